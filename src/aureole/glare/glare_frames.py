"""Room for glare patterns of one size: their spectra, and how much of what they spread lands on the frame.

A pattern's middle pixel is left out: what it holds stays in its pixel anyway, so the spectra's rounding
touches glare only, never the picture. Where glare leaves the frame it can be given back to its own pixel;
how much that is depends on the pixel's place, most of all near the borders, so it is kept at nodes that
crowd there.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import KernelMix

RESOLUTIONS = ("full", "half")


@dataclass(frozen=True, eq=False)
class GlareFrames:
    """Patterns of glare for pictures of one size.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float
        Radians across the pictures' columns.
    resolution : str
        "full", or "half": patterns on boxes of 2 × 2 pixels.
    kernels : KernelMix
        Their spectra.
    arriving : ndarray of float32, shape (frames, Y, X, 3)
        Share of a pixel's light that each spreads over the frame, at the `border_nodes` of rows and columns.
    """

    shape: tuple[int, int]
    field_of_view: float
    resolution: str
    kernels: KernelMix
    arriving: NDArray[np.float32]

    @classmethod
    def empty(
        cls,
        shape: tuple[int, int],
        field_of_view: float,
        resolution: str = "full",
        count: int = 1,
        even: bool = True,
    ) -> "GlareFrames":
        """Return room for patterns.

        Parameters
        ----------
        shape : tuple of int
            (rows, columns) of the pictures.
        field_of_view : float
            Radians across the pictures' columns, below 180 degrees.
        resolution : str
            "full" or "half".
        count : int
            How many patterns.
        even : bool
            Whether all are even about their middles, as a focused eye's are.

        Returns
        -------
        GlareFrames
            All dark.

        Raises
        ------
        refuse.Refusal
            Where a number or a word is outside its range.
        """
        rows, columns = (refuse.at_least("shape", length, 1) for length in shape)
        if not 0 < refuse.positive("field_of_view", field_of_view) < math.pi:
            raise refuse.Refusal(
                f"'field_of_view' must be below 180 degrees, got {math.degrees(field_of_view):g} degrees."
            )
        low = _low((rows, columns), resolution)
        kernels = KernelMix.empty(low, pattern_shape((rows, columns), resolution), count, 3, even)
        nodes = (len(border_nodes(low[0])), len(border_nodes(low[1])))
        return cls(
            (rows, columns),
            field_of_view,
            resolution,
            kernels,
            np.zeros((count, *nodes, 3), dtype=np.float32),
        )

    @property
    def nbytes(self) -> int:
        """Bytes of memory that the patterns take."""
        return int(self.kernels.nbytes + self.arriving.nbytes)

    def put(self, index: int, pattern: NDArray[np.floating]) -> None:
        """Keep a pattern, without its middle.

        Parameters
        ----------
        index : int
            Its place.
        pattern : ndarray, shape (rows, columns, 3)
            Energy per pixel, of the size `pattern_shape`, none negative.

        Raises
        ------
        refuse.Refusal
            Where its shape is another one, or it is not even and only even ones have room.
        """
        kernel = np.array(refuse.shape_of("pattern", pattern, (*self.kernels.reach, 3)), dtype=np.float32)
        kernel[kernel.shape[0] // 2, kernel.shape[1] // 2] = 0
        self.kernels.put(index, kernel)
        places = [border_nodes(length) for length in self.kernels.shape]
        self.arriving[index] = _arriving(kernel, self.kernels.shape, *places)


def pattern_shape(shape: tuple[int, int], resolution: str = "full") -> tuple[int, int]:
    """Return the size of a pattern that reaches from any pixel of a picture to any other.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    resolution : str
        "full" or "half".

    Returns
    -------
    tuple of int
        (rows, columns), odd.
    """
    rows, columns = _low(shape, resolution)
    return 2 * rows - 1, 2 * columns - 1


def pattern_field(shape: tuple[int, int], field_of_view: float, resolution: str = "full") -> float:
    """Return the field of view across the columns of such a pattern, in the picture's perspective.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float
        Radians across the pictures' columns.
    resolution : str
        "full" or "half".

    Returns
    -------
    float
        Radians.
    """
    pixels = pattern_shape(shape, resolution)[1] * (2 if resolution == "half" else 1)
    return 2 * math.atan(math.tan(field_of_view / 2) * pixels / shape[1])


def border_nodes(length: int) -> NDArray[np.int64]:
    """Return places along a side that crowd towards both its ends.

    Parameters
    ----------
    length : int
        Pixels of the side.

    Returns
    -------
    ndarray of int64, shape (nodes,)
        Rising from 0 to length − 1, at least two; neighbours lie apart by at most a fifth of their
        distance to the border, or one pixel.
    """
    places, at = [0], 0
    while at < length // 2:
        at += max(1, at // 5)
        places.append(min(at, length // 2))
    ends = {*places, *(length - 1 - place for place in places)}
    return np.array(sorted(ends) if length > 1 else [0, 0], dtype=np.int64)


def _low(shape: tuple[int, int], resolution: str) -> tuple[int, int]:
    if refuse.one_of("resolution", resolution, RESOLUTIONS) == "half":
        return (shape[0] + 1) // 2, (shape[1] + 1) // 2
    return shape


def _arriving(
    kernel: NDArray[np.float32], shape: tuple[int, int], rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Sum the part of a kernel that lies on the frame, seen from some pixels of it."""
    # A pixel in row i sees the kernel's rows from N − 1 − i on, N of them.
    top, left = shape[0] - 1 - rows, shape[1] - 1 - columns
    sums = np.zeros((kernel.shape[0] + 1, *kernel.shape[1:]))
    np.cumsum(kernel, axis=0, out=sums[1:])
    tall = np.zeros((len(rows), kernel.shape[1] + 1, 3))
    np.cumsum(sums[top + shape[0]] - sums[top], axis=1, out=tall[:, 1:])
    found: NDArray[np.float64] = tall[:, left + shape[1]] - tall[:, left]
    return found
