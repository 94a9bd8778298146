"""A sequence's frames made small, on one sheet to look at."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from aureole import picture
from aureole.jobs.contact_sheet import sheet, tile
from aureole.jobs.sequence_video import SHOWN
from aureole.records import Picture, Stage


def sheet_stages(frames: Sequence[Path]) -> Iterator[Stage]:
    """Lay frames that lie there on one sheet, all at the exposure that suits the first.

    Parameters
    ----------
    frames : sequence of Path
        Pictures of one size, in their order; those that are display-referred files already (PNG, JPEG) are
        shown as they are.

    Yields
    ------
    Stage
        One for each frame; the last one holds an ndarray of (rows, columns, 3), ready for a display.
    """
    tiles, stops = [], 0.0
    finished = picture.format_of(frames[0]) in SHOWN
    for index, place in enumerate(frames):
        yield Stage(index / len(frames), f"contact sheet, {index} of {len(frames)} frames")
        seen = picture.read(place)
        if index == 0 and not finished:
            stops = picture.auto_exposure(seen)
        small = Picture(tile(seen.pixels[..., :3]), seen.colour_space)
        tiles.append(picture.to_display(small, stops, "clip" if finished else "filmic"))
    yield Stage(1.0, "contact sheet", sheet(tiles))
