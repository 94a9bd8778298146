"""The fast members of the spectral sum: against their definitions, the reference, and each other."""

import numpy as np
import pytest
from scipy import ndimage

from aureole import light, refuse
from aureole.light.observer import bands
from aureole.light.rays import far_step
from aureole.records import Grid, Pattern

REFERENCE = 550e-9
SHAPES = [(121, 121), (120, 118), (131, 110), (110, 131)]
TARGETS = {
    "own": None,
    "finer": Grid((64, 65), (0.7, 0.9)),
    "shifted": Grid((33, 40), (1.2, 1.1), (11.0, -13.0)),
    "outside": Grid((5, 4), (1.0, 1.0), (900.0, 10.0)),
    "one sample": Grid((1, 1), (1.0, 1.0)),
}
# Largest error against 101 wavelengths with the same interpolation, of the brightest value.
STATED = {
    ("batch", "linear"): 5e-3,
    ("batch", "cubic"): 2.5e-2,
    ("rays", "linear"): 1.5e-2,
    ("rays", "cubic"): 3e-3,
}


def fringes(shape):
    """A pattern with P(−q) = P(q) and no mirror axis: 7 samples or more from peak to null."""
    grid = Grid(shape, (1.0, 1.0))
    y, x = (axis.reshape(sides) for axis, sides in zip(grid.axes(), ((-1, 1), (1, -1)), strict=True))
    streak = 0.02 * np.sinc((x + y) / 12) ** 2 / (1 + (x * x + y * y) / 400)
    intensity = np.sinc(x / 9) ** 2 * np.sinc(y / 7) ** 2 + streak
    return Pattern(intensity.astype(np.float32), grid, REFERENCE, float(intensity.sum()))


def lopsided(shape):
    """A smooth pattern that has no symmetry at all."""
    pattern = fringes(shape)
    y, x = pattern.grid.axes()
    shade = 1 + 0.4 * np.sin(0.06 * x[None, :] + 0.5) + 0.3 * np.cos(0.05 * y[:, None] + 1.0)
    return Pattern((pattern.intensity * shade).astype(np.float32), pattern.grid, REFERENCE, 1.0)


def summed(pattern, method, spectrum="D65", **options):
    return light.spectral_sum(pattern, None, light.illuminant(spectrum), method, **options).pixels


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(("method", "interpolation"), STATED)
@pytest.mark.parametrize("make", [fringes, lopsided])
def test_within_the_stated_error(shape, target, method, interpolation, make):
    pattern, options = make(shape), {"grid": TARGETS[target], "interpolation": interpolation}
    wanted = summed(pattern, "reference", samples=101, **options)
    found = summed(pattern, method, **options)
    assert found.dtype == np.float32
    assert found.min() >= 0.0
    np.testing.assert_allclose(found, wanted, rtol=0, atol=STATED[method, interpolation] * wanted.max())


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "target",
    [Grid((60, 61), (1, 1)), Grid((31, 32), (2.1, 1.9)), Grid((30, 33), (0.4, 0.5)), Grid((1, 2), (1, 1))],
)
@pytest.mark.parametrize(("method", "interpolation"), STATED)
def test_symmetric_halves_the_work_only(shape, target, method, interpolation):
    """On a target that stays clear of the lone first row and column of even patterns."""
    pattern, options = fringes(shape), {"grid": target, "interpolation": interpolation}
    whole = summed(pattern, method, **options)
    half = summed(pattern, method, symmetric=True, **options)
    np.testing.assert_allclose(half, whole, rtol=0, atol=2e-5 * whole.max())


