"""A mask as its distinct lines, and the far field from them."""

import numpy as np
import pytest

from aureole import Grid, aperture, refuse
from aureole.diffraction import METHODS, far_field
from aureole.diffraction.rows import factor, rows_field, rows_power, sample
from aureole.records import Aperture

WIDTH = 2e-3
RELATIVE = 5e-7  # error over the peak
GRIDS = [
    Grid((24, 24), (1 / WIDTH, 1 / WIDTH)),
    Grid((23, 30), (0.37 / WIDTH, 2.1 / WIDTH)),
    Grid((24, 17), (0.9 / WIDTH, 0.9 / WIDTH), (3.3 / WIDTH, 0.0)),
    Grid((13, 18), (0.9 / WIDTH, 0.4 / WIDTH), (0.0, -7.7 / WIDTH)),
    Grid((12, 13), (0.9 / WIDTH, 0.4 / WIDTH), (-1.1 / WIDTH, 5.2 / WIDTH)),
]
SHAPES = {
    "circle": aperture.circle(WIDTH / 2),
    "box": aperture.rectangle(WIDTH, WIDTH / 3),
    "heptagon": aperture.iris(7, WIDTH),
    "whirl": aperture.whirl(WIDTH),
}


def raster(name, size):
    return Aperture(WIDTH, mask=aperture.rasterize(Aperture(WIDTH, SHAPES[name].outlines), size))


def unfolded(factors, size):
    """Paint a mask back from its factors."""
    half, first = (size + 1) // 2, size // 2
    mask = np.zeros((size, size))
    for each in factors:
        lines = np.vstack([each.lines, np.zeros(half)])[each.labels]
        quadrant = lines if each.by_rows else lines.T
        for sign_y in (1, -1):
            for sign_x in (1, -1):
                sign = sign_y ** each.odd[0] * sign_x ** each.odd[1]
                rows = first + np.arange(half) if sign_y > 0 else size - 1 - first - np.arange(half)
                columns = first + np.arange(half) if sign_x > 0 else size - 1 - first - np.arange(half)
                weight = np.where(rows == size - 1 - rows, 0.5, 1)[:, None]
                weight = weight * np.where(columns == size - 1 - columns, 0.5, 1)
                mask[np.ix_(rows, columns)] += sign * weight * quadrant / 4
    return mask


@pytest.mark.parametrize("size", [1, 2, 7, 20, 33])
def test_factors_paint_the_mask_back(size):
    rng = np.random.default_rng(size)
    noise = rng.random((size, size)).astype(np.float32)
    sparse = noise * (rng.random((size, size)) < 0.1)
    for mask in (noise, sparse, np.round(noise)):
        np.testing.assert_allclose(unfolded(factor(mask), size), mask, rtol=0, atol=3e-7)


@pytest.mark.parametrize("size", [40, 41])
def test_mirror_symmetry_leaves_parts_out(size):
    parts = {name: [each.odd for each in factor(raster(name, size).mask)] for name in SHAPES}
    assert parts["circle"] == parts["box"] == [(0, 0)]
    assert parts["heptagon"] == [(0, 0), (0, 1)]
    assert parts["whirl"] == [(0, 0), (0, 1), (1, 0), (1, 1)]


def test_a_part_below_rounding_is_left_out():
    mask = np.ones((8, 8), dtype=np.float32)
    mask[0, 0] += 1.2e-7
    assert [each.odd for each in factor(mask)] == [(0, 0)]


def test_equal_lines_are_one():
    stripes = np.tile(np.arange(16, dtype=np.float32) % 3, (16, 1))
    for mask in (stripes, np.ascontiguousarray(stripes.T)):
        assert all(len(each.lines) == 1 for each in factor(mask))
    # A single lit column has as many distinct rows as it has values, and one distinct column.
    column = np.zeros((16, 16), dtype=np.float32)
    column[:, 5] = np.linspace(0.1, 1, 16)
    assert all(len(each.lines) == 1 and not each.by_rows for each in factor(column))


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("size", [32, 45])
@pytest.mark.parametrize("grid", GRIDS)
def test_field_and_power_agree_with_the_reference(name, size, grid):
    shape = raster(name, size)
    peak = aperture.area(shape)
    wanted = far_field(shape, grid, "reference").amplitude
    np.testing.assert_allclose(rows_field(shape, grid), wanted, rtol=0, atol=RELATIVE * peak)
    power = rows_power(shape, grid)
    assert power.dtype == np.float32
    np.testing.assert_allclose(power, np.abs(wanted) ** 2, rtol=0, atol=2 * RELATIVE * peak**2)


@pytest.mark.parametrize("size", [256, 257])
def test_a_sample_guesses_symmetry_and_distinct_lines(size):
    half = size // 2
    quadrants, lines = zip(*(sample(raster(name, size).mask) for name in SHAPES), strict=True)
    assert quadrants == (1, 1, 2, 4)
    assert lines[1] <= half // 8  # the box
    for name, guessed in zip(SHAPES, lines, strict=True):
        found = max(len(each.lines) for each in factor(raster(name, size).mask))
        assert guessed <= 2 * found + half // 8
    # Stripes either way have few distinct lines.
    stripes = np.tile(np.arange(size, dtype=np.float32) % 3, (size, 1))
    assert sample(stripes)[1] <= half // 8
    assert sample(np.ascontiguousarray(stripes.T))[1] <= half // 8
    noise = np.random.default_rng(2).random((size, size), dtype=np.float32)
    assert sample(noise) == (4, (size + 1) // 2)


def test_factors_may_be_given():
    shape = raster("whirl", 30)
    found = rows_field(shape, GRIDS[1], factors=factor(shape.mask))
    np.testing.assert_array_equal(found, rows_field(shape, GRIDS[1]))


def test_centred_grids_are_hermitian():
    field = rows_field(raster("whirl", 31), Grid((17, 19), (1 / WIDTH, 1 / WIDTH)))
    np.testing.assert_array_equal(field, field[::-1, ::-1].conj())


def test_outlines_are_refused():
    with pytest.raises(refuse.Refusal, match="needs a raster; rasterize the outlines first"):
        rows_field(aperture.circle(WIDTH), GRIDS[0])


@pytest.mark.parametrize(
    ("size", "grid", "wanted"),
    [
        (64, Grid((512, 512), (1.0, 1.0)), "fft"),
        (64, Grid((512, 512), (0.7, 0.7)), "rows"),
        (300, Grid((8, 8), (1.0, 1.0)), "fft"),
    ],
)
def test_auto_weighs_rows_against_its_rivals(size, grid, wanted, monkeypatch):
    taken = []
    for name in ("rows", "fft", "chirpz"):
        monkeypatch.setitem(METHODS, name, lambda a, g, n=name: taken.append(n))
    far_field(Aperture(1.0, mask=np.ones((size, size), dtype=np.float32)), grid)
    assert taken == [wanted]


def test_auto_looks_at_the_mask_where_that_decides(monkeypatch):
    """Few distinct rows go to 'rows', noise of the same size to its rival."""
    taken = []
    monkeypatch.setitem(METHODS, "rows", lambda a, g, factors: taken.append(len(factors)))
    for name in ("fft", "chirpz"):
        monkeypatch.setitem(METHODS, name, lambda a, g, n=name: taken.append(n))
    noise = np.random.default_rng(1).random((1024, 1024), dtype=np.float32)
    grid = Grid((1024, 1024), (0.25, 0.25))
    far_field(Aperture(1.0, mask=np.ones_like(noise)), grid)
    far_field(Aperture(1.0, mask=noise), grid)
    assert taken == [1, "fft"]
