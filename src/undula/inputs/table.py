"""Base of all tables of an input file: strict, frozen, and without idle keys.

Some keys have a meaning only for some values of another key, as ``load.slope`` for
``load.profile = "linear"``. A table lists them in ``only_with``. Such a key is an error where
nothing would use it, because a silently ignored setting gives a wrong result that looks right.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

IDLE_KEY = "idle_key"
CONFLICT = "conflict"


class OnlyWith(NamedTuple):
    """Condition for a key to have a meaning: the key `chooser` has one of `values`."""

    chooser: str
    values: tuple[str, ...]


class Table(BaseModel):
    """Base class of the tables of an input file.

    Types are strict: a whole number is valid as a float, and nothing else is converted. NaN,
    infinity and unknown keys are refused. Error messages quote the ``description`` of a field.

    Attributes
    ----------
    only_with
        Conditions of the keys that do not always have a meaning.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    only_with: ClassVar[Mapping[str, OnlyWith]] = {}

    @field_validator("*", mode="before")
    @classmethod
    def _has_a_meaning(cls, value: Any, info: ValidationInfo) -> Any:
        # Runs for given keys only: pydantic does not validate defaults.
        rule = cls.only_with.get(info.field_name or "")
        # Where the chooser itself has no meaning, the message has to name the chooser of that.
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
    """Return the error for keys that are valid by themselves but not together."""
    return PydanticCustomError(CONFLICT, "{sentence}", {"sentence": sentence})
