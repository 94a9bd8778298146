"""Laws of the spectral sum: closed form, energy, similarity, linearity, neutrality."""

import numpy as np
import pytest

from aureole import light
from aureole.records import Grid, Pattern

REFERENCE = 550e-9
WIDTH = 20.0  # of the Gaussian, in samples
SAMPLED = [method for method in light.METHODS if method != "reference"]
NAMES = ["E", "D65", "A", "F1", "blackbody:2000K", "line:620nm"]


def gaussian(u, v):
    """A pattern whose integral over the plane is 1."""
    return np.exp(-np.pi * (u * u + v * v) / WIDTH**2) / WIDTH**2


def sampled(shape=(257, 256), spacing=(1.0, 1.0)):
    grid = Grid(shape, spacing)
    y, x = grid.axes()
    return Pattern(gaussian(x[None, :], y[:, None]).astype(np.float32), grid, REFERENCE, 1.0)


def integral_over_the_table(spectrum, u, v):
    """Σ over the 1 nm table of weight × ρ² P(ρ q): each wavelength a Gaussian of its own width."""
    wavelengths, functions = light.observer()
    power = np.interp(wavelengths, spectrum.wavelengths, spectrum.values, left=0.0, right=0.0)
    weights = power[:, None] * functions
    ratio = (REFERENCE / wavelengths)[:, None, None]
    scaled = ratio**2 * gaussian(ratio * u, ratio * v)
    return np.einsum("wyx,wc->yxc", scaled, weights / weights[:, 1].sum())


@pytest.mark.parametrize("name", ["E", "D65", "A"])
@pytest.mark.parametrize("method", list(light.METHODS))
def test_a_gaussian_has_a_closed_form(name, method):
    grid = Grid((31, 30), (3.3, 3.3))
    y, x = grid.axes()
    wanted = integral_over_the_table(light.illuminant(name), x[None, :], y[:, None])
    found = light.spectral_sum(
        sampled(), None, light.illuminant(name), method, grid=grid, interpolation="cubic"
    ).pixels
    # "batch" interpolates its second pass linearly and has 15 bands.
    error = 3e-3 if method == "batch" else 1.5e-4
    np.testing.assert_allclose(found, wanted, rtol=0, atol=error * wanted.max())


def test_an_exact_pattern_leaves_only_the_sampling_of_wavelengths():
    grid = Grid((31, 30), (3.3, 3.3))
    y, x = grid.axes()
    wanted = integral_over_the_table(light.illuminant("D65"), x[None, :], y[:, None])
    errors = []
    for samples in (15, 60, 240):
        found = light.spectral_sum(gaussian, REFERENCE, light.illuminant("D65"), grid=grid, samples=samples)
        errors.append(np.abs(found.pixels - wanted).max() / wanted.max())
    assert errors[0] < 2e-3
    assert errors[1] < 1.5e-4
    assert errors[2] < 1e-5


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_interpolation_gets_better_with_the_grid(interpolation):
    """Halving the spacing divides the error by 2 or more (linear) or 8 (cubic)."""
    grid = Grid((21, 21), (3.7, 3.7))
    exact = light.spectral_sum(gaussian, REFERENCE, light.illuminant("E"), grid=grid).pixels
    errors = []
    for pattern in (sampled((65, 65), (4.0, 4.0)), sampled((129, 129), (2.0, 2.0))):
        made = light.spectral_sum(
            pattern, None, light.illuminant("E"), grid=grid, interpolation=interpolation
        ).pixels
        errors.append(np.abs(made - exact).max() / exact.max())
    assert errors[1] < errors[0] / (2.0 if interpolation == "linear" else 8.0)
    assert errors[1] < (6e-3 if interpolation == "linear" else 4e-4)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("method", "samples"), [("reference", 5), ("full", 5), ("full", 60), ("batch", 60), ("rays", 60)]
)
def test_energy_goes_into_each_channel_in_proportion_to_the_white(name, method, samples):
    spectrum = light.illuminant(name)
    if spectrum.kind == "lines" and method in ("batch", "rays"):
        method = "full"  # these refuse lines
    pixels = light.spectral_sum(
        sampled(), None, spectrum, method, samples=samples, interpolation="cubic"
    ).pixels
    error = 5e-4 if method == "batch" else 5e-5  # its second pass is linear
    np.testing.assert_allclose(pixels.sum(axis=(0, 1), dtype=float), light.white(spectrum), rtol=error)


