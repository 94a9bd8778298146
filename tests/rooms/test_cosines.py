"""The far field from cosine and sine transforms of a folded mask's quadrants."""

import numpy as np
import pytest

from aureole import Grid, aperture
from aureole.diffraction import far_field, far_power
from aureole.diffraction.chirpz import fft_lengths
from aureole.diffraction.cosines import cosines_field, cosines_power, cosines_serve
from aureole.diffraction.rows import fold, sample
from aureole.records import Aperture

WIDTH = 2e-3
RELATIVE = 5e-7  # error over the peak
# Which quadrants are left of a random mask by adding its mirror images; along y and x, 0 even, 1 odd.
SYMMETRIES = {
    "none": lambda mask: mask,
    "up-down": lambda mask: mask + mask[::-1],
    "left-right": lambda mask: mask + mask[:, ::-1],
    "point": lambda mask: mask + mask[::-1, ::-1],
    "both": lambda mask: mask + mask[::-1] + mask[:, ::-1] + mask[::-1, ::-1],
}
KEPT = {"none": [0, 1, 2, 3], "up-down": [0, 1], "left-right": [0, 2], "point": [0, 3], "both": [0]}


def mask_of(symmetry, size):
    mask = np.random.default_rng(size).integers(0, 64, (size, size)) / 256
    return Aperture(WIDTH, mask=SYMMETRIES[symmetry](mask).astype(np.float32))


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_symmetry_empties_quadrants(symmetry):
    mask = mask_of(symmetry, 16).mask
    assert fold(mask).kept == KEPT[symmetry]
    assert sample(mask)[0] == len(KEPT[symmetry])


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("size", [2, 16, 30])
@pytest.mark.parametrize(
    ("shape", "lengths"),
    [
        ((1, 1), (32, 32)),
        ((30, 30), (30, 30)),  # both Nyquist frequencies
        ((31, 31), (30, 30)),
        ((17, 30), (60, 30)),
        ((30, 12), (30, 90)),
        ((29, 288), (36, 300)),  # more than one block of rows side by side
        ((288, 29), (300, 36)),
    ],
)
def test_field_and_power_agree_with_the_reference(symmetry, size, shape, lengths):
    opening = mask_of(symmetry, size)
    pixel = WIDTH / size
    grid = Grid(shape, (1 / (lengths[0] * pixel), 1 / (lengths[1] * pixel)))
    assert fft_lengths(opening, grid) == lengths
    peak = aperture.area(opening)
    wanted = far_field(opening, grid, "reference").amplitude
    field = cosines_field(opening, grid, lengths)
    power = cosines_power(opening, grid, lengths)
    assert field.dtype == np.complex64
    assert power.dtype == np.float32
    np.testing.assert_allclose(field, wanted, rtol=0, atol=RELATIVE * peak)
    np.testing.assert_allclose(power, np.abs(wanted) ** 2, rtol=0, atol=2 * RELATIVE * peak**2)


def test_a_wide_mask_with_dark_borders():
    """More than one block of columns side by side, and columns that are left out."""
    size = 320
    mask = np.zeros((size, size), dtype=np.float32)
    mask[20:-30, 12:-11] = np.random.default_rng(3).random((size - 50, size - 23))
    opening = Aperture(WIDTH, mask=mask)
    grid = Grid((40, 44), (1 / WIDTH, 1 / WIDTH))
    wanted = far_field(opening, grid, "reference").amplitude
    found = cosines_field(opening, grid, (size, size))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=RELATIVE * aperture.area(opening))


def test_a_dark_mask():
    dark = Aperture(WIDTH, mask=np.zeros((8, 8), dtype=np.float32))
    grid = Grid((8, 9), (1 / WIDTH, 1 / WIDTH))
    np.testing.assert_array_equal(cosines_field(dark, grid, (8, 8)), 0)
    np.testing.assert_array_equal(cosines_power(dark, grid, (8, 8)), 0)


def test_the_power_keeps_the_masks_symmetry():
    grid = Grid((31, 33), (1 / WIDTH, 1 / WIDTH))
    power = cosines_power(mask_of("none", 32), grid, (32, 32))
    np.testing.assert_array_equal(power, power[::-1, ::-1])
    power = cosines_power(mask_of("up-down", 32), grid, (32, 32))
    np.testing.assert_array_equal(power, power[::-1])


@pytest.mark.parametrize(
    ("symmetry", "size", "shape", "lengths", "centre", "serves"),
    [
        ("both", 16, (16, 16), (16, 16), 0, True),
        ("up-down", 16, (17, 17), (16, 16), 0, True),
        ("none", 16, (16, 16), (16, 16), 0, False),  # a real FFT is as fast
        ("none", 16, (16, 16), (32, 32), 0, True),
        ("both", 16, (18, 16), (16, 16), 0, False),  # beyond Nyquist
        ("both", 16, (8, 8), (8, 16), 0, False),  # shorter than the mask
        ("both", 16, (16, 16), (17, 16), 0, False),
        ("both", 15, (15, 15), (16, 16), 0, False),
        ("both", 14, (14, 14), (14, 14), 0, False),  # a factor of 7
        ("both", 16, (16, 16), (16, 16), 3, False),
    ],
)
def test_where_they_serve(symmetry, size, shape, lengths, centre, serves):
    opening = mask_of(symmetry, size)
    spacing = tuple(1 / (length * WIDTH / size) for length in lengths)
    grid = Grid(shape, spacing, (centre * spacing[0], 0.0))
    assert cosines_serve(opening, grid, lengths) == serves
    # Whoever serves, the answer is the same.
    wanted = np.abs(far_field(opening, grid, "reference").amplitude) ** 2
    found = far_power(opening, grid, "fft")
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2 * RELATIVE * aperture.area(opening) ** 2)
