"""undula: elastic microfilaments in viscous fluid under axial follower forces.

Build a model (`Filament` and a load), give it a start, and `integrate`, or solve for what it ends
in with `find_spinning` and `find_flapping`; see docs/index.md.
Each name is imported when it is first asked for, so that the command line answers at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import undula.analysis.observables as observables
    import undula.views as views
    from undula.analysis.basins import basins
    from undula.analysis.births import births
    from undula.analysis.borders import solved_borders
    from undula.analysis.disagreements import disagreements
    from undula.analysis.equilibrium import Equilibrium, find_equilibrium
    from undula.analysis.flapping import find_flapping
    from undula.analysis.integrate import integrate
    from undula.analysis.kinds import converged, follow, follow_from_onset
    from undula.analysis.lyapunov import lyapunov
    from undula.analysis.periodic_orbits import follow_born
    from undula.analysis.periodic_search import find_periodic
    from undula.analysis.periodic_state import Periodic
    from undula.analysis.record import dataset_of
    from undula.analysis.run import Run
    from undula.analysis.solved_points import solved_line
    from undula.analysis.spinning import find_spinning
    from undula.analysis.stability import (
        critical_curve,
        critical_force,
        growth_curve,
        spectrum,
    )
    from undula.analysis.states import Flapping, Spinning
    from undula.analysis.thresholds import threshold, threshold_curve
    from undula.errors import InputError
    from undula.models.beads import BeadLoad
    from undula.models.chain import Chain
    from undula.models.filament import Filament
    from undula.models.loads import LinearLoad, Load, PointLoad, PowerLoad, TipLoad
    from undula.models.natural_curvature import CurvatureTable
    from undula.models.profiles import ProfileLoad, TableLoad
    from undula.models.scales import Scales
    from undula.models.starts import from_state, helix, kicked, mode, planar, straight
    from undula.studies.steps_store import load_steps
    from undula.studies.store import load_result
    from undula.studies.study_store import load_study
    from undula.studies.unchecked import StoredWarning

_HOMES = {
    "BeadLoad": "undula.models.beads",
    "Chain": "undula.models.chain",
    "CurvatureTable": "undula.models.natural_curvature",
    "Equilibrium": "undula.analysis.equilibrium",
    "Filament": "undula.models.filament",
    "Flapping": "undula.analysis.states",
    "InputError": "undula.errors",
    "LinearLoad": "undula.models.loads",
    "Load": "undula.models.loads",
    "Periodic": "undula.analysis.periodic_state",
    "PointLoad": "undula.models.loads",
    "PowerLoad": "undula.models.loads",
    "ProfileLoad": "undula.models.profiles",
    "Run": "undula.analysis.run",
    "Scales": "undula.models.scales",
    "Spinning": "undula.analysis.states",
    "StoredWarning": "undula.studies.unchecked",
    "TableLoad": "undula.models.profiles",
    "TipLoad": "undula.models.loads",
    "basins": "undula.analysis.basins",
    "births": "undula.analysis.births",
    "converged": "undula.analysis.kinds",
    "critical_curve": "undula.analysis.stability",
    "critical_force": "undula.analysis.stability",
    "dataset_of": "undula.analysis.record",
    "disagreements": "undula.analysis.disagreements",
    "find_equilibrium": "undula.analysis.equilibrium",
    "find_flapping": "undula.analysis.flapping",
    "find_periodic": "undula.analysis.periodic_search",
    "find_spinning": "undula.analysis.spinning",
    "follow": "undula.analysis.kinds",
    "follow_born": "undula.analysis.periodic_orbits",
    "follow_from_onset": "undula.analysis.kinds",
    "from_state": "undula.models.starts",
    "growth_curve": "undula.analysis.stability",
    "helix": "undula.models.starts",
    "integrate": "undula.analysis.integrate",
    "kicked": "undula.models.starts",
    "load_result": "undula.studies.store",
    "load_steps": "undula.studies.steps_store",
    "load_study": "undula.studies.study_store",
    "lyapunov": "undula.analysis.lyapunov",
    "mode": "undula.models.starts",
    "planar": "undula.models.starts",
    "solved_borders": "undula.analysis.borders",
    "solved_line": "undula.analysis.solved_points",
    "spectrum": "undula.analysis.stability",
    "straight": "undula.models.starts",
    "threshold": "undula.analysis.thresholds",
    "threshold_curve": "undula.analysis.thresholds",
}

_ROOMS = {"observables": "undula.analysis.observables", "views": "undula.views"}

__all__ = [
    "BeadLoad",
    "Chain",
    "CurvatureTable",
    "Equilibrium",
    "Filament",
    "Flapping",
    "InputError",
    "LinearLoad",
    "Load",
    "Periodic",
    "PointLoad",
    "PowerLoad",
    "ProfileLoad",
    "Run",
    "Scales",
    "Spinning",
    "StoredWarning",
    "TableLoad",
    "TipLoad",
    "basins",
    "births",
    "converged",
    "critical_curve",
    "critical_force",
    "dataset_of",
    "disagreements",
    "find_equilibrium",
    "find_flapping",
    "find_periodic",
    "find_spinning",
    "follow",
    "follow_born",
    "follow_from_onset",
    "from_state",
    "growth_curve",
    "helix",
    "integrate",
    "kicked",
    "load_result",
    "load_steps",
    "load_study",
    "lyapunov",
    "mode",
    "observables",
    "planar",
    "solved_borders",
    "solved_line",
    "spectrum",
    "straight",
    "threshold",
    "threshold_curve",
    "views",
]


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return import_module(_ROOMS[name])
    if name not in _HOMES:
        raise AttributeError(f"module 'undula' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
