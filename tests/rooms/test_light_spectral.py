"""The spectral sum: every method against the reference, grids of all kinds, refusals."""

import numpy as np
import pytest
from scipy import ndimage

from aureole import light, refuse
from aureole.records import Grid, Pattern

REFERENCE = 550e-9
AGREE = 2e-6  # of the brightest value: float32 against float64
PATTERNS = [(33, 33), (32, 32), (40, 27), (1, 9)]
TARGETS = {
    "own": None,
    "finer": Grid((41, 30), (0.31, 0.27)),
    "coarser and wider": Grid((20, 21), (3.3, 2.9)),
    "shifted": Grid((16, 17), (0.8, 0.8), (5.3, -4.1)),
    "outside": Grid((6, 6), (1.0, 1.0), (200.0, 0.0)),
    "one sample": Grid((1, 1), (1.0, 1.0)),
}


def noise(shape, spacing=(1.0, 1.0), centre=(0.0, 0.0)):
    intensity = np.random.default_rng(5).random(shape, dtype=np.float32)
    return Pattern(intensity, Grid(shape, spacing, centre), REFERENCE, float(intensity.sum()))


def both(pattern, **options):
    spectrum = options.pop("spectrum", light.illuminant("D65"))
    return tuple(
        light.spectral_sum(pattern, None, spectrum, method, **options).pixels
        for method in ("full", "reference")
    )


@pytest.mark.parametrize("shape", PATTERNS)
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_full_agrees_with_reference(shape, target, interpolation):
    full, slow = both(noise(shape), grid=TARGETS[target], interpolation=interpolation, samples=13)
    assert full.shape == slow.shape
    assert full.dtype == slow.dtype == np.float32
    np.testing.assert_allclose(full, slow, rtol=0, atol=AGREE * max(slow.max(), 1.0))


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_full_agrees_in_the_patterns_own_units(interpolation):
    pattern = noise((24, 31), (250.0, 125.0), (700.0, -90.0))
    target = Grid((19, 22), (210.0, 333.0), (650.0, 40.0))
    full, slow = both(pattern, grid=target, interpolation=interpolation)
    np.testing.assert_allclose(full, slow, rtol=0, atol=AGREE * slow.max())


@pytest.mark.parametrize("samples", [1, 2, 3, 4, 5, 60])
def test_any_number_of_wavelengths(samples):
    full, slow = both(noise((21, 20)), samples=samples)
    np.testing.assert_allclose(full, slow, rtol=0, atol=AGREE * slow.max())


@pytest.mark.parametrize("shape", [(33, 33), (32, 32), (32, 31), (31, 32), (1, 1), (2, 2)])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_symmetric_halves_the_work_only(shape, interpolation):
    """On an odd pattern with P(−q) = P(q) nothing else changes."""
    pattern = noise((45, 43))
    even = Pattern(0.5 * (pattern.intensity + pattern.intensity[::-1, ::-1]), pattern.grid, REFERENCE, 1.0)
    target = Grid(shape, (0.9, 0.7))
    options = {"grid": target, "interpolation": interpolation}
    full = light.spectral_sum(even, None, light.illuminant("E"), **options).pixels
    half = light.spectral_sum(even, None, light.illuminant("E"), symmetric=True, **options).pixels
    np.testing.assert_allclose(half, full, rtol=0, atol=AGREE * full.max())


def test_linear_reference_is_scipys():
    pattern = noise((30, 26))
    ratio = REFERENCE / 470e-9
    y, x = pattern.grid.axes()
    places = np.meshgrid(ratio * y + 15, ratio * x + 13, indexing="ij")
    scaled = ndimage.map_coordinates(pattern.intensity.astype(float), places, order=1, mode="grid-constant")
    made = light.spectral_sum(pattern, None, light.line(470e-9), "reference").pixels
    np.testing.assert_allclose(made[..., 1], ratio**2 * scaled, rtol=0, atol=2e-7)


def test_cubic_reference_passes_through_samples_and_lines():
    ramp = np.tile(np.arange(40, dtype=np.float32), (40, 1))
    target = Grid((9, 9), (0.37, 0.37), (3.0, 2.0))
    made = light.spectral_sum(
        ramp, REFERENCE, light.line(REFERENCE), "reference", grid=target, interpolation="cubic"
    )
    wanted = np.tile(target.axes()[1] + 20, (9, 1))
    np.testing.assert_allclose(made.pixels[..., 1], wanted, rtol=1e-6)


def test_cubic_is_never_negative():
    spike = np.zeros((15, 15), dtype=np.float32)
    spike[7, 7] = 1.0
    for made in both(Pattern(spike, Grid((15, 15), (1.0, 1.0)), REFERENCE, 1.0), interpolation="cubic"):
        assert made.min() == 0.0


def test_a_bare_array_is_a_pattern_of_spacing_one():
    pattern = noise((12, 13))
    bare = light.spectral_sum(pattern.intensity, REFERENCE, light.illuminant("A"))
    np.testing.assert_array_equal(
        bare.pixels, light.spectral_sum(pattern, None, light.illuminant("A")).pixels
    )


def test_the_picture_says_what_it_is():
    made = light.spectral_sum(noise((8, 8)), REFERENCE, light.illuminant("A"))
    assert made.colour_space == "xyz"
    assert made.metadata == {"white_xyz": pytest.approx(tuple(light.white(light.illuminant("A"))))}


