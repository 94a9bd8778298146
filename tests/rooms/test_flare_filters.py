"""Filters over ghosts: energy, direction and amount of the spectral blur; what the median takes and keeps."""

import numpy as np
import pytest

from aureole import Picture, refuse
from aureole.flare import filters


def picture_of(shape=(120, 160), channels=3):
    return Picture(np.zeros((*shape, channels), dtype=np.float32), "xyz")


def with_dot(x, y, shape=(120, 160)):
    found = picture_of(shape)
    found.pixels[y, x] = (1.0, 2.0, 3.0)
    return found


def moments(plane):
    """Return the middle (x, y) and the 2 x 2 covariance of a plane's light, in pixels."""
    rows, columns = np.indices(plane.shape) + 0.5
    weight = plane / plane.sum(dtype=np.float64)
    x, y = (weight * columns).sum(), (weight * rows).sum()
    places = np.stack([columns - x, rows - y])
    return (x, y), np.einsum("aij,bij,ij->ab", places, places, weight)


@pytest.mark.parametrize(("x", "y"), [(20, 30), (130, 60), (80, 110)])
@pytest.mark.parametrize("spread", [0.02, 0.1])
def test_the_spectral_filter_blurs_along_the_line_through_the_middle(x, y, spread):
    """A hat of half width w has the variance w²/6; a pixel laid down anew is up to half a pixel wider."""
    found = filters.spectral(with_dot(x, y), spread).pixels
    np.testing.assert_allclose(found.sum(axis=(0, 1), dtype=np.float64), [1, 2, 3], rtol=1e-5)
    place, spread_out = moments(found[..., 1])
    arm = np.array([x + 0.5 - 80, y + 0.5 - 60])
    length = np.linalg.norm(arm)
    assert np.hypot(place[0] - x - 0.5, place[1] - y - 0.5) < 0.01 * length * spread
    along = arm @ spread_out @ arm / length**2
    across = np.trace(spread_out) - along
    assert along - across == pytest.approx((spread * length) ** 2 / 6, rel=0.1, abs=0.15)
    assert across < 0.6


def test_the_middle_stays_and_can_be_elsewhere():
    dot = with_dot(40, 20)
    found = filters.spectral(dot, 0.1, (40.5, 20.5)).pixels[..., 0]
    (x, y), spread_out = moments(found)
    assert (x, y) == pytest.approx((40.5, 20.5), abs=1e-3)
    assert np.trace(spread_out) < 0.6
    assert filters.spectral(dot, 0.0).pixels == pytest.approx(dot.pixels, abs=0)


def test_a_smooth_picture_keeps_its_energy_and_symmetry():
    rows, columns = np.indices((101, 141)) - np.array([50, 70])[:, None, None]
    lump = np.exp(-(rows**2 + columns**2) / 100.0).astype(np.float32)
    given = Picture(np.repeat(lump[..., None], 3, axis=2), "xyz", {"note": 1})
    found = filters.spectral(given, 0.2)
    assert (found.colour_space, found.metadata) == ("xyz", {"note": 1})
    np.testing.assert_allclose(found.pixels.sum(), given.pixels.sum(), rtol=1e-5)
    np.testing.assert_allclose(found.pixels, found.pixels[::-1, ::-1], atol=1e-6)
    np.testing.assert_allclose(found.pixels, found.pixels[:, ::-1], atol=1e-6)


def test_shares_are_whole():
    """Every pixel's shares sum to 1 where it stays inside, also where it shrinks."""
    for factor in (0.8, 0.97, 1.03):
        shares = filters._shares(50, factor, 25.0).toarray()
        sums = shares.sum(axis=0)
        inside = np.abs(np.arange(50) + 0.5 - 25) * factor < 24
        np.testing.assert_allclose(sums[inside], 1, rtol=1e-6)
        assert (shares >= 0).all()


def test_the_median_takes_off_lone_pixels_and_seams_and_keeps_edges_and_energy():
    given = picture_of()
    given.pixels[40:80, 40:100] = 1.0
    clean = given.pixels.copy()
    given.pixels[60, 70] = 50.0
    given.pixels[41:79, 55] = 0.0
    found = filters.median(given).pixels
    np.testing.assert_allclose(
        found.sum(axis=(0, 1), dtype=np.float64), given.pixels.sum(axis=(0, 1), dtype=np.float64), rtol=1e-6
    )
    scale = found[50, 50, 0]
    # All but the rectangle's corners and the ends of the seam is as without the faults.
    wrong = np.abs(found / scale - clean)[..., 0] > 1e-6
    assert wrong.sum() <= 6
    assert found[60, 70, 0] == scale


def test_a_median_that_would_leave_nothing_leaves_the_picture():
    dot = with_dot(40, 20)
    np.testing.assert_array_equal(filters.median(dot).pixels, dot.pixels)
    np.testing.assert_array_equal(filters.median(picture_of()).pixels, 0)
    np.testing.assert_array_equal(filters.median(dot, 1).pixels, dot.pixels)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: filters.median(p, 4), r"^'size' must be an odd number of pixels up to 99, got 4\.$"),
        (lambda p: filters.median(p, 0), r"^'size' must be an integer >= 1, got 0\.$"),
        (lambda p: filters.spectral(p, 0.7), r"^'spread' must be .*0\.5, got 0\.7\.$"),
        (lambda p: filters.spectral(p, 0.1, (np.nan, 3)), r"^'centre's x' must be a finite number"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(refuse.Refusal, match=message):
        call(picture_of())
    broken = picture_of()
    broken.pixels[3, 3] = np.nan
    with pytest.raises(refuse.Refusal, match=r"^'picture' must hold finite numbers"):
        filters.median(broken)
