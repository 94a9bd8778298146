"""Glare that changes over the frame: places, stamps, layers; the light is kept whatever is blended."""

import math

import numpy as np
import pytest

from aureole import Picture, Refusal, glare
from aureole.glare.composite import EYE_MODES
from aureole.glare.eye_field import direction_of, node_shares

RNG = np.random.default_rng(8)
SHAPE = (41, 61)
FIELD = math.radians(50)


def streak(angle, shape=(81, 121), total=0.5):
    """A kernel with one streak through its core, at an angle."""
    y, x = (np.arange(n) - n // 2 for n in shape)
    across = y[:, None] * math.cos(angle) - x * math.sin(angle)
    along = np.hypot(y[:, None], x)
    fall = np.exp(-(across**2) / 4) / (1 + along / 4)
    return Picture((fall / fall.sum() * total)[..., None].astype(np.float32) * np.ones(3, dtype=np.float32))


def psf_at(direction):
    """A streak that turns by 1 radian for each radian to the right, and by 2 for each one downward."""
    return streak(direction[0] + 2 * direction[1])


def night():
    pixels = RNG.random((*SHAPE, 3), dtype=np.float32) * np.float32(0.1)
    pixels[5, 7], pixels[30:33, 50:52] = (900, 500, 100), (40, 80, 90)
    return Picture(pixels)


def sums(picture):
    return picture.pixels.sum(axis=(0, 1), dtype=np.float64)


def lamp(row, column):
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[row, column] = (5, 3, 1)
    return Picture(pixels)


def test_places_run_from_border_to_border_and_know_their_directions():
    places = glare.field_places(SHAPE, FIELD, (3, 2))
    assert [place for place, _ in places] == [(y, x) for y in (0, 20, 40) for x in (0, 60)]
    # The border pixel's middle lies half a pixel inside the field.
    edge = math.atan(60 / 61 * math.tan(FIELD / 2))
    assert places[3][1] == (pytest.approx(edge), pytest.approx(0))
    assert places[0][1][0] == pytest.approx(-edge)
    assert places[0][1][1] < 0 < places[5][1][1]
    assert glare.field_places(SHAPE, FIELD, (1, 1)) == [((20, 30), (0, 0))]


@pytest.mark.parametrize("nodes", [(1, 1), (1, 3), (2, 2), (3, 4)])
def test_shares_of_the_places_add_up_to_one(nodes):
    shares = np.array(node_shares(SHAPE, nodes))
    np.testing.assert_allclose(shares.sum(axis=0), 1, rtol=1e-6)
    assert shares.min() >= 0
    for (place, _), share in zip(glare.field_places(SHAPE, FIELD, nodes), shares, strict=True):
        assert share[round(place[0]), round(place[1])] == pytest.approx(1)


@pytest.mark.parametrize("mode", EYE_MODES)
def test_a_source_at_a_place_has_that_places_glare(mode):
    field = glare.eye_field(psf_at, SHAPE, FIELD, (3, 3), mode)
    for (row, column), direction in glare.field_places(SHAPE, FIELD, (3, 3)):
        source = lamp(int(row), int(column))
        plain = glare.eye_composite(source, psf_at(direction), FIELD, mode, threshold=0.1).pixels
        out = glare.eye_composite(source, field, threshold=0.1).pixels
        np.testing.assert_allclose(out, plain, rtol=1e-4, atol=1e-6)


def test_between_places_glare_is_blended():
    field = glare.eye_field(psf_at, SHAPE, FIELD, (1, 3))
    (_, left), (_, middle), _ = glare.field_places(SHAPE, FIELD, (1, 3))
    source = lamp(20, 12)
    ends = [glare.eye_composite(source, psf_at(at), FIELD).pixels for at in (left, middle)]
    out = glare.eye_composite(source, field).pixels
    np.testing.assert_allclose(out, 0.6 * ends[0] + 0.4 * ends[1], rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("mode", ["replace", "scatter"])
def test_one_pattern_everywhere_is_the_plain_way_and_light_is_kept(mode):
    source, psf = night(), streak(0.7)
    plain = glare.eye_composite(source, psf, FIELD, mode)
    alike = glare.eye_field(lambda _: psf, SHAPE, FIELD, (2, 3), mode)
    np.testing.assert_allclose(glare.eye_composite(source, alike).pixels, plain.pixels, rtol=1e-4, atol=1e-4)
    stamped = glare.eye_stamps(source, lambda _: psf, glare.eye_prepare(psf, SHAPE, FIELD, mode), 2)
    np.testing.assert_allclose(
        glare.eye_composite(source, stamped).pixels, plain.pixels, rtol=1e-4, atol=1e-4
    )
    turning = glare.eye_field(psf_at, SHAPE, FIELD, (2, 2), mode)
    for ready in (turning, glare.eye_stamps(source, psf_at, turning, 2)):
        np.testing.assert_allclose(sums(glare.eye_composite(source, ready)), sums(source), rtol=1e-6)


def test_a_stamp_is_the_convolution_with_the_sources_own_pattern():
    source, rest = lamp(9, 44), streak(0.0)
    ready = glare.eye_stamps(source, psf_at, glare.eye_prepare(rest, SHAPE, FIELD), 1)
    own = psf_at(direction_of((9, 44), SHAPE, FIELD))
    plain = glare.eye_composite(source, own, FIELD).pixels
    np.testing.assert_allclose(glare.eye_composite(source, ready).pixels, plain, rtol=1e-5, atol=1e-7)


def test_stamps_go_to_the_sources_with_most_light():
    # The source of 3 × 2 dim pixels has less light than the single strong one and more than the third.
    source = night()
    source.pixels[20, 20] = 300
    asked = []

    def remember(direction):
        asked.append(direction)
        return psf_at(direction)

    rest = glare.eye_prepare(streak(0.0), SHAPE, FIELD)
    ready = glare.eye_stamps(source, remember, rest, 2, threshold=10.0)
    expected = [direction_of(place, SHAPE, FIELD) for place in ((5, 7), (31, 50.5))]
    np.testing.assert_allclose(asked, expected, atol=1e-3)
    # Each pixel's light is shared out once.
    np.testing.assert_allclose(
        sum(part.weights for part in ready.parts), glare.solid_angle_weights(SHAPE, FIELD), rtol=1e-6
    )
    assert len(glare.eye_stamps(lamp(3, 3), psf_at, rest, 5).parts) == 2
    assert len(glare.eye_stamps(source, psf_at, rest, 0).parts) == 1


def test_a_large_source_is_convolved_with_its_own_pattern():
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[10:22, 12:22] = (3, 2, 1)
    rest = glare.eye_prepare(streak(0.0), SHAPE, FIELD)
    ready = glare.eye_stamps(Picture(pixels), psf_at, rest, 1)
    weights = glare.solid_angle_weights(SHAPE, FIELD)[10:22, 12:22]
    place = [
        (weights.sum(axis=1 - axis) @ np.arange(n, m)) / weights.sum()
        for axis, n, m in ((0, 10, 22), (1, 12, 22))
    ]
    own = psf_at(direction_of(place, SHAPE, FIELD))
    plain = glare.eye_composite(Picture(pixels), own, FIELD).pixels
    np.testing.assert_allclose(
        glare.eye_composite(Picture(pixels), ready).pixels, plain, rtol=1e-3, atol=1e-5
    )


def test_layers_by_angle_are_the_whole_and_lie_in_order():
    psf, pitch = streak(0.4), glare.tangent_pitch(SHAPE, FIELD)
    angles = [math.radians(2), math.radians(8)]
    layers = glare.radial_layers(psf, angles, pitch)
    total = sum(layer.pixels.astype(np.float64) for layer in layers)
    np.testing.assert_allclose(total, psf.pixels, rtol=1e-5, atol=1e-9)
    assert min(layer.pixels.min() for layer in layers) >= 0
    y, x = (np.arange(n) - n // 2 for n in psf.pixels.shape[:2])
    radius = np.arctan(pitch * np.hypot(y[:, None], x))
    assert layers[0].pixels[radius > 2 * angles[0]].max() == 0
    assert layers[1].pixels[radius < angles[0] / 2].max() == 0
    assert layers[2].pixels[radius < angles[1] / 2].max() == 0


def test_what_does_not_fit_is_refused():
    source, rest = night(), glare.eye_prepare(streak(0.0), SHAPE, FIELD)
    with pytest.raises(Refusal, match="nodes"):
        glare.eye_field(psf_at, SHAPE, FIELD, (0, 3))
    with pytest.raises(Refusal, match="border"):
        glare.eye_field(psf_at, SHAPE, FIELD, border="wrap")
    with pytest.raises(Refusal, match="colour space"):
        glare.eye_field(
            lambda at: Picture(streak(0).pixels, "rec709" if at[0] < 0 else "acescg"), SHAPE, FIELD
        )
    with pytest.raises(Refusal, match="count"):
        glare.eye_stamps(source, psf_at, rest, -1)
    with pytest.raises(Refusal, match="field of view"):
        glare.eye_stamps(source, psf_at, glare.eye_prepare(streak(0), SHAPE))
    with pytest.raises(Refusal, match="shape"):
        glare.eye_stamps(Picture(source.pixels[:20]), psf_at, rest)
    with pytest.raises(Refusal, match="colour space"):
        glare.eye_stamps(source, lambda _: Picture(streak(0).pixels, "acescg"), rest)
    with pytest.raises(Refusal, match="rise"):
        glare.radial_layers(streak(0), [0.2, 0.1], 0.01)
    with pytest.raises(Refusal, match="core_angle"):
        glare.eye_prepare(streak(0), SHAPE, FIELD, "scatter", core_angle=2.0)
