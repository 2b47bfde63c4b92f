"""Whether the tables of a linked rod fit one another and a vector of unknowns."""

from typing import Any

from undula.jit.compilation import kernel
from undula.models.rod.tables import RODS, DirectedRod
from undula.numerics.integration.system import belongs, implements

__all__ = ["belongs"]


def _register(rod: Any) -> None:
    m = rod.stride

    @kernel
    def tables_belong(system: Any, n: Any) -> Any:
        links = system.joint.shape[0]
        alike = (
            system.weight.shape[0]
            == system.outer_force.shape[0]
            == system.inner_force.shape[0]
            == links
        )
        return 0 < m * links == n and alike

    @kernel
    def directors_belong(system: Any, n: Any) -> Any:
        own = 8 * system.natural.shape[0] == n and system.natural.shape[1] == 2
        return tables_belong(system, n) and own and system.tip.shape[0] == 3

    implements(belongs, rod)(directors_belong if rod is DirectedRod else tables_belong)


for _rod in RODS:
    _register(_rod)
