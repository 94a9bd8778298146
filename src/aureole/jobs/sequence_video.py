"""A sequence as a video to look at: all its frames at one exposure."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from aureole import picture, refuse
from aureole.records import Stage

SHOWN = ("png", "jpeg")


def video_stages(
    frames: Sequence[Path], path: Path, rate: float, exposure: float | str = "auto"
) -> Iterator[Stage]:
    """Write a video of frames that lie there.

    Parameters
    ----------
    frames : sequence of Path
        Pictures of one size, in their order.
    path : Path
        The video, .mp4.
    rate : float
        Frames a second.
    exposure : float or str
        Stops, for all frames alike; "auto" takes those that suit the first frame. Frames that are
        display-referred files already (PNG, JPEG) are shown as they are.

    Yields
    ------
    Stage
        One for each frame; the last one holds the path.

    Raises
    ------
    refuse.Refusal
        Where there are no frames, they differ in size, or the video cannot be written.
    """
    if not frames:
        raise refuse.Refusal(f"no frame is there for '{path}'.")
    first = picture.read(frames[0])
    rows, columns = first.pixels.shape[:2]
    # What was made for screens is shown as it is.
    finished = picture.format_of(frames[0]) in SHOWN
    stops = 0.0 if finished else picture.auto_exposure(first) if exposure == "auto" else exposure
    with picture.video_file(path, (rows, columns), rate) as append:
        for index, place in enumerate(frames):
            yield Stage(index / len(frames), f"video, {index} of {len(frames)} frames")
            append(picture.to_display(picture.read(place), stops, "clip" if finished else "filmic"))
    yield Stage(1.0, "video", path)
