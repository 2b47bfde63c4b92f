"""The part of a curve that was searched for a target, in numbers and in words."""

from dataclasses import dataclass

from undula.analysis.solvers.inverse.targets import Target


@dataclass(frozen=True)
class Searched:
    """Values of the parameter and of the quantity at the points of a curve that was searched.

    Attributes
    ----------
    values : tuple of float
        Values of the parameter.
    quantities : tuple of float
        Values of the quantity there.
    not_searched : str or None
        The part that could not be searched, and why, in words; None without such a part.
    """

    values: tuple[float, ...]
    quantities: tuple[float, ...]
    not_searched: str | None = None

    @property
    def quantity_range(self) -> tuple[float, float] | None:
        """Least and largest value of the quantity; None without a point."""
        return (min(self.quantities), max(self.quantities)) if self.quantities else None

    def reason(self, target: Target, parameter: str) -> str:
        """Return why the target is not met, in a sentence with the cure."""
        if not self.quantities:
            return self.not_searched or "the search was stopped before its first point"
        low, high = min(self.values), max(self.values)
        least, most = min(self.quantities), max(self.quantities)
        further = "" if self.not_searched is None else f"; {self.not_searched}"
        return (
            f"{target.kind} between {parameter} {low:.6g} and {high:.6g} has {target.quantity}"
            f" {least:.6g} to {most:.6g} at {len(self.values)} points{further}; give a target in"
            " between, or another range"
        )
