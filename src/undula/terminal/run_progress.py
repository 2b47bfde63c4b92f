"""Progress of a run in words: reached time, step size, rate and remaining wall time."""

from undula.analysis.runs.progress import Progress

#: Wall time after which the rate is reliable, and wall time of an overlong run [s].
RELIABLE_AFTER, FAR_TOO_LONG = 10.0, 86400.0


def part_done(progress: Progress) -> float:
    """Return the fraction of a run that is done; a settling run may end at a smaller one."""
    return min(1.0, progress.time / progress.end)


def pace(progress: Progress, first: Progress, *, settling: bool) -> str:
    """Return the progress of a run in words.

    Parameters
    ----------
    progress
        Present state of the run.
    first
        State at the first report, after compilation.
    settling
        True for a run that ends when it has settled; its end time is then a limit.
    """
    most = "at most " if settling else ""
    words = f"t = {progress.time:.4g} of {most}{progress.end:.4g} T, step {progress.step:.1e} T"
    gained, spent = _since(first, progress)
    if gained <= 0.0 or spent <= 0.0:
        return words
    to_go = (progress.end - progress.time) * spent / gained
    return f"{words}, {gained / spent:.2g} T/s, {most}{duration(to_go)} to go"


def far_too_long(progress: Progress, first: Progress, *, settling: bool) -> str:
    """Return a sentence on a run that would take days at its rate; empty for other runs.

    Parameters are those of `pace`.
    """
    gained, spent = _since(first, progress)
    if spent < RELIABLE_AFTER:
        return ""
    cure = "Ctrl-C and --budget SECONDS stop it, and keep what there is"
    if gained <= 0.0:
        return f"the run does not get on: its steps are of {progress.step:.0e} T; {cure}"
    to_go = (progress.end - progress.time) * spent / gained
    if to_go < FAR_TOO_LONG:
        return ""
    most = "up to " if settling else ""
    rate = f"at this pace the run takes {most}{duration(to_go)} more, in steps of"
    return f"{rate} {progress.step:.0e} T; {cure}"


def _since(first: Progress, progress: Progress) -> tuple[float, float]:
    """Return the integrated time [T] and the wall time [s] since the first report."""
    return progress.time - first.time, progress.seconds - first.seconds


def duration(seconds: float) -> str:
    """Return a time span in the unit that suits it, such as ``3.2 s`` or ``12 min``."""
    for limit, unit, name in ((90.0, 1.0, "s"), (5400.0, 60.0, "min"), (2e5, 3600.0, "h")):
        if seconds < limit:
            return f"{seconds / unit:.2g} {name}"
    return f"{seconds / 86400.0:.2g} days"
