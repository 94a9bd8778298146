"""Colour against the figures that its standards print."""

import numpy as np
import pytest

from aureole import light

AS_PRINTED_4 = 5.1e-5  # half a unit of the fourth decimal, and rounding
AS_PRINTED_7 = 6e-8
AS_PRINTED_10 = 6e-11


def xy(spectrum):
    return light.chromaticity(light.white(spectrum))


def test_sums_of_the_observer():
    """CIE 018:2019: the sums over the 1 nm table."""
    _, functions = light.observer()
    np.testing.assert_allclose(functions.sum(axis=0), [106.865469, 106.856917, 106.892251], atol=5e-7)
    assert functions[555 - 360].tolist() == [0.5120501, 1.0, 0.005749999]
    assert functions[0].tolist() == [0.0001299, 0.000003917, 0.0006061]


def test_equal_energy_is_one_third():
    """CIE 15:2018: the table's own E lies within 5e-5 of (1/3, 1/3), and its Y is 106.857 nm."""
    np.testing.assert_allclose(xy(light.illuminant("E")), [1 / 3, 1 / 3], atol=5e-5)
    assert light.tristimulus(light.illuminant("E"))[1] == pytest.approx(106.857e-9, abs=5e-13)


def test_our_integral_is_the_sum_over_the_table():
    wavelengths, functions = light.observer()
    for name in light.ILLUMINANTS:
        made = light.illuminant(name)
        power = np.interp(wavelengths, made.wavelengths, made.values, left=0.0, right=0.0)
        total = power @ functions
        np.testing.assert_allclose(light.white(made), total / total[1], rtol=2e-5)


@pytest.mark.parametrize(
    ("name", "printed"),
    [("A", (0.44758, 0.40745)), ("D65", (0.31272, 0.32903))],
)
def test_illuminants_have_their_printed_chromaticity(name, printed):
    """CIE 15:2018, Table 11.1; the CIE interpolates the tables differently in the fifth decimal."""
    np.testing.assert_allclose(xy(light.illuminant(name)), printed, atol=1.2e-5)


def test_f1_has_its_printed_chromaticity():
    """CIE 15:2018, Table 11.1 sums at 5 nm; at 1 nm the mercury lines shift y by 2e-4."""
    lamp = light.illuminant("F1")
    wavelengths, functions = light.observer()
    coarse = np.interp(wavelengths[::5], lamp.wavelengths, lamp.values, left=0.0, right=0.0) @ functions[::5]
    np.testing.assert_allclose(light.chromaticity(coarse), (0.3131, 0.3371), atol=AS_PRINTED_4)
    np.testing.assert_allclose(xy(lamp), (0.3131, 0.3371), atol=2e-4)


DIODES = ((0.4560, 0.4078), (0.4357, 0.4012), (0.3756, 0.3723), (0.3422, 0.3502), (0.3118, 0.3236))


@pytest.mark.parametrize("number", range(1, 6))
def test_diodes_have_their_printed_chromaticity(number):
    """CIE 15:2018, Table 12.2 sums at 5 nm, too."""
    lamp = light.illuminant(f"LED-B{number}")
    wavelengths, functions = light.observer()
    coarse = np.interp(wavelengths[::5], lamp.wavelengths, lamp.values, left=0.0, right=0.0) @ functions[::5]
    np.testing.assert_allclose(light.chromaticity(coarse), DIODES[number - 1], atol=AS_PRINTED_4)
    np.testing.assert_allclose(xy(lamp), DIODES[number - 1], atol=3e-4)


def test_tables_hold_their_printed_values():
    """ISO/CIE 11664-2, Table 1 and CIE 15:2018, Table 10.1, at a few wavelengths."""
    for name, printed in {
        "A": {400: 14.708, 500: 59.8611, 600: 129.043, 700: 198.261},
        "D65": {400: 82.7549, 500: 109.354, 600: 90.0062, 700: 71.6091, 830: 60.3125},
        "F1": {400: 5.17, 405: 19.49, 410: 6.13, 435: 43.67, 440: 16.94},
    }.items():
        made = light.illuminant(name)
        for nanometres, value in printed.items():
            found = np.interp(nanometres / 1e9, made.wavelengths, made.values)
            assert found == pytest.approx(value, rel=4e-6), (name, nanometres)


def test_illuminant_a_is_a_black_body():
    """Its formula has c2 = 1.435e-2 at 2848 K; with today's c2 that is 2855.5 K."""
    a, body = light.illuminant("A"), light.black_body(2848.0 * 1.438776877e-2 / 1.435e-2)
    ratio = np.interp(a.wavelengths, body.wavelengths, body.values) / a.values
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-8)
    np.testing.assert_allclose(xy(light.black_body(2856)), xy(a), atol=5e-5)


