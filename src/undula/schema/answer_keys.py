"""Keys of the JSON objects with which commands answer, and the quantities that they hold.

An object is described by the `Keys` that it may hold. Each key is described by a quantity, which
fixes its unit, by the keys of an object or of the objects of a list, or by `Named`. An answer holds
no other keys, and need not hold all of them; docs/output.md states their meanings.
"""

from collections.abc import Mapping

from undula.schema.claim_keys import CLAIM
from undula.schema.key_kinds import (
    ENERGY,
    FORCE,
    FREQUENCY,
    LENGTH,
    OF_PARAMETER,
    PARAMETER,
    RATE,
    TIME,
    UNITLESS,
    Keys,
    Named,
    plain,
    range_of,
    with_error,
    with_physical,
)

#: Derivatives, by parameter and quantity.
_SENSITIVITIES = Named(Named(UNITLESS))
#: A force in the further units of a chain.
_FURTHER = Named(FORCE)
_NAMES = plain("length", "force", "energy", "power", "time", "frequency")
#: Keys of every answer.
EVERY: Keys = plain("status", "error")
_EXTENTS: Keys = {
    "bending_energy": range_of(ENERGY),
    "tip_radius": range_of(LENGTH),
    "tip_height": range_of(LENGTH),
}
_FREQUENCIES: Keys = {
    **with_error("frequency", FREQUENCY),
    **with_error("rotation_frequency", FREQUENCY),
    **with_error("shape_frequency", FREQUENCY),
}
_RATES: Keys = dict.fromkeys(
    ("leading_rate", "leading_rate_in_plane", "leading_rate_out_of_plane"), RATE
)
_REFERENCE: Keys = plain("links", "error_of")

# ---------------------------------------------------------------- runs

_EXPONENTS: Keys = {
    **dict.fromkeys(("value", "error", "exponents", "errors"), RATE),
    **with_error("beyond_symmetry", RATE),
    **plain("symmetries"),
    "duration": TIME,
    "finite_separation": {"rate": RATE, "error": RATE, **plain("saturated")},
}
#: Numbers that the name of a motion rests on.
EVIDENCE: Keys = {
    **with_error("frequency", FREQUENCY),
    **with_error("lyapunov", RATE),
    **with_error("decay_rate", RATE),
    "leading_rate": RATE,
    "ringing_frequency": FREQUENCY,
    "shape_period": TIME,
    **dict.fromkeys(("displacement", "distance", "recurrence_distance"), LENGTH),
    **plain("drift", "shape_drift", "shape_change", "misfit", "planarity", "winding_coherence"),
    **plain("maxima", "maxima_a_period", "periods", "samples", "samples_per_period"),
    **plain("sense_of_rotation", "turn_a_period", "turns", "plane_turns", "bias"),
    **plain("decay_factor", "zero_crossings", "energy_swing"),
}
HEALTH: Keys = {
    **plain("power_balance_error", "length_error", "largest_joint_angle", "folded"),
    "smallest_step": TIME,
    "largest_step": TIME,
    **plain("steps", "rejected", "failed", "factorisations", "solves", "frame", "frame_changes"),
}
RUN: Keys = {
    **EVERY,
    **plain("cause", "load", "verdict", "reason", "margin", "without_lyapunov"),
    **plain("planarity", "winding_angle", "seed", "output", "figure", "movie"),
    "units": _NAMES,
    "force": FORCE,
    "force_in": _FURTHER,
    **_REFERENCE,
    "evidence": EVIDENCE,
    "lyapunov": _EXPONENTS,
    **_FREQUENCIES,
    **_EXTENTS,
    "precession": {
        **dict.fromkeys(("tip_turns", "plane_turns", "beats"), FREQUENCY),
        **plain("side_switching"),
    },
    **dict.fromkeys(("time", "window", "longer", "settled_from", "tight_from"), TIME),
    "settled": {
        **plain("kind", "cycles", "turn", "brief"),
        **dict.fromkeys(("since", "period", "remaining"), TIME),
    },
    "solved": {
        **plain("kind", "relative"),
        "time": TIME,
        "distance": LENGTH,
        "leading_rate": RATE,
    },
    **HEALTH,
    # Wall time.
    **plain("seconds"),
}

