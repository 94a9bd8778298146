"""Draw what merging does to ghosts, as the tile paper's Figures 8 and 12 do.

    python docs/ghosts.py levels NONE LIGHT HEAVY
    python docs/ghosts.py insets PICTURE
    python docs/ghosts.py filters PLAIN SPECTRAL FINE

levels: a ghost of the Nikon zoom as quads of rays, unmerged and merged; a colour a size.
insets: the Heliar with one light and with two; below, where tiles and heavy merging differ most from the
reference, both and a hundred times their difference.
filters: a ghost's edge in three flat colours, the same blurred along its dispersion, and in bands of colour.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import Picture, flare, light, picture
from aureole.flare import filters, pupil, tracing
from aureole.picture.transfer import decode_srgb

SHAPE, TIMES = (540, 960), 100
NIKON, PATH, ANGLES = "nikon_tele_zoom_140mm_seed", (1, 17), (4.0, 2.5)
HELIAR, F_NUMBER = "heliar_tronnier_100mm", 16.0
PLACES = ((0.3, 0.3), (0.62, 0.72))
INSET, GAP = (160, 312), 12
EDGE = ((300, 460), (0, 280))
Pixels = NDArray[np.float32]


def levels() -> list[Pixels]:
    """Return the paper's Figure 8 as display values."""
    lens = flare.load(NIKON)
    source = flare.light_at(*np.radians(ANGLES))
    prepared = tracing.prepare(lens, [550e-9])
    [sheet] = pupil.sheets(prepared, [flare.path_of(lens, PATH)], source.direction, 97)
    frame = flare.frame_of(lens, (1080, 1920))
    return [flare.merge_picture(sheet, frame, merge, (480, 480)) for merge in ("none", "light", "heavy")]


def insets() -> list[Pixels]:
    """Return the paper's Figure 12 as one picture of linear colour."""
    lens, (rows, columns) = flare.load(HELIAR), SHAPE
    sources = [flare.light_on_picture(lens, (x * columns, y * rows), SHAPE) for x, y in PLACES]
    halves = []
    for lights in (sources[:1], sources):
        settings = {"ghosts": "paper", "f_number": F_NUMBER, "grid": 128}
        fast = _rgb(flare.render(lens, lights, SHAPE, merge="heavy", **settings))
        truth = _rgb(flare.render(lens, lights, SHAPE, merge="none", method="reference", **settings))
        exposure = np.percentile(truth, 99.9)
        difference = TIMES * np.abs(fast - truth)
        top, left = _worst(difference)
        cut = np.s_[top : top + INSET[0], left : left + INSET[1]]
        below = [each[cut] for each in (fast, truth, difference)]
        gap = np.full((INSET[0], GAP, 3), exposure, np.float32)
        strip = np.concatenate([below[0], gap, below[1], gap, below[2]], axis=1)
        line = np.full((GAP, columns, 3), exposure, np.float32)
        halves.append(np.concatenate([fast, line, strip]) / exposure)
    return [np.concatenate([halves[0], np.ones((len(halves[0]), GAP, 3), np.float32), halves[1]], axis=1)]


def three_filters() -> list[Pixels]:
    """Return a ghost's edge in flat colours, filtered, and in bands."""
    lens = flare.load("zeiss_biotar_50mm")
    source = flare.light_at(*np.radians((12.0, -6.0)), spectrum=light.illuminant("D65"))
    settings = {"wavelengths": 3, "ghosts": "all"}
    flat = flare.render(lens, source, SHAPE, blend="flat", **settings)
    bands = flare.render(lens, source, SHAPE, **settings)
    found = [_rgb(each) for each in (flat, filters.spectral(flat, 0.02), bands)]
    exposure = np.percentile(found[2], 99.5)
    (top, bottom), (left, right) = EDGE
    return [each[top:bottom, left:right] / exposure for each in found]


def _rgb(given: Picture) -> Pixels:
    return light.convert(given, "rec709").pixels


def _worst(difference: Pixels) -> tuple[int, int]:
    """Return the upper left corner of the window that holds most of a difference."""
    sums = ndimage.uniform_filter(difference.sum(axis=2), INSET, mode="constant")
    inner = sums[INSET[0] // 2 : -(INSET[0] // 2), INSET[1] // 2 : -(INSET[1] // 2)]
    top, left = np.unravel_index(np.argmax(inner), inner.shape)
    return int(top), int(left)


def draw(kind: str, paths: list[Path]) -> None:
    """Write the pictures of one figure."""
    made = {"levels": levels, "insets": insets, "filters": three_filters}[kind]()
    for pixels, path in zip(made, paths, strict=True):
        shown = np.ascontiguousarray(np.clip(pixels, 0, 1), dtype=np.float32)
        if kind == "levels":
            shown = decode_srgb(shown)
        picture.write(path, Picture(shown, "rec709"))


if __name__ == "__main__":
    draw(sys.argv[1], [Path(name) for name in sys.argv[2:]])
