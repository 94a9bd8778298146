"""Wavefronts: Zernike's orthonormality, defocus, Maréchal, tilt, Parseval, brute force."""

import numpy as np
import pytest

from aureole import Grid, aperture, diffraction, light
from aureole.diffraction import autocorrelation

DIAMETER, WAVELENGTH = 3e-3, 550e-9
PAIRS = [(n, m) for n in range(7) for m in range(-n, n + 1, 2)]


def centre_power(shape):
    return float(diffraction.far_power(shape, Grid((1, 1), (1.0, 1.0)), wavelength=WAVELENGTH)[0, 0])


def test_zernikes_polynomials_are_orthonormal_on_the_disc():
    """∬ Z Z' dx dy = π δ, by Gauss-Legendre in ρ² and equal steps of angle: exact for polynomials."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    radius, weight = np.sqrt((nodes + 1) / 2), weights / 2
    angle = 2 * np.pi * np.arange(32) / 32
    x, y = radius[:, None] * np.cos(angle), -radius[:, None] * np.sin(angle)
    values = np.array([aperture.zernike(pair, x, y) for pair in PAIRS])
    products = np.einsum("iab,jab,a->ij", values, values, weight) / 32
    np.testing.assert_allclose(products, np.eye(len(PAIRS)), atol=1e-12)


def test_zernikes_polynomials_as_printed():
    """Noll 1976, Table I, in polar coordinates with the angle counter-clockwise as seen."""
    generator = np.random.default_rng(4)
    r, t = generator.random(50), 2 * np.pi * generator.random(50)
    x, y = r * np.cos(t), -r * np.sin(t)
    printed = {
        (0, 0): np.ones(50),
        (1, 1): 2 * r * np.cos(t),
        (1, -1): 2 * r * np.sin(t),
        (2, 0): np.sqrt(3) * (2 * r**2 - 1),
        (2, -2): np.sqrt(6) * r**2 * np.sin(2 * t),
        (2, 2): np.sqrt(6) * r**2 * np.cos(2 * t),
        (3, -1): np.sqrt(8) * (3 * r**3 - 2 * r) * np.sin(t),
        (3, 1): np.sqrt(8) * (3 * r**3 - 2 * r) * np.cos(t),
        (3, -3): np.sqrt(8) * r**3 * np.sin(3 * t),
        (3, 3): np.sqrt(8) * r**3 * np.cos(3 * t),
        (4, 0): np.sqrt(5) * (6 * r**4 - 6 * r**2 + 1),
        (4, 2): np.sqrt(10) * (4 * r**4 - 3 * r**2) * np.cos(2 * t),
    }
    for pair, wanted in printed.items():
        np.testing.assert_allclose(aperture.zernike(pair, x, y), wanted, atol=1e-12)


@pytest.mark.parametrize("waves", [0.1, 0.5, 1.0, 1.7, 3.0])
def test_a_defocused_circle_on_the_axis(waves):
    """∫ exp(i2πwρ²) d(ρ²) from 0 to 1 has the square sinc²(w): dark at whole waves (Born and Wolf 8.8)."""
    shape = aperture.with_wavefront(aperture.circle(DIAMETER), 512, defocus=waves * WAVELENGTH)
    found = centre_power(shape) / aperture.area(shape) ** 2
    assert found == pytest.approx(np.sinc(waves) ** 2, abs=2e-5)


@pytest.mark.parametrize("pair", [(2, 2), (3, 1), (4, 0), (5, -3)])
def test_small_errors_follow_marechal(pair):
    """exp(−(2πσ)²) for an error of σ waves root mean square, up to its fourth power."""
    for sigma in (0.01, 0.03, 0.07):
        shape = aperture.with_wavefront(aperture.circle(DIAMETER), 512, {pair: sigma * WAVELENGTH})
        strehl = centre_power(shape) / aperture.area(shape) ** 2
        assert strehl == pytest.approx(np.exp(-((2 * np.pi * sigma) ** 2)), abs=1e-4 + 20 * sigma**3)


@pytest.mark.parametrize("method", ["reference", "chirpz", "fft"])
def test_a_tilt_moves_the_pattern(method):
    """W = a x moves F to sin θ = a, here by a whole number of samples, but for the pixels' steps."""
    size, samples = 256, (7, -4)
    pixel = DIAMETER / size
    step = 1 / (512 * pixel)
    # Over the radius a tilt of rms c is 2 c x / R, upward and to the right.
    rms = {
        "tilt-x": samples[0] * step * WAVELENGTH * DIAMETER / 4,
        "tilt-y": -samples[1] * step * WAVELENGTH * DIAMETER / 4,
    }
    flat = aperture.from_mask(aperture.rasterize(aperture.iris(5, DIAMETER), size), DIAMETER)
    tilted = aperture.with_wavefront(flat, size, rms, radius=DIAMETER / 2)
    grid = Grid((41, 40), (step, step))
    moved = Grid((41, 40), (step, step), (samples[1] * step, samples[0] * step))

    # The pixels' sinc stays where it is, so it is taken off both.
    def sinc(g):
        v, u = g.axes()
        return np.sinc(v * pixel)[:, None] * np.sinc(u * pixel)

    found = diffraction.far_field(tilted, moved, method, wavelength=WAVELENGTH).amplitude / sinc(moved)
    wanted = diffraction.far_field(flat, grid, "reference").amplitude / sinc(grid)
    np.testing.assert_allclose(found, wanted, atol=1e-5 * aperture.area(flat))


