"""Composition: areas by inclusion and exclusion, De Morgan, outlines against rasters, refusals."""

import math
import re

import numpy as np
import pytest

from aureole import aperture, refuse

PAIRS = {
    "crossing": (aperture.iris(5, 2.0), aperture.moved(aperture.circle(1.2), 0.7, 0.3)),
    "arcs crossing": (aperture.iris(6, 2.0, 0.5), aperture.moved(aperture.iris(3, 1.5, 0.9), -0.5, 0.4)),
    "nested": (aperture.circle(2.0), aperture.iris(4, 1.0, 0.3, 0.2)),
    "apart": (
        aperture.moved(aperture.circle(0.6), -0.5, 0.0),
        aperture.moved(aperture.circle(0.6), 0.5, 0.2),
    ),
    "with a hole": (
        aperture.subtraction(aperture.circle(2.0), aperture.circle(0.8)),
        aperture.rectangle(0.6, 2.0),
    ),
    "grey": (aperture.dimmed(aperture.iris(7, 2.0), 0.5), aperture.dimmed(aperture.rectangle(1.0, 0.7), 0.8)),
}
ON_PAIRS = pytest.mark.parametrize("pair", list(PAIRS))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def areas(*apertures):
    return [aperture.area(one) for one in apertures]


def lens_area(radius, other, distance):
    """Area that two circles share (Weisstein, MathWorld, "Circle-Circle Intersection", Eq. 14)."""
    r, s, d = radius, other, distance
    return (
        r**2 * math.acos((d**2 + r**2 - s**2) / (2 * d * r))
        + s**2 * math.acos((d**2 + s**2 - r**2) / (2 * d * s))
        - math.sqrt((-d + r + s) * (d + r - s) * (d - r + s) * (d + r + s)) / 2
    )


@pytest.mark.parametrize("pair", [name for name in PAIRS if name != "apart"])
def test_inclusion_and_exclusion(pair):
    """With transmittances a and b: ∫ (a + b − ab), and ∫ a (1 − b)."""
    first, second = PAIRS[pair]
    one, other = areas(first, second)
    both = aperture.area(aperture.intersection(first, second))
    assert aperture.area(aperture.union(first, second)) == pytest.approx(one + other - both, rel=1e-12)
    assert aperture.area(aperture.subtraction(first, second)) == pytest.approx(one - both, rel=1e-12)
    assert aperture.area(aperture.intersection(second, first)) == pytest.approx(both, rel=1e-12)


def test_two_circles():
    first = aperture.circle(2.0)
    second = aperture.moved(aperture.circle(1.4), 0.9, 0.5)
    shared = aperture.area(aperture.intersection(first, second))
    # Arcs that cross become chords that stray by less than 1e-7 of the width.
    assert shared == pytest.approx(lens_area(1.0, 0.7, math.hypot(0.9, 0.5)), abs=1e-6)
    apart = aperture.union(*PAIRS["apart"])
    assert aperture.area(apart) == pytest.approx(2 * math.pi * 0.09, rel=1e-12)
    whole = aperture.subtraction(*PAIRS["apart"])
    assert aperture.area(whole) == pytest.approx(math.pi * 0.09, rel=1e-12)


def bar(left):
    return aperture.polygon([[left, -2.0], [2.0, -2.0], [2.0, 2.0], [left, 2.0]])


def test_borders_that_cancel_are_no_borders():
    """A bar over all but a corner of a triangle leaves a triangle, not the whole less nearly the whole."""
    whole = aperture.polygon([[-1.0, 0.0], [1.0, -1.0], [1.0, 1.0]])
    left = aperture.subtraction(whole, bar(-0.9))
    assert [len(ring.vertices) for ring in left.outlines] == [3]
    found = sorted(map(tuple, left.outlines[0].vertices.round(9)))
    assert found == [(-1.0, 0.0), (-0.9, -0.05), (-0.9, 0.05)]
    assert aperture.area(left) == pytest.approx(0.1 * 0.1 / 2, rel=1e-9)


