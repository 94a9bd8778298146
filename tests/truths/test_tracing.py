"""The compiled tracer: equal to the slow truth ray by ray, mirrored with the light, inside its bounds."""

from functools import cache

import numpy as np
import pytest

from aureole import flare, refuse
from aureole.flare import coating, glass, paraxial, primitives, probes, pupil, rays, tracing
from aureole.flare.prescription import Lens, Surface

load = cache(flare.load)
WAVES = (450e-9, 650e-9)
SLANT = (0.08, 0.05, 1.0)
LENSES = {"heliar_tronnier_100mm": 4, "zeiss_biotar_50mm": 6, "canon_tele_zoom_135mm": 60}
LENSES |= {"schneider_anamorphic_31mm": 20, "leica_summilux_35mm": 12}


@cache
def prepared(name, f_number=None):
    return tracing.prepare(load(name), WAVES, f_number)


def truth(lens, path, points, direction, wavelength):
    """Return the slow tracer's rays from the same points."""
    origins = np.column_stack([points, np.zeros(len(points))])
    along = np.tile(tracing.travel(direction), (len(points), 1))
    return rays.trace_reference(lens, path, origins, along, wavelength)


def scattered(sheet_bounds, count=300, seed=1):
    left, top, right, bottom = sheet_bounds
    chance = np.random.default_rng(seed)
    return np.column_stack([chance.uniform(left, right, count), chance.uniform(top, bottom, count)])


@pytest.mark.parametrize("name", LENSES)
def test_rays_are_those_of_the_truth(name):
    """Places on the picture to 1 µm (a pixel is 19 µm), weights to 3e-4, across the stop, too."""
    lens = load(name)
    compared = 0
    for path in [(), *(ghost.reflections for ghost in flare.ghosts(lens, "all")[:: LENSES[name]])]:
        box = pupil.bounds(prepared(name), path, SLANT)
        if box is None:
            continue
        points = scattered(box)
        found = tracing.trace(prepared(name), path, points, SLANT)
        for w, wavelength in enumerate(WAVES):
            slow = truth(lens, path, points, SLANT, wavelength)
            compared += compare(lens, found, w, slow, tracing.told_crossing(prepared(name), path))
    assert compared > 500


def compare(lens, found, w, slow, crossing=0):
    """Assert that rays at one wavelength are those of the slow tracer; return how many were compared."""
    sure = np.abs(slow.relative_radius - 1.0) > 1e-4
    np.testing.assert_array_equal(found.passed[w][sure], slow.passed[sure])
    lit = slow.passed & sure
    np.testing.assert_allclose(found.weight[w, lit], rays.power(lens, slow)[lit], rtol=3e-4)
    stop = np.column_stack([found.stop_x[w, lit], found.stop_y[w, lit]])
    np.testing.assert_allclose(stop, rays.stop_points(lens, slow, crossing)[lit], atol=5e-5)
    np.testing.assert_allclose(found.radius[w, lit], slow.relative_radius[lit], atol=5e-5)
    shown = lit & (np.abs(slow.positions[:, 0]) < lens.sensor[0])
    landed = np.column_stack([found.x[w, shown], found.y[w, shown]])
    np.testing.assert_allclose(landed, slow.positions[shown, :2], atol=1e-6, rtol=1e-4)
    return shown.sum()


def test_an_asphere_and_a_conic_are_those_of_the_truth():
    medium = glass.of_numbers(1.6, 50.0)
    surfaces = (
        Surface(20.0, 0.004, 0.012, medium, conic=-0.8, asphere=(-800.0, 2e6)),
        Surface(-5.0, 0.003, 0.012, asphere=(500.0,)),
        Surface(0.0, 0.002, 0.01, stop=True),
        Surface(-25.0, 0.003, 0.01, medium, conic=0.4),
        Surface(10.0, 0.04, 0.01),
    )
    lens = Lens("test", "Test", 0.05, 4.0, (0.036, 0.024), surfaces)
    tables = tracing.prepare(lens, [550e-9])
    points = scattered((-0.011, -0.011, 0.011, 0.011), 500)
    for path in ((), (4, 3), (1, 0), (3, 1)):
        found = tracing.trace(tables, path, points, SLANT)
        slow = truth(lens, path, points, SLANT, 550e-9)
        assert compare(lens, found, 0, slow) > 20


