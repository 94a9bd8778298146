"""A lamp of two diodes shows two patterns, each about its own mirror image (surface paper, Fig. 22)."""

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.records import Picture
from aureole.surface.resampling import on_warped_steps
from aureole.surface.table import axis, energy, lookup
from aureole.surface.table_cells import hat_integrals

STEP = 0.02


def lobes(size=401, width=0.1):
    h = axis(size)
    values = sum(
        weight * np.exp(-((h[:, None]) ** 2 + (h[None, :] - x) ** 2) / (2 * width**2))
        for x, weight in ((-0.7, 0.4), (0.0, 1.0), (0.7, 0.6))
    )
    return surface.scatter_table(values[..., None] * np.ones(3), (1, 1, 1))


def photograph(places, colours, black=0.01):
    pixels = np.full((41, 61, 3), black, dtype=np.float32)
    for (row, column), colour in zip(places, colours, strict=True):
        pixels[row, column] += np.asarray(colour, dtype=np.float32)
    return Picture(pixels)


def test_two_diodes_show_two_patterns_each_about_its_mirror_image():
    table = lobes()
    lamp = surface.lamp_from_reflection(photograph([(18, 20), (24, 40)], [[1, 1, 1]] * 2), STEP)
    whole = surface.convolved(table, lamp)
    h_t, h_b = np.linspace(-1.2, 1.2, 61)[None, :], np.linspace(-0.6, 0.6, 31)[:, None]
    assert lamp.middle == (21, 30)
    # The middle of the light lies at row 21, column 30; a photograph runs against h, its rows along it.
    expected = 0.5 * (
        lookup(table, h_t - 10 * STEP, h_b + 3 * STEP) + lookup(table, h_t + 10 * STEP, h_b - 3 * STEP)
    )
    found = lookup(whole, h_t, h_b)
    assert np.abs(found - expected).max() <= 0.02 * expected.max()
    unequal = lookup(table, h_t + 10 * STEP, h_b + 3 * STEP) + lookup(table, h_t - 10 * STEP, h_b - 3 * STEP)
    assert np.abs(found - 0.5 * unequal).max() > 0.2 * expected.max()


def test_a_point_lamp_changes_the_table_no_more_than_its_pixel_does():
    table = lobes()
    lamp = surface.lamp_from_reflection(photograph([(20, 30)], [[3, 3, 3]]), STEP)
    assert lamp.weights.shape == (1, 1, 3)
    whole = surface.convolved(table, lamp)
    assert energy(whole) == pytest.approx(energy(table), rel=2e-3)


def test_the_lamps_luminance_is_one_and_its_colour_is_kept_or_left_out():
    taken = photograph([(18, 20), (24, 40)], [[1, 0, 0], [0, 0, 1]])
    coloured = surface.lamp_from_reflection(taken, STEP, threshold=0.05)
    assert light.to_xyz(coloured.weights)[..., 1].sum() == pytest.approx(1, rel=1e-5)
    assert coloured.weights[..., 0].sum() == pytest.approx(coloured.weights[..., 2].sum(), rel=1e-3)
    neutral = surface.lamp_from_reflection(taken, STEP, threshold=0.05, neutral=True)
    np.testing.assert_array_equal(neutral.weights[..., 0], neutral.weights[..., 2])


def test_a_black_photograph_is_refused():
    with pytest.raises(refuse.Refusal, match="shows no lamp"):
        surface.lamp_from_reflection(photograph([], [], black=0.0), STEP)
    with pytest.raises(refuse.Refusal, match="'step' must be"):
        surface.lamp_from_reflection(photograph([(1, 1)], [[1, 1, 1]]), 0.0)


def test_a_fine_photograph_of_the_lamp_needs_no_finer_plane_than_memory_holds():
    table, fine = lobes(), STEP / 27
    pixels = np.full((81, 121, 3), 1e-3, dtype=np.float32)
    pixels[40, 20], pixels[40, 100] = 1.0, 1.0
    lamp = surface.lamp_from_reflection(Picture(pixels), fine)
    whole = surface.convolved(table, lamp)
    h_t, h_b = np.linspace(-1.2, 1.2, 61)[None, :], np.linspace(-0.3, 0.3, 11)[:, None]
    expected = 0.5 * (lookup(table, h_t - 40 * fine, h_b) + lookup(table, h_t + 40 * fine, h_b))
    assert np.abs(lookup(whole, h_t, h_b) - expected).max() <= 0.02 * expected.max()


def test_a_photograph_taken_askew_gives_the_same_lamp():
    upright = surface.lamp_from_reflection(photograph([(18, 20), (24, 40)], [[1, 1, 1]] * 2), STEP)
    # Seen by a camera that is turned, so that the tangent runs up the photograph.
    turned = Picture(np.rot90(photograph([(18, 20), (24, 40)], [[1, 1, 1]] * 2).pixels))
    found = surface.lamp_from_reflection(turned, STEP, rotation=np.pi / 2)
    rows, columns = upright.weights.shape[:2]
    a, b = (found.weights.shape[0] - rows) // 2, (found.weights.shape[1] - columns) // 2
    np.testing.assert_allclose(found.weights[a : a + rows, b : b + columns], upright.weights, atol=1e-6)


def test_no_light_falls_between_a_tables_samples():
    step, size = 0.01, 403
    plane = np.zeros((size, size, 1))
    plane[size // 2 - 90, size // 2 + 130] = 1.0
    table = on_warped_steps(plane, step, (33, 33), 2.0, 5)
    tent = hat_integrals(33, 2.0, 5)
    assert tent @ table[..., 0] @ tent == pytest.approx(step**2, rel=1e-3)


def test_a_lamp_of_two_diodes_is_drawn_from_a_photograph_of_its_mirror_image():
    """Fig. 22 from end to end: photograph of the mirror image, lamp, table of the lamp, picture."""
    table, eye = lobes(801, 0.06), (0.0, 0.0, 1.0)
    places = np.array([[0.06, 0.02], [-0.05, -0.03]])
    colours = np.array([[1.0, 0.6, 0.3], [0.4, 0.7, 1.0]])
    lamps = tuple(
        surface.distant_lamp((*place, np.sqrt(1 - place @ place)), colour)
        for place, colour in zip(places, colours, strict=True)
    )
    view = surface.view_from(eye, (0, 0, 0), (121, 121), 0.3)
    plane, mirror = surface.Plane(1.0, 1.0), surface.Material(specular=1.0, roughness=0.004, diffraction=0.0)
    taken = surface.render(surface.Scene(lamps, view, material=mirror), table, plane)
    # A pixel sees 2 tan(0.15) / 121 of the plane, from a distance of 1: that is its step in h.
    step = 2 * np.tan(0.15) / 121
    lamp = surface.lamp_from_reflection(Picture(taken.pixels[..., :3]), step, 0.02)
    whole = surface.convolved(table, lamp)
    at = np.array([lamp.middle[1] - 60, 60 - lamp.middle[0]]) * step
    one = surface.distant_lamp((*at, np.sqrt(1 - at @ at)), 3 * [luminance(colours.sum(axis=0))])
    found = surface.render(surface.Scene((one,), view), whole, plane).pixels[..., :3]
    expected = surface.render(surface.Scene(lamps, view), table, plane).pixels[..., :3]
    point = surface.render(surface.Scene((one,), view), table, plane).pixels[..., :3]
    assert np.abs(found - expected).max() <= 0.04 * expected.max()
    assert np.abs(point - expected).max() > 0.3 * expected.max()


def luminance(colour):
    return float(light.to_xyz(np.asarray(colour)[None])[0, 1])
