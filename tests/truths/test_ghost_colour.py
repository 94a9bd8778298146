"""The colour of ghosts between few traced wavelengths: exact for what all rays share, against many traced."""

import numpy as np
import pytest

from aureole import flare, light
from aureole.flare import energy, ghost_colour, pupil, tracing
from aureole.flare.spectral import interpolation, sample_spectrum

WHITE = light.illuminant("E")
SAMPLING = sample_spectrum(WHITE, 3)
HELIAR = flare.load("heliar_tronnier_100mm")


@pytest.fixture(scope="module")
def exact():
    return ghost_colour.prepare_curves(HELIAR, SAMPLING)


def test_a_flat_curve_changes_nothing(exact):
    wanted = np.linspace(410e-9, 690e-9, 9)
    found = ghost_colour.weight_blend(np.full(12, 0.3), exact, SAMPLING.wavelengths, wanted)
    np.testing.assert_allclose(found, interpolation(SAMPLING.wavelengths, wanted), rtol=1e-9)


def test_what_all_rays_share_is_exact(exact):
    """Weights that are a wild curve times a parabola in 1 / λ come out at every wavelength."""
    wanted = np.linspace(410e-9, 690e-9, 9)

    def curve(waves):
        return 1e-4 + 1e-2 * (550e-9 / waves - 1) ** 4

    def smooth(waves):
        return 1 + 0.2 * (550e-9 / waves) - 0.05 * (550e-9 / waves) ** 2

    traced = SAMPLING.wavelengths
    blend = ghost_colour.weight_blend(curve(exact.wavelengths), exact, traced, wanted)
    truth = curve(wanted) * smooth(wanted)
    np.testing.assert_allclose(blend @ (curve(traced) * smooth(traced)), truth, rtol=1e-9)
    plain = interpolation(traced, wanted) @ (curve(traced) * smooth(traced))
    assert np.abs(plain / truth - 1).max() > 0.2


def test_a_curve_that_vanishes_does_not_divide(exact):
    wanted = np.linspace(410e-9, 690e-9, 9)
    for curve in (np.zeros(12), np.linspace(-1, 1, 12)):
        found = ghost_colour.weight_blend(curve, exact, SAMPLING.wavelengths, wanted)
        np.testing.assert_allclose(found, interpolation(SAMPLING.wavelengths, wanted))


def test_three_wavelengths_do_for_coated_ghosts(exact):
    """Energies at nine other wavelengths against those traced there; a plain polynomial is far off."""
    direction = flare.light_at(0.05, 0.03).direction
    wanted = np.linspace(420e-9, 680e-9, 9)
    paths = flare.ghosts(HELIAR)
    truth = energy.ghost_powers(HELIAR, paths, direction, wanted, base=24)
    sheets = pupil.sheets(tracing.prepare(HELIAR, SAMPLING.wavelengths), paths, direction, base=24)
    curves = ghost_colour.curves(exact, sheets, direction)
    worst = []
    for k, (sheet, curve) in enumerate(zip(sheets, curves, strict=True)):
        few = energy.sheet_energy(sheet)
        blends = (
            ghost_colour.weight_blend(curve, exact, SAMPLING.wavelengths, wanted),
            interpolation(SAMPLING.wavelengths, wanted),
        )
        worst.append([np.abs(blend @ few / truth[k] - 1).max() for blend in blends])
    mended, plain = np.max(worst, axis=0)
    assert mended < 0.02
    assert plain > 1


def test_white_light_needs_few_wavelengths():
    source = flare.light_at(0.05, 0.03)
    paths = flare.ghosts(HELIAR)
    few, many = (energy.ghost_energies(HELIAR, paths, source, wavelengths=n, base=24) for n in (2, 8))
    strong = many > 0.02 * many.max()
    np.testing.assert_allclose(few[strong], many[strong], rtol=0.02)
    assert few.sum() == pytest.approx(many.sum(), rel=0.005)
