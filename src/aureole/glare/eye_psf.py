"""The point spread function of an eye, in angle: wave optics near the source, CIE 135's veil beyond.

One amplitude over the entrance pupil makes the pattern: |FT|² of pupil, lids, lens fibres, particles and
lashes together. Where the raster's frequencies end, the pattern fades into the glare function of CIE 135 for
the eye's age and pigment; what is then missing to the whole energy of the hemisphere is left in the core.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.glare.eye import EyeState
from aureole.glare.eye_components import bent, combined, component_psfs, whole_opening
from aureole.glare.eye_pattern import (
    FEWEST_PIXELS,
    MARGIN,
    REFERENCE_WAVELENGTH,
    WAVELENGTHS,
    Veil,
    lamp_of,
    pattern_of,
    raster_size,
)
from aureole.glare.eye_pixels import Frame
from aureole.glare.eye_wave import FADE_START
from aureole.glare.kernel import nonnegative
from aureole.records import Picture, Spectrum, Stage

COMBINATIONS = ("coherent", "thesis")


def eye_psf(
    state: EyeState,
    shape: tuple[int, int],
    field_of_view: float,
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    combine: str = "coherent",
    tail: bool = True,
    projection: str = "angle",
    source: tuple[float, float] = (0.0, 0.0),
    size: int | None = None,
    wavelengths: int = WAVELENGTHS,
    weights: Mapping[str, float] | None = None,
    streak_bend: float = 0.0,
) -> Picture:
    """Return the point spread function of an eye.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    shape : tuple of int
        (rows, columns) of the result; the core lies at (rows//2, columns//2).
    field_of_view : float
        Radians across the columns.
    spectrum : Spectrum, optional
        The light's; equal energy unless given. A single line gives three equal channels.
    colour_space : str
        Primaries of the result.
    combine : {"coherent", "thesis"}
        "coherent" transforms all parts of the eye as one amplitude. "thesis" adds the patterns of pupil,
        fibres, particles and lashes as intensities, as J. Delavennat's thesis (2021) does.
    tail : bool
        Whether CIE 135's glare function follows where wave optics ends; False is wave optics alone.
    projection : str
        "angle", equal angles a pixel; "perspective", as pictures have them.
    source : tuple of float
        Direction of the light off the line of sight, (right, down) in radians: the lashes' shadow moves.
    size : int, optional
        Pixels a side of the amplitude on the pupil, even; enough for 6 degrees unless given, or for the
        field where that is smaller. Few pixels make quick previews, and the veil begins nearer.
    wavelengths : int
        At least so many, over 380 to 770 nm; more where streaks would fall apart into dots.
    weights : mapping of str to float, optional
        Brightness of the four patterns for "thesis", such as `THESIS_WEIGHTS` (its Eq. 3.4); their shares of
        the light unless given.
    streak_bend : float
        For "thesis": radians by which the lashes' streaks are bent, as its Figure 3.7 does, where they leave
        the frame on the right (over sin 1). Curved lashes bend them without this.

    Returns
    -------
    Picture
        Shape (rows, columns, 3), energy fraction of each pixel, none negative; each channel sums to 1 over
        the hemisphere. Its metadata has `degrees_per_pixel` (on the axis), `energy_inside` (mean over
        channels), `pupil_diameter` (m), `reach` (radians at 575 nm where the veil takes over) and `size`.
        Closed lids leave all light in the core's pixel.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    psf = None
    for stage in eye_psf_stages(
        state,
        shape,
        field_of_view,
        spectrum,
        colour_space,
        combine,
        tail,
        projection,
        source,
        size,
        wavelengths,
        weights,
        streak_bend,
    ):
        psf = stage.result
    assert isinstance(psf, Picture)
    return psf


def eye_psf_stages(
    state: EyeState,
    shape: tuple[int, int],
    field_of_view: float,
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    combine: str = "coherent",
    tail: bool = True,
    projection: str = "angle",
    source: tuple[float, float] = (0.0, 0.0),
    size: int | None = None,
    wavelengths: int = WAVELENGTHS,
    weights: Mapping[str, float] | None = None,
    streak_bend: float = 0.0,
) -> Iterator[Stage]:
    """Do what `eye_psf` does, telling how far it is.

    Parameters
    ----------
    state : EyeState
        As in `eye_psf`.
    shape : tuple of int
        As in `eye_psf`.
    field_of_view : float
        As in `eye_psf`.
    spectrum : Spectrum, optional
        As in `eye_psf`.
    colour_space : str
        As in `eye_psf`.
    combine : str
        As in `eye_psf`.
    tail : bool
        As in `eye_psf`.
    projection : str
        As in `eye_psf`.
    source : tuple of float
        As in `eye_psf`.
    size : int, optional
        As in `eye_psf`.
    wavelengths : int
        As in `eye_psf`.
    weights : mapping of str to float, optional
        As in `eye_psf`.
    streak_bend : float
        As in `eye_psf`.

    Yields
    ------
    Stage
        The last one holds the point spread function.
    """
    refuse.one_of("combine", combine, COMBINATIONS)
    frame = Frame.checked(shape, field_of_view, projection)
    refuse.one_of("colour_space", colour_space, light.SPACES)
    refuse.at_least("wavelengths", wavelengths, 1)
    refuse.finite("streak_bend", streak_bend)
    if combine != "thesis" and (weights is not None or streak_bend):
        raise refuse.Refusal("'weights' and 'streak_bend' belong to combine 'thesis'; 'coherent' has none.")
    many = raster_size(state, frame) if size is None else refuse.at_least("size", size, FEWEST_PIXELS)
    yield Stage(0.0, "parts of the eye")
    if combine == "thesis":
        psfs = component_psfs(
            state, shape, field_of_view, spectrum, colour_space, tail, projection, source, many, wavelengths
        )
        psfs["streaks"] = bent(psfs["streaks"], streak_bend / frame.step)
        pixels = combined(psfs, weights)
    else:
        width = MARGIN * state.pupil_diameter
        opening, energy = whole_opening(state, many, width, source)
        yield Stage(0.4, "diffraction in the eye")
        if energy > 0:
            lamp = lamp_of(spectrum, colour_space, frame, wavelengths)
            veil = Veil.of(state.eye) if tail else None
            pixels = pattern_of(opening, energy, frame, lamp, veil, "core" if tail else "none", tail)
        else:
            pixels = _in_one_pixel(frame)
    psf = nonnegative(Picture(pixels, colour_space))
    yield Stage(
        1.0, "point spread function", Picture(psf.pixels, colour_space, _told(psf, state, frame, many))
    )


def _in_one_pixel(frame: Frame) -> NDArray[np.float32]:
    """Return what closed lids leave of a point: nothing is spread."""
    pixels = np.zeros((*frame.shape, 3), dtype=np.float32)
    pixels[frame.shape[0] // 2, frame.shape[1] // 2] = 1
    return pixels


def _told(psf: Picture, state: EyeState, frame: Frame, size: int) -> dict[str, Any]:
    """Return the metadata of a point spread function."""
    last = FADE_START * 0.5 * size / (MARGIN * state.pupil_diameter)
    return {
        "degrees_per_pixel": math.degrees(frame.step),
        "energy_inside": float(psf.pixels.sum(axis=(0, 1), dtype=np.float64).mean()),
        "pupil_diameter": state.pupil_diameter,
        "reach": math.asin(min(1.0, last * REFERENCE_WAVELENGTH)),
        "size": size,
    }
