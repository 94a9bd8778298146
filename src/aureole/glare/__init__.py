"""The glare of a camera or an eye: its point spread function, and laying it over a picture.

In: cameras, pictures, spectra. Out: point spread functions in RGB, pictures with glare, kernels for
other programs. A point spread function is energy per pixel: over the infinite plane each channel
sums to 1, and a finite one carries the fraction that it holds.

camera      cameras, and their point spread functions
camera_field  a camera's glare that changes over the frame
kernel      fading, non-negative kernels, what other programs expect
area_light  lights with a size behind what hides parts of them: powers of their points, added up
power_sums  powers of many openings added up: a transform each, few for all, or from change to change
coherent_modes  few fields that stand for those of many openings that differ little
moving_power  the same while occluders move, each frame from the one before
area_psf    the same in colour on a camera's pixels, and as a picture of the lamp with its glare
visibility  how much of the opening each pixel sees past an occluder, out of focus
lamp_layer  a lamp behind occluders as its light lies on a frame
neighbourhood  what crops the iris, guessed from the picture about a light
composite   replace, scatter, add and bloom
bloom       glare from box to box of a few pixels, and near lights from pixel to pixel, for speed
bloom_error how far that is from the full convolution, told from a few pixels
sources     which light of a picture makes glare: the knee, the matte
lamps       the lights that a picture shows: place, flux, colour, size
lamp_matte  which light of a picture is that of its lamps
tracks      the same through a shot, each with a number that stays
lamp_files  both in a file, a line each

The eye:
eye             what an eye is made of, its state at a time, and the named eyes
eye_pupil       how wide the pupil stands, and how it trembles
eye_motion      fluctuations of the lens, and the vitreous that turns after the head
eye_lids        blinks and squinting
eye_adaptation  the scene's luminance, damped in time
eye_noise       noise in time with a given spectrum
veil            published glare functions of the eye, by angle, age and pigment
eye_particles   particles of cornea, lens and vitreous that scatter what CIE 135 says
eye_aperture    the eye's parts as amplitudes on the plane of its pupil
eye_composite   an eye's glare on a picture, weighed by solid angle
eye_field       glare that changes with the source's place, and layers by the source's strength
eye_spread      convolution at half resolution
eye_stars       small sources, measured whole so that they do not flicker
eye_wave        the wave behind the pupil: its power over frequency, ready for any pixels
eye_pixels      where pixels lie in angle, and what falls into them
eye_pattern     wavelengths, and the veil beyond the wave's reach
eye_components  the patterns of the eye's parts one by one, and their shares of the light
eye_psf         the eye's point spread function
photosafe       limiting how often a sequence of pictures flashes
eye_picture     a picture of these parts, for people to look at
glare_frames    room for glare patterns of one size, as spectra
flipbook        the parts' patterns through the eye's range of motion
flipbook_files  flipbooks in a file
fresh_glare     the same from a wave computed for every picture
flipbook_error  how far flipbooks are from that wave
real_time       a moving eye's glare on pictures, many times a second
"""

