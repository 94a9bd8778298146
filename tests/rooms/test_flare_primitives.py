"""Primitives of ray grids: which cells stay, what merging may do, and what it must keep."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from aureole import flare, refuse
from aureole.flare import primitives, pupil, tracing
from aureole.flare.merge_picture import merge_picture, sizes
from aureole.flare.primitives import MERGES, Frame, Merge, construct

FRAME = Frame((480, 640), 1e-5)


@dataclass(frozen=True)
class Grid:
    """A sheet of rays made by hand."""

    x: np.ndarray
    y: np.ndarray
    weight: np.ndarray
    level: np.ndarray
    stop_x: np.ndarray
    stop_y: np.ndarray
    reached: np.ndarray
    cell: float = 1e-8


def grid_of(place, n=65, rim=0.9, weight=None):
    """Rays on [-1, 1]², placed by a map to pixels from the frame's middle.

    Valid within a circle; all of them for a rim above 1.
    """
    v, u = np.meshgrid(*[np.linspace(-1.0, 1.0, n)] * 2, indexing="ij")
    x, y = (-FRAME.pitch * np.broadcast_to(part, u.shape) for part in place(u, v))
    light = np.ones_like(u) if weight is None else weight(u, v)
    stop = 1.0 if rim < 1 else 0.6
    fields = [x, y, light, np.hypot(u, v) / rim, stop * u, stop * v]
    return Grid(*(field[None].astype(np.float32) for field in fields), np.ones((1, n, n), dtype=bool))


def bent(u, v):
    return 150 * u + 30 * u**3 + 20 * v * v, 100 * v + 15 * v**3 + 10 * u * u


def folded(u, v):
    """A caustic at u = 0.5."""
    return 150 * (u - u * u), 100 * v + 5 * u


def areas(found):
    x, y = found.corners[..., 0].astype(float), found.corners[..., 1].astype(float)
    return 0.5 * np.abs((x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0]))


def power(found):
    return float(np.sum(found.area * found.attributes[:, :, 0].mean(axis=1), dtype=float))


def test_cells_with_a_valid_ray_stay():
    grid = grid_of(bent)
    valid = grid.level[0] <= 1
    some = valid[:-1, :-1] | valid[:-1, 1:] | valid[1:, :-1] | valid[1:, 1:]
    found = construct(grid, FRAME, keep="valid")
    assert len(found.area) == some.sum()
    np.testing.assert_allclose(found.area, grid.cell, rtol=1e-6)
    assert np.all(found.size == 1)
    # Columns run against the sensor's x, rows against its y.
    expected = 320 - grid.x[0] / FRAME.pitch, 240 - grid.y[0] / FRAME.pitch
    i, j = np.argwhere(some)[100]
    corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
    np.testing.assert_allclose(
        found.corners[100], [[expected[0][at], expected[1][at]] for at in corners], rtol=0, atol=1e-3
    )
    np.testing.assert_array_equal(found.attributes[100, :, 1], [grid.level[0][at] for at in corners])


@pytest.mark.parametrize("merge", MERGES)
@pytest.mark.parametrize("place", [bent, folded])
def test_merging_keeps_cells_and_power(merge, place):
    grid = grid_of(place, n=82, weight=lambda u, v: 0.3 + 0.1 * u - 0.05 * v * v)
    plain, found = construct(grid, FRAME), construct(grid, FRAME, merge=merge)
    assert found.area.sum(dtype=float) == pytest.approx(plain.area.sum(dtype=float), rel=1e-6)
    assert np.all(np.isin(found.size, [1, 2, 4, 8, 16]))
    np.testing.assert_allclose(found.area, found.size.astype(float) ** 2 * grid.cell, rtol=1e-6)
    rel = 5e-3 if merge.startswith("published") else 1e-5
    assert power(found) == pytest.approx(power(plain), rel=rel)


def nodes_of(found, k, grid):
    """The grid's nodes that a primitive covers, found by its place on the stop."""
    n = grid.x.shape[1]
    places = np.rint((found.attributes[k, [0, 2], 2:].astype(float) + 1.0) * (n - 1) / 2.0).astype(int)
    (j0, i0), (j1, i1) = places
    return np.ix_(range(i0, i1 + 1), range(j0, j1 + 1))


