"""One linear photograph from a bracket of exposures: black level, the camera's response, the merge.

Raw files are linear: photographs of known exposures are merged with the weights that make the error
smallest, each by its own shot and read noise. Display-referred files need the camera's response first,
which a bracket tells by itself (Debevec and Malik 1997).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface.response import Response

Values = NDArray[np.float64]

TOP = 0.98  # of the saturation: what is above counts as clipped


@dataclass(frozen=True, eq=False)
class Merged:
    """A linear photograph.

    Parameters
    ----------
    values : ndarray of float64, shape (rows, columns)
        Counts above black per unit of exposure.
    deviation : ndarray of float64, shape (rows, columns)
        Expected standard deviation of the values.
    saturated : ndarray of bool, shape (rows, columns)
        Where even the shortest exposure is clipped: the values are too small there.
    """

    values: Values
    deviation: Values
    saturated: NDArray[np.bool_]


def merge(
    photos: Sequence[ArrayLike],
    exposures: Sequence[float],
    black: float | Sequence[ArrayLike] | str = 0.0,
    saturation: float | None = None,
    read_noise: float = 1.0,
    gain: float = 1.0,
    response: Response | None = None,
) -> Merged:
    """Merge a bracket of linear photographs into one.

    Each pixel is the mean of counts / exposure, weighed by exposure² / (read noise² + counts / gain): the
    inverse of their variances, with the counts that a first mean expects, so that the noise of a count
    does not choose its own weight.

    Parameters
    ----------
    photos : sequence of array_like, each of shape (rows, columns)
        Counts, linear in light.
    exposures : sequence of float
        Of each photograph, in seconds or relative.
    black : float, sequence of array_like, or str
        Counts without light: a number; a dark frame for each photograph; or "estimate", by `estimate_black`.
    saturation : float or None
        Counts at which the camera clips; None says that nothing is clipped, or with a response that its
        largest value is. A bracket that looks clipped all the same is refused.
    read_noise : float
        Counts, standard deviation.
    gain : float
        Electrons a count.
    response : Response or None
        Of files that are not linear in light, as `camera_response` finds it: then black, saturation and read
        noise are in the files' values, all of which have the same noise; None is linear.

    Returns
    -------
    Merged
        Values, their deviation, and where all exposures are clipped.

    Raises
    ------
    refuse.Refusal
        Where shapes differ, values are not finite, or numbers are not positive.
    """
    stack, times = _checked(photos, exposures)
    read_noise, gain = refuse.positive("read_noise", read_noise), refuse.positive("gain", gain)
    usable = np.ones(stack.shape, dtype=bool)
    if saturation is None and response is not None:
        saturation = float(response.values[-1])
    if saturation is None:
        _refuse_clipped(stack, times)
    else:
        usable = stack < TOP * refuse.positive("saturation", saturation)
    saturated = np.asarray(~usable.any(axis=0))
    # Where all are clipped the shortest exposure says most.
    usable[np.argmin(times)] |= saturated
    if response is not None and isinstance(black, str):
        raise refuse.Refusal("'black' cannot be estimated where a response is given; give it as a number.")
    dark = _black_frames(black, stack, times)
    scale = times[:, None, None]
    if response is None:
        counts = stack - dark
        mean = (counts * usable).sum(axis=0) / (scale * usable).sum(axis=0)
        variance = read_noise**2 + scale * np.maximum(mean, 0.0) / gain
    else:
        counts = response.exposure(stack) - response.exposure(dark)
        variance = np.maximum(read_noise * response.slope(stack), 1e-12) ** 2
    weights = usable * scale**2 / variance
    total = weights.sum(axis=0)
    values = (weights * counts / scale).sum(axis=0) / total
    return Merged(values, 1.0 / np.sqrt(total), saturated)


def estimate_black(photos: Sequence[ArrayLike], exposures: Sequence[float]) -> float:
    """Estimate the black level from a bracket: what its dark pixels would read at no exposure.

    Parameters
    ----------
    photos : sequence of array_like, each of shape (rows, columns)
        Two or more, linear in light.
    exposures : sequence of float
        Of each photograph.

    Returns
    -------
    float
        Median, over the darkest tenth of the pixels, of a straight line through counts over exposure at
        exposure 0.

    Raises
    ------
    refuse.Refusal
        Where there are not two different exposures.
    """
    stack, times = _checked(photos, exposures)
    if np.ptp(times) == 0.0:
        raise refuse.Refusal("'exposures' must differ to estimate a black level; give 'black' as a number.")
    longest = stack[np.argmax(times)]
    # Choosing by another photograph than is read would need three; a tenth keeps the choice's bias small.
    dark = stack[:, longest <= np.quantile(longest, 0.1)]
    offset = times - times.mean()
    slopes = offset @ dark / (offset @ offset)
    return float(np.median(dark.mean(axis=0) - slopes * times.mean()))


def _black_frames(black: float | Sequence[ArrayLike] | str, stack: Values, times: Values) -> float | Values:
    if isinstance(black, str):
        refuse.one_of("black", black, ("estimate",))
        return estimate_black(list(stack), times.tolist())
    if isinstance(black, int | float):
        return refuse.finite("black", black)
    if len(black) != len(stack):
        raise refuse.Refusal(f"'black' needs a dark frame for each of {len(stack)} photos, got {len(black)}.")
    frames = [
        refuse.all_finite(f"black[{k}]", refuse.shape_of(f"black[{k}]", frame, stack.shape[1:]))
        for k, frame in enumerate(black)
    ]
    return np.stack(frames).astype(np.float64)


def _refuse_clipped(stack: Values, times: Values) -> None:
    """Refuse a bracket whose longer exposures stop at one count where the shortest expects more."""
    top = float(stack.max())
    shortest = stack[np.argmin(times)]
    for photo, time in zip(stack, times / times.min(), strict=True):
        # Half of what the shortest exposure expects leaves room for noise; two such pixels may be hot.
        lost = (photo == top) & (photo > shortest) & (0.5 * time * (shortest - shortest.min()) > top)
        if int(lost.sum()) > 2:
            raise refuse.Refusal(
                f"'photos' look clipped at {top:g}: say so by 'saturation', or what is bright comes out dim."
            )


def _checked(photos: Sequence[ArrayLike], exposures: Sequence[float]) -> tuple[Values, Values]:
    """Return a stack (P, rows, columns) and exposures (P,)."""
    if len(photos) == 0 or len(photos) != len(exposures):
        raise refuse.Refusal(
            f"'exposures' must be one for each photograph, got {len(exposures)} for {len(photos)}."
        )
    first = refuse.shape_of("photos[0]", photos[0], (None, None))
    layers = [
        refuse.all_finite(f"photos[{k}]", refuse.shape_of(f"photos[{k}]", photo, first.shape))
        for k, photo in enumerate(photos)
    ]
    times = [refuse.positive(f"exposures[{k}]", value) for k, value in enumerate(exposures)]
    return np.stack(layers).astype(np.float64), np.array(times)
