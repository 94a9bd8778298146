"""Merged ray grids draw the picture of unmerged ones, more closely than the tile paper's, with its power."""

import numpy as np
import pytest

from aureole import flare, picture
from aureole.flare import paraxial, pupil, raster, tracing
from aureole.flare.primitives import Frame, construct

# Table 7: the lowest that its light and heavy merging came to, dB, exposed so that few pixels are clipped.
PRINTED = {"light": 45.9, "heavy": 45.0}
SHAPE = (270, 480)


def ghosts_of(name, numbers, f_number):
    lens = flare.load(name)
    prepared = tracing.prepare(lens, [550e-9], f_number or 1.01 * paraxial.f_number(lens))
    direction = np.array([0.12, 0.05, 1.0])
    paths = [flare.path_of(lens, pair) for pair in numbers]
    frame = Frame(SHAPE, lens.sensor[0] / SHAPE[1])
    return pupil.sheets(prepared, paths, direction / np.linalg.norm(direction), base=65), frame


def drawn(sheets, frame, merge, method="tiles"):
    found = construct(sheets, frame, merge=merge, clip=False)
    return raster.rasterize(found, np.ones((1, 3)), frame, method)[..., 0].astype(np.float64)


@pytest.mark.parametrize("name", ["heliar_tronnier_100mm", "zeiss_biotar_50mm"])
@pytest.mark.parametrize("f_number", [None, 16.0])
def test_merged_grids_draw_the_same_picture(name, f_number):
    sheets, frame = ghosts_of(name, [(1, 2), (2, 3), (2, 4), (3, 5), (7, 8)], f_number)
    truth = drawn(sheets, frame, "none", "reference")
    peak = np.quantile(truth, 0.999)
    for merge, printed in PRINTED.items():
        found = drawn(sheets, frame, merge)
        clipped = np.minimum(found, peak), np.minimum(truth, peak)
        assert picture.psnr(*clipped, peak=peak) > printed + 2
        assert found.sum() == pytest.approx(truth.sum(), rel=5e-3)


@pytest.mark.parametrize("merge", PRINTED)
def test_each_ghost_keeps_its_power(merge):
    sheets, frame = ghosts_of("heliar_tronnier_100mm", [(1, 3), (2, 4), (4, 5), (7, 8)], 8.0)
    wide = Frame((3 * SHAPE[0], 3 * SHAPE[1]), frame.pitch)
    for sheet in sheets:
        truth = drawn([sheet], wide, "none").sum()
        assert drawn([sheet], wide, merge).sum() == pytest.approx(truth, rel=1e-3)
