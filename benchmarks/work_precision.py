"""Error against time for every contender: flapping at F = 200, 40 segments, five beats.

Run with `make bench`, or `python benchmarks/work_precision.py [--quick]`. Writes
docs/img/work-precision.png and benchmarks/results/work-precision.json. Of each time the shortest of
several in turn counts.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one thread for everybody
os.environ.setdefault("OMP_NUM_THREADS", "1")

import math
import sys
from collections.abc import Iterable
from dataclasses import asdict

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contenders import page, push
from contenders.windows import OURS, Timed, names, once
from undula.views.common import style

QUICK = "--quick" in sys.argv
MOTION, SEGMENTS, PERIODS = "flapping", 40, 5
TOLERANCES = tuple(10.0 ** (-0.5 * k) for k in range(5, 13 if QUICK else 14))
#: A contender gets no tighter tolerance once it takes so long, and longer than before; only every
#: other one once it takes so long [s]; and how often all are run.
LONGEST, LONG, REPEATED = (0.5, 0.5, 1) if QUICK else (6.0, 1.0, 3)
#: Seconds that further runs of the same may take together.
TOGETHER = 0.5
#: What comes last, as it takes most of the time.
SLOW = ("numpy", "Radau")
WANTED = page.PAGE.parent / "img" / "work-precision.png"
LOOKS = {
    "scipy BDF": style.X_COLOUR,
    "scipy Radau": style.Z_COLOUR,
    "scipy LSODA": style.ACTIVE_COLOUR,
    "scipy odeint": "#CC79A7",
    "CVODE": "#56B4E9",
    "undula": style.Y_COLOUR,
}
DASHES = {"numpy": ":", "compiled": "-.", "sparsity": "--", "band": "--", "dense": "-."}


def measured() -> dict[str, list[Timed]]:
    """Run all contenders at all tolerances; those that are quick once more, in turn."""
    found: dict[str, list[Timed]] = {name: [] for name in names()}
    for name in sorted(found, key=lambda name: any(word in name for word in SLOW)):
        runs, k = found[name], 0
        while k < len(TOLERANCES) and not _slower_and_slower(runs):
            runs.append(once(name, MOTION, SEGMENTS, PERIODS, TOLERANCES[k]))
            k += 2 if LONG < runs[-1].best < math.inf else 1
        keep(found, None)
    for _ in range(REPEATED - 1):
        for name, runs in found.items():
            for run in runs:
                if sum(run.seconds) + run.best < TOGETHER:
                    run.seconds += once(name, MOTION, SEGMENTS, PERIODS, run.rtol).seconds
    return found


def keep(found: dict[str, list[Timed]], pushed: tuple[float, float] | None) -> None:
    """Store what there is, so that a run that is stopped was not in vain."""
    results = {name: [asdict(run) for run in runs] for name, runs in found.items()}
    name = "work-precision-quick" if QUICK else "work-precision"
    page.keep(name, {**results, "PyElastica": pushed, "machine": page.machine()})


def _slower_and_slower(runs: list[Timed]) -> bool:
    # A loose tolerance may be slower than the next.
    last = [run.best for run in runs if run.best < math.inf][-2:]
    return len(last) == 2 and last[1] > max(LONGEST, last[0])


def draw(found: dict[str, list[Timed]], pushed: tuple[float, float] | None) -> Figure:
    """Draw errors against times, log-log."""
    with style.figure_style():
        figure = Figure(figsize=(10.0, 5.2))
        axes = figure.subplots(1, 2, sharex=True)
        for ax, what in zip(axes, ("frequency_error", "tip_error"), strict=True):
            for name, runs in found.items():
                _line(ax, name, runs, what)
            ax.set(xscale="log", yscale="log", xlabel="processor time of five beats  [s]")
            ax.margins(0.03)
            ax.grid(color=style.GROUND, linewidth=0.8)
        if pushed:
            axes[0].plot(
                *pushed,
                marker="*",
                markersize=9,
                linestyle="",
                color=style.INK,
                label="PyElastica, extrapolated; error by inertia",
            )
        axes[0].set_ylabel("relative error of the frequency")
        axes[1].set_ylabel(r"largest error of the tip  $[L]$")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="lower center", ncols=3, fontsize=7.5, handlelength=2.6)
        figure.subplots_adjust(left=0.07, right=0.985, top=0.97, bottom=0.36, wspace=0.2)
    return figure


def _line(ax: Axes, name: str, runs: Iterable[Timed], what: str) -> None:
    colour = next(colour for start, colour in LOOKS.items() if name.startswith(start))
    shown = [run for run in runs if getattr(run, what) < 0.3]
    last = name.rpartition(", ")[2]
    dashes = {"lab frame": "-", "co-rotating": "--", "as it comes": ":"} | DASHES
    ax.plot(
        [run.best for run in shown],
        [getattr(run, what) for run in shown],
        marker="o",
        markersize=2.6 if name in OURS else 2.0,
        linewidth=1.8 if name in OURS else 1.0,
        linestyle=dashes.get(last, "-"),
        color=colour,
        label=name,
    )


def main() -> None:
    """Measure, draw, and keep."""
    found = measured()
    pushed = None
    if not QUICK:
        inertia = abs(push.accuracy(MOTION).inertia) * push.MASS
        pushed = push.pushed(MOTION, SEGMENTS, PERIODS).window, inertia
    keep(found, pushed)
    target = page.RESULTS / WANTED.name if QUICK else WANTED
    draw(found, pushed).savefig(target, dpi=115, pil_kwargs={"optimize": True})
    if not QUICK:
        page.write("figure", f"![Errors against time]({WANTED.parent.name}/{WANTED.name})")
    print(f"{target}: {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
