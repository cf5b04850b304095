"""The native half, as the package calls it: every argument in its place."""

from os import PathLike
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ._scene import Diagnostic

def compile(
    source: str | Path, definitions: list[tuple[str, float]]
) -> tuple[str | None, list[Diagnostic]]: ...
def render(
    source: str | Path,
    size: tuple[int, int],
    samples: int | None,
    aa: str | None,
    error: float | None,
    seconds: float | None,
    certify: bool,
    filter: str,
    glossy: bool,
    seed: int,
    depth: int,
    min_weight: float,
    channels: list[str],
    linear: bool,
    dither_output: bool,
    definitions: list[tuple[str, float]],
    threads: int | None,
) -> dict[str, Any]: ...
def read(path: str | PathLike[str]) -> dict[str, Any]: ...
def write(
    path: str | PathLike[str],
    pixels: NDArray[Any] | None,
    measured: dict[str, NDArray[Any]],
    indices: NDArray[Any] | None,
    palette: NDArray[Any] | None,
    at: tuple[int, int],
    rle: bool,
) -> None: ...
def quantize(
    image: NDArray[Any],
    colours: int,
    method: str,
    metric: str,
    dither: str,
    strength: float | None,
    palette: NDArray[Any] | None,
    keep: NDArray[Any] | None,
    max_error: float | None,
    matte: list[float] | None,
    threads: int | None,
) -> tuple[NDArray[Any], NDArray[Any]]: ...
def composite(
    operator: str,
    a: NDArray[Any],
    b: NDArray[Any] | None,
    at: tuple[int, int],
    factor: float | None,
    stored: bool,
    threads: int | None,
) -> NDArray[Any]: ...
def tone(
    image: NDArray[Any],
    operation: str,
    numbers: list[float],
    per_channel: bool,
    threads: int | None,
) -> NDArray[Any]: ...
