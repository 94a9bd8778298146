"""The picture room: pictures in and out, convolution, display.

- `files`: what a file is, from its header; in: a path, out: a `Header`, or a refusal
- `reading`: in: a path, out: a linear `Picture`
- `writing`: in: a `Picture`, out: a file, and notes on what it could not hold
- `layers`: in: a `Picture` and layers that arrive one by one, out: one EXR with channels for each
- `whole_files`: in: a path, out: a temporary to write, which is renamed to the path once it is whole
- `metadata`: the records of what a file says, and the notes for the person who gave it
- `radiance`: words in the header of .hdr files
- `channels`: in: channel names, out: which of them are the picture
- `luminance_chroma`: in: Y, RY, BY at their own resolutions, out: RGB
- `primaries`: in: chromaticities, out: a colour space's name, and matrices between spaces
- `transfer`: in: linear light, out: the numbers of display-referred files, and back
- `color_config`: OpenColorIO configurations where one is given
- `torus`: in: sizes, out: the samples for a picture and a kernel, and the transforms along them
- `convolution`: in: pixels and a kernel, or kernels that share the pixels, out: pixels of the same size
- `mixing`: in: kernels, kept in 16 bits, and weights, out: pictures convolved with their sum
- `quality`: in: a picture and its reference, out: plain and logarithmic PSNR, SSIM
- `regions`: in: luminance and a threshold, out: connected bright regions, and what each measures
- `display`: in: linear pictures, out: pixels that are ready for a screen
- `video`: in: pixels that are ready for a screen, one by one, out: a video (MP4, H.264)
- `scene`: in: a size and a seed, out: the bundled night scene; `_canvas` and `_far_shore` draw for it
"""

from aureole.picture.convolution import MOST_SPECTRA, Convolver, PlacesConvolver, convolve
from aureole.picture.display import auto_exposure, false_colour, log_scale, side_by_side, to_display
from aureole.picture.files import SUFFIXES, allowed_memory, describe, format_of, refuse_memory
from aureole.picture.layers import Layers, attributes_of, write_layers
from aureole.picture.metadata import (
    Attribute,
    Channel,
    Colour,
    Header,
    Window,
    extra_channels,
    header_of,
    notes,
    with_attributes,
    with_notes,
)
from aureole.picture.mixing import KernelMix, MixedConvolver
from aureole.picture.quality import log_psnr, psnr, ssim
from aureole.picture.reading import read
from aureole.picture.regions import Regions, bright_labels, measured_regions
from aureole.picture.scene import night_scene
from aureole.picture.transfer import decode_srgb, encode_srgb, into_gamut
from aureole.picture.video import check_video, video_file
from aureole.picture.whole_files import clear_partials, whole_file, writable
from aureole.picture.writing import COMPRESSIONS, write

__all__ = [
    "COMPRESSIONS",
    "MOST_SPECTRA",
    "SUFFIXES",
    "Attribute",
    "Channel",
    "Colour",
    "Convolver",
    "Header",
    "KernelMix",
    "Layers",
    "MixedConvolver",
    "PlacesConvolver",
    "Regions",
    "Window",
    "allowed_memory",
    "attributes_of",
    "auto_exposure",
    "bright_labels",
    "check_video",
    "clear_partials",
    "convolve",
    "decode_srgb",
    "describe",
    "encode_srgb",
    "extra_channels",
    "false_colour",
    "format_of",
    "header_of",
    "into_gamut",
    "log_psnr",
    "log_scale",
    "measured_regions",
    "night_scene",
    "notes",
    "psnr",
    "read",
    "refuse_memory",
    "side_by_side",
    "ssim",
    "to_display",
    "video_file",
    "whole_file",
    "with_attributes",
    "with_notes",
    "writable",
    "write",
    "write_layers",
]