def spread(corners, size):
    """The bilinear map of four corners at a grid of nodes."""
    u, v = np.meshgrid(*[np.linspace(0.0, 1.0, size + 1)] * 2)
    a, b, c, d = np.asarray(corners, dtype=float)
    return a * (1 - u) * (1 - v) + b * u * (1 - v) + c * u * v + d * (1 - u) * v


def merged(found):
    return np.flatnonzero(found.size > 1)


def test_a_block_moves_no_ray_by_more_than_its_bound():
    """Every ray of every merged block against the block's bilinear map; the bound is used, too."""
    grid = grid_of(bent, n=82)
    bound = 0.4
    found = construct(grid, FRAME, merge=Merge(position=bound, brightness=1.0, stitch=False))
    columns, rows = 320 - grid.x[0] / FRAME.pitch, 240 - grid.y[0] / FRAME.pitch
    worst = 0.0
    for k in merged(found):
        at = nodes_of(found, k, grid)
        off = [
            spread(found.corners[k, :, axis], found.size[k]) - truth[at]
            for axis, truth in enumerate((columns, rows))
        ]
        worst = max(worst, np.hypot(*off).max())
    assert len(merged(found)) > 50
    assert 0.3 * bound < worst < bound + 1e-3


def test_a_block_changes_no_brightness_by_more_than_its_bound():
    """Power over area of every cell against the block's, where cells are as large as a pixel."""
    grid = grid_of(bent, n=82, weight=lambda u, v: 0.5 + 0.3 * np.sin(2 * u) * np.cos(v))
    bound = 0.03
    found = construct(grid, FRAME, merge=Merge(position=50.0, brightness=bound, stitch=False))
    places = np.stack([320 - grid.x[0] / FRAME.pitch, 240 - grid.y[0] / FRAME.pitch], axis=-1).astype(float)
    worst = 0.0
    for k in merged(found):
        at, size = nodes_of(found, k, grid), found.size[k]
        told = np.stack([spread(found.corners[k, :, axis], size) for axis in (0, 1)], axis=-1)
        light = means(spread(found.attributes[k, :, 0], size)) / cell_areas(told)
        truth = means(grid.weight[0][at]) / cell_areas(places[at])
        worst = max(worst, abs(light / truth - 1).max())
    assert len(merged(found)) > 50
    # Blocks differ from their cells as their quarters do, but for what curves inside a quarter.
    assert worst < bound


def means(values):
    return 0.25 * (values[:-1, :-1] + values[1:, :-1] + values[:-1, 1:] + values[1:, 1:])


def cell_areas(places):
    across, along = places[1:, 1:] - places[:-1, :-1], places[1:, :-1] - places[:-1, 1:]
    return 0.5 * abs(across[..., 0] * along[..., 1] - across[..., 1] * along[..., 0])


@pytest.mark.parametrize("merge", ["light", "heavy", "published-heavy"])
def test_only_blocks_of_valid_rays_merge(merge):
    grid = grid_of(bent, n=82)
    found = construct(grid, FRAME, merge=merge)
    for k in merged(found):
        assert grid.level[0][nodes_of(found, k, grid)].max() <= 1.0
    assert found.size.max() >= 4


def test_no_block_goes_over_a_fold():
    """The fold is at u = 0.5; u stands in for the place on the stop. The published test goes over it."""
    grid = grid_of(folded, n=82)
    for merge in ("light", "heavy", Merge(position=1e3, brightness=1e3)):
        found = construct(grid, FRAME, merge=merge)
        u = found.attributes[merged(found)][..., 2]
        assert len(u) > 20
        assert np.all((u < 0.5).all(axis=1) | (u > 0.5).all(axis=1))
    found = construct(grid, FRAME, merge="published-heavy")
    u = found.attributes[merged(found)][..., 2]
    assert np.any((u < 0.5).any(axis=1) & (u > 0.5).any(axis=1))


