"""An area light of many samples behind an occluder: powers by the change alone, and by a transform each.

The quad paper takes 81 samples at 1024² in 31.9 ms where FFT takes 63.4 ms (section 6.1, GeForce GTX 1080 Ti,
without the making of the masks, which both need).
"""

import statistics
from functools import partial
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole import aperture, glare
from aureole.bench import shapes
from aureole.bench.timing import milliseconds, workers
from aureole.records import Aperture, Grid

ACROSS = 9
# Pixels of 1024 that the shadow moves from a sample to its neighbour, as from frame to frame in the paper.
STEP = 5.0
OCCLUDERS = ("disc", "leaf", "slanted bars")


def masks(name: str, occluder: str, size: int, across: int = ACROSS) -> list[Aperture]:
    """Paint what of an opening the samples of a square light see past an occluder.

    Parameters
    ----------
    name : str
        Opening: box, circle, heptagon or whirl.
    occluder : str
        disc, leaf or slanted bars.
    size : int
        Pixels a side.
    across : int
        Samples along each side of the light.

    Returns
    -------
    list of Aperture
        In the order of the samples.
    """
    opening = Aperture(1.0, mask=shapes.mask(name, size, across=1.0).astype(np.float32), name=name)
    silhouettes = {
        "disc": aperture.circle(0.3),
        "leaf": aperture.polygon([(-0.35, -0.1), (0.0, -0.18), (0.4, 0.15), (0.05, 0.12)]),
        "slanted bars": aperture.railing(0.12, 0.22, 7, 4.0, 0.4),
    }
    before = aperture.occluder(silhouettes[occluder], 1.0)
    side = STEP / 1024 * across
    light = glare.AreaLight(aperture.rectangle(side, side))
    samples = glare.light_samples(light, across)
    return [seen for _, seen in glare.sample_openings(opening, [before], light, samples, size) if seen]


def by_changes(painted: list[Aperture], grid: Grid) -> NDArray[np.float32]:
    """Sum the powers, each from its neighbour's change.

    Parameters
    ----------
    painted : list of Aperture
        Rasters.
    grid : Grid
        Frequencies.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        The mean.
    """
    assert painted[0].mask is not None
    total = glare.PowerSum(grid, len(painted[0].mask))
    for each in painted:
        total.add(each, 1 / len(painted))
    return total.result()


def by_transforms(painted: list[Aperture]) -> NDArray[np.float32]:
    """Sum the powers of real transforms on half the plane, and mirror the sum.

    Parameters
    ----------
    painted : list of Aperture
        Rasters of an even number of pixels.

    Returns
    -------
    ndarray of float32, shape (n, n)
        The mean at the transform's own frequencies, zero in the middle; without the pixel's sinc.
    """
    assert painted[0].mask is not None
    size = len(painted[0].mask)
    half = np.zeros((size, size // 2 + 1), dtype=np.float32)
    for each in painted:
        field = scipy.fft.rfft2(each.mask, workers=workers())
        half += field.real**2 + field.imag**2
    half *= np.float32(1 / (len(painted) * size**4))
    out = np.empty((size, size), dtype=np.float32)
    middle = size // 2
    rows = np.roll(half, middle, axis=0)
    out[:, middle:] = rows[:, :middle]
    out[:, 0] = rows[:, middle]
    out[1:, 1:middle] = rows[:0:-1, middle - 1 : 0 : -1]
    out[0, 1:middle] = rows[0, middle - 1 : 0 : -1]
    return out


def compare(name: str, occluder: str, size: int = 1024, runs: int = 5) -> dict[str, Any]:
    """Time both in turn.

    Parameters
    ----------
    name, occluder : str
        As of `masks`.
    size : int
        Pixels and frequencies a side.
    runs : int
        How often.

    Returns
    -------
    dict
        Medians in milliseconds, their ratio, and the largest difference in parts of the peak.
    """
    painted = masks(name, occluder, size)
    grid = Grid((size, size), (1.0, 1.0))
    found, expected = by_changes(painted, grid), by_transforms(painted)
    y, x = grid.axes()
    expected *= ((np.sinc(y / size) ** 2)[:, None] * np.sinc(x / size) ** 2).astype(np.float32)
    changes, transforms = [], []
    for _ in range(runs):
        changes.append(milliseconds(partial(by_changes, painted, grid)))
        transforms.append(milliseconds(partial(by_transforms, painted)))
    ours, theirs = statistics.median(changes), statistics.median(transforms)
    error = float(np.abs(found - expected).max() / expected.max())
    return {
        "samples": len(painted),
        "ours_ms": ours,
        "fft_ms": theirs,
        "faster": theirs / ours,
        "error": error,
    }
