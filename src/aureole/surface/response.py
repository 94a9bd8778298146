"""A camera's response from a bracket, where its files are not linear in light.

Debevec and Malik (1997): a pixel of light E shows, at exposure t, the value Z with g(Z) = ln E + ln t. One
g fits all pixels of all photographs best, smooth where they say little.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse

Values = NDArray[np.float64]

LEVELS = 256
SMOOTHNESS = 30.0  # Debevec and Malik's λ
_ENDS = 0.02  # of the range at both ends that says nothing
_CALM = 0.5  # share of the pixels, the calmest, of which samples are taken


@dataclass(frozen=True, eq=False)
class Response:
    """How a camera's values follow from light.

    Parameters
    ----------
    values : ndarray of float64, shape (K,)
        A file's values, rising evenly.
    log_exposure : ndarray of float64, shape (K,)
        g: natural logarithm of the exposure that shows each, 0 in the middle of the values; never falling.
    """

    values: Values
    log_exposure: Values

    def exposure(self, photo: ArrayLike) -> Values:
        """Return the exposure that shows a photograph's values.

        Parameters
        ----------
        photo : array_like
            Values of a file, of any shape.

        Returns
        -------
        ndarray of float64
            Linear in light, of the same shape; 1 at the middle value.
        """
        return np.exp(np.interp(np.asarray(photo, dtype=np.float64), self.values, self.log_exposure))

    def slope(self, photo: ArrayLike) -> Values:
        """Return by how much exposure rises for a step of 1 in value.

        Parameters
        ----------
        photo : array_like
            Values of a file, of any shape.

        Returns
        -------
        ndarray of float64
            Of the same shape.
        """
        rise = np.gradient(self.log_exposure, self.values)
        values = np.asarray(photo, dtype=np.float64)
        return np.asarray(self.exposure(values) * np.interp(values, self.values, rise))


def camera_response(
    photos: Sequence[ArrayLike],
    exposures: Sequence[float],
    top: float | None = None,
    smoothness: float = SMOOTHNESS,
) -> Response:
    """Find a camera's response from a bracket of one scene (Debevec and Malik 1997, Eq. 3).

    Parameters
    ----------
    photos : sequence of array_like, each of shape (rows, columns)
        Two or more, as in their files: one channel, from 0 to `top`.
    exposures : sequence of float
        Of each photograph.
    top : float or None
        The largest value of the files; None is 255 where a value is above 1, and otherwise 1.
    smoothness : float
        Weight of the response's second derivative, λ, for values of 256 levels.

    Returns
    -------
    Response
        At 256 values from 0 to `top`.

    Raises
    ------
    refuse.Refusal
        Where there are not two different exposures, or the photographs do not brighten with exposure.
    """
    stack, times = _checked(photos, exposures)
    if top is None:
        top = 255.0 if stack.max() > 1.0 else 1.0
    top = refuse.positive("top", top)
    places = np.clip(stack.reshape(len(stack), -1)[:, _samples(stack, top)] / top, 0.0, 1.0) * (LEVELS - 1)
    curve = np.maximum.accumulate(_solved(places, np.log(times), refuse.positive("smoothness", smoothness)))
    if not curve[-1] - curve[0] > 0.1:
        raise refuse.Refusal("'photos' do not brighten with 'exposures': no response can be found.")
    return Response(np.linspace(0.0, top, LEVELS), curve - curve[LEVELS // 2])


def _solved(places: Values, log_times: Values, smoothness: float) -> Values:
    """Solve for g at the levels; places (P, N) are values counted in levels."""
    photos, pixels = places.shape
    weights = hat(places / (LEVELS - 1)).ravel()
    low = np.minimum(places.astype(int), LEVELS - 2).ravel()
    part = places.ravel() - low
    rows = np.arange(places.size)
    data = np.zeros((places.size, LEVELS + pixels))
    data[rows, low], data[rows, low + 1] = weights * (1.0 - part), weights * part
    data[rows, LEVELS + np.tile(np.arange(pixels), photos)] = -weights
    bend = np.zeros((LEVELS - 2, LEVELS + pixels))
    inner = np.arange(LEVELS - 2)
    # The ends weigh little, but not nothing, so that the curve goes on straight there.
    stiff = smoothness * np.maximum(hat((inner + 1.0) / (LEVELS - 1)), 0.01)
    bend[inner, inner], bend[inner, inner + 1], bend[inner, inner + 2] = stiff, -2.0 * stiff, stiff
    middle = np.zeros((1, LEVELS + pixels))
    middle[0, LEVELS // 2] = 1.0
    matrix = np.concatenate([data, bend, middle])
    wanted = np.concatenate([weights * np.repeat(log_times, pixels), np.zeros(LEVELS - 1)])
    return np.asarray(np.linalg.lstsq(matrix, wanted, rcond=None)[0][:LEVELS])


def hat(share: Values) -> Values:
    """Weigh values by their distance from both ends of the range (Debevec and Malik 1997, Eq. 4).

    Parameters
    ----------
    share : ndarray of float64
        Values over the largest one.

    Returns
    -------
    ndarray of float64
        1 in the middle, 0 at the ends.
    """
    return np.clip(2.0 * np.minimum(share, 1.0 - share), 0.0, 1.0)


def _samples(stack: Values, top: float) -> NDArray[np.intp]:
    """Choose pixels that tell the response: calm ones, evenly over brightness, not clipped in all."""
    inside = (stack > _ENDS * top) & (stack < (1.0 - _ENDS) * top)
    useful = np.flatnonzero(inside.sum(axis=0) >= min(2, len(stack)))
    if useful.size < 10:
        raise refuse.Refusal(
            "'photos' overlap too little to find a response:"
            " hardly a pixel is neither dark nor clipped in two of them."
        )
    roughness = np.hypot(*np.gradient(stack.mean(axis=0))).ravel()[useful]
    calm = useful[roughness <= np.quantile(roughness, _CALM)]
    bright = stack.mean(axis=0).ravel()[calm]
    count = min(calm.size, 4 * math.ceil(LEVELS / max(1, len(stack) - 1)))
    # Even steps of brightness, not of rank: dark pixels are the most.
    targets = np.linspace(bright.min(), bright.max(), count)
    order = np.argsort(bright, kind="stable")
    return np.unique(calm[order[np.clip(np.searchsorted(bright[order], targets), 0, calm.size - 1)]])


def _checked(photos: Sequence[ArrayLike], exposures: Sequence[float]) -> tuple[Values, Values]:
    """Return a stack (P, rows, columns) and exposures (P,)."""
    if len(photos) < 2 or len(photos) != len(exposures):
        raise refuse.Refusal(
            "A response needs two photographs or more and an exposure for each,"
            f" got {len(photos)} and {len(exposures)}."
        )
    first = refuse.shape_of("photos[0]", photos[0], (None, None))
    layers = [
        refuse.all_finite(f"photos[{k}]", refuse.shape_of(f"photos[{k}]", photo, first.shape))
        for k, photo in enumerate(photos)
    ]
    times = np.array([refuse.positive(f"exposures[{k}]", value) for k, value in enumerate(exposures)])
    if np.ptp(times) == 0.0:
        raise refuse.Refusal("'exposures' must differ to find a response.")
    return np.stack(layers).astype(np.float64), times
