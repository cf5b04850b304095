"""Scenes as text: compiling, and what the compiler has to say."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, NamedTuple

from . import _core


class Note(NamedTuple):
    """Another place that matters to a diagnostic."""

    message: str
    file: str | None
    line: int | None
    column: int | None


class Diagnostic(NamedTuple):
    """One thing that the compiler has to say."""

    severity: Literal["error", "warning"]
    #: What was found and what was expected.
    message: str
    #: The file, ``<text>`` for a scene given as text; ``None`` where no place shows what is wrong.
    file: str | None
    #: Line and column of the first character, from 1; columns count characters.
    line: int | None
    column: int | None
    #: Line and column behind the last character.
    end_line: int | None
    end_column: int | None
    #: What to do about it.
    hint: str | None
    #: Other places that matter.
    notes: tuple[Note, ...]

    def __str__(self) -> str:
        place = "" if self.file is None else f"{self.file}:{self.line}:{self.column}: "
        hint = "" if self.hint is None else f"\nhint: {self.hint}"
        return f"{place}{self.severity}: {self.message}{hint}"


class SceneError(ValueError):
    """A scene has mistakes. The message shows each with its line of the source."""

    #: All that the compiler has to say, in the order of the source; at least one is an error.
    diagnostics: tuple[Diagnostic, ...]

    def __init__(self, message: str, diagnostics: tuple[Diagnostic, ...] | list[Diagnostic] = ()):
        super().__init__(message)
        self.diagnostics = tuple(diagnostics)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.diagnostics)


class Compiled(NamedTuple):
    """What comes of compiling."""

    #: The compiled scene, as ``prcomp`` writes it into the working folder; ``None`` if there are errors.
    scene: str | None
    #: Errors and warnings in the order of the source.
    diagnostics: tuple[Diagnostic, ...]

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The diagnostics that are errors."""
        return tuple(found for found in self.diagnostics if found.severity == "error")


#: A scene as text, or the path of one.
Scene = str | os.PathLike[str]


def source(scene: Scene) -> str | Path:
    """The text or the path that ``scene`` is: a ``str`` of one line that ends in .sdl or .prc is a path."""
    if isinstance(scene, os.PathLike):
        return Path(os.fspath(scene))
    if not isinstance(scene, str):
        raise TypeError(f"scene: expected a str or a path, found {type(scene).__name__}")
    is_path = scene.lower().endswith((".sdl", ".prc")) and "\n" not in scene
    return Path(scene) if is_path else scene


def numbers(definitions: Mapping[str, float] | None) -> list[tuple[str, float]]:
    """Names and numbers, as the native half takes them."""
    return [(name, float(number)) for name, number in (definitions or {}).items()]


def compile(scene: Scene, *, definitions: Mapping[str, float] | None = None) -> Compiled:
    """Compiles a scene description and says everything that is wrong with it.

    ``scene`` is the text, or a path: any ``os.PathLike``, or a ``str`` of one line that ends in ``.sdl``. Files that a
    text includes are looked for in the working folder. ``definitions`` replaces the numbers of ``let`` statements by
    name, as ``-D`` does. Mistakes do not raise: they are in ``diagnostics``.

    >>> compile("object is glas").errors[0].message
    'unknown class `glas`'
    """
    text, diagnostics = _core.compile(source(scene), numbers(definitions))
    return Compiled(text, tuple(diagnostics))
