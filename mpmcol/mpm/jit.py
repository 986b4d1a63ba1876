"""How code is compiled: decorators and compiler flags, and the folder of the disk cache.

Numba's disk cache does not detect edits of helpers in other files, so the name of the cache folder is a hash of all
sources of compiled code. It is set here, before any kernel is declared.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import platform
import shutil
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

from mpmcol.mpm.spin_count import spin_count

os.environ.setdefault("NUMBA_THREADING_LAYER_PRIORITY", "omp tbb workqueue")
os.environ.setdefault("GOMP_SPINCOUNT", str(spin_count()))  # read when libgomp is loaded

import numba
from numba import prange as prange
from numba.core import types
from numba.core.caching import FunctionCache
from numba.extending import overload, register_jitable, typeof_impl
from numba.np.unsafe.ndarray import to_fixed_tuple

from mpmcol.mpm.cache_folder import cache_root

F = TypeVar("F", bound=Callable[..., Any])

COMPILED_SOURCES = ("mpm", "bench")  # folders of the package with compiled code
DIGEST_LENGTH = 16  # hexadecimal digits in the name of a cache folder
_STALE_AFTER_S = 7 * 24 * 3600.0
_FLAGS: dict[str, Any] = {"error_model": "numpy", "nogil": True}
# Functions that only kernels call have no interface to C, which would take a seventh of the time of compilation.
CALLED_BY_KERNELS: Any = {"no_cfunc_wrapper": True}


def source_digest() -> str:
    """Hash of all that compiled code depends on: its sources, and the versions of Numba, llvmlite, NumPy and Python."""
    digest = hashlib.sha256()
    versions = [metadata.version(package) for package in ("numba", "llvmlite", "numpy")] + [platform.python_version()]
    digest.update(repr(versions).encode())
    package = Path(__file__).parents[1]
    for name in COMPILED_SOURCES:
        for path in sorted((package / name).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:DIGEST_LENGTH]


def _remove_stale(root: Path, keep: Path) -> None:
    """Delete cache folders of other versions that have not been used for a week; no folder of another name."""
    with contextlib.suppress(OSError):  # another process may have deleted it
        for folder in root.glob("[0-9a-f]" * DIGEST_LENGTH):
            if folder != keep and folder.is_dir() and time.time() - folder.stat().st_mtime > _STALE_AFTER_S:
                shutil.rmtree(folder, ignore_errors=True)


def _choose_cache_folder() -> tuple[Path, str]:
    """The folder for the present sources, and a note for the user if it is not in the user's cache."""
    root, note = cache_root()
    folder = root / source_digest()
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
    _remove_stale(root, folder)
    return folder, note


# Both are needed: Numba reads its environment again whenever it changes, and may already be imported.
CACHE_FOLDER, CACHE_NOTE = _choose_cache_folder()
os.environ["NUMBA_CACHE_DIR"] = str(CACHE_FOLDER)
_config: Any = numba.config
_config.CACHE_DIR = str(CACHE_FOLDER)
JIT_DISABLED = bool(_config.DISABLE_JIT)
THREAD_LIMIT = int(_config.NUMBA_NUM_THREADS)  # that Numba may use


class _TolerantCache(FunctionCache):
    """Numba's disk cache; where files are damaged or cannot be written, functions are compiled again."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            loaded = super().load_overload(sig, target_context)
            if loaded is not None:  # what is linked with it must start threads as well when it is loaded itself
                loaded.library._reload_init.update(loaded.reload_init)
            return loaded
        except Exception:  # damaged pickles raise many kinds
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Identify machine code by the name of its function, where Numba takes a hash of the pickled closure.

        The bytes of a pickled closure differ between a process that has compiled the Python source and one that has
        read its bytecode. Names suffice: `variant` makes them unique, and the cache folder depends on all sources.
        """
        return sig, codegen.magic_tuple(), self._py_func.__qualname__

    def holds(self, sig: Any, codegen: Any) -> bool:
        """Whether there is machine code for arguments of these types."""
        try:
            return self._index_key(sig, codegen) in self._cache_file._load_index()
        except Exception:  # damaged pickles raise many kinds
            return False


