"""Lights with a size behind occluders: visible area, Parseval, and single points as special cases."""

import math

import numpy as np
import pytest

from aureole import aperture, diffraction, glare, light
from aureole.glare.power_sums import METHODS
from aureole.records import Aperture, Grid

WIDTH, SIZE = 8e-3, 128
OPENING = aperture.iris(7, WIDTH)
# Its points step by 0.1 mm on the opening's plane, a shadow's edge by about a pixel and a half.
LAMP = glare.AreaLight(aperture.circle(4e-3), (1e-3, -0.5e-3), 12.0)
LEAF = aperture.occluder(aperture.polygon([(-2e-3, -2e-3), (3e-3, 0.0), (-1e-3, 2e-3)]), 0.5, (1e-3, 0.0))
BARS = aperture.occluder(aperture.railing(2e-3, 3e-3, 7, 1.0), 0.5)
GRID = Grid((129, 129), (1 / WIDTH, 1 / WIDTH))


def masks(across: int, *occluders: aperture.Occluder) -> list[tuple[float, Aperture | None]]:
    samples = glare.light_samples(LAMP, across)
    return list(glare.sample_openings(OPENING, occluders, LAMP, samples, SIZE))


def trapezium(x, inner: float, outer: float):
    """Return the overlap of two boxes that are moved x apart, over the smaller one's length."""
    return np.clip((inner + outer) / 2 - np.abs(x), 0, min(inner, outer)) / min(inner, outer)


@pytest.mark.parametrize("across", [1, 4, 9])
def test_samples_hold_all_of_the_light_about_its_middle(across):
    samples = glare.light_samples(LAMP, across)
    assert samples.weights.sum() == pytest.approx(1)
    np.testing.assert_allclose(samples.weights @ samples.toward, LAMP.toward, atol=1e-8)


def test_neighbours_in_the_order_are_neighbours_in_the_light():
    samples = glare.light_samples(glare.AreaLight(aperture.rectangle(1e-3, 1e-3)), 9)
    assert len(samples.weights) == 81
    assert np.abs(np.diff(samples.cells, axis=0)).sum(axis=1).max() == 1


@pytest.mark.parametrize("method", sorted(METHODS))
@pytest.mark.parametrize("grid", [GRID, Grid((64, 80), (0.5 / WIDTH, 0.7 / WIDTH), (30.0, 0.0))])
def test_the_power_is_the_mean_of_its_samples(grid, method):
    found = glare.area_power(OPENING, [LEAF, BARS], LAMP, grid, 5, 0.02, SIZE, method)
    direct = np.zeros(grid.shape)
    for weight, opening in masks(5, LEAF, BARS):
        if opening is not None:
            direct += weight * diffraction.far_power(opening, grid, "chirpz")
    exact = 1e-4 * direct.max() / direct.sum()
    assert np.abs(found.power - direct).max() < (1e-3 if method == "modes" else 1e-4) * direct.max()
    if grid is GRID:
        assert np.abs(found.power - direct).sum() <= (found.estimated + exact) * direct.sum()
        assert (found.estimated > 0) == (method == "modes") == (found.transforms < 15)
        assert found.estimated <= 0.01


def test_the_visible_part_is_an_integral_over_light_and_opening():
    # Rectangles: a lamp's and an opening's widths and one bar's edge make a closed form along x alone.
    window, side, depth, distance = aperture.rectangle(6e-3, 6e-3), 4e-3, 0.5, 10.0
    lamp = glare.AreaLight(aperture.rectangle(side, side), (0.0, 0.0), distance)
    grid = Grid((4, 4), (1 / WIDTH, 1 / WIDTH))
    factor = 1 / (1 - depth / distance)
    for x in (0.0, 1.7e-3, 3.2e-3):
        bar = aperture.occluder(aperture.rectangle(2e-3, 1.0), depth, (x, 0.0))
        found = glare.area_power(window, [bar], lamp, grid, across=9, size=256)
        # The shadow's middle runs evenly over the lamp's width times depth, both magnified.
        middles = factor * (x - depth * side * (np.arange(2000) + 0.5 - 1000) / 2000)
        covered = trapezium(middles, 2e-3 * factor, 6e-3).mean() * 2e-3 * factor / 6e-3
        assert found.visible == pytest.approx(1 - covered, abs=2e-3)


def test_all_frequencies_hold_what_is_visible():
    # Parseval, on a plane that reaches as far as the raster's own frequencies.
    grid = Grid((257, 257), (0.5 / WIDTH, 0.5 / WIDTH))
    found = glare.area_power(OPENING, [BARS], LAMP, grid, across=5, size=64)
    whole = glare.area_power(OPENING, [], LAMP, grid, across=1, size=64)
    assert whole.visible == pytest.approx(1)
    assert found.power.sum() / whole.power.sum() == pytest.approx(found.visible, rel=0.01)
    assert 0.3 < found.visible < 0.9


