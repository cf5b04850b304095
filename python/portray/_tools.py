"""The toolkit: quantising, compositing, tones."""

from __future__ import annotations

from typing import Literal, NamedTuple

from . import _core
from ._picture import Array, Image, _pair, pixels_of


class Quantized(NamedTuple):
    """A picture in the colours of a table: ``palette[indices]`` shows it."""

    #: (rows, columns), ``uint8``.
    indices: Array
    #: (1 to 256, 3) display values, or (…, 4) where some are not opaque, ``uint8``.
    palette: Array


def quantize(
    image: Image | Array,
    colours: int = 256,
    *,
    method: Literal["heckbert", "fast", "best"] = "best",
    metric: Literal["rgb", "oklab"] = "rgb",
    dither: Literal["none", "floyd-steinberg", "blue-noise"] = "none",
    strength: float | None = None,
    palette: Array | None = None,
    keep: Array | None = None,
    max_error: float | None = None,
    matte: tuple[float, float, float] | None = None,
    threads: int | None = None,
) -> Quantized:
    """Finds the colours that a picture gets by with, and draws it in them, as ``iencode`` does.

    ``colours`` is 1 to 256. ``palette`` takes these colours, exactly and in their order, in place of a table that is made.
    ``keep`` are colours that a table begins with; ``max_error`` takes as few colours as reach this error. ``strength`` is
    the share of the error that a ``dither`` makes up for, 0 to 1. ``matte`` (display values, 0 to 1) is put behind pixels
    that are not covered; without it their coverage is kept in the palette. The picture is taken in display values, 8 bits.
    """
    return Quantized(
        *_core.quantize(
            pixels_of(image),
            colours,
            method,
            metric,
            dither,
            strength,
            palette,
            keep,
            max_error,
            None if matte is None else list(matte),
            threads,
        )
    )


def composite(
    operator: str,
    a: Image | Array,
    b: Image | Array | None = None,
    *,
    at: tuple[int, int] = (0, 0),
    factor: float | None = None,
    stored: bool = False,
    threads: int | None = None,
) -> Array:
    """Combines two pictures by an operator of Porter and Duff, in linear light, as ``icomp`` does.

    ``operator`` is ``clear``, ``a``, ``b``, ``over``, ``rover``, ``in``, ``rin``, ``out``, ``rout``, ``atop``, ``ratop``,
    ``xor`` or ``plus``; or, for one picture and a ``factor``, ``darken``, ``dissolve`` or ``opaque``. ``at`` is the column
    and row of the top left of ``a`` on ``b``. The result is as large as both together: its top left is the least column and
    row of either. It has the type of the deeper one, and coverage unless it is whole everywhere. ``stored`` combines
    display values, as programs without linear light do.
    """
    second = None if b is None else pixels_of(b)
    return _core.composite(operator, pixels_of(a), second, _pair("at", at), factor, stored, threads)


def tone(
    image: Image | Array,
    operation: str,
    *numbers: float,
    per_channel: bool = False,
    threads: int | None = None,
) -> Array:
    """Changes tones by an operation of ``ieq`` and its numbers, on display values.

    ``equalize``; ``clahe`` tiles, clip, bins; ``gamma`` G; ``levels`` LO, HI; ``brightness`` B; ``contrast`` C;
    ``saturation`` S; ``hue`` degrees. What is not covered does not count and stays as it is. ``per_channel`` takes each channel
    by itself where luma would be looked at.
    """
    return _core.tone(pixels_of(image), operation, list(numbers), per_channel, threads)


def equalize(
    image: Image | Array,
    *,
    tiles: int | None = None,
    clip: float = 0.01,
    bins: int = 256,
    per_channel: bool = False,
    threads: int | None = None,
) -> Array:
    """Spreads tones so that all are equally frequent; with ``tiles``, within so many tiles each way.

    ``clip`` is the largest share of a tile in one of its ``bins``, 0 for no limit; both count with ``tiles`` alone.
    """
    if tiles is None:
        return tone(image, "equalize", per_channel=per_channel, threads=threads)
    return tone(image, "clahe", tiles, clip, bins, per_channel=per_channel, threads=threads)