def test_the_phase_is_that_of_the_wavelength_and_longer_paths_lag():
    """Two pixels, by hand."""
    mask = np.zeros((2, 2), dtype=np.float32)
    mask[0] = 1.0, 0.5
    path = np.array([[0.0, 1e-7], [0.0, 0.0]], dtype=np.float32)
    shape = aperture.from_mask(mask, 2.0)
    from dataclasses import replace

    value = diffraction.far_field(
        replace(shape, wavefront=path), Grid((1, 1), (1.0, 1.0)), "reference", wavelength=4e-7
    ).amplitude[0, 0]
    assert value == pytest.approx(1 + 0.5j, abs=1e-7)


def rough(size):
    generator = np.random.default_rng(size)
    terms = {pair: 3e-8 * generator.standard_normal() for pair in PAIRS}
    return aperture.with_wavefront(
        aperture.from_mask(generator.random((size, size)), DIAMETER), size, terms, radius=DIAMETER
    )


@pytest.mark.parametrize("size", [16, 21])
@pytest.mark.parametrize("method", ["chirpz", "fft"])
def test_fast_methods_agree_with_the_reference(size, method):
    shape = rough(size)
    pixel = DIAMETER / size
    for length in (size // 2, size, 2 * size + 1):
        step = 1 / (length * pixel)
        for samples, centre in (((17, 18), (0.0, 0.0)), ((12, 9), (3 * step, -11 * step))):
            grid = Grid(samples, (step, step), centre)
            found = diffraction.far_field(shape, grid, method, wavelength=WAVELENGTH).amplitude
            wanted = diffraction.far_field(shape, grid, "reference", wavelength=WAVELENGTH).amplitude
            np.testing.assert_allclose(found, wanted, atol=1e-5 * aperture.area(shape))
            auto = diffraction.far_power(shape, grid, wavelength=WAVELENGTH)
            np.testing.assert_allclose(auto, np.abs(wanted) ** 2, atol=2e-5 * aperture.area(shape) ** 2)


def test_a_wavefront_breaks_the_mirror_symmetry():
    """F(−q) = F*(q) holds for real apertures only: coma points one way."""
    shape = aperture.with_wavefront(aperture.circle(DIAMETER), 128, {"coma-x": 1e-7})
    grid = Grid((33, 33), (0.5 / DIAMETER, 0.5 / DIAMETER))
    power = diffraction.far_power(shape, grid, wavelength=WAVELENGTH)
    assert np.abs(power - power[::-1, ::-1]).max() > 0.05 * power.max()
    np.testing.assert_allclose(power, power[::-1], atol=1e-5 * power.max())


@pytest.mark.parametrize("size", [32, 33])
def test_parseval_with_a_wavefront(size):
    """Over one period of the DFT, the pixel's sinc taken off, ∑|F|² is ∑|f|²."""
    shape = rough(size)
    pixel = DIAMETER / size
    step = 1 / (2 * size * pixel)
    grid = Grid((2 * size, 2 * size), (step, step))
    v, u = grid.axes()
    power = diffraction.far_power(shape, grid, "fft", wavelength=WAVELENGTH)
    power /= (np.sinc(v * pixel)[:, None] * np.sinc(u * pixel)) ** 2
    assert float(power.sum()) * step**2 == pytest.approx(aperture.energy(shape), rel=1e-5)


@pytest.mark.parametrize("fringes", [0.3, 1.0, 3.0])
def test_pixel_integrals_are_the_means_of_samples(fringes):
    """Against a Gauss-Legendre rule over each pixel, which follows its fringes."""
    shape = aperture.with_wavefront(aperture.iris(5, DIAMETER), 96, {"coma-x": 1e-7}, defocus=5e-7)
    spacing = fringes / DIAMETER
    grid = Grid((13, 12), (spacing, spacing), (2 * spacing, -3 * spacing))
    nodes, weights = np.polynomial.legendre.leggauss(9)
    mean = np.zeros(grid.shape)
    for y, weight_y in zip(nodes, weights, strict=True):
        for x, weight_x in zip(nodes, weights, strict=True):
            centre = (grid.centre[0] + y / 2 * spacing, grid.centre[1] + x / 2 * spacing)
            moved = Grid(grid.shape, grid.spacing, centre)
            power = diffraction.far_power(shape, moved, "reference", wavelength=WAVELENGTH)
            mean += weight_y * weight_x / 4 * power
    found = autocorrelation.mean_power(shape, grid, WAVELENGTH)
    np.testing.assert_allclose(found, mean, atol=1e-3 * mean.max())


def test_a_starburst_with_a_flat_wavefront_is_the_starburst_without():
    flat = aperture.from_mask(aperture.rasterize(aperture.iris(6, DIAMETER), 256), DIAMETER)
    zero = aperture.with_wavefront(flat, 256)
    assert zero.wavefront is not None
    lamp = light.illuminant("line:550nm")
    grid = Grid((40, 41), (1e-4, 1e-4))
    for sample in ("area", "point"):
        with_zero = diffraction.starburst(zero, grid, lamp, sample=sample).pixels
        without = diffraction.starburst(flat, grid, lamp, "exact", sample).pixels
        np.testing.assert_allclose(with_zero, without, atol=2e-4 * without.max())


def test_a_starbursts_energy_is_kept_by_a_wavefront():
    shape = aperture.with_wavefront(aperture.circle(DIAMETER), 256, {"coma-x": 2e-7}, defocus=1e-6)
    found = diffraction.starburst(shape, Grid((129, 129), (1e-4, 1e-4)), light.illuminant("line:550nm"))
    assert float(found.pixels[..., 1].sum()) == pytest.approx(1, abs=0.01)


def test_a_starburst_has_each_wavelengths_own_phase():
    """Defocus of one wave at 550 nm darkens the axis there, and not at half the wavelength's distance."""
    shape = aperture.with_wavefront(aperture.circle(DIAMETER), 128, defocus=550e-9)
    grid = Grid((1, 1), (1e-7, 1e-7))
    for nanometres in (420.0, 550.0, 690.0):
        lamp = light.illuminant(f"line:{nanometres}nm")
        peak = diffraction.starburst(aperture.circle(DIAMETER), grid, lamp, sample="point").pixels[0, 0, 1]
        found = diffraction.starburst(shape, grid, lamp, sample="point").pixels[0, 0, 1]
        assert found / peak == pytest.approx(np.sinc(550 / nanometres) ** 2, abs=1e-3)