@pytest.mark.parametrize("shape", [(33, 33), (32, 30), (1, 9), (9, 1), (1, 1)])
@pytest.mark.parametrize("samples", [4, 13, 60])
def test_batch_is_its_two_passes(shape, samples):
    """Spelled out with SciPy: the mean of four neighbours, then one look-up a band."""
    noise = np.random.default_rng(3).random(shape, dtype=np.float32)
    pattern = Pattern(noise, Grid(shape, (1.0, 1.0)), REFERENCE, 1.0)
    count = -(-samples // 4)
    edges = 400e-9 * (7 / 4) ** (np.arange(count + 1) / count)
    step = (7 / 4) ** (1 / (4 * count))
    y, x = pattern.grid.axes()

    def scaled(values, ratio):
        places = np.meshgrid(ratio * y + shape[0] // 2, ratio * x + shape[1] // 2, indexing="ij")
        return ratio**2 * ndimage.map_coordinates(values, places, order=1, mode="grid-constant")

    first = sum(scaled(noise.astype(float), step**power) for power in (-1.5, -0.5, 0.5, 1.5)) / 4
    weights = bands(light.illuminant("D65"), edges)
    ratios = REFERENCE / np.sqrt(edges[1:] * edges[:-1])
    wanted = sum(scaled(first, ratio)[..., None] * w for ratio, w in zip(ratios, weights, strict=True))
    found = summed(pattern, "batch", samples=samples)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5 * max(wanted.max(), 1.0))


@pytest.mark.parametrize("name", ["E", "F1", "blackbody:2000K"])
def test_bands_share_out_the_white(name):
    spectrum = light.illuminant(name)
    weights = bands(spectrum, np.array([450e-9, 500e-9, 510e-9, 650e-9]))
    np.testing.assert_allclose(weights.sum(axis=0), light.white(spectrum), rtol=1e-12)
    assert weights.min() >= 0


def test_a_narrow_band_serves_too():
    """A spectrum that ends within the range is sampled where it has light, and beyond it where it must be."""
    pattern = fringes((121, 121))
    for low, high in ((600e-9, 640e-9), (710e-9, 760e-9)):
        spectrum = light.spectrum([low, high], [1.0, 1.0])
        wanted = light.spectral_sum(pattern, None, spectrum, "reference", interpolation="cubic").pixels
        for method in ("batch", "rays"):
            found = light.spectral_sum(pattern, None, spectrum, method, interpolation="cubic").pixels
            np.testing.assert_allclose(found, wanted, rtol=0, atol=2.5e-2 * wanted.max())


def test_nodes_stand_closer_for_narrower_light():
    def step(low, high):
        wavelengths, weights = light.quadrature(light.spectrum([low, high], [1.0, 1.0]), 500)
        return far_step(REFERENCE / wavelengths, weights)

    assert step(590e-9, 600e-9) < 0.7 * step(560e-9, 630e-9) < 0.5 * step(400e-9, 700e-9)


def test_rays_take_no_notice_of_few_samples():
    """As many wavelengths as follow the fringes, whatever was asked for."""
    pattern = fringes((121, 121))
    np.testing.assert_array_equal(summed(pattern, "rays", samples=2), summed(pattern, "rays", samples=60))


@pytest.mark.parametrize(
    ("size", "samples", "chosen"), [(64, 60, "full"), (512, 2, "full"), (512, 161, "rays")]
)
def test_auto_takes_the_cheaper(size, samples, chosen):
    pattern = fringes((size, size))
    options = {"samples": samples, "symmetric": True}
    np.testing.assert_array_equal(summed(pattern, "auto", **options), summed(pattern, chosen, **options))


def test_auto_keeps_full_where_rays_cannot_serve():
    shifted = Pattern(fringes((400, 400)).intensity, Grid((400, 400), (1, 1), (1.0, 0.0)), REFERENCE, 1.0)
    options = {"samples": 161, "grid": Grid((400, 400), (1, 1))}
    np.testing.assert_array_equal(summed(shifted, "auto", **options), summed(shifted, "full", **options))


@pytest.mark.parametrize(
    ("pattern", "spectrum", "method", "message"),
    [
        (
            fringes((20, 20)),
            "line:500nm",
            "batch",
            "'method' 'batch' needs a spectrum of kind 'power'; use 'full' for lines.",
        ),
        (
            fringes((20, 20)),
            "line:500nm",
            "rays",
            "'method' 'rays' needs a spectrum of kind 'power'; use 'full' for lines.",
        ),
        (
            Pattern(np.ones((4, 4), np.float32), Grid((4, 4), (1, 1), (0.5, 0.0)), REFERENCE, 1.0),
            "E",
            "rays",
            "'method' 'rays' needs a pattern centred on zero, got (0.5, 0.0); use 'full'.",
        ),
    ],
)
def test_refusals(pattern, spectrum, method, message):
    with pytest.raises(refuse.Refusal) as refusal:
        summed(pattern, method, spectrum)
    assert str(refusal.value) == message


@pytest.mark.parametrize("method", ["batch", "rays"])
def test_callables_are_for_the_reference(method):
    with pytest.raises(refuse.Refusal, match=f"'{method}' interpolates a sampled pattern; use 'reference'"):
        light.spectral_sum(
            lambda u, v: u + v, REFERENCE, light.illuminant("E"), method, grid=Grid((3, 3), (1, 1))
        )
