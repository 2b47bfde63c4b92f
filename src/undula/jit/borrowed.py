"""Arrays without reference counts, borrowed by compiled code for the duration of a call.

Compiled code counts the references to each array that it reads from a record, and frees the memory
with the last one. In the many small kernels of a step, counting takes a third of the time of the
arithmetic. A function that owns a record for a whole call can pass a borrowed record instead, whose
arrays have no count. The owner must outlive the call: compiled code drops a variable after its last
use, so an owner created in the same function has to be used once more after the call.
"""

from typing import Any, cast

from numba.core import cgutils, types
from numba.extending import intrinsic, overload

from undula.jit.compilation import RESOLVED


def borrowed(record: Any) -> Any:
    """Return a record without reference counts of its arrays.

    Parameters
    ----------
    record : typing.NamedTuple or ndarray
        The owner. Called from Python, it is returned as it is.

    Returns
    -------
    typing.NamedTuple or ndarray
        The same values in the same memory.
    """
    return record


def _uncounted(typing_context: Any, array: Any) -> Any:  # noqa: ARG001
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        uncounted = context.make_array(signature.return_type)(context, builder, arguments[0])
        uncounted.meminfo = cgutils.get_null_value(uncounted.meminfo.type)
        uncounted.parent = cgutils.get_null_value(uncounted.parent.type)
        return uncounted._getvalue()

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
