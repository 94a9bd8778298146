"""Glare functions of the eye against published values, closed forms and quadrature of another kind."""

import itertools
import math

import numpy as np
import pytest
from scipy import integrate

from aureole import refuse
from aureole.glare import veil

DEGREES = np.array([0.1, 0.5, 1, 3, 10, 30])
# 1 / steradian for 35 years and brown eyes, computed independently from the printed coefficients.
TABLE = {
    "cie_135": (1.14e4, 134, 19.1, 1.04, 0.063, 0.0080),
    "cie_146": (1.06e4, 102, 15.6, 1.00, 0.072, 0.0096),
    "stiles_holladay": (None, None, 10.6, 1.18, 0.106, 0.0118),
    "spencer": (6.5e3, 108, 19.0, 1.46, 0.109, 0.0115),
}


@pytest.mark.parametrize("name", TABLE)
def test_glare_functions_have_their_tabulated_values(name):
    found = getattr(veil, name)(np.radians(DEGREES))
    for value, expected in zip(found, TABLE[name], strict=True):
        if expected is not None:
            assert value == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("age", "pigment"), [(20, 0), (35, 0.5), (70, 0.5), (80, 1.2)])
def test_the_total_glare_function_holds_about_all_the_light(age, pigment):
    def glare(angle):
        return veil.cie_135(angle, age, pigment)

    whole = veil.hemisphere_energy(glare)
    assert 1.0 <= whole <= 1.035
    slow = 0.0
    edges = [0, *np.geomspace(1e-6, math.pi / 2, 30)]
    for low, high in itertools.pairwise(edges):
        slow += integrate.quad(
            lambda t: 2 * math.pi * math.sin(t) * float(glare(t)), low, high, epsrel=1e-11
        )[0]
    assert whole == pytest.approx(slow, rel=1e-9)


@pytest.mark.parametrize(
    ("age", "fractions"), [(35, {0.1: 0.32, 1: 0.078, 10: 0.033}), (70, {0.1: 0.39, 1: 0.133, 10: 0.063})]
)
def test_the_fractions_beyond_an_angle_are_the_known_ones(age, fractions):
    def glare(angle):
        return veil.cie_135(angle, age, 0.5)

    for degrees, expected in fractions.items():
        beyond = veil.hemisphere_energy(glare, math.radians(degrees))
        assert beyond == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize("luminance", [1e-3, 0.1, 100])
def test_spencers_functions_hold_all_the_light_in_each_state(luminance):
    whole = veil.hemisphere_energy(lambda angle: veil.spencer(angle, luminance))
    assert 0.9995 <= whole <= 0.9998


def test_an_integral_over_the_hemisphere_is_that_of_the_closed_form():
    # ∫ 2π sin θ (1 + cos θ) dθ = 2π + π, and an integral splits at any angle.
    assert veil.hemisphere_energy(lambda t: 1 + np.cos(t)) == pytest.approx(3 * math.pi, rel=1e-12)
    parts = [
        veil.hemisphere_energy(veil.cie_135, low, high) for low, high in ((0, 0.02), (0.02, math.pi / 2))
    ]
    assert sum(parts) == pytest.approx(veil.hemisphere_energy(veil.cie_135), rel=1e-9)


def test_spencers_halo_stands_at_three_degrees_and_follows_the_wavelength():
    angles = np.radians(np.linspace(2, 5, 3001))
    for wavelength in (450e-9, 568e-9, 650e-9):
        halo = veil.spencer(angles, 1e-3, wavelength=wavelength) - 0.207 / 0.138 * (
            veil.spencer(angles, 100) - 0.478 * 20.91 / (np.degrees(angles) + 0.02) ** 3
        )
        halo -= 0.478 * 20.91 / (np.degrees(angles) + 0.02) ** 3
        assert np.degrees(angles[np.argmax(halo)]) == pytest.approx(3 * wavelength / 568e-9, abs=0.002)
        assert halo.max() == pytest.approx(0.033 * 436.9 * 568e-9 / wavelength, rel=1e-3)


def test_age_scatters_more_light_and_takes_it_from_the_core():
    far, near = np.radians(5.0), 0.0
    for glare in (veil.cie_135, lambda angle, age: veil.spencer(angle, 100, age)):
        assert glare(far, 70) > 1.3 * glare(far, 25)
        assert glare(near, 70) < glare(near, 25)
    assert veil.cie_146(far, 70) > 1.3 * veil.cie_146(far, 25)
    assert veil.cie_146(far, 70, 0.0) == pytest.approx(veil.cie_146(far, 70, 1.2, "small-angle"), rel=1e-12)
    moved = veil.hemisphere_energy(lambda angle: veil.spencer(angle, 100, 80))
    assert moved == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: veil.cie_135(-0.1), "'angle' must be >= 0"),
        (lambda: veil.cie_146(0.0), "'angle' must be > 0"),
        (lambda: veil.stiles_holladay([0.1, 0.0]), "'angle' must be > 0"),
        (lambda: veil.cie_135(0.1, age=-1), "'age' must be a number from 0 to 120"),
        (lambda: veil.cie_135(0.1, pigment=2), "'pigment' must be a number from 0 to 1.2"),
        (lambda: veil.cie_146(0.1, equation="generl"), "Did you mean 'general'"),
        (lambda: veil.spencer(0.1, luminance=0), "'luminance' must be a finite number > 0"),
        (lambda: veil.hemisphere_energy(veil.cie_135, 1.0, 0.5), "'low' must be less than 'high'"),
        (lambda: veil.cie_135(math.nan), "'angle' must hold finite numbers"),
    ],
)
def test_glare_functions_refuse_what_they_cannot_serve(call, said):
    with pytest.raises(refuse.Refusal, match=said):
        call()
