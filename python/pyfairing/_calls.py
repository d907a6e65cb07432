"""Threads, progress and warnings of calls."""

from __future__ import annotations

import operator
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, SupportsIndex, TypeAlias

#: Called as `progress(stage, done, total)`; `total` is None if unknown.
ProgressCallback: TypeAlias = Callable[[str, int, "int | None"], object]

#: No progress, a bar of tqdm, or a callback.
Progress: TypeAlias = "bool | ProgressCallback | None"

Call: TypeAlias = "tuple[int | None, ProgressCallback | None]"


class FairingWarning(UserWarning):
    """A result that needs attention, such as a changed input or an automatic choice."""


def warn(text: str) -> None:
    """Warns at the line of the first caller outside this package."""
    import sys

    level = 2
    frame = sys._getframe(1)
    while frame is not None and frame.f_globals.get("__name__", "").startswith("pyfairing"):
        frame = frame.f_back  # type: ignore[assignment]
        level += 1
    warnings.warn(text, FairingWarning, stacklevel=level)


_DEFAULT: ContextVar[int | None] = ContextVar("threads of calls that name none", default=None)


@contextmanager
def default_threads(count: int | None) -> Iterator[None]:
    """Default number of threads for calls in this context."""
    token = _DEFAULT.set(count)
    try:
        yield
    finally:
        _DEFAULT.reset(token)


class _Bar:
    """A tqdm bar for each stage; the last closes when the call drops it."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from error
        self._make: Any = tqdm
        self._bar: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, total: int | None) -> None:
        if stage != self._stage:
            if self._bar is not None:
                self._bar.close()
            self._bar = self._make(total=total, desc=stage, leave=False)
            self._stage = stage
        self._bar.n = done
        self._bar.refresh()


def call(threads: SupportsIndex | None = None, progress: Progress = None) -> Call:
    """The last argument of functions of the extension."""
    count = _DEFAULT.get() if threads is None else operator.index(threads)
    if count is not None and count < 1:
        raise ValueError(f"threads is {count}, but must be 1 or more")
    if progress is None or progress is False:
        return count, None
    if progress is True:
        return count, _Bar()
    if callable(progress):
        return count, progress
    raise TypeError(f"progress must be a callable, True or None, not {type(progress).__name__}")
