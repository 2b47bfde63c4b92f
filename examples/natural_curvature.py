"""A filament that is curved by nature: spinning askew, precessing, and beating to one side.

Question
--------
Ling, Guo & Kanso (2018) give a filament the natural curvature 2 pi about its first director, drop
the twist moment from their equations, and see three motions under tip forces of 100, 200 and 250:
spinning askew, flapping in a plane that goes round a fifth as fast, and flapping that is nearly
planar. Are these what the equations do, and where?

Answer
------
All three are there. At 100 the tip goes round once a cycle. The plane that goes round once in five
beats lives in a narrow range around 170 (with 40 links 174); at 200 and 250 the beat is to one side
of the axis and does not go round.

Run it with `python examples/natural_curvature.py [FIGURE.png [TWIST]]`; it takes half a minute.
TWIST is "paper", "rigid" or "elastic": the latter two keep the twist moment.
"""

import sys

import numpy as np

import undula as un

#: The paper's forces and 150; its precession is found at 169.
FORCES = {"paper": (100.0, 150.0, 169.0, 200.0, 250.0)}
OTHERS = (100.0, 150.0, 200.0, 250.0)
#: Time of a run, and from when on it is measured [T].
UNTIL, LATE = 1.2, 0.4


def main(figure: str = "natural_curvature.png", twist: str = "paper") -> None:
    """Run the filament under several forces, measure how the tip goes round, and draw it."""
    drawn, ratios = [], {}
    for force in FORCES.get(twist, OTHERS):
        model = un.Filament(
            20, un.TipLoad(force), natural_curvature=(2.0 * np.pi, 0.0), twist=twist
        )
        run = un.integrate(model, un.kicked(model, 0.1), until=UNTIL, samples=12000)
        late = run.motion.late(LATE)
        drift, beat = rounds(late), height_frequency(late)
        ratios[force] = abs(drift) / beat
        print(f"F = {force:3g}: {run.verdict.name}, {drift:.4g} turns and {beat:.4g} rises per T")
        short = run.motion.late(UNTIL - 24.0 / beat)
        drawn.append(
            un.views.TipAngleSeries(f"$F$ = {force:g}", short.time, short.nodes, 5.3 / beat)
        )
    un.views.winding_figure(drawn).savefig(figure)

    # Once a cycle; a fifth; and hardly at all: once in fifty cycles would be slow.
    if twist == "paper":
        assert abs(ratios[100.0] - 1.0) < 0.01
        assert abs(ratios[169.0] - 0.2) < 0.02
        assert max(ratios[200.0], ratios[250.0]) < 0.02


def rounds(motion) -> float:
    """Return the turns of the tip about the axis per T."""
    angle = un.observables.azimuth(motion.nodes)
    return (angle[-1] - angle[0]) / (2.0 * np.pi * (motion.time[-1] - motion.time[0]))


def height_frequency(motion) -> float:
    """Return the frequency of the strongest line of the tip's height [cycles per T]."""
    height = un.observables.tip_height(motion.nodes)
    strength = np.abs(np.fft.rfft((height - height.mean()) * np.hanning(height.size)))
    step = motion.time[1] - motion.time[0]
    return float(np.fft.rfftfreq(height.size, step)[np.argmax(strength)])


if __name__ == "__main__":
    main(*sys.argv[1:])
