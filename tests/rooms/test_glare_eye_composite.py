"""An eye's glare on a picture: the frame's sum, hue, half resolution, stars that do not flicker, layers."""

import math

import numpy as np
import pytest

from aureole import Picture, Refusal, glare, light
from aureole.glare import eye_spread, eye_stars

RNG = np.random.default_rng(6)
SHAPE = (61, 84)
FIELD = math.radians(70)


def bell(shape=(95, 121), width=6.0, total=0.95, tints=(1.0, 0.97, 0.9), degrees_per_pixel=None):
    """A kernel with a wide skirt, its channels unlike."""
    y, x = (np.arange(n) - n // 2 for n in shape)
    fall = (1 + (y[:, None] ** 2 + x**2) / width**2) ** -1.5
    pixels = (fall / fall.sum() * total)[..., None] * np.array(tints)
    said = {} if degrees_per_pixel is None else {"degrees_per_pixel": degrees_per_pixel}
    return Picture(pixels.astype(np.float32), metadata=said)


def night(shape=SHAPE):
    pixels = RNG.random((*shape, 3), dtype=np.float32) * np.float32(0.02)
    pixels[5, 7] = (4000, 2000, 500)
    pixels[shape[0] // 2, shape[1] - 2] = 300
    return Picture(pixels)


def sums(picture):
    return picture.pixels[..., :3].sum(axis=(0, 1), dtype=np.float64)


def by_hand(source, kernel, weights, border):
    """The equation of the module, pixel by pixel."""
    rows, columns = source.shape[:2]
    out = source.astype(np.float64)
    cy, cx = kernel.shape[0] // 2, kernel.shape[1] // 2
    for i, j in np.ndindex(rows, columns):
        lit = weights[i, j] * source[i, j].astype(np.float64)
        spread = np.zeros_like(out)
        for y, x in np.ndindex(kernel.shape[:2]):
            to = i + y - cy, j + x - cx
            if (y, x) != (cy, cx) and 0 <= to[0] < rows and 0 <= to[1] < columns:
                spread[to] += lit * kernel[y, x]
        kept = spread.sum(axis=(0, 1))
        lost = lit * (kernel.sum(axis=(0, 1), dtype=np.float64) - kernel[cy, cx])
        out[i, j] -= kept if border == "keep" else lost
        out += spread
    return out


@pytest.mark.parametrize("border", glare.BORDERS)
@pytest.mark.parametrize("kernel_shape", [(5, 5), (4, 7)])
def test_the_picture_is_what_the_equation_says(border, kernel_shape):
    source = RNG.random((7, 9, 3), dtype=np.float32)
    psf = bell(kernel_shape, 2.0, 0.8)
    weights = glare.solid_angle_weights((7, 9), FIELD)
    out = glare.eye_composite(Picture(source), psf, FIELD, border=border).pixels
    np.testing.assert_allclose(out, by_hand(source, psf.pixels, weights, border), rtol=1e-5)


def test_the_weights_are_the_pixels_solid_angles():
    # Solid angle of a rectangle from the axis to (x, y) on a plane at distance 1: atan(xy / sqrt(1+x²+y²)).
    rows, columns = 30, 40
    pitch = 2 * math.tan(FIELD / 2) / columns
    y, x = ((np.arange(n + 1) - n / 2) * pitch for n in (rows, columns))
    corners = np.arctan(y[:, None] * x / np.sqrt(1 + y[:, None] ** 2 + x**2))
    exact = np.diff(np.diff(corners, axis=0), axis=1) / pitch**2
    np.testing.assert_allclose(glare.solid_angle_weights((rows, columns), FIELD), exact, rtol=1.5e-3)
    np.testing.assert_array_equal(glare.solid_angle_weights((3, 4), None), np.ones((3, 4)))


@pytest.mark.parametrize("mode", ["replace", "scatter"])
@pytest.mark.parametrize("resolution", glare.RESOLUTIONS)
@pytest.mark.parametrize("kernel_shape", [(95, 121), (180, 240), (40, 33)])
def test_the_frames_sum_is_kept(mode, resolution, kernel_shape):
    source = night()
    out = glare.eye_composite(source, bell(kernel_shape), FIELD, mode, resolution=resolution)
    np.testing.assert_allclose(sums(out), sums(source), rtol=1e-6)
    assert out.pixels.min() >= 0


def test_a_border_that_loses_light_is_the_padded_frame():
    source, psf = night(), bell()
    padded = np.zeros((SHAPE[0] + 94, SHAPE[1] + 120, 3), dtype=np.float32)
    padded[47:-47, 60:-60] = source.pixels
    whole = glare.eye_composite(Picture(padded), psf, None, border="lose")
    np.testing.assert_allclose(sums(whole), sums(source), rtol=1e-6)
    lost = glare.eye_composite(source, psf, None, border="lose")
    np.testing.assert_allclose(whole.pixels[47:-47, 60:-60], lost.pixels, rtol=1e-4, atol=1e-3)
    assert sums(lost)[0] < 0.9 * sums(source)[0]


def test_a_prepared_kernel_and_a_matte():
    source, psf = night(), bell()
    ready = glare.eye_prepare(psf, SHAPE, FIELD)
    whole = glare.eye_composite(source, psf, FIELD).pixels
    np.testing.assert_array_equal(glare.eye_composite(source, ready).pixels, whole)
    none = glare.eye_composite(source, ready, matte=np.zeros(SHAPE)).pixels
    np.testing.assert_array_equal(none, source.pixels)
    left = np.zeros(SHAPE)
    left[:, :40] = 1
    one = glare.eye_composite(source, ready, matte=left).pixels - source.pixels
    other = glare.eye_composite(source, ready, matte=1 - left).pixels - source.pixels
    np.testing.assert_allclose(source.pixels + one + other, whole, rtol=1e-4, atol=1e-3)


def test_alpha_stays_and_lids_dim_all_colour():
    rgba = np.concatenate([night().pixels, RNG.random((*SHAPE, 1), dtype=np.float32)], axis=2)
    source, ready = Picture(rgba), glare.eye_prepare(bell(), SHAPE, FIELD)
    open_, half = (glare.eye_composite(source, ready, open_share=share).pixels for share in (1.0, 0.5))
    np.testing.assert_array_equal(open_[..., 3], rgba[..., 3])
    np.testing.assert_array_equal(half[..., 3], rgba[..., 3])
    np.testing.assert_allclose(half[..., :3], 0.5 * open_[..., :3], rtol=1e-6)


def hue(rgb):
    """CIE 1976 hue angle h_uv of linear Rec.709, in degrees."""
    x, y, z = light.to_xyz(rgb, "rec709", white=light.SPACES["rec709"].white)
    white = light.SPACES["rec709"].white
    u, v = 4 * x / (x + 15 * y + 3 * z), 9 * y / (x + 15 * y + 3 * z)
    un, vn = (n * white[i] / (white @ [1, 15, 3]) for i, n in ((0, 4), (1, 9)))
    return math.degrees(math.atan2(v - vn, u - un))


ORANGE = np.array([8.0, 1.7, 0.2], dtype=np.float32)


def added_behind_a_blocker(blocker, knee_of):
    """Sum of what an orange lamp of 3 × 3 pixels behind a blocker adds."""
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[30:33, 40:43] = ORANGE * np.float32(blocker)
    psf = bell(tints=(1, 1, 1))
    out = glare.eye_composite(Picture(pixels), psf, FIELD, "add", threshold=0.9, knee=0.0, knee_of=knee_of)
    return (out.pixels - pixels).sum(axis=(0, 1), dtype=np.float64)


@pytest.mark.parametrize("blocker", [1.0, 0.6, 0.5, 0.4])
def test_an_orange_lamp_behind_a_blocker_keeps_its_hue(blocker):
    # Behind half a blocker red alone is above the threshold of 0.9, blue is below it all the time.
    assert abs(hue(added_behind_a_blocker(blocker, "luminance")) - hue(ORANGE)) < 0.1


def test_the_thesis_knee_turns_it_red():
    # Fig. 4.28: the blocker takes green below the threshold and leaves red above.
    found = added_behind_a_blocker(0.5, "thesis")
    assert found[1] == 0
    assert found[0] > 0
    assert abs(hue(found) - hue(ORANGE)) > 10


def test_half_the_resolution_keeps_light_and_place():
    pixels = RNG.random((20, 26, 3), dtype=np.float32)
    boxes = eye_spread.halved(pixels)
    back = eye_spread.doubled(boxes, (20, 26))
    np.testing.assert_allclose(boxes.sum(axis=(0, 1)), pixels.sum(axis=(0, 1)), rtol=1e-6)
    np.testing.assert_allclose(back.sum(axis=(0, 1)), pixels.sum(axis=(0, 1)), rtol=1e-6)
    rows, columns = np.indices((20, 26)).reshape(2, -1)
    few = eye_spread._halved_few(rows, columns, pixels.reshape(-1, 3), (10, 13))
    np.testing.assert_allclose(few, boxes, rtol=1e-5)
    # A plane goes through unchanged but for the outermost pixels, and a point stays about its place.
    y, x = np.mgrid[:20, :26].astype(np.float32)
    plane = (3 + 2 * y + x)[..., None]
    there = eye_spread.doubled(eye_spread.halved(plane), (20, 26))
    np.testing.assert_allclose(there[3:-3, 3:-3], plane[3:-3, 3:-3], rtol=1e-5)
    point = np.zeros((20, 26, 1), dtype=np.float32)
    point[9, 14] = 1
    spot = eye_spread.doubled(eye_spread.halved(point), (20, 26))[..., 0]
    assert ((spot * y).sum(), (spot * x).sum()) == (pytest.approx(9), pytest.approx(14))


@pytest.mark.parametrize("shape", [(9, 9), (8, 10), (11, 6)])
def test_the_kernel_of_boxes_is_the_mean_over_a_boxs_places(shape):
    kernel = RNG.random((*shape, 1), dtype=np.float32)
    half = eye_spread.halved_kernel(kernel)
    assert half.shape[0] % 2 == half.shape[1] % 2 == 1
    expected = np.zeros(half.shape)
    for place in np.ndindex(2, 2):
        for y, x in np.ndindex(shape):
            to = (y - shape[0] // 2 + place[0]) // 2, (x - shape[1] // 2 + place[1]) // 2
            expected[half.shape[0] // 2 + to[0], half.shape[1] // 2 + to[1]] += kernel[y, x] / 4
    np.testing.assert_allclose(half, expected, rtol=1e-5, atol=1e-6)


def test_half_resolution_is_near_full_resolution():
    # A small star's near glare is laid at full resolution; the rest is smooth.
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[30, 41] = 100
    pixels[10:20, 50:70] = 1
    full, half = (
        glare.eye_composite(Picture(pixels), bell(), FIELD, resolution=resolution).pixels
        for resolution in glare.RESOLUTIONS
    )
    near = np.s_[24:37, 35:48]
    np.testing.assert_allclose(half[near], full[near], rtol=0.08)
    glow = full - pixels
    assert np.abs(half - full).mean() < 0.02 * np.abs(glow).mean()


def star_at(y, x, strength, shape=SHAPE, sky=0.0):
    """A star one pixel wide, by the share of each pixel that it covers."""
    pixels = np.full((*shape, 3), sky, dtype=np.float32)
    i, j = math.floor(y), math.floor(x)
    down, along = np.array([1 - (y - i), y - i]), np.array([1 - (x - j), x - j])
    pixels[i : i + 2, j : j + 2] += (strength * np.outer(down, along))[..., None].astype(np.float32)
    return Picture(pixels)


PATH = [(30 + 0.13 * n, 40 + 0.29 * n) for n in range(12)]


def wobble(values):
    return (max(values) - min(values)) / max(values)


@pytest.mark.parametrize("resolution", glare.RESOLUTIONS)
@pytest.mark.parametrize("sky", [0.0, 0.01])
@pytest.mark.parametrize("strength", [1.1, 1.3, 3.0])
def test_a_star_that_moves_by_fractions_of_a_pixel_does_not_flicker(strength, sky, resolution):
    ready = glare.eye_prepare(bell(), SHAPE, FIELD, "add", resolution=resolution, core_angle=1e-6)
    weights = glare.solid_angle_weights(SHAPE, FIELD)
    glows = {0: [], 1: []}
    for y, x in PATH:
        source = star_at(y, x, strength, sky=sky)
        for size, glow in glows.items():
            out = glare.eye_composite(source, ready, threshold=1.0, knee=0.2, star_size=size)
            # The weight of the star's place is no flicker.
            place = weights[round(y), round(x)]
            glow.append(float((out.pixels - source.pixels).sum(dtype=np.float64) / place))
    assert wobble(glows[1]) < 0.01
    assert wobble(glows[0]) > 0.4


@pytest.mark.parametrize("resolution", glare.RESOLUTIONS)
def test_a_moving_star_keeps_its_energy_in_every_mode(resolution):
    for mode in ("replace", "scatter"):
        ready = glare.eye_prepare(bell(), SHAPE, FIELD, mode, resolution=resolution)
        totals = [
            float(glare.eye_composite(star_at(y, x, 50.0), ready).pixels.sum(dtype=np.float64))
            for y, x in PATH
        ]
        assert wobble(totals) < 1e-6


def test_only_lumps_are_concentrated():
    strength = np.zeros((20, 30))
    strength[5, 6] = 4.0
    strength[10:18, 10:28] = 1.0
    strength[2:5, 20:23] = 1.0
    whole, ring = glare.lumps(strength)
    assert (whole[5, 6], ring[5, 6]) == (pytest.approx(4.0), 0)
    # Edges and insides of a surface are none, nor is a lamp that is wider.
    assert whole[8:].max() == whole[:, 15:].max() == 0
    rows, columns, compact = glare.compact_light(np.repeat(strength[..., None], 3, axis=2))
    assert (rows.tolist(), columns.tolist()) == ([5], [6])
    np.testing.assert_allclose(compact, [[4, 4, 4]], rtol=1e-6)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_lump_of_any_width_is_measured_whole_wherever_it_lies(size):
    for fraction in (0.0, 0.3, 0.7):
        strength = np.zeros((24, 24))
        side = np.clip(np.arange(24) + 1 - (9 + fraction), 0, 1) * np.clip(
            9 + fraction + size - np.arange(24), 0, 1
        )
        strength += np.outer(side, side)
        whole, ring = glare.lumps(strength + 0.1, size)
        np.testing.assert_allclose(whole[strength > 0], size**2, rtol=1e-6)
        np.testing.assert_allclose(ring[strength > 0], 0.1, rtol=1e-6)


def test_each_layer_has_its_own_threshold():
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[30, 20], pixels[30, 60] = 3.0, 30.0
    near, far = bell((9, 9), 2.0), bell((61, 61), 6.0)
    settings = {"threshold": 1.0, "knee": 0.0, "gain": 0.5}
    out = glare.eye_composite(Picture(pixels), near, FIELD, "add", layers=[(far, 10.0, 2.0)], **settings)
    alone = glare.eye_composite(Picture(pixels), near, FIELD, "add", **settings)
    strong = glare.eye_composite(Picture(pixels), far, FIELD, "add", threshold=10.0, knee=0.0, gain=2.0)
    np.testing.assert_allclose(out.pixels, alone.pixels + strong.pixels - pixels, rtol=1e-5, atol=1e-6)
    assert strong.pixels[30, 45, 0] > 0
    # The dim star has short needles only.
    assert alone.pixels[24, 20].max() < 1e-6


def test_what_does_not_fit_is_refused():
    source, psf = night(), bell()
    with pytest.raises(Refusal, match="degrees per pixel"):
        glare.eye_composite(source, bell(degrees_per_pixel=2.0), FIELD)
    central = math.degrees(2 * math.tan(FIELD / 2) / SHAPE[1])
    for fits in (central, math.degrees(FIELD) / SHAPE[1]):
        glare.eye_prepare(bell(degrees_per_pixel=fits), SHAPE, FIELD)
    with pytest.raises(Refusal, match="below 180"):
        glare.solid_angle_weights(SHAPE, 4.0)
    with pytest.raises(Refusal, match="border"):
        glare.eye_prepare(psf, SHAPE, FIELD, border="wrap")
    with pytest.raises(Refusal, match="resolution"):
        glare.eye_prepare(psf, SHAPE, FIELD, resolution="quarter")
    with pytest.raises(Refusal, match="mode"):
        glare.eye_prepare(psf, SHAPE, FIELD, mode="blend")
    with pytest.raises(Refusal, match="sum <= 1"):
        glare.eye_prepare(bell(total=1.2), SHAPE, FIELD)
    with pytest.raises(Refusal, match="colour space"):
        glare.eye_composite(source, Picture(psf.pixels, "acescg"), FIELD)
    with pytest.raises(Refusal, match="shape"):
        glare.eye_composite(night((20, 30)), glare.eye_prepare(psf, SHAPE, FIELD))
    with pytest.raises(Refusal, match="layers"):
        glare.eye_composite(source, psf, FIELD, layers=[(psf, 1.0, 1.0)])
    with pytest.raises(Refusal, match="open_share"):
        glare.eye_composite(source, psf, FIELD, open_share=1.5)
    with pytest.raises(Refusal, match="knee_of"):
        glare.eye_composite(source, psf, FIELD, "add", knee_of="hue")
    with pytest.raises(Refusal, match="star_size"):
        glare.eye_composite(source, psf, FIELD, "add", star_size=-1)
    with pytest.raises(Refusal, match="size"):
        eye_stars.lumps(np.zeros((4, 4)), 0)
