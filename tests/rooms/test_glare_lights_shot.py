"""Lights of drawn shots, found and followed: behind bars, through each other, and as the camera pans."""

import numpy as np
import pytest

from aureole import Picture, glare

SHAPE, FINE = (48, 96), 4
WALL = 0.05


def coverage(inside):
    """Mean of a function of (x, y) over each pixel, by samples."""
    steps = (np.arange(SHAPE[0] * FINE) + 0.5) / FINE, (np.arange(SHAPE[1] * FINE) + 0.5) / FINE
    fine = inside(steps[1][None], steps[0][:, None]).astype(np.float64)
    return fine.reshape(SHAPE[0], FINE, SHAPE[1], FINE).mean(axis=(1, 3))


def disc(x, y, radius):
    return lambda u, v: (u - x) ** 2 + (v - y) ** 2 <= radius**2


def drawn(*parts):
    """A wall with parts of given coverage and colour laid over it, the last one on top."""
    pixels = np.full((*SHAPE, 3), WALL)
    for share, colour in parts:
        pixels += share[..., None] * (np.asarray(colour, dtype=float) - pixels)
    return Picture(pixels.astype(np.float32))


def behind_bars(x, bar, gap):
    """A lamp five pixels in radius behind upright bars; and the area of it that is seen, in pixels."""

    def is_bar(u, v):
        return (u % (bar + gap) < bar) & (v > 0)

    lamp = disc(x, 24.3, 5.0)
    seen = coverage(lambda u, v: lamp(u, v) & ~is_bar(u, v))
    return drawn((coverage(is_bar), (0.01,) * 3), (seen, (300, 200, 100))), seen.sum()


def test_a_lamp_behind_bars_is_one_lamp_with_the_light_that_is_seen():
    """Bars narrower than the lamp cut it in pieces that are found as one; its light is the area seen."""
    shot = [behind_bars(8.2 + 1.7 * n, 3, 9) for n in range(45)]
    frames = [(n, glare.find_lamps(picture, 2.0, connect=5)) for n, (picture, _) in enumerate(shot)]
    assert all(len(lamps) == 1 for _, lamps in frames)
    assert {seen.id for seen in glare.track_lamps(frames)} == {1}
    luminance = glare.luminances(drawn((np.ones(SHAPE), (300, 200, 100))))[0, 0]
    for (_, (lamp,)), (_, area) in zip(frames, shot, strict=True):
        assert lamp.flux == pytest.approx(area * luminance, rel=0.002)


def test_a_lamp_that_is_hidden_whole_for_some_frames_is_the_same_when_it_comes_out():
    shot = [behind_bars(6.2 + 1.3 * n, 14, 16) for n in range(64)]
    frames = [(n, glare.find_lamps(picture, 2.0)) for n, (picture, _) in enumerate(shot)]
    hidden = [n for n, (_, area) in enumerate(shot) if area == 0]
    assert len(hidden) > 3
    assert all(bool(lamps) == (n not in hidden) for n, lamps in frames)
    assert {seen.id for seen in glare.track_lamps(frames)} == {1}


def test_glare_of_a_lamp_behind_bars_jumps_no_further_than_what_is_seen_of_it():
    """What makes glare changes from frame to frame by at most twice what the visible light does."""
    shot = [behind_bars(8.2 + 0.4 * n, 3, 9) for n in range(60)]
    lit, light = [], []
    for picture, _ in shot:
        seen = glare.luminances(picture)
        lamps = glare.find_lamps(picture, 2.0, connect=5)
        lit.append(glare.lamp_matte(picture, 2.0, lamps, connect=5) * seen)
        light.append(seen)
    for n in range(1, len(shot)):
        assert np.all(np.abs(lit[n] - lit[n - 1]) <= 2.001 * np.abs(light[n] - light[n - 1]) + 1e-3)


def test_lamps_that_pass_through_each_other_keep_their_numbers():
    """For some frames they are one region; a warm strong one and a cold weak one come out of it."""
    frames = []
    for n in range(60):
        warm, cold = disc(8 + 1.3 * n, 24.0, 4.0), disc(88 - 1.3 * n, 25.5, 2.5)
        picture = drawn((coverage(cold), (50, 60, 90)), (coverage(warm), (300, 200, 100)))
        frames.append((n, glare.find_lamps(picture, 2.0)))
    assert min(len(lamps) for _, lamps in frames) == 1
    found = glare.track_lamps(frames)
    assert {seen.id for seen in found} == {1, 2}
    warm = {seen.id for seen in found if not seen.merged and seen.lamp.colour[0] > seen.lamp.colour[2]}
    cold = {seen.id for seen in found if not seen.merged and seen.lamp.colour[0] < seen.lamp.colour[2]}
    assert warm == {1}
    assert cold == {2}


def test_lamps_that_a_pan_brings_in_and_takes_out_have_a_number_each():
    """The camera turns, once with a jerk; each lamp has a number while it is seen, and no other has it."""
    generator = np.random.default_rng(5)
    places = np.column_stack([12 + 15.0 * np.arange(24), generator.uniform(8, 40, 24)])
    levels = np.exp(generator.uniform(np.log(50), np.log(500), 24))
    frames, owners = [], {}
    for n in range(80):
        moved = places - [3.0 * n + (8.0 if n >= 30 else 0.0), 0.0]
        there = np.flatnonzero((moved[:, 0] > 3) & (moved[:, 0] < SHAPE[1] - 3))
        parts = [(coverage(disc(*moved[k], 2.0)), (levels[k],) * 3) for k in there]
        frames.append((n, glare.find_lamps(drawn(*parts), 2.0)))
        owners[n] = [(k, moved[k]) for k in there]
    found = glare.track_lamps(frames, reach=8.0, patience=3)
    numbers = {}
    for n, there in owners.items():
        seen = [sighting for sighting in found if sighting.frame == n]
        for k, place in there:
            nearest = min(seen, key=lambda sighting: np.hypot(*(place - sighting.lamp.place)))
            numbers.setdefault(k, set()).add(nearest.id)
    assert all(len(ids) == 1 for ids in numbers.values())
    assert len({next(iter(ids)) for ids in numbers.values()}) == len(numbers) == 22