@pytest.mark.parametrize("spacing", [0.5, 1.0, 2.0])
def test_energy_does_not_depend_on_the_output_grid(spacing):
    grid = Grid((int(240 / spacing), int(240 / spacing)), (spacing, spacing), (0.2, -0.3))
    pixels = light.spectral_sum(
        sampled(), None, light.illuminant("E"), grid=grid, interpolation="cubic"
    ).pixels
    energy = pixels.sum(axis=(0, 1), dtype=float) * spacing**2
    np.testing.assert_allclose(energy, light.white(light.illuminant("E")), rtol=2e-5)


@pytest.mark.parametrize("name", [name for name in NAMES if not name.startswith("line")])
@pytest.mark.parametrize("space", ["rec709", "acescg", "rec2020"])
def test_the_sum_of_a_pattern_is_neutral_whatever_the_light(name, space):
    picture = light.spectral_sum(sampled(), None, light.illuminant(name), interpolation="cubic")
    totals = light.convert(picture, space).pixels.sum(axis=(0, 1), dtype=float)
    np.testing.assert_allclose(totals, 1.0, rtol=5e-5)


@pytest.mark.parametrize("method", ["reference", "full"])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_line_at_the_reference_gives_the_pattern_back(method, interpolation):
    pattern = sampled((32, 33))
    made = light.spectral_sum(
        pattern, None, light.line(REFERENCE), method, interpolation=interpolation
    ).pixels
    wanted = pattern.intensity[:, :, None] * light.white(light.line(REFERENCE))
    np.testing.assert_allclose(made, wanted, rtol=3e-6, atol=1e-12)


@pytest.mark.parametrize("method", ["reference", "full"])
def test_twice_the_frequency_at_half_the_wavelength(method):
    """Similarity: a line at λ_r / 2 shows four times the pattern, at half the size."""
    pattern = Pattern(sampled((64, 64)).intensity, Grid((64, 64), (1.0, 1.0)), 900e-9, 1.0)
    made = light.spectral_sum(pattern, None, light.line(450e-9), method).pixels[:, :, 1]
    np.testing.assert_allclose(made[16:48, 16:48], 4.0 * pattern.intensity[::2, ::2], rtol=3e-6)
    assert made[:15].max() == made[:, 49:].max() == 0.0


def test_linear_in_the_spectrum():
    """With each light weighed by its luminance."""
    pattern, parts = sampled((40, 41)), [light.line(460e-9), light.line(610e-9)]
    mixed = light.spectrum([460e-9, 610e-9], [3.0, 0.5], "lines")
    luminances = np.array([3.0, 0.5]) * [light.tristimulus(part)[1] for part in parts]
    alone = [light.spectral_sum(pattern, None, part).pixels for part in parts]
    wanted = np.tensordot(luminances / luminances.sum(), alone, axes=1)
    np.testing.assert_allclose(
        light.spectral_sum(pattern, None, mixed).pixels, wanted, rtol=0, atol=2e-6 * wanted.max()
    )


def test_linear_in_the_pattern():
    first, second = sampled((30, 30)).intensity, np.random.default_rng(2).random((30, 30)).astype(np.float32)
    d65 = light.illuminant("D65")
    together = light.spectral_sum(first + 2 * second, REFERENCE, d65).pixels
    apart = (
        light.spectral_sum(first, REFERENCE, d65).pixels
        + 2 * light.spectral_sum(second, REFERENCE, d65).pixels
    )
    np.testing.assert_allclose(together, apart, rtol=0, atol=3e-6 * apart.max())


def test_red_lies_outside_violet():
    """Long waves spread further: the colour of a Gaussian reddens outwards."""
    pixels = light.spectral_sum(sampled(), None, light.illuminant("E")).pixels
    redness = pixels[128, 128:160, 0] / pixels[128, 128:160, 2]
    assert np.all(np.diff(redness) > 0)


