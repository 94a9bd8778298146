"""From a pattern at one wavelength to a table for a whole light: closed forms, and the fast sum's truth."""

import numpy as np
import pytest

from aureole import light, surface
from aureole.refuse import Refusal
from aureole.surface.integrate import bilinear
from aureole.surface.table import axes, cells, energy

GREEN, RED = 530e-9, 650e-9


def gaussian(width, wavelength, half_range=1.0, size=401, offset=(0.0, 0.0)):
    h = np.linspace(-half_range, half_range, size)
    values = np.exp(-((h[None, :] - offset[0]) ** 2 + (-h[:, None] - offset[1]) ** 2) / (2 * width**2))
    return surface.diffraction_pattern(values, half_range, wavelength)


@pytest.mark.parametrize("warp", [1, 3, 5])
@pytest.mark.parametrize("size", [64, 65, (40, 51)])
@pytest.mark.parametrize(("shape", "half_range"), [((90, 101), 1.0), ((101, 90), 0.1), ((60, 60), 2.0)])
@pytest.mark.parametrize("sample", ["cell", "point"])
def test_separable_is_the_reference(warp, size, shape, half_range, sample):
    noise = np.random.default_rng(3).random(shape)
    pattern = surface.diffraction_pattern(noise, half_range, RED)
    options = {"size": size, "warp": warp, "half_range": 1.7, "wavelengths": 12, "sample": sample}
    fast = surface.table_from_pattern(pattern, method="separable", **options).values
    truth = surface.table_from_pattern(pattern, method="reference", **options).values
    assert truth.max() > 0
    assert np.abs(fast - truth).max() <= 1e-6 * truth.max()


@pytest.mark.parametrize("model", ["phase", "amplitude", "paper"])
def test_separable_is_the_reference_in_each_model_and_with_several_bands(model):
    rng = np.random.default_rng(4)
    bands = [surface.diffraction_pattern(rng.random((50, 61)), 0.8, w) for w in (RED, 450e-9, GREEN)]
    options = {"spectrum": "A", "size": 63, "model": model}
    fast = surface.table_from_pattern(bands, method="separable", **options).values
    truth = surface.table_from_pattern(bands, method="reference", **options).values
    assert np.abs(fast - truth).max() <= 1e-6 * truth.max()


@pytest.mark.parametrize(("shape", "half_range"), [((400, 301), 0.02), ((40, 31), 1.0)])
def test_means_are_those_of_many_points(shape, half_range):
    """Cells of 23 × 17 samples, or 1/20 of one, against 60 × 60 places in each."""
    pattern = surface.diffraction_pattern(np.random.default_rng(6).random(shape), half_range, RED)
    table = surface.table_from_pattern(pattern, light.line(GREEN), 33, 0.03, 3, "amplitude")
    shares = (np.arange(60) + 0.5) / 60
    low, high = cells(33, 0.03, 3)
    places = (low[:, None] + (high - low)[:, None] * shares).ravel() * RED / GREEN
    fine = bilinear(pattern, places[None, :], -places[:, None]).reshape(33, 60, 33, 60)
    wanted = (RED / GREEN) ** 2 * fine.mean(axis=(1, 3))
    assert wanted.max() > 0.3
    assert np.abs(table.values[..., 1] - wanted).max() <= 4e-3 * wanted.max()


@pytest.mark.parametrize("warp", [1, 5])
@pytest.mark.parametrize("size", [64, 301])
def test_means_keep_the_energy_of_orders_narrower_than_a_cell(warp, size):
    h = np.linspace(-0.5, 0.5, 601)
    combs = [np.exp(-((((h + shift) % 0.09) - 0.045) ** 2) / (2 * 0.001**2)) for shift in (0.02, 0.05)]
    pattern = surface.diffraction_pattern(np.outer(*combs), 0.5, RED)
    held = pattern.values.sum(dtype=float) / 600**2 * light.white(light.line(GREEN))
    tables = {
        sample: surface.table_from_pattern(
            pattern, light.line(GREEN), size, warp=warp, model="amplitude", sample=sample
        )
        for sample in ("cell", "point")
    }
    assert energy(tables["cell"]) == pytest.approx(held, rel=1e-6)
    assert energy(tables["point"]) != pytest.approx(held, rel=0.03)


