"""Light from all around on a flat sample: correlation against the sum over all directions, energy, turns."""

import numpy as np
import pytest

from aureole import refuse, surface
from aureole.bench.surface_environment import environment_errors
from aureole.surface.environment import Environment, directions
from aureole.surface.resampling import on_even_steps
from aureole.surface.table import axis, lookup

FRAME = surface.frame_of((0.2, 0.9, 0.3), (1, 0, 0), 0.4)
OBLIQUE = 1e-3  # relative, as the issue asks
NORMAL = 3e-3
VIEWS = np.array([[0, 0], [0.1, 0.2], [0.5, -0.3], [-0.7, 0.2], [0.3, 0.8], [-0.2, -0.9], [0.65, 0.65]])


def lobes(size=512, width=0.04, seed=0):
    """Ten smooth lobes of neutral light, one of them about h = 0."""
    generator = np.random.default_rng(seed)
    h = axis(size)
    values = np.zeros((size, size))
    for k in range(10):
        x, y = generator.uniform(-1.2, 1.2, 2) * (k > 0)
        values += np.exp(-((h[:, None] + y) ** 2 + (h[None, :] - x) ** 2) / (2 * width**2))
    return surface.scatter_table(np.repeat(values[..., None], 3, axis=2), (1, 1, 1))


def flat(size=65):
    return surface.scatter_table(np.ones((size, size, 3)), (1, 1, 1))


def white_room(rows=16):
    return Environment(np.ones((rows, 2 * rows, 3), dtype=np.float32))


