"""How a blocked wave spreads: the far field, and starbursts from it.

In: apertures, grids in cycles per metre, spectra. Out: fields, patterns and pictures in XYZ.

far         far_field and far_power, their methods, and the chooser
reference   the slow truth: direct sums and boundary integrals in float64
quadtree    a mask as few signed rectangles
quads       the far field of rectangles as a product of one-dimensional factors
rows        the far field of a mask from its distinct rows
culling     its power where it may exceed a level, zero elsewhere
chirpz      chirp-z transform and FFT of a mask, times the pixel's sinc
cosines     cosine and sine transforms of a folded mask, where a real FFT would do more than is needed
polygons    the far field of exact outlines, straight edges, arcs and circles
changes     a running field of an aperture that changes: what the next two share
progressive the far field of an aperture that changes, from the change alone
autocorrelation  an opening laid over itself, shifted: pixel integrals at one wavelength
fresnel     the Fresnel integrals, from tables
corner      the corner function: what the end of a straight edge does to a wave
near        near_field, near_power and NearOperator: Fresnel diffraction at any distance, and the chooser
near_circles the near field of circles, exact: a table near the axis, edge waves elsewhere
near_arcs   the near field of rings with arcs, exact: few nodes along an edge, or its ends
near_pixels its methods for masks: products of tables of Fresnel integrals
near_culling its power where it may exceed a level, zero elsewhere
near_progressive the near field of an aperture that changes
near_fft    its convolution, where the plane's places have the pixels' pitch
near_outlines  its methods for exact outlines: integrals along their boundary
near_polygons  straight edges among them, corner by corner or as a product of two matrices
near_sums   powers of many wavelengths behind one aperture, added up in XYZ
near_picture  the near field in colour, exact or by the quad paper's approximation
ringing     ringing textures: the near field of a lens's stop, for ghosts
measures    transfer functions, Strehl ratio, encircled energy and cut-off of a pupil
coherence   all wavelengths of a straight-edged opening at once, in closed form
starburst   a whole starburst over all wavelengths, point samples or pixel integrals
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
