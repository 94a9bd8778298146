"""The quadtree: repainting exactly, the paper's rules one by one, levels, refusals."""

import itertools
import re

import numpy as np
import pytest

from aureole import refuse
from aureole.diffraction import FINEST, difference_quads, level_mask, paint, quadtree

WIDTH = 3e-3


def listed(mask, finest="full"):
    """Return each quad as (x0, y0, x1, y1, weight) in pixels of the level."""
    size = len(level_mask(mask, finest))
    quads = quadtree(mask, float(size), finest)
    boxes = quads.rectangles + size / 2
    return sorted((*box, weight) for box, weight in zip(boxes.tolist(), quads.weights.tolist(), strict=True))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


# The rules of Scandolo, Lee and Eisemann 2018, §4.2, on one block of four.


def test_four_equal_children_merge():
    assert listed([[1, 1], [1, 1]]) == [(0, 0, 2, 2, 1)]
    assert listed([[0.5, 0.5], [0.5, 0.5]]) == [(0, 0, 2, 2, 0.5)]


@pytest.mark.parametrize(("row", "column"), list(itertools.product(range(2), range(2))))
def test_one_lit_child_is_listed_and_dark_goes_up(row, column):
    mask = np.zeros((2, 2))
    mask[row, column] = 1
    assert listed(mask) == [(column, row, column + 1, row + 1, 1)]


@pytest.mark.parametrize(
    ("mask", "box"),
    [
        ([[1, 1], [0, 0]], (0, 0, 2, 1)),
        ([[0, 0], [1, 1]], (0, 1, 2, 2)),
        ([[1, 0], [1, 0]], (0, 0, 1, 2)),
        ([[0, 1], [0, 1]], (1, 0, 2, 2)),
    ],
)
def test_two_adjacent_children_are_one_rectangle(mask, box):
    assert listed(mask) == [(*box, 1)]


@pytest.mark.parametrize(
    ("mask", "boxes"),
    [
        ([[1, 0], [0, 1]], [(0, 0, 1, 1, 1), (1, 1, 2, 2, 1)]),
        ([[0, 1], [1, 0]], [(0, 1, 1, 2, 1), (1, 0, 2, 1, 1)]),
    ],
)
def test_two_diagonal_children_are_both_listed(mask, boxes):
    assert listed(mask) == boxes


@pytest.mark.parametrize(("row", "column"), list(itertools.product(range(2), range(2))))
def test_of_three_lit_children_lit_goes_up_with_a_negative_quad(row, column):
    mask = np.ones((2, 2))
    mask[row, column] = 0
    assert listed(mask) == sorted([(0, 0, 2, 2, 1), (column, row, column + 1, row + 1, -1)])


def test_what_goes_up_merges_there():
    """Three whole blocks and a block of three lit pixels: a lit square, one dark pixel."""
    mask = np.ones((4, 4))
    mask[3, 0] = 0
    assert listed(mask) == [(0, 0, 4, 4, 1), (0, 3, 1, 4, -1)]
    # One lit pixel leaves dark going up, so three lit blocks and a dark one.
    mask = np.ones((4, 4))
    mask[2:, :2] = [[0, 0], [1, 0]]
    assert listed(mask) == [(0, 0, 4, 4, 1), (0, 2, 2, 4, -1), (0, 3, 1, 4, 1)]


def test_grey_follows_the_same_rules_with_weights():
    assert listed([[0.5, 0.5], [0.5, 0]]) == [(0, 0, 2, 2, 0.5), (1, 1, 2, 2, -0.5)]
    assert listed([[0.25, 0], [0, 0]]) == [(0, 0, 1, 1, 0.25)]
    assert listed([[1, 1], [1, 0.25]]) == [(0, 0, 2, 2, 1), (1, 1, 2, 2, -0.75)]
    # Two pairs: the darker goes up, so one rectangle is enough on top of it.
    assert listed([[0.75, 0.75], [0.25, 0.25]]) == [(0, 0, 2, 1, 0.5), (0, 0, 2, 2, 0.25)]


@pytest.mark.parametrize("block", list(itertools.product([0, 1], repeat=4)))
def test_no_block_takes_more_than_two_quads(block):
    mask = np.array(block, dtype=float).reshape(2, 2)
    assert len(listed(mask)) <= 2
    np.testing.assert_array_equal(paint(quadtree(mask, WIDTH), 2, WIDTH), mask)


def mask_of(kind, size, seed):
    rng = np.random.default_rng(seed)
    if kind == "grey":
        return rng.random((size, size))
    if kind == "few greys":
        return rng.integers(0, 3, (size, size)) / 2
    return (rng.random((size, size)) < {"binary": 0.5, "sparse": 0.05, "dense": 0.95}[kind]).astype(float)


