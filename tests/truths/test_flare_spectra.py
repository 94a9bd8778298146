"""Laws of the wavelengths that flare traces and draws: whites, interpolation, convergence."""

import math

import numpy as np
import pytest

from aureole import light, refuse
from aureole.flare import ghosts, load, paraxial, power, trace_reference
from aureole.flare.lights import light_at
from aureole.flare.spectral import BAND_COUNTS, band_count, interpolation, sample_spectrum

PIXEL = 36e-3 / 1920


@pytest.mark.parametrize("name", ["E", "A", "D65", "F1", "blackbody:3200K", "line:550nm"])
@pytest.mark.parametrize("blend", ["blended", "flat"])
@pytest.mark.parametrize("count", [1, 3, 4])
def test_bands_sum_to_the_white(name, blend, count):
    spectrum = light.illuminant(name)
    sampling = sample_spectrum(spectrum, count, blend)
    for wanted in (BAND_COUNTS[0], BAND_COUNTS[-1]):
        bands = sampling.bands(wanted)
        np.testing.assert_allclose(bands.colours.sum(axis=0), light.white(spectrum), rtol=1e-12)
        np.testing.assert_allclose(bands.blend.sum(axis=1), 1.0, rtol=1e-12)
        assert np.all(np.diff(bands.wavelengths) > 0)


def test_interpolation_keeps_polynomials_of_one_over_wavelength():
    traced = sample_spectrum(light.illuminant("E"), 4).wavelengths
    wanted = np.linspace(400e-9, 700e-9, 7)
    weights = interpolation(traced, wanted)
    for degree in range(4):
        np.testing.assert_allclose(weights @ (500e-9 / traced) ** degree, (500e-9 / wanted) ** degree)
    # One degree more than there are points is beyond it: the law is not empty.
    beyond = weights @ (500e-9 / traced) ** 4 - (500e-9 / wanted) ** 4
    assert 1e-4 < np.abs(beyond).max() < 0.1


def test_flat_samples_are_those_of_the_spectral_sum():
    spectrum = light.illuminant("D65")
    sampling = sample_spectrum(spectrum, 3, "flat")
    traced, weights = light.quadrature(spectrum, 3, 400e-9, 700e-9)
    bands = sampling.bands(8)
    np.testing.assert_allclose(bands.wavelengths, traced)
    np.testing.assert_array_equal(bands.blend, np.eye(3))
    # Bands end halfway between the traced wavelengths, cells evenly: near each other, not the same.
    assert np.abs(bands.colours - weights).max() < 0.1 * weights.max()


def test_few_lines_are_traced_themselves_and_many_are_blended():
    lines = light.spectrum([450e-9, 546e-9, 611e-9], [1.0, 2.0, 1.0], "lines")
    own = sample_spectrum(lines, 4)
    np.testing.assert_array_equal(own.wavelengths, lines.wavelengths)
    np.testing.assert_array_equal(own.bands(8).wavelengths, lines.wavelengths)
    blended = sample_spectrum(lines, 2)
    assert len(blended.wavelengths) == 2
    np.testing.assert_allclose(blended.bands(32).wavelengths, lines.wavelengths)


def test_bands_shrink_as_their_number_grows():
    sampling = sample_spectrum(light.illuminant("E"))
    rates = [(1 / sampling.bands(count).wavelengths) ** 2 for count in (8, 32)]
    widest = [np.abs(np.diff(rate)).max() for rate in rates]
    assert widest[1] < 0.3 * widest[0]


@pytest.mark.parametrize(
    ("shift", "step", "largest", "count"),
    [(0.0, 1.5, 32, 4), (20.0, 2.0, 32, 12), (1e6, 1.5, 32, 32), (1e6, 1.5, 12, 12)],
)
def test_band_count_follows_the_shift(shift, step, largest, count):
    assert band_count(shift, step, largest) == count


@pytest.mark.parametrize(
    ("name", "path", "place", "weight"),
    # Bounds a little above what was measured; pixels, and parts of the largest weight.
    [("heliar_tronnier_100mm", 3, 2e-3, 0.016), ("zeiss_biotar_50mm", 3, 5e-3, 0.002)],
)
def test_rays_between_traced_wavelengths(name, path, place, weight):
    lens = load(name)
    reflections = ghosts(lens, "paper")[path].reflections
    towards = light_at(math.radians(8), math.radians(4)).direction
    heading = np.array([-towards[0], -towards[1], towards[2]])
    across = np.linspace(-1.0, 1.0, 15) * paraxial.entrance_radius(lens)[0]
    x, y = np.meshgrid(across, across)
    origins = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) - 0.05 * heading
    kept = np.ones(len(origins), dtype=bool)

    def traced(wavelengths):
        count = len(wavelengths)
        starts, ways = np.tile(origins, (count, 1)), np.tile(heading, (count * len(origins), 1))
        found = trace_reference(lens, reflections, starts, ways, np.repeat(wavelengths, len(origins)))
        kept[:] &= found.passed.reshape(count, -1).all(axis=0)
        return found.positions[:, :2].reshape(count, -1, 2), power(lens, found).reshape(count, -1)

    many = np.linspace(402e-9, 698e-9, 19)
    places, weights = traced(many)
    errors = []
    for count in (2, 3, 4):
        few = sample_spectrum(light.illuminant("E"), count).wavelengths
        blend = interpolation(few, many)
        near_places, near_weights = traced(few)
        wrong = np.abs(np.einsum("mw,wnc->mnc", blend, near_places) - places)[:, kept].max() / PIXEL
        dim = np.abs(blend @ near_weights - weights)[:, kept].max() / weights[:, kept].max()
        errors.append((wrong, dim))
    assert kept.sum() > 20
    assert errors[2][0] < place
    assert errors[2][1] < weight
    # Each further wavelength brings places nearer by an order of magnitude.
    assert errors[2][0] < 0.2 * errors[1][0] < 0.04 * errors[0][0]


@pytest.mark.parametrize(
    ("count", "blend", "message"),
    [
        (0, "blended", r"'wavelengths' must be an integer >= 1, got 0\."),
        (65, "blended", r"'wavelengths' must be at most 64, got 65\."),
        (3, "blendet", r"'blend' must be one of 'blended', 'flat', got 'blendet'\. Did you mean 'blended'\?"),
    ],
)
def test_refusals(count, blend, message):
    with pytest.raises(refuse.Refusal, match=message):
        sample_spectrum(light.illuminant("E"), count, blend)


def test_light_that_nobody_sees_is_refused():
    with pytest.raises(refuse.Refusal, match="needs light between 360 and 830 nm"):
        sample_spectrum(light.line(1064e-9))
