"""Tables of the gratings that come with the program: orders in place, light kept, the zero order told."""

import math

import numpy as np
import pytest

from aureole import light, presets, refuse, surface
from aureole.surface.table import areas, axes, energy

NAMES = ("cd", "cd-toisoul-2017", "dvd", "bluray", "lcd-342ppi", "lcd-534ppi", "blazed-600")


def seen(name, nanometres, incidence, order, size=1601):
    """Return the angle at which a table is brightest near an order, read as a renderer reads it, degrees."""
    table = line_table(name, nanometres, size)
    step = nanometres * 1e-9 / surface.grating(name).along.period
    sine = math.sin(math.radians(incidence))
    angles = np.radians(np.linspace(-90.0, 90.0, 36001))
    near = np.abs(sine + np.sin(angles) - order * step) < 0.1 * step
    values = surface.lookup(table, sine + np.sin(angles[near]), 0.0)[:, 1].astype(np.float64)
    # The middle of the order in h, where it is even to both sides.
    h = np.sin(angles[near])
    return math.degrees(math.asin(np.average(h, weights=values * np.cos(angles[near]))))


def line_table(name, nanometres, size):
    return surface.table_from_grating(name, light.line(nanometres * 1e-9), (5, size), warp=1)


@pytest.mark.parametrize(("nanometres", "degrees"), [(380, 13.74), (532, 19.42), (650, 23.97), (780, 29.18)])
def test_a_cds_first_orders_stand_where_they_should(nanometres, degrees):
    """asin(λ / 1.6 µm), to 0.05 degrees, on both sides."""
    assert seen("cd", nanometres, 0.0, 1) == pytest.approx(degrees, abs=0.05)
    assert seen("cd", nanometres, 0.0, -1) == pytest.approx(-degrees, abs=0.05)


@pytest.mark.parametrize("order", [-1, 1, 2, 4])
def test_orders_at_30_degrees_stand_at_whole_steps_of_h(order):
    """d (sin θ_i + sin θ_o) = m λ: h · t = m λ / d."""
    angle = seen("cd", 532, 30.0, order)
    h = math.sin(math.radians(30.0)) + math.sin(math.radians(angle))
    assert h == pytest.approx(order * 532e-9 / 1.6e-6, abs=4e-4)


def test_a_blu_ray_sends_no_order_back_at_normal_incidence_and_a_cd_does():
    """Beyond the mirror's own lobe there is next to nothing on the half of h that directions reach."""
    for nanometres in (380, 550, 780):
        shares = {}
        for name in ("cd", "bluray"):
            table = line_table(name, nanometres, 801)
            (along_b, along_t), h_t = areas(table), np.abs(axes(table)[1])
            mass = along_b @ table.values[..., 1].astype(np.float64) * along_t
            half = 0.5 * nanometres * 1e-9 / surface.grating(name).along.period
            shares[name] = mass[(h_t > half) & (h_t < 1.0)].sum() / mass.sum()
        assert shares["bluray"] < 0.02
        assert shares["cd"] > 0.3


@pytest.mark.parametrize(("name", "spacing"), [("lcd-342ppi", 0.00713), ("lcd-534ppi", 0.01114)])
def test_orders_of_displays_are_apart_by_the_pixel(name, spacing):
    """530 nm over 25.4 mm / 342 and 534; sub-pixels make them three times as far apart along the rows."""
    display = surface.grating(name)
    assert 530e-9 / display.across.period == pytest.approx(spacing, abs=1e-5)
    assert display.along.period == pytest.approx(display.across.period / 3)
    table = surface.table_from_grating(name, light.line(530e-9), (1601, 1601), half_range=0.05, warp=1)
    middle, step = 800, 0.05 / 800
    for line, distance in (
        (table.values[middle::-1, middle, 1], spacing),
        (table.values[middle, middle:, 1], 3 * spacing),
    ):
        near = np.arange(int(0.8 * distance / step), int(1.2 * distance / step))
        # Without the pattern of a single opening, which falls across an order and pulls its top inward.
        lines = line[near] / np.sinc(0.7 * near * step / distance) ** 2
        assert near[np.argmax(lines)] * step == pytest.approx(distance, abs=step)


@pytest.mark.parametrize("name", NAMES)
def test_no_preset_sends_back_more_light_than_came(name):
    """At every incidence along and across its lines; with its zero order the share of what reflects."""
    table = surface.table_from_grating(name, size=(151, 301), wavelengths=121)
    sines = np.sin(np.radians([0.0, 20.0, 45.0, 70.0, 90.0]))
    directions = np.concatenate([np.stack([sines, 0 * sines], 1), np.stack([0 * sines, sines], 1)])
    found = surface.albedo(table, directions)
    assert found.max() <= 1.0
    assert surface.albedo_bound(table) <= 1.0
    assert found[0, 1] > 0.05
    preset = surface.grating(name)
    open_share = math.prod(
        part.width / part.period
        for part in (preset.along, preset.across)
        if part is not None and part.profile == "slits"
    )
    assert 4 * np.pi**2 * energy(table)[1] <= open_share * 1.005


def test_every_preset_is_tried():
    assert sorted(NAMES) == sorted(presets.names("gratings"))


@pytest.mark.parametrize("zero_order", ["remove", "specular"])
def test_what_is_taken_from_a_height_fields_middle_is_its_mirrors_share(zero_order):
    rng = np.random.default_rng(4)
    field = surface.height_field(0.1e-6 * rng.random((16, 20)), 0.2e-6)
    kept = surface.table_from_height(field, size=101, warp=3, wavelengths=15)
    cut = surface.table_from_height(field, size=101, warp=3, wavelengths=15, zero_order=zero_order)
    lost = 4 * np.pi**2 * (energy(kept) - energy(cut))
    assert lost[1] > 0.1
    if zero_order == "specular":
        np.testing.assert_allclose(lost, cut.metadata["zero_order_energy"], rtol=1e-4)
    # The middle is dark, the rest is as it was.
    assert cut.values[50, 50].max() < 1e-3 * kept.values[50, 50].max()
    far = (slice(0, 20), slice(None))
    np.testing.assert_allclose(cut.values[far], kept.values[far], atol=1e-9 * kept.values.max())


@pytest.mark.parametrize(
    "ask",
    [
        lambda: surface.table_from_grating("cd", size=10**6),
        lambda: surface.table_from_height(np.zeros((4, 4)), 1e-7, size=10**6),
        lambda: surface.taylor_tables(np.zeros((4, 4)), 1e-7, order=60, size=50000),
        lambda: surface.height_pattern(np.zeros((4, 4)), 1e-7, size=10**6),
    ],
)
def test_tables_that_would_not_fit_are_refused_before_work_starts(ask):
    with pytest.raises(refuse.Refusal, match=r"'size' of .* needs .* GB of memory"):
        ask()
