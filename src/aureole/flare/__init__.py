"""The lens and its ghosts: glass, coatings, prescriptions, rays, and the picture that they make.

In: a lens's name or its file, and lights. Out: a `Lens`, its ghosts, what they carry, their picture. Light
travels along +z from the first surface to the sensor; lengths are metres; surfaces are counted from 0 inside
and from 1 where people read them.

glass          the refractive index: a catalogue's Sellmeier constants, or Cauchy through n_d and V_d
coating        what bare and coated interfaces reflect and transmit, by angle, wavelength, polarisation
prescription   `Lens` and `Surface`; reading and checking a lens
lens_file      writing a lens as TOML
ghost_paths    the ways of two reflections and of four, their names and counts
paraxial       matrices of the image and of ghosts; focal length, focus, f-number, pupil, axial colour
housing        the rims of a lens as they are seen from the front: near the axis, or by real rays
lint           what looks wrong in a prescription
importers      lens files of other programs; import_*: one format a file, `import_draft` makes a lens of it
rays           real rays, one loop for every way: the truth for faster tracers
tracing        the same compiled: many rays, wavelengths and ghosts at a time
probes         coarse rays: which part of the pupil makes a ghost, and how finely it must be sampled
pupil          regular grids of rays over each ghost's part of the pupil
primitives     quads of a ray grid that carry light into the picture, merged where none is missed; the frame
merge_picture  the outlines of a ghost's primitives, coloured by how many cells they were merged of
barycentric    how much each corner of a quad says about a point in it: the tile paper's ways and the bilinear
raster         the picture of primitives: each on its own, or by tiles
filters        over pictures of ghosts: a blur along the dispersion, a median
spectral       which wavelengths are traced, and the bands of colour drawn between them
lights         lights by angle, by place on the picture, of a size, of a colour, found in a picture
ghost_colour   how a ghost's light goes with the wavelength between those traced
energy         what each ghost carries by sheets of rays; ranked, chosen, compared with the image
random_rays    the same by random rays: the truth
blending       sheets at few wavelengths, drawn in many bands of colour
iris           the stop's opening as a mask, with ringing or without
render         all of it: lights in, the picture of the ghosts out, whole or ghost by ghost
"""

from aureole.flare.coating import Coating, Layer, quarter_wave, reflectance
from aureole.flare.energy import (
    chosen,
    ghost_energies,
    ghost_powers,
    ghost_to_image,
    ranked,
    shortlist,
    strongest,
)
from aureole.flare.ghost_paths import (
    GhostPath,
    counts,
    four_bounces,
    ghosts,
    only,
    path_named,
    path_of,
    without,
)
from aureole.flare.glass import AIR, Glass, index, named
from aureole.flare.housing import SeenPupil, TracedHousing, housing_rims, stop_outline
from aureole.flare.importers import import_lens, open_lens
from aureole.flare.lens_file import to_toml, write
from aureole.flare.lights import colour_spectrum, find_lights, light_at, light_on_picture, place_on_picture
from aureole.flare.lint import Finding, findings
from aureole.flare.merge_picture import merge_picture
from aureole.flare.prescription import Lens, Surface, ZoomState, at_state, load, with_coating
from aureole.flare.primitives import Frame, Merge, Primitives, construct, frame_of
from aureole.flare.random_rays import Estimate, monte_carlo
from aureole.flare.raster import rasterize
from aureole.flare.rays import Traced, power, trace_reference
from aureole.flare.render import GhostLayer, Options, render, render_layers, render_stages
from aureole.flare.spectral import sample_spectrum

__all__ = [
    "AIR",
    "Coating",
    "Estimate",
    "Finding",
    "Frame",
    "GhostLayer",
    "GhostPath",
    "Glass",
    "Layer",
    "Lens",
    "Merge",
    "Options",
    "Primitives",
    "SeenPupil",
    "Surface",
    "Traced",
    "TracedHousing",
    "ZoomState",
    "at_state",
    "chosen",
    "colour_spectrum",
    "construct",
    "counts",
    "find_lights",
    "findings",
    "four_bounces",
    "frame_of",
    "ghost_energies",
    "ghost_powers",
    "ghost_to_image",
    "ghosts",
    "housing_rims",
    "import_lens",
    "index",
    "light_at",
    "light_on_picture",
    "load",
    "merge_picture",
    "monte_carlo",
    "named",
    "only",
    "open_lens",
    "path_named",
    "path_of",
    "place_on_picture",
    "power",
    "quarter_wave",
    "ranked",
    "rasterize",
    "reflectance",
    "render",
    "render_layers",
    "render_stages",
    "sample_spectrum",
    "shortlist",
    "stop_outline",
    "strongest",
    "to_toml",
    "trace_reference",
    "with_coating",
    "without",
    "write",
]