def test_auto_picks_the_method_that_serves():
    pattern, spectrum = noise((16, 16)), light.illuminant("E")
    auto, full = (light.spectral_sum(pattern, None, spectrum, method).pixels for method in ("auto", "full"))
    np.testing.assert_array_equal(auto, full)
    exact = light.spectral_sum(lambda u, v: np.exp(-u * u - v * v), REFERENCE, spectrum, grid=pattern.grid)
    assert exact.pixels.shape == (16, 16, 3)


def test_callables_take_x_before_y():
    grid = Grid((5, 7), (1.0, 1.0))
    made = light.spectral_sum(lambda u, v: u + 0.0 * v, REFERENCE, light.line(REFERENCE), grid=grid)
    np.testing.assert_allclose(made.pixels[..., 1], np.tile(np.arange(-3.0, 4.0), (5, 1)))


def test_a_callable_may_be_constant():
    made = light.spectral_sum(
        lambda u, v: np.float64(2.0), REFERENCE, light.line(REFERENCE), grid=Grid((2, 3), (1, 1))
    )
    np.testing.assert_allclose(made.pixels[..., 1], 2.0)


def test_inputs_stay_untouched():
    pattern = noise((9, 9))
    before = pattern.intensity.copy()
    pattern.intensity.flags.writeable = False
    light.spectral_sum(pattern, None, light.illuminant("E"))
    np.testing.assert_array_equal(pattern.intensity, before)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (
            (noise((4, 4)), None),
            {"method": "fall"},
            "'method' must be one of 'auto', 'reference', 'full', 'batch', 'rays', got 'fall'.",
        ),
        (
            (noise((4, 4)), None),
            {"interpolation": "spline"},
            "'interpolation' must be one of 'linear', 'cubic'",
        ),
        ((noise((4, 4)), None), {"samples": 0}, "'samples' must be an integer >= 1, got 0."),
        ((noise((4, 4)), -1.0), {}, "'reference_wavelength' must be a finite number > 0, got -1."),
        (
            (noise((4, 4)), 500e-9),
            {},
            "'reference_wavelength' is 5e-07 but the pattern's own is 5.5e-07; give None to use that.",
        ),
        (
            (np.ones((4, 4)), None),
            {},
            "'reference_wavelength' is needed, in metres: only a Pattern knows its own.",
        ),
        ((np.ones((4, 4, 3)), 5e-7), {}, "'pattern' must be an array of shape (any, any), got (4, 4, 3)."),
        ((np.full((4, 4), np.nan), 5e-7), {}, "'pattern' must hold finite numbers, got 16 that are NaN"),
        (
            (Pattern(np.ones((4, 4), np.float32), Grid((4, 5), (1, 1)), 5e-7, 1.0), None),
            {},
            "'pattern' must be an array of shape (4, 5), got (4, 4).",
        ),
        ((lambda u, v: u * v, 5e-7), {}, "'grid' is needed where the pattern is a callable."),
        (
            (lambda u, v: u * v, 5e-7),
            {"method": "full", "grid": Grid((2, 2), (1, 1))},
            "'method' 'full' interpolates a sampled pattern; use 'reference' for a callable.",
        ),
        (
            (noise((4, 4)), None),
            {"grid": Grid((4, 4), (1, 1), (1.0, 0.0)), "symmetric": True},
            "'symmetric' needs a 'grid' centred on zero, got its centre at (1.0, 0.0).",
        ),
        (
            (noise((4, 4)), None),
            {"grid": Grid((0, 4), (1, 1))},
            "'grid.shape (y)' must be an integer >= 1, got 0.",
        ),
        (
            (noise((4, 4)), None),
            {"grid": Grid((4, 4), (1, -1))},
            "'grid.spacing (x)' must be a finite number > 0",
        ),
    ],
)
def test_refusals(arguments, options, message):
    with pytest.raises(refuse.Refusal) as refusal:
        light.spectral_sum(*arguments, light.illuminant("E"), **options)
    assert str(refusal.value).startswith(message)


def test_a_pattern_stretched_by_a_rule_of_ones_own():
    """Linear interpolation of a plane ax + by + c is exact: Σ w (s (ax + by) + c)."""
    grid = Grid((41, 41), (0.5, 0.5))
    y, x = grid.axes()
    values = (0.01 * x + 0.02 * y[:, None] + 1).astype(np.float32)
    target, spectrum = Grid((9, 12), (0.3, 0.2), (1.0, -2.0)), light.illuminant("E")
    found = light.stretched_sum(
        Pattern(values, grid, 550e-9, 0.0), spectrum, lambda ratios: 1 + 0.2 * (1 - ratios), target, 7
    )
    wavelengths, weights = light.quadrature(spectrum, 7)
    (v, u), wanted = target.axes(), np.zeros((9, 12, 3))
    for wavelength, weight in zip(wavelengths, weights, strict=True):
        scale = 1 + 0.2 * (1 - 550e-9 / wavelength)
        wanted += (scale * (0.01 * u + 0.02 * v[:, None]) + 1)[..., None] * weight
    np.testing.assert_allclose(found.pixels, wanted, atol=1e-6)
    assert found.metadata["white_xyz"] == pytest.approx(light.white(spectrum))


def test_a_rule_that_turns_the_pattern_over_is_refused():
    pattern = Pattern(np.ones((5, 5), np.float32), Grid((5, 5), (1.0, 1.0)), 550e-9, 0.0)
    with pytest.raises(refuse.Refusal, match="'scale' must be > 0 for every wavelength"):
        light.stretched_sum(
            pattern, light.illuminant("E"), lambda ratios: 1 - ratios, Grid((3, 3), (1.0, 1.0))
        )
