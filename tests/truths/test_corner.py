"""The corner function against its integral, and the laws that it obeys."""

import itertools

import numpy as np
import pytest
from scipy import integrate

from aureole import refuse
from aureole.diffraction import _kernels_corner
from aureole.diffraction.corner import corner_integral, corner_table, half_plane_wave
from aureole.diffraction.fresnel import taylor_table

PLACES = np.array([1e-6, 0.02, 0.3, 1.0, 2.5, 4.49, 4.51, 5.9, 6.1, 20.0, 300.0])


def brute(h, s):
    """The integral along τ = s + u exp(iπ/4), s >= 0, where it decays and passes no pole."""
    turn = np.exp(0.25j * np.pi)

    def integrand(u):
        square = h * h + (s + turn * u) ** 2
        return turn * np.exp(0.5j * np.pi * (square - h * h - s * s)) * h / square / (2 * np.pi)

    breaks = [0, min(1, h + 1e-3), 1, 3, 8]
    total = 0
    for low, high in itertools.pairwise(breaks):
        for part, unit in ((np.real, 1), (np.imag, 1j)):
            value, _ = integrate.quad(
                lambda u, part=part: part(integrand(u)), low, high, epsabs=1e-13, limit=400
            )
            total += unit * value
    turns = (h * h + s * s) / 4
    return total * np.exp(2j * np.pi * (turns - np.rint(turns)))


@pytest.mark.parametrize("h", PLACES)
def test_the_integral_itself(h):
    for s in (0.0, *PLACES):
        assert corner_integral(h, s) == pytest.approx(brute(h, s), abs=1e-10)


def test_all_quadrants():
    """G is odd in h, and an edge that is cut in two adds up to the whole line's wave."""
    h, s = np.meshgrid(PLACES, PLACES)
    np.testing.assert_array_equal(corner_integral(-h, s), -corner_integral(h, s))
    whole = corner_integral(h, s) + corner_integral(h, -s)
    np.testing.assert_allclose(whole, half_plane_wave(h), rtol=0, atol=1e-12)
    np.testing.assert_allclose(whole, corner_integral(h, -1e9), rtol=0, atol=1e-9)


def test_a_right_angle_is_a_product():
    """Two half lines at a right angle bound a quadrant, whose field is a product of two Fresnel integrals."""
    h, s = np.random.default_rng(4).uniform(0, 9, (2, 1000))
    both = corner_integral(h, s) + corner_integral(s, h)
    np.testing.assert_allclose(both, half_plane_wave(h) * half_plane_wave(s), rtol=0, atol=1e-11)


def test_close_to_the_corner_it_is_an_angle():
    angle = np.linspace(-3, 3, 31)
    found = corner_integral(1e-9 * np.sin(angle), 1e-9 * np.cos(angle))
    np.testing.assert_allclose(found, angle / (2 * np.pi), rtol=0, atol=3e-9)


def test_at_the_ends_of_the_numbers():
    huge = np.array([1e9, 1e150, 1e300, np.inf])
    np.testing.assert_allclose(corner_integral(huge, 1.0), 0, atol=1e-9)
    np.testing.assert_allclose(corner_integral(1.0, huge), 0, atol=1e-9)
    np.testing.assert_allclose(corner_integral(huge, -huge), 0, atol=1e-9)
    np.testing.assert_allclose(corner_integral(1.0, -huge), half_plane_wave(np.array(1.0)), atol=1e-9)
    np.testing.assert_array_equal(corner_integral(0.0, [-1.0, 0.0, 1.0, 1e9]), 0)
    assert corner_integral(5e-324, 5e-324) == pytest.approx(1 / 8)
    assert corner_integral(0.3, -0.2).shape == ()
    assert corner_integral(np.ones((2, 1)), np.zeros(3)).shape == (2, 3)


@pytest.mark.parametrize(("kind", "error"), [("fine", 1e-9), ("coarse", 1.5e-7)])
def test_the_compiled_function(kind, error):
    places = np.concatenate([-PLACES, [0.0], PLACES])
    table = corner_table(kind)
    for h in (*PLACES, *-PLACES):
        found = [_kernels_corner.corner(h, s, taylor_table(), *table) for s in places]
        np.testing.assert_allclose(found, corner_integral(h, places), rtol=0, atol=error)
    for h, s in ((1e300, 1.0), (1.0, 1e300), (1e200, 1e200), (0.0, 0.0), (0.0, 1.0)):
        assert np.isfinite(_kernels_corner.corner(h, s, taylor_table(), *table))


def test_what_is_no_number_is_refused():
    with pytest.raises(refuse.Refusal, match=r"^'h' and 's' must hold numbers, got 2 that are NaN\.$"):
        corner_integral([0.0, np.nan], [[1.0], [2.0]])
