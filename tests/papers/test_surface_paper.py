"""A. Toisoul, A. Ghosh, "Practical acquisition and rendering of diffraction effects in surface
reflectance", ACM Transactions on Graphics, 2017.

Its printed numbers and equations, what its figures claim, and the limits that it lists about itself (sections
4.3 and 7). Its times, its prefilter's error (6.2) and its bokeh's (Appendix C) are measured again by
`aureole bench surface` and in the tests of those rooms.
"""

import math

import numpy as np
import pytest

from aureole import light, surface
from aureole.light.differences import difference_2000, lab
from aureole.refuse import Refusal
from aureole.surface.integrate import table_rows
from aureole.surface.table import axes, axis, energy

# Section 4.3: the two filters, and the range of its sums.
RED, GREEN = 680e-9, 520e-9
WAVELENGTHS = np.arange(380, 781, 5) / 1e9
# Section 6.1: a compact disc.
SPACING, WIDTH, SLITS = 2.0e-6, 0.5e-6, 21


def observer():
    """Return the observer at the paper's wavelengths."""
    places, functions = light.observer()
    return np.stack([np.interp(WAVELENGTHS, places, one) for one in functions.T], axis=1)


def trapezoids(values):
    """Integrate over the paper's wavelengths, whose weights are the trapezoid rule's."""
    return np.trapezoid(values, WAVELENGTHS, axis=0)


def photograph(wavelength=RED, half_range=1.0, size=401):
    """Return smooth lobes as a measured pattern."""
    h = np.linspace(-half_range, half_range, size)
    lobes = sum(
        np.exp(-((h[None, :] - t) ** 2 + (-h[:, None] - b) ** 2) / (2 * 0.05**2))
        for t, b in ((0.0, 0.0), (0.4, 0.1), (-0.3, -0.5))
    )
    return surface.diffraction_pattern(lobes, half_range, wavelength)


def test_section_4_3_equation_15_by_the_trapezoidal_rule():
    """S = 1/(4π² F0²) ∫ (λm/λ)² L(λm h/λ) P x̄ dλ, over the light's ∫ P ȳ dλ; L = 4π² F0² M."""
    pattern, lamp = photograph(), light.illuminant("A")
    table = surface.table_from_pattern(pattern, "A", 65, 1.0, 3, "paper", sample="point")
    power = np.interp(WAVELENGTHS, lamp.wavelengths, lamp.values)
    h_b, h_t = axes(table)
    places = np.linspace(-1.0, 1.0, 401)
    summed = []
    for wavelength in WAVELENGTHS:
        near_t, near_b = (
            np.maximum(1 - np.abs(RED / wavelength * h[:, None] - places) / 0.005, 0) for h in (h_t, h_b)
        )
        # The photograph's row 0 is at +h.
        summed.append((RED / wavelength) ** 2 * near_b[:, ::-1] @ pattern.values @ near_t.T)
    weights = power[:, None] * observer()
    wanted = trapezoids(np.stack(summed)[..., None] * weights[:, None, None]) / trapezoids(weights[:, 1])
    # Our wavelengths are the means of cells, the paper's their borders.
    assert np.abs(table.values - wanted).max() <= 2e-3 * wanted.max()


def test_section_4_3_samples_at_odd_powers():
    """A table of 2048 × 2048 at (uⁿ, vⁿ), u even in [−1, 1], n odd, "typically 5"; ours reaches |h| = 2."""
    u = np.linspace(-1.0, 1.0, 2048)
    assert axis(2048, 1.0, 5) == pytest.approx(u**5, abs=1e-14)
    assert axis(2048) == pytest.approx(2 * u**5, abs=1e-14)
    near = np.abs(axis(2048, 1.0, 5)) < 0.03
    assert near.sum() > 0.49 * 2048
    with pytest.raises(Refusal, match="odd"):
        surface.table_from_pattern(photograph(), size=9, warp=4)


@pytest.mark.parametrize(("sample", "count"), [("cell", 5), ("point", 81)])
def test_section_4_3_a_table_of_the_papers_size_is_the_direct_sum(sample, count):
    """2048 × 2048 from 1000 × 1000, at rows from the border to the middle; means' slow sums are very slow."""
    noise = np.random.default_rng(1).random((1000, 1000), dtype=np.float32)
    pattern = surface.diffraction_pattern(noise, 1.0, RED)
    rows = slice(5, 1040, 207)
    wanted = table_rows(pattern, "E", 2048, rows, count, sample)
    found = surface.table_from_pattern(pattern, "E", wavelengths=count, sample=sample).values
    assert found.shape == (2048, 2048, 3)
    assert np.abs(found[rows] - wanted).max() <= 1e-6 * wanted.max()
    assert wanted[-1].max() > 0.5 * wanted.max()


