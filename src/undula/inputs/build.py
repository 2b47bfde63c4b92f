"""Model, start and schedule of a run, built from a checked input."""

from collections.abc import Callable, Mapping
from pathlib import Path

from undula.analysis.run_settings import Schedule
from undula.arrays import State
from undula.errors import InputError
from undula.inputs.file_names import file_name
from undula.inputs.input import ModelInput, RunInput
from undula.inputs.model_tables import LoadTable
from undula.inputs.run_tables import StartTable
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.initial_states import from_state, helix, kicked, mode, planar, straight
from undula.models.loads.analytic import DensityLoad, LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.beads import BeadLoad
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import TableLoad
from undula.models.model import Model

_DENSITIES: Mapping[str, Callable[[LoadTable], DensityLoad]] = {
    "tip": lambda table: TipLoad(table.force),
    "point": lambda table: PointLoad(table.force, table.position),
    "linear": lambda table: LinearLoad(table.force, table.slope),
    "power": lambda table: PowerLoad(table.force, table.exponent),
    "table": lambda table: TableLoad(table.force, table.s or (), table.density or ()),
}
_LOADS: Mapping[str, Callable[[LoadTable], Load]] = {
    **_DENSITIES,
    "beads": lambda table: BeadLoad(table.force, table.beads),
}

_STARTS: Mapping[str, Callable[[Model, StartTable], State]] = {
    "straight": lambda model, _: straight(model),
    "kicked": lambda model, table: kicked(model, table.amplitude, seed=table.seed),
    "planar": lambda model, table: planar(model, table.amplitude, angle=table.angle),
    "helix": lambda model, table: helix(
        model, table.amplitude, right_handed=table.handedness == "right"
    ),
    "mode": lambda model, table: mode(model, table.amplitude, angle=table.angle),
    "state": lambda model, table: _stored_state(
        model, file_name(table.file or ""), table.amplitude
    ),
}


def build_model(wanted: ModelInput) -> Model:
    """Return the model that an input describes.

    Parameters
    ----------
    wanted
        A checked input; its tables ``[model]`` and ``[load]`` are used.
    """
    table, load = wanted.model, wanted.load
    if table.kind == "chain":
        return Chain(
            links=table.links,
            load=_LOADS[load.profile](load),
            drag_ratio=table.drag_ratio,
            base_spring=table.base_spring,
            bead_drag=table.bead_drag,
            confined=table.confined,
            spring=table.spring,
        )
    return Filament(
        segments=table.segments,
        load=_DENSITIES[load.profile](load),
        drag_ratio=table.drag_ratio,
        inextensibility=table.inextensibility,
        tensile_stiffness=table.tensile_stiffness,
        confined=table.confined,
        natural_curvature=table.natural_curvature,
        bending_ratio=table.bending_ratio,
        twist=table.twist,
        twist_stiffness=table.twist_stiffness,
    )


def build_start(wanted: RunInput, model: Model) -> State:
    """Return the initial state of the run that an input describes.

    Parameters
    ----------
    wanted
        A checked input; its table ``[start]`` is used.
    model
        The model of the run.

    Returns
    -------
    ndarray of shape (model.size,)
        The state at time 0.

    Raises
    ------
    InputError
        The result file of ``start.file`` cannot be read, or its last shape does not lie in the
        plane of a confined model.
    """
    return _STARTS[wanted.start.shape](model, wanted.start)


def build_schedule(wanted: RunInput) -> Schedule:
    """Return the end, the samples and the tolerances of the run that an input describes.

    Parameters
    ----------
    wanted
        A checked input; its table ``[time]`` is used.
    """
    return Schedule(**wanted.time.model_dump())


def _stored_state(model: Model, path: Path, amplitude: float) -> State:
    # The import is slow, and most starts read no file.
    from undula.storage.run_file import load_result

    nodes = load_result(path)["nodes"]
    if not nodes.sizes["time"]:
        raise InputError(f"{path} holds no samples to start from; give another start.file")
    return from_state(model, nodes.values[-1], amplitude)
