"""Dirt that moves: specks and scratches keep their shapes; lashes hang before any opening."""

import itertools
import math
import re

import numpy as np
import pytest

from aureole import aperture, jobs, refuse

WIDTH, SIZE = 2e-3, 128
SQUARE = aperture.rectangle(WIDTH, WIDTH)
PIXEL = WIDTH / SIZE


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def dusty(shift=(0.0, 0.0), **more):
    return aperture.dust(SQUARE, SIZE, 0.2, 2e-4, 3, shift=shift, **more).mask


def scratched(shift, count=20):
    return aperture.scratches(SQUARE, SIZE, count, 1e-3, 3e-5, 3, shift=shift).mask


@pytest.mark.parametrize("make", [dusty, scratched])
@pytest.mark.parametrize(("right", "down"), [(17, 5), (-30, 40), (0, -90)])
def test_dirt_that_is_moved_by_whole_pixels_keeps_its_shape(make, right, down):
    still, moved = make((0.0, 0.0)), make((right * PIXEL, down * PIXEL))
    rows = slice(max(down, 0), SIZE + min(down, 0)), slice(max(-down, 0), SIZE + min(-down, 0))
    columns = slice(max(right, 0), SIZE + min(right, 0)), slice(max(-right, 0), SIZE + min(-right, 0))
    np.testing.assert_allclose(moved[rows[0], columns[0]], still[rows[1], columns[1]], atol=2e-4)
    assert np.abs(moved - still).mean() > 0.005


def test_glass_that_moves_has_the_scratches_of_the_still_one_and_its_neighbours():
    still = aperture.scratches(SQUARE, SIZE, 20, 1e-3, 3e-5, 3).mask
    endless = scratched((0.0, 0.0))
    assert np.all(endless <= still)
    # Only what reaches over from beside the square is new.
    assert 0.9 < np.mean(endless == still) < 1


def test_endless_glass_is_as_scratched_everywhere_and_does_not_repeat():
    lost = [1 - scratched((k * WIDTH, 2 * k * WIDTH), 40).mean() for k in range(-3, 4)]
    assert max(lost) < 1.6 * min(lost)
    assert len({round(value, 9) for value in lost}) == len(lost)


@pytest.mark.parametrize("make", [dusty, scratched])
def test_a_drift_has_no_jumps(make):
    frames = [make((0.17 * k * PIXEL, 0.11 * k * PIXEL)) for k in range(30)]
    steps = [np.abs(b - a).mean() for a, b in itertools.pairwise(frames)]
    assert max(steps) < 2.5 * np.median(steps)


def test_lashes_hang_from_above_and_scale_with_the_opening():
    small, large = aperture.circle(3e-3), aperture.circle(1.0)
    masks = [aperture.eyelashes(shape, SIZE, 8, 1).mask for shape in (small, large)]
    np.testing.assert_allclose(masks[0], masks[1], atol=1e-5)
    lost = aperture.rasterize(large, SIZE) - masks[1]
    assert lost.min() >= 0
    assert lost[: SIZE // 2].sum() > 20 * lost[SIZE // 2 :].sum() > 0


def test_more_lashes_and_lower_lids_leave_less():
    open_share = [aperture.eyelashes(aperture.circle(1.0), 64, count, 2).mask.mean() for count in (0, 4, 12)]
    assert open_share[0] > open_share[1] > open_share[2]
    lids = [
        aperture.eyelashes(aperture.circle(1.0), 64, 0, 2, opening).mask.mean() for opening in (1, 0.5, 0.2)
    ]
    assert lids[0] == pytest.approx(math.pi / 4, abs=1e-4)
    assert lids[0] > lids[1] > lids[2]


def test_dirt_that_is_refused():
    with refused("'shift' must hold finite numbers, got 1 that are NaN or infinite."):
        dusty((math.nan, 0.0))
    with refused("the eyelashes let no light through; take fewer, or open the lids."):
        aperture.eyelashes(aperture.circle(1.0), 32, 4, 1, 0.0)


def test_an_opening_knows_its_dirt_at_a_time_and_from_a_direction():
    opening = jobs.Opening(
        shape="circle", dust=0.2, dust_scale=4e-4, dirt_drift=(1e-4, 0.0), dirt_distance=1e-2
    )
    plain = jobs.Opening(shape="circle", dust=0.2, dust_scale=4e-4)
    start = plain.build("circle", 3e-3).mask
    np.testing.assert_array_equal(opening.at(0.0).build("circle", 3e-3).mask, start)
    right = math.atan(1e-4 / 1e-2)
    # A second of drift is taken back by light from so far to the right that it moves the shadow left.
    there = opening.at(1.0, (right, 0.0)).build("circle", 3e-3).mask
    np.testing.assert_allclose(there, start, atol=1e-5)
    assert np.abs(opening.at(1.0).build("circle", 3e-3).mask - start).mean() > 0.01
    assert plain.at(5.0, (0.1, 0.1)) == plain


def test_dust_stays_the_same_while_a_shadow_moves_over_it():
    dust = jobs.Opening(shape="circle", dust=0.3)
    whole = dust.build("circle", 3e-3).mask
    for x in (-0.2, 0.3):
        cut = jobs.Opening(shape="circle", dust=0.3, shadow=(x, 0.0, 0.4)).build("circle", 3e-3).mask
        shared = cut > 0
        assert np.mean(cut[shared] == whole[shared]) > 0.99


def test_drift_without_dirt_is_refused():
    with refused("'dirt_drift' needs 'dust' or 'scratches'."):
        jobs.Opening(shape="circle", dirt_drift=(1e-4, 0.0)).build("circle", 3e-3)
