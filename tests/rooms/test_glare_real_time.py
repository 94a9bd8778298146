"""Glare from flipbooks is the plain formula with the plain sum of patterns, to their rounding."""

import math
from dataclasses import replace

import numpy as np
import pytest
from eye_patterns import NODES, SHARES, lights, patterns

from aureole import glare, refuse
from aureole.glare import EyeState, RealTimeGlare, eye_composite, make_flipbooks
from aureole.glare.eye_composite import arriving_share, solid_angle_weights
from aureole.glare.glare_frames import GlareFrames, border_nodes, pattern_field, pattern_shape
from aureole.picture import Convolver
from aureole.records import Picture

FIELD = math.radians(60)
STATE = EyeState(pupil_diameter=5.1e-3, vitreous_angle=0.03, lid_opening=0.7)
ROUNDING = 2.0**-15  # of the glare's root mean square
SHAPES = [(24, 37), (37, 24), (40, 64), (1, 9)]


def books(shape, resolution="full", **changes):
    return make_flipbooks(
        shape=shape, field_of_view=FIELD, frames=NODES, resolution=resolution,
        patterns=patterns(shape, resolution), **changes,
    )  # fmt: skip


def summed(flipbooks, shape, state, resolution="full"):
    """The patterns' plain sum in double precision, without its middle."""
    make = patterns(shape, resolution)
    total = 0
    for name, book in flipbooks.books.items():
        places = list(np.ndindex(*(len(nodes) for _, nodes in book.axes)))
        for place, weight in flipbooks.mix(state):
            if book.first <= place < book.first + len(places):
                at = {
                    axis: nodes[k]
                    for (axis, nodes), k in zip(book.axes, places[place - book.first], strict=True)
                }
                total = total + weight * make(name, replace(EyeState(), **at))[0]
    total[total.shape[0] // 2, total.shape[1] // 2] = 0
    return total


def by_formula(flipbooks, picture, state, border):
    """L − a w L + K ⊗ (w L)."""
    shape = picture.shape[:2]
    kernel = summed(flipbooks, shape, state)
    lit = picture.astype(np.float64) * solid_angle_weights(shape, FIELD)[..., None]
    taken = arriving_share(kernel, shape) if border == "keep" else kernel.sum(axis=(0, 1))
    spread = Convolver(kernel, shape, "double")(lit)
    return picture - taken * lit + spread, spread


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("border", ["keep", "lose"])
def test_a_frame_is_the_plain_formula(shape, border):
    flipbooks, picture = books(shape), lights(shape)
    wanted, spread = by_formula(flipbooks, picture, STATE, border)
    found = RealTimeGlare(flipbooks, border=border)(picture, STATE)
    # Between nodes the share that leaves the frame is off by per cents of itself.
    allowed = ROUNDING * np.sqrt(np.mean(spread**2)) + (0.01 if border == "keep" else 0) * spread.mean()
    assert np.sqrt(np.mean((found - wanted) ** 2)) < 4 * allowed


@pytest.mark.parametrize("shape", [*SHAPES, (63, 64), (64, 63)])
@pytest.mark.parametrize("resolution", ["full", "half"])
def test_the_sum_of_the_frame_is_kept(shape, resolution):
    picture = lights(shape)
    found = RealTimeGlare(books(shape, resolution))(picture, STATE)
    before, after = (pixels.sum(axis=(0, 1), dtype=np.float64) for pixels in (picture, found))
    np.testing.assert_allclose(after, before, rtol=1e-6)
    assert found.min() >= 0


def test_what_leaves_the_frame_is_lost_where_asked():
    shape = (30, 40)
    flipbooks, picture = books(shape), lights(shape)
    wanted, _ = by_formula(flipbooks, picture, STATE, "lose")
    found = RealTimeGlare(flipbooks, border="lose")(picture, STATE)
    np.testing.assert_allclose(found.sum(axis=(0, 1), dtype=float), wanted.sum(axis=(0, 1)), rtol=1e-4)
    assert found.sum() < 0.99 * picture.sum()


def test_light_above_the_knee_is_added_as_in_compositing():
    shape = (36, 50)
    flipbooks, picture = books(shape), lights(shape)
    kernel = summed(flipbooks, shape, STATE).astype(np.float32)
    wanted = eye_composite(
        Picture(picture), Picture(kernel), FIELD, "add", threshold=3.0, knee=0.4, gain=2.0, core_angle=1e-9
    ).pixels
    found = RealTimeGlare(flipbooks, "add", threshold=3.0, knee=0.4, gain=2.0)(picture, STATE)
    added = wanted - picture
    assert np.sqrt(np.mean((found - wanted) ** 2)) < 4 * ROUNDING * np.sqrt(np.mean(added**2))


@pytest.mark.parametrize("mode", ["replace", "add"])
def test_a_star_that_moves_by_fractions_of_a_pixel_keeps_its_light_at_half_resolution(mode):
    shape = (40, 60)
    live = RealTimeGlare(books(shape, "half"), mode, threshold=0.0, knee=0.0)
    totals = []
    for x in np.linspace(29, 31, 9):
        picture = np.zeros((*shape, 3), dtype=np.float32)
        column = int(x)
        picture[20, column : column + 2] = 1000 * np.array([1 - x + column, x - column])[:, None]
        totals.append(live(picture, STATE).sum(dtype=np.float64))
    assert np.ptp(totals) < 0.002 * np.mean(totals)


def test_half_resolution_is_near_full_away_from_the_source():
    shape = (64, 96)
    picture = np.zeros((*shape, 3), dtype=np.float32)
    picture[32:34, 48:50] = 100
    full, half = (
        RealTimeGlare(
            make_flipbooks(
                shape=shape, field_of_view=FIELD, frames=NODES, resolution=resolution,
                patterns=smooth(shape, resolution),
            )
        )(picture, STATE)
        for resolution in ("full", "half")
    )  # fmt: skip
    y, x = np.arange(64) - 32.5, np.arange(96) - 48.5
    far = np.hypot(y[:, None], x) > 8
    np.testing.assert_allclose(half[far], full[far], rtol=0.08)


def smooth(shape, resolution):
    """The same pattern in degrees at both resolutions."""
    reach, step = pattern_shape(shape, resolution), 2 if resolution == "half" else 1
    y, x = ((np.arange(n) - n // 2) * step for n in reach)
    pattern = 3e-2 * step**2 / (4 + y[:, None] ** 2 + x**2) ** 1.3
    return lambda name, state: (np.repeat(pattern[..., None], 3, axis=2), SHARES.get(name, 0.5))


def test_lids_dim_the_frame_where_asked():
    shape = (20, 30)
    flipbooks, picture = books(shape), lights(shape)
    closing = replace(STATE, lid_opening=0.2)
    share = flipbooks.open_share(closing)
    plain = RealTimeGlare(flipbooks)(picture, closing)
    np.testing.assert_allclose(
        RealTimeGlare(flipbooks, dimming=True)(picture, closing), plain * share, rtol=1e-5
    )
    assert 0 < share < flipbooks.open_share(replace(STATE, lid_opening=1.0)) <= 1


@pytest.mark.parametrize("shape", [(360, 640), (720, 1280), (1000, 1000), (7, 5)])
@pytest.mark.parametrize("resolution", ["full", "half"])
def test_a_pattern_has_the_pictures_degrees(shape, resolution):
    """Glare has the same size in degrees whatever the number of pixels."""
    step = 2 if resolution == "half" else 1
    rows, columns = pattern_shape(shape, resolution)
    pitch = 2 * math.tan(pattern_field(shape, FIELD, resolution) / 2) / columns
    assert pitch == pytest.approx(step * 2 * math.tan(FIELD / 2) / shape[1], rel=1e-12)
    # From a corner it reaches the opposite corner.
    assert (rows // 2 + 1) * step >= shape[0]
    assert (columns // 2 + 1) * step >= shape[1]


@pytest.mark.parametrize("length", [1, 2, 3, 10, 455, 512])
def test_border_nodes_crowd_towards_the_borders(length):
    nodes = border_nodes(length)
    assert nodes[0] == 0
    assert nodes[-1] == max(length - 1, 0)
    np.testing.assert_array_equal(nodes, (length - 1 - nodes)[::-1])
    gaps, distance = np.diff(nodes), np.minimum(nodes[:-1], length - 1 - nodes[1:])
    assert np.all(gaps <= np.maximum(1, distance / 4 + 1))


def test_the_share_that_arrives_is_the_sum_of_the_pattern_over_the_frame():
    shape = (9, 14)
    pattern, _ = patterns(shape)("corona", STATE)
    frames = GlareFrames.empty(shape, FIELD)
    frames.put(0, pattern)
    pattern = pattern.copy()
    pattern[8, 13] = 0
    rows, columns = (border_nodes(n) for n in shape)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            seen = pattern[8 - row : 17 - row, 13 - column : 27 - column].sum(axis=(0, 1))
            np.testing.assert_allclose(frames.arriving[0, i, j], seen, rtol=1e-5)


def test_refusals():
    flipbooks = books((8, 9))
    holed = lights((8, 9))
    holed[3, 4] = np.nan
    with pytest.raises(refuse.Refusal, match="'pixels' must hold finite numbers, got 3 that are NaN"):
        RealTimeGlare(flipbooks)(holed, STATE)
    with pytest.raises(refuse.Refusal, match="'mode' must be one of 'replace', 'add', got 'scater'"):
        RealTimeGlare(flipbooks, "scater")
    with pytest.raises(refuse.Refusal, match="'border' must be one of"):
        RealTimeGlare(flipbooks, border="wrap")
    with pytest.raises(refuse.Refusal, match="'threshold' must be a number >= 0, got -1"):
        RealTimeGlare(flipbooks, "add", threshold=-1)
    with pytest.raises(refuse.Refusal, match=r"'pixels' must be an array of shape \(8, 9, 3\)"):
        RealTimeGlare(flipbooks)(np.zeros((9, 8, 3), dtype=np.float32), STATE)
    with pytest.raises(refuse.Refusal, match="'field_of_view' must be below 180 degrees, got 180"):
        glare.make_flipbooks(shape=(8, 9), field_of_view=math.pi)