def test_a_moving_railing_changes_the_power_by_no_more_than_the_area_explains():
    # |∫(|F|² − |G|²)| <= ‖F − G‖ ‖F + G‖, by Cauchy and Schwarz, for each sample.
    grid, patterns, seen = Grid((257, 257), (0.5 / WIDTH, 0.5 / WIDTH)), [], []
    for x in (0.0, 0.3e-3):
        bars = BARS.moved_to(x, 0.0)
        patterns.append(glare.area_power(OPENING, [bars], LAMP, grid, across=3, size=64).power)
        samples = glare.light_samples(LAMP, 3)
        opened = glare.sample_openings(OPENING, [bars], LAMP, samples, 64)
        seen.append([(w, np.zeros((64, 64)) if o is None else o.mask.astype(float)) for w, o in opened])
    pixel = (WIDTH / 64) ** 2
    bound = sum(
        weight * math.sqrt(np.sum((f - g) ** 2) * np.sum((f + g) ** 2)) * pixel
        for (weight, f), (_, g) in zip(*seen, strict=True)
    )
    changed = float(np.abs(patterns[1] - patterns[0]).sum()) * grid.spacing[0] * grid.spacing[1]
    assert 0.05 * bound < changed <= bound


def test_finer_samples_are_taken_until_the_error_allows_it():
    rough = glare.area_power(OPENING, [LEAF], LAMP, GRID, tolerance=0.5, size=SIZE)
    fine = glare.area_power(OPENING, [LEAF], LAMP, GRID, tolerance=0.004, size=SIZE)
    assert rough.samples < fine.samples
    assert fine.error <= 0.004
    truth = glare.area_power(OPENING, [LEAF], LAMP, GRID, across=33, size=SIZE)
    difference = np.abs(fine.power - truth.power).sum() / truth.power.sum()
    assert difference <= 0.004


def test_a_hidden_light_is_dark():
    wall = aperture.occluder(aperture.rectangle(1.0, 1.0), 0.5)
    found = glare.area_power(OPENING, [wall], LAMP, GRID, size=SIZE)
    assert found.visible == 0
    assert not found.power.any()
    assert found.error == 0


def _camera(resolution=(90, 160)):
    return glare.camera(50e-3, 16, OPENING, 6e-3 * 160 / 90, 6e-3, resolution)


def test_a_point_without_occluders_has_the_cameras_own_starburst():
    white = light.illuminant("D65")
    point = glare.AreaLight(aperture.circle(1e-4))
    found = glare.area_psf(_camera(), point, [], (65, 65), white, across=1)
    expected = glare.camera_psf(_camera(), (65, 65), white, border_fade=0.0)
    np.testing.assert_allclose(found.psf.pixels, expected.pixels, rtol=1e-6, atol=1e-12)
    assert found.visible == pytest.approx(1)
    assert found.openings == 1


def test_the_picture_of_a_lamp_holds_what_is_visible_of_it():
    opening = _camera()
    bars = aperture.occluder(aperture.railing(1e-3, 1.5e-3, 9, 1.0), 0.5)
    lamp = glare.AreaLight(aperture.circle(12e-3), (4e-3, -2e-3), 12.0)
    found = glare.area_psf(opening, lamp, [bars], (181, 321), across=3)
    sharp = glare.lamp_picture(found, opening, lamp)
    assert sharp.sum() == pytest.approx(found.visible, rel=1e-5)
    out = glare.area_glare(found, opening, lamp, (2.0, 1.0, 0.5))
    sums = out.pixels.sum(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(sums, np.array([2.0, 1.0, 0.5]) * found.visible, rtol=0.01)
    # The middle of its light lies where the lamp stands.
    rows, columns = np.nonzero(sharp == sharp.max())
    pitch = 6e-3 / 90 / 50e-3
    assert abs(columns.mean() - (80 + 4e-3 / pitch)) < 10
    assert abs(rows.mean() - (45 - 2e-3 / pitch)) < 10


def test_few_samples_say_how_much_is_visible():
    # Right of an upright edge lies half a square of what is left of a square's diagonal.
    depth, distance, half = 0.5, 10.0, 2e-3
    opening = glare.camera(50e-3, 12.5, aperture.iris(4, 2 * half), 6e-3 * 160 / 90, 6e-3, (90, 160))
    lamp = glare.AreaLight(aperture.rectangle(half, half), (0.0, 0.0), distance)
    middles = (np.arange(4000) + 0.5) / 4000 - 0.5
    for x in (-1.6e-3, 0.4e-3):
        wall = aperture.occluder(aperture.rectangle(0.2, 0.4), depth, (-x - 0.1, 0.0))
        found = glare.area_psf(opening, lamp, [wall], (9, 9), tolerance=0.5)
        edges = np.clip((-x - depth * half * middles) / (1 - depth / distance) / half, -1, 1)
        open_parts = np.where(edges > 0, (1 - edges) ** 2 / 2, 1 - (1 + edges) ** 2 / 2)
        assert found.openings <= 5
        assert found.visible == pytest.approx(open_parts.mean(), rel=2e-3)
        assert found.seen.sum() == pytest.approx(found.visible)


def test_upright_bars_need_one_opening_a_column():
    bars = aperture.occluder(aperture.railing(1e-3, 1.5e-3, 9, 1.0), 0.5)
    lamp = glare.AreaLight(aperture.rectangle(12e-3, 12e-3), (0.0, 0.0), 12.0)
    found = glare.area_psf(_camera(), lamp, [bars], (33, 33), across=4)
    assert found.openings <= 4
