"""Arrays that are lent to compiled code for the time of a call.

Compiled code counts the references to each array that it takes out of a record, so that the memory
is freed with the last one. In the many small kernels of a step this counting takes as long as a
third of the arithmetic. Whoever holds a record for the whole call can lend it: its arrays then have
no count. The owner must outlive the loan: compiled code drops what it does not use any more, so an
owner that was made in the same function has to be used once more after the call.
"""

from typing import Any, cast

from numba.core import cgutils, types
from numba.extending import intrinsic, overload

from undula.jit.compilation import RESOLVED


def borrowed(record: Any) -> Any:
    """Return a record (a `typing.NamedTuple`) whose arrays have no count; an array likewise."""
    return record


def _uncounted(typing_context: Any, array: Any) -> Any:  # noqa: ARG001
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        made = context.make_array(signature.return_type)(context, builder, arguments[0])
        made.meminfo = cgutils.get_null_value(made.meminfo.type)
        made.parent = cgutils.get_null_value(made.parent.type)
        return made._getvalue()

    return array(array), generate


_without_count: Any = intrinsic(_uncounted)


@overload(borrowed, strict=False, jit_options=RESOLVED)
def _borrowed(record: Any) -> Any:
    if isinstance(record, types.Array):
        return lambda record: _without_count(record)
    if isinstance(record, types.NamedTuple | types.NamedUniTuple):
        fields = ", ".join(f"borrowed(record.{name})" for name in record.fields)
        namespace = {"borrowed": borrowed, "Record": record.instance_class}
        exec(f"def rebuilt(record): return Record({fields})", namespace)
        return cast("Any", namespace["rebuilt"])
    return lambda record: record
