"""Images of named channels: rendering, reading, writing."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy
from numpy.typing import DTypeLike, NDArray

from . import _core
from ._scene import Diagnostic, Scene, numbers, source

#: An array of samples.
Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Image:
    """An image as named channels, each an array of the same rows and columns or ``None``."""

    #: Light: (rows, columns) for grey or (rows, columns, 3). Display values in integers, linear in ``float32``.
    light: Array | None = None
    #: Share of each pixel that is covered: (rows, columns), 0 to 255, to 65535, or to 1.
    coverage: Array | None = None
    #: Distance from the camera to the first surface, in scene units; 3.4028235e38 where there is none.
    depth: Array | None = None
    #: Unit normal of the first surface in scene coordinates, toward the camera: (rows, columns, 3).
    normal: Array | None = None
    #: Number of the object of the first surface, from 1 in the order of the scene; 0 where there is none.
    objects: Array | None = None
    #: Index of each pixel's colour in ``palette``, ``uint8``.
    indices: Array | None = None
    #: Colours: (1 to 256, 3), or (…, 4) with straight coverage, ``uint8``.
    palette: Array | None = None
    #: Column and row of the top left pixel on the canvas.
    at: tuple[int, int] = (0, 0)

    @property
    def rgb(self) -> Array:
        """Red, green and blue: (rows, columns, 3). Grey is all three."""
        if self.light is None:
            raise ValueError(f"the image has no light; it has {self._names()}")
        if self.light.ndim == 3:
            return self.light
        return numpy.repeat(self.light[:, :, None], 3, axis=2)

    @property
    def pixels(self) -> Array:
        """Light and, where there is any, coverage behind it: what functions of arrays take."""
        if self.light is None:
            raise ValueError(f"the image has no light; it has {self._names()}")
        if self.coverage is None:
            return self.light
        return numpy.dstack((self.light, self.coverage))

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""
        for channel in (self.light, self.coverage, self.depth, self.normal, self.objects, self.indices):
            if channel is not None:
                return channel.shape[1], channel.shape[0]
        raise ValueError("the image has no channels")

    def _names(self) -> str:
        names = ("coverage", "depth", "normal", "objects", "indices", "palette")
        return ", ".join(name for name in names if getattr(self, name) is not None) or "no channels"


@dataclass(frozen=True, eq=False)
class Render(Image):
    """A rendered picture and what is known about it."""

    #: Figures by the names of ``portray --stats``: rays by kind, what was cut, ``trace_seconds``, and ``ending``: ``done``,
    #: ``most samples`` where the error could not be reached, ``one sample`` where there was time for no more.
    statistics: Mapping[str, int | float | str] = field(default_factory=dict)
    #: The estimated root of the mean square error, in display steps of 1/255 before rounding; ``None`` where samples
    #: are not drawn by lot.
    estimated_error: float | None = None
    #: Warnings of the compiler.
    diagnostics: tuple[Diagnostic, ...] = ()


def pixels_of(image: Image | Array) -> Array:
    """The array of a picture."""
    return image.pixels if isinstance(image, Image) else image


def is_linear(dtype: DTypeLike) -> bool:
    """Whether pictures of this type hold linear light."""
    wanted = numpy.dtype(dtype)
    if wanted not in (numpy.dtype(numpy.uint8), numpy.dtype(numpy.float32)):
        raise ValueError(f"dtype: expected uint8 or float32, found {wanted}")
    return wanted == numpy.dtype(numpy.float32)


def render(
    scene: Scene,
    size: tuple[int, int] = (512, 512),
    *,
    samples: int | None = None,
    aa: Literal["none", "adaptive", "stochastic"] | None = None,
    error: float | None = None,
    seconds: float | None = None,
    certify: bool = False,
    filter: Literal["box", "tent", "mitchell"] = "box",
    glossy: bool = False,
    seed: int = 0,
    depth: int = 15,
    min_weight: float = 1 / 256,
    channels: Sequence[str] = ("rgb",),
    dtype: DTypeLike = numpy.uint8,
    dither_output: bool = False,
    definitions: Mapping[str, float] | None = None,
    threads: int | None = None,
) -> Render:
    """Renders a scene, as ``portray`` does: the same arguments give the same samples.

    ``scene`` is the text of a description or of a compiled scene, or a path: any ``os.PathLike``, or a ``str`` of one
    line that ends in ``.sdl`` or ``.prc``. ``size`` is columns and rows, each 1 to 65535.

    ``samples`` of a pixel: a square without ``aa`` or with ``"none"``, a power of 4 up to 256 with ``"adaptive"``, any
    number up to 65536 with ``"stochastic"``. In their place ``error`` samples until the estimated error, in display steps
    of 1/255, is at most that, and ``seconds`` for so long. Without all of them pixels are divided where they differ.
    ``certify`` proves what can be proved to show one surface, or none, and divides the rest; ``statistics`` tell how much
    (``certain_share``). Another ``seed`` draws other samples. ``filter`` says what a sample counts for in the pixels around it; ``glossy`` lets
    rough surfaces mirror what is around them. Rays of the tree deeper than ``depth`` return the background, and those
    that can add less than ``min_weight`` to a channel are left out.

    ``channels`` are some of ``rgb``, ``coverage``, ``depth``, ``normal`` and ``objects``. Without ``coverage`` the background
    is painted in; with it light is straight in ``uint8``, and multiplied by coverage in ``float32``. ``dtype`` is ``uint8``
    for display values or ``float32`` for linear light, which is not clamped; ``dither_output`` spreads the rounding to
    ``uint8``. ``definitions`` replaces the numbers of ``let`` statements, ``threads`` is 1 to 1024 and does not change
    the picture.

    Other threads go on while it renders, and Ctrl-C ends it: ``KeyboardInterrupt``, or whatever a handler of a signal raises.
    Raises :class:`SceneError` for a scene with mistakes.
    """
    if isinstance(channels, str):
        raise TypeError("channels: expected a sequence of names, found str")
    arrays = _core.render(
        source(scene),
        _pair("size", size),
        samples,
        aa,
        error,
        seconds,
        certify,
        filter,
        glossy,
        seed,
        depth,
        min_weight,
        list(channels),
        is_linear(dtype),
        dither_output,
        numbers(definitions),
        threads,
    )
    arrays["diagnostics"] = tuple(arrays["diagnostics"])
    return Render(**arrays)


def read(path: str | os.PathLike[str]) -> Image:
    """Reads an image of any format that the suite knows, by the ending of its name; without one, IDF.

    PNG, OpenEXR, PNM, PAM, GIF, JPEG, TIFF and WebP. ``uint8`` and ``uint16`` are display values with straight coverage,
    ``float32`` linear light multiplied by coverage, whatever the file has. Indexed images have ``indices`` and ``palette``,
    and their colours in ``light``.
    """
    return Image(**_core.read(path))


def write(
    path: str | os.PathLike[str],
    image: Image | Array,
    *,
    palette: Array | None = None,
    depth: Array | None = None,
    normal: Array | None = None,
    objects: Array | None = None,
    at: tuple[int, int] | None = None,
    rle: bool = False,
) -> None:
    """Writes an image in the format of its name's ending; without one, IDF.

    With ``palette``, ``image`` holds indices: PNG and GIF become indexed. PNG gets 8 or 16 bits and straight coverage,
    OpenEXR linear ``float32``, PNM is opaque. Only IDF and OpenEXR hold ``depth``, ``normal`` and ``objects``; those of an
    :class:`Image` are written there and left out elsewhere. ``at`` is the column and row of the top left pixel on the
    canvas, ``rle`` codes the data files of IDF. An error leaves an older file as it was.
    """
    given = {"depth": depth, "normal": normal, "objects": objects}
    pixels: Array | None = None
    indices: Array | None = None
    if isinstance(image, Image):
        if os.path.splitext(path)[1].lower() in ("", ".idf", ".exr"):
            given = {name: getattr(image, name) if own is None else own for name, own in given.items()}
        at = image.at if at is None else at
        if image.indices is not None:
            indices, palette = image.indices, image.palette if palette is None else palette
        else:
            pixels = image.pixels
    elif palette is not None:
        indices = image
    else:
        pixels = image
    layers = {name: layer for name, layer in given.items() if layer is not None}
    _core.write(path, pixels, layers, indices, palette, _pair("at", at or (0, 0)), rle)


def _pair(name: str, pair: tuple[int, int]) -> tuple[int, int]:
    """Two of something, or what is wrong with them."""
    try:
        first, second = pair
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected two whole numbers, found {pair!r}") from None
    return first, second
