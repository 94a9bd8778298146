"""Flashes counted and limited: square waves, ramps, red, corners of the frame, and any noise at all."""

import numpy as np
import pytest

from aureole import Refusal, glare

SHAPE = (18, 32)
FPS = 30


def square(rate, seconds=4, fps=FPS, low=0.1, high=0.9):
    """A wave that is as long bright as it is dark."""
    phase = np.floor(2 * rate * np.arange(round(seconds * fps)) / fps + 1e-9)
    return np.where(phase % 2 == 0, low, high)


def frames(levels, where=np.s_[:, :], colour=(1.0, 1.0, 1.0), ground=0.2):
    """Pictures of even ground with a part that has these levels."""
    for level in levels:
        pixels = np.full((*SHAPE, 3), ground, dtype=np.float32)
        pixels[where] = level * np.array(colour, dtype=np.float32)
        yield pixels


def limited(pictures, fps=FPS):
    limiter = glare.FlashLimiter(fps)
    return [limiter(pixels) for pixels in pictures]


def worst(pictures, fps=FPS):
    """Flashes of the worst second, of any cell or the whole, by luminance and by saturated red."""
    measures = [glare.flash_measures(pixels) for pixels in pictures]
    general, red = (np.array([m[kind] for m in measures]) for kind in (0, 1))
    return glare.flashes(general, fps), glare.flashes(red, fps, 20 / 320, np.inf)


@pytest.mark.parametrize("rate", [1, 2, 3, 5, 10])
def test_a_square_wave_has_as_many_flashes_as_periods(rate):
    assert glare.flashes(square(rate, fps=60), 60) == rate


def test_what_does_not_count():
    assert glare.flashes(square(5, low=0.5, high=0.59), FPS) == 0
    assert glare.flashes(square(5, low=0.81, high=1.0), FPS) == 0
    assert glare.flashes(square(5, low=0.79, high=1.0), FPS) == 5
    assert glare.flashes(np.linspace(0, 1, 20), FPS) == 0
    # One change up and one down are one flash, however many steps they take.
    assert glare.flashes([0.1, 0.3, 0.5, 0.9, 0.6, 0.3, 0.1], FPS) == 1
    assert glare.flashes([], FPS) == 0
    # Small ripples on a slow rise are not its turns.
    assert glare.flashes(np.linspace(0, 1, 90) + 0.04 * square(15, 3, low=-1, high=1), FPS) == 0


def test_a_second_ends_before_its_first_instant_comes_again():
    # Three hertz: the seventh change comes exactly one second after the first.
    levels = np.tile([0.0] * 5 + [1.0] * 5, 6)
    assert glare.flashes(levels, 30) == 3
    assert glare.flashes(levels, 41) == 4


@pytest.mark.parametrize("rate", [4, 7.5, 15])
@pytest.mark.parametrize("where", [np.s_[:, :], np.s_[:6, :8], np.s_[4:6, 10:14]])
def test_a_fast_square_wave_is_limited_wherever_it_is(rate, where):
    source = list(frames(square(rate), where))
    assert worst(source)[0] > 3
    out = limited(source)
    assert worst(out)[0] <= 3
    # Once it is known to flash, it is calm.
    assert worst(out[60:])[0] == 0


def test_red_alone_is_limited():
    # Red of 0.4 has a luminance of 0.085, which is no general flash.
    source = list(frames(square(6, low=0.0, high=0.4), colour=(1, 0, 0), ground=0))
    assert worst(source) == (0, 6)
    assert worst(limited(source))[1] <= 3


@pytest.mark.parametrize("rate", [1, 2, 3])
def test_what_is_allowed_passes_unchanged(rate):
    source = list(frames(square(rate, fps=60)))
    for before, after in zip(source, limited(source, 60), strict=True):
        np.testing.assert_array_equal(after, before)


def test_a_slow_ramp_and_a_cut_pass_unchanged_with_light_above_white():
    levels = np.concatenate([np.linspace(0, 5, 90), np.linspace(5, 0, 90), np.full(10, 3.0)])
    source = list(frames(levels))
    for before, after in zip(source, limited(source), strict=True):
        np.testing.assert_array_equal(after, before)


def test_only_the_part_that_flashes_is_held_back():
    source = list(frames(square(6), np.s_[:4, :4], ground=0.3))
    for pixels, step in zip(source, np.linspace(0, 0.3, len(source)), strict=True):
        pixels[10:, 20:] = 0.2 + step
    for before, after in zip(source, limited(source), strict=True):
        np.testing.assert_array_equal(after[10:, 20:], before[10:, 20:])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("fps", [12, 50])
def test_no_sequence_gets_a_fourth_flash_through(seed, fps):
    rng = np.random.default_rng(seed)
    # Lamps of every colour blink in blocks, some beyond white, at changing rates.
    source = []
    state = rng.random((6, 8, 3)) * 2
    for _ in range(4 * fps):
        turn = rng.random((6, 8, 1)) < rng.choice([0.05, 0.4, 0.9])
        state = np.where(turn, rng.random((6, 8, 3)) * rng.choice([0.3, 1, 4], (6, 8, 1)), state)
        source.append(np.kron(state, np.ones((3, 4, 1))).astype(np.float32))
    assert max(worst(source, fps)) > 3
    out = limited(source, fps)
    assert max(worst(out, fps)) <= 3
    assert min(pixels.min() for pixels in out) >= 0


def test_it_lets_go_when_flashing_ends():
    levels = np.concatenate([square(6, 2), np.full(90, 0.5)])
    limiter = glare.FlashLimiter(FPS)
    shares = []
    for pixels in frames(levels):
        last = limiter(pixels)
        shares.append(limiter.share)
    assert min(shares[40:60]) < 0.1
    assert shares[-1] == 1
    np.testing.assert_array_equal(last, pixels)


def test_alpha_stays_and_the_size_of_frames_does_not_matter():
    limiter = glare.FlashLimiter(FPS)
    for level in square(7.5, 2):
        pixels = np.full((5, 7, 4), level, dtype=np.float32)
        pixels[..., 3] = 0.25
        out = limiter(pixels)
        np.testing.assert_array_equal(out[..., 3], 0.25)
    assert out.shape == (5, 7, 4)


def test_what_does_not_fit_is_refused():
    with pytest.raises(Refusal, match="fps"):
        glare.FlashLimiter(0)
    with pytest.raises(Refusal, match="white"):
        glare.FlashLimiter(24, white=-1.0)
    with pytest.raises(Refusal, match="colour_space"):
        glare.FlashLimiter(24, colour_space="rec")
    with pytest.raises(Refusal, match="fps"):
        glare.flashes([0.1, 0.2], -3)
    limiter = glare.FlashLimiter(24)
    limiter(np.zeros((4, 5, 3), dtype=np.float32))
    with pytest.raises(Refusal, match="shape"):
        limiter(np.zeros((4, 6, 3), dtype=np.float32))
    with pytest.raises(Refusal, match="finite"):
        limiter(np.full((4, 5, 3), np.nan, dtype=np.float32))
    with pytest.raises(Refusal, match="grid"):
        glare.FlashLimiter(24, grid=(0, 3))(np.zeros((4, 5, 3), dtype=np.float32))
