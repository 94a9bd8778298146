"""Measures of a pupil: transfer functions, Strehl ratio, encircled energy, cut-off, in closed form."""

import numpy as np
import pytest
from scipy.special import j0, j1

from aureole import Camera, Grid, Refusal, aperture, diffraction, glare, light

DIAMETER, WAVELENGTH = 3e-3, 550e-9
UNIT = DIAMETER / WAVELENGTH  # cycles per unit of sin θ at the cut-off
CIRCLE, SQUARE = aperture.circle(DIAMETER), aperture.rectangle(DIAMETER, DIAMETER)
PARTS = np.linspace(0, 1.1, 45)


def of_circle(s):
    """2/π (acos s − s √(1 − s²)): Goodman, Eq. 6-31."""
    s = np.minimum(s, 1)
    return 2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s**2))


def of_annulus(s, ratio):
    """W. H. Steel 1953: areas of overlapping discs, added up; the diameters are 1 and the ratio."""

    def lens(d, r, q):
        """Area that two discs of radii r and q share at a distance d."""
        d = np.clip(d, abs(r - q) + 1e-12, r + q)
        one = r**2 * np.arccos((d**2 + r**2 - q**2) / (2 * d * r))
        two = q**2 * np.arccos((d**2 + q**2 - r**2) / (2 * d * q))
        root = (r + q - d) * (d + r - q) * (d - r + q) * (d + r + q)
        return one + two - np.sqrt(np.maximum(root, 0)) / 2

    a, b = 0.5, ratio / 2
    crossed = np.where(s < a - b, np.pi * b**2, lens(s, a, b))
    return (lens(s, a, a) - 2 * crossed + lens(s, b, b)) / (np.pi * (a**2 - b**2))


def test_transfer_of_a_circle():
    for angle in (0.0, 0.7, np.pi / 2, 3.0):
        found = diffraction.mtf(CIRCLE, PARTS * UNIT, WAVELENGTH, angle)
        np.testing.assert_allclose(found, of_circle(PARTS), atol=5e-5)


def test_transfer_of_a_square_is_a_triangle_along_its_sides_and_its_square_across():
    along = diffraction.mtf(SQUARE, PARTS * UNIT, WAVELENGTH, [[0.0], [np.pi / 2]])
    np.testing.assert_allclose(along, np.tile(np.maximum(1 - PARTS, 0), (2, 1)), atol=1e-6)
    across = diffraction.mtf(SQUARE, PARTS * UNIT, WAVELENGTH, np.pi / 4)
    np.testing.assert_allclose(across, np.maximum(1 - PARTS / np.sqrt(2), 0) ** 2, atol=1e-6)


@pytest.mark.parametrize("ratio", [0.2, 0.5])
def test_transfer_of_an_annulus(ratio):
    found = diffraction.mtf(aperture.obstruction(CIRCLE, ratio), PARTS * UNIT, WAVELENGTH)
    np.testing.assert_allclose(found, of_annulus(PARTS, ratio), atol=2e-4)


def test_transfer_in_light_of_many_wavelengths_is_the_mean_by_luminance():
    lamp = light.illuminant("D65")
    wavelengths, weights = light.quadrature(lamp, 200)
    wanted = sum(
        weight * of_circle(PARTS * WAVELENGTH**-1 * each)
        for each, weight in zip(wavelengths, weights[:, 1] / weights[:, 1].sum(), strict=True)
    )
    np.testing.assert_allclose(diffraction.mtf(CIRCLE, PARTS * UNIT, lamp), wanted, atol=1e-3)


def test_transfer_of_a_pattern_is_its_fourier_transform():
    """Against the pattern itself, of an opening without symmetry and with a wavefront."""
    shape = aperture.with_wavefront(aperture.iris(5, DIAMETER), 64, {"coma-x": 9e-8}, defocus=2e-7)
    grid = Grid((256, 256), (0.5 / DIAMETER, 0.5 / DIAMETER))
    v, u = grid.axes()
    power = diffraction.far_power(shape, grid, wavelength=WAVELENGTH).astype(float)
    for part, angle in ((0.2, 0.0), (0.3, np.pi / 2), (0.25, 2.2)):
        found = diffraction.optical_transfer(shape, part * UNIT, WAVELENGTH, angle)
        x, y = part * DIAMETER * np.cos(angle), -part * DIAMETER * np.sin(angle)
        turned = np.exp(2j * np.pi * v * y) @ power @ np.exp(2j * np.pi * u * x) / power.sum()
        assert abs(found - turned) < 5e-3


@pytest.mark.parametrize("pair", [(2, 0), (3, 1), (4, 0), (3, -3)])
def test_an_aberration_never_raises_the_transfer(pair):
    flat = aperture.with_wavefront(CIRCLE, 256)
    bent = aperture.with_wavefront(CIRCLE, 256, {pair: 8e-8})
    for angle in (0.0, 1.0, np.pi / 2):
        limit = diffraction.mtf(flat, PARTS * UNIT, WAVELENGTH, angle)
        found = diffraction.mtf(bent, PARTS * UNIT, WAVELENGTH, angle)
        assert np.all(found <= limit + 1e-9)
        assert found[15] < 0.9 * limit[15]