@pytest.mark.parametrize(("model", "power"), [("phase", 4), ("amplitude", 2), ("paper", 2)])
def test_one_line_scales_the_pattern(model, power):
    # M(h) = exp(−h²/2s²) at λ_m; at λ it is (λ_m/λ)^p exp(−(λ_m h/λ)²/2s²).
    pattern = gaussian(0.1, RED)
    table = surface.table_from_pattern(pattern, light.line(GREEN), 101, 1.0, 1, model, sample="point")
    h_b, h_t = axes(table)
    ratio = RED / GREEN
    wanted = ratio**power * np.exp(-(ratio**2) * (h_t[None, :] ** 2 + h_b[:, None] ** 2) / (2 * 0.1**2))
    # Linear interpolation between samples s/20 apart errs by (1/20)²/8 of the peak a side.
    assert np.abs(table.values[..., 1] - wanted).max() <= 1e-3 * ratio**power
    assert table.values[50, 50] == pytest.approx(ratio**power * light.white(light.line(GREEN)), rel=1e-6)


def test_a_gaussian_pattern_under_white_light_is_a_sum_of_gaussians():
    pattern = gaussian(0.2, RED, half_range=2.0, size=801)
    table = surface.table_from_pattern(pattern, "E", 81, warp=3, sample="point")
    wavelengths, weights = light.quadrature(light.illuminant("E"), 81)
    h_b, h_t = axes(table)
    squared = h_t[None, :] ** 2 + h_b[:, None] ** 2
    wanted = sum(
        weight * (RED / w) ** 4 * np.exp(-((RED / w) ** 2) * squared[..., None] / (2 * 0.2**2))
        for w, weight in zip(wavelengths, weights, strict=True)
    )
    assert np.abs(table.values - wanted).max() <= 1e-3 * wanted.max()


def test_amplitude_keeps_the_energy_at_each_wavelength_and_phase_does_not():
    pattern = gaussian(0.05, RED, half_range=0.5, size=501)
    energies = {
        model: [
            surface.albedo(surface.table_from_pattern(pattern, light.line(w), 501, 1.0, 3, model))[1]
            for w in (RED, GREEN)
        ]
        for model in ("amplitude", "phase")
    }
    wanted = 4 * np.pi**2 * 2 * np.pi * 0.05**2
    assert energies["amplitude"] == pytest.approx([wanted, wanted], rel=1e-3)
    assert energies["phase"] == pytest.approx([wanted, wanted * (RED / GREEN) ** 2], rel=1e-3)


def test_row_zero_is_up_and_columns_run_along_the_tangent():
    pattern = gaussian(0.03, GREEN, offset=(0.5, 0.25))
    table = surface.table_from_pattern(pattern, light.line(GREEN), 201, 1.0, 1, sample="point")
    row, column = np.unravel_index(table.values[..., 1].argmax(), (201, 201))
    assert (row, column) == (75, 150)  # h_b = 0.25 lies above the middle row, h_t = 0.5 right of it
    assert surface.lookup(table, 0.5, 0.25)[1] == pytest.approx(1.0, rel=1e-3)
    assert surface.lookup(table, 0.5, -0.25)[1] == pytest.approx(0.0, abs=1e-6)


def test_orders_lie_where_the_grating_equation_says():
    # A lone spot at h = λ_m/d is, at each other wavelength, at h = λ/d.
    pitch = 1.6e-6
    pattern = gaussian(0.01, RED, size=801, offset=(RED / pitch, 0.0))
    for wavelength in (400e-9, GREEN, 700e-9):
        table = surface.table_from_pattern(pattern, light.line(wavelength), (21, 2001), 1.0, 1)
        h_t = axes(table)[1]
        profile = table.values[10, :, 1]
        assert (profile @ h_t) / profile.sum() == pytest.approx(wavelength / pitch, abs=1e-4)


