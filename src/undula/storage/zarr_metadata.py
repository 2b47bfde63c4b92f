"""Metadata of a store, checked against their digest before Zarr reads them.

Zarr looks up codecs by the names in the metadata, and some codecs run code: only those that undula
and xarray write are allowed. undula writes Zarr's format 2, which stores the metadata twice: in one
consolidated file, and in single files of the group and of each array. One valid copy is enough.
Format 3 is read only: other software may have stored a copy in it.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from undula.errors import InputError
from undula.storage.atomic import write_whole
from undula.storage.digests import digest_of

#: Attributes of the root that hold the digest, and the names of the arrays that it covers.
DIGEST, ARRAYS = "undula_digest", "undula_arrays"
#: Attributes of the root that the digest covers; others may be added.
ATTRIBUTES = ("study", "versions", "software", "units", "load", "undula_format")
#: Metadata files of format 2, the last one consolidated, and of format 3.
_GROUP, _ATTRIBUTES, _ARRAY, _CONSOLIDATED = ".zgroup", ".zattrs", ".zarray", ".zmetadata"
_FORMAT_3 = "zarr.json"
_NAMES = (_GROUP, _ATTRIBUTES, _ARRAY, _CONSOLIDATED, _FORMAT_3)
_CODECS = {"blosc", "zstd", "crc32", "vlen-utf8"}
_CODECS_OF_FORMAT_3 = {"bytes", "blosc", "zstd", "crc32c", "vlen-utf8"}
_TYPES = re.compile(r"[<|][fi][1248]|\|b1|<U\d{1,4}|\|O")
_TYPES_OF_FORMAT_3 = {"float64", "int64", "int32", "int8", "bool", "string", "fixed_length_utf32"}

Content = Mapping[str, Any]


@dataclass(frozen=True)
class Metadata:
    """The metadata of a store.

    Attributes
    ----------
    content
        Parsed JSON by the names of the files.
    format
        Format of Zarr, 2 or 3.
    checked
        True if the digest shows that undula wrote the content.
    """

    content: Content
    format: Literal[2, 3]
    checked: bool

    @property
    def files(self) -> dict[str, bytes]:
        """Bytes of the metadata files, by name."""
        files = {name: json.dumps(part, indent=2).encode() for name, part in self.content.items()}
        if self.format == 2:
            together = {"metadata": self.content, "zarr_consolidated_format": 1}
            files[_CONSOLIDATED] = json.dumps(together, indent=2).encode()
        return files

    @property
    def attributes(self) -> Mapping[str, Any]:
        """The attributes of the root."""
        if self.format == 3:
            return self.content[_FORMAT_3].get("attributes", {})  # type: ignore[no-any-return]
        return self.content.get(_ATTRIBUTES, {})  # type: ignore[no-any-return]

    def array(self, name: str) -> Mapping[str, Any]:
        """Return the metadata of an array, for format 2."""
        return self.content[f"{name}/{_ARRAY}"]  # type: ignore[no-any-return]

    def dims(self, name: str) -> tuple[str, ...]:
        """Return the names of the dimensions of an array, for format 2."""
        return tuple(self.content[f"{name}/{_ATTRIBUTES}"]["_ARRAY_DIMENSIONS"])


def is_metadata(key: str) -> bool:
    """Return True if a file of a store holds metadata, judging by its name."""
    return key.rsplit("/", 1)[-1] in _NAMES


def is_store(path: Path) -> bool:
    """Return True if a folder is a store of any content."""
    return any((path / name).is_file() for name in (_GROUP, _CONSOLIDATED, _FORMAT_3))


def seal_of(content: Content) -> dict[str, Any]:
    """Return the names and the digest to be added to the root attributes of a new store."""
    names = sorted(key.removesuffix(f"/{_ARRAY}") for key in content if key.endswith(_ARRAY))
    return {ARRAYS: names, DIGEST: _digest(content, names)}


def read_metadata(path: Path) -> Metadata:
    """Return the metadata of a store.

    Raises
    ------
    InputError
        The metadata are damaged or name a type or codec that undula does not write, or the folder
        is not a store.
    """
    if (path / _FORMAT_3).exists():
        return _checked_codecs(path, Metadata(_format_3_files(path), 3, checked=False))
    copies = [copy for copy in (_consolidated(path), single_files(path)) if _is_group(copy)]
    sealed = [copy for copy in copies if _is_sealed(copy)]
    if not copies:
        raise _no_store(path)
    if not sealed and any(DIGEST in copy.get(_ATTRIBUTES, {}) for copy in copies):
        raise InputError(
            f"what {path} says of itself is damaged; take the files {_CONSOLIDATED} and"
            f" {_ATTRIBUTES} from a copy, or make the study again with undula sweep and another"
            " --out"
        )
    return _checked_codecs(path, Metadata((sealed or copies)[0], 2, checked=bool(sealed)))


def mend_metadata(path: Path, metadata: Metadata) -> None:
    """Write a damaged copy of a store's metadata again from the valid one.

    Parameters
    ----------
    path
        Folder of the store.
    metadata
        Its metadata, from a valid copy.

    Raises
    ------
    InputError
        The folder cannot be written or is full.
    """
    consolidated_is_valid = _is_sealed(_consolidated(path))
    singles_are_valid = _is_sealed(single_files(path))
    for name, image in metadata.files.items():
        if not (consolidated_is_valid if name == _CONSOLIDATED else singles_are_valid):
            write_whole(path / name, image, overwrite=True)


def single_files(path: Path) -> dict[str, Any]:
    """Return the metadata in the single files of group and arrays, as far as they can be read."""
    places = (path, *(place for place in sorted(path.glob("*")) if (place / _ARRAY).exists()))
    files = [place / name for place in places for name in (_GROUP, _ATTRIBUTES, _ARRAY)]
    read = {file.relative_to(path).as_posix(): _json(file) for file in files if file.is_file()}
    return {key: part for key, part in read.items() if part is not None}


def _consolidated(path: Path) -> dict[str, Any]:
    """Return the metadata in the consolidated file; empty if it cannot be read."""
    whole = _json(path / _CONSOLIDATED)
    content = whole.get("metadata") if whole else None
    return content if isinstance(content, dict) else {}


def _format_3_files(path: Path) -> dict[str, Any]:
    """Return the metadata in the files of format 3, as far as they can be read."""
    files = [path / _FORMAT_3, *sorted(path.glob(f"*/{_FORMAT_3}"))]
    read = {file.relative_to(path).as_posix(): _json(file) for file in files}
    if read[_FORMAT_3] is None:
        raise _no_store(path)
    return {key: part for key, part in read.items() if part is not None}


def _no_store(path: Path) -> InputError:
    return InputError(f"{path} is no stored study or result; give a folder that undula sweep made")


def _json(file: Path) -> dict[str, Any] | None:
    try:
        content = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    return content if isinstance(content, dict) else None


def _is_group(content: Content) -> bool:
    return _GROUP in content and all(isinstance(part, dict) for part in content.values())


def _is_sealed(content: Content) -> bool:
    """Return True if the metadata carry their own digest."""
    attributes = content.get(_ATTRIBUTES, {})
    names = attributes.get(ARRAYS)
    return isinstance(names, list) and attributes.get(DIGEST) == _digest(content, names)


def _digest(content: Content, names: list[Any]) -> str:
    own = {name: content.get(_ATTRIBUTES, {}).get(name) for name in ATTRIBUTES}
    arrays = [[content.get(f"{name}/{file}") for file in (_ARRAY, _ATTRIBUTES)] for name in names]
    return digest_of([own, names, arrays])


def _checked_codecs(path: Path, metadata: Metadata) -> Metadata:
    """Return the metadata; refuse types and codecs that undula does not write."""
    for name in _foreign(metadata):
        raise InputError(
            f"{path} asks for {name}, which undula does not write and does not run; give a folder"
            " that undula sweep made"
        )
    return metadata


def _foreign(metadata: Metadata) -> Iterator[str]:
    """Yield the types and codecs that are not allowed."""
    nodes = list(metadata.content.values())
    if metadata.format == 3:
        # The file of the group may hold the metadata of all arrays as well.
        groups = [node.get("consolidated_metadata") or {} for node in nodes]
        nodes += [array for group in groups for array in group.get("metadata", {}).values()]
    for node in nodes:
        if metadata.format == 2 and "dtype" in node:
            codecs = [*(node.get("filters") or ()), *filter(None, [node.get("compressor")])]
            yield from _not_in(_CODECS, "the codec", [_name(codec, "id") for codec in codecs])
            if not _TYPES.fullmatch(str(node["dtype"])):
                yield f"the type {node['dtype']!r}"
        elif metadata.format == 3 and node.get("node_type") == "array":
            yield from _not_in(
                _CODECS_OF_FORMAT_3,
                "the codec",
                [
                    _name(codec, "name")
                    for key in ("codecs", "storage_transformers")
                    for codec in node.get(key) or ()
                ],
            )
            yield from _not_in(
                _TYPES_OF_FORMAT_3, "the type", [_name(node.get("data_type"), "name")]
            )


def _not_in(allowed: set[str], kind: str, names: list[str]) -> Iterator[str]:
    yield from (f"{kind} {name!r}" for name in names if name not in allowed)


def _name(entry: Any, key: str) -> str:
    return str(entry.get(key)) if isinstance(entry, dict) else str(entry)
