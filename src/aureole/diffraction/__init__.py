"""How a blocked wave spreads: the far field and starbursts from it, and the near field.

In: apertures, grids in cycles per metre or metres, spectra. Out: fields, patterns and pictures in XYZ.

The far field:
far               far_field and far_power, their methods, and the chooser
reference         the slow truth: direct sums and boundary integrals in float64
polygons          exact outlines, straight edges, arcs and circles
quadtree          a mask as few signed rectangles
quads             the transform of rectangles as a product of one-dimensional factors
rows              the transform of a mask from its distinct rows
culling           the power where it may exceed a level, zero elsewhere
chirpz            chirp-z transform and FFT of a mask, times the pixel's sinc
cosines           cosine and sine transforms of a folded mask, where a real FFT would do more than is needed
progressive       an aperture that changes, from the change alone
changes           what progressive and near_progressive share
measures          transfer functions, Strehl ratio, encircled energy and cut-off of a pupil
autocorrelation   an opening laid over itself, shifted: pixel integrals at one wavelength

Starbursts:
starburst         a whole starburst over all wavelengths, point samples or pixel integrals
coherence         all wavelengths of a straight-edged opening at once, in closed form
core              the few pixels about the axis, where each fringe counts
discs             starbursts of disc-shaped lights
pixels            where pixels lie in frequency, and the nodes that integrate over them

The near field:
near              near_field, near_power and NearOperator, their methods, and the chooser
near_outlines     exact outlines: the reference along their boundary, and polygons' shares below
near_polygons     straight edges, corner by corner or as a product of two matrices
near_circles      circles: a table near the axis, edge waves elsewhere
near_arcs         rings with arcs: few nodes along an edge, or its ends
near_pixels       masks: the reference, quads and rows, products of tables of Fresnel integrals
near_fft          masks by convolution, where the plane's places have the pixels' pitch
near_culling      the power where it may exceed a level, zero elsewhere
near_progressive  an aperture that changes, from the change alone
near_picture      in colour, exact or by the quad paper's approximation
near_sums         powers of many wavelengths behind one aperture, added up in XYZ
ringing           ringing textures: the near field of a lens's stop, for ghosts
fresnel           the Fresnel integrals, from tables
corner            the corner function: what the end of a straight edge does to a wave
"""

from aureole.diffraction.far import METHODS, check_grid, far_field, far_power
from aureole.diffraction.measures import cutoff_frequency, encircled_energy, mtf, optical_transfer, strehl
from aureole.diffraction.near import NearOperator, near_field, near_power
from aureole.diffraction.near_picture import near_picture, near_picture_stages
from aureole.diffraction.near_progressive import ProgressiveNearField
from aureole.diffraction.progressive import ProgressiveFarField
from aureole.diffraction.quadtree import FINEST, Quads, difference_quads, level_mask, paint, quadtree
from aureole.diffraction.ringing import RingingTexture, ringing_texture, ringing_texture_stages
from aureole.diffraction.starburst import starburst, starburst_stages

__all__ = [
    "FINEST",
    "METHODS",
    "NearOperator",
    "ProgressiveFarField",
    "ProgressiveNearField",
    "Quads",
    "RingingTexture",
    "check_grid",
    "cutoff_frequency",
    "difference_quads",
    "encircled_energy",
    "far_field",
    "far_power",
    "level_mask",
    "mtf",
    "near_field",
    "near_picture",
    "near_picture_stages",
    "near_power",
    "optical_transfer",
    "paint",
    "quadtree",
    "ringing_texture",
    "ringing_texture_stages",
    "starburst",
    "starburst_stages",
    "strehl",
]
