"""The near field's bench: its discrete rivals against closed forms and direct integrals."""

import numpy as np
import pytest

from aureole import Aperture, Grid, diffraction
from aureole.bench import convolved, fractional, shapes

WIDTH, WAVELENGTH = 0.1, 550e-9


def places(size):
    return (np.arange(size) - size // 2) / np.sqrt(size)


def lump(size):
    """A smooth complex picture that is not symmetric and dies away before the border."""
    x = places(size)
    across = np.exp(-np.pi * ((x - 0.8) / 1.3) ** 2 + 2j * x)
    return np.outer(np.exp(-np.pi * ((x + 0.7) / 0.8) ** 2), across)


def distance(fresnel_number, width=WIDTH):
    """The distance at which an opening across half of the window has a Fresnel number."""
    return (width / 4) ** 2 / (WAVELENGTH * fresnel_number)


@pytest.mark.parametrize("order", [-1.7, -0.4, 0, 0.1, 0.5, 0.77, 1, 1.2, 1.5, 2, 2.5, 3.9])
def test_a_gaussian_is_its_own_fractional_transform(order):
    """exp(−πx²) is the first eigenfunction, with eigenvalue 1 for every order."""
    gaussian = np.exp(-np.pi * places(144) ** 2)
    picture = np.outer(gaussian, gaussian).astype(complex)
    np.testing.assert_allclose(fractional.fractional(picture, order), picture, atol=1e-12)


@pytest.mark.parametrize("order", [0.3, 0.62, 1.4, -0.8])
def test_the_first_hermite_function_turns_with_the_order(order):
    """x exp(−πx²) has eigenvalue exp(−iaπ/2)."""
    x = places(144)
    picture = np.outer(np.exp(-np.pi * x**2), x * np.exp(-np.pi * x**2)).astype(complex)
    wanted = np.exp(-0.5j * np.pi * order) * picture
    np.testing.assert_allclose(fractional.fractional(picture, order), wanted, atol=1e-12)


@pytest.mark.parametrize("size", [144, 161])
def test_order_one_is_the_fourier_transform(size):
    picture = lump(size)
    phase = np.exp(-2j * np.pi * np.outer(places(size), places(size))) / np.sqrt(size)
    wanted = phase @ picture @ phase.T
    np.testing.assert_allclose(fractional.fractional(picture, 1), wanted, atol=1e-12)
    # It is a limit from both sides, where the algorithm takes other ways.
    for near in (1 - 1e-9, 1 + 1e-9):
        np.testing.assert_allclose(fractional.fractional(picture, near), wanted, atol=1e-7)


def test_order_two_turns_the_picture_about():
    picture = lump(161)
    np.testing.assert_allclose(fractional.fractional(picture, 2), picture[::-1, ::-1], atol=1e-12)


@pytest.mark.parametrize(("first", "second"), [(0.37, 0.85), (0.37, -0.37), (1.3, 0.9), (-0.6, 0.2)])
def test_orders_add_up(first, second):
    twice = fractional.fractional(fractional.fractional(lump(144), first), second)
    np.testing.assert_allclose(twice, fractional.fractional(lump(144), first + second), atol=1e-12)


@pytest.mark.parametrize("order", [0.2, 0.62, 1.1])
@pytest.mark.parametrize("size", [144, 161])
def test_the_fractional_transform_is_its_integral(order, size):
    """The defining integral, summed finely."""
    angle = 0.5 * np.pi * order
    t = np.linspace(-8, 8, 6001)
    x = places(size)[:, None]
    kernel = np.exp(1j * np.pi * ((x**2 + t**2) / np.tan(angle) - 2 * x * t / np.sin(angle)))
    kernel *= np.sqrt(1 - 1j / np.tan(angle)) * (t[1] - t[0])
    across = kernel @ (np.exp(-np.pi * ((t - 0.8) / 1.3) ** 2 + 2j * t))
    down = kernel @ np.exp(-np.pi * ((t + 0.7) / 0.8) ** 2)
    np.testing.assert_allclose(fractional.fractional(lump(size), order), np.outer(down, across), atol=1e-12)


def test_single_precision_stays_single():
    found = fractional.fractional(lump(144).astype(np.complex64), 0.4)
    assert found.dtype == np.complex64
    np.testing.assert_allclose(found, fractional.fractional(lump(144), 0.4), atol=1e-5)


@pytest.mark.parametrize("fresnel_number", [0.5, 4, 60])
def test_fresnel_diffraction_of_a_gaussian_by_its_order(fresnel_number):
    """exp(−πx²/b²) spreads to exp(−πx²/(b² + iλz)) b / √(b² + iλz) a direction: phase and scale as well."""
    size, far = 256, distance(fresnel_number)
    waist = WIDTH / 6
    x = (np.arange(size) - size // 2) * WIDTH / size
    gaussian = np.exp(-np.pi * (x / waist) ** 2)
    mask = np.outer(gaussian, gaussian).astype(np.float32)
    field, spacing = fractional.fractional_near(mask, WIDTH, far, WAVELENGTH)
    order = fractional.fresnel_order(size, WIDTH, far, WAVELENGTH)
    window = (WIDTH / 2) ** 2 / (WAVELENGTH * far)
    assert np.tan(0.5 * np.pi * order) == pytest.approx(size / (4 * window))
    assert spacing == pytest.approx(WIDTH / size / np.cos(0.5 * np.pi * order))
    wide = waist**2 + 1j * WAVELENGTH * far
    seen = (np.arange(size) - size // 2) * spacing
    line = waist / np.sqrt(wide) * np.exp(-np.pi * seen**2 / wide)
    np.testing.assert_allclose(field, np.outer(line, line), atol=3e-6)


def rms(found, truth):
    """The difference of two irradiances, root mean square, of the mean."""
    found, truth = np.abs(found) ** 2, np.abs(truth) ** 2
    return float(np.sqrt(np.mean((found - truth) ** 2)) / truth.mean())


@pytest.fixture(scope="module")
def opening():
    return shapes.mask("heptagon", 128)


def truth(mask, far, spacing):
    """The exact near field of the mask at the places of samples, of which the middle one is on the axis."""
    size = len(mask)
    half = 0.5 * WIDTH / size
    grid = Grid((size, size), (spacing, spacing), (half, half))
    return diffraction.near_field(Aperture(WIDTH, mask=mask), grid, far, WAVELENGTH, "reference").amplitude


@pytest.mark.parametrize("fresnel_number", [1, 3, 10])
def test_the_fractional_near_field_of_a_mask_comes_near_the_exact_one(opening, fresnel_number):
    """Hard edges have no highest frequency, so that samples lose some of them."""
    far = distance(fresnel_number)
    field, spacing = fractional.fractional_near(opening, WIDTH, far, WAVELENGTH)
    exact = truth(opening, far, spacing)
    assert rms(field, exact) < 0.06
    assert rms(field[:, ::-1], exact) > 0.1


CONVOLUTIONS = [
    convolved.impulse_response,
    convolved.impulse_response_by_axes,
    convolved.transfer_function,
]


@pytest.mark.parametrize("way", CONVOLUTIONS)
@pytest.mark.parametrize("size", [24, 25])
def test_padded_convolutions_are_sums_over_samples(way, size):
    """Σ f h of a random mask, with the impulse response, or with the transfer function's own transform."""
    mask = np.random.default_rng(7).random((size, size), dtype=np.float32)
    far, spacing = distance(0.7), WIDTH / size
    lag = np.arange(size)[:, None] - np.arange(size)
    if way is convolved.transfer_function:
        frequency = np.fft.fftfreq(2 * size, spacing)
        response = np.exp(-1j * np.pi * WAVELENGTH * far * frequency**2)
        line = (response * np.exp(2j * np.pi * lag[..., None] * spacing * frequency)).mean(axis=-1)
    else:
        scale = WAVELENGTH * far
        line = spacing * np.exp(1j * np.pi * (lag * spacing) ** 2 / scale) / np.sqrt(1j * scale)
    wanted = line @ mask @ line.T
    np.testing.assert_allclose(way(mask, WIDTH, far, WAVELENGTH), wanted, atol=3e-6 * np.abs(wanted).max())


def test_convolutions_have_the_errors_that_sampling_gives(opening):
    """The impulse response aliases at short distances and the transfer function at long ones."""
    far, near = distance(0.5), distance(30)
    step = WIDTH / len(opening)
    errors = {
        (way.__name__, z): rms(way(opening, WIDTH, z, WAVELENGTH), truth(opening, z, step))
        for way in CONVOLUTIONS
        for z in (far, near)
    }
    assert errors["impulse_response", far] == pytest.approx(errors["impulse_response_by_axes", far], rel=0.01)
    assert errors["impulse_response", far] < 0.01 < 0.1 < errors["transfer_function", far]
    assert errors["transfer_function", near] < 0.2 < 0.5 < errors["impulse_response", near]


def test_without_a_frame_the_light_comes_round(opening):
    far = distance(2)
    exact = truth(opening, far, WIDTH / len(opening))
    framed, bare = (convolved.impulse_response(opening, WIDTH, far, WAVELENGTH, k) for k in (2, 1))
    assert rms(bare, exact) > 4 * rms(framed, exact)
