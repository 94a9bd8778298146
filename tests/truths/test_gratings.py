"""Gratings: orders where the grating equation has them, energy, and sharp orders that cells do not miss."""

import math

import numpy as np
import pytest

from aureole import light, surface
from aureole.surface.height import order_powers
from aureole.surface.table import cells, energy

GREEN = 550e-9
CD = surface.grating("cd")


@pytest.mark.parametrize(
    ("name", "nanometres", "degrees"),
    [
        ("cd", 380, 13.74),
        ("cd", 532, 19.42),
        ("cd", 650, 23.97),
        ("cd", 780, 29.18),
        ("dvd", 380, 30.90),
        ("dvd", 532, 45.97),
        ("dvd", 650, 61.45),
    ],
)
def test_first_orders_at_normal_incidence(name, nanometres, degrees):
    """θ = asin(λ / d), of 1.6 and 0.74 µm."""
    numbers, angles = surface.orders(surface.grating(name), 0.0, nanometres * 1e-9)
    assert math.degrees(angles[numbers == 1][0]) == pytest.approx(degrees, abs=0.006)


def test_a_blu_ray_disc_has_no_order_at_normal_incidence_and_one_at_grazing():
    disc = surface.grating("bluray")
    for nanometres in (380, 550, 780):
        assert surface.orders(disc, 0.0, nanometres * 1e-9)[0].tolist() == [0]
    assert 1 in surface.orders(disc, math.radians(80), 550e-9)[0]
    assert 1 not in surface.orders(disc, math.radians(89), 645e-9)[0]


@pytest.mark.parametrize("degrees", [-70, 0, 30, 60])
def test_orders_stand_at_whole_h_at_every_incidence(degrees):
    incidence = math.radians(degrees)
    numbers, angles = surface.orders(CD, incidence, GREEN)
    h = math.sin(incidence) + np.sin(angles)
    np.testing.assert_allclose(h, numbers * GREEN / CD.along.period, atol=1e-12)
    # The next orders on both sides would lie beyond the horizon.
    for beyond in (numbers[0] - 1, numbers[-1] + 1):
        assert abs(beyond * GREEN / CD.along.period - math.sin(incidence)) > 1.0
    # The pattern has its maxima there.
    at, beside = (CD.along.density(h + step, GREEN) for step in (0.0, 0.003))
    assert np.all(at > beside)


def test_the_multislit_is_one_at_the_poles_and_as_printed_between():
    """Eq. 16, written out."""
    width, spacing, count = 0.5e-6, 2.0e-6, 21
    sine = np.linspace(-0.97, 0.97, 300)
    x, y = np.pi * width * sine / GREEN, np.pi * spacing * sine / GREEN
    printed = (np.sin(x) / x) ** 2 * (np.sin(count * y) / (count * np.sin(y))) ** 2
    found = surface.multislit(sine, width, spacing, count, GREEN)
    np.testing.assert_allclose(found, printed, atol=1e-12)
    pole = surface.multislit([0.0, GREEN / spacing], width, spacing, count, GREEN)
    np.testing.assert_allclose(pole, [1.0, np.sinc(0.25) ** 2], rtol=1e-12)


LINES = [
    surface.Lines(1.6e-6, 0.5e-6, 21),
    surface.Lines(1.6e-6, 0.5e-6, 1),
    surface.Lines(1.6e-6, 0.7e-6, 8, "grooves", 0.11e-6),
    surface.Lines(1.6667e-6, 1.6667e-6, 13, "blazed", 0.25e-6),
]


@pytest.mark.parametrize("lines", LINES)
def test_the_mean_over_a_cell_is_the_integral_of_the_density(lines):
    edges = np.linspace(-2.0, 2.0, 38)
    fine = np.linspace(-2.0, 2.0, 37 * 20000 + 1)
    density = lines.density(fine, GREEN)
    whole = np.diff(np.concatenate([[0], np.cumsum(0.5 * (density[1:] + density[:-1]))])[::20000])
    found = lines.mean(edges[:-1], edges[1:], GREEN)
    np.testing.assert_allclose(found, whole / 20000, atol=1e-6 * found.max())


def test_cells_far_below_an_order_keep_their_digits():
    lines = LINES[0]
    low, high = cells(2047)
    middle = slice(1000, 1047)
    found = lines.mean(low[middle], high[middle], GREEN)
    np.testing.assert_allclose(found, lines.density(0.0, GREEN), rtol=1e-6)


@pytest.mark.parametrize("lines", LINES)
def test_orders_hold_the_energy_of_a_period(lines):
    """Parseval over all orders: the share of the slits, or all of what a phase only shifts."""
    share = lines.width / lines.period if lines.profile == "slits" else 1.0
    orders = np.arange(-20000, 20001)
    assert lines.efficiency(orders, GREEN).sum() == pytest.approx(share, rel=1e-3)


def test_grooves_half_a_wave_deep_and_half_as_wide_have_no_zero_order():
    lines = surface.Lines(2e-6, 1e-6, 9, "grooves", GREEN / 4)
    assert lines.efficiency(0, GREEN) == pytest.approx(0.0, abs=1e-20)
    assert lines.efficiency([1, -1], GREEN) == pytest.approx([4 / np.pi**2] * 2)


@pytest.mark.parametrize(
    ("nanometres", "degrees"), [(300, 5.16), (500, 8.63), (750, 13.00), (1000, 17.46), (1600, 28.69)]
)
def test_blaze_angles_of_600_lines(nanometres, degrees):
    period = 1e-3 / 600
    angle = surface.littrow_angle(period, nanometres * 1e-9)
    assert math.degrees(angle) == pytest.approx(degrees, abs=0.006)
    # In Littrow mounting all light of the blaze wavelength is in order 1.
    lines = surface.blazed_grating(600, nanometres * 1e-9).along
    assert lines.efficiency(1, nanometres * 1e-9, 2 * math.cos(angle)) == pytest.approx(1.0)