# ---------------------------------------------------------------- thresholds and states

_RINGING: Keys = {
    **dict.fromkeys(("oscillatory_force", "oscillatory_error", "hopf_force", "error"), FORCE),
    **dict.fromkeys(("oscillatory_force_in", "hopf_force_in"), _FURTHER),
    "hopf_frequency": FREQUENCY,
    "frequency_error": FREQUENCY,
    **plain("hopf_growth_slope", "reason"),
    "searched_to": FORCE,
}
_EIGENVALUE: Keys = {"rate": RATE, "frequency": FREQUENCY, "error": RATE}
STABILITY: Keys = {
    **EVERY,
    **plain("load", "method", "paper_time", "figure", "parameter"),
    "units": _NAMES,
    **_RINGING,
    "later": {
        **with_error("frequency", FREQUENCY),
        "force": FORCE,
        "force_in": _FURTHER,
        "error": FORCE,
        **plain("growth_slope"),
    },
    "force": FORCE,
    "force_in": _FURTHER,
    "spectrum": _EIGENVALUE,
    "points": {PARAMETER: UNITLESS, "force": FORCE, "force_in": _FURTHER, **_EIGENVALUE},
    "thresholds": {PARAMETER: UNITLESS, **_RINGING},
}
FIND: Keys = {
    **EVERY,
    **plain("kind", "reason", "stable", "residual", "power_balance_error", "turn"),
    "units": _NAMES,
    "force": FORCE,
    "force_in": _FURTHER,
    **_REFERENCE,
    **dict.fromkeys(("frequency", "error", "solver_error", "time_error"), FREQUENCY),
    **_RATES,
    **_EXTENTS,
    "period": TIME,
    "trivial_rate": RATE,
    **plain("trivial_multiplier_error"),
    "errors": Named(UNITLESS),
    "sensitivities": _SENSITIVITIES,
}
_BRANCH: Keys = {
    **EVERY,
    **plain("reason", "residual", "parameter", "birth", "figure"),
    "onset": FORCE,
    "units": _NAMES,
    "points": {
        PARAMETER: UNITLESS,
        "frequency": FREQUENCY,
        **plain("stable"),
        **_RATES,
        **_EXTENTS,
    },
    "bifurcations": {
        PARAMETER: UNITLESS,
        **dict.fromkeys(("value", "error"), OF_PARAMETER),
        **plain("kind", "stability", "not_converged"),
        **_REFERENCE,
        "force_in": _FURTHER,
        **dict.fromkeys(("frequency", "second_frequency"), FREQUENCY),
    },
}
FOLLOW: Keys = {**_BRANCH, "branches": {**_BRANCH, **plain("kind")}}
_THRESHOLD: Keys = {
    **plain("threshold", "reason", "bifurcation"),
    **_REFERENCE,
    **dict.fromkeys(("value", "error", "solver_error", "searched_to"), FORCE),
    "force_in": _FURTHER,
    **dict.fromkeys(("frequency", "second_frequency"), FREQUENCY),
}
THRESHOLD: Keys = {
    **EVERY,
    **_THRESHOLD,
    "sensitivities": _SENSITIVITIES,
    **plain("parameter", "figure"),
    "units": _NAMES,
    "thresholds": {PARAMETER: UNITLESS, **_THRESHOLD},
}