def test_the_published_test_sees_one_side_only():
    """A map that stretches and its mirror image: one merges wholly, the other hardly; ours like both."""

    def stretched(u, v):
        return 60 * np.exp(1.2 * u) - 100, 100 * v

    def mirrored(u, v):
        return 100 - 60 * np.exp(1.2 * u), 100 * v

    counts = {
        merge: [
            len(construct(grid_of(place, rim=9.0), FRAME, merge=merge).area)
            for place in (stretched, mirrored)
        ]
        for merge in ("published-light", "light")
    }
    assert counts["light"][0] == counts["light"][1]
    assert max(counts["published-light"]) > 5 * min(counts["published-light"])
    assert min(counts["published-light"]) == 16


def test_the_published_test_lets_errors_cancel():
    """What x gains y loses: with y upward, both shrink or grow together as seen in pixels."""
    grid = grid_of(lambda u, v: (140 * (u - 0.3 * u * u), 105 * (v - 0.3 * u * u)), rim=9.0)
    assert len(construct(grid, FRAME, merge="published-light").area) < 100
    assert len(construct(grid, FRAME, merge="light").area) > 200


def covers(found, points):
    """How many primitives each point lies in, by half planes."""
    corners = found.corners.astype(float)
    turned = (areas_signed(found) < 0)[:, None]
    inside = np.ones((len(points), len(corners)), dtype=bool)
    for k in range(4):
        a, b = corners[:, k], corners[:, (k + 1) % 4]
        side = (b[:, 0] - a[:, 0]) * (points[:, None, 1] - a[:, 1])
        side -= (b[:, 1] - a[:, 1]) * (points[:, None, 0] - a[:, 0])
        inside &= (side > 0) ^ turned.T
    return inside.sum(axis=1)


def areas_signed(found):
    across, along = (found.corners[:, k + 2].astype(float) - found.corners[:, k] for k in (0, 1))
    return 0.5 * (across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])


def test_no_cracks_between_large_and_small():
    """Points in the ghost lie in one primitive each; without stitching slivers are left, under 1 in 100."""
    grid = grid_of(bent, n=50)
    points = np.array([320.0, 240.0]) + np.random.default_rng(2).uniform(-55, 55, (5000, 2))
    for merge in ("light", "heavy"):
        bounds = MERGES[merge]
        found = construct(grid, FRAME, merge=bounds)
        assert np.unique(found.size).size >= 3
        np.testing.assert_array_equal(covers(found, points), 1)
    open_ = Merge(position=bounds.position, brightness=bounds.brightness, stitch=False)
    wrong = np.mean(covers(construct(grid, FRAME, merge=open_), points) != 1)
    assert 0 < wrong < 1e-2


@pytest.mark.parametrize("merge", ["light", "heavy"])
def test_merged_primitives_cover_the_same_part_of_the_picture(merge):
    grid = grid_of(bent, n=82)
    plain, found = construct(grid, FRAME), construct(grid, FRAME, merge=merge)
    assert np.sum(areas(found)) == pytest.approx(np.sum(areas(plain)), rel=2e-4)


def test_a_plain_map_merges_wholly():
    found = construct(grid_of(lambda u, v: (100 * u + 9 * v, 80 * v), n=33, rim=9.0), FRAME, merge="light")
    np.testing.assert_array_equal(found.size, 16)
    assert len(found.area) == 4
    fewer = construct(grid_of(lambda u, v: (100 * u, 80 * v), n=33, rim=9.0), FRAME, merge=Merge(steps=2))
    np.testing.assert_array_equal(fewer.size, [4] * 64)


def test_a_mirrored_sheet_makes_mirrored_primitives():
    grid = grid_of(bent)
    other = replace(grid, x=-grid.x)
    for merge in ("none", "light", "heavy"):
        one, two = construct(grid, FRAME, merge=merge), construct(other, FRAME, merge=merge)
        np.testing.assert_array_equal(one.size, two.size)
        np.testing.assert_allclose(one.corners[..., 0], 640 - two.corners[..., 0], rtol=0, atol=1e-3)
        np.testing.assert_array_equal(one.attributes, two.attributes)


def test_what_misses_the_frame_is_left_out_and_told():
    grid = grid_of(lambda u, v: (400 * u, 100 * v))
    whole = construct(grid, FRAME, clip=False)
    found = construct(grid, FRAME)
    assert whole.outside.sum() == 0
    assert 0.1 * power(whole) > found.outside.sum() > 0.03 * power(whole)
    assert power(found) + found.outside.sum() == pytest.approx(power(whole), rel=1e-6)
    assert found.corners[..., 0].max(axis=1).min() >= 0
    assert found.corners[..., 0].min(axis=1).max() <= 640


