"""What blocks the light: openings with exact outlines, raster masks, and their composition.

In: sizes in metres, angles in radians, masks, pictures. Out: `aureole.Aperture` records and masks.

shapes     circle, rectangle, iris, polygon, whirl: openings whose edges are known exactly
masks      from_mask, from_picture and rasterize: between openings and pixels
compose    union, intersection, subtraction, dimmed, scaled, moved, rotated
chances    random numbers that are the same on every machine
dust       dust and scratches: an opening seen through dirt
particles  discs at seeded places, and how they move
fibres     rings of radial gratings
lashes     lids and lashes before a pupil
eyelashes  the same before any opening
housing    rims of a lens, and what they leave of light from off the axis
bands      work on a picture in bands of rows, on all cores
clipping   what of a ring lies within a circle, arcs kept exact
occluders  what stands between a light and an opening, and its shadow
obstructions  central discs, spider vanes, round shadows, and cat's eyes
screens    half planes, and obstacles with nothing around them
wavefront  wavefront errors of openings, and what pixels do to a wave
zernike    the polynomials that wavefronts are made of
geometry   arcs, chords, areas and moments of outlines, for the rooms above
"""

from aureole.aperture.chances import uniform
from aureole.aperture.compose import dimmed, intersection, moved, rotated, scaled, subtraction, union
from aureole.aperture.dust import dust, scratches
from aureole.aperture.eyelashes import LID_OPENING, eyelashes
from aureole.aperture.fibres import Fibres, fibre_coverage, fibre_outlines, fibres, stretched_fibres
from aureole.aperture.geometry import (
    GAUSS_NODES,
    Circle,
    arc_of,
    area,
    as_circle,
    boundary_nodes,
    central_moments,
    chords,
    energy,
    is_mirrored,
    orientation,
    ring_moments,
)
from aureole.aperture.housing import Rim, behind_rims, open_part, parallax
from aureole.aperture.lashes import Lids, close_lids, lash_coverage, lashes, lids
from aureole.aperture.masks import from_mask, from_picture, rasterize
from aureole.aperture.obstructions import cats_eye, obstruction, shadow, spiders
from aureole.aperture.occluders import Occluder, occluder, railing, seen_past
from aureole.aperture.particles import (
    Discs,
    disc_coverage,
    disc_outlines,
    joined,
    scattered,
    stretched,
    turned,
)
from aureole.aperture.screens import half_plane, obstacle
from aureole.aperture.shapes import circle, iris, polygon, rectangle, whirl
from aureole.aperture.wavefront import (
    bounding_radius,
    check_wavefront,
    steepest_step,
    transmittance,
    wavefront_rms,
    with_wavefront,
)
from aureole.aperture.zernike import ZERNIKE_NAMES, Term, zernike, zernike_pair

__all__ = [
    "GAUSS_NODES",
    "LID_OPENING",
    "ZERNIKE_NAMES",
    "Circle",
    "Discs",
    "Fibres",
    "Lids",
    "Occluder",
    "Rim",
    "Term",
    "arc_of",
    "area",
    "as_circle",
    "behind_rims",
    "boundary_nodes",
    "bounding_radius",
    "cats_eye",
    "central_moments",
    "check_wavefront",
    "chords",
    "circle",
    "close_lids",
    "dimmed",
    "disc_coverage",
    "disc_outlines",
    "dust",
    "energy",
    "eyelashes",
    "fibre_coverage",
    "fibre_outlines",
    "fibres",
    "from_mask",
    "from_picture",
    "half_plane",
    "intersection",
    "iris",
    "is_mirrored",
    "joined",
    "lash_coverage",
    "lashes",
    "lids",
    "moved",
    "obstacle",
    "obstruction",
    "occluder",
    "open_part",
    "orientation",
    "parallax",
    "polygon",
    "railing",
    "rasterize",
    "rectangle",
    "ring_moments",
    "rotated",
    "scaled",
    "scattered",
    "scratches",
    "seen_past",
    "shadow",
    "spiders",
    "steepest_step",
    "stretched",
    "stretched_fibres",
    "subtraction",
    "transmittance",
    "turned",
    "uniform",
    "union",
    "wavefront_rms",
    "whirl",
    "with_wavefront",
    "zernike",
    "zernike_pair",
]