def krystek(kelvin):
    """Krystek 1985: u, v of black bodies by rational functions, within 1.1e-4 up to 15000 K."""
    u = (0.860117757 + 1.54118254e-4 * kelvin + 1.28641212e-7 * kelvin**2) / (
        1 + 8.42420235e-4 * kelvin + 7.08145163e-7 * kelvin**2
    )
    v = (0.317398726 + 4.22806245e-5 * kelvin + 4.20481691e-8 * kelvin**2) / (
        1 - 2.89741816e-5 * kelvin + 1.61456053e-7 * kelvin**2
    )
    return u, v


@pytest.mark.parametrize("kelvin", [1000, 1500, 2000, 2856, 4000, 5000, 6500, 8000, 10000, 15000])
def test_black_bodies_follow_krystek(kelvin):
    X, Y, Z = light.white(light.black_body(kelvin))
    found = np.array([4 * X, 6 * Y]) / (X + 15 * Y + 3 * Z)
    np.testing.assert_allclose(found, krystek(kelvin), atol=1.1e-4)


@pytest.mark.parametrize(
    ("kelvin", "printed"),
    [
        (1000, (0.6528, 0.3445)),
        (2000, (0.5267, 0.4133)),
        (3000, (0.4369, 0.4041)),
        (5000, (0.3451, 0.3516)),
        (6500, (0.3135, 0.3236)),
        (10000, (0.2806, 0.2883)),
        (1e9, (0.2399, 0.2340)),
    ],
)
def test_black_bodies_have_their_tabulated_chromaticity(kelvin, printed):
    """The Planckian locus with c2 = 1.4388e-2 m K; the last is the limit of infinite temperature."""
    np.testing.assert_allclose(xy(light.black_body(kelvin)), printed, atol=1.01e-4)


@pytest.mark.parametrize(
    ("space", "printed", "tolerance"),
    [
        # IEC 61966-2-1:1999, 5.2; its primaries and white are those of BT.709.
        (
            "rec709",
            [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]],
            AS_PRINTED_4,
        ),
        # ITU-R BT.2020-2, Table 4, the luminance row; SMPTE RP 177 gives the others.
        (
            "rec2020",
            [[0.6370, 0.1446, 0.1689], [0.2627, 0.6780, 0.0593], [0.0000, 0.0281, 1.0610]],
            AS_PRINTED_4,
        ),
        # The Academy's CTL library, AP1_2_XYZ_MAT of S-2014-004.
        (
            "acescg",
            [
                [0.6624541811, 0.1340042065, 0.1561876870],
                [0.2722287168, 0.6740817658, 0.0536895174],
                [-0.0055746495, 0.0040607335, 1.0103391003],
            ],
            AS_PRINTED_10,
        ),
        # SMPTE ST 2065-1:2012, 4.4 (AP0 to XYZ).
        (
            "aces2065-1",
            [
                [0.9525523959, 0.0, 0.0000936786],
                [0.3439664498, 0.7281660966, -0.0721325464],
                [0.0, 0.0, 1.0088251844],
            ],
            AS_PRINTED_10,
        ),
        ("xyz", np.eye(3), 1e-15),
    ],
)
def test_matrices_are_the_standards(space, printed, tolerance):
    np.testing.assert_allclose(light.SPACES[space].to_xyz, printed, atol=tolerance)


@pytest.mark.parametrize(
    ("source", "target", "printed", "tolerance"),
    [
        # ITU-R BT.2087-0, Annex 1.
        (
            "rec709",
            "rec2020",
            [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]],
            AS_PRINTED_4,
        ),
        # ACES S-2014-004, A.2 (AP0 to AP1).
        (
            "aces2065-1",
            "acescg",
            [
                [1.4514393161, -0.2365107469, -0.2149285693],
                [-0.0765537734, 1.1762296998, -0.0996759264],
                [0.0083161484, -0.0060324498, 0.9977163014],
            ],
            AS_PRINTED_10,
        ),
        # OpenColorIO's ACES configurations: linear Rec.709 to ACEScg with Bradford.
        (
            "rec709",
            "acescg",
            [[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0135], [0.0206, 0.1096, 0.8698]],
            1e-4,
        ),
    ],
)
def test_matrices_between_spaces_are_the_standards(source, target, printed, tolerance):
    np.testing.assert_allclose(light.matrix(source, target), printed, atol=tolerance)


def test_bradford_from_d65_to_d50():
    """B. Lindbloom, Chromatic Adaptation, with the whites of ASTM E308."""
    printed = [
        [1.0478112, 0.0228866, -0.0501270],
        [0.0295424, 0.9904844, -0.0170491],
        [-0.0092345, 0.0150436, 0.7521316],
    ]
    found = light.adaptation((0.95047, 1.0, 1.08883), (0.96422, 1.0, 0.82521))
    np.testing.assert_allclose(found, printed, atol=AS_PRINTED_7)


def test_adaptation_goes_back_the_way_it_came():
    d65, a = (light.white(light.illuminant(name)) for name in ("D65", "A"))
    np.testing.assert_allclose(light.adaptation(d65, a) @ light.adaptation(a, d65), np.eye(3), atol=1e-14)
    np.testing.assert_allclose(light.adaptation(a, a), np.eye(3), atol=1e-14)
