"""From a formula to a table: sharp orders keep their energy, and a formula's own means are used."""

import numpy as np
import pytest

from aureole import light, surface
from aureole.refuse import Refusal
from aureole.surface.table import axes, cells, energy

GREEN = light.line(550e-9)


def narrow(h_t, h_b, wavelength, width=2e-3):
    """Return a spot at h_t = λ/d much narrower than a cell of a small table; its integral is 1."""
    place = wavelength / 1e-6
    return np.exp(-((h_t - place) ** 2 + h_b**2) / (2 * width**2)) / (2 * np.pi * width**2)


class Boxes:
    """Orders of width w along t times a plateau along b, with exact means over cells."""

    pitch, width = 1e-6, 1e-3

    def __call__(self, h_t, h_b, wavelength):
        inside = np.abs(h_t - wavelength / self.pitch) <= self.width / 2
        return inside / self.width * np.exp(-np.abs(h_b) / 0.1)

    def cell_factors(self, t_cells, b_cells, wavelength):
        edges = [np.clip(t_cells - wavelength / self.pitch, -self.width / 2, self.width / 2)]
        along_t = (edges[0][1] - edges[0][0]) / (t_cells[1] - t_cells[0]) / self.width
        running = np.sign(b_cells) * 0.1 * (1 - np.exp(-np.abs(b_cells) / 0.1))
        return (running[1] - running[0]) / (b_cells[1] - b_cells[0]), along_t


class OnlyMeans:
    """The same means without factors."""

    def __call__(self, h_t, h_b, wavelength):
        return Boxes()(h_t, h_b, wavelength)

    def cell_mean(self, t_cells, b_cells, wavelength):
        return np.multiply.outer(*Boxes().cell_factors(t_cells, b_cells, wavelength))


@pytest.mark.parametrize("warp", [1, 3, 5])
def test_cells_keep_the_energy_of_orders_narrower_than_they_are(warp):
    # Integrals: a box of area 1 along t, twice 0.1 (1 − e⁻²⁰) along b.
    table = surface.table_from_function(Boxes(), GREEN, (151, 128), warp=warp)
    assert energy(table)[1] == pytest.approx(0.2, rel=1e-6)


def test_points_miss_what_cells_keep():
    point = surface.table_from_function(Boxes(), GREEN, (151, 128), sample="point")
    assert abs(energy(point)[1] - 0.2) > 0.1


def test_factors_and_means_agree():
    factors = surface.table_from_function(Boxes(), "E", (60, 61), wavelengths=20).values
    means = surface.table_from_function(OnlyMeans(), "E", (60, 61), wavelengths=20).values
    assert np.abs(factors - means).max() <= 1e-6 * means.max()


def test_a_formula_without_means_is_sampled_until_its_orders_are_found():
    table = surface.table_from_function(lambda t, b, w: narrow(t, b, w, 0.02), GREEN, (64, 65), warp=3)
    assert energy(table)[1] == pytest.approx(1.0, rel=0.01)


def test_smooth_formulas_need_no_cells():
    smooth = lambda t, b, w: np.exp(-(t**2) - 2 * b**2) * (w / 500e-9)  # noqa: E731
    cell, point = (
        surface.table_from_function(smooth, "D65", 200, warp=1, sample=sample, wavelengths=10).values
        for sample in ("cell", "point")
    )
    assert np.abs(cell - point).max() <= 1e-3 * point.max()


def test_point_samples_are_the_formula():
    def tilted(h_t, h_b, wavelength):
        return 3 + h_t + 10 * h_b

    table = surface.table_from_function(tilted, GREEN, (5, 7), 1.5, 3, "point")
    h_b, h_t = axes(table)
    assert h_b[0] == 1.5
    assert np.allclose(table.values[..., 1], 3 + h_t[None, :] + 10 * h_b[:, None], rtol=1e-6)


def test_a_pattern_and_its_formula_give_one_table():
    # Amplitude model: M(λ_m h/λ) (λ_m/λ)².
    def formula(h_t, h_b, wavelength):
        ratio = 600e-9 / wavelength
        return ratio**2 * np.exp(-(ratio**2) * ((h_t - 0.2) ** 2 + (h_b + 0.1) ** 2) / 0.02)

    h = np.linspace(-1.5, 1.5, 601)
    wide = {"size": 90, "warp": 3, "half_range": 1.0}
    # The spot does not move with the wavelength in this formula, so one line serves.
    pattern = surface.diffraction_pattern(formula(h[None, :], -h[:, None], 600e-9), 1.5, 600e-9)
    measured = surface.table_from_pattern(pattern, light.line(600e-9), sample="point", **wide).values
    analytic = surface.table_from_function(formula, light.line(600e-9), sample="point", **wide).values
    assert np.abs(measured - analytic).max() <= 1e-3 * analytic.max()


def test_cells_tile_the_range_about_their_samples():
    for count, warp in ((8, 1), (9, 3), (64, 5)):
        low, high = cells(count, 2.0, warp)
        assert low[0] == -2.0
        assert high[-1] == 2.0
        assert np.array_equal(low[1:], high[:-1])
        assert np.all(high > low)
        assert np.allclose(low, -high[::-1])


def test_nan_and_unknown_words_are_refused():
    with pytest.raises(Refusal, match="'sample' must be one of"):
        surface.table_from_function(narrow, GREEN, 8, sample="cells")
    with pytest.raises(Refusal, match="finite"):
        surface.table_from_function(lambda t, b, w: np.full(np.broadcast(t, b).shape, np.nan), GREEN, 8)