def test_a_strip_between_two_edges_is_kept():
    """Light passes between the stop's edge and a vignetting one, and no ray of the coarse grid hits it."""
    grid = grid_of(bent, n=9)
    level = np.where(grid.stop_x < 0.6, 1.5, 0.9).astype(np.float32)
    stop = (grid.stop_x * 1.4).astype(np.float32)
    grid = replace(grid, level=level, stop_x=stop)
    passed = (level <= 1) & (stop**2 + grid.stop_y**2 <= 1)
    assert not passed.any()
    assert len(construct(grid, FRAME, keep="valid").area) == 0
    found = construct(grid, FRAME)
    assert len(found.area) > 2
    low, high = found.attributes[..., 2].min(axis=1), found.attributes[..., 2].max(axis=1)
    assert np.all((low <= 1) & (high >= -1) & (found.attributes[..., 1].min(axis=1) <= 1))


def test_a_lost_ray_leaves_a_parallelogram_without_its_light():
    grid = grid_of(lambda u, v: (100 * u, 80 * v), n=17, rim=9.0)
    reached = grid.reached.copy()
    reached[0, 0, 0] = reached[0, 16, :] = False
    grid = replace(grid, reached=reached, x=np.where(reached, grid.x, 7.0).astype(np.float32))
    found = construct(grid, FRAME, merge="heavy")
    first = np.flatnonzero(found.attributes[:, 0, 0] == 0)
    assert len(first) == 1
    plain = construct(grid_of(lambda u, v: (100 * u, 80 * v), n=17, rim=9.0), FRAME)
    np.testing.assert_allclose(found.corners[first[0]], plain.corners[0], rtol=0, atol=1e-3)
    # Cells with two lost rays go; the sums count.
    assert found.size.astype(float) @ found.size == 15 * 16


def test_iris_places_hold_merging_back():
    """A map that is plain on the sensor but bent on the stop: an iris's edge would move."""
    grid = grid_of(lambda u, v: (100 * u, 80 * v), n=33, rim=9.0)
    bent_stop = replace(grid, stop_x=(0.5 * grid.stop_x + 0.3 * grid.stop_x**2).astype(np.float32))
    assert len(construct(grid, FRAME, merge="light").area) == 4
    assert len(construct(bent_stop, FRAME, merge="light").area) > 20


def test_sheets_keep_their_order_ghosts_and_colours():
    one, two = grid_of(bent, n=17), grid_of(folded, n=33)
    both = [replace(one, **{name: np.repeat(getattr(one, name), 2, axis=0) for name in FIELDS}), two]
    found = construct(both, FRAME, colours=[[4, 2], [7]], ghosts=[10, 3])
    np.testing.assert_array_equal(np.unique(found.ghost), [3, 10])
    first = found.ghost == 10
    assert np.all(np.diff(first.astype(int)) <= 0)
    assert set(found.colour[first]) == {2, 4}
    assert set(found.colour[~first]) == {7}
    alone = construct(two, FRAME)
    np.testing.assert_array_equal(found.corners[~first], alone.corners)
    assert found.outside.shape == (2,)


FIELDS = ("x", "y", "weight", "level", "stop_x", "stop_y", "reached")


@pytest.mark.parametrize("merge", MERGES)
def test_counting_needs_no_primitives(merge):
    grids = [grid_of(bent), grid_of(folded)]
    found = construct(grids, FRAME, merge=merge)
    assert primitives.count(grids, FRAME, merge) == len(found.area)
    arrays = (found.corners, found.attributes, found.area, found.colour, found.ghost, found.size)
    assert sum(array.nbytes for array in arrays) == len(found.area) * primitives.BYTES