def test_section_4_3_the_papers_range_holds_the_same_values():
    wide, narrow = (
        surface.table_from_pattern(photograph(), "E", 129, reach, 1, "paper", sample="point")
        for reach in (2.0, 1.0)
    )
    assert np.abs(wide.values[32:97:4, 32:97:4] - narrow.values[::8, ::8]).max() <= 1e-6


def test_a_range_of_one_loses_orders_that_ours_shows():
    """A disc at 60 degrees: orders two and three stand at |h| > 1, where [−1, 1]² ends."""
    h = np.array([2, 3]) * 650e-9 / 1.6e-6
    lit = surface.table_from_grating("cd", light.line(650e-9), 1025, warp=1)
    cut = surface.table_from_grating("cd", light.line(650e-9), 1025, 1.0, warp=1)
    outside = h[h > 1.0]
    assert outside.size == 1
    assert surface.lookup(lit, outside, 0.0)[:, 1].min() > 0.01
    assert not surface.lookup(cut, outside, 0.0).any()


@pytest.mark.parametrize(
    ("model", "printed", "apart"), [("paper", (0.282, 0.286), 17.7), ("phase", (0.240, 0.234), 25.9)]
)
def test_equation_15_turns_the_zero_order_blue(model, printed, apart):
    """At h = 0 white light is scaled by λ⁻² (or λ⁻⁴): a highlight must be drawn as a lobe instead."""
    table = surface.table_from_pattern(photograph(550e-9), "E", 9, model=model, sample="point")
    centre = table.values[4, 4].astype(float)
    assert light.chromaticity(centre) == pytest.approx(printed, abs=2e-3)
    white = np.asarray(table.white)
    shift = difference_2000(lab(white, white), lab(centre / centre[1], white))
    assert float(shift) == pytest.approx(apart, abs=0.2)


def test_section_4_4_a_red_photograph_ends_at_its_first_order_and_a_blue_one_goes_on():
    """Figures 8, 16 and 17: a photograph of one size holds more orders the shorter its wavelength."""
    grating = surface.multislit_grating(SPACING, WIDTH, SLITS, spread=0.01)
    reach, line = 1.5 * RED / SPACING, light.line(GREEN)
    h = np.linspace(-reach, reach, 1201)
    second = 2 * GREEN / SPACING
    seen = {}
    for wavelength in (RED, 450e-9):
        values = grating.pattern(h[None, :], h[::-1, None], wavelength)
        pattern = surface.diffraction_pattern(values, reach, wavelength)
        table = surface.table_from_pattern(pattern, line, (101, 1025), warp=1, model="paper")
        h_t = axes(table)[1]
        profile = table.values[..., 1].sum(axis=0)
        seen[wavelength] = [
            profile[np.abs(h_t - place) < 0.05].max() / profile.max() for place in (second / 2, second)
        ]
    assert seen[RED][0] > 0.3
    assert seen[RED][1] == 0.0
    assert min(seen[450e-9]) > 0.1


@pytest.mark.parametrize("name", ["E", "A", "F1", "LED-B1", "LED-B3", "LED-B5", "cool"])
def test_figure_15_any_light(name):
    """A pattern's whole light has the colour of ∫ P x̄ dλ, as (λm/λ)² h keeps each wavelength's energy."""
    a = light.illuminant("A")
    cool = light.spectrum(a.wavelengths, 1 / a.values, name="cool")  # "inverse incandescent"
    lamp = cool if name == "cool" else light.illuminant(name)
    pattern = photograph()
    table = surface.table_from_pattern(pattern, lamp, 201, model="amplitude")
    held = pattern.values.sum(dtype=float) * (2 / 400) ** 2
    assert energy(table) == pytest.approx(held * light.white(lamp), rel=1e-5)
    assert surface.rgb(table).sum(axis=(0, 1)).min() > 0
    if name == "cool":
        assert light.chromaticity(light.white(lamp))[0] < 0.28


def test_figures_1_and_21_violet_is_inside_in_every_light():
    for name in ("E", "A", "F1", "LED-B3"):
        table = surface.table_from_grating("cd-toisoul-2017", name, (33, 1025), warp=1)
        h_t = axes(table)[1]
        first = (h_t > 0.17) & (h_t < 0.36)
        red, _, blue = np.moveaxis(np.maximum(surface.rgb(table)[16, first], 0), -1, 0)
        assert (blue @ h_t[first]) / blue.sum() < (red @ h_t[first]) / red.sum() - 0.04


