"""Digests of content, whatever file it is kept in: of plain JSON, and of named arrays."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

#: The key of the digest in an object of JSON that carries its own.
KEY = "sha256"


def digest_of(content: Any) -> str:
    """Return the SHA-256 of plain JSON types: of their one shortest text with sorted keys."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def digest_of_arrays(arrays: Mapping[str, npt.NDArray[Any]], about: Mapping[str, str]) -> str:
    """Return the SHA-256 of arrays with their names, types and shapes, and of what they are of."""
    told = [[name, array.dtype.str, array.shape] for name, array in sorted(arrays.items())]
    digest = hashlib.sha256(digest_of([told, dict(about)]).encode())
    for _, array in sorted(arrays.items()):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def sealed_json(content: Mapping[str, Any]) -> bytes:
    """Return the bytes of a file that holds an object of JSON and its digest."""
    sealed = {**content, KEY: digest_of(content)}
    return json.dumps(sealed, indent=1, allow_nan=False).encode()


def unsealed_json(image: bytes) -> dict[str, Any] | None:
    """Return the object of such a file, None if the file is damaged or carries no digest."""
    try:
        content = json.loads(image)
        if isinstance(content, dict) and content.pop(KEY, None) == digest_of(content):
            return content
    except (ValueError, RecursionError):
        pass
    return None
