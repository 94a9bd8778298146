"""Videos to look at: display-ready pictures, one by one, as H.264 in MP4, written whole.

PyAV is needed (`pip install aureole[video]`); nothing else of the room depends on it. Colours are
Rec.709's, eight bits, with colour at half the resolution as players want it.
"""

import contextlib
import os
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture.whole_files import whole_file

SUFFIX = ".mp4"
# Constant quality of x264: 0 loses nothing, 51 is worst; at 16 losses are hard to see.
QUALITY = 16
# Whole rates that television slows down by a part in 1001, such as 23.976 for 24, written with few digits.
SLOWED = tuple(Fraction(whole * 1000, 1001) for whole in (24, 30, 48, 60, 120))
NEAR = 0.006
# ITU-T H.273's numbers: Rec.709 primaries and matrix, sRGB's curve, values from 16 to 235.
REC709, SRGB, NARROW = 1, 13, 1


def check_video(path: str | os.PathLike[str]) -> Path:
    """Refuse, before any work, a video that could not be written.

    Parameters
    ----------
    path : path_like
        Where it shall lie.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    refuse.Refusal
        Where its suffix is not .mp4, or PyAV is missing.
    """
    place = Path(path)
    if place.suffix.lower() != SUFFIX:
        raise refuse.Refusal(f"'video' must end in {SUFFIX}, got '{place}'.")
    _library()
    return place


@contextlib.contextmanager
def video_file(
    path: str | os.PathLike[str], shape: tuple[int, int], rate: float
) -> Iterator[Callable[[NDArray[np.float32]], None]]:
    """Write a video that appears whole or not at all.

    Parameters
    ----------
    path : path_like
        Where it shall lie, with suffix .mp4; one that exists is replaced.
    shape : tuple of int
        (rows, columns) of the pictures; an odd last row or column is repeated, as the format wants
        even sizes.
    rate : float
        Pictures a second.

    Yields
    ------
    callable
        Takes a picture, shape (rows, columns, 3), 0..1 and encoded as sRGB, and appends it.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written, PyAV is missing, or a picture has another size.
    """
    av = _library()
    check_video(path)
    speed = frame_rate(rate)
    # The index goes to the front, so that a browser shows the first pictures before it has all.
    front = {"movflags": "faststart"}
    with whole_file(path) as part, av.open(str(part), "w", options=front) as container:
        stream = container.add_stream("libx264", rate=speed)
        stream.height, stream.width = (length + length % 2 for length in shape)
        stream.pix_fmt = "yuv420p"
        coding = stream.codec_context
        coding.color_primaries, coding.colorspace = REC709, REC709
        coding.color_trc, coding.color_range = SRGB, NARROW
        # One thread, so that the file is the same on machines with any number of processors.
        stream.options = {"crf": str(QUALITY), "preset": "medium", "threads": "1"}

        def append(pixels: NDArray[np.float32]) -> None:
            frame = av.VideoFrame.from_ndarray(_eight_bits(pixels, shape), format="rgb24")
            container.mux(stream.encode(frame.reformat(format="yuv420p", dst_colorspace="ITU709")))

        yield append
        container.mux(stream.encode())


def frame_rate(rate: float) -> Fraction:
    """Return a rate as the fraction that videos count with.

    Parameters
    ----------
    rate : float
        Pictures a second, 0.001 to 1000.

    Returns
    -------
    Fraction
        24 for 24, 24000/1001 for 23.976 or 23.98.

    Raises
    ------
    refuse.Refusal
        Where the rate is outside its range.
    """
    asked = refuse.between("fps", rate, 1e-3, 1e3)
    near = [slow for slow in SLOWED if abs(asked - slow) < NEAR]
    return near[0] if near else Fraction(asked).limit_denominator(1001)


def _eight_bits(pixels: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.uint8]:
    """Return pixels as bytes, at even sizes."""
    refuse.shape_of("pixels", pixels, (*shape, 3))
    even = [(0, length % 2) for length in shape]
    whole = np.pad(pixels, (*even, (0, 0)), mode="edge") if any(shape[i] % 2 for i in (0, 1)) else pixels
    return np.ascontiguousarray(np.round(255 * np.clip(whole, 0, 1)).astype(np.uint8))


def _library() -> Any:
    try:
        import av
    except ImportError:
        raise refuse.Refusal("a video needs PyAV: pip install 'aureole[video]'.") from None
    return av