def test_bars_that_overlap_leave_what_neither_covers():
    square = aperture.rectangle(1.0, 1.0)
    tall, wide = aperture.rectangle(0.2, 1.5), aperture.rectangle(1.5, 0.2)
    left = aperture.subtraction(aperture.subtraction(square, tall), wide)
    assert [len(ring.vertices) for ring in left.outlines] == [4, 4, 4, 4]
    assert aperture.area(left) == pytest.approx(4 * 0.4**2, rel=1e-9)
    joined = aperture.union(tall, wide)
    assert [len(ring.vertices) for ring in joined.outlines] == [12]
    assert aperture.area(joined) == pytest.approx(2 * 0.3 - 0.04, rel=1e-9)


def test_glass_keeps_its_own_rings():
    """Half of the light through half of the square: two rings, whose weights no single ring has."""
    half = aperture.dimmed(bar(0.0), 0.5)
    left = aperture.subtraction(aperture.rectangle(1.0, 1.0), half)
    assert sorted(ring.transmittance for ring in left.outlines) == [-0.5, 1.0]
    assert aperture.area(left) == pytest.approx(0.75, rel=1e-12)


def test_annulus():
    ring = aperture.subtraction(aperture.circle(2.0), aperture.circle(0.8))
    assert ring.width == 2.0
    assert aperture.area(ring) == pytest.approx(math.pi * (1 - 0.16), rel=1e-12)
    assert aperture.energy(ring) == pytest.approx(math.pi * (1 - 0.16), rel=1e-12)
    assert [aperture.as_circle(r).radius for r in ring.outlines] == [1.0, 0.4]
    mask = aperture.rasterize(ring, 64)
    assert mask[32, 32] == 0
    assert mask[32, 50] == 1
    wheel = aperture.union(ring, aperture.circle(0.8))
    assert aperture.area(wheel) == pytest.approx(math.pi, rel=1e-12)


def test_a_shape_within_itself_is_itself():
    for shape in (aperture.circle(1.0), aperture.iris(6, 1.0, 0.4), aperture.rectangle(1.0, 0.3)):
        area = aperture.area(shape)
        assert aperture.area(aperture.intersection(shape, shape)) == pytest.approx(area, rel=1e-12)
        assert aperture.area(aperture.union(shape, shape)) == pytest.approx(area, rel=1e-12)


def test_a_bar_that_cuts_an_opening_in_two():
    opening, bar = aperture.rectangle(2.0, 1.0), aperture.rectangle(0.25, 3.0)
    cut = aperture.subtraction(opening, bar)
    assert aperture.area(cut) == pytest.approx(1.75, rel=1e-12)
    mask = aperture.rasterize(cut, 16)
    np.testing.assert_allclose(mask[8], [1] * 7 + [0] * 2 + [1] * 7, atol=1e-6)
    assert cut.width == 2.0


@ON_PAIRS
@pytest.mark.parametrize("size", [48, 49])
def test_outlines_agree_with_rasters(pair, size):
    """Where at most one shape has an edge in a pixel, the product of means is the mean of products.

    An arc may stray by 1e-4 of a pixel, and by less where a crossing has cut it.
    """
    first, second = PAIRS[pair]
    width = max(first.width, second.width)
    full = aperture.rectangle(width, width)
    masks = [aperture.rasterize(aperture.intersection(full, a), size).astype(float) for a in (first, second)]
    levels = [max(ring.transmittance for ring in a.outlines) for a in (first, second)]
    edged = [(mask > 1e-5) & (mask < level * (1 - 1e-5)) for mask, level in zip(masks, levels, strict=True)]
    clear = ~(edged[0] & edged[1])
    assert clear.mean() > 0.9
    a, b = masks
    for make, wanted in (
        (aperture.union, a + b - a * b),
        (aperture.intersection, a * b),
        (aperture.subtraction, a * (1 - b)),
    ):
        if pair == "apart" and make is aperture.intersection:
            continue
        whole = aperture.intersection(full, make(first, second))
        found = aperture.rasterize(whole, size)
        np.testing.assert_allclose(found[clear], wanted[clear], rtol=0, atol=2e-4)


