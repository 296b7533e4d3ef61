"""The decorators of compiled kernels, and the folder that keeps their code.

The compiler's cache knows the file of a kernel but not those of the kernels it calls, nor the version of the machine
code's generator, so a change would leave stale code. Importing this module drops all cached code that does not carry
the mark of these very sources and versions, wherever it is kept. Where neither the sources' folder nor the user's can
be written, every start compiles anew.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import hashlib
import platform
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

import llvmlite
import numba as nb
import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba.core import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

if TYPE_CHECKING:
    from collections.abc import Callable

_PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}"

COMPILES: bool = not getattr(nb.config, "DISABLE_JIT", False)
"""Whether kernels are compiled at all: NUMBA_DISABLE_JIT=1 has them run as plain Python."""


def versions() -> tuple[str, ...]:
    """Versions of what compiles the kernels, and the processor that they are compiled for."""
    return (platform.python_version(), np.__version__, nb.__version__, llvmlite.__version__, get_host_cpu_name())


def _place() -> Path | None:
    try:
        probe = nb.njit(cache=True)(versions)  # a folder is looked for here, compiled is nothing
    except RuntimeError:  # no locator available
        return None
    return Path(probe.stats.cache_path) if COMPILES and probe.stats.cache_path is not None else None


FOLDER = _place()
"""Folder of compiled code; None where there can be none."""

CACHED = FOLDER is not None
"""Whether compiled code is kept for the next start."""


def mark_of(sources: Path, folder: Path) -> Path:
    """The file in a folder of compiled code that says that these sources were compiled there, by these versions."""
    digest = hashlib.sha256(repr((np.__version__, nb.__version__, llvmlite.__version__)).encode())
    for source in sorted(sources.glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return folder / f"sources.{_PYTHON}.{digest.hexdigest()[:16]}"


def _drop_stale_code(mark: Path) -> None:
    """Drop what this Python compiled into the folder of a mark, unless that stands there."""
    if mark.exists():
        return
    folder = mark.parent
    for stale in (*folder.glob(f"*.{_PYTHON}*nb[ci]"), *folder.glob(f"sources.{_PYTHON}.*")):
        with contextlib.suppress(OSError):  # another process may be doing the same
            stale.unlink()
    with contextlib.suppress(OSError):
        mark.touch()


if FOLDER is not None:
    _drop_stale_code(mark_of(Path(__file__).parent, FOLDER))


def fresh() -> bool:
    """Whether no kernel has been compiled yet that this start could use."""
    return FOLDER is None or next(FOLDER.glob("*.nbi"), None) is None


class _Code(JITCodeLibrary):
    """Code of a part, which waits to be linked into kernels: there it is optimised and translated."""

    def _optimize_final_module(self) -> None:
        """Leave it: what one part calls would be optimised again in each that calls it, a quarter of the time."""

    def _finalize_final_module(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Null: Python calls no part."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """What is told the environment of the machine code: as there is none, `set_env` here."""
        return self

    def set_env(self, name: str, env: object) -> None:
        """Need none: kernels raise nothing."""


class _Compiler(Compiler):
    """The compiler of parts."""

    def __init__(self, typing: Any, target: Any, library: Any, *what: Any) -> None:
        super().__init__(typing, target, _Code(target.codegen(), "part"), *what)


_F = TypeVar("_F", bound="Callable[..., object]")


def kernel(function: _F) -> _F:
    """Decorate a function to have it compiled at its first call, and cached beside the source if it can be.

    Kernels allocate nothing, so that arrays need no counting of references (`_nrt`), a third of the time of an event.
    """
    made = _compiled(function)
    if COMPILES:
        made._compile_for_args = functools.partial(_without_collecting, made._compile_for_args)
    return cast("_F", made)


def part(function: _F, **more: object) -> _F:
    """As `kernel`, to be called by kernels alone, which optimise and cache it with their own code."""
    made = _compiled(function, cache=False, no_cpython_wrapper=True, pipeline_class=_Compiler, **more)
    if COMPILES:
        made._insert, made._compile_for_args = _nothing, functools.partial(_refused, function)
        made.get_call_template = functools.partial(_of_any_value, made.get_call_template)
    return cast("_F", made)


def fused(function: _F) -> _F:
    """As `part`, for power series: set into its callers, with products and sums fused, and sums in any order."""
    return part(function, fastmath={"arcp", "contract", "reassoc"}, forceinline=True)


def inlined(function: _F) -> _F:
    """As `part`, set into its callers: for one that has a single caller, or takes arrays, passed as thirty numbers."""
    return part(function, forceinline=True)


_OPTIONS: Any = {"error_model": "numpy", "nogil": True, "_nrt": False, "no_cfunc_wrapper": True}


def _compiled(function: Callable[..., object], **more: object) -> Any:
    options: dict[str, Any] = {"cache": CACHED, **_OPTIONS, **more}
    made: Any = nb.njit(**options)(function)
    cache = getattr(made, "_cache", None)
    if CACHED and cache is not None:
        cache.load_overload = functools.partial(_loaded, cache, cache.load_overload)
    return made


def _without_collecting(compile_for: Callable[..., Any], *what: Any, **more: Any) -> Any:
    """Compile without looks for garbage, a twelfth of the time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        return compile_for(*what, **more)
    finally:
        if collects:
            gc.enable()


def _of_any_value(template: Callable[..., Any], arguments: Any, named: Any) -> Any:
    """A call for all values of its numbers: what is known of one, the compiler finds where it sets the part in."""
    plain = {name: types.unliteral(each) for name, each in named.items()}
    return template(tuple(types.unliteral(each) for each in arguments), plain)


def _nothing(*_: Any, **__: Any) -> None:
    """Leave a part out of the table of what Python may call."""


def _refused(function: Callable[..., object], *_: Any, **__: Any) -> None:
    raise TypeError(f"{function.__name__} is a part of kernels, which alone can call it")


def _loaded(cache: Any, load: Callable[..., Any], *what: Any) -> Any:
    """Compiled code from the cache; None, so that it is compiled anew, where its files are cut off."""
    try:
        return load(*what)
    except Exception:
        cache.flush()
        return None
