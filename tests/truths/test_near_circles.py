"""Laws of a circle's near field: closed forms on the axis, series, and limits near the edge and far away."""

import math

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture
from aureole.aperture import Circle
from aureole.diffraction.fresnel import fresnel_integrals
from aureole.diffraction.near_circles import circle_near, radial_field

WAVELENGTH = 550e-9
R = 1e-3
ROUNDING = 5e-7
NUMBERS = [1e-4, 0.03, 1.0, 3.5, 6.0, 7.0, 10.5, 100.5, 1e3, 1e5]


def at(number, radius=R):
    """Return the distance at which a²/(λz) is this."""
    return radius**2 / (WAVELENGTH * number)


def along(first, last, count, number, radius=R):
    """Return D at places to the right of the centre."""
    step = (last - first) / (count - 1)
    grid = Grid((1, count), (1.0, step), (0.0, first + count // 2 * step))
    return grid.axes()[1], circle_near(Circle(0.0, 0.0, radius), grid, at(number, radius), WAVELENGTH)[0]


def lommel(number, share):
    """D inside, by Lommel's series in (r / R)ⁿ (Born and Wolf, Principles of Optics, 8.8)."""
    n = np.arange(1, 400)
    terms = special.jv(n, 2 * np.pi * number * share) * (-1j) ** n * share**n
    series = special.j0(2 * np.pi * number * share) + terms.sum()
    return 1 - np.exp(1j * np.pi * number * (1 + share**2)) * series


@pytest.mark.parametrize("number", NUMBERS)
def test_on_the_axis(number):
    """|D|² = 4 sin²(πN_F / 2), D = 1 − exp(iπN_F)."""
    found = circle_near(Circle(0.0, 0.0, R), Grid((1, 1), (R, R)), at(number), WAVELENGTH)[0, 0]
    assert abs(found - (1 - np.exp(1j * np.pi * number))) < ROUNDING
    assert abs(abs(found) ** 2 - 4 * math.sin(math.pi * number / 2) ** 2) < 1e-6


@pytest.mark.parametrize("number", [0.3, 2.0, 6.4, 20.0, 90.0])
def test_lommels_series(number):
    places, found = along(0.0, 0.9 * R, 40, number)
    wanted = [lommel(number, r / R) for r in places]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("number", NUMBERS)
def test_everywhere_the_boundary_integral(number):
    """At the centre, inside, across the edge and outside; near where the table ends too."""
    scale = math.sqrt(2 * number) / R
    ends = 40 / (2 * math.pi * scale**2 * R)
    for first, last in ((0, 2 * R), (0.999 * R, 1.001 * R), (0.8 * ends, 1.2 * ends), (5 * R, 5.01 * R)):
        places, found = along(first, last, 41, number)
        wanted = [radial_field(scale * R, np.array([scale * r]))[0] for r in np.abs(places)]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUNDING)


def test_the_trapezoidal_rule_is_itself_right():
    """Against Lommel's series, which knows no boundary wave."""
    for number, share in ((0.2, 0.4), (5.0, 0.1), (30.0, 0.7)):
        radius = math.sqrt(2 * number)
        found = radial_field(radius, np.array([share * radius]))[0]
        assert abs(found - lommel(number, share)) < 1e-11


@pytest.mark.parametrize("number", [0.01, 1.0, 40.0, 1e4])
def test_the_edge_is_crossed_without_a_step(number):
    step = 1e-9 * R
    _, found = along(R - 2 * step, R + 2 * step, 5, number)
    np.testing.assert_allclose(found, found[2], rtol=0, atol=ROUNDING)


def test_a_large_circle_is_a_half_plane():
    """D = ½ + (1 − i)/2 E(√(2/λz) (R − r)): ¼ at the edge, 1.370 at the first fringe."""
    number = 1e9
    unit = R / math.sqrt(2 * number)
    places, found = along(R - 3 * unit, R + 2 * unit, 501, number)
    cosine, sine = fresnel_integrals((R - places) / unit)
    wanted = 0.5 + (0.5 - 0.5j) * (cosine + 1j * sine)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-5)
    assert np.max(np.abs(found) ** 2) == pytest.approx(1.370, abs=1e-3)
    assert np.interp(R, places, np.abs(found) ** 2) == pytest.approx(0.25, abs=1e-4)


@pytest.mark.parametrize("number", [0.5, 3.5, 10.0, 100.0, 1000.0])
def test_poissons_spot_behind_an_opaque_disc(number):
    """Babinet: on the axis the shadow of a disc is as bright as if it were not there."""
    grid = Grid((1, 1), (R, R))
    opening = circle_near(Circle(0.0, 0.0, R), grid, at(number), WAVELENGTH)[0, 0]
    assert abs(1 - opening) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("number", [2.0, 60.0])
def test_a_ring_is_a_circle_without_a_smaller_one(number):
    """On the axis D = exp(iπN_inner) − exp(iπN_outer)."""
    grid = Grid((1, 1), (R, R))
    outer, inner = (
        circle_near(Circle(0.0, 0.0, r), grid, at(number), WAVELENGTH)[0, 0] for r in (R, 0.4 * R)
    )
    wanted = np.exp(1j * np.pi * number * 0.16) - np.exp(1j * np.pi * number)
    assert abs(outer - inner - wanted) < 2 * ROUNDING


@pytest.mark.parametrize("number", [1e-4, 1e-6])
def test_far_away_it_is_airys_pattern(number):
    """D → −iπN_F exp(iπr²/(λz)) 2 J1(x) / x, x = 2πN_F r/R."""
    reach = 3 / number * R
    places, found = along(0.0, reach, 61, number)
    x = 2 * np.pi * number * places / R
    airy = np.where(x == 0, 1.0, 2 * special.j1(x) / np.where(x == 0, 1.0, x))
    wanted = -1j * np.pi * number * airy * np.exp(1j * np.pi * number * (places / R) ** 2)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=(1e-6 + 4 * number) * np.pi * number)


@pytest.mark.parametrize("number", [0.2, 5.0])
def test_far_to_the_side_the_field_is_faint_and_right(number):
    scale = math.sqrt(2 * number) / R
    places, found = along(150 * R, 150.2 * R, 21, number)
    wanted = np.array([radial_field(scale * R, np.array([scale * r]))[0] for r in places])
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5 * np.abs(wanted).max())


def test_similarity():
    grids = [Grid((9, 10), (r / 4, r / 4)) for r in (R, 3 * R)]
    one, other = (
        circle_near(Circle(0.0, 0.0, r), grid, at(9.0, r), WAVELENGTH)
        for r, grid in zip((R, 3 * R), grids, strict=True)
    )
    np.testing.assert_allclose(one, other, rtol=0, atol=ROUNDING)


def test_energy_through_a_large_plane_is_the_area():
    count, spacing = 501, 0.05 * R
    grid = Grid((count, count), (spacing, spacing))
    power = np.abs(circle_near(Circle(0.0, 0.0, R), grid, at(4.0), WAVELENGTH)) ** 2
    # A plane of 25 radii loses little, and never gains.
    assert 0.98 < power.sum() * spacing**2 / aperture.area(aperture.circle(2 * R)) < 1