def test_mirrored_light_gives_a_mirrored_sheet():
    tables, path = prepared("heliar_tronnier_100mm"), (4, 1)
    (one,) = pupil.sheets(tables, [path], (0.1, 0.04, 1.0), base=24)
    points = scattered(one.rectangle)
    found = tracing.trace(tables, path, points, (0.1, 0.04, 1.0))
    other = tracing.trace(tables, path, points * (-1.0, 1.0), (-0.1, 0.04, 1.0))
    np.testing.assert_array_equal(found.passed, other.passed)
    np.testing.assert_array_equal(found.x, -other.x)
    np.testing.assert_array_equal(found.y, other.y)
    np.testing.assert_array_equal(found.weight, other.weight)


@pytest.mark.parametrize("name", sorted(LENSES)[::2])
def test_bounds_hold_what_a_dense_grid_over_the_front_finds(name):
    lens, side = load(name), 90
    reach = 1.2 * lens.surfaces[0].semi_aperture
    line = np.linspace(-reach, reach, side)
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    seen = 0
    for ghost in flare.ghosts(lens, "all")[:: LENSES[name]]:
        found = tracing.trace(prepared(name), ghost, points, SLANT)
        box = pupil.bounds(prepared(name), ghost, SLANT)
        power = np.sum(found.weight * found.passed, axis=0)
        if box is None:
            assert power.sum() == 0
            continue
        (x, y), (left, top, right, bottom) = points.T, box
        inside = (x >= left) & (x <= right) & (y >= top) & (y <= bottom)
        assert power[~inside].sum() <= 1e-4 * power.sum()
        seen += power.sum() > 0
    assert seen > 3


def test_an_iris_set_smaller_blocks_what_lies_outside_it():
    lens = load("heliar_tronnier_100mm")
    wide, small = prepared("heliar_tronnier_100mm"), prepared("heliar_tronnier_100mm", 8.0)
    points = scattered((-0.014, -0.014, 0.014, 0.014))
    open_, closed = (tracing.trace(tables, (), points, SLANT) for tables in (wide, small))
    part = small.stop_radius / wide.stop_radius
    assert small.stop_radius == pytest.approx(paraxial.stop_radius(lens, 8.0))
    assert wide.stop_radius == lens.surfaces[lens.stop].semi_aperture
    np.testing.assert_allclose(closed.stop_x * part, open_.stop_x, rtol=1e-5)
    within = open_.passed & (np.hypot(open_.stop_x, open_.stop_y) <= part)
    np.testing.assert_array_equal(closed.passed, within)


def test_the_image_s_power_is_the_opening_s_area_where_nothing_refracts():
    """A bare stop of radius a under light at an angle lets π a² cos θ through."""
    lens = Lens("test", "Test", 0.1, 4.0, (0.036, 0.024), (Surface(0.0, 0.05, 0.004, stop=True),))
    found = pupil.image_power(tracing.prepare(lens, [500e-9, 600e-9]), (0.3, 0.0, 1.0))
    np.testing.assert_allclose(found, np.pi * 0.004**2 / np.hypot(1.0, 0.3), rtol=1e-4)


def test_the_image_s_power_is_that_of_the_truth_s_rays():
    lens, name = load("zeiss_biotar_50mm"), "zeiss_biotar_50mm"
    half = lens.surfaces[0].semi_aperture * 1.1
    line = (np.arange(150) + 0.5) / 75 * half - half
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    slow = truth(lens, (), points, SLANT, WAVES[0])
    cell = (half / 75) ** 2 / np.linalg.norm(SLANT)
    expected = np.sum(rays.power(lens, slow) * slow.passed) * cell
    assert pupil.image_power(prepared(name), SLANT)[0] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("name", ["heliar_tronnier_100mm", "canon_tele_zoom_135mm"])
