"""Masks: exact coverage against brute force, exact areas, round trips, pictures, refusals."""

import math
import re

import numpy as np
import pytest
import shapely

from aureole import Outline, Picture, aperture, refuse
from aureole.records import Aperture

SUPERSAMPLES = 64
SHAPES = {
    "circle": aperture.circle(2.0),
    "heptagon": aperture.iris(7, 2.0, rotation=0.2),
    "rounded": aperture.iris(5, 2.0, 0.6, 0.4),
    "rectangle": aperture.rectangle(1.9, 0.37),
    "whirl": aperture.whirl(2.0, 5, 0.1),
    "off": aperture.polygon([(0.11, 0.2), (0.93, -0.3), (0.5, 0.99)]),
}
ON_SHAPES = pytest.mark.parametrize("name", list(SHAPES))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def inside(name, x, y):
    """Ask point by point, by the shape's own definition."""
    if name == "circle":
        return x**2 + y**2 < 1
    if name == "rounded":
        # Within the polygon, or within the circle of a blade beyond its side.
        ring = SHAPES[name].outlines[0]
        found = shapely.contains_xy(shapely.Polygon(ring.vertices), x, y)
        for start, end in zip(ring.vertices, np.roll(ring.vertices, -1, axis=0), strict=True):
            middle = (start + end) / 2
            outward = middle / np.hypot(*middle)
            blade = 1 / 0.6
            centre = outward * (np.hypot(*middle) - math.sqrt(blade**2 - np.sum((end - start) ** 2) / 4))
            beyond = x * outward[0] + y * outward[1] > np.hypot(*middle)
            found |= beyond & (np.hypot(x - centre[0], y - centre[1]) < blade)
        return found
    return shapely.contains_xy(shapely.Polygon(SHAPES[name].outlines[0].vertices), x, y)


@ON_SHAPES
@pytest.mark.parametrize("size", [1, 2, 9, 12])
def test_coverage_against_supersampling(name, size):
    shape = SHAPES[name]
    count = size * SUPERSAMPLES
    at = ((np.arange(count) + 0.5) / count - 0.5) * shape.width
    x, y = np.meshgrid(at, at)
    blocks = inside(name, x, y).reshape(size, SUPERSAMPLES, size, SUPERSAMPLES)
    mask = aperture.rasterize(shape, size)
    assert mask.shape == (size, size)
    assert mask.dtype == np.float32
    # A straight edge across a pixel of 64² samples is counted to within about a sample a row.
    np.testing.assert_allclose(mask, blocks.mean(axis=(1, 3)), rtol=0, atol=1.5 / SUPERSAMPLES)


@pytest.mark.parametrize("name", ["heptagon", "rectangle", "off", "whirl"])
@pytest.mark.parametrize("size", [7, 10])
def test_coverage_is_the_area_of_each_pixel_cut_by_the_shape(name, size):
    shape = SHAPES[name]
    polygon = shapely.Polygon(shape.outlines[0].vertices)
    edges = np.linspace(-0.5, 0.5, size + 1) * shape.width
    pixels = [
        shapely.box(edges[column], edges[row], edges[column + 1], edges[row + 1])
        for row in range(size)
        for column in range(size)
    ]
    cut = shapely.area(shapely.intersection(polygon, np.array(pixels))).reshape(size, size)
    np.testing.assert_allclose(
        aperture.rasterize(shape, size), cut * (size / shape.width) ** 2, rtol=0, atol=1e-6
    )


@ON_SHAPES
@pytest.mark.parametrize("size", [1, 2, 31, 64])
def test_the_mask_keeps_the_area(name, size):
    shape = SHAPES[name]
    pixel = shape.width / size
    total = aperture.rasterize(shape, size).sum(dtype=float) * pixel**2
    # Chords within arcs stray by less than 1e-4 of a pixel; the rest is float32.
    arcs = shape.outlines[0].bulges.any()
    perimeter = shapely.Polygon(aperture.chords(shape.outlines[0], 1e-4)).length
    missing = aperture.area(shape) - total
    assert -1e-6 < missing < 1e-6 + arcs * 1e-4 * pixel * perimeter


def test_the_winding_does_not_matter():
    ring = SHAPES["rounded"].outlines[0]
    turned = Outline(ring.vertices[::-1].copy(), -np.roll(ring.bulges[::-1], -1))
    one, other = (aperture.rasterize(Aperture(2.0, (r,)), 33) for r in (ring, turned))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-6)


