"""Units: text in, metres and radians out; reports with readable numbers; refusals."""

import math
import re

import pytest

from aureole import refuse, units


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("1m", 1.0),
        ("2.5cm", 0.025),
        ("50mm", 0.05),
        ("50 mm", 0.05),
        ("  50mm ", 0.05),
        ("2um", 2e-6),
        ("2µm", 2e-6),  # the micro sign, U+00B5
        ("2μm", 2e-6),  # the Greek letter, U+03BC
        ("550nm", 550e-9),
        (".5mm", 5e-4),
        ("5.mm", 5e-3),
        ("+1e-3m", 1e-3),
        ("5E2nm", 500e-9),
        ("-3mm", -3e-3),
        ("0mm", 0.0),
    ],
)
def test_lengths(text, metres):
    assert units.length(text, "size", "50mm") == pytest.approx(metres, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("50", "'size' needs a unit (m, cm, mm, um or nm), got 50; write 3mm."),
        ("50 parsec", "'size' has an unknown unit 'parsec' in 50 parsec; use m, cm, mm, um or nm."),
        ("50MM", "'size' has an unknown unit 'MM' in 50MM; use m, cm, mm, um or nm."),
        ("mm", "'size' must be a length with its unit, such as 3mm, got 'mm'."),
        ("", "'size' must be a length with its unit, such as 3mm, got ''."),
        ("nan mm", "'size' must be a length with its unit, such as 3mm, got 'nan mm'."),
        ("1e999mm", "'size' must be a length with its unit, such as 3mm, got '1e999mm'."),
        ("1,5mm", "'size' must be a length with its unit, such as 3mm, got '1,5mm'."),
        ("1.2.3mm", "'size' must be a length with its unit, such as 3mm, got '1.2.3mm'."),
        ("3mm 4mm", "'size' must be a length with its unit, such as 3mm, got '3mm 4mm'."),
        ("3mm\n4", "'size' must be a length with its unit, such as 3mm, got '3mm\\n4'."),
    ],
)
def test_lengths_refused(text, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        units.length(text, "size", "3mm")


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("180", math.pi),
        ("90deg", math.pi / 2),
        ("-45 deg", -math.pi / 4),
        ("30°", math.pi / 6),
        ("0.2rad", 0.2),
        ("0", 0.0),
    ],
)
def test_angles(text, radians):
    assert units.angle(text, "rotation") == pytest.approx(radians, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ten", "'rotation' must be an angle in degrees, such as 10deg, got 'ten'."),
        ("10turns", "'rotation' has an unknown unit 'turns' in 10turns; use deg or rad."),
        ("10mm", "'rotation' has an unknown unit 'mm' in 10mm; use deg or rad."),
        ("inf", "'rotation' must be an angle in degrees, such as 10deg, got 'inf'."),
    ],
)
def test_angles_refused(text, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        units.angle(text, "rotation")


@pytest.mark.parametrize(
    ("metres", "text"),
    [
        (2.0, "2 m"),
        (1.0, "1 m"),
        (0.05, "50 mm"),
        (0.003125, "3.125 mm"),
        (1e-3, "1 mm"),
        (18.75e-6, "18.75 µm"),
        (550e-9, "550 nm"),
        (-550e-9, "-550 nm"),
        (0.0, "0 nm"),
    ],
)
def test_lengths_in_reports(metres, text):
    assert units.metres_as_text(metres) == text


@pytest.mark.parametrize("metres", [3.0, 0.05, 18.75e-6, 550e-9])
def test_what_is_printed_reads_back(metres):
    assert units.length(units.metres_as_text(metres), "size", "3mm") == pytest.approx(metres, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("10cd/m2", 10.0),
        ("10 cd/m²", 10.0),
        ("0.5cd/m^2", 0.5),
        ("3nit", 3.0),
        ("3 nits", 3.0),
        ("2kcd/m2", 2000.0),
        ("5mcd/m2", 5e-3),
        ("0cd/m2", 0.0),
    ],
)
def test_luminances(text, value):
    assert units.luminance(text, "luminance") == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("10", "'luminance' needs a unit (cd/m2 or nit), got 10; write 10cd/m2."),
        ("10lux", "'luminance' has an unknown unit 'lux' in 10lux; use cd/m2 or nit."),
        ("-1cd/m2", "'luminance' must be a luminance >= 0, got -1cd/m2."),
        ("bright", "'luminance' must be a luminance with its unit, such as 10cd/m2, got 'bright'."),
    ],
)
def test_luminances_refused(text, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        units.luminance(text, "luminance")


@pytest.mark.parametrize(("text", "value"), [("1.5", 1.5), ("1.5s", 1.5), ("500 ms", 0.5), ("-2s", -2.0)])
def test_times(text, value):
    assert units.seconds(text, "time") == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("5min", "'time' has an unknown unit 'min' in 5min; use s or ms."),
        ("soon", "'time' must be a time in seconds, such as 1.5s or 500ms, got 'soon'."),
    ],
)
def test_times_refused(text, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        units.seconds(text, "time")
