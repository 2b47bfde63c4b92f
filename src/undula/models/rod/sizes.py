"""Check that the tables of a linked rod fit one another and a vector of unknowns."""

from typing import Any

from undula.jit.compilation import kernel
from undula.models.rod.tables import RODS, DirectedRod
from undula.numerics.integration.system import implements, sizes_match

__all__ = ["sizes_match"]


def _register(rod: Any) -> None:
    m = rod.stride

    @kernel
    def tables_match(system: Any, n: Any) -> Any:
        links = system.joint.shape[0]
        equal_sizes = (
            system.weight.shape[0]
            == system.outer_force.shape[0]
            == system.inner_force.shape[0]
            == links
        )
        return 0 < m * links == n and equal_sizes

    @kernel
    def directors_match(system: Any, n: Any) -> Any:
        own = 8 * system.natural.shape[0] == n and system.natural.shape[1] == 2
        return tables_match(system, n) and own and system.tip.shape[0] == 3

    implements(sizes_match, rod)(directors_match if rod is DirectedRod else tables_match)


for _rod in RODS:
    _register(_rod)