def test_a_blazed_grating_is_brighter_on_one_side():
    table = surface.table_from_grating("blazed-600", size=129, wavelengths=81, zero_order="remove")
    left, right = table.values[:, :64, 1].sum(), table.values[:, 65:, 1].sum()
    assert right > 5 * left


def test_a_table_holds_the_share_of_the_slits():
    """4π² ∫ S dh: all orders of a net with wide pitch lie within the table, but for the slits' own tails."""
    net = surface.crossed_grating(*[surface.Lines(25e-6, 15e-6, 5)] * 2)
    table = surface.table_from_grating(net, size=201, warp=3, wavelengths=31)
    np.testing.assert_allclose(4 * np.pi**2 * energy(table), 0.36 * np.array(table.white), rtol=0.01)


@pytest.mark.parametrize("source", ["cd", surface.crossed_grating(*[surface.Lines(25e-6, 15e-6, 3)] * 2)])
def test_what_is_left_out_as_specular_is_said(source):
    kept = surface.table_from_grating(source, size=101, warp=1, wavelengths=21)
    cut = surface.table_from_grating(source, size=101, warp=1, wavelengths=21, zero_order="specular")
    lost = 4 * np.pi**2 * (energy(kept) - energy(cut))
    np.testing.assert_allclose(lost, cut.metadata["zero_order_energy"], rtol=1e-5)
    np.testing.assert_allclose(lost / lost[1], kept.white, rtol=0.01)


def test_the_width_of_what_is_left_out_is_the_orders_own():
    """Where a Gaussian of that width has half its height, the order of one wavelength has half of its own."""
    lines = surface.Lines(25e-6, 15e-6, 9)
    net = surface.crossed_grating(lines, lines)
    line = light.line(555e-9)
    cut = surface.table_from_grating(net, line, size=101, warp=1, zero_order="specular")
    half = cut.metadata["zero_order_width"] * np.sqrt(2 * np.log(2))
    heights = lines.density([0.0, half, -half], 555e-9)
    np.testing.assert_allclose(heights[1:], 0.5 * heights[0], rtol=0.01)


def test_a_table_is_that_of_the_formula():
    one = surface.table_from_grating("cd", size=(65, 63), wavelengths=81)
    other = surface.table_from_function(surface.grating("cd"), size=(65, 63), wavelengths=81)
    np.testing.assert_allclose(one.values, other.values, atol=1e-6 * one.values.max())


def test_rings_hold_the_energy_of_their_lines_beyond_the_spread():
    """Around h = 0 a mixture of directions is a cloud; each ring holds both orders of its radius."""
    rings = surface.radial_grating(surface.Lines(1.6e-6, 0.5e-6, 21))
    edges = np.linspace(-0.52, 0.52, 401)
    cut = np.stack([edges[:-1], edges[1:]])
    values = rings.cell_mean(cut, cut, GREEN, zero_order=False)
    both = 2 * 0.52 * rings.along.mean([-0.52], [0.52], GREEN, zero_order=False)
    radius = np.hypot(cut.mean(axis=0)[:, None], cut.mean(axis=0))
    inside = values[radius < 0.52].sum() * (edges[1] - edges[0]) ** 2 * 4 * np.pi**2
    assert inside == pytest.approx(float(both[0]), rel=0.02)


def test_a_height_field_of_facets_is_the_blazed_grating():
    lines = surface.blazed_grating(600, 500e-9).along
    count = 256
    rise = (np.arange(count) + 0.5) / count * lines.depth
    powers = order_powers(surface.height_field(np.tile(rise, (3, 1)), lines.period / count), GREEN)
    np.testing.assert_allclose(powers[0, :4], lines.efficiency(np.arange(4), GREEN), atol=1e-3)


RINGS = surface.radial_grating(surface.Lines(1.6e-6, 0.5e-6, 21))


def test_a_mixture_of_directions_is_the_mean_over_them():
    """Within the zero order to a thousandth of its peak; the light of each ring to 1 %."""
    radius = np.linspace(1e-3, 0.45, 450)
    angles = np.pi * (np.arange(3000) + 0.5) / 3000
    t, b = radius[:, None] * np.cos(angles), radius[:, None] * np.sin(angles)
    spread = np.exp(-0.5 * (b / 0.02) ** 2) / (math.sqrt(2 * math.pi) * 0.02)
    mixed = (RINGS.along.density(t, GREEN) * spread).mean(axis=1) / (4 * np.pi**2)
    found = RINGS.pattern(radius, 0.0, GREEN)
    np.testing.assert_allclose(found[:160], mixed[:160], atol=1e-3 * mixed.max())
    for part in (radius < 0.17, radius > 0.17):
        assert (found * radius)[part].sum() == pytest.approx((mixed * radius)[part].sum(), rel=0.01)


@pytest.mark.parametrize("zero_order", ["keep", "remove"])
def test_rings_hold_the_light_of_their_lines(zero_order):
    """All of it, the zero order too, which is a cloud about h = 0."""
    lines = surface.multislit_grating(1.6e-6, 0.5e-6)
    found, wanted = (
        energy(surface.table_from_grating(one, size=301, wavelengths=21, zero_order=zero_order))
        for one in (RINGS, lines)
    )
    np.testing.assert_allclose(found, wanted, rtol=0.015)


def test_a_table_of_rings_is_that_of_the_formula():
    one = surface.table_from_grating(RINGS, size=(65, 63), wavelengths=9)
    other = surface.table_from_function(RINGS, size=(65, 63), wavelengths=9)
    np.testing.assert_allclose(one.values, other.values, atol=2e-3 * one.values.max())
