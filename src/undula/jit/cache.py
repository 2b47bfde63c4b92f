"""Cache of compiled code on disk, which detects every change of the compiled sources.

numba's own cache only looks at the file that holds a function: an edited kernel would keep running
in its old form in every entry point of another file. It raises an error for a damaged file, and
where no folder is writable. Here every compiled function is one file, sealed with a digest of its
content and of all sources of compiled code. A file without a valid seal (damaged, truncated or out
of date) is ignored, and the function is compiled again. Files are written atomically, so that
processes can share them. Where no folder is writable, each process compiles its functions.

The folder is that of the variable NUMBA_CACHE_DIR if it is set, else one next to the sources, else
numba's folder of the user.
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
#: Packages whose functions and constants compiled code uses, in any of their files.
COMPILED_PACKAGES = ("jit", "numerics", "models")
#: Import by which a file elsewhere is recognised as a source of compiled code.
_JIT_IMPORT = b"undula.jit"

#: Settings of numba that change the machine code.
_SETTINGS = ("BOUNDSCHECK", "OPT", "DEBUGINFO_DEFAULT", "ENABLE_AVX")

_reasons: list[str] = []


def why_not_kept() -> str | None:
    """Return why this process keeps no compiled code, with the cure.

    Returns
    -------
    str or None
        One sentence; None if compiled code is kept.
    """
    return _reasons[0] if _reasons else None


def keep_on_disk(function: Any) -> Any:
    """Let a compiled function be loaded from disk, or else be compiled and kept there.

    Functions of other packages are left alone, as changes of their sources are not detected here.
    So are functions that numba does not compile, as with NUMBA_DISABLE_JIT.

    Parameters
    ----------
    function : numba dispatcher or callable
        The function, changed in place.

    Returns
    -------
    numba dispatcher or callable
        The same function.
    """
    if isinstance(function, Dispatcher) and _is_ours(function.py_func.__module__):
        setattr(function, "_cache", KernelCache(function.py_func))  # noqa: B010
    return function


@cache
def kernel_digest() -> str:
    """Return the digest of all sources of compiled code: the version of that code.

    Returns
    -------
    str
        A hexadecimal SHA-256 digest.
    """
    digest = hashlib.sha256()
    for path, content in sorted(_sources()):
        package, below, _ = path.partition("/")
        is_shared = not below and package != "__init__.py"
        if is_shared or package in COMPILED_PACKAGES or _JIT_IMPORT in content:
            digest.update(path.encode())
            digest.update(content)
    return digest.hexdigest()


def _sources() -> Iterator[tuple[str, bytes]]:
    """Yield path, relative to the package, and content of each source."""
    if PACKAGE.is_dir():
        for source in PACKAGE.rglob("*.py"):
            yield source.relative_to(PACKAGE).as_posix(), source.read_bytes()
        return
    # Imported from an archive.
    pending = [("", resources.files(__name__.partition(".")[0]))]
    while pending:
        path, folder = pending.pop()
        for item in folder.iterdir():
            if item.is_dir():
                pending.append((f"{path}{item.name}/", item))
            elif item.name.endswith(".py"):
                yield f"{path}{item.name}", item.read_bytes()


class KernelCache(caching._Cache):
    """Compiled forms of one function on disk, one file for each signature.

    Parameters
    ----------
    function : callable
        The Python function.
    """

    def __init__(self, function: Any) -> None:
        code, python = function.__code__, "".join(map(str, sys.version_info[:2]))
        self._function = f"{function.__module__}.{function.__qualname__}"
        self._name = f"{function.__qualname__}-{code.co_firstlineno}.py{python}"
        self._folder = _folder(os.path.dirname(code.co_filename))

    @property
    def cache_path(self) -> str | None:
        """Folder of the files; None if no folder is writable."""
        return self._folder

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Load the function compiled for a signature.

        Parameters
        ----------
        signature : numba signature
            Types of the arguments.
        target : numba target context
            The compiler's target.

        Returns
        -------
        numba compile result or None
            The function; None if it has to be compiled.
        """
        path = self._path(signature, target)
        if path is None:
            return None
        target.refresh()
        # No fault of a file matters: the function can be compiled.
        with contextlib.suppress(Exception):
            content = Path(path).read_bytes()
            if content[:32] == _seal(content[32:]):
                stored_key, reduced = pickle.loads(content[32:])
                if stored_key == self._key(signature, target):
                    return compiler.CompileResult._rebuild(target, *reduced)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Write the function compiled for a signature, if the folder takes it.

        Parameters
        ----------
        signature : numba signature
            Types of the arguments.
        result : numba compile result
            The function.
        """
        path = self._path(signature, result.target_context)
        if path is None or result.lifted or result.library.has_dynamic_globals:
            return
        content = dumps((self._key(signature, result.target_context), result._reduce()))
        try:
            _write(path, _seal(content) + content)
        except OSError as error:
            _record_reason(f"{os.path.dirname(path)} ({error.strerror or error})")

    def _path(self, signature: Any, target: Any) -> str | None:
        if self._folder is None or not _all_ours(signature):
            return None
        names = hashlib.sha256(repr(self._key(signature, target)).encode()).hexdigest()
        return os.path.join(self._folder, f"{self._name}.{names[:16]}.nbc")

    def _key(self, signature: Any, target: Any) -> tuple[Any, ...]:
        """Return the key of a file: function, signature, machine and settings of numba."""
        settings = (getattr(config, name) for name in _SETTINGS)
        return self._function, signature, target.codegen().magic_tuple(), *settings

    def enable(self) -> None:
        """Do nothing: the cache is always on."""

    def disable(self) -> None:
        """Do nothing: the cache is always on."""

    def flush(self) -> None:
        """Do nothing: files that are out of date are not loaded."""


def _seal(content: bytes) -> bytes:
    """Return the digest (32 bytes) of a content together with the sources and the compiler."""
    toolchain = f"{kernel_digest()} numba {numba.__version__} llvmlite {version('llvmlite')}"
    return hashlib.sha256(toolchain.encode() + content).digest()


def _write(path: str, content: bytes) -> None:
    """Write a file atomically."""
    handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


@cache
def _folder(sources: str) -> str | None:
    """Return the folder for compiled functions of a folder of sources; None if none is writable."""
    subfolder = f"{os.path.basename(sources)}_{hashlib.sha256(sources.encode()).hexdigest()[:40]}"
    users = AppDirs(appname="numba", appauthor=False).user_cache_dir
    chosen: str = getattr(config, "CACHE_DIR")  # noqa: B009
    preferred = [os.path.join(chosen, subfolder)] if chosen else []
    for folder in (
        *preferred,
        os.path.join(sources, "__pycache__"),
        os.path.join(users, subfolder),
    ):
        with contextlib.suppress(OSError):
            os.makedirs(folder, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            return folder
    _record_reason("any of the folders for them")
    return None


def _record_reason(where: str) -> None:
    _reasons.append(
        f"compiled kernels cannot be kept in {where}, so that every call compiles them for half a"
        " minute; set NUMBA_CACHE_DIR to a folder that can be written"
    )


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == __name__.partition(".")[0]


def _all_ours(signature: Any) -> bool:
    """Return whether all records of a signature are of this package, whose changes are detected."""
    records = [
        kind for kind in signature if isinstance(kind, types.NamedTuple | types.NamedUniTuple)
    ]
    return all(_is_ours(record.instance_class.__module__) for record in records)