def over_the_table(spectrum, power):
    """Σ of weight × ρ^power over the 1 nm table: (3,)."""
    wavelengths, functions = light.observer()
    density = np.interp(wavelengths, spectrum.wavelengths, spectrum.values, left=0.0, right=0.0)
    weights = density[:, None] * functions
    return ((REFERENCE / wavelengths)[:, None] ** power * weights).sum(axis=0) / weights[:, 1].sum()


@pytest.mark.parametrize("method", SAMPLED)
@pytest.mark.parametrize("name", ["E", "A", "F1"])
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_constant_pattern_keeps_its_value_times_the_mean_square_scale(method, name, symmetric):
    """S_c = Σ w ρ², at every pixel whose wavelengths all lie within the pattern."""
    pattern = Pattern(np.full((241, 240), 0.3, np.float32), Grid((241, 240), (1, 1)), REFERENCE, 1.0)
    target, spectrum = Grid((100, 101), (1.3, 1.3)), light.illuminant(name)
    found = light.spectral_sum(pattern, None, spectrum, method, grid=target, symmetric=symmetric).pixels
    wanted = np.broadcast_to(0.3 * over_the_table(spectrum, 2), found.shape)
    np.testing.assert_allclose(found, wanted, rtol=5e-3 if method == "batch" else 5e-4)


@pytest.mark.parametrize("method", SAMPLED)
@pytest.mark.parametrize("power", [1, 2, 3, 4])
def test_power_laws_keep_their_slope(method, power):
    """|q|^−p becomes |q|^−p Σ w ρ^(2 − p): neutral for p = 2, bluer below, redder above."""
    grid = Grid((401, 401), (1.0, 1.0))
    y, x = grid.axes()
    radius = np.hypot(y[:, None], x[None, :])
    falling = np.where(radius > 2, radius, 2.0) ** -float(power)
    pattern = Pattern(falling.astype(np.float32), grid, REFERENCE, 1.0)
    spectrum = light.illuminant("E")
    found = light.spectral_sum(pattern, None, spectrum, method, symmetric=True, interpolation="cubic").pixels
    ring = (radius > 20) & (radius < 135)
    relative = found[ring] * radius[ring, None] ** power
    wanted = np.broadcast_to(over_the_table(spectrum, 2 - power), relative.shape)
    np.testing.assert_allclose(relative, wanted, rtol=1.2e-2 if method == "batch" else 2e-3)


@pytest.mark.parametrize("method", SAMPLED)
@pytest.mark.parametrize("wavelength", [400e-9, 529e-9, 780e-9])
def test_the_reference_wavelength_is_free(method, wavelength):
    """The same light through the same opening, in the same directions, whatever the label of its pattern."""
    ratio = wavelength / REFERENCE
    pattern = sampled((301, 301))
    relabelled = Pattern(pattern.intensity, pattern.grid, wavelength, 1.0)
    first, second = (
        light.spectral_sum(each, None, light.illuminant("E"), method, grid=grid, interpolation="cubic").pixels
        for each, grid in (
            (pattern, Grid((41, 40), (1.5, 1.5))),
            (relabelled, Grid((41, 40), (1.5 / ratio, 1.5 / ratio))),
        )
    )
    np.testing.assert_allclose(second / ratio**2, first, rtol=0, atol=3e-4 * first.max())


def test_streaks_of_a_slit_sum_to_their_mean():
    """Far out a wide spectrum leaves half of sin²: S_c → Σ w ρ² / (2 (π ρ u)²) of sinc²."""
    grid = Grid((65, 1501), (0.125, 0.125))
    u = grid.axes()[1]
    pattern = Pattern(np.tile(np.sinc(u) ** 2, (65, 1)).astype(np.float32), grid, REFERENCE, 1.0)
    target = Grid((1, 161), (0.125, 0.125), (0.0, 45.0))
    pixels = light.spectral_sum(
        pattern, None, light.illuminant("E"), "rays", grid=target, interpolation="cubic"
    ).pixels
    wanted = over_the_table(light.illuminant("E"), 0) / (2 * np.pi**2)
    relative = pixels[0] * target.axes()[1][:, None] ** 2
    np.testing.assert_allclose(relative, np.broadcast_to(wanted, relative.shape), rtol=2e-2)