def test_transmittances_multiply():
    first = aperture.dimmed(aperture.rectangle(4.0, 4.0), 0.5)
    second = aperture.dimmed(aperture.rectangle(2.0, 4.0), 0.8)
    columns = {
        aperture.union: [0.5, 1 - 0.5 * 0.2, 1 - 0.5 * 0.2, 0.5],
        aperture.intersection: [0, 0.4, 0.4, 0],
        aperture.subtraction: [0.5, 0.5 * 0.2, 0.5 * 0.2, 0.5],
    }
    for make, wanted in columns.items():
        mask = aperture.rasterize(make(first, second), 4)
        np.testing.assert_allclose(mask, [wanted] * 4, rtol=0, atol=1e-6)
        rasters = [aperture.from_mask(aperture.rasterize(a, 4), 4.0) for a in (first, first)]
        assert rasters[0].mask.max() == 0.5
        energy = 4 * np.sum(np.square(wanted))
        assert aperture.energy(make(first, second)) == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize(
    ("pair", "make"),
    [
        (pair, make)
        for pair in PAIRS
        for make in (aperture.union, aperture.intersection, aperture.subtraction)
        if (pair, make) != ("apart", aperture.intersection)  # which is refused, since nothing is left
    ],
)
def test_energy_against_a_fine_raster(pair, make):
    first, second = PAIRS[pair]
    made = make(first, second)
    fine = aperture.from_mask(aperture.rasterize(made, 600), made.width)
    # Edge pixels hold the square of their mean, which is at most the mean of their squares.
    assert aperture.energy(made) == pytest.approx(aperture.energy(fine), rel=1e-2)
    assert aperture.energy(made) > aperture.energy(fine) * (1 - 1e-6)


def test_energy_of_dimmed_and_overlapping():
    heptagon = aperture.iris(7, 2.0)
    half = aperture.dimmed(heptagon, 0.5)
    assert aperture.energy(half) == pytest.approx(aperture.energy(heptagon) / 4, rel=1e-12)
    assert aperture.area(half) == pytest.approx(aperture.area(heptagon) / 2, rel=1e-12)
    assert aperture.energy(heptagon) == pytest.approx(aperture.area(heptagon), rel=1e-12)


def raster(mask, width=1.0):
    return aperture.from_mask(mask, width)


def test_de_morgan_on_rasters():
    rng = np.random.default_rng(6)
    for a, b in (rng.random((2, 8, 8)), rng.integers(0, 2, (2, 8, 8)).astype(float)):
        neither = aperture.intersection(raster(1 - a), raster(1 - b)).mask
        np.testing.assert_allclose(1 - aperture.union(raster(a), raster(b)).mask, neither, atol=1e-6)
        not_both = aperture.union(raster(1 - a), raster(1 - b)).mask
        np.testing.assert_allclose(1 - aperture.intersection(raster(a), raster(b)).mask, not_both, atol=1e-6)
        without = aperture.intersection(raster(a), raster(1 - b)).mask
        np.testing.assert_allclose(aperture.subtraction(raster(a), raster(b)).mask, without, atol=1e-6)


def test_a_raster_with_outlines():
    dots = np.random.default_rng(7).random((32, 32))
    made = aperture.intersection(raster(dots, 2.0), aperture.circle(2.0))
    np.testing.assert_allclose(made.mask, dots * aperture.rasterize(aperture.circle(2.0), 32), atol=1e-6)
    turned = aperture.intersection(aperture.circle(2.0), raster(dots, 2.0))
    np.testing.assert_allclose(turned.mask, made.mask, atol=1e-6)
    assert made.width == turned.width == 2.0


def test_rasters_of_different_widths():
    small, large = raster(np.ones((4, 4)), 1.0), raster(np.full((4, 4), 0.5), 2.0)
    wanted = np.full((8, 8), 0.5)
    wanted[2:6, 2:6] = 1
    for pair in ((small, large), (large, small)):
        joined = aperture.union(*pair)
        assert joined.width == 2.0
        np.testing.assert_allclose(joined.mask, wanted, atol=1e-6)
    within = aperture.intersection(large, small)
    assert within.width == 2.0
    np.testing.assert_allclose(within.mask, wanted - 0.5, atol=1e-6)
    cropped = aperture.intersection(small, large)
    assert cropped.width == 1.0
    np.testing.assert_allclose(cropped.mask, np.full((4, 4), 0.5), atol=1e-6)


