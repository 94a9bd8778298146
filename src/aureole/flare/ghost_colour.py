"""How a ghost's light goes with the wavelength: few rays at many wavelengths mend many rays at few.

A coating throws back little near its design wavelength and much elsewhere, and a ghost is thrown back twice:
its weight is too wild a function of the wavelength for a polynomial through three or four traced ones. But
over one ghost the rays meet each surface at much the same angle, so that the mean weight of a few of them is
the curve of all. Each traced weight is divided by the curve, the smooth rest is interpolated, and the
result is multiplied by the curve where it is wanted.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole.flare import pupil, tracing
from aureole.flare.prescription import Lens
from aureole.flare.spectral import Sampling, interpolation

# Wavelengths of a curve, and the rays whose mean it is: the tracer goes by blocks of 128.
NODES = 12
RAYS = 64
# Below this part of its largest value a curve does not divide.
LEAST = 1e-4

Numbers = NDArray[np.float64]


def prepare_curves(lens: Lens, sampling: Sampling, f_number: float | None = None) -> tracing.Prepared:
    """Make a lens's tables at the wavelengths of the curves.

    Parameters
    ----------
    lens : Lens
        The lens.
    sampling : Sampling
        The light's.
    f_number : float, optional
        Wide open without it.

    Returns
    -------
    Prepared
        At Chebyshev's points in 1 / λ over the light's spectrum.
    """
    fast, slow = 1.0 / sampling.cells[0], 1.0 / sampling.cells[-1]
    places = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    nodes = 1.0 / (0.5 * (fast + slow) + 0.5 * (fast - slow) * places)
    return tracing.prepare(lens, nodes, f_number)


def curves(
    prepared: tracing.Prepared,
    sheets: Sequence[pupil.Sheet],
    direction: ArrayLike,
    sensor: tuple[float, float] | None = None,
) -> Numbers:
    """Return the mean weight of some rays of each ghost at the wavelengths of the curves.

    Parameters
    ----------
    prepared : Prepared
        From `prepare_curves`.
    sheets : sequence of Sheet
        The ghosts' rays, from `aureole.flare.pupil.sheets`.
    direction : array_like, shape (3,)
        From the lens towards the light.
    sensor : tuple of float, optional
        Width and height in metres: rays that land inside are taken where there are any.

    Returns
    -------
    ndarray, shape (G, 12)
        0 for a ghost by which no ray passes.
    """
    points = np.array([_some(sheet, sensor) for sheet in sheets]).reshape(-1, 2)
    paths, counts = [sheet.path for sheet in sheets], [RAYS] * len(sheets)
    found = tracing.follow(prepared, paths, counts, points, tracing.travel(direction))
    weight = np.where(found.reached, found.weight, 0.0)
    return np.asarray(weight.reshape(len(sheets), NODES, RAYS).mean(axis=2, dtype=np.float64))


def weight_blend(curve: Numbers, prepared: tracing.Prepared, traced: Numbers, wanted: Numbers) -> Numbers:
    """Return what the weight at wanted wavelengths takes of that at each traced one.

    Parameters
    ----------
    curve : ndarray, shape (12,)
        One ghost's, from `curves`.
    prepared : Prepared
        From `prepare_curves`.
    traced : ndarray, shape (W,)
        Metres.
    wanted : ndarray, shape (M,)
        Metres.

    Returns
    -------
    ndarray, shape (M, W)
        As `aureole.flare.spectral.interpolation`, for weights alone: places and levels are smooth.
    """
    plain = interpolation(traced, wanted)
    nodes = prepared.wavelengths
    known, sought = interpolation(nodes, traced) @ curve, interpolation(nodes, wanted) @ curve
    # No part of the curve's own light is so small that its interpolation could be called known.
    if not known.min() > LEAST * curve.max():
        return plain
    return np.asarray(plain * np.maximum(sought, 0.0)[:, None] / known)


def _some(sheet: pupil.Sheet, sensor: tuple[float, float] | None) -> Numbers:
    """Return the places in the pupil of some rays that pass, (RAYS, 2); of any, where none does."""
    _, rows, columns = sheet.x.shape
    middle = len(sheet.x) // 2
    passing = sheet.passed
    kinds = [passing[middle], passing.any(axis=0), np.ones((rows, columns), dtype=bool)]
    if sensor is not None:
        landed = (np.abs(sheet.x) <= sensor[0] / 2.0) & (np.abs(sheet.y) <= sensor[1] / 2.0)
        kinds.insert(0, passing[middle] & landed[middle])
    places = next(np.flatnonzero(kind) for kind in kinds if kind.any())
    chosen = places[np.linspace(0, len(places) - 1, RAYS).round().astype(np.int64)]
    box = sheet.rectangle
    assert box is not None
    x = box.left + (box.right - box.left) * (chosen % columns) / (columns - 1)
    y = box.top + (box.bottom - box.top) * (chosen // columns) / (rows - 1)
    return np.column_stack([x, y])
