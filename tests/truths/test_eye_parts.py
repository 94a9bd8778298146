"""The eye's parts on pixels: areas in closed form, and far fields of the exact outlines."""

import math

import numpy as np
import pytest

from aureole import Aperture, aperture, diffraction

SIZE, WIDTH = 256, 1e-3
PIXEL = WIDTH / SIZE


def discs(*places):
    table = np.array(places)
    return aperture.Discs(table[:, :2], table[:, 2])


def amplitude(mask, grid):
    """Far field of what the pixels are means of: without their own sinc."""
    raster = diffraction.far_field(
        Aperture(WIDTH, mask=mask), grid, "fft" if grid.centre == (0, 0) else "auto"
    )
    v, u = grid.axes()
    return raster.amplitude / (np.sinc(v * PIXEL)[:, None] * np.sinc(u * PIXEL))


def exact(outlines, grid):
    return diffraction.far_field(Aperture(WIDTH, outlines), grid, "reference").amplitude


@pytest.mark.parametrize("radius", [0.1, 0.45, 0.8, 1.6, 7.3, 60.0])
def test_a_disc_covers_its_area_wherever_it_lies(radius):
    for x, y in ((0.0, 0.0), (10.3, -4.7), (0.5, 0.5), (-3.99, 2.01)):
        covered = aperture.disc_coverage(discs((x * PIXEL, y * PIXEL, radius * PIXEL)), SIZE, WIDTH)
        assert covered.sum(dtype=float) == pytest.approx(math.pi * radius**2, rel=2e-6)
        assert covered.min() >= 0
        assert covered.max() <= 1