def test_dimming_a_raster():
    mask = np.random.default_rng(8).random((3, 3))
    np.testing.assert_allclose(aperture.dimmed(raster(mask), 0.25).mask, 0.25 * mask, rtol=1e-6)


def test_scaling():
    for shape in (aperture.iris(5, 2.0, 0.3), raster(np.eye(3), 2.0)):
        twice = aperture.scaled(shape, 2.0)
        assert twice.width == 2 * shape.width
        assert aperture.area(twice) == pytest.approx(4 * aperture.area(shape), rel=1e-12)
        assert aperture.energy(twice) == pytest.approx(4 * aperture.energy(shape), rel=1e-12)


def test_rotating():
    """Counter-clockwise as seen, like an iris's own rotation."""
    turned = aperture.rotated(aperture.iris(5, 2.0, 0.3), 0.4).outlines[0]
    itself = aperture.iris(5, 2.0, 0.3, rotation=0.4).outlines[0]
    np.testing.assert_allclose(turned.vertices, itself.vertices, atol=1e-15)
    np.testing.assert_array_equal(turned.bulges, itself.bulges)
    square = aperture.rectangle(2.0, 2.0)
    assert aperture.rotated(square, math.pi / 4).width == pytest.approx(2 * math.sqrt(2), rel=1e-12)
    assert aperture.rotated(aperture.circle(2.0), 1.0).width == 2.0


def test_moving():
    """x to the right, y downward, on a square that still holds the shape."""
    moved = aperture.moved(aperture.rectangle(0.5, 0.5), 0.75, 0.25)
    assert moved.width == pytest.approx(2.0, rel=1e-12)
    mask = aperture.rasterize(moved, 8)
    wanted = np.zeros((8, 8))
    wanted[4:6, 6:8] = 1
    np.testing.assert_allclose(mask, wanted, atol=1e-6)
    assert aperture.moved(aperture.circle(2.0), 0.0, 0.0).width == 2.0
    # A circle's square reaches to its rim, which chords miss by 1e-7.
    assert aperture.moved(aperture.circle(2.0), 0.0, -3.0).width == pytest.approx(8.0, rel=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: aperture.intersection(*PAIRS["apart"]),
            "'circle within circle' lets no light through.",
        ),
        (
            lambda: aperture.subtraction(aperture.circle(1.0), aperture.circle(2.0)),
            "'circle without circle' lets no light through.",
        ),
        (
            lambda: aperture.subtraction(raster(np.eye(2)), raster(np.ones((2, 2)))),
            "'subtraction' lets no light through.",
        ),
        (
            lambda: aperture.intersection(raster(np.eye(2)), raster(1 - np.eye(2))),
            "'intersection' lets no light through.",
        ),
        (
            lambda: aperture.dimmed(aperture.circle(1.0), 0.0),
            "'transmittance' must be a finite number > 0, got 0.",
        ),
        (
            lambda: aperture.dimmed(aperture.circle(1.0), 1.5),
            "'transmittance' must be a number from 0 to 1, got 1.5.",
        ),
        (lambda: aperture.scaled(aperture.circle(1.0), 0), "'factor' must be a finite number > 0, got 0."),
        (
            lambda: aperture.rotated(aperture.circle(1.0), math.inf),
            "'angle' must be a finite number, got inf.",
        ),
        (lambda: aperture.moved(aperture.circle(1.0), math.nan, 0), "'x' must be a finite number, got nan."),
        (lambda: aperture.moved(aperture.circle(1.0), 0, "1"), "'y' must be a finite number, got '1'."),
        (
            lambda: aperture.rotated(raster(np.eye(2)), 1.0),
            "a raster cannot be rotated exactly; change the picture, or use outlines.",
        ),
        (
            lambda: aperture.moved(raster(np.eye(2)), 1.0, 0.0),
            "a raster cannot be moved exactly; change the picture, or use outlines.",
        ),
    ],
)
def test_refusals(make, message):
    with refused(message):
        make()