def test_points_between_rays_lie_where_a_frame_s_pixels_want_them(name):
    """Rays through the middles of a sheet's cells, against the mean of the cell's corners."""
    lens, frame = load(name), primitives.Frame((270, 480), 0.036 / 480)
    paths = flare.ghosts(lens, "same-side")[:: LENSES[name]]
    strayed, counts = [], []
    for sheet in pupil.sheets(prepared(name), paths, SLANT, base=128, frame=frame, error=0.5):
        (left, top, right, bottom), (rows, columns) = sheet.rectangle, sheet.x.shape[1:]
        step = (right - left) / (columns - 1) / 2, (bottom - top) / (rows - 1) / 2
        middles = left + step[0], top + step[1], right - step[0], bottom - step[1]
        points = probes.points_of(middles, (rows - 1, columns - 1))
        between = tracing.trace(prepared(name), sheet.path, points, SLANT)
        off = []
        for landed, corners in ((between.x, sheet.x), (between.y, sheet.y)):
            mean = corners[:, :-1, :-1] + corners[:, 1:, :-1] + corners[:, :-1, 1:] + corners[:, 1:, 1:]
            off.append(landed.reshape(len(WAVES), rows - 1, columns - 1) - mean / 4)
        corners = sheet.passed
        passed = corners[:, :-1, :-1] & corners[:, 1:, :-1] & corners[:, :-1, 1:] & corners[:, 1:, 1:]
        beside = np.maximum(np.abs(between.x) / 0.018, np.abs(between.y) / 0.010125).reshape(passed.shape)
        strayed.append(np.hypot(*off)[passed & (beside < 1)] / frame.pitch)
        counts.append(rows * columns)
    strayed = np.concatenate(strayed)
    assert np.quantile(strayed, 0.99) < 1.0
    assert np.median(counts) < 0.5 * 128**2


def test_the_paper_s_grids_cover_the_front_and_shrink_with_the_ghost():
    tables, base = prepared("heliar_tronnier_100mm"), 64
    paths = flare.ghosts(load("heliar_tronnier_100mm"))
    made = pupil.sheets(tables, paths, SLANT, base=base, adapt="paper")
    sides = [sheet.x.shape[1] for sheet in made]
    assert len({sheet.rectangle for sheet in made}) == 1
    assert min(sides) >= round(0.05 * base)
    for sheet, side in zip(made, sides, strict=True):
        lit = sheet.passed
        if lit.sum() < 200:
            continue
        part = np.ptp(sheet.x[lit]) * np.ptp(sheet.y[lit]) / (0.036 * 0.024)
        assert side / base == pytest.approx(np.clip(np.sqrt(part), 0.05, 1.0), rel=0.15)


def test_a_coating_does_the_same_from_either_side():
    """R and T at one angle in the medium of the lower index, from that side and from the other."""
    layers, dense = (
        [coating.quarter_wave(1.38, 550e-9), coating.quarter_wave(2.1, 550e-9)],
        glass.of_numbers(1.8),
    )
    cosines = np.linspace(0.05, 1.0, 40)
    inside = np.sqrt(1.0 - (1.0 - cosines**2) / 1.8**2)
    for wavelength in WAVES:
        there = coating.reflectance(layers, glass.AIR, dense, cosines, wavelength)
        back = coating.reflectance(layers[::-1], dense, glass.AIR, inside, wavelength)
        np.testing.assert_allclose(there, back, atol=1e-12)


def test_refusals_name_what_is_wrong():
    tables = prepared("heliar_tronnier_100mm")
    with pytest.raises(refuse.Refusal, match="'direction' must point forward"):
        tracing.trace(tables, (), [[0.0, 0.0]], (0.0, 0.1, -1.0))
    with pytest.raises(refuse.Refusal, match="'base' must be"):
        pupil.sheets(tables, [(4, 1)], SLANT, base=1)
    with pytest.raises(refuse.Refusal, match="'reflections' must turn"):
        tracing.trace(tables, (1, 4), [[0.0, 0.0]], SLANT)
