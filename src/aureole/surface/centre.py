"""The zero order's place in a photograph, to a fraction of a pixel.

Two estimates: the centroid of the brightest lobe, which a saturated core does not disturb, and the
point about which the whole pattern is symmetric: heights much smaller than a wavelength, and
amplitudes, have S(−h) = S(h).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse

METHODS = ("auto", "core", "symmetry")
COMPRESSION = 0.25  # the power of the values that symmetry compares, so that weak orders count too
SURROUNDINGS = 50.0  # a picture's side over the radius of what is around a lobe
SYMMETRIC = 0.9  # correlation with the turned pattern from which symmetry is believed


@dataclass(frozen=True)
class Centre:
    """Where the zero order lies.

    Parameters
    ----------
    row, column : float
        Pixels; whole numbers are pixels' centres.
    method : str
        "core", "symmetry" or "given".
    symmetry : float
        Correlation of the photograph with itself turned by 180° about this place; 1 is symmetric, and 0
        stands for not looked at.
    """

    row: float
    column: float
    method: str
    symmetry: float = 0.0


def find_centre(
    photo: ArrayLike,
    method: str = "auto",
    near: tuple[float, float] | None = None,
    radius: float | None = None,
) -> Centre:
    """Find the zero order in a linear photograph.

    Parameters
    ----------
    photo : array_like, shape (rows, columns)
        Linear, black level removed; its core may be saturated.
    method : {"auto", "core", "symmetry"}
        "core" takes the centroid of the brightest lobe above half its height. "symmetry" takes the point
        about which the photograph, its values to the power 1/4, is most symmetric, near the core. "auto"
        takes the core, which is the finer one, unless it lies a pixel or more away from a point of good
        symmetry (a correlation of 0.9): then a flare or a bloomed core has drawn it aside.
    near : tuple of float or None
        (row, column) close to the zero order, for samples whose zero order is not the brightest.
    radius : float or None
        How far from `near`, in pixels, to look; None is a twentieth of the smaller side.

    Returns
    -------
    Centre
        The place.

    Raises
    ------
    refuse.Refusal
        Where nothing is bright, or `near` lies outside.
    """
    refuse.one_of("method", method, METHODS)
    values = np.asarray(
        refuse.all_finite("photo", refuse.shape_of("photo", photo, (None, None))), dtype=float
    )
    row, column, width = _core(values, near, radius)
    core = Centre(row, column, "core")
    if method == "core":
        return core
    symmetric = _symmetry(values, core, max(2.0, width))
    if method == "symmetry":
        return symmetric
    apart = np.hypot(symmetric.row - row, symmetric.column - column)
    return (
        symmetric
        if symmetric.symmetry >= SYMMETRIC and apart >= 1.0
        else replace(core, symmetry=symmetric.symmetry)
    )


def _core(
    values: NDArray[np.float64], near: tuple[float, float] | None, radius: float | None
) -> tuple[float, float, float]:
    """Return the centroid (row, column) of the brightest lobe and the radius of its upper half."""
    from scipy import ndimage

    # A median over 3 x 3 forgets hot pixels, a narrow Gaussian the noise on a plateau.
    smooth = ndimage.gaussian_filter(ndimage.median_filter(values, 3), 1.0)
    seen = smooth
    if near is not None:
        seen = np.where(_disc(values.shape, near, radius), smooth, -np.inf)
    top = float(seen.max())
    if not top > 0:
        raise refuse.Refusal("'photo' has no light where the zero order is looked for.")
    lobes, _ = ndimage.label(smooth > 0.5 * top)
    # Where many orders are clipped alike, the zero order is the one in the brightest surroundings.
    around = ndimage.gaussian_filter(smooth, max(1.0, min(values.shape) / SURROUNDINGS))
    peak = np.unravel_index(int(np.argmax(np.where(seen > 0.5 * top, around, -np.inf))), seen.shape)
    lobe = lobes == lobes[peak]
    weights = np.where(lobe, smooth - 0.5 * top, 0.0)
    row, column = ndimage.center_of_mass(weights)
    return float(row), float(column), float(np.sqrt(np.count_nonzero(lobe) / np.pi))


def _disc(shape: tuple[int, ...], near: tuple[float, float], radius: float | None) -> NDArray[np.bool_]:
    for name, place, count in zip(("near (row)", "near (column)"), near, shape, strict=True):
        refuse.between(name, place, 0.0, count - 1.0)
    reach = min(shape) / 20.0 if radius is None else refuse.positive("radius", radius)
    rows, columns = np.ogrid[: shape[0], : shape[1]]
    return np.asarray(np.hypot(rows - near[0], columns - near[1]) <= max(reach, 1.0))


def _symmetry(values: NDArray[np.float64], core: Centre, reach: float) -> Centre:
    """Find the point within reach of the core about which the values are most symmetric."""
    from scipy import fft

    middle = (round(core.row), round(core.column))
    half = [min(place, count - 1 - place) for place, count in zip(middle, values.shape, strict=True)]
    part = values[
        middle[0] - half[0] : middle[0] + half[0] + 1, middle[1] - half[1] : middle[1] + half[1] + 1
    ]
    signal = np.maximum(part, 0.0) ** COMPRESSION
    signal = signal - signal.mean()
    size = [fft.next_fast_len(2 * count, real=True) for count in signal.shape]
    # The convolution of a pattern with itself peaks at twice its centre of symmetry.
    turned = fft.irfft2(fft.rfft2(signal, size) ** 2, size)
    window = int(np.ceil(2.0 * reach)) + 1
    rows, columns = (2 * count + np.arange(-window, window + 1) for count in half)
    near = turned[np.ix_(rows % size[0], columns % size[1])]
    place = divmod(int(np.argmax(near)), near.shape[1])
    top = near[place]
    offsets = [_vertex(np.moveaxis(near, axis, 0), place[axis], place[1 - axis]) for axis in (0, 1)]
    shift = [0.5 * (place[axis] - window + offsets[axis]) for axis in (0, 1)]
    score = float(top / np.sum(signal**2)) if np.any(signal) else 0.0
    return Centre(middle[0] + shift[0], middle[1] + shift[1], "symmetry", score)


def _vertex(values: NDArray[np.float64], index: int, other: int) -> float:
    """Return the offset of a parabola's vertex from the sample at an index."""
    if not 0 < index < len(values) - 1:
        return 0.0
    before, here, after = values[index - 1 : index + 2, other]
    bend = before - 2.0 * here + after
    return float(0.5 * (before - after) / bend) if bend < 0 else 0.0