def test_a_real_ghost_keeps_its_power_and_merges():
    """Heliar, f/16, the ghost of surfaces 2 and 3: its cells' power whatever the merging."""
    lens = flare.load("heliar_tronnier_100mm")
    frame = primitives.frame_of(lens)
    assert frame.pitch == pytest.approx(36e-3 / 1920)
    prepared = tracing.prepare(lens, [550e-9], 16.0)
    direction = (np.sin(0.1), 0.0, np.cos(0.1))
    sheets = pupil.sheets(prepared, [flare.path_of(lens, [2, 3])], direction, base=65)
    plain = construct(sheets, frame)
    for merge, fewer in (("light", 3), ("heavy", 5)):
        found = construct(sheets, frame, merge=merge)
        assert power(found) == pytest.approx(power(plain), rel=1e-5)
        assert fewer * len(found.area) < len(plain.area)


def test_the_picture_of_merging_shows_sizes():
    grid = grid_of(bent, n=82)
    none = merge_picture(grid, FRAME, "none", (200, 240))
    some = merge_picture(grid, FRAME, "heavy", (200, 240))
    assert none.shape == (200, 240, 3)
    assert none.dtype == np.float32
    assert 0 <= some.min() < some.max() == 1
    # Without merging all lines are of the smallest cells' red; merged, there is more white and blue.
    assert np.all(none[..., 0] >= none[..., 1])
    assert np.mean(some == 1) > np.mean(none == 1) + 0.1
    assert np.any(some[..., 2] > some[..., 0] + 0.2)
    # The ghost fills the drawing but for its margin.
    lit = np.argwhere((none < 1).any(axis=2))
    assert min(lit.min(axis=0)) < 12
    assert lit.max() > 180
    with pytest.raises(refuse.Refusal, match="'wavelength' must be a number from 0 to 0, got 1"):
        merge_picture(grid, FRAME, wavelength=1)


def test_the_sizes_are_counted():
    found = construct(grid_of(bent, n=82), FRAME, merge="heavy")
    told = sizes(found)
    assert sum(told.values()) == len(found.area)
    assert sum(size * size * many for size, many in told.items()) == len(
        construct(grid_of(bent, n=82), FRAME).area
    )


def test_refusals():
    grid = grid_of(bent, n=9)
    with pytest.raises(refuse.Refusal, match=r"'merge' must be one of .* Did you mean 'light'"):
        construct(grid, FRAME, merge="ligth")
    with pytest.raises(refuse.Refusal, match="'position' must be a finite number > 0, got 0"):
        construct(grid, FRAME, merge=Merge(position=0.0))
    with pytest.raises(refuse.Refusal, match="'steps' must be a number from 0 to 4, got 5"):
        construct(grid, FRAME, merge=Merge(steps=5))
    with pytest.raises(refuse.Refusal, match="'colours' must have a row for each of 1 sheets, got 2"):
        construct(grid, FRAME, colours=[[0], [1]])
    with pytest.raises(refuse.Refusal, match="'keep' must be one of 'crossed', 'valid'"):
        construct(grid, FRAME, keep="all")
    with pytest.raises(refuse.Refusal, match="'shape' must be an integer >= 1, got 0"):
        primitives.frame_of(flare.load("heliar_tronnier_100mm"), (0, 10))


def test_brightness_has_no_steps_between_neighbours():
    """At a node, weight over area of four cells' corners: alike to the square of a cell, not to a cell."""
    grid = grid_of(bent, n=42, rim=2.0)
    found = construct(grid, FRAME)
    assert len(found.area) == 41 * 41
    x, y = (found.corners[:, :, axis].astype(float) for axis in (0, 1))
    before, behind = np.roll(np.arange(4), 1), np.roll(np.arange(4), -1)
    own = (x - x[:, before]) * (y[:, behind] - y) - (y - y[:, before]) * (x[:, behind] - x)
    lit = (found.attributes[:, :, 0] / own).reshape(41, 41, 4)
    dark = (1.0 / own).reshape(41, 41, 4)
    steps = [np.ptp(around(told)[4:-4, 4:-4], axis=-1).max() / told.max() for told in (lit, dark)]
    assert steps[0] < 0.002 < 0.03 < steps[1]


def around(told):
    """The four cells' numbers at each inner node."""
    return np.stack([told[:-1, :-1, 2], told[:-1, 1:, 3], told[1:, 1:, 0], told[1:, :-1, 1]], axis=-1)
