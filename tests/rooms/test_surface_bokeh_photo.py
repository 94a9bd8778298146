"""A photograph of a bokeh, end to end: turn, period, number of lines, heights, and their diffraction."""

import math

import numpy as np
import pytest
from scipy import ndimage

from aureole import picture, refuse, surface
from aureole.records import Picture

PIXEL, PERIOD = 0.083e-6, 1e-3 / 600
BLAZED = surface.blazed_grating(600, 500e-9).along
# The paper's lens: 250 mm at f/5.6 from 85 cm.
LENS = (0.85, 0.25, 5.6)


def disc(pattern, turn, size=340, radius=150, blur=1.5, counts=4000, floor=0.1):
    """Photograph pattern(x, y up) within a lit disc, turned clockwise, blurred, with the noise of light."""
    y, x = np.mgrid[:size, :size] - 0.5 * (size - 1)
    t, b = x * math.cos(turn) + y * math.sin(turn), x * math.sin(turn) - y * math.cos(turn)
    lit = (floor + (1 - floor) * pattern(t, b)) * (np.hypot(x, y) < radius)
    return np.random.default_rng(7).poisson(counts * ndimage.gaussian_filter(lit, blur)) / counts


def facets(t, b):
    return t * PIXEL / PERIOD % 1.0


@pytest.mark.parametrize("turn", [0.3, math.pi / 2, -2.0])
def test_a_known_grating_is_found_however_it_lies(turn):
    """Facets rise along +t in what comes out, whatever the turn was: that is how its angle is known."""
    found = surface.heights_from_bokeh(disc(facets, turn), known=BLAZED, deviation=0)
    assert math.remainder(found.angle - turn, math.tau) == pytest.approx(0.0, abs=0.005)
    assert found.heights.pixel == pytest.approx(PIXEL, rel=0.01)
    assert found.lit == pytest.approx(300 * PIXEL / PERIOD, abs=0.6)
    assert found.error < 0.15
    slopes = np.diff(found.heights.heights.mean(axis=0))
    assert np.median(slopes) == pytest.approx(BLAZED.depth * PIXEL / PERIOD, rel=0.2)
    # It may be any number of whole periods wide.
    periods = found.heights.heights.shape[1] * found.heights.pixel / PERIOD
    assert periods == pytest.approx(round(periods), abs=0.05)


def test_a_given_turn_is_taken_and_tells_which_way_lines_rise():
    upright = surface.heights_from_bokeh(
        disc(facets, math.pi / 2), known=BLAZED, angle=math.pi / 2, deviation=0
    )
    turned = surface.heights_from_bokeh(
        disc(facets, math.pi / 2), known=BLAZED, angle=-math.pi / 2, deviation=0
    )
    slopes = [np.median(np.diff(one.heights.heights.mean(axis=0))) for one in (upright, turned)]
    assert slopes[0] > 0 > slopes[1]
    assert turned.error == pytest.approx(upright.error, rel=0.1)


def test_sharpening_brings_the_known_grating_nearer_until_the_blur_is_too_wide():
    """The trend of appendix C: a narrow blur is undone in part, a wide one is not."""
    for blur, least, most in ((1.5, 0.0, 0.95), (4.0, 0.9, 1.1)):
        seen = disc(facets, 0.0, size=160, radius=400, blur=blur)
        blurred, sharp = (
            surface.heights_from_bokeh(
                seen, known=BLAZED, angle=0.0, deviation=deviation, iterations=12
            ).error
            for deviation in (0.0, blur)
        )
        assert least < sharp / blurred < most


def openings(t, b):
    """Sub-pixels of 342 pixels per inch, 70 % open, at 2 µm a pixel."""
    pixel = 0.0254 / 342 / 2e-6
    return (np.abs(t % (pixel / 3) / (pixel / 3) - 0.5) < 0.35) * (np.abs(b % pixel / pixel - 0.5) < 0.35)


