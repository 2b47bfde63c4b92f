"""Where a run is, in words: time reached, length of the step, rate, time still to go."""

from undula.analysis.integrate import Progress


def part_done(progress: Progress) -> float:
    """Return the part of the run that is done, at least; a settling run may end sooner."""
    return min(1.0, progress.time / progress.end)


def pace(progress: Progress, first: Progress, *, settling: bool) -> str:
    """Tell where a run is.

    Parameters
    ----------
    progress
        What the run says of itself.
    first
        What it said when it was looked at first: compilation lies before that.
    settling
        Whether it ends as soon as it has settled, its end being a limit.
    """
    most = "at most " if settling else ""
    words = f"t = {progress.time:.4g} of {most}{progress.end:.4g} T, step {progress.step:.1e} T"
    gained, spent = progress.time - first.time, progress.seconds - first.seconds
    if gained <= 0.0 or spent <= 0.0:
        return words
    to_go = (progress.end - progress.time) * spent / gained
    return f"{words}, {gained / spent:.2g} T/s, {most}{duration(to_go)} to go"


def duration(seconds: float) -> str:
    """Return a time span in the unit that suits it, such as ``3.2 s`` or ``12 min``."""
    for limit, unit, name in ((90.0, 1.0, "s"), (5400.0, 60.0, "min"), (2e5, 3600.0, "h")):
        if seconds < limit:
            return f"{seconds / unit:.2g} {name}"
    return f"{seconds / 86400.0:.2g} days"