def _cached(compiled: Any) -> Any:
    """Store the machine code of a function on disk."""
    if not JIT_DISABLED:
        compiled._cache = _TolerantCache(compiled.py_func)
    return compiled


def variant(*frozen: Any) -> Callable[[F], F]:
    """Give a function made by a factory a unique name, from the modules, functions or numbers frozen into it.

    Numba identifies machine code by name, argument types and a counter of compilations in the process. Code in the disk
    cache was counted by other processes: if two functions of one factory were each the first compiled in their
    process, a third process would silently call one instead of the other.
    """
    labels = [str(getattr(part, "__name__", part)).rpartition(".")[2] for part in frozen]

    def rename(function: F) -> F:
        function.__qualname__ = "_".join([function.__qualname__, *labels])
        function.__name__ = "_".join([function.__name__, *labels])
        return function

    return rename


def device(function: F) -> F:
    """A formula: plain Python when called from Python, inlined when called from a kernel."""
    return register_jitable(forceinline=True, **CALLED_BY_KERNELS, **_FLAGS)(function)


def make_unpack(size: int) -> Callable[[Any], tuple[float, ...]]:
    """A formula that gives the `size` numbers of an array as a tuple."""

    def unpack(values: Any) -> tuple[float, ...]:
        return tuple(values.tolist())

    @overload(unpack)
    def compiled_unpack(values: Any) -> Callable[[Any], tuple[float, ...]]:
        def implementation(values: Any) -> Any:
            return to_fixed_tuple(values, size)  # type: ignore[call-arg]

        return implementation

    return unpack


class LinkedFunction:
    """A function that compiled code calls, compiled once and cached on disk. From Python it runs as Python code."""

    def __init__(self, function: Any, **flags: bool) -> None:
        functools.update_wrapper(self, function)
        self.function = function
        options: Any = {"no_cpython_wrapper": True, **flags, **CALLED_BY_KERNELS, **_FLAGS}
        self.compiled = _cached(numba.njit(**options)(function))

    def __call__(self, *arguments: Any) -> Any:
        """Run the Python code."""
        return self.function(*arguments)


@typeof_impl.register(LinkedFunction)
def _typeof_linked(function: LinkedFunction, context: Any) -> Any:
    """In compiled code it is its compiled function."""
    return types.Dispatcher(function.compiled)


def subroutine(function: F) -> F:
    """A loop that kernels call: compiled once, cached on disk, and inlined into all of them."""
    linked: Any = function if JIT_DISABLED else LinkedFunction(function, forceinline=True)
    return linked


def phase(function: F) -> F:
    """A parallel loop that kernels call: compiled once, cached on disk, and linked into all of them."""
    linked: Any = function if JIT_DISABLED else LinkedFunction(function, parallel=True)
    return linked


def kernel(function: F) -> F:
    """An entry point from Python: parallel, cached on disk. Without fastmath, for NaN checks and reproducible bits."""
    compiled: F = _cached(numba.njit(parallel=True, **_FLAGS)(function))
    return compiled


def driver(function: F) -> F:
    """An entry point from Python that runs phases one after another; cached on disk."""
    compiled: F = _cached(numba.njit(**_FLAGS)(function))
    return compiled


def argument_types(*arguments: Any) -> tuple[Any, ...]:
    """Numba's types of these values, which can be pickled."""
    return tuple(numba.typeof(each) for each in arguments)


def is_compiled(function: Any, signature: Any) -> bool:
    """Whether there is machine code of a subroutine, phase, kernel or driver for these types, in memory or on disk."""
    compiled = getattr(function, "compiled", function)
    return (
        JIT_DISABLED
        or signature in compiled.overloads
        or compiled._cache.holds(signature, compiled.targetctx.codegen())
    )


def compile_for(function: Any, signature: Any) -> None:
    """Compile a subroutine, phase, kernel or driver for arguments of these types, or load it from the disk cache."""
    if not JIT_DISABLED:
        getattr(function, "compiled", function).compile(signature)