def test_a_display_comes_back_from_a_file_and_diffracts_where_it_should(tmp_path):
    photograph = disc(openings, 0.2, size=420, radius=190, blur=1.5)
    pixels = np.stack([0.0 * photograph, 0.0 * photograph, photograph], axis=-1)
    picture.write(tmp_path / "bokeh.exr", Picture(pixels.astype(np.float32), "rec709", {}))
    found = surface.heights_from_bokeh(
        tmp_path / "bokeh.exr", pixel=2e-6, depth=0.1e-6, iterations=10, lens=LENS
    )
    display = surface.display_grating(342)
    assert found.period == pytest.approx(display.along.period, rel=0.005)
    assert found.across == pytest.approx(display.across.period, rel=0.005)
    assert found.width / found.period == pytest.approx(0.7, abs=0.1)
    assert found.notes == ()
    assert 0 <= found.heights.heights.min() < 0.02e-6
    assert found.heights.heights.max() == pytest.approx(0.1e-6)
    # The first orders of the heights that were seen stand at λ / d along t and along b.
    pattern = surface.height_pattern(
        found.heights, wavelength=530e-9, size=401, half_range=0.04, coherence=300e-6
    )
    middle, step = 200, 0.04 / 200
    along_t, along_b = pattern.values[middle, middle:], pattern.values[middle::-1, middle]
    for line, period, low, high in (
        (along_t, display.along.period, 0.015, 0.03),
        (along_b, display.across.period, 0.004, 0.0105),
    ):
        first = int(low / step)
        at = (first + np.argmax(line[first : int(high / step)])) * step
        assert at == pytest.approx(530e-9 / period, abs=1.5 * step)


def test_lit_slits_of_a_disc_make_its_analytic_pattern_and_the_lens_is_doubted():
    """Section 6.1: 21 slits of 2 µm lit; the lens cannot show such lines, and that is said."""
    radius = 150.0

    def tracks(t, b):
        return np.abs((t * 21 / (2 * radius)) % 1.0 - 0.5) < 0.25

    found = surface.heights_from_bokeh(disc(tracks, 0.0, radius=radius), period=2e-6, depth=0.1e-6, lens=LENS)
    assert found.lit == 21
    slits = found.grating().along
    assert (slits.count, slits.period) == (21, pytest.approx(2e-6))
    assert slits.width == pytest.approx(1e-6, rel=0.1)
    assert "cannot be seen" in found.notes[0]


def test_the_scale_of_one_photograph_serves_another():
    known = surface.heights_from_bokeh(disc(facets, 0.0), known=BLAZED, angle=0.0, deviation=0)
    other = surface.heights_from_bokeh(
        disc(facets, 0.0), pixel=PIXEL, scale=known.scale, angle=0.0, deviation=0
    )
    np.testing.assert_allclose(other.heights.heights, known.heights.heights, atol=1e-15)
    assert other.error is None


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"depth": 1e-7}, "either 'pixel' or 'period'"),
        ({"depth": 1e-7, "pixel": 1e-7, "period": 1e-6}, "either 'pixel' or 'period'"),
        ({"pixel": 1e-7}, "one of 'depth', 'known' and 'scale'"),
        ({"pixel": 1e-7, "depth": -1.0}, "'depth'"),
        ({"pixel": 0.0, "depth": 1e-7}, "'pixel'"),
        ({"known": surface.Lines(2e-6, 1e-6)}, "must have a depth"),
        ({"pixel": 1e-7, "depth": 1e-7, "angle": math.nan}, "'angle'"),
        ({"pixel": 1e-7, "depth": 1e-7, "channel": 5}, "'pixels'"),
    ],
)
def test_what_is_not_said_is_asked_for(more, message):
    seen = np.repeat(disc(facets, 0.0, size=120, radius=50)[..., None], 3, axis=2)
    with pytest.raises(refuse.Refusal, match=message):
        surface.heights_from_bokeh(seen, deviation=0, **more)


def test_darkness_and_missing_files_are_refused(tmp_path):
    with pytest.raises(refuse.Refusal, match="dark"):
        surface.heights_from_bokeh(np.zeros((40, 40)), pixel=1e-7, depth=1e-7)
    wide = np.cos(np.linspace(0, 9, 100))[None, :] + np.full((16, 1), 2.0)
    with pytest.raises(refuse.Refusal, match="fewer than two lines"):
        surface.heights_from_bokeh(wide, pixel=1e-7, depth=1e-7, angle=0.0, deviation=0)
    with pytest.raises(refuse.Refusal, match="none\\.png"):
        surface.heights_from_bokeh(tmp_path / "none.png", pixel=1e-7, depth=1e-7)