#: Units of the target and of the slope depend on the question.
SOLVE: Keys = {
    **EVERY,
    **plain("kind", "quantity", "target", "parameter", "least", "most", "reason", "not_searched"),
    "between": OF_PARAMETER,
    "units": _NAMES,
    "solutions": {
        PARAMETER: UNITLESS,
        **dict.fromkeys(("value", "error", "solver_error"), OF_PARAMETER),
        **plain("slope", "stable", "bifurcation"),
        **_REFERENCE,
        **dict.fromkeys(("frequency", "second_frequency"), FREQUENCY),
        "force": FORCE,
        "force_in": _FURTHER,
        "leading_rate": RATE,
        **_EXTENTS,
    },
}

# ---------------------------------------------------------------- ramps

_BETWEEN: Keys = dict.fromkeys(("start", "end"), OF_PARAMETER)
_CHANGE: Keys = {**plain("direction", "before", "after"), **_BETWEEN}
RAMP: Keys = {
    **EVERY,
    **plain("parameter", "load", "missing", "store", "figure"),
    "units": _NAMES,
    "steps": {
        "value": OF_PARAMETER,
        **plain("direction", "status", "cause", "verdict", "reason", "planarity"),
        **plain("power_balance_error", "length_error", "steps", "seconds"),
        "time": TIME,
        **_FREQUENCIES,
        **_EXTENTS,
    },
    "regimes": {**plain("direction", "verdict", "steps"), **_BETWEEN},
    "changes": _CHANGE,
    "hysteresis": {**dict.fromkeys(("low", "high"), OF_PARAMETER), **plain("up", "down")},
    "thresholds": {**_THRESHOLD, "nearest_change": _CHANGE},
}

# ---------------------------------------------------------------- sweeps

SWEEP: Keys = {
    **EVERY,
    **plain("store", "load", "label", "keep", "policy", "tries", "seconds"),
    "units": _NAMES,
    "axes": {**plain("key", "count"), **dict.fromkeys(("first", "last"), OF_PARAMETER)},
    "points": plain("all", "done", "failed", "to_go"),
    "verdicts": Named(UNITLESS),
    "failures": {PARAMETER: UNITLESS, **plain("try", "reason")},
}
PLOT: Keys = {
    **EVERY,
    **plain("figure", "points", "done", "failed", "parameter"),
    "verdicts": Named(UNITLESS),
    **_REFERENCE,
    "borders": Named({PARAMETER: UNITLESS, "force": FORCE, "error": FORCE, **plain("reason")}),
    "at": {PARAMETER: UNITLESS},
    "disagreements": {PARAMETER: UNITLESS, **plain("try", "verdict", "sentence", "near")},
    "basins": {
        PARAMETER: UNITLESS,
        **plain("tries"),
        "verdicts": Named(plain("fraction", "low", "high")),
    },
}

# ---------------------------------------------------------------- others

MOVIE: Keys = {**EVERY, **plain("movie")}
UNITS: Keys = {
    **EVERY,
    "filament": plain("length_um", "stiffness_pn_um2", "viscosity_mpa_s", "slenderness"),
    "units": Named(plain("physical", "unit")),
    "converted": plain("quantity", "dimensionless", "physical", "unit"),
}
REPRODUCE: Keys = {
    **EVERY,
    **plain("report", "claims_file"),
    "claims": CLAIM,
    "verdicts": Named(UNITLESS),
    "items": plain("name", "title", "paper", "claims"),
}

_DIMENSIONLESS: Mapping[str, Keys] = {
    "run": RUN,
    "resume": RUN,
    "stability": STABILITY,
    "find": FIND,
    "follow": FOLLOW,
    "threshold": THRESHOLD,
    "solve": SOLVE,
    "step": RAMP,
    "sweep": SWEEP,
    "status": SWEEP,
    "plot": PLOT,
    "movie": MOVIE,
    "units": UNITS,
    "reproduce": REPRODUCE,
}
#: The keys of an answer, by the command.
ANSWERS: Mapping[str, Keys] = {
    command: with_physical(keys) for command, keys in _DIMENSIONLESS.items()
}
