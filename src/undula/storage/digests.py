"""Digests of content, independent of the file format: of plain JSON, and of named arrays."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

#: Key of the digest in a JSON object that carries its own digest.
KEY = "sha256"


def digest_of(content: Any) -> str:
    """Return the SHA-256 of plain JSON types, from their shortest text with sorted keys."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def digest_of_arrays(arrays: Mapping[str, npt.NDArray[Any]], about: Mapping[str, str]) -> str:
    """Return the SHA-256 of arrays with their names, types and shapes, and of further texts.

    Parameters
    ----------
    arrays
        The arrays by name.
    about
        Further texts by name, such as the input that the arrays belong to.
    """
    types = [[name, array.dtype.str, array.shape] for name, array in sorted(arrays.items())]
    digest = hashlib.sha256(digest_of([types, dict(about)]).encode())
    for _, array in sorted(arrays.items()):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def sealed_json(content: Mapping[str, Any]) -> bytes:
    """Return the bytes of a file that holds a JSON object and its digest."""
    sealed = {**content, KEY: digest_of(content)}
    return json.dumps(sealed, indent=1, allow_nan=False).encode()


def unsealed_json(image: bytes) -> dict[str, Any] | None:
    """Return the object of a file by `sealed_json`, None if it is damaged or has no digest."""
    try:
        content = json.loads(image)
        if isinstance(content, dict) and content.pop(KEY, None) == digest_of(content):
            return content
    except (ValueError, RecursionError):
        pass
    return None
