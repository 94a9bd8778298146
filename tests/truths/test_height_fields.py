"""Height fields: sinusoids are Bessel functions, light is kept, series converge or are told."""

import numpy as np
import pytest
from scipy.special import jv

from aureole import light, surface
from aureole.surface.height import order_powers, order_powers_at, spread_orders
from aureole.surface.table import cells, energy

BLUE = 450e-9


def waves(depth, rows=24, columns=32, pixel=0.15e-6):
    """A field of two crossed waves; `depth` is from the lowest to the highest, metres."""
    y, x = np.mgrid[:rows, :columns]
    field = np.sin(2 * np.pi * 4 * x / columns) + 0.6 * np.sin(2 * np.pi * (3 * y / rows + x / columns))
    return surface.height_field(depth * (field - field.min()) / np.ptp(field), pixel)


@pytest.mark.parametrize("depth", [0.02e-6, 0.1e-6, 0.3e-6])
def test_the_orders_of_a_sinusoid_are_bessel_functions(depth):
    """exp(i a sin x) = Σ J_m(a) exp(i m x), a = k w depth / 2."""
    x = np.arange(64) / 64
    field = surface.height_field(np.tile(0.5 * depth * np.sin(2 * np.pi * x), (2, 1)), 0.1e-6)
    found = order_powers(field, BLUE, cosines=1.7)[0, :8]
    np.testing.assert_allclose(found, jv(np.arange(8), np.pi / BLUE * 1.7 * depth) ** 2, atol=1e-12)


def test_an_exact_table_holds_all_light():
    table = surface.table_from_height(waves(0.2e-6), size=129, warp=3, wavelengths=9)
    np.testing.assert_allclose(4 * np.pi**2 * energy(table), table.white, rtol=0.01)
    assert "notes" not in table.metadata


def test_shallow_heights_are_as_born_says():
    """Beyond the zero order the first order is right to the square of the phase."""
    field = waves(1e-9)
    exact, born = (order_powers(field, BLUE, method) for method in ("exact", "born"))
    exact[0, 0] = born[0, 0] = 0.0
    assert np.abs(born - exact).sum() < 1e-3 * exact.sum()


def test_a_taylor_series_of_order_one_is_born():
    field = waves(0.1e-6)
    one, other = order_powers(field, BLUE, "taylor", 1), order_powers(field, BLUE, "born")
    np.testing.assert_allclose(one, other, atol=1e-15)


def test_higher_fields_need_higher_orders():
    needed = [surface.taylor_order(waves(depth * 1e-6), BLUE) for depth in (0.02, 0.05, 0.1, 0.2, 0.4347)]
    assert needed == sorted(needed)
    assert needed[0] <= 2
    assert needed[-1] >= 12
    field = waves(0.1e-6)
    assert (
        surface.taylor_error(field, BLUE, needed[2])
        <= 0.01
        < surface.taylor_error(field, BLUE, needed[2] - 1)
    )


def test_a_series_that_is_too_short_is_told():
    table = surface.table_from_height(waves(0.2e-6), size=17, wavelengths=5, method="born")
    (note,) = table.metadata["notes"]
    assert note.startswith("Order 1 puts ")
    assert "below 1%" in note
    long = surface.table_from_height(waves(0.2e-6), size=17, wavelengths=5, method="taylor", order=20)
    assert "notes" not in long.metadata


@pytest.mark.parametrize("cosines", [2.0, 1.3, 0.4])
def test_tables_of_powers_add_up_to_the_series(cosines):
    field = waves(0.1e-6)
    tables = surface.taylor_tables(field, order=3, size=33, wavelengths=5)
    assert len(tables.values) == 7
    direct = surface.table_from_height(
        field, size=33, wavelengths=5, method="taylor", order=3, cosines=cosines
    )
    np.testing.assert_allclose(tables.at(cosines), direct.values, atol=1e-6 * direct.values.max())