def test_pixel_edges_on_shape_edges_leave_nothing_grey():
    mask = aperture.rasterize(aperture.rectangle(4.0, 2.0), 8)
    wanted = np.zeros((8, 8))
    wanted[2:6] = 1
    np.testing.assert_array_equal(mask, wanted)


def test_parts_outside_the_square_are_cut_off():
    """On every side, also where an edge leaves through a corner."""
    ring = aperture.iris(4, 3.0, rotation=0.1).outlines[0]
    mask = aperture.rasterize(Aperture(1.6, (ring,)), 16)
    cut = shapely.Polygon(ring.vertices).intersection(shapely.box(-0.8, -0.8, 0.8, 0.8)).area
    assert mask.sum(dtype=float) * 0.01 == pytest.approx(cut, rel=1e-6)
    assert mask[8, 0] == mask[8, 15] == mask[0, 8] == mask[15, 8] == 1
    beside = aperture.moved(aperture.circle(0.5), 3.0, 0.0).outlines[0]
    for turn in (beside.vertices, beside.vertices[:, ::-1], -beside.vertices, -beside.vertices[:, ::-1]):
        far = Outline(np.ascontiguousarray(turn), np.ones(2))
        assert aperture.rasterize(Aperture(1.6, (far,)), 16).max() == 0


@ON_SHAPES
def test_pixels_off_the_edge_are_exactly_dark_or_lit(name):
    """No rounding that would look like an edge to the quadtree."""
    shape, size = SHAPES[name], 61
    edge = shapely.Polygon(aperture.chords(shape.outlines[0], 1e-7)).exterior
    at = (np.arange(size) + 0.5 - size / 2) * shape.width / size
    distance = shapely.distance(edge, shapely.points(*np.meshgrid(at, at)))
    mask = aperture.rasterize(shape, size)[distance > 0.72 * shape.width / size]
    assert set(np.unique(mask)) == {0.0, 1.0}


def test_mirror_symmetry():
    for size in (32, 33):
        mask = aperture.rasterize(aperture.circle(1.0), size)
        for same in (mask.T, mask[::-1], mask[:, ::-1]):
            np.testing.assert_allclose(mask, same, rtol=0, atol=1e-4)


def test_round_trip():
    mask = np.random.default_rng(4).random((9, 9)).astype(np.float32)
    made = aperture.from_mask(mask, 3e-3)
    np.testing.assert_array_equal(aperture.rasterize(made, 9), mask)
    assert made.width == 3e-3
    assert made.outlines == ()
    assert aperture.area(made) == pytest.approx(mask.mean(dtype=float) * 9e-6, rel=1e-12)
    assert aperture.energy(made) == pytest.approx(np.mean(mask.astype(float) ** 2) * 9e-6, rel=1e-12)


def test_the_mask_is_copied():
    mask = np.ones((4, 4), dtype=np.float32)
    made = aperture.from_mask(mask, 1.0)
    mask[:] = 0
    assert made.mask.min() == 1
    again = aperture.rasterize(made, 4)
    again[:] = 0
    assert made.mask.min() == 1


def test_kinds_of_masks():
    for mask in (
        np.eye(3, dtype=bool),
        np.eye(3, dtype=int),
        np.eye(3).tolist(),
        np.asfortranarray(np.eye(3)),
    ):
        made = aperture.from_mask(mask, 1.0)
        np.testing.assert_array_equal(made.mask, np.eye(3))
        assert made.mask.dtype == np.float32
        assert made.mask.flags.c_contiguous


def test_resampling_repeats_and_averages():
    mask = np.random.default_rng(5).random((6, 6))
    made = aperture.from_mask(mask, 1.0)
    twice = aperture.rasterize(made, 12)
    np.testing.assert_allclose(twice, np.kron(mask, np.ones((2, 2))), rtol=0, atol=1e-6)
    third = aperture.rasterize(made, 2)
    np.testing.assert_allclose(third, mask.reshape(2, 3, 2, 3).mean(axis=(1, 3)), rtol=0, atol=1e-6)
    for size in (1, 5, 7, 64):
        assert aperture.rasterize(made, size).mean(dtype=float) == pytest.approx(mask.mean(), rel=1e-6)


