"""Laws of the near field of exact outlines: closed forms, Babinet, conservation, the far limit."""

import math

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture, refuse
from aureole.diffraction import far_field, near_field

WAVELENGTH = 550e-9
D = 2e-3  # metres, of every opening here
EXACT = 1e-9
METHODS = pytest.mark.parametrize(("method", "error"), [("reference", EXACT), ("polygons", 1e-6)])


def at(fresnel_number, width=D):
    """Return the distance at which (width / 2)² / (λz) is this."""
    return (width / 2) ** 2 / (WAVELENGTH * fresnel_number)


def plane(shape, extent, centre=(0.0, 0.0)):
    return Grid(shape, (extent / shape[0], extent / shape[1]), centre)


def field(shape, grid, distance, method="reference"):
    return near_field(shape, grid, distance, WAVELENGTH, method).amplitude.astype(complex)


def between(low, high, places, distance):
    """∫ exp(iπ(x − x')²/(λz)) dx over an interval, over √(λz/2): Fresnel integrals at its ends."""
    scale = math.sqrt(2 / (WAVELENGTH * distance))
    (s0, c0), (s1, c1) = (special.fresnel(scale * (end - places)) for end in (low, high))
    return c1 - c0 + 1j * (s1 - s0)


def rectangle_field(grid, distance, width, height):
    """D = −i/2 (E(y₁) − E(y₀)) (E(x₁) − E(x₀)), E = C + iS (Goodman, Introduction to Fourier Optics)."""
    y, x = grid.axes()
    along_y, along_x = (between(-side / 2, side / 2, p, distance) for side, p in ((height, y), (width, x)))
    return -0.5j * along_y[:, None] * along_x


@METHODS
@pytest.mark.parametrize("number", [1e-6, 0.1, 7.0, 100.0])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.3e-3, -1.1e-3), (D / 4, D / 2)])
def test_rectangle(method, error, number, centre):
    """Places on its edges, on their extensions and on its corners are among them."""
    grid = plane((8, 8), 2 * D, centre)
    wanted = rectangle_field(grid, at(number), D, D / 2)
    found = field(aperture.rectangle(D, D / 2), grid, at(number), method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=error * min(1, 10 * number))


@pytest.mark.parametrize("number", [1.0, 3.5, 10.5, 100.5])
def test_circle_on_axis(number):
    """D = 1 − exp(iπN_F), so that |D|² = 4 sin²(πN_F / 2)."""
    found = field(aperture.circle(D), plane((1, 1), D), at(number))[0, 0]
    assert found == pytest.approx(1 - np.exp(1j * np.pi * number), abs=EXACT)
    assert abs(found) ** 2 == pytest.approx(4 * math.sin(math.pi * number / 2) ** 2, abs=EXACT)


def test_arago_spot():
    """Behind the middle of an opaque disc the light is as bright as with nothing in its way."""
    for number in (0.3, 4.0, 30.0):
        found = 1 - field(aperture.circle(D), plane((1, 1), D), at(number))[0, 0]
        assert abs(found) ** 2 == pytest.approx(1, abs=EXACT)


@METHODS
def test_babinet(method, error):
    """A frame and its window have fields that add up to the whole rectangle's."""
    outer, inner = aperture.rectangle(D, D), aperture.rectangle(0.4 * D, 0.3 * D)
    frame = aperture.subtraction(outer, inner)
    grid, distance = plane((9, 10), 1.5 * D, (0.0, 0.2e-3)), at(8.0)
    whole, window, rest = (field(each, grid, distance, method) for each in (outer, inner, frame))
    np.testing.assert_allclose(rest + window, whole, rtol=0, atol=2 * error)


@METHODS
def test_far_limit(method, error):
    """D → exp(iπ|x'|²/(λz)) F(x'/(λz)) / (iλz)."""
    number = 1e-6
    reach = WAVELENGTH * at(number)
    shape = aperture.iris(5, D, rotation=0.3)
    frequencies = Grid((9, 10), (0.7 / D, 0.9 / D), (1.3 / D, 0.0))
    grid = Grid((9, 10), (0.7 / D * reach, 0.9 / D * reach), (1.3 / D * reach, 0.0))
    y, x = grid.axes()
    phase = np.exp(1j * np.pi * (y[:, None] ** 2 + x**2) / reach)
    wanted = phase * far_field(shape, frequencies, "reference").amplitude / (1j * reach)
    found = field(shape, grid, at(number), method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=(1e-8 + error + 4 * number) * np.abs(wanted).max())


@METHODS
def test_energy_through_a_large_plane_is_the_area(method, error):
    """The tails beyond ±X hold about 1/X of it: twice as large a plane loses half as much."""
    del error
    shape, distance = aperture.iris(3, D), at(0.5)
    spacing = 0.95 * WAVELENGTH * distance / D  # |D|² has no finer fringes
    losses = []
    for factor in (1, 2):
        count = 2 * int(factor * (4 * D / spacing + 30) / 2) + 1
        power = np.abs(field(shape, Grid((count, count), (spacing, spacing)), distance, method)) ** 2
        losses.append(1 - power.sum() * spacing**2 / aperture.area(shape))
    assert 0 < losses[1] < 0.6 * losses[0]
    assert losses[0] < 0.03


@METHODS
def test_direction_and_start_of_a_ring_do_not_count(method, error):
    corners = np.array([[0.0, 0.8], [-0.9, -0.3], [0.1, -0.1], [0.7, -0.9]]) * 1e-3
    grid = plane((6, 7), 1.3 * D, (0.1e-3, 0.0))
    wanted = field(aperture.polygon(corners), grid, at(5.0), "reference")
    for same in (corners[::-1], np.roll(corners, 2, axis=0)):
        found = field(aperture.polygon(same), grid, at(5.0), method)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=2 * error)


def test_arcs_and_many_short_edges():
    """A blade of 400 chords strays from its arc by 1.6e-5 of the radius of the opening."""
    grid, curved = plane((5, 6), 1.2 * D), aperture.iris(3, D, curvature=0.8)
    chords = aperture.chords(curved.outlines[0], 1e-10)
    found = field(aperture.polygon(chords), grid, at(2.0))
    np.testing.assert_allclose(found, field(curved, grid, at(2.0)), rtol=0, atol=5e-6)


def test_the_reference_refuses_what_would_take_days():
    with pytest.raises(refuse.Refusal, match=r"^method 'reference' would sum more than .* use 'auto'\.$"):
        field(aperture.rectangle(D, D), plane((4, 4), D), 1e-12)
    with pytest.raises(refuse.Refusal, match=r"^method 'reference' would sum more than .* use 'auto'\.$"):
        field(aperture.circle(D), Grid((4, 4), (1e200, 1.0)), 1.0)