def test_orders_stand_where_the_grating_equation_has_them_and_up_is_up():
    """A wave that rises along +t and along +b (upward) sends its order 1 to h = λ / d there."""
    rows, columns, pixel = 40, 40, 0.1e-6
    y, x = np.mgrid[:rows, :columns]
    facets = np.mod(x - y, columns) / columns * 0.5 * BLUE
    pattern = surface.height_pattern(surface.height_field(facets, pixel), wavelength=BLUE, size=401)
    row, column = np.unravel_index(np.argmax(pattern.values), pattern.values.shape)
    h_t, h_b = -2 + column * 0.01, 2 - row * 0.01
    assert (h_t, h_b) == pytest.approx((BLUE / 4e-6, BLUE / 4e-6), abs=0.006)


@pytest.mark.parametrize(
    ("method", "order", "size"), [("exact", 1, (40, 33)), ("born", 1, 32), ("taylor", 4, 33)]
)
def test_tables_are_the_sum_of_each_wavelengths_pattern(method, order, size):
    """Lists of what reaches what and orders mixed from a few, against whole matrices for each wavelength."""
    field = waves(0.2e-6)
    table = surface.table_from_height(field, size=size, wavelengths=31, method=method, order=order)
    rows, columns = table.values.shape[:2]
    t, b = cells(columns), cells(rows)[:, ::-1]
    whole = np.zeros(table.values.shape)
    for wavelength, weight in zip(*light.quadrature(light.illuminant("E"), 31), strict=True):
        powers = order_powers(field, float(wavelength), method, order)
        whole += spread_orders(powers, field.pixel, float(wavelength), t, b)[..., None] * weight
    np.testing.assert_allclose(table.values, whole, atol=1e-6 * whole.max())


@pytest.mark.parametrize("depth", [0.0, 0.1e-6, 3e-6])
def test_orders_at_a_few_wavelengths_tell_those_at_all(depth):
    field = waves(depth) if depth else surface.height_field(np.zeros((6, 8)), 0.1e-6)
    wavelengths = np.linspace(380e-9, 780e-9, 101)
    powers, mixture = order_powers_at(field, wavelengths)
    assert len(powers) < 101
    for k in (0, 13, 50, 100):
        mixed = np.tensordot(mixture[k], powers, axes=1)
        np.testing.assert_allclose(mixed, order_powers(field, wavelengths[k]), atol=1e-9)


def test_wavelengths_of_a_table_are_close_enough():
    field = waves(0.2e-6)
    chosen, many = (
        surface.table_from_height(field, size=257, wavelengths=count).values for count in (None, 700)
    )
    bright = many > 1e-3 * many.max()
    # Isolated dim cells between two orders are less exact.
    assert np.quantile(np.abs(chosen[bright] / many[bright] - 1.0), 0.9) < 0.005


def test_a_shader_reads_tables_of_powers_as_their_sum():
    tables = surface.taylor_tables(waves(0.1e-6), order=2, size=33, wavelengths=5)
    h_t, h_b = np.meshgrid([-0.9, 0.0, 0.31], [0.2, 1.1])
    for cosines in (2.0, 1.1):
        found = tables.lookup(h_t, h_b, cosines)
        np.testing.assert_allclose(found, surface.lookup(tables.table_at(cosines), h_t, h_b), rtol=1e-5)
    mixed = tables.lookup(h_t, h_b, np.full(h_t.shape, 1.1))
    np.testing.assert_array_equal(mixed, found)
    assert not tables.lookup(2.1, 0.0, 1.0).any()


def test_the_panels_of_figure_13_come_nearer_to_the_exact_one():
    """Orders 1, 2 and 5 of a field that order 5 is enough for."""
    *series, exact = surface.series_tables(waves(0.07e-6), size=33)
    errors = [float(np.abs(one.values - exact.values).sum()) for one in series]
    assert errors == sorted(errors, reverse=True)
    assert errors[2] < 0.05 * errors[0]
    assert [one.metadata["order"] for one in series] == [1, 2, 5]
    assert ["notes" in one.metadata for one in series] == [True, True, False]
    # What the table says it errs by is what the orders do.
    for one in series:
        shortest = float(light.quadrature(light.illuminant("E"), one.metadata["wavelengths"])[0].min())
        error = surface.taylor_error(waves(0.07e-6), shortest, one.metadata["order"])
        assert one.metadata["series_error"] == error
