"""Refusal of states that a body cannot have by its symmetry."""

from undula.errors import InputError
from undula.models.model import Model


def require_space(model: Model) -> None:
    """Refuse a model that is confined to a plane.

    Raises
    ------
    InputError
        The model is confined.
    """
    if model.dimension != 3:
        raise InputError("a confined model cannot spin; set confined = false")


def require_turning(model: Model, kind: str) -> None:
    """Refuse a body without rotational symmetry about its axis.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    kind : {"spinning", "flapping"}
        A state that only bodies with this symmetry have.

    Raises
    ------
    InputError
        The body has no such symmetry.
    """
    if not model.axisymmetric:
        raise InputError(
            f"this filament has no turning symmetry, which {kind} takes, as it is curved by nature"
            " or bends more easily one way: use natural_curvature = (0, 0) and bending_ratio = 1,"
            " or ask for its equilibrium, its threshold onset, or a periodic motion"
        )
