"""Glass: the catalogue's own n_d and V_d, Cauchy through any pair, refusals."""

import re

import numpy as np
import pytest

from aureole import presets, refuse
from aureole.flare import coating, glass

NAMES = sorted(glass.catalogue())


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_there_are_enough_glasses():
    assert len(NAMES) >= 100
    assert sum(len(presets.load("glasses", maker).glasses) for maker in presets.names("glasses")) == len(
        NAMES
    )


@pytest.mark.parametrize("name", NAMES)
def test_sellmeiers_constants_give_the_printed_index_and_abbe_number(name):
    line = glass.named(name)
    assert len(line.b) == len(line.c) == 3
    assert float(glass.index(line, glass.D_LINE)) == pytest.approx(line.index, abs=1e-5)
    assert glass.abbe_number(line) == pytest.approx(line.abbe, abs=0.05)


@pytest.mark.parametrize(
    ("name", "code"),
    # International six-figure codes as the makers print them: n_d - 1 and V_d.
    [
        ("N-BK7", "517642"),
        ("N-SK16", "620603"),
        ("F2", "620364"),
        ("SF6", "805254"),
        ("N-LASF9", "850322"),
        ("N-SF11", "785257"),
        ("N-BAK4", "569560"),
        ("N-FK51A", "487845"),
        ("S-BSL7", "516641"),
        ("S-TIH53", "847238"),
        ("S-LAL14", "697555"),
    ],
)
def test_six_figure_codes(name, code):
    line = glass.named(name)
    n_d = float(glass.index(line, glass.D_LINE))
    assert f"{1000 * (n_d - 1):.0f}{10 * glass.abbe_number(line):.0f}" == code


@pytest.mark.parametrize(
    ("name", "wavelength", "printed"),
    # Schott's data sheets, n_e and n_g.
    [("N-BK7", 546.0740e-9, 1.51872), ("N-BK7", 435.8343e-9, 1.52668), ("N-SF11", 546.0740e-9, 1.79192)],
)
def test_other_lines_of_the_data_sheets(name, wavelength, printed):
    assert float(glass.index(glass.named(name), wavelength)) == pytest.approx(printed, abs=1e-5)


@pytest.mark.parametrize(("n_d", "v_d"), [(1.5168, 64.17), (1.84666, 23.8), (1.43875, 94.9)])
def test_cauchy_goes_through_index_and_abbe_number(n_d, v_d):
    made = glass.of_numbers(n_d, v_d)
    assert float(glass.index(made, glass.D_LINE)) == pytest.approx(n_d, abs=1e-15)
    assert glass.abbe_number(made) == pytest.approx(v_d, rel=1e-12)


def test_cauchy_is_near_sellmeier():
    """Two terms leave a few units of the fourth place at the ends of the visible spectrum."""
    waves = np.linspace(420e-9, 680e-9, 27)
    exact = glass.named("N-BK7")
    near = glass.index(glass.of_numbers(exact.index, exact.abbe), waves)
    assert np.abs(near - glass.index(exact, waves)).max() < 5e-4


def test_air_and_glass_without_abbe_number_do_not_disperse():
    waves = np.linspace(380e-9, 780e-9, 5)
    assert glass.of_numbers(1.0) is glass.AIR
    assert glass.named("air") is glass.AIR
    np.testing.assert_array_equal(glass.index(glass.AIR, waves), 1.0)
    np.testing.assert_array_equal(glass.index(glass.of_numbers(1.7), waves), 1.7)
    assert glass.abbe_number(glass.of_numbers(1.7)) == float("inf")


def test_names_are_found_in_any_case():
    assert glass.named("n-bk7") is glass.named("N-BK7")
    with refused("the catalogue of glasses has no 'N-BK77'. Did you mean 'N-BK7'?"):
        glass.named("n-bk77")


def test_refusals():
    with refused("'index' must be a number from 1 to 5, got 0.9."):
        glass.of_numbers(0.9)
    with refused("'abbe' must be a finite number > 0, got -3."):
        glass.of_numbers(1.5, -3)
    with refused("'wavelengths' must be > 0 (metres), got 0."):
        glass.index(glass.AIR, [550e-9, 0.0])
    with refused("'wavelengths' must hold finite numbers, got 1 that are NaN or infinite."):
        glass.index(glass.AIR, np.nan)
    with refused("the glass 'N-BK7' is not transparent at each of 'wavelengths'."):
        glass.index(glass.named("N-BK7"), 10.1e-6)
    with refused("'cosines' must be numbers from 0 to 1, got 1.5."):
        coating.reflectance((), glass.AIR, glass.named("F2"), 1.5, 550e-9)
    with refused("'wavelength' must be a finite number > 0, got 0."):
        coating.quarter_wave(1.38, 0.0)
    with refused("'polarisation' must be one of 'mean', 's', 'p', got 'x'."):
        coating.reflectance((), glass.AIR, glass.named("F2"), 1.0, 550e-9, "x")