def test_coma_along_x_is_not_alike_along_x_and_y():
    shape = aperture.with_wavefront(CIRCLE, 256, {"coma-x": 8e-8})
    sagittal, tangential = diffraction.mtf(shape, PARTS[15] * UNIT, WAVELENGTH, [0.0, np.pi / 2])
    assert sagittal < 0.8 * tangential


def test_encircled_energy_of_a_circle_is_rayleighs():
    """1 − J0² − J1²: 83.8 % at the first dark ring, 91.0 % at the second (Born and Wolf 8.5.2)."""
    z = np.array([0.0, 0.3, 1.2197, 2.2331, 3.2383, 10.0, 40.0])
    found = diffraction.encircled_energy(CIRCLE, z / UNIT, WAVELENGTH)
    np.testing.assert_allclose(found, 1 - j0(np.pi * z) ** 2 - j1(np.pi * z) ** 2, atol=1e-4)
    assert found[2] == pytest.approx(0.838, abs=5e-4)
    assert found[3] == pytest.approx(0.910, abs=5e-4)


def test_encircled_energy_is_that_of_the_point_spread_function():
    shape = aperture.with_wavefront(aperture.iris(5, DIAMETER), 128, {"coma-x": 9e-8}, defocus=4e-7)
    lamp = light.illuminant("line:550nm")
    pitch, focal_length = 1e-6, 50e-3
    camera = Camera(focal_length, focal_length / DIAMETER, 1e-3, 1e-3, (1000, 1000), shape)
    psf = glare.camera_psf(camera, (121, 121), lamp, border_fade=0)
    radii = np.array([4e-6, 10e-6, 25e-6, 50e-6])
    wanted = glare.encircled_energy(psf, radii, (pitch, pitch))
    found = diffraction.encircled_energy(shape, radii / focal_length, WAVELENGTH)
    np.testing.assert_allclose(found, wanted, atol=6e-3)


@pytest.mark.parametrize("waves", [0.25, 0.6])
def test_strehl_of_defocus_at_one_wavelength_and_in_white(waves):
    shape = aperture.with_wavefront(CIRCLE, 256, defocus=waves * WAVELENGTH)
    assert diffraction.strehl(shape, WAVELENGTH) == pytest.approx(np.sinc(waves) ** 2, abs=1e-4)
    lamp = light.illuminant("E")
    wavelengths, weights = light.quadrature(lamp, 200)
    share = weights[:, 1] / wavelengths**2
    wanted = np.sum(share * np.sinc(waves * WAVELENGTH / wavelengths) ** 2) / share.sum()
    assert diffraction.strehl(shape, lamp) == pytest.approx(wanted, abs=2e-3)
    assert diffraction.strehl(CIRCLE, lamp) == 1


def test_cut_off_is_the_longest_chord():
    cut = diffraction.cutoff_frequency
    assert cut(CIRCLE, WAVELENGTH) == pytest.approx(UNIT, rel=1e-5)
    assert cut(aperture.obstruction(CIRCLE, 0.5), WAVELENGTH, 1.0) == pytest.approx(UNIT, rel=1e-4)
    assert cut(aperture.rectangle(2e-3, 1e-3), WAVELENGTH) == pytest.approx(2e-3 / WAVELENGTH)
    assert cut(aperture.rectangle(2e-3, 1e-3), WAVELENGTH, np.pi / 2) == pytest.approx(1e-3 / WAVELENGTH)
    # A hexagon with a corner at +x is as long as its circle along x, √3/2 as long along y.
    six = aperture.iris(6, DIAMETER)
    assert cut(six, WAVELENGTH) == pytest.approx(UNIT, rel=2e-3)
    assert cut(six, WAVELENGTH, np.pi / 2) == pytest.approx(np.sqrt(3) / 2 * UNIT, rel=2e-3)
    raster = aperture.from_mask(aperture.rasterize(six, 512), DIAMETER)
    for angle in (0.0, np.pi / 2, np.pi):
        assert cut(raster, WAVELENGTH, angle) == pytest.approx(cut(six, WAVELENGTH, angle), rel=3e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: diffraction.mtf(CIRCLE, [np.nan], WAVELENGTH), "'frequencies' must hold finite numbers"),
        (lambda: diffraction.mtf(CIRCLE, [0.0], 0.0), "'light' must be a finite number > 0, got 0."),
        (lambda: diffraction.mtf(CIRCLE, [0.0], 1e-6, np.inf), "'angle' must hold finite numbers"),
        (lambda: diffraction.mtf(CIRCLE, [0.0], 1e-6, raster_size=0), "'raster_size' must be an integer"),
        (lambda: diffraction.encircled_energy(CIRCLE, [-1.0], 1e-6), "'radii' must be numbers >= 0, got -1."),
        (
            lambda: diffraction.cutoff_frequency(aperture.from_mask(np.ones((4, 4)), 1.0), 1e-6, 0.3),
            "a raster's cut-off is known along its rows and columns: 'angle' 0 or π/2.",
        ),
    ],
)
def test_refusals(make, message):
    with pytest.raises(Refusal) as refused:
        make()
    assert message in str(refused.value)
