"""The parts of an eye that make its glare, one by one: their patterns, and what share of the light they have.

Pupil and lids make the bloom, lens fibres the halo, particles the corona, lashes the streaks. What a part
takes from the amplitude, less its mean over the open pupil, is what it scatters; the energy of that over the
energy that passes is its share. The patterns of all parts, each of energy 1, added up by their shares, come
near the pattern of the whole amplitude: what is lost is how the parts interfere.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.glare.eye import EyeState
from aureole.glare.eye_aperture import COMPONENTS, eye_parts, focused
from aureole.glare.eye_pattern import (
    FEWEST_PIXELS,
    MARGIN,
    WAVELENGTHS,
    Lamp,
    Veil,
    lamp_of,
    pattern_of,
    raster_size,
)
from aureole.glare.eye_pixels import Frame
from aureole.glare.kernel import nonnegative
from aureole.records import Aperture, Picture, Spectrum

Parts = dict[str, NDArray[np.float32]]
# Brightness of the four patterns in J. Delavennat's thesis (2021), Eq. 3.4.
THESIS_WEIGHTS: Mapping[str, float] = MappingProxyType(
    {"bloom": 1.0, "halo": 0.75, "corona": 1.0, "streaks": 0.5}
)
# Fibres finer than this part of half a cycle per pixel would show rings in wrong places, and are left out.
FINEST_FIBRES = 0.95
SHARES_SIZE = 1024


def component_psfs(
    state: EyeState,
    shape: tuple[int, int],
    field_of_view: float,
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    tail: bool = True,
    projection: str = "angle",
    source: tuple[float, float] = (0.0, 0.0),
    size: int | None = None,
    wavelengths: int = WAVELENGTHS,
    components: Sequence[str] = COMPONENTS,
) -> dict[str, Picture]:
    """Return the pattern of each part of an eye.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    shape : tuple of int
        (rows, columns) of the results; the core lies at (rows//2, columns//2).
    field_of_view : float
        Radians across the columns.
    spectrum : Spectrum, optional
        The light's; equal energy unless given.
    colour_space : str
        Primaries of the results.
    tail : bool
        Whether CIE 135's glare function follows where the corona's wave optics end.
    projection : str
        "angle" or "perspective".
    source : tuple of float
        Direction of the light off the line of sight, (right, down) in radians.
    size : int, optional
        Pixels a side of the amplitude on the pupil, even.
    wavelengths : int
        At least so many.
    components : sequence of str
        Which parts; all unless given.

    Returns
    -------
    dict of str to Picture
        By the parts' names, each (rows, columns, 3) and of energy 1 over the hemisphere in each
        channel; their metadata has `weight`, the part's share of the light, and `energy_inside`. A part that
        scatters nothing has weight 0 and no light.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    for name in components:
        refuse.one_of("components", name, COMPONENTS)
    frame = Frame.checked(shape, field_of_view, projection)
    many = raster_size(state, frame) if size is None else refuse.at_least("size", size, FEWEST_PIXELS)
    width = MARGIN * state.pupil_diameter
    parts = resolved_parts(state, many, width, source)
    lamp = lamp_of(spectrum, colour_space, frame, wavelengths)
    energies, shares = component_energies(parts)
    psfs = {}
    for name, amplitude in _amplitudes(parts, components):
        pixels = _pattern(state, name, amplitude, energies[name], frame, lamp, tail, shares)
        psf = nonnegative(Picture(pixels, colour_space))
        inside = float(psf.pixels.sum(axis=(0, 1), dtype=np.float64).mean())
        metadata = {"weight": shares[name], "energy_inside": inside}
        psfs[name] = Picture(psf.pixels, colour_space, metadata)
    return psfs


def component_weights(
    state: EyeState, source: tuple[float, float] = (0.0, 0.0), size: int = SHARES_SIZE
) -> dict[str, float]:
    """Return the share of the light that each part of an eye scatters.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    source : tuple of float
        Direction of the light off the line of sight, (right, down) in radians.
    size : int
        Pixels a side of the raster on which it is measured.

    Returns
    -------
    dict of str to float
        By the names of `COMPONENTS`; they sum to 1, and "bloom" has what the others leave.

    Raises
    ------
    refuse.Refusal
        Where a number does not fit.
    """
    refuse.at_least("size", size, 16)
    parts = eye_parts(state, size, MARGIN * state.pupil_diameter, source)
    return component_energies(parts)[1]


def component_energies(parts: Parts) -> tuple[dict[str, float], dict[str, float]]:
    """Return the energy of each part's amplitude in pixels, and its share of the light.

    Parameters
    ----------
    parts : dict of str to ndarray of float32, shape (n, n)
        As of `eye_parts`.

    Returns
    -------
    tuple of dict
        By the names of `COMPONENTS`. Shares sum to 1.
    """
    bloom = parts["bloom"]
    energies = {"bloom": float(bloom.sum(dtype=np.float64))}
    passing = _passing(parts)
    for name in COMPONENTS[1:]:
        # Particles and lashes take all or nothing, also where a pixel's mean lies between.
        whole = {"corona": 2.0, "streaks": 1.0}.get(name)
        part, mean = parts[name], _mean(parts, name)
        square = float(np.vdot(bloom, part)) * whole if whole else float(np.vdot(bloom, part * part))
        energies[name] = max(square - mean**2 * energies["bloom"], 0.0)
    shares = {name: energies[name] / passing if passing > 0 else 0.0 for name in COMPONENTS[1:]}
    excess = max(1.0, sum(shares.values()))
    shares = {name: share / excess for name, share in shares.items()}
    return energies, {"bloom": 1 - sum(shares.values())} | shares


def whole_opening(
    state: EyeState, size: int, width: float, source: tuple[float, float]
) -> tuple[Aperture, float]:
    """Return what all parts of an eye let through, and its energy.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    size : int
        Pixels a side.
    width : float
        Metres across them.
    source : tuple of float
        Direction of the light, radians.

    Returns
    -------
    Aperture
        A raster of −1 to 1, with the eye's wavefront.
    float
        Square metres; particles take nothing from it, even where they are smaller than a pixel.
    """
    parts = resolved_parts(state, size, width, source)
    energy = _passing(parts) * (width / size) ** 2
    amplitude = parts["bloom"]
    for name in COMPONENTS[1:]:
        amplitude *= np.subtract(1, parts[name], out=parts[name])
    return focused(Aperture(width, mask=amplitude), state), energy


def resolved_parts(state: EyeState, size: int, width: float, source: tuple[float, float]) -> Parts:
    """Return `eye_parts`, without fibres that the raster cannot tell.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    size : int
        Pixels a side.
    width : float
        Metres across them.
    source : tuple of float
        Direction of the light, radians.

    Returns
    -------
    dict of str to ndarray of float32, shape (size, size)
        By the names of `COMPONENTS`.
    """
    parts = eye_parts(state, size, width, source)
    if not resolves_fibres(state, width / size):
        parts["halo"][:] = 0
    return parts


def resolves_fibres(state: EyeState, pixel: float) -> bool:
    """Say whether a raster's pixels can tell the lens's fibres.

    Parameters
    ----------
    state : EyeState
        The eye.
    pixel : float
        Metres.

    Returns
    -------
    bool
        Whether their frequency is within the raster's.
    """
    eye = state.eye
    if eye.fibre_count is None:
        frequency = 1 / eye.fibre_width
    else:
        frequency = eye.fibre_count / (2 * math.pi * max(eye.fibre_annulus[0], 1e-4))
    return frequency < FINEST_FIBRES * 0.5 / pixel


def combined(psfs: Mapping[str, Picture], weights: Mapping[str, float] | None) -> NDArray[np.float32]:
    """Add the patterns of the parts.

    Parameters
    ----------
    psfs : mapping of str to Picture
        As of `component_psfs`.
    weights : mapping of str to float, or None
        Brightness of each; the parts' shares of the light unless given. They are made to sum to 1.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The sum.

    Raises
    ------
    refuse.Refusal
        Where a part is unknown, a weight is below zero, or none is above.
    """
    chosen = {name: float(psf.metadata["weight"]) for name, psf in psfs.items()}
    if weights is not None:
        for name, weight in weights.items():
            refuse.one_of("weights", name, COMPONENTS)
            refuse.between(f"weight of '{name}'", weight, 0, 1e6)
        # What scatters nothing has no pattern.
        chosen = {name: float(weights.get(name, 0.0)) if share else 0.0 for name, share in chosen.items()}
    whole = sum(chosen.values())
    if not whole > 0:
        raise refuse.Refusal("'weights' must have one above 0 for a part that scatters light.")
    return sum(np.float32(chosen[name] / whole) * psfs[name].pixels for name in psfs)  # type: ignore[return-value]


def bent(psf: Picture, offset: float) -> Picture:
    """Bend a pattern of streaks as J. Delavennat's thesis (2021, Figure 3.7) does: moved by sin x.

    Parameters
    ----------
    psf : Picture
        Of lashes; its core lies at (rows//2, columns//2).
    offset : float
        By how many pixels, downward, a place at x = 1 is moved over sin 1; x is -1 to 1 across the columns.

    Returns
    -------
    Picture
        Each column moved down by offset · sin x; what leaves the frame is lost.
    """
    rows, columns = psf.pixels.shape[:2]
    moved = refuse.finite("offset", offset) * np.sin(
        (np.arange(columns) - columns // 2) / max(columns / 2, 1)
    )
    whole = np.floor(moved).astype(int)
    part = (moved - whole).astype(np.float32)[:, None]
    pixels = np.zeros_like(psf.pixels)
    for step, share in ((0, 1 - part), (1, part)):
        places = np.arange(rows)[:, None] - whole - step
        inside = ((places >= 0) & (places < rows))[..., None]
        pixels += np.where(inside, psf.pixels[np.clip(places, 0, rows - 1), np.arange(columns)], 0) * share
    return Picture(pixels, psf.colour_space, psf.metadata)


def _pattern(
    state: EyeState,
    name: str,
    amplitude: NDArray[np.float32],
    energy: float,
    frame: Frame,
    lamp: Lamp,
    tail: bool,
    shares: Mapping[str, float],
) -> NDArray[np.float32]:
    """Return the pattern of one part."""
    pixels = np.zeros((*frame.shape, 3), dtype=np.float32)
    if not energy > 0:
        if name == "bloom":
            pixels[frame.shape[0] // 2, frame.shape[1] // 2] = 1
        return pixels
    if shares[name] == 0:
        return pixels
    width = MARGIN * state.pupil_diameter
    opening = focused(Aperture(width, mask=amplitude), state)
    area = energy * (width / len(amplitude)) ** 2
    rest = "none" if not tail else "core" if name == "bloom" else "all"
    veil = Veil.of(state.eye, shares[name]) if tail and name == "corona" else None
    return pattern_of(opening, area, frame, lamp, veil, rest, tail)


def _amplitudes(parts: Parts, components: Sequence[str]) -> Iterator[tuple[str, NDArray[np.float32]]]:
    """Yield each part's amplitude within the open pupil, less its mean."""
    bloom = parts["bloom"]
    for name in components:
        if name == "bloom":
            yield name, bloom
        else:
            amplitude = parts[name] - np.float32(_mean(parts, name))
            amplitude *= bloom
            yield name, amplitude


def _mean(parts: Parts, name: str) -> float:
    whole = float(parts["bloom"].sum(dtype=np.float64))
    return float(np.vdot(parts["bloom"], parts[name])) / whole if whole > 0 else 0.0


def _passing(parts: Parts) -> float:
    """Return the energy in pixels that passes all parts; particles take none."""
    through = np.square(1 - parts["halo"])
    through *= 1 - parts["streaks"]
    return float(np.vdot(parts["bloom"], through))
