"""undula: elastic microfilaments in viscous fluid under axial follower forces.

Build a model (`Filament` or `Chain`, with a load), choose an initial state, and `integrate` it; or
solve for its states directly with `find`. See docs/index.md.

Each name is imported at its first use, so that the command line starts quickly.
"""

import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import undula.analysis.observables.shapes as observables
    import undula.views as views
    from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
    from undula.analysis.linear.results import Crossing, Onset, Spectrum
    from undula.analysis.linear.spectrum import spectrum
    from undula.analysis.linear.stability import critical_curve, growth_curve, onset
    from undula.analysis.maps.basins import basins
    from undula.analysis.maps.contradictions import contradictions
    from undula.analysis.maps.stability_along_force import stability_along_force
    from undula.analysis.maps.stability_boundaries import stability_boundaries
    from undula.analysis.observables.shapes import Range
    from undula.analysis.ramps.quasi_static import RampResult, ramp
    from undula.analysis.ramps.ramp import Ramp
    from undula.analysis.record import Fact, Record
    from undula.analysis.regimes.lyapunov import Lyapunov, NotFollowed, lyapunov
    from undula.analysis.regimes.verdict import Verdict
    from undula.analysis.runs.dataset import dataset_of
    from undula.analysis.runs.integrate import integrate
    from undula.analysis.runs.progress import Progress
    from undula.analysis.runs.run import Run
    from undula.analysis.sensitivity.sensitivities import Sensitivities, sensitivities
    from undula.analysis.solvers.branches import follow, follow_from_onset
    from undula.analysis.solvers.criticality import criticality
    from undula.analysis.solvers.find import find
    from undula.analysis.solvers.find_threshold import threshold
    from undula.analysis.solvers.inverse.solutions import Solution, Solutions
    from undula.analysis.solvers.inverse.solve_for import solve_for
    from undula.analysis.solvers.periodic_orbits import follow_from_bifurcation
    from undula.analysis.solvers.threshold_record import Threshold, ThresholdCurve
    from undula.analysis.states.branch import Bifurcation, Bifurcations, Branch
    from undula.analysis.states.extrapolation import Converged
    from undula.analysis.states.not_found import NotFound, SearchStatus
    from undula.analysis.states.periodic_record import Periodic
    from undula.analysis.states.records import Equilibrium, Flapping, Spinning
    from undula.analysis.states.state import State
    from undula.errors import InputError
    from undula.models.chain import Chain
    from undula.models.filament import Filament
    from undula.models.initial_states import from_state, helix, kicked, mode, planar, straight
    from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
    from undula.models.loads.beads import BeadLoad
    from undula.models.loads.power import PowerLoad
    from undula.models.loads.user_density import ProfileLoad, TableLoad
    from undula.models.model import Model
    from undula.models.natural_curvature import CurvatureTable
    from undula.models.scales import Scales
    from undula.models.units import Units
    from undula.storage.unchecked import StoredWarning
    from undula.sweeps.from_python import sweep
    from undula.sweeps.load import load

_MODULE_OF = {
    "BeadLoad": "undula.models.loads.beads",
    "Bifurcation": "undula.analysis.states.branch",
    "Bifurcations": "undula.analysis.states.branch",
    "Branch": "undula.analysis.states.branch",
    "Chain": "undula.models.chain",
    "Converged": "undula.analysis.states.extrapolation",
    "CriticalCurve": "undula.analysis.linear.curves",
    "Crossing": "undula.analysis.linear.results",
    "CurvatureTable": "undula.models.natural_curvature",
    "Equilibrium": "undula.analysis.states.records",
    "Fact": "undula.analysis.record",
    "Filament": "undula.models.filament",
    "Flapping": "undula.analysis.states.records",
    "GrowthCurve": "undula.analysis.linear.curves",
    "InputError": "undula.errors",
    "LinearLoad": "undula.models.loads.analytic",
    "Load": "undula.models.loads.analytic",
    "Lyapunov": "undula.analysis.regimes.lyapunov",
    "Model": "undula.models.model",
    "NotFollowed": "undula.analysis.regimes.lyapunov",
    "NotFound": "undula.analysis.states.not_found",
    "Onset": "undula.analysis.linear.results",
    "Periodic": "undula.analysis.states.periodic_record",
    "PointLoad": "undula.models.loads.analytic",
    "PowerLoad": "undula.models.loads.power",
    "ProfileLoad": "undula.models.loads.user_density",
    "Progress": "undula.analysis.runs.progress",
    "Ramp": "undula.analysis.ramps.ramp",
    "RampResult": "undula.analysis.ramps.quasi_static",
    "Range": "undula.analysis.observables.shapes",
    "Record": "undula.analysis.record",
    "Run": "undula.analysis.runs.run",
    "Scales": "undula.models.scales",
    "SearchStatus": "undula.analysis.states.not_found",
    "Sensitivities": "undula.analysis.sensitivity.sensitivities",
    "Solution": "undula.analysis.solvers.inverse.solutions",
    "Solutions": "undula.analysis.solvers.inverse.solutions",
    "Spectrum": "undula.analysis.linear.results",
    "Spinning": "undula.analysis.states.records",
    "State": "undula.analysis.states.state",
    "StoredWarning": "undula.storage.unchecked",
    "TableLoad": "undula.models.loads.user_density",
    "Threshold": "undula.analysis.solvers.threshold_record",
    "ThresholdCurve": "undula.analysis.solvers.threshold_record",
    "TipLoad": "undula.models.loads.analytic",
    "Units": "undula.models.units",
    "Verdict": "undula.analysis.regimes.verdict",
    "basins": "undula.analysis.maps.basins",
    "contradictions": "undula.analysis.maps.contradictions",
    "critical_curve": "undula.analysis.linear.stability",
    "criticality": "undula.analysis.solvers.criticality",
    "dataset_of": "undula.analysis.runs.dataset",
    "find": "undula.analysis.solvers.find",
    "follow": "undula.analysis.solvers.branches",
    "follow_from_bifurcation": "undula.analysis.solvers.periodic_orbits",
    "follow_from_onset": "undula.analysis.solvers.branches",
    "from_state": "undula.models.initial_states",
    "growth_curve": "undula.analysis.linear.stability",
    "helix": "undula.models.initial_states",
    "integrate": "undula.analysis.runs.integrate",
    "kicked": "undula.models.initial_states",
    "load": "undula.sweeps.load",
    "lyapunov": "undula.analysis.regimes.lyapunov",
    "mode": "undula.models.initial_states",
    "onset": "undula.analysis.linear.stability",
    "planar": "undula.models.initial_states",
    "ramp": "undula.analysis.ramps.quasi_static",
    "sensitivities": "undula.analysis.sensitivity.sensitivities",
    "solve_for": "undula.analysis.solvers.inverse.solve_for",
    "spectrum": "undula.analysis.linear.spectrum",
    "stability_along_force": "undula.analysis.maps.stability_along_force",
    "stability_boundaries": "undula.analysis.maps.stability_boundaries",
    "straight": "undula.models.initial_states",
    "sweep": "undula.sweeps.from_python",
    "threshold": "undula.analysis.solvers.find_threshold",
}

