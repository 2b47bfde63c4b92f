"""What a file holds, as JSON that is compared: small values as they are, arrays by their digests.

Files are read by general libraries, not by the package, whose readers may change places.
"""

import base64
import hashlib
import io
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import imageio_ffmpeg
import numpy as np
import zarr
from normal import steady, steady_lines, steady_value
from PIL import Image

#: Attributes in which HDF5 and NetCDF keep their own books.
_BOOKS = re.compile(r"DIMENSION_LIST|REFERENCE_LIST|CLASS|NAME|_Netcdf4.*|_NCProperties")
_IMAGE = re.compile(r"data:image/png;base64,([A-Za-z0-9+/=]+)")
_PACKED = re.compile(r"[A-Za-z0-9+/=]{400,}")
_CONTENT = re.compile(r'<script type="application/json" id="content">(.*?)</script>', re.DOTALL)
_SCRIPT = re.compile(r"<script>.*?</script>", re.DOTALL)
#: Longer than any script of ours: the plotting library.
_LIBRARY = 1_000_000
_CELLS = 8


def contents(folder: Path) -> dict[str, Any]:
    """Return what the files of a folder hold, by name; of those of unknown kinds, nothing."""
    found = {}
    for path in _files(folder):
        read = _READERS.get(path.suffix)
        name = steady(path.relative_to(folder).as_posix())
        found[name] = read(path) if read else None
    return found


def _files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.is_dir() and path.suffix != ".zarr":
            yield from _files(path)
        else:
            yield path
            if path.suffix == ".zarr":
                yield from sorted((*path.glob("borders.json"), *path.glob("runs/*.nc")))


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _array(values: Any) -> dict[str, Any]:
    """Return an array's type, shape and digest, with numbers that tell how far apart two are."""
    array = np.asarray(values)
    if array.dtype.kind in "OSU":
        texts = [one.decode() if isinstance(one, bytes) else str(one) for one in array.ravel()]
        return {"type": "text", "shape": list(array.shape), "digest": _digest(repr(texts).encode())}
    told = {"type": array.dtype.str, "shape": list(array.shape), "digest": _digest(array.tobytes())}
    if array.dtype.kind == "f" and np.isfinite(array).any():
        finite = array[np.isfinite(array)]
        told |= {name: float(getattr(finite, name)()) for name in ("min", "max", "sum")}
    return told


def _attributes(attributes: Any) -> dict[str, Any]:
    plain = {str(key): _plain(value) for key, value in attributes.items()}
    return {key: value for key, value in plain.items() if not _BOOKS.fullmatch(key)}


def _plain(value: Any) -> Any:
    """Return an attribute in JSON types; a text that is JSON as what it says."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist() if value.dtype.kind != "O" else [str(one) for one in value.ravel()]
    if isinstance(value, bytes):
        value = value.decode()
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(value)
        except ValueError:
            return value
    return value


def _netcdf(path: Path) -> Any:
    with h5py.File(path) as file:
        found: dict[str, Any] = {"attributes": _attributes(file.attrs)}

        def visit(name: str, item: Any) -> None:
            of = {"attributes": _attributes(item.attrs)}
            found[name] = of | (_array(item[()]) if isinstance(item, h5py.Dataset) else {})

        file.visititems(visit)
    return steady_value(found)


def _zarr(path: Path) -> Any:
    group = zarr.open_group(path, mode="r")
    found: dict[str, Any] = {"attributes": _attributes(dict(group.attrs))}
    for name, array in sorted(group.arrays()):
        found[name] = {"attributes": _attributes(dict(array.attrs)), **_array(array[...])}
    return steady_value(found)


def _picture(content: bytes) -> dict[str, Any]:
    """Return the digest of an image's pixels, and how dark each cell of a coarse grid is."""
    with Image.open(io.BytesIO(content)) as image:
        pixels = np.asarray(image.convert("RGBA"))
        grey = np.asarray(image.convert("L"), dtype=float)
    rows = (part.mean(axis=0) for part in np.array_split(grey, _CELLS))
    means = ([one.mean() for one in np.array_split(row, _CELLS)] for row in rows)
    cells = [" ".join(f"{one:.2f}" for one in row) for row in means]
    return {"size": list(pixels.shape), "digest": _digest(pixels.tobytes()), "grey": cells}


def _page(path: Path) -> Any:
    """Return what a page holds, without the plotting library; images by their pixels."""
    text = path.read_text("utf-8")
    content = _CONTENT.search(text)
    if content:
        rest = _SCRIPT.sub(lambda one: "" if len(one[0]) > _LIBRARY else one[0], text)
        frame = _CONTENT.sub("", rest)
        return {"content": steady_value(json.loads(content[1])), "frame": steady_lines(frame)}
    text = _IMAGE.sub(lambda one: _picture(base64.b64decode(one[1]))["digest"], text)
    return steady_lines(_PACKED.sub("(packed)", text))


def _movie(path: Path) -> dict[str, Any]:
    frames = imageio_ffmpeg.read_frames(str(path))
    about, digest, count = next(frames), hashlib.sha256(), 0
    for frame in frames:
        digest.update(frame)
        count += 1
    size = {"size": list(about["size"]), "fps": about["fps"]}
    return {**size, "frames": count, "digest": digest.hexdigest()[:16]}


def _json(path: Path) -> Any:
    value = json.loads(path.read_text("utf-8"))
    if path.name == "answer.json":
        # What it names are the sources.
        del value["key"]
    return steady_value(value)


_READERS: dict[str, Callable[[Path], Any]] = {
    ".nc": _netcdf,
    ".zarr": _zarr,
    ".png": lambda path: _picture(path.read_bytes()),
    ".html": _page,
    ".mp4": _movie,
    ".json": _json,
}
