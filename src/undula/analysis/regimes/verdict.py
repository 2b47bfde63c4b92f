"""Verdict on a run: name, reason, evidence and margin."""

from __future__ import annotations

from dataclasses import dataclass

from undula.analysis.regimes.late_window import LateWindow

#: Names of the straight equilibrium, and of a motion that is not classified.
STRAIGHT, UNDECIDED = "straight", "undecided"
#: Largest margin of a verdict.
MAX_MARGIN = 100.0


@dataclass(frozen=True)
class Verdict:
    """Classification of the final motion of a run.

    Attributes
    ----------
    name
        ``straight``, ``undecided``, ``chaotic`` or one of `undula.analysis.regimes.names`.
    reason
        The evidence for the name, or the reason why the run is undecided, in one sentence.
    evidence
        Measured numbers by name; shares are relative, the others in units of L, T and B.
    window_start
        Start of the window that was classified [T].
    margin
        Factor by which the criteria of the name are met, from 1 to 100; 0 if undecided.
    longer
        Time that an undecided run lacks, roughly [T]; None if a longer run does not help.
    late
        The late window of an irregular motion, which waits for its Lyapunov exponents.
    """

    name: str
    reason: str
    evidence: dict[str, float]
    window_start: float
    margin: float = 0.0
    longer: float | None = None
    late: LateWindow | None = None
