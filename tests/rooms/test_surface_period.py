"""A grating's period from its orders, and notes where a measurement disagrees with them."""

import numpy as np
import pytest

from aureole import surface
from aureole.surface.geometry import BenchGeometry

WAVELENGTH = 532e-9


def orders(spacing, half_range=1.0, size=601, width=None, shift=0.0, skew=0.0, missing=()):
    """A row of Gaussian orders along t under a falling envelope."""
    h = np.linspace(-half_range, half_range, size)
    width = 0.06 * spacing if width is None else width
    row = np.zeros(size)
    for number in range(-40, 41):
        place = shift + spacing * (number + skew * number**2)
        if number not in missing:
            row += np.exp(-((place / 0.6 / half_range) ** 2)) * np.exp(-0.5 * ((h - place) / width) ** 2)
    across = np.exp(-0.5 * (h / width) ** 2)
    return surface.diffraction_pattern(across[:, None] * row, half_range, WAVELENGTH)


@pytest.mark.parametrize("spacing", [0.0712, 0.177, 0.332])
def test_the_period_is_recovered_to_two_thousandths(spacing):
    along_t, along_b = surface.period_of(orders(spacing))
    assert along_t.period == pytest.approx(WAVELENGTH / spacing, rel=2e-3)
    assert along_b is None


def test_a_missing_zero_order_does_not_halve_the_period():
    along_t, _ = surface.period_of(orders(0.2, missing=(0, -2, 2, 4, -4)))
    assert along_t.period == pytest.approx(WAVELENGTH / 0.2, rel=2e-3)


def test_a_cds_period_comes_back_from_its_pattern():
    edges = np.linspace(-1.0, 1.0, 1202)
    cells = np.stack([edges[:-1], edges[1:]])
    values = surface.grating("cd").cell_mean(cells, cells[:, ::-1], WAVELENGTH)
    pattern = surface.diffraction_pattern(values, cells.mean(axis=0)[-1], WAVELENGTH)
    assert surface.period_of(pattern)[0].period == pytest.approx(1.6e-6, rel=1e-3)


def test_noise_and_a_smooth_lobe_have_no_period():
    noise = np.random.default_rng(5).exponential(size=(301, 301))
    assert surface.period_of(surface.diffraction_pattern(noise, 0.1, WAVELENGTH)) == (None, None)
    h = np.linspace(-1, 1, 301)
    lobe = np.exp(-8 * (h[:, None] ** 2 + h**2))
    assert surface.period_of(surface.diffraction_pattern(lobe, 0.1, WAVELENGTH)) == (None, None)


def test_a_wrong_wavelength_is_noted_where_the_period_is_known():
    pattern = orders(0.2)
    assert surface.order_notes(pattern, WAVELENGTH / 0.2) == ()
    off = surface.diffraction_pattern(pattern.values, 1.0, WAVELENGTH + 10e-9)
    (note,) = surface.order_notes(off, WAVELENGTH / 0.2)
    assert "2.66 µm is known" in note
    assert "% too large" in note


def test_a_wrong_centre_and_a_wrong_tilt_are_noted():
    (note,) = surface.order_notes(orders(0.2, shift=3 * 2 / 600))
    assert "+3.0 samples" in note
    (note,) = surface.order_notes(orders(0.2, skew=0.004))
    assert "tilt" in note


def test_a_measurement_with_the_wrong_geometry_says_so():
    true = BenchGeometry(0.2, 0.25, 4e-4, tilt=(0.0, 0.3))
    rows, columns = np.mgrid[0:301.0, 0:301.0]
    h_t, h_b, irradiance = true.h_of(rows, columns, (150.0, 150.0), (301, 301))
    photo = irradiance * np.exp(-0.5 * (h_b / 0.02) ** 2 - 2 * h_t**2) * np.cos(np.pi * h_t / 0.08) ** 40
    right = surface.measure_pattern(photo, 1.0, true, WAVELENGTH, centre=(150.0, 150.0))
    assert right.metadata["notes"] == []
    assert right.metadata["period"][0] == pytest.approx(WAVELENGTH / 0.08, rel=2e-3)
    level = BenchGeometry(0.2, 0.25, 4e-4)
    wrong = surface.measure_pattern(photo, 1.0, level, WAVELENGTH, centre=(150.0, 150.0))
    assert any("tilt" in note for note in wrong.metadata["notes"])
