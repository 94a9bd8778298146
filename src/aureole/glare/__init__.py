"""The glare of a camera: its point spread function, and laying it over a picture.

In: cameras, pictures, spectra. Out: point spread functions in RGB, pictures with glare, kernels for
other programs. A point spread function is energy per pixel: over the infinite plane each channel
sums to 1, and a finite one carries the fraction that it holds.

camera      cameras, and their point spread functions
kernel      fading, non-negative kernels, what other programs expect
composite   replace, scatter and add

The eye:
veil           published glare functions of the eye, by angle, age and pigment
eye_particles  particles of cornea, lens and vitreous that scatter what CIE 135 says
"""

from aureole.glare.camera import camera, camera_psf, camera_psf_stages, pupil
from aureole.glare.composite import MODES, Composition, composite, prepare
from aureole.glare.kernel import HOSTS, encircled_energy, fade, kernel_for, nonnegative

__all__ = [
    "HOSTS",
    "MODES",
    "Composition",
    "camera",
    "camera_psf",
    "camera_psf_stages",
    "composite",
    "encircled_energy",
    "fade",
    "kernel_for",
    "nonnegative",
    "prepare",
    "pupil",
]