def test_lights_add_linearly():
    noise = np.random.default_rng(5).random((40, 40))
    pattern = surface.diffraction_pattern(noise, 1.0, GREEN)
    a, b = 450e-9, 610e-9
    both = light.spectrum([a, b], [2.0, 1.0], "lines")
    tables = [surface.table_from_pattern(pattern, light.line(w), 41) for w in (a, b)]
    # A table is relative to its own light's luminance.
    y = [2.0 * light.tristimulus(light.line(a))[1], light.tristimulus(light.line(b))[1]]
    wanted = (y[0] * tables[0].values + y[1] * tables[1].values) / sum(y)
    found = surface.table_from_pattern(pattern, both, 41).values
    assert np.abs(found - wanted).max() <= 1e-6 * wanted.max()


def test_bands_are_mixed_linearly_between_their_wavelengths():
    flat = [
        surface.diffraction_pattern(np.full((20, 20), level), 2.0, w)
        for level, w in ((1.0, 500e-9), (3.0, 600e-9))
    ]
    found = {}
    for wavelength in (450e-9, 500e-9, 525e-9, 600e-9, 650e-9):
        table = surface.table_from_pattern(flat, light.line(wavelength), 3, 0.5, 1, "amplitude")
        found[wavelength] = table.values[1, 1, 1]
    low, high = (500 / 525) ** 2 * 1.0, (600 / 525) ** 2 * 3.0
    wanted = [(500 / 450) ** 2, 1.0, 0.75 * low + 0.25 * high, 3.0, 3.0 * (600 / 650) ** 2]
    assert list(found.values()) == pytest.approx(wanted, rel=1e-6)


def test_the_last_stage_is_the_table():
    pattern = gaussian(0.1, RED, size=41)
    stages = list(surface.table_from_pattern_stages(pattern, "E", (600, 20)))
    fractions = [stage.fraction for stage in stages]
    assert len(stages) == 4
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert np.array_equal(
        stages[-1].result.values, surface.table_from_pattern(pattern, "E", (600, 20)).values
    )


def test_bilinear_has_the_samples_and_zero_outside():
    pattern = surface.diffraction_pattern([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], 0.5, GREEN)
    assert bilinear(pattern, np.array([-0.5, 0.0, 0.5]), np.array(0.5)).tolist() == [1.0, 2.0, 3.0]
    assert bilinear(pattern, np.array(0.25), np.array(0.0)) == pytest.approx(4.0)
    assert bilinear(pattern, np.array([9.0, -9.0]), np.array([9.0, -9.0])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"model": "born"}, "'model' must be one of"),
        ({"method": "fast"}, "'method' must be one of"),
        ({"warp": 4}, "'warp' must be odd"),
        ({"half_range": 2.5}, "'half_range' must be a number from 0 to 2"),
        ({"size": 1}, "'size' must be an integer >= 2"),
        ({"patterns": []}, "'patterns' needs one pattern or more"),
        ({"spectrum": "D56"}, "Did you mean 'D65'"),
        ({"sample": "mean"}, "'sample' must be one of"),
        ({"zero_order": "drop"}, "'zero_order' must be one of"),
    ],
)
def test_refusals(change, message):
    asked = {"patterns": gaussian(0.1, RED, size=9), "size": 5, **change}
    with pytest.raises(Refusal, match=message):
        surface.table_from_pattern(**asked)


def test_two_bands_of_one_wavelength_are_refused():
    with pytest.raises(Refusal, match="two are of the same"):
        surface.table_from_pattern([gaussian(0.1, RED, size=9), gaussian(0.2, RED, size=9)], size=5)


@pytest.mark.parametrize(
    ("values", "half_range", "wavelength", "message"),
    [
        ([[1.0, np.nan], [0.0, 0.0]], 1.0, RED, "finite"),
        ([[1.0, 2.0]], 1.0, RED, "two rows and columns"),
        (np.ones((2, 2)), 0.0, RED, "'half_range'"),
        (np.ones((2, 2)), 1.0, -RED, "'wavelength'"),
    ],
)
def test_patterns_that_are_refused(values, half_range, wavelength, message):
    with pytest.raises(Refusal, match=message):
        surface.diffraction_pattern(values, half_range, wavelength)
