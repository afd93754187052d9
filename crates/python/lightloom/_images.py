"""Pictures, and what is measured of them."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _lightloom
from ._errors import Error
from ._types import Shown

Pixels = npt.NDArray[np.float32]

AS_IS: Shown = ("none", 1.0, 0.0)
"""Display light is shown as it is."""
BY_REINHARD: Shown = ("reinhard-simple", 1.0, 0.0)
"""The curve by which measures look at pictures."""


class Image(np.ndarray[Any, np.dtype[np.float32]]):
    """A picture: an array `[height, width, 3]` of linear light that a notebook shows.

    What is computed from one is one as well, as long as it has that shape.

    >>> import lightloom, numpy
    >>> grey = lightloom.Image(numpy.full((2, 3, 3), 0.5))
    >>> (2 * grey).png()[1:4]
    b'PNG'
    """

    shown: Shown
    """How it is shown: the name of a tone-mapping curve, its white point, and the exposure [EV]."""

    def __new__(cls, pixels: npt.ArrayLike, shown: Shown = BY_REINHARD) -> Image:
        image = np.asarray(pixels, dtype=np.float32).view(cls)
        image.shown = shown
        return image

    def __array_finalize__(self, of: Any) -> None:
        self.shown = getattr(of, "shown", BY_REINHARD)

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        # A sum of all is a number, and what is no picture any more is a plain array.
        if array.ndim == 0:
            return array[()]
        return super().__array_wrap__(array, context, return_scalar)

    def is_picture(self) -> bool:
        """Returns whether it has the shape of a picture."""
        return self.ndim == 3 and self.shape[2] in (3, 4) and self.size > 0

    def png(self, exposure: float | None = None) -> bytes:
        """Returns a PNG file of it, at another exposure [EV] where one is given. Pixels that are no numbers are magenta."""
        curve, white, own = self.shown
        return _lightloom.png(_pixels(self), (curve, white, own if exposure is None else exposure))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes it into a file: .exr or .pfm keep linear light, .png is what is shown.

        `Renderer.save` also writes the record by which `lightloom rerun` renders a picture again.
        """
        _lightloom.write(_pixels(self), os.fspath(path), self.shown)

    def _repr_png_(self) -> bytes | None:
        return self.png() if self.is_picture() else None


Image.__module__ = "lightloom"


def _pixels(picture: npt.ArrayLike) -> Pixels:
    """Returns an array of pixels as Rust takes it, without a copy where it is of that kind already."""
    array = np.asarray(picture)
    if array.dtype.kind not in "fiub":
        raise Error(f"a picture is an array of numbers; found one of {array.dtype}")
    if array.ndim == 2:
        array = np.repeat(array[..., None], 3, axis=2)
    if array.ndim != 3 or array.shape[2] not in (3, 4) or array.size == 0:
        raise Error(
            "a picture is an array [height, width, 3] or [height, width, 4], or one of grey, [height, width]; "
            f"found {list(array.shape)}"
        )
    return np.asarray(array, dtype=np.float32)


def read(path: str | os.PathLike[str]) -> Image:
    """Reads a picture: .exr, .pfm and .hdr as they are, .png as the linear light that it stands for."""
    shown = AS_IS if os.fspath(path).lower().endswith(".png") else BY_REINHARD
    return Image(_lightloom.read(os.fspath(path))[..., :3], shown)


def measure(picture: npt.ArrayLike, reference: npt.ArrayLike, *, display: bool = False) -> dict[str, Any]:
    """Compares a picture with a reference of the same size, and returns all measures, as `lightloom compare --json` prints them.

    `display` says that both hold display light in 0 to 1 already; else they hold linear light.

    >>> import lightloom, numpy
    >>> reference = numpy.ones((8, 8, 3))
    >>> lightloom.measure(1.1 * reference, reference)["rel_mse"]
    0.0099...
    """
    shown = None if display else BY_REINHARD
    found: dict[str, Any] = json.loads(_lightloom.compare(_pixels(picture), _pixels(reference), shown))
    return found


def flip(picture: npt.ArrayLike, reference: npt.ArrayLike, *, display: bool = False) -> Pixels:
    """Returns the ꟻLIP error of each pixel, `[height, width]` of 0 to 1; HDR-ꟻLIP, over all exposures that matter, of linear light.

    `display` says that both hold display light in 0 to 1 already.
    """
    return _lightloom.flip(_pixels(picture), _pixels(reference), AS_IS, not display)
