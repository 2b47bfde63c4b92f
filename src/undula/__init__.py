"""undula: elastic microfilaments in viscous fluid under axial follower forces.

Build a model (`Filament` or `Chain`, with a load), choose an initial state, and `integrate` it; or
solve for its states directly with `find_spinning` and `find_flapping`. See docs/index.md.

Each name is imported at its first use, so that the command line starts quickly.
"""

import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import undula.analysis.observables.shapes as observables
    import undula.views as views
    from undula.analysis.linear.spectrum import spectrum
    from undula.analysis.linear.stability import critical_curve, growth_curve, onset
    from undula.analysis.maps.basins import basins
    from undula.analysis.maps.contradictions import contradictions
    from undula.analysis.maps.stability_along_force import stability_along_force
    from undula.analysis.maps.stability_boundaries import stability_boundaries
    from undula.analysis.regimes.lyapunov import lyapunov
    from undula.analysis.runs.dataset import dataset_of
    from undula.analysis.runs.integrate import integrate
    from undula.analysis.runs.run import Run
    from undula.analysis.solvers.branches import follow, follow_from_onset
    from undula.analysis.solvers.criticality import criticality
    from undula.analysis.solvers.equilibrium import find_equilibrium
    from undula.analysis.solvers.flapping import find_flapping
    from undula.analysis.solvers.periodic_orbits import follow_from_bifurcation
    from undula.analysis.solvers.periodic_search import find_periodic
    from undula.analysis.solvers.spinning import find_spinning
    from undula.analysis.solvers.state_kinds import extrapolate
    from undula.analysis.solvers.thresholds import threshold, threshold_curve
    from undula.analysis.states.periodic_record import Periodic
    from undula.analysis.states.records import Equilibrium, Flapping, Spinning
    from undula.errors import InputError
    from undula.models.chain import Chain
    from undula.models.filament import Filament
    from undula.models.initial_states import from_state, helix, kicked, mode, planar, straight
    from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
    from undula.models.loads.beads import BeadLoad
    from undula.models.loads.power import PowerLoad
    from undula.models.loads.user_density import ProfileLoad, TableLoad
    from undula.models.natural_curvature import CurvatureTable
    from undula.models.scales import Scales
    from undula.storage.ramp_file import load_ramp
    from undula.storage.run_file import load_result
    from undula.storage.unchecked import StoredWarning
    from undula.sweeps.store import load_sweep

_MODULE_OF = {
    "BeadLoad": "undula.models.loads.beads",
    "Chain": "undula.models.chain",
    "CurvatureTable": "undula.models.natural_curvature",
    "Equilibrium": "undula.analysis.states.records",
    "Filament": "undula.models.filament",
    "Flapping": "undula.analysis.states.records",
    "InputError": "undula.errors",
    "LinearLoad": "undula.models.loads.analytic",
    "Load": "undula.models.loads.analytic",
    "Periodic": "undula.analysis.states.periodic_record",
    "PointLoad": "undula.models.loads.analytic",
    "PowerLoad": "undula.models.loads.power",
    "ProfileLoad": "undula.models.loads.user_density",
    "Run": "undula.analysis.runs.run",
    "Scales": "undula.models.scales",
    "Spinning": "undula.analysis.states.records",
    "StoredWarning": "undula.storage.unchecked",
    "TableLoad": "undula.models.loads.user_density",
    "TipLoad": "undula.models.loads.analytic",
    "basins": "undula.analysis.maps.basins",
    "criticality": "undula.analysis.solvers.criticality",
    "extrapolate": "undula.analysis.solvers.state_kinds",
    "critical_curve": "undula.analysis.linear.stability",
    "onset": "undula.analysis.linear.stability",
    "dataset_of": "undula.analysis.runs.dataset",
    "contradictions": "undula.analysis.maps.contradictions",
    "find_equilibrium": "undula.analysis.solvers.equilibrium",
    "find_flapping": "undula.analysis.solvers.flapping",
    "find_periodic": "undula.analysis.solvers.periodic_search",
    "find_spinning": "undula.analysis.solvers.spinning",
    "follow": "undula.analysis.solvers.branches",
    "follow_from_bifurcation": "undula.analysis.solvers.periodic_orbits",
    "follow_from_onset": "undula.analysis.solvers.branches",
    "from_state": "undula.models.initial_states",
    "growth_curve": "undula.analysis.linear.stability",
    "helix": "undula.models.initial_states",
    "integrate": "undula.analysis.runs.integrate",
    "kicked": "undula.models.initial_states",
    "load_result": "undula.storage.run_file",
    "load_ramp": "undula.storage.ramp_file",
    "load_sweep": "undula.sweeps.store",
    "lyapunov": "undula.analysis.regimes.lyapunov",
    "mode": "undula.models.initial_states",
    "planar": "undula.models.initial_states",
    "stability_boundaries": "undula.analysis.maps.stability_boundaries",
    "stability_along_force": "undula.analysis.maps.stability_along_force",
    "spectrum": "undula.analysis.linear.spectrum",
    "straight": "undula.models.initial_states",
    "threshold": "undula.analysis.solvers.thresholds",
    "threshold_curve": "undula.analysis.solvers.thresholds",
}

_SUBMODULES = {"observables": "undula.analysis.observables.shapes", "views": "undula.views"}

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
    "contradictions",
    "critical_curve",
    "criticality",
    "dataset_of",
    "extrapolate",
    "find_equilibrium",
    "find_flapping",
    "find_periodic",
    "find_spinning",
    "follow",
    "follow_from_bifurcation",
    "follow_from_onset",
    "from_state",
    "growth_curve",
    "helix",
    "integrate",
    "kicked",
    "load_ramp",
    "load_result",
    "load_sweep",
    "lyapunov",
    "mode",
    "observables",
    "onset",
    "planar",
    "spectrum",
    "stability_along_force",
    "stability_boundaries",
    "straight",
    "threshold",
    "threshold_curve",
    "views",
]


#: Names of the previous version and their new names; the next version drops them.
_RENAMED = {
    "births": "criticality",
    "converged": "extrapolate",
    "critical_force": "onset",
    "disagreements": "contradictions",
    "follow_born": "follow_from_bifurcation",
    "load_steps": "load_ramp",
    "load_study": "load_sweep",
    "solved_borders": "stability_boundaries",
    "solved_line": "stability_along_force",
}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        new = _RENAMED[name]
        message = f"undula.{name} is now undula.{new}; the old name goes with the next release"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return __getattr__(new)
    if name in _SUBMODULES:
        return import_module(_SUBMODULES[name])
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'undula' has no attribute {name!r}")
    return getattr(import_module(_MODULE_OF[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
