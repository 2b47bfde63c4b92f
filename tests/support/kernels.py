"""Compilation of the kernels that take longest before the tests, on all processors.

``python tests/support/kernels.py`` does so. Two processes of tests that need a kernel at the same
time would both compile it.
"""

import os
from concurrent.futures import ProcessPoolExecutor

import undula as un

LOAD = un.TipLoad(60.0)
#: One body of each kind of rod (see `undula.models.rod.tables`), those that take longest first.
BODIES = {
    "directed": un.Filament(4, LOAD, bending_ratio=2.0),
    "spatial": un.Filament(4, LOAD),
    "extensible": un.Filament(4, LOAD, inextensibility="weak"),
    "folding": un.Chain(4, LOAD),
    "unwrapped": un.Chain(4, LOAD, confined=True, spring="unwrapped"),
    "planar": un.Filament(4, LOAD, confined=True),
    "extensible planar": un.Filament(4, LOAD, inextensibility="weak", confined=True),
    "folding planar": un.Chain(4, LOAD, confined=True),
}
#: Those whose Lyapunov exponents are computed in tests that are not slow.
WITH_EXPONENTS = ("spatial",)


def run(name: str) -> None:
    """Compile what a run of a body takes."""
    body = BODIES[name]
    un.integrate(body, un.kicked(body), until=1e-4, samples=4)


def carry_changes(name: str) -> None:
    """Compile what the Lyapunov exponents of a body take."""
    body = BODIES[name]
    un.lyapunov(body, un.kicked(body), 1e-3)


def main() -> None:
    """Share the work out to as many processes as there are processors."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = [pool.submit(run, name) for name in BODIES]
        changes = [pool.submit(carry_changes, name) for name in WITH_EXPONENTS]
        for done in (*runs, *changes):
            done.result()


if __name__ == "__main__":
    main()