@pytest.mark.parametrize("kind", ["binary", "sparse", "dense", "grey", "few greys"])
@pytest.mark.parametrize("finest", list(FINEST))
@pytest.mark.parametrize("size", [8, 16, 24, 40, 64, 88])
def test_painting_gives_back_the_mask(kind, finest, size):
    mask = mask_of(kind, size, size)
    quads = quadtree(mask, WIDTH, finest)
    step = FINEST[finest]
    level = mask.reshape(size // step, step, size // step, step).mean(axis=(1, 3))
    np.testing.assert_array_equal(level_mask(mask, finest), level)
    exact = 0 if kind != "grey" else 1e-14
    np.testing.assert_allclose(paint(quads, size // step, WIDTH), level, rtol=0, atol=exact)
    # On the finer grid each square of the level is painted over its own pixels.
    painted = paint(quads, size, WIDTH)
    np.testing.assert_allclose(painted, np.kron(level, np.ones((step, step))), rtol=0, atol=1e-14)


@pytest.mark.parametrize("size", [1, 2, 3, 5, 7, 9, 31, 33])
def test_any_size(size):
    for seed in range(3):
        mask = mask_of("few greys", size, seed)
        quads = quadtree(mask, WIDTH)
        assert np.isfinite(quads.rectangles).all()
        assert np.all(quads.weights != 0)
        assert np.all(quads.rectangles[:, :2] < quads.rectangles[:, 2:])
        np.testing.assert_array_equal(paint(quads, size, WIDTH), mask)


@pytest.mark.parametrize("size", [1, 4, 5])
def test_an_empty_mask_has_no_quads(size):
    quads = quadtree(np.zeros((size, size)), WIDTH)
    assert len(quads) == 0
    assert quads.rectangles.shape == (0, 4)
    np.testing.assert_array_equal(paint(quads, size, WIDTH), np.zeros((size, size)))


def test_a_full_mask_is_one_quad():
    for size in (1, 2, 64):
        quads = quadtree(np.ones((size, size)), WIDTH)
        np.testing.assert_allclose(quads.rectangles, [[-WIDTH / 2, -WIDTH / 2, WIDTH / 2, WIDTH / 2]])
        np.testing.assert_array_equal(quads.weights, [1.0])


def test_quads_are_fewer_than_pixels():
    rows, columns = np.mgrid[:256, :256] - 127.5
    disc = (np.hypot(rows, columns) < 100).astype(float)
    assert len(quadtree(disc, WIDTH)) < disc.sum() / 50
    # And no more than a quad for each pair of pixels, whatever the mask.
    assert len(quadtree(mask_of("binary", 64, 1), WIDTH)) < 64 * 64 / 2


def test_weights_times_areas_add_up_to_the_mask():
    mask = mask_of("grey", 32, 3)
    quads = quadtree(mask, WIDTH)
    x0, y0, x1, y1 = quads.rectangles.T
    total = np.sum(quads.weights * (x1 - x0) * (y1 - y0))
    assert total == pytest.approx(mask.mean() * WIDTH**2, rel=1e-12)


def merged(mask, finest="full"):
    size = len(level_mask(mask, finest))
    quads = quadtree(mask, float(size), finest, merge=True)
    boxes = quads.rectangles + size / 2
    return sorted((*box, weight) for box, weight in zip(boxes.tolist(), quads.weights.tolist(), strict=True))


def test_rectangles_merge_across_levels():
    """§7: a square of two pixels and one pixel below it on either side are a column each."""
    mask = np.zeros((8, 8))
    mask[2:5, 2:4] = 1
    assert len(listed(mask)) == 2
    assert merged(mask) == [(2, 2, 4, 5, 1)]
    # Over the tree's own middle, where no level could merge.
    mask = np.zeros((8, 8))
    mask[1:7, 3:5] = 1
    assert len(listed(mask)) > 1
    assert merged(mask) == [(3, 1, 5, 7, 1)]


def test_a_negative_quad_cuts_what_it_covers():
    mask = np.ones((2, 2))
    mask[1, 1] = 0
    # It shares no whole side: three lit pixels stay two rectangles.
    assert merged(mask) == listed(mask)
    assert merged([[1, 1, 1, 0]] * 4) == [(0, 0, 3, 4, 1)]


def test_only_equal_weights_merge():
    assert merged([[1, 0.5], [0, 0]]) == [(0, 0, 1, 1, 1), (1, 0, 2, 1, 0.5)]


@pytest.mark.parametrize("kind", ["binary", "sparse", "dense", "grey", "few greys"])
@pytest.mark.parametrize("finest", list(FINEST))
@pytest.mark.parametrize("size", [8, 24, 64, 88])
def test_merging_keeps_the_mask_and_never_adds_quads(kind, finest, size):
    mask = mask_of(kind, size, size)
    quads = quadtree(mask, WIDTH, finest, merge=True)
    assert len(quads) <= len(quadtree(mask, WIDTH, finest))
    assert np.all(quads.weights != 0)
    assert np.all(quads.rectangles[:, :2] < quads.rectangles[:, 2:])
    exact = 0 if kind != "grey" else 1e-14
    level = level_mask(mask, finest)
    np.testing.assert_allclose(paint(quads, len(level), WIDTH), level, rtol=0, atol=exact)


@pytest.mark.parametrize("size", [1, 4])
def test_merging_nothing(size):
    assert len(quadtree(np.zeros((size, size)), WIDTH, merge=True)) == 0
    assert len(quadtree(np.ones((size, size)), WIDTH, merge=True)) == 1


def test_merging_takes_a_quarter_off_a_disc():
    rows, columns = np.mgrid[:256, :256] - 127.5
    disc = (np.hypot(rows, columns) < 100).astype(float)
    assert len(quadtree(disc, WIDTH, merge=True)) < 0.8 * len(quadtree(disc, WIDTH))


def test_a_photograph_takes_a_quad_for_each_pixel():
    """§7: natural images are where quads lose; memory stays in proportion to the pixels."""
    noise = np.random.default_rng(2).random((1024, 1024), dtype=np.float32)
    quads = quadtree(noise, WIDTH)
    assert 0.9 * noise.size < len(quads) <= noise.size
    np.testing.assert_allclose(paint(quads, 1024, WIDTH), noise, rtol=0, atol=1e-9)


def test_kinds_of_masks():
    for kind in (bool, np.float32, int):
        assert listed(np.eye(2, dtype=kind)) == [(0, 0, 1, 1, 1), (1, 1, 2, 2, 1)]


@pytest.mark.parametrize(
    ("mask", "finest", "message"),
    [
        (np.ones((2, 3)), "full", "'mask' must be square, got 2 x 3 pixels."),
        (
            np.ones((6, 6)),
            "quarter",
            "'mask' must be square, its side a multiple of 4 for 'quarter', got 6 x 6 pixels.",
        ),
        (
            np.ones((4, 8)),
            "half",
            "'mask' must be square, its side a multiple of 2 for 'half', got 4 x 8 pixels.",
        ),
        (
            np.ones((4, 4)),
            "eighth",
            "'mask' must be square, its side a multiple of 8 for 'eighth', got 4 x 4 pixels.",
        ),
        (
            np.ones((4, 4)),
            "quater",
            "'finest' must be one of 'full', 'half', 'quarter', 'eighth', got 'quater'. "
            "Did you mean 'quarter'?",
        ),
        (np.ones(4), "full", "'mask' must be an array of shape (any, any), got (4,)."),
        (np.ones((0, 0)), "full", "'mask' must be an array of shape (any, any), got (0, 0)."),
        ([[1, np.nan], [0, 0]], "full", "'mask' must hold finite numbers, got 1 that are NaN or infinite."),
    ],
)
def test_masks_refused(mask, finest, message):
    with refused(message):
        quadtree(mask, WIDTH, finest)


def test_widths_refused():
    with refused("'width' must be a finite number > 0, got 0."):
        quadtree(np.ones((2, 2)), 0)


@pytest.mark.parametrize("finest", ["full", "half"])
@pytest.mark.parametrize("merge", [False, True])
def test_a_difference_is_what_it_opens_less_what_it_covers(finest, merge):
    before, after = mask_of("binary", 32, 1), mask_of("binary", 32, 2)
    opened, covered = difference_quads(after - before, WIDTH, finest, merge)
    size = len(level_mask(before, finest))
    painted = [paint(quads, size, WIDTH) for quads in (opened, covered)]
    np.testing.assert_allclose(painted[0], level_mask(np.maximum(after - before, 0), finest), atol=1e-12)
    np.testing.assert_allclose(painted[1], level_mask(np.maximum(before - after, 0), finest), atol=1e-12)


def test_a_difference_of_one_pixel_is_one_quad():
    difference = np.zeros((8, 8))
    difference[2, 5] = -1
    opened, covered = difference_quads(difference, WIDTH)
    assert (len(opened), len(covered)) == (0, 1)
    assert covered.weights[0] == 1
