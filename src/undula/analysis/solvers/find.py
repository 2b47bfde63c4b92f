"""Search for a state of any kind, by its name."""

from typing import Any

from undula.analysis.arguments import require_model
from undula.analysis.one_thread import on_one_thread
from undula.analysis.runs.run import Run
from undula.analysis.solvers.state_kinds import KINDS, Solved, extrapolate, kind_by_name, with_error
from undula.analysis.states.extrapolation import Converged
from undula.analysis.states.not_found import NotFound
from undula.errors import InputError
from undula.models.model import Model


@on_one_thread
def find(
    model: Model | Run,
    kind: str,
    *,
    guess: Any = None,
    seed: int | None = None,
    converged: bool = False,
    error: bool = False,
) -> Solved | Converged[Any] | NotFound:
    """Solve for a state of a model.

    Parameters
    ----------
    model : Model or Run
        A filament or a chain; a run stands for its model, with itself as the guess.
    kind : {"spinning", "flapping", "equilibrium", "periodic"}
        Kind of the state: a shape that turns about the axis, a planar beat, a bent shape at rest,
        or any motion that repeats itself, up to a rotation.
    guess : Run or State, optional
        A run that ends in such a motion, or the state of a similar model, with any number of links.
        Without one the branch is followed from where such states begin.
    seed : int, optional
        Of "periodic" without a guess: seed of the kick of the run that is made, at least 0.
    converged : bool
        True to extrapolate to many links.
    error : bool
        True to estimate the error of the frequency against the filament, which takes the same
        search with another number of links.

    Returns
    -------
    Spinning, Flapping, Equilibrium, Periodic, Converged or NotFound
        `Converged` if that was asked for. `NotFound` is false, and has advice.

    Raises
    ------
    InputError
        There is no such kind, the model cannot have it, or it has no limit of many links; both a
        guess and a seed are given, or a seed of another kind.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning")
    >>> state.stable, round(state.frequency)
    (True, 87)
    >>> bool(un.find(un.Filament(8, un.TipLoad(30.0)), "spinning"))
    False
    """
    if isinstance(model, Run):
        model, guess = model.model, model if guess is None else guess
    require_model(model, "find")
    if not isinstance(kind, str):
        raise InputError(
            f"kind = {kind!r} is no kind of state; take {' or '.join(map(repr, KINDS))}; the force"
            " is that of the model's load"
        )
    if seed is not None and kind != "periodic":
        raise InputError(f"a seed is of a periodic motion, not of {kind}; leave it out")
    if converged:
        return extrapolate(model, kind, guess)
    options = {} if seed is None else {"seed": seed}
    state: Solved | NotFound = kind_by_name(kind).find(model, guess, **options)
    return with_error(state) if error and not isinstance(state, NotFound) else state
