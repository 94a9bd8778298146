"""Glass and coatings against closed forms: Fresnel, Brewster, quarter waves, Airy's sum, energy."""

import numpy as np
import pytest

from aureole.flare import coating, glass

AIR, GLASS, DENSE = glass.AIR, glass.of_numbers(1.52), glass.of_numbers(1.8)
GREEN = 550e-9
COSINES = np.cos(np.radians(np.linspace(0, 89.9, 60)))
WAVES = np.linspace(380e-9, 780e-9, 9)[:, None]


def fresnel(n1, n2, cosine):
    """Return R by the tile paper's Eq. 1."""
    inner = np.sqrt(1 - (n1 / n2) ** 2 * (1 - cosine**2))
    s = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner)
    p = (n1 * inner - n2 * cosine) / (n1 * inner + n2 * cosine)
    return (s**2 + p**2) / 2


def airy(n0, n1, n2, thickness, cosine, wavelength, p):
    """Return r of one layer as the sum of all its inner reflections."""
    c0, c1, c2 = (np.sqrt(1 - (n0 / n) ** 2 * (1 - cosine**2)) for n in (n0, n1, n2))
    a0, a1, a2 = (n / c if p else n * c for n, c in ((n0, c0), (n1, c1), (n2, c2)))
    r01, r12 = (a0 - a1) / (a0 + a1), (a1 - a2) / (a1 + a2)
    turn = np.exp(-2j * 2 * np.pi * n1 * c1 * thickness / wavelength)
    # r01 + t01 r12 t10 turn + t01 r12 r10 r12 t10 turn² + ..., with r10 = -r01 and t01 t10 = 1 - r01².
    return r01 + (1 - r01**2) * r12 * turn / (1 + r01 * r12 * turn)


@pytest.mark.parametrize(("before", "after"), [(AIR, GLASS), (GLASS, AIR), (GLASS, DENSE)])
def test_bare_glass_reflects_as_fresnel_says(before, after):
    cosines = COSINES[before.index**2 * (1 - COSINES**2) < after.index**2]
    found, _ = coating.reflectance((), before, after, cosines, GREEN)
    np.testing.assert_allclose(found, fresnel(before.index, after.index, cosines), rtol=1e-12, atol=1e-15)


def test_nothing_of_p_is_reflected_at_brewsters_angle():
    cosine = np.cos(np.arctan(GLASS.index))
    found, _ = coating.reflectance((), AIR, GLASS, cosine, GREEN, "p")
    assert found < 1e-30
    assert coating.reflectance((), AIR, GLASS, cosine, GREEN, "s")[0] > 0.1


def test_all_is_reflected_beyond_the_critical_angle():
    beyond = COSINES[GLASS.index**2 * (1 - COSINES**2) > 1]
    for layers in ((), (coating.quarter_wave(1.38, GREEN),), (coating.quarter_wave(2.1, GREEN),) * 2):
        found, through = coating.reflectance(layers, GLASS, AIR, beyond, WAVES)
        np.testing.assert_allclose(found, 1, atol=1e-12)
        np.testing.assert_allclose(through, 0, atol=1e-12)


@pytest.mark.parametrize(("n0", "n1", "ns"), [(1.0, 1.38, 1.52), (1.0, 1.38, 1.9), (1.5, 1.7, 1.8)])
def test_a_quarter_wave_reflects_by_its_closed_form(n0, n1, ns):
    media = glass.of_numbers(n0), glass.of_numbers(ns)
    found, _ = coating.reflectance([coating.quarter_wave(n1, GREEN)], *media, 1.0, GREEN)
    assert found == pytest.approx(((n0 * ns - n1**2) / (n0 * ns + n1**2)) ** 2, rel=1e-12)


def test_a_v_coat_reflects_nothing():
    """Two quarter waves cancel where (n2 / n1)² = ns / n0 (Macleod, Thin-Film Optical Filters, 3.2)."""
    second = 1.38 * np.sqrt(GLASS.index)
    layers = [coating.quarter_wave(1.38, GREEN), coating.quarter_wave(second, GREEN)]
    assert coating.reflectance(layers, AIR, GLASS, 1.0, GREEN)[0] < 1e-30
    assert coating.reflectance(layers, AIR, GLASS, 1.0, 450e-9)[0] > 1e-3


def test_a_half_wave_is_not_there():
    layer = coating.quarter_wave(2.0, 2 * GREEN)
    bare = coating.reflectance((), AIR, GLASS, 1.0, GREEN)[0]
    assert coating.reflectance([layer], AIR, GLASS, 1.0, GREEN)[0] == pytest.approx(bare, rel=1e-12)


@pytest.mark.parametrize(("n1", "n2"), [(1.38, 1.52), (2.3, 1.52), (1.2, 1.9)])
def test_one_layers_matrix_is_airys_sum(n1, n2):
    layer = coating.Layer(glass.of_numbers(n1), 137e-9)
    found = coating.amplitudes([layer], AIR, glass.of_numbers(n2), COSINES, WAVES)
    for got, p in ((found.r_s, False), (found.r_p, True)):
        np.testing.assert_allclose(got, airy(1.0, n1, n2, 137e-9, COSINES, WAVES, p), rtol=0, atol=1e-12)


def test_what_is_not_reflected_goes_through():
    """R + T = 1 to 1e-12: T is computed from its own amplitude."""
    chance = np.random.default_rng(5)
    for count in (0, 1, 2, 7, 20):
        layers = [
            coating.Layer(glass.of_numbers(n), d)
            for n, d in zip(
                chance.uniform(1.2, 2.4, count), chance.uniform(20e-9, 300e-9, count), strict=True
            )
        ]
        for before, after in ((AIR, GLASS), (GLASS, AIR), (DENSE, GLASS)):
            for polarisation in coating.POLARISATIONS:
                found, through = coating.reflectance(layers, before, after, COSINES, WAVES, polarisation)
                np.testing.assert_allclose(found + through, 1, atol=1e-12)
                assert found.min() >= 0


def test_a_stack_met_from_behind_transmits_the_same():
    """Reversed layers at the angle of the refracted ray: T is the same (reciprocity)."""
    layers = [coating.Layer(glass.of_numbers(n), d) for n, d in ((1.38, 90e-9), (2.1, 60e-9), (1.6, 110e-9))]
    inside = np.sqrt(1 - (1 - COSINES**2) / GLASS.index**2)
    for polarisation in ("s", "p"):
        one = coating.reflectance(layers, AIR, GLASS, COSINES, WAVES, polarisation)[1]
        other = coating.reflectance(layers[::-1], GLASS, AIR, inside, WAVES, polarisation)[1]
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_a_layer_too_thin_for_light_tunnels():
    """Between two glasses a gap of air far below a wave lets light through beyond the critical angle."""
    cosine = np.cos(np.radians(60.0))
    through = [
        float(coating.reflectance([coating.Layer(AIR, d)], GLASS, GLASS, cosine, GREEN)[1])
        for d in (1e-12, 100e-9, 2e-6)
    ]
    assert through[0] == pytest.approx(1, abs=1e-6)
    assert 0.05 < through[1] < 0.95
    assert through[2] < 1e-6