_SUBMODULES = {"observables": "undula.analysis.observables.shapes", "views": "undula.views"}

__all__ = [
    "BeadLoad",
    "Bifurcation",
    "Bifurcations",
    "Branch",
    "Chain",
    "Converged",
    "CriticalCurve",
    "Crossing",
    "CurvatureTable",
    "Equilibrium",
    "Fact",
    "Filament",
    "Flapping",
    "GrowthCurve",
    "InputError",
    "LinearLoad",
    "Load",
    "Lyapunov",
    "Model",
    "NotFollowed",
    "NotFound",
    "Onset",
    "Periodic",
    "PointLoad",
    "PowerLoad",
    "ProfileLoad",
    "Progress",
    "Ramp",
    "RampResult",
    "Range",
    "Record",
    "Run",
    "Scales",
    "SearchStatus",
    "Sensitivities",
    "Solution",
    "Solutions",
    "Spectrum",
    "Spinning",
    "State",
    "StoredWarning",
    "TableLoad",
    "Threshold",
    "ThresholdCurve",
    "TipLoad",
    "Units",
    "Verdict",
    "basins",
    "contradictions",
    "critical_curve",
    "criticality",
    "dataset_of",
    "find",
    "follow",
    "follow_from_bifurcation",
    "follow_from_onset",
    "from_state",
    "growth_curve",
    "helix",
    "integrate",
    "kicked",
    "load",
    "lyapunov",
    "mode",
    "observables",
    "onset",
    "planar",
    "ramp",
    "sensitivities",
    "solve_for",
    "spectrum",
    "stability_along_force",
    "stability_boundaries",
    "straight",
    "sweep",
    "threshold",
    "views",
]


#: Names of the previous version and their new names; the next version drops them.
_RENAMED = {
    "births": "criticality",
    "critical_force": "onset",
    "disagreements": "contradictions",
    "follow_born": "follow_from_bifurcation",
    "load_steps": "load",
    "load_study": "load",
    "solved_borders": "stability_boundaries",
    "solved_line": "stability_along_force",
}


#: Functions of the previous version with their modules, and calls of new ones in place of theirs;
#: the next version drops them.
_FORMER = {
    "find_spinning": ("undula.analysis.solvers.spinning", 'find(model, "spinning")'),
    "find_flapping": ("undula.analysis.solvers.flapping", 'find(model, "flapping")'),
    "find_equilibrium": ("undula.analysis.solvers.equilibrium", 'find(model, "equilibrium")'),
    "find_periodic": ("undula.analysis.solvers.periodic_search", 'find(model, "periodic")'),
    "threshold_curve": (
        "undula.analysis.solvers.thresholds",
        "threshold(model, kind, along=(parameter, values))",
    ),
    "extrapolate": ("undula.analysis.solvers.state_kinds", "find(model, kind, converged=True)"),
    "load_result": ("undula.storage.run_file", "load(path)"),
    "load_ramp": ("undula.storage.ramp_file", "load(path)"),
    "load_sweep": ("undula.sweeps.store", "load(path)"),
}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        new = _RENAMED[name]
        message = f"undula.{name} is now undula.{new}; the old name goes with the next release"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return __getattr__(new)
    if name in _FORMER:
        module, call = _FORMER[name]
        message = f"undula.{name} is now undula.{call}; the old name goes with the next release"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return getattr(import_module(module), name)
    if name in _SUBMODULES:
        return import_module(_SUBMODULES[name])
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'undula' has no attribute {name!r}")
    return getattr(import_module(_MODULE_OF[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
