"""A picture of the eye's parts as they stand before its pupil, for people to look at.

The colours are ours: the pupil is white as the light that it lets through, so that what stands in the light
shows before it.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.aperture import Discs
from aureole.glare.eye import EyeState
from aureole.glare.eye_aperture import Source, lash_shadows, lid_shadow, moved_particles, state_fibres
from aureole.records import Picture

PICTURE_WIDTH = 12e-3
IRIS_RADIUS = 5.9e-3
# Linear colours; those of the iris belong to CIE 135's p.
WHITE_OF_EYE, PUPIL, SKIN, LASH = (
    (0.55, 0.52, 0.5),
    (0.85, 0.85, 0.85),
    (0.5, 0.27, 0.19),
    (0.01, 0.008, 0.006),
)
IRIS = {0.0: (0.03, 0.012, 0.005), 0.5: (0.13, 0.06, 0.025), 1.0: (0.1, 0.16, 0.07), 1.2: (0.2, 0.32, 0.5)}
FIBRE = (0.45, 0.6, 0.8)
# Of the cornea, the lens and the vitreous.
PARTICLES = ((0.1, 0.45, 0.1), (0.75, 0.3, 0.02), (0.55, 0.05, 0.35))
Colour = tuple[float, float, float]


def eye_picture(
    state: EyeState, size: int = 512, width: float = PICTURE_WIDTH, source: Source = (0.0, 0.0)
) -> Picture:
    """Draw an eye's parts: pupil, fibres, particles, iris, lids and lashes.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    size : int
        Pixels on each side.
    width : float
        Side of the square about the pupil's middle, metres; a small one shows the fibres.
    source : tuple of float
        Direction of the light, as in `eye_parts`.

    Returns
    -------
    Picture
        Linear Rec.709, shape (size, size, 3), as seen along the line of sight: particles of the cornea
        green, of the lens orange, of the vitreous purple.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("size", size, 1)
    refuse.positive("width", width)

    def disc(radius: float) -> NDArray[np.float32]:
        return apertures.disc_coverage(Discs(np.zeros((1, 2)), np.array([radius])), size, width)

    pigment = refuse.between("pigment", state.eye.pigment, 0, max(IRIS))
    red, green, blue = (
        float(np.interp(pigment, list(IRIS), part)) for part in zip(*IRIS.values(), strict=True)
    )
    drawing = np.empty((size, size, 3), dtype=np.float32)
    drawing[:] = WHITE_OF_EYE
    _paint(drawing, disc(IRIS_RADIUS), (red, green, blue))
    pupil = disc(state.pupil_diameter / 2)
    _paint(drawing, pupil, PUPIL)
    _paint(drawing, pupil * apertures.fibre_coverage(state_fibres(state), size, width), FIBRE)
    for colour, layer in zip(PARTICLES, moved_particles(state), strict=True):
        _paint(drawing, pupil * apertures.disc_coverage(layer, size, width), colour)
    between = np.ones((size, size), dtype=np.float32)
    apertures.close_lids(between, apertures.lids(state.lid_opening), width, lid_shadow(source))
    _paint(drawing, 1 - between, SKIN)
    _paint(drawing, apertures.lash_coverage(lash_shadows(state, source), size, width), LASH)
    return Picture(drawing, "rec709", {"width": width})


def _paint(drawing: NDArray[np.float32], part: NDArray[np.float32], colour: Colour) -> None:
    """Lay a colour over the part of each pixel that it covers, in place."""
    drawing += part[..., None] * (np.array(colour, dtype=np.float32) - drawing)
