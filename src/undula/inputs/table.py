"""What all tables of an input file have in common: strict, frozen, and no idle keys.

Some keys have a meaning only for one choice of another key, as ``load.slope`` has for
``load.profile = "linear"``. A table lists them in ``only_with``; giving such a key where
nothing would read it is an error, because a setting that is silently ignored is a wrong
result that looks right.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

IDLE_KEY = "idle_key"
CONFLICT = "conflict"


class OnlyWith(NamedTuple):
    """The choice that gives a key its meaning: `chooser` must have one of `values`."""

    chooser: str
    values: tuple[str, ...]


class Table(BaseModel):
    """One table of the input file.

    Types are taken strictly (a whole number may stand for a float, nothing else is converted),
    NaN and infinity are refused, and so is any key that the table does not know. The
    ``description`` of each field says what the key takes; error messages quote it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    only_with: ClassVar[Mapping[str, OnlyWith]] = {}

    @field_validator("*", mode="before")
    @classmethod
    def _has_a_meaning(cls, value: Any, info: ValidationInfo) -> Any:
        # Runs for given keys only: pydantic does not validate defaults.
        rule = cls.only_with.get(info.field_name or "")
        # Where the chooser itself has no meaning, choosing otherwise there would not help.
        while rule is not None and rule.chooser in info.data:
            chosen = info.data[rule.chooser]
            outer = cls.only_with.get(rule.chooser)
            if outer is None or info.data.get(outer.chooser) in outer.values:
                break
            rule = outer
        else:
            return value
        if chosen in rule.values:
            return value
        context = {"chooser": rule.chooser, "chosen": chosen, "values": rule.values}
        raise PydanticCustomError(IDLE_KEY, "has no meaning here", context)

    def dump(self) -> dict[str, Any]:
        """Return the keys that have a meaning, with their resolved values, as plain JSON types."""
        return {key: value for key, value in self.model_dump().items() if self._is_used(key, value)}

    def _is_used(self, key: str, value: Any) -> bool:
        rule = self.only_with.get(key)
        return value is not None and (rule is None or getattr(self, rule.chooser) in rule.values)


def conflict(sentence: str) -> PydanticCustomError:
    """Return the error for keys that are each right but do not go together."""
    return PydanticCustomError(CONFLICT, "{sentence}", {"sentence": sentence})