def lamps(rows=64, count=14, seed=2):
    generator = np.random.default_rng(seed)
    radiance = np.zeros((rows, 2 * rows, 3), dtype=np.float32)
    radiance[generator.integers(rows, size=count), generator.integers(2 * rows, size=count)] = 100.0
    return Environment(radiance + np.float32(0.1) * (np.arange(rows) < rows // 4)[:, None, None])


@pytest.fixture(scope="module")
def summed():
    """A table, a room with lamps, and their sum over all directions."""
    table, room = lobes(), lamps()
    return table, room, surface.quadrature(table, room, FRAME, VIEWS)


@pytest.mark.parametrize(("filter", "size"), [("sharpened", 511), ("average", 719), ("point", 719)])
def test_correlation_equals_the_integral_over_all_directions(summed, filter, size):
    table, room, exact = summed
    found = surface.reflect(table, room, FRAME, size, filter).towards(VIEWS)
    error = np.abs(found - exact.radiance).max(axis=1) / exact.radiance.max(axis=1)
    assert error[0] <= NORMAL
    assert error[1:].max() <= OBLIQUE


def test_the_reference_settles_and_agrees_with_a_sum_of_look_ups(summed):
    table, room, exact = summed
    assert exact.change.max() <= 1e-4
    views = VIEWS[[0, 3]]
    looked = surface.quadrature(table, room, FRAME, views, 1e-3, 8, "directions")
    np.testing.assert_allclose(exact.radiance[[0, 3]], looked.radiance, rtol=3e-3)


def test_the_reference_finds_all_light_of_an_order_far_narrower_than_a_pixel():
    # One sample of a table in u: a spike 1e-4 wide, seen in a lamp of one pixel, shows its energy or nothing.
    size = 401
    values = np.zeros((size, size, 3))
    values[150, 260] = 1.0
    spike = surface.scatter_table(values, (1, 1, 1))
    radiance = np.zeros((32, 64, 3), dtype=np.float32)
    radiance[10, 20] = 2.0
    latitude, longitude = np.pi / 2 - np.pi * 10.5 / 32, 2 * np.pi * 20.5 / 64 - np.pi
    across = np.cos(latitude)
    lamp = np.array([across * np.sin(longitude), np.sin(latitude), -across * np.cos(longitude)])
    frame = surface.frame_of(lamp + np.array([0.3, 0.2, 0.1]), (1, 0, 0))
    h = axis(size)
    order = np.array([h[260], -h[150]])
    views = [order - frame[:2] @ lamp, order - frame[:2] @ lamp + (0.1, 0.1)]
    found = surface.quadrature(spike, Environment(radiance), frame, views).radiance[:, 1]
    assert found[0] == pytest.approx(2 * surface.table_cells(spike, 1)[0, 5], rel=1e-4)
    assert found[1] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("normal", [(0, 1, 0), (0, 0, 1), (0.2, -0.9, 0.3), (1, 0, 0)])
def test_the_reference_of_a_flat_table_is_the_irradiance_whichever_way_the_sample_lies(normal):
    frame = surface.frame_of(normal, (0.3, 0.1, 1), 0.2)
    room = surface.lamps_and_windows(16)
    energy = sum(e[:count].sum(axis=0) for _, e, count in directions(room, frame, 64))
    found = surface.quadrature(flat(), room, frame, [[0.0, 0.0], [0.3, -0.4]]).radiance
    np.testing.assert_allclose(found, 4 * np.pi**2 * np.stack([energy, energy]), rtol=1e-3)
    mirrored = surface.quadrature(flat(), room, frame * [[1], [-1], [1]], [[0.0, 0.0], [0.3, 0.4]])
    np.testing.assert_allclose(mirrored.radiance, found, rtol=1e-6)


def test_a_flat_table_sends_the_irradiance_to_every_view():
    found = surface.reflect(flat(), white_room(), FRAME, 255).towards(VIEWS)
    # White light from a whole hemisphere has the irradiance π.
    np.testing.assert_allclose(found, 4 * np.pi**3, rtol=1e-3)


def test_all_energy_of_the_light_is_laid_out():
    room = surface.lamps_and_windows(64)
    whole = surface.hemisphere(room, FRAME, 255).energy.sum(axis=(0, 1), dtype=np.float64)
    summed = sum(energies[:count].sum(axis=0) for _, energies, count in directions(room, FRAME, 24))
    np.testing.assert_allclose(whole, summed, rtol=2e-5)


def test_turning_sample_and_light_together_changes_nothing():
    table = lobes(256)
    room = lamps()
    columns = room.radiance.shape[1]
    turned = Environment(np.roll(room.radiance, columns // 8, axis=1))
    # Columns to the right are turned about y from −z towards +x.
    cosine, sine = np.cos(np.pi / 4), np.sin(np.pi / 4)
    about_up = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
    first = surface.reflect(table, room, FRAME, 255).towards(VIEWS)
    second = surface.reflect(table, turned, FRAME @ about_up.T, 255).towards(VIEWS)
    np.testing.assert_allclose(second, first, rtol=1e-4, atol=1e-5 * first.max())


def test_a_sample_turned_about_its_normal_turns_its_pattern():
    table, room = lobes(256), lamps()
    half_turn = surface.frame_of(FRAME[2], FRAME[0], np.pi)
    reversed_table = surface.scatter_table(table.values[::-1, ::-1], (1, 1, 1))
    first = surface.reflect(table, room, FRAME, 255).towards(VIEWS)
    second = surface.reflect(reversed_table, room, half_turn, 255).towards(-VIEWS)
    np.testing.assert_allclose(second, first, rtol=1e-4, atol=1e-5 * first.max())


def test_the_prefiltered_map_is_right_along_the_normal_only():
    table, room = lobes(256), lamps()
    exact = surface.quadrature(table, room, FRAME, VIEWS[[0, 5]]).radiance
    found = surface.prefiltered(table, room, FRAME, VIEWS[[0, 5]])
    assert found[0] == pytest.approx(exact[0], rel=1e-4)
    assert abs(found[1, 1] / exact[1, 1] - 1) > 0.05


def test_means_on_even_steps_keep_all_light_of_lines_narrower_than_a_step():
    size, step = 401, 0.04
    values = np.zeros((size, size, 1))
    values[200, 150] = 1.0
    h = axis(size)
    plane = on_even_steps(values, 2.0, 5, (103, 103), step)
    # A tent in u between three neighbours, integrated over h by fine steps.
    fine = np.linspace(h[149], h[151], 20001)
    u, node = np.sign(fine) * (np.abs(fine) / 2) ** 0.2, np.linspace(-1, 1, size)
    along = np.trapezoid(np.clip(1 - np.abs(u - node[150]) * (size - 1) / 2, 0, 1), fine)
    down_fine = np.linspace(h[199], h[201], 20001)
    v = np.sign(down_fine) * (np.abs(down_fine) / 2) ** 0.2
    down = np.trapezoid(np.clip(1 - np.abs(v) * (size - 1) / 2, 0, 1), down_fine)
    assert plane.sum(dtype=np.float64) * step**2 == pytest.approx(along * down, rel=1e-4)


def test_points_on_even_steps_are_the_tables_own_look_ups():
    table = lobes(129)
    plane = on_even_steps(table.values, 2.0, 5, (31, 41), 0.07, "point")
    h_t, h_b = (np.arange(41) - 20) * 0.07, (15 - np.arange(31)) * 0.07
    expected = lookup(table, h_t[None, :], h_b[:, None])
    np.testing.assert_allclose(plane, expected, rtol=1e-5, atol=1e-6)


def test_a_cameras_part_of_the_views_is_the_same_light_finer():
    table, room = surface.table_from_grating("lcd-342ppi", size=257), lamps()
    centre = np.array([0.2, -0.1])
    views = centre + np.array([[0, 0], [0.03, 0.04], [-0.05, 0.02], [0.05, -0.05]])
    exact = surface.quadrature(table, room, FRAME, views).radiance
    close = surface.CloseReflection(table, centre, 0.05, 1e-3, size=511)(room, FRAME)
    error = np.abs(close.towards(views) - exact).max(axis=1) / exact.max()
    assert error.max() <= 3e-3
    with pytest.raises(refuse.Refusal, match="'views' must lie within"):
        close.towards([[0.4, 0.4]])
    with pytest.raises(refuse.Refusal, match="GB of memory"):
        surface.CloseReflection(table, centre, 0.5, 1e-6)


def test_the_bench_finds_the_errors_that_are_asked_for():
    found = environment_errors(lobes(512), "lobes", "all", quick=True)
    prefilter, correlation = found
    assert correlation["normal_percent"] <= 100 * NORMAL
    assert correlation["own_percent"] <= 100 * OBLIQUE
    assert prefilter["normal_percent"] <= 1e-3
    assert prefilter["rmse_percent"] > 7.6