def picture(pixels):
    return Picture(np.asarray(pixels, dtype=np.float32))


def test_from_picture_takes_the_luminance():
    """Weights of Rec.709: 0.2126, 0.7152, 0.0722 (ITU-R BT.709)."""
    pixels = np.zeros((2, 2, 3))
    pixels[0, 0], pixels[0, 1], pixels[1, 0], pixels[1, 1] = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)
    made = aperture.from_picture(picture(pixels), 2e-3)
    np.testing.assert_allclose(made.mask, [[0.2126, 0.7152], [0.0722, 1]], rtol=1e-6)
    assert made.width == 2e-3


def test_from_picture_of_one_channel_or_with_alpha():
    grey = np.array([[0.25, 1.0], [0.0, 0.5]])
    np.testing.assert_allclose(aperture.from_picture(picture(grey[..., None]), 1.0).mask, grey)
    four = np.concatenate([np.repeat(grey[..., None], 3, axis=2), np.zeros((2, 2, 1))], axis=2)
    np.testing.assert_allclose(aperture.from_picture(picture(four), 1.0).mask, grey, rtol=1e-6)


def test_from_picture_scales_what_is_brighter_than_one_and_clips_what_is_negative():
    grey = np.array([[-1.0, 4.0], [1.0, 2.0]])[..., None]
    np.testing.assert_allclose(aperture.from_picture(picture(grey), 1.0).mask, [[0, 1], [0.25, 0.5]])
    dim = np.array([[0.0, 0.5], [0.1, 0.2]])[..., None]
    np.testing.assert_allclose(aperture.from_picture(picture(dim), 1.0).mask, dim[..., 0])


@pytest.mark.parametrize("shape", [(2, 5), (5, 2), (4, 5), (1, 4)])
def test_a_picture_that_is_not_square_is_centred_on_a_dark_square(shape):
    made = aperture.from_picture(picture(np.ones((*shape, 1))), 1.0)
    side = max(shape)
    assert made.mask.shape == (side, side)
    assert made.mask.sum() == shape[0] * shape[1]
    rows, columns = np.flatnonzero(made.mask.any(axis=1)), np.flatnonzero(made.mask.any(axis=0))
    # The dark borders differ by at most the one pixel that cannot be shared.
    assert 0 <= (side - 1 - rows[-1]) - rows[0] <= 1
    assert 0 <= (side - 1 - columns[-1]) - columns[0] <= 1


@pytest.mark.parametrize(
    ("mask", "message"),
    [
        (np.ones((2, 3)), "'mask' must be square, got 2 x 3 pixels."),
        (np.ones(4), "'mask' must be an array of shape (any, any), got (4,)."),
        (np.ones((0, 0)), "'mask' must be an array of shape (any, any), got (0, 0)."),
        (np.zeros((2, 2)), "'mask' must let some light through, got zero everywhere."),
        ([[0, 1.5], [0, 0]], "'mask' must hold values from 0 to 1, got 0 to 1.5."),
        ([[0, 0.5], [-0.25, 0]], "'mask' must hold values from 0 to 1, got -0.25 to 0.5."),
        ([[0, math.nan], [1, 0]], "'mask' must hold finite numbers, got 1 that are NaN or infinite."),
        ([["a", "b"], ["c", "d"]], "'mask' must hold real numbers, got values of type <U1."),
    ],
)
def test_masks_refused(mask, message):
    with refused(message):
        aperture.from_mask(mask, 1.0)


def test_other_refusals():
    with refused("'width' must be a finite number > 0, got -1."):
        aperture.from_mask(np.ones((2, 2)), -1)
    with refused("'mask' must let some light through, got zero everywhere."):
        aperture.from_picture(picture(np.zeros((2, 2, 3))), 1.0)
    for size, shown in ((0, "0"), (2.5, "2.5"), ("8", "'8'")):
        with refused(f"'size' must be an integer >= 1, got {shown}."):
            aperture.rasterize(aperture.circle(1.0), size)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_pictures_with_nan_or_infinity_are_refused(bad):
    pixels = np.ones((2, 2, 3))
    pixels[0, 1, 2] = bad
    with refused("'picture' must hold finite numbers, got 1 that are NaN or infinite."):
        aperture.from_picture(picture(pixels), 1.0)