def test_equation_16_and_the_disc_of_section_6_1():
    """Δ = 2.0 µm, w = 0.5 µm, N = 21: poles are sinc², N − 2 maxima lie between, order 4 is missing."""
    step = 532e-9 / SPACING
    orders = surface.multislit(np.arange(5) * step, WIDTH, SPACING, SLITS, 532e-9)
    assert orders == pytest.approx(np.sinc(0.25 * np.arange(5)) ** 2, abs=1e-12)
    assert orders[4] == pytest.approx(0.0, abs=1e-12)
    sines = np.linspace(step / SLITS, step * (1 - 1 / SLITS), 20001)
    between = surface.multislit(sines, WIDTH, SPACING, SLITS, 532e-9)
    maxima = np.flatnonzero((between[1:-1] > between[:-2]) & (between[1:-1] > between[2:]))
    assert maxima.size == SLITS - 2
    lines = surface.grating("cd-toisoul-2017").along
    assert (lines.period, lines.width, lines.count) == (SPACING, WIDTH, SLITS)
    numbers, angles = surface.orders(surface.grating("cd-toisoul-2017"), 0.0, 532e-9)
    assert np.degrees(angles[numbers == 1]) == pytest.approx([math.degrees(math.asin(0.266))])


def test_figure_13_higher_orders_are_worse_before_they_are_better():
    """Section 5.2: terms of a series that has not converged add light that is not there."""
    pixels = (np.indices((24, 24)) % 12 < 7).all(axis=0).astype(float)
    deep, shallow = (surface.height_field(pixels * depth, 1.3e-6) for depth in (0.45e-6, 0.02e-6))
    found = [surface.taylor_error(deep, GREEN, order) for order in (1, 2, 5)]
    assert found[0] < found[1] < found[2]
    assert surface.taylor_error(deep, GREEN, 30) < 1e-3
    found = [surface.taylor_error(shallow, GREEN, order) for order in (1, 2, 5)]
    assert found[0] > found[1] > found[2]


def test_section_5_a_first_order_series_is_three_tables():
    pixels = (np.indices((12, 12)) % 6 < 3).all(axis=0) * 0.05e-6
    tables = surface.taylor_tables(pixels, 1.3e-6, 1, size=17, wavelengths=3)
    assert len(tables.values) == 3


def test_section_1_displays():
    """Pixels of "16-25 µm" are the three parts of those of 534 and 342 an inch."""
    for name, microns in (("lcd-534ppi", 16), ("lcd-342ppi", 25)):
        assert surface.grating(name).along.period * 1e6 == pytest.approx(microns, abs=0.3)


def test_section_5_limits_of_lenses():
    """f/5.6 resolves 343 and f/2.8 687 lines a millimetre "at 0 % contrast", on the sensor, at 520 nm."""
    assert pytest.approx(343, abs=0.5) == 1e-3 / (520e-9 * 5.6)
    assert pytest.approx(687, abs=0.5) == 1e-3 / (520e-9 * 2.8)


def test_appendix_c_a_pixel_of_the_bokeh():
    """106 lines of a grating of 600 a millimetre: 0.083 µm a pixel."""
    assert surface.pixel_pitch(106, 1e-3 / 600, 2128) * 1e6 == pytest.approx(0.083, abs=5e-4)


def test_reciprocity_is_exact():
    table = surface.table_from_grating("cd-toisoul-2017", "F1", 65)
    rng = np.random.default_rng(4)
    radius, angle = np.sqrt(rng.random((2, 200))), 2 * np.pi * rng.random((2, 200))
    to_light, to_eye = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    there, back = to_light + to_eye, to_eye + to_light
    assert np.array_equal(
        surface.lookup(table, there[:, 0], there[:, 1]), surface.lookup(table, back[:, 0], back[:, 1])
    )


@pytest.mark.parametrize("model", ["phase", "amplitude", "paper"])
def test_lights_add_linearly(model):
    """The table of two lamps together is their tables' sum, each by its luminance; of two bands as well."""
    bands = [photograph(RED, size=61), photograph(450e-9, 0.8, 51)]
    a, led = light.illuminant("A"), light.illuminant("LED-B3")
    places = led.wavelengths
    lamps = [light.spectrum(places, np.interp(places, one.wavelengths, one.values)) for one in (a, led)]
    both = light.spectrum(places, lamps[0].values + lamps[1].values)
    tables = [surface.table_from_pattern(bands, lamp, 33, model=model) for lamp in (*lamps, both)]
    levels = [light.tristimulus(lamp)[1] for lamp in (*lamps, both)]
    wanted = (levels[0] * tables[0].values + levels[1] * tables[1].values) / levels[2]
    # Each light's wavelengths stand at its own means of the same cells.
    assert np.abs(tables[2].values - wanted).max() <= 1e-3 * wanted.max()
