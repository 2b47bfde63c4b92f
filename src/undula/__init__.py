"""undula: elastic microfilaments in viscous fluid under axial follower forces.

Build a model (`Filament` and a load), give it a start, and `integrate`; see docs/index.md.
"""

from undula import views
from undula.analysis.integrate import integrate
from undula.analysis.record import dataset_of
from undula.analysis.run import Run
from undula.errors import InputError
from undula.models.filament import Filament
from undula.models.loads import LinearLoad, Load, PointLoad, PowerLoad, TipLoad
from undula.models.scales import Scales
from undula.models.starts import from_state, helix, kicked, mode, planar, straight
from undula.studies.store import load_result

__all__ = [
    "Filament",
    "InputError",
    "LinearLoad",
    "Load",
    "PointLoad",
    "PowerLoad",
    "Run",
    "Scales",
    "TipLoad",
    "dataset_of",
    "from_state",
    "helix",
    "integrate",
    "kicked",
    "load_result",
    "mode",
    "planar",
    "straight",
    "views",
]