from aureole.glare.area_light import (
    AreaLight,
    AreaPower,
    LightSamples,
    area_power,
    difference,
    light_samples,
    sample_openings,
)
from aureole.glare.area_psf import AreaPsf, area_glare, area_psf, area_psf_stages, lamp_picture
from aureole.glare.bloom_error import bloom_psnr
from aureole.glare.camera import camera, camera_psf, camera_psf_stages, pupil
from aureole.glare.camera_field import (
    camera_at,
    camera_direction,
    camera_places,
    camera_within,
    field_prepare,
    open_share_of,
    vignette,
)
from aureole.glare.composite import EYE_MODES, MODES, Composition, composite, prepare
from aureole.glare.eye import Eye, EyeState, check_eye, eye_named, states
from aureole.glare.eye_adaptation import adapted, adapted_after
from aureole.glare.eye_aperture import COMPONENTS, corona_layers, eye_aperture, eye_parts, open_share
from aureole.glare.eye_components import THESIS_WEIGHTS, component_psfs, component_weights
from aureole.glare.eye_composite import (
    BORDERS,
    EyeComposition,
    eye_composite,
    eye_prepare,
    solid_angle_weights,
    tangent_pitch,
)
from aureole.glare.eye_field import axis_nodes, eye_field, eye_stamps, field_places, radial_layers
from aureole.glare.eye_lids import blinks
from aureole.glare.eye_particles import Population, populations, scattered_share
from aureole.glare.eye_picture import eye_picture
from aureole.glare.eye_psf import eye_psf, eye_psf_stages
from aureole.glare.eye_pupil import pupil_diameter, ritschel_diameter
from aureole.glare.eye_spread import RESOLUTIONS
from aureole.glare.eye_stars import compact_light, lumps
from aureole.glare.flipbook import FRAMES, Flipbooks, eye_patterns, make_flipbooks, make_flipbooks_stages
from aureole.glare.flipbook_error import FlipbookError, flipbook_error
from aureole.glare.flipbook_files import load_flipbooks, save_flipbooks
from aureole.glare.fresh_glare import FreshGlare
from aureole.glare.glare_frames import pattern_field, pattern_shape
from aureole.glare.kernel import HOSTS, encircled_energy, fade, kernel_for, nonnegative
from aureole.glare.lamp_files import LampList, read_lamps, write_lamps
from aureole.glare.lamp_layer import LampPatch, lamp_layer, lamp_patch, lamp_reach
from aureole.glare.lamp_matte import lamp_matte, lit_about
from aureole.glare.lamps import MOST_LAMPS, Lamp, find_lamps, lamp_threshold, luminances
from aureole.glare.moving_power import MovingPower
from aureole.glare.neighbourhood import (
    INSIDE,
    circle_about,
    cropped_opening,
    light_pixels,
    neighbourhood_radius,
)
from aureole.glare.photosafe import FlashLimiter, flash_measures, flashes
from aureole.glare.power_sums import ModeSum, PowerSum, Summing, TransformSum, power_sum
from aureole.glare.real_time import RealTimeGlare
from aureole.glare.sources import KNEES, above_knee
from aureole.glare.tracks import PATIENCE, LampTracker, Sighting, lasting, track_lamps
from aureole.glare.veil import cie_135, cie_146, hemisphere_energy, spencer, stiles_holladay
from aureole.glare.visibility import visibility

__all__ = [
    "BORDERS",
    "COMPONENTS",
    "EYE_MODES",
    "FRAMES",
    "HOSTS",
    "INSIDE",
    "KNEES",
    "MODES",
    "MOST_LAMPS",
    "PATIENCE",
    "RESOLUTIONS",
    "THESIS_WEIGHTS",
    "AreaLight",
    "AreaPower",
    "AreaPsf",
    "Composition",
    "Eye",
    "EyeComposition",
    "EyeState",
    "FlashLimiter",
    "FlipbookError",
    "Flipbooks",
    "FreshGlare",
    "Lamp",
    "LampList",
    "LampPatch",
    "LampTracker",
    "LightSamples",
    "ModeSum",
    "MovingPower",
    "Population",
    "PowerSum",
    "RealTimeGlare",
    "Sighting",
    "Summing",
    "TransformSum",
    "above_knee",
    "adapted",
    "adapted_after",
    "area_glare",
    "area_power",
    "area_psf",
    "area_psf_stages",
    "axis_nodes",
    "blinks",
    "bloom_psnr",
    "camera",
    "camera_at",
    "camera_direction",
    "camera_places",
    "camera_psf",
    "camera_psf_stages",
    "camera_within",
    "check_eye",
    "cie_135",
    "cie_146",
    "circle_about",
    "compact_light",
    "component_psfs",
    "component_weights",
    "composite",
    "corona_layers",
    "cropped_opening",
    "difference",
    "encircled_energy",
    "eye_aperture",
    "eye_composite",
    "eye_field",
    "eye_named",
    "eye_parts",
    "eye_patterns",
    "eye_picture",
    "eye_prepare",
    "eye_psf",
    "eye_psf_stages",
    "eye_stamps",
    "fade",
    "field_places",
    "field_prepare",
    "find_lamps",
    "flash_measures",
    "flashes",
    "flipbook_error",
    "hemisphere_energy",
    "kernel_for",
    "lamp_layer",
    "lamp_matte",
    "lamp_patch",
    "lamp_picture",
    "lamp_reach",
    "lamp_threshold",
    "lasting",
    "light_pixels",
    "light_samples",
    "lit_about",
    "load_flipbooks",
    "luminances",
    "lumps",
    "make_flipbooks",
    "make_flipbooks_stages",
    "neighbourhood_radius",
    "nonnegative",
    "open_share",
    "open_share_of",
    "pattern_field",
    "pattern_shape",
    "populations",
    "power_sum",
    "prepare",
    "pupil",
    "pupil_diameter",
    "radial_layers",
    "read_lamps",
    "ritschel_diameter",
    "sample_openings",
    "save_flipbooks",
    "scattered_share",
    "solid_angle_weights",
    "spencer",
    "states",
    "stiles_holladay",
    "tangent_pitch",
    "track_lamps",
    "vignette",
    "visibility",
    "write_lamps",
]
