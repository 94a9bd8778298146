"""Laws of screens without end: the half plane's closed form, opaque discs and squares, exact pixels."""

import math
import re

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture, refuse
from aureole.diffraction import far_field, near_field

WAVELENGTH = 550e-9
D = 2e-3
DISTANCE = 0.5
UNIT = math.sqrt(WAVELENGTH * DISTANCE / 2)


def field(shape, grid, distance=DISTANCE):
    return near_field(shape, grid, distance, WAVELENGTH, "polygons").amplitude.astype(complex)


def half_plane_field(depth):
    """(1 − i) / 2 (E(∞) + E(v)), E = C + iS, at v units inside the open half (Born and Wolf, 8.7.3)."""
    sine, cosine = special.fresnel(depth)
    return (0.5 - 0.5j) * (0.5 + cosine + 0.5j + 1j * sine)


def test_the_half_plane_in_figures():
    """1/4 at the edge, the first maximum 1.370, and the shadow darkens evenly (Born and Wolf, 8.7.3)."""
    grid = Grid((1, 1001), (UNIT, 0.01 * UNIT))
    power = np.abs(field(aperture.half_plane(width=D), grid)[0]) ** 2
    depth = -grid.axes()[1] / UNIT
    assert power[500] == pytest.approx(0.25, abs=1e-6)
    most = int(np.argmax(power))
    assert power[most] == pytest.approx(1.3704, abs=1e-4)
    assert depth[most] == pytest.approx(1.217, abs=6e-3)
    assert np.all(np.diff(power[500:]) < 0)
    least = int(np.argmin(np.where((depth > 1.5) & (depth < 2.2), power, 9)))
    assert power[least] == pytest.approx(0.778, abs=1e-3)


@pytest.mark.parametrize("rotation", [0.0, math.pi / 2, math.pi, -0.7, 2.0, 1e-9])
@pytest.mark.parametrize("offset", [0.0, 0.3e-3, -2e-3])
@pytest.mark.parametrize("distance", [1e-4, 0.5, 100.0])
def test_the_half_plane_everywhere(rotation, offset, distance):
    grid = Grid((11, 12), (0.3e-3, 0.2e-3), (0.1e-3, 0.0))
    y, x = grid.axes()
    depth = offset - (x * math.cos(rotation) - y[:, None] * math.sin(rotation))
    wanted = half_plane_field(depth / math.sqrt(WAVELENGTH * distance / 2))
    found = field(aperture.half_plane(offset, rotation, D), grid, distance)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-6)


def test_far_along_an_edge():
    """A thousand widths from where the edge is nearest the axis it is the same edge."""
    grid = Grid((3, 41), (D, 0.2e-3), (1000 * D, 0.0))
    wanted = half_plane_field(-grid.axes()[1] / UNIT)
    found = field(aperture.half_plane(width=D), grid)
    np.testing.assert_allclose(found, np.broadcast_to(wanted, (3, 41)), rtol=0, atol=2e-6)


def test_a_half_plane_on_pixels():
    """Coverage is exact: the cut of a slanted edge through the square, and pixels cut in half."""
    mask = aperture.rasterize(aperture.half_plane(width=D), 5)
    np.testing.assert_array_equal(mask, np.tile(np.float32([1, 1, 0.5, 0, 0]), (5, 1)))
    np.testing.assert_allclose(
        aperture.rasterize(aperture.half_plane(rotation=math.pi / 2, width=D), 4),
        np.tile([[0], [0], [1], [1]], (1, 4)),
        atol=1e-6,
    )
    for rotation in (0.3, 2.5, -1.2):
        whole = sum(
            aperture.rasterize(aperture.half_plane(sign * 0.2e-3, rotation + turn, D), 64)
            for sign, turn in ((1, 0), (-1, math.pi))
        )
        np.testing.assert_allclose(whole, 1, atol=1e-6)
        mask = aperture.rasterize(aperture.half_plane(0.0, rotation, D), 65)
        assert mask.mean() == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("distance", [0.02, 0.3, 6.0])
def test_arago_spot(distance):
    """Behind an opaque disc the axis is as bright as with nothing in the way (Fresnel 1818)."""
    found = field(aperture.obstacle(aperture.circle(D)), Grid((1, 1), (D, D)), distance)[0, 0]
    assert abs(found) ** 2 == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("distance", [0.02, 0.3, 6.0])
def test_an_opaque_square_leaves_what_the_wave_without_it_had(distance):
    """Babinet: 1 less the product of Fresnel integrals of an opening of its shape."""
    grid = Grid((9, 10), (0.3e-3, 0.25e-3))
    scale = math.sqrt(2 / (WAVELENGTH * distance))
    along = []
    for axis in grid.axes():
        (s0, c0), (s1, c1) = (special.fresnel(scale * (end - axis)) for end in (-D / 2, D / 2))
        along.append(c1 - c0 + 1j * (s1 - s0))
    wanted = 1 + 0.5j * along[0][:, None] * along[1]
    found = field(aperture.obstacle(aperture.rectangle(D, D)), grid, distance)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-6)


def test_a_grey_obstacle_lets_the_rest_through():
    grey = aperture.obstacle(aperture.dimmed(aperture.iris(6, D), 0.25))
    dark = aperture.obstacle(aperture.iris(6, D))
    grid = Grid((6, 7), (0.3e-3, 0.25e-3))
    np.testing.assert_allclose(field(grey, grid), 0.75 + 0.25 * field(dark, grid), rtol=0, atol=2e-6)
    assert aperture.rasterize(grey, 9)[4, 4] == 0.75
    assert aperture.rasterize(dark, 9)[4, 4] == 0


def test_far_fields_of_screens_are_numbers():
    grid = Grid((8, 9), (1 / D, 1 / D))
    for shape in (aperture.half_plane(width=D), aperture.obstacle(aperture.circle(D))):
        assert np.isfinite(far_field(shape, grid).amplitude).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: aperture.half_plane(math.nan), "'offset' must be a finite number, got nan."),
        (lambda: aperture.half_plane(0.0, math.inf), "'rotation' must be a finite number, got inf."),
        (lambda: aperture.half_plane(width=0), "'width' must be a finite number > 0, got 0."),
        (
            lambda: aperture.half_plane(1e6, width=0.5),
            "'offset' must be within 1e+06 widths of the axis, got 1e+06 m for a width of 0.5 m.",
        ),
        (
            lambda: aperture.obstacle(aperture.from_mask(np.ones((2, 2)), D)),
            "an obstacle needs outlines and this is a raster; take its near field as an opening from 1.",
        ),
    ],
)
def test_what_does_not_fit_is_refused(make, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        make()
