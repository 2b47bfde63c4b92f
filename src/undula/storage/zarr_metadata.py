"""What a store says of itself, held against its digest and read before Zarr sees any of it.

Zarr looks up codecs by the names that a store gives, and some run code: only those that undula and
xarray write are let through. The second format of Zarr keeps the metadata twice, in one file and in
one of each array, and either will do.
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

#: The attribute of the root that holds the digest, and the names of the arrays that it is of.
DIGEST, ARRAYS = "undula_digest", "undula_arrays"
#: The attributes of the root that the digest is of: others may be added.
ATTRIBUTES = ("study", "versions", "software", "units", "load", "undula_format")
_GROUP, _ATTRIBUTES, _ARRAY, _ALL = ".zgroup", ".zattrs", ".zarray", ".zmetadata"
_THIRD = "zarr.json"
_NAMES = (_GROUP, _ATTRIBUTES, _ARRAY, _ALL, _THIRD)
_CODECS = {"blosc", "zstd", "crc32", "vlen-utf8"}
_CODECS_OF_THIRD = {"bytes", "blosc", "zstd", "crc32c", "vlen-utf8"}
_TYPES = re.compile(r"[<|][fi][1248]|\|b1|<U\d{1,4}|\|O")
_TYPES_OF_THIRD = {"float64", "int64", "int32", "int8", "bool", "string", "fixed_length_utf32"}

Content = Mapping[str, Any]


@dataclass(frozen=True)
class Metadata:
    """The metadata of a store.

    Attributes
    ----------
    content
        By the names of their files, as JSON.
    format
        Of Zarr.
    checked
        Whether the content is known to be what undula wrote.
    """

    content: Content
    format: Literal[2, 3]
    checked: bool

    @property
    def files(self) -> dict[str, bytes]:
        """The files that say the same."""
        files = {name: json.dumps(told, indent=2).encode() for name, told in self.content.items()}
        if self.format == 2:
            together = {"metadata": self.content, "zarr_consolidated_format": 1}
            files[_ALL] = json.dumps(together, indent=2).encode()
        return files

    @property
    def attributes(self) -> Mapping[str, Any]:
        """The attributes of the root."""
        if self.format == 3:
            return self.content[_THIRD].get("attributes", {})  # type: ignore[no-any-return]
        return self.content.get(_ATTRIBUTES, {})  # type: ignore[no-any-return]

    def array(self, name: str) -> Mapping[str, Any]:
        """Return what is said of an array of the second format."""
        return self.content[f"{name}/{_ARRAY}"]  # type: ignore[no-any-return]

    def dims(self, name: str) -> tuple[str, ...]:
        """Return the names of the dimensions of an array of the second format."""
        return tuple(self.content[f"{name}/{_ATTRIBUTES}"]["_ARRAY_DIMENSIONS"])


def is_metadata(key: str) -> bool:
    """Tell whether a file of a store holds metadata, by its name."""
    return key.rsplit("/", 1)[-1] in _NAMES


def is_store(path: Path) -> bool:
    """Tell whether there is a store in a place, whatever it holds."""
    return any((path / name).is_file() for name in (_GROUP, _ALL, _THIRD))


def seal_of(content: Content) -> dict[str, Any]:
    """Return the attributes of the root that seal the metadata of a new store."""
    names = sorted(key.removesuffix(f"/{_ARRAY}") for key in content if key.endswith(_ARRAY))
    return {ARRAYS: names, DIGEST: _digest(content, names)}


def read_metadata(path: Path) -> Metadata:
    """Return the metadata of a store.

    Raises
    ------
    InputError
        They are damaged, or name what undula does not write, or this is no store.
    """
    if (path / _THIRD).exists():
        return _checked_codecs(path, Metadata(_third(path), 3, checked=False))
    copies = [copy for copy in (_together(path), single_files(path)) if _is_group(copy)]
    sealed = [copy for copy in copies if _is_sealed(copy)]
    if not copies:
        raise _no_store(path)
    if not sealed and any(DIGEST in copy.get(_ATTRIBUTES, {}) for copy in copies):
        raise InputError(
            f"what {path} says of itself is damaged; take the files {_ALL} and {_ATTRIBUTES} from a"
            " copy, or make the study again with undula sweep and another --out"
        )
    return _checked_codecs(path, Metadata((sealed or copies)[0], 2, checked=bool(sealed)))


def mend_metadata(path: Path, metadata: Metadata) -> None:
    """Write anew whichever of the two copies of a store's metadata is damaged.

    Raises
    ------
    InputError
        The folder cannot be written or is full.
    """
    whole = {True: _is_sealed(_together(path)), False: _is_sealed(single_files(path))}
    for name, image in metadata.files.items():
        if not whole[name == _ALL]:
            write_whole(path / name, image, overwrite=True)


def single_files(path: Path) -> dict[str, Any]:
    """Return the metadata that are in one file of each array, as far as they can be read."""
    places = (path, *(place for place in sorted(path.glob("*")) if (place / _ARRAY).exists()))
    files = [place / name for place in places for name in (_GROUP, _ATTRIBUTES, _ARRAY)]
    read = {file.relative_to(path).as_posix(): _json(file) for file in files if file.is_file()}
    return {key: told for key, told in read.items() if told is not None}


def _together(path: Path) -> dict[str, Any]:
    told = _json(path / _ALL)
    content = told.get("metadata") if told else None
    return content if isinstance(content, dict) else {}


def _third(path: Path) -> dict[str, Any]:
    files = [path / _THIRD, *sorted(path.glob(f"*/{_THIRD}"))]
    read = {file.relative_to(path).as_posix(): _json(file) for file in files}
    if read[_THIRD] is None:
        raise _no_store(path)
    return {key: told for key, told in read.items() if told is not None}


def _no_store(path: Path) -> InputError:
    return InputError(f"{path} is no stored study or result; give a folder that undula sweep made")


def _json(file: Path) -> dict[str, Any] | None:
    try:
        told = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    return told if isinstance(told, dict) else None


def _is_group(content: Content) -> bool:
    return _GROUP in content and all(isinstance(told, dict) for told in content.values())


def _is_sealed(content: Content) -> bool:
    attributes = content.get(_ATTRIBUTES, {})
    names = attributes.get(ARRAYS)
    return isinstance(names, list) and attributes.get(DIGEST) == _digest(content, names)


def _digest(content: Content, names: list[Any]) -> str:
    own = {name: content.get(_ATTRIBUTES, {}).get(name) for name in ATTRIBUTES}
    arrays = [[content.get(f"{name}/{one}") for one in (_ARRAY, _ATTRIBUTES)] for name in names]
    return digest_of([own, names, arrays])


def _checked_codecs(path: Path, metadata: Metadata) -> Metadata:
    for found in _strange(metadata):
        raise InputError(
            f"{path} asks for {found}, which undula does not write and does not run; give a folder"
            " that undula sweep made"
        )
    return metadata


def _strange(metadata: Metadata) -> Iterator[str]:
    """Yield the types and codecs that are not let through."""
    told = list(metadata.content.values())
    if metadata.format == 3:
        # Those of all arrays may stand in the file of the group as well.
        inside = [one.get("consolidated_metadata") or {} for one in told]
        told = [*told, *(each for one in inside for each in one.get("metadata", {}).values())]
    for one in told:
        if metadata.format == 2 and "dtype" in one:
            codecs = [*(one.get("filters") or ()), *filter(None, [one.get("compressor")])]
            yield from _not_in(_CODECS, "the codec", [_name(each, "id") for each in codecs])
            if not _TYPES.fullmatch(str(one["dtype"])):
                yield f"the type {one['dtype']!r}"
        elif metadata.format == 3 and one.get("node_type") == "array":
            yield from _not_in(
                _CODECS_OF_THIRD,
                "the codec",
                [
                    _name(each, "name")
                    for part in ("codecs", "storage_transformers")
                    for each in one.get(part) or ()
                ],
            )
            yield from _not_in(_TYPES_OF_THIRD, "the type", [_name(one.get("data_type"), "name")])


def _not_in(known: set[str], kind: str, names: list[str]) -> Iterator[str]:
    yield from (f"{kind} {name!r}" for name in names if name not in known)


def _name(told: Any, key: str) -> str:
    return str(told.get(key)) if isinstance(told, dict) else str(told)
