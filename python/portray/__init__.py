"""Ray tracing of constructive solid geometry, and an image toolkit, as numpy arrays.

>>> import portray
>>> scene = "object is red sphere  camera at (0, 0, 9)  ambient intensity 1"
>>> picture = portray.render(scene, size=(64, 48))
>>> picture.rgb.shape, picture.rgb.dtype
((48, 64, 3), dtype('uint8'))
>>> indices, palette = portray.quantize(picture, 16)
>>> palette[indices].shape
(48, 64, 3)

Pictures are arrays of shape (rows, columns) for grey, (rows, columns, 2) for grey and coverage, (rows, columns, 3) for
red, green and blue, and (rows, columns, 4) for those and coverage. Arrays of ``uint8`` and ``uint16`` hold display
values (sRGB) and straight coverage, as PNG does; arrays of ``float32`` hold linear light, multiplied by coverage, as
OpenEXR does. What takes an array takes an :class:`Image` as well.

Wrong types raise ``TypeError``, wrong values and shapes ``ValueError``, files that cannot be read or written
``OSError``, and scenes with mistakes :class:`SceneError`. Everything lets go of the interpreter while it works. The same
arguments give the same bytes, with any number of threads.
"""

from ._picture import Image, Render, read, render, write
from ._scene import Compiled, Diagnostic, Note, SceneError, compile
from ._tools import Quantized, composite, equalize, quantize, tone

__version__ = "0.1.0"

__all__ = [
    "Compiled",
    "Diagnostic",
    "Image",
    "Note",
    "Quantized",
    "Render",
    "SceneError",
    "compile",
    "composite",
    "equalize",
    "quantize",
    "read",
    "render",
    "tone",
    "write",
]
