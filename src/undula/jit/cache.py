"""The cache of compiled code on disk, which notices every change of what is compiled.

numba's own cache looks at the one file that holds a function, so that an edited kernel would go on
running in its old form wherever another file calls it; it takes a damaged file for an error, and
does without no cache. Here every compiled function is one file, sealed with a digest of its content
and of all sources that compiled code is made of. What does not carry its seal is compiled anew: a
file that is damaged, cut or out of date. Files appear whole, so that processes may share them. And
where nothing can be kept, functions are compiled in each process.

They are kept in the folder NUMBA_CACHE_DIR if there is such a variable, else beside the sources, or
else in the user's own folder of numba.
"""

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
from numba.core import caching, compiler, config, types
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps
from numba.misc.appdirs import AppDirs

PACKAGE = Path(__file__).resolve().parents[1]
#: The floors that compiled code takes functions and constants from, in any of their files.
COMPILED_FLOORS = ("jit", "numerics", "models")
#: What a file elsewhere imports to have functions compiled.
_COMPILES = b"undula.jit"

#: Settings of numba's that change what it makes.
_SETTINGS = ("BOUNDSCHECK", "OPT", "DEBUGINFO_DEFAULT", "ENABLE_AVX")

_troubles: list[str] = []


def trouble() -> str | None:
    """Return why what this process compiles is not kept, with the cure; None if it is."""
    return _troubles[0] if _troubles else None


def keep(function: Any) -> Any:
    """Return a function, compiled by numba, that is looked for on disk first and then kept there.

    Functions of other packages are not, as nothing here would notice that they change; nor is any
    without a compiler.
    """
    if isinstance(function, Dispatcher) and _is_ours(function.py_func.__module__):
        setattr(function, "_cache", KernelCache(function.py_func))  # noqa: B010
    return function


@cache
def kernel_digest() -> str:
    """Digest of every source that compiled code is made of: the version of that code."""
    digest = hashlib.sha256()
    for place, content in sorted(_sources()):
        floor, below, _ = place.partition("/")
        if not below or floor in COMPILED_FLOORS or _COMPILES in content:
            digest.update(place.encode())
            digest.update(content)
    return digest.hexdigest()


def _sources() -> Iterator[tuple[str, bytes]]:
    """Yield the place in the package of each source, and what it holds."""
    if PACKAGE.is_dir():
        for source in PACKAGE.rglob("*.py"):
            yield source.relative_to(PACKAGE).as_posix(), source.read_bytes()
        return
    # Imported from an archive.
    left = [("", resources.files(__name__.partition(".")[0]))]
    while left:
        place, at = left.pop()
        for one in at.iterdir():
            if one.is_dir():
                left.append((f"{place}{one.name}/", one))
            elif one.name.endswith(".py"):
                yield f"{place}{one.name}", one.read_bytes()


class KernelCache(caching._Cache):
    """Where the compiled forms of one function are kept."""

    def __init__(self, function: Any) -> None:
        code, python = function.__code__, "".join(map(str, sys.version_info[:2]))
        self._whose = f"{function.__module__}.{function.__qualname__}"
        self._name = f"{function.__qualname__}-{code.co_firstlineno}.py{python}"
        self._folder = _folder(os.path.dirname(code.co_filename))

    @property
    def cache_path(self) -> str | None:
        """The folder; None if there is none that can be written."""
        return self._folder

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return the function compiled for a signature; None if it has to be compiled anew."""
        path = self._path(signature, target)
        if path is None:
            return None
        target.refresh()
        # Whatever may be wrong with a file, the function can be compiled.
        with contextlib.suppress(Exception):
            content = Path(path).read_bytes()
            if content[:32] == _seal(content[32:]):
                known, reduced = pickle.loads(content[32:])
                if known == self._key(signature, target):
                    return compiler.CompileResult._rebuild(target, *reduced)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the function compiled for a signature, if there is room for it."""
        path = self._path(signature, result.target_context)
        if path is None or result.lifted or result.library.has_dynamic_globals:
            return
        content = dumps((self._key(signature, result.target_context), result._reduce()))
        try:
            _write(path, _seal(content) + content)
        except OSError as error:
            _note(f"{os.path.dirname(path)} ({error.strerror or error})")

    def _path(self, signature: Any, target: Any) -> str | None:
        if self._folder is None or not _all_ours(signature):
            return None
        names = hashlib.sha256(repr(self._key(signature, target)).encode()).hexdigest()
        return os.path.join(self._folder, f"{self._name}.{names[:16]}.nbc")

    def _key(self, signature: Any, target: Any) -> tuple[Any, ...]:
        """Return what a file is for: a function, its signature, the machine, and numba's ways."""
        settings = (getattr(config, name) for name in _SETTINGS)
        return self._whose, signature, target.codegen().magic_tuple(), *settings

    def enable(self) -> None:
        """Do nothing: it is never off."""

    def disable(self) -> None:
        """Do nothing."""

    def flush(self) -> None:
        """Do nothing: what is out of date is not loaded."""


def _seal(content: bytes) -> bytes:
    """Return the digest of a content, of the sources and of the compiler (32 bytes)."""
    makers = f"{kernel_digest()} numba {numba.__version__} llvmlite {version('llvmlite')}"
    return hashlib.sha256(makers.encode() + content).digest()


def _write(path: str, content: bytes) -> None:
    """Write a file that appears whole or not at all."""
    handle, beside = tempfile.mkstemp(dir=os.path.dirname(path), suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


@cache
def _folder(sources: str) -> str | None:
    """Return the folder in which functions of a folder of sources are kept, None if nowhere."""
    apart = f"{os.path.basename(sources)}_{hashlib.sha256(sources.encode()).hexdigest()[:40]}"
    users = AppDirs(appname="numba", appauthor=False).user_cache_dir
    chosen: str = getattr(config, "CACHE_DIR")  # noqa: B009
    given = [os.path.join(chosen, apart)] if chosen else []
    for folder in (*given, os.path.join(sources, "__pycache__"), os.path.join(users, apart)):
        with contextlib.suppress(OSError):
            os.makedirs(folder, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            return folder
    _note("any of the folders for them")
    return None


def _note(where: str) -> None:
    _troubles.append(
        f"compiled kernels cannot be kept in {where}, so that every call compiles them for half a"
        " minute; set NUMBA_CACHE_DIR to a folder that can be written"
    )


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == __name__.partition(".")[0]


def _all_ours(signature: Any) -> bool:
    """Tell whether all records of a signature are of this package, whose changes are noticed."""
    records = [one for one in signature if isinstance(one, types.NamedTuple | types.NamedUniTuple)]
    return all(_is_ours(one.instance_class.__module__) for one in records)
