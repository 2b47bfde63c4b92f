"""Chains of two and three links: how fast they spin and beat, and where the beats end.

Question
--------
Ling, Guo & Kanso (2018) set the frequencies of chains of two and three links beside those of the
straight chain's leading disturbance, and find spinning faster than planar flapping throughout. Is
it, and how far do the motions go?

Answer
------
Both begin with the linear frequency, and spinning is the faster one from there on. Two links beat
the more slowly the harder they are pushed. Beats are unstable out of their plane, and end where a
joint folds; spinning goes on, with two links stably.

Run it with `python examples/two_and_three_links.py [FIGURE.png]`; it takes some ten seconds.
"""

import sys

import numpy as np

import undula as un

FARTHEST = 30.0


def main(figure: str = "two_and_three_links.png") -> None:
    """Follow both motions of both chains, compare them, and draw them."""
    branches, linear = [], []
    for links in (2, 3):
        model = un.Chain(links, un.TipLoad(1.0))
        onset = un.onset(model)
        spinning = un.follow_from_onset(model, "spinning", FARTHEST)
        flapping = un.follow_from_onset(model, "flapping", FARTHEST)
        branches += [spinning, flapping]
        linear.append(un.growth_curve(model, np.linspace(onset.oscillatory_force, 14.0, 400)))

        # How much slower beats are, at the forces at which they were found.
        frequencies = [state.frequency for state in flapping.states]
        turns = np.interp(
            flapping.values, spinning.values, [state.frequency for state in spinning.states]
        )
        slower = 1.0 - np.array(frequencies) / turns
        end = flapping.values[-1]
        print(f"{links} links: onset {onset.force:.6g} K/L, {onset.frequency:.6g} cycles per T")
        print(f"  beats end at {end:.4g} K/L, {100.0 * slower[-1]:.0f} per cent slower than turns")

        assert np.all(slower > 0.0)
        assert abs(frequencies[0] / onset.frequency - 1.0) < 0.01
        assert all(state.stable for state in spinning.states)
        assert not any(state.stable for state in flapping.states)

    title = "chains of two (1) and three links (2); dotted: the straight state's disturbance"
    drawn = un.views.bifurcation_diagram(branches, title=title)
    for curve in linear:
        swinging = curve.frequencies > 0.0
        drawn.axes[0].plot(curve.forces[swinging], curve.frequencies[swinging], "k:", lw=1.2)
    drawn.savefig(figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
