"""The paper's second transition, from spinning to flapping, resolved.

Question
--------
Ling, Guo & Kanso (2018) see a filament under a tip load spin below F = 188 and flap in a plane
beyond. What happens in between, and why?

Answer
------
Spinning is lost and planar flapping is gained at two different forces. Between them both are
stable, and the motion that parts them is solved for as well: a spinning whose shape changes, which
is born where flapping changes its stability and dies where spinning does.

Run it with `python examples/second_transition.py [FIGURE.png]`; it takes half a minute.
"""

import sys

import undula as un

SEGMENTS = 20


def main(figure: str = "second_transition.png") -> None:
    """Follow the three branches, tell where they change stability, and draw them."""
    model = un.Filament(SEGMENTS, un.TipLoad(60.0))
    spinning = un.follow(un.find(model, "spinning"), "load.force", 230.0)
    flapping = un.follow(un.find(model, "flapping"), "load.force", 230.0)
    (lost,) = (one for one in spinning.bifurcations if one.loses)
    (gained,) = (one for one in flapping.bifurcations if one.gains)
    between = un.follow_from_bifurcation(gained, 1.02 * lost.value)

    print(f"flapping is gained at F = {gained.value:.6g}, {gained.kind}")
    print(f"spinning is lost at   F = {lost.value:.6g}, {lost.kind}")
    (fold,) = (one for one in between.bifurcations if one.kind == "fold")
    print(f"what parts them lives from {between.values[0]:.6g} to {fold.value:.6g}, unstable")

    # The last one lies on the first two where it is born and where it dies.
    assert abs(fold.value - lost.value) < 1e-3
    title = f"tip load, {SEGMENTS} segments"
    un.views.bifurcation_diagram([spinning, flapping, between], title=title).savefig(figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
