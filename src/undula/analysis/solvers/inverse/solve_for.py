"""The inverse question: values of a parameter at which a state or a threshold has a target."""

from collections.abc import Callable, Sequence

from undula.analysis.arguments import require_model
from undula.analysis.one_thread import on_one_thread
from undula.analysis.solvers.inverse.branch_search import Question, search_branch
from undula.analysis.solvers.inverse.branch_solutions import branch_solutions
from undula.analysis.solvers.inverse.ranges import range_of
from undula.analysis.solvers.inverse.solutions import Solutions
from undula.analysis.solvers.inverse.targets import target_of
from undula.analysis.solvers.inverse.threshold_solutions import (
    require_other_than_force,
    search_thresholds,
)
from undula.analysis.solvers.symmetry import require_space
from undula.analysis.solvers.thresholds import THRESHOLDS
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.follow_branch import Progress
from undula.models.model import Model


@on_one_thread
def solve_for(
    model: Model,
    kind: str,
    *,
    by: str,
    between: Sequence[float] | None = None,
    progress: Progress | None = None,
    stop: Callable[[], bool] = lambda: False,
    **target: float,
) -> Solutions:
    """Solve for the values of a parameter at which a state or a threshold has a target.

    A branch of states is followed over the range by pseudo-arclength continuation, through folds,
    so that all solutions on it are found. A threshold is solved for at values over the range, each
    next to the last, and then between them. All solutions are located to round-off.

    Parameters
    ----------
    model : Model
        The model; its own value of the parameter is where a branch begins, if it lies in the range.
    kind : str
        Kind of state, "spinning", "flapping", "equilibrium" or "periodic", or name of a threshold,
        "onset", "spinning-lost", "flapping-gained" or "flapping-lost".
    by : str
        Name of the parameter, such as "load.force" or "model.drag_ratio"; of a threshold not the
        force.
    between : (float, float), optional
        Range of the parameter, in its unit. The default of the force is from 0 to 8 times that of
        the onset. The default of another parameter is from a quarter of its own value to 4 times
        that, as far as the model allows.
    progress : callable, optional
        Called with each value of the parameter that was reached.
    stop : callable, optional
        Called after each state; the search ends where it returns True.
    **target : float
        One quantity and its value: of a state `frequency` [cycles per T], `period` [T],
        `leading_rate` [1/T], 0 where stability changes, `bending_energy` [B/L], `tip_radius` or
        `tip_height` [L]; where the shape changes `bending_energy_min`, `_max` or `_mean`, and so
        on. Of a threshold `value` [B/L^2] or `frequency`.

    Returns
    -------
    Solutions
        A sequence of `Solution`, by rising value. It is empty, and has a reason, if the target is
        not met.

    Raises
    ------
    InputError
        The kind, the parameter or the quantity does not exist, there is not exactly one target, or
        the range is not two rising values that the model allows.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> question = {"frequency": 80.0, "by": "load.force", "between": (40, 100)}
    >>> forces = un.solve_for(model, "spinning", **question)
    >>> state = un.find(model.with_(force=forces[0].value), "spinning")
    >>> len(forces), round(state.frequency, 6)
    (1, 80.0)
    """
    require_model(model, "solve_for")
    wanted = target_of(model, kind, target)
    if kind in THRESHOLDS:
        require_other_than_force(kind, by)
    elif kind in ("spinning", "periodic"):
        require_space(model)
    ends = range_of(model, kind, by, between)
    if kind in THRESHOLDS:
        curve = search_thresholds(model, wanted, by, ends, progress, stop)
        searched, found = curve.searched, curve.solutions(ends, stop)
    else:
        shared = model_along(model, kind, by, ends)
        question = Question(shared, wanted, by, ends, progress, stop)
        branch = search_branch(question)
        searched, found = branch.searched, branch_solutions(question, branch)
    return Solutions(
        kind=kind,
        quantity=wanted.quantity,
        target=wanted.value,
        parameter=by,
        between=ends,
        quantity_range=searched.quantity_range,
        found=found,
        reason=None if found else searched.reason(wanted, by),
        not_searched="the search was stopped" if stop() else searched.not_searched,
    )
