"""Spectra by number and by name, and what is refused."""

import numpy as np
import pytest

from aureole import light, refuse


def test_a_spectrum_owns_its_arrays():
    wavelengths, values = np.array([500e-9, 600e-9]), np.array([1.0, 2.0])
    made = light.spectrum(wavelengths, values, name="lamp")
    wavelengths[0] = values[0] = 7.0
    assert made.wavelengths.tolist() == [500e-9, 600e-9]
    assert made.values.tolist() == [1.0, 2.0]
    assert (made.kind, made.name) == ("power", "lamp")
    assert made.values.dtype == made.wavelengths.dtype == np.float64


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([5e-7, 6e-7], [1, 1], "lines "), "'kind' must be one of 'power', 'lines', got 'lines '"),
        (([], []), "'wavelengths' must be an array of shape (any), got (0,)."),
        (([5e-7, 6e-7], [1.0]), "'values' must be an array of shape (2), got (1,)."),
        (([5e-7, np.nan], [1, 1]), "'wavelengths' must hold finite numbers, got 1 that are NaN or infinite."),
        (([5e-7, 6e-7], [1, np.inf]), "'values' must hold finite numbers, got 1 that are NaN or infinite."),
        (([0.0, 6e-7], [1, 1]), "'wavelengths' must be > 0 (metres), got 0."),
        (([6e-7, 5e-7], [1, 1]), "'wavelengths' must rise, got 6e-07 followed by 5e-07."),
        (([5e-7, 5e-7], [1, 1]), "'wavelengths' must rise, got 5e-07 followed by 5e-07."),
        (([5e-7, 6e-7], [1, -0.5]), "'values' must not be negative, got -0.5."),
        (([5e-7, 6e-7], [0, 0]), "'values' must not all be zero: a spectrum needs some light."),
        (([5e-7], [1]), "'wavelengths' needs two samples or more for kind 'power'; use kind 'lines'."),
    ],
)
def test_wrong_samples_are_refused(arguments, message):
    with pytest.raises(refuse.Refusal) as refusal:
        light.spectrum(*arguments)
    assert str(refusal.value).startswith(message)


def test_a_line_is_one_wavelength():
    made = light.line(589.3e-9)
    assert (made.kind, made.name) == ("lines", "589.3 nm")
    assert made.wavelengths.tolist() == [589.3e-9]
    with pytest.raises(refuse.Refusal, match=r"'wavelength' must be a finite number > 0, got -1\."):
        light.line(-1)


@pytest.mark.parametrize("name", list(light.ILLUMINANTS))
def test_illuminants_are_made_once(name):
    made = light.illuminant(name)
    assert made.name == name
    assert made is light.illuminant(name)
    assert made.values.min() >= 0
    assert np.all(np.diff(made.wavelengths) > 0)


@pytest.mark.parametrize(("name", "value"), [("A", 100.0), ("D65", 100.0)])
def test_illuminants_are_100_at_560_nm(name, value):
    made = light.illuminant(name)
    assert np.interp(560e-9, made.wavelengths, made.values) == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize("text", ["blackbody:3200K", "blackbody:3200", "blackbody: 3200 k"])
def test_a_black_body_as_text(text):
    assert np.array_equal(light.illuminant(text).values, light.black_body(3200).values)


def test_a_line_as_text():
    assert light.illuminant("line:0.55um").wavelengths == pytest.approx([550e-9], rel=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "D56",
            "'illuminant' must be one of 'E', 'A', 'D65', 'F1', 'LED-B1', 'LED-B2', 'LED-B3', 'LED-B4', "
            "'LED-B5', 'blackbody:3200K', 'line:550nm', got 'D56'. Did you mean 'D65'?",
        ),
        ("blackbody", "'illuminant' must be one of 'E', 'A', 'D65', 'F1', 'LED-B1',"),
        ("blackbody:warm", "'blackbody' must be a temperature in kelvin, such as 3200K, got 'warm'."),
        ("blackbody:0K", "'kelvin' must be a finite number > 0, got 0."),
        ("line:550", "'wavelength' needs a unit (m, cm, mm, um or nm), got 550; write 550nm."),
    ],
)
def test_unknown_illuminants_are_refused(text, message):
    with pytest.raises(refuse.Refusal) as refusal:
        light.illuminant(text)
    assert str(refusal.value).startswith(message)


def test_black_bodies_follow_wien():
    """The peak of 5000 K lies at b / T = 2.897771955e-3 / 5000 m (CODATA 2018)."""
    made = light.black_body(5000)
    assert made.wavelengths[np.argmax(made.values)] == pytest.approx(579.554e-9, abs=0.5e-9)


def test_black_bodies_at_the_extremes():
    cold, hot = light.black_body(100), light.black_body(1e9)
    assert np.isfinite(light.white(cold)).all()
    assert hot.values[0] / hot.values[-1] == pytest.approx((830 / 300) ** 4, rel=1e-4)
    with pytest.raises(refuse.Refusal, match="must not all be zero"):
        light.black_body(10)
