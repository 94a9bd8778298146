"""The eye's glare laid over pictures: its size in degrees, strength off the axis, hue, stars, flashes, time.

    python benchmarks/eye_compositing.py [--runs 9] [--size 1024]

The eye is the standard one at 0.1 cd/m2. Lamps are drawn by the part of each pixel's solid angle that they
cover. A star is one pixel wide and moves by fractions of a pixel; its glare is what "add" adds, over the
weight of its place; the wobble is largest less smallest over largest. Times of pictures of 910 x 512 are
medians, of all processors together, the ways in turn.
"""

import argparse
import math
import os
import platform
import statistics
import time

import numpy as np

import aureole
from aureole import Picture, glare, light, picture

STATE = glare.EyeState.at(time=0.5, luminance=0.1, blinking=False)
FIELD = math.radians(60)
FORMATS = ((360, 640), (720, 1280), (1000, 1000))
LAMP = 1e4
ORANGE = np.array([8.0, 1.7, 0.2])


def pattern(shape, field, reach, size):
    """Return the eye's pattern on a picture's pixels, out to an angle."""
    pitch = glare.tangent_pitch(shape, field)
    side = 2 * math.ceil(math.tan(reach) / pitch) + 1
    across = 2 * math.atan(pitch * side / 2)
    return glare.eye_psf(STATE, (side, side), across, projection="perspective", size=size)


def lamp(shape, field, radius, off_axis=0.0):
    """Draw a round lamp on black, each pixel from 8 x 8 places."""
    pitch, parts = glare.tangent_pitch(shape, field), 8
    within = (np.arange(parts) + 0.5) / parts - 0.5
    y, x = (((np.arange(n)[:, None] + within).ravel() - (n - 1) / 2) * pitch for n in shape)
    weights = (1 + y[:, None] ** 2 + x**2) ** -1.5
    towards = math.cos(off_axis) + math.sin(off_axis) * x
    inside = towards / np.sqrt(1 + y[:, None] ** 2 + x**2) > math.cos(radius)
    blocks = shape[0], parts, shape[1], parts
    share = (weights * inside).reshape(blocks).sum(axis=(1, 3)) / weights.reshape(blocks).sum(axis=(1, 3))
    return Picture(np.repeat((LAMP * share)[..., None], 3, axis=2).astype(np.float32))


def sizes(size):
    """Print at which angle the glare of a lamp has fallen to a level, in three formats."""
    for shape in FORMATS:
        out = glare.eye_composite(
            lamp(shape, FIELD, math.radians(0.25)), pattern(shape, FIELD, math.radians(6), size), FIELD
        )
        pitch = glare.tangent_pitch(shape, FIELD)
        y, x = ((np.arange(n) - (n - 1) / 2) * pitch for n in shape)
        angle = np.degrees(np.arctan(np.hypot(y[:, None], x)))
        edges = np.arange(0.5, 5.0, 0.1)
        place = np.digitize(angle.ravel(), edges)
        total, count = (
            np.bincount(place, each, len(edges) + 1)[1:-1]
            for each in (out.pixels[..., 1].ravel(), np.ones(angle.size))
        )
        radii = [np.interp(-math.log(level), -np.log(total / count), edges[:-1] + 0.05) for level in (5, 0.6)]
        print(
            f"{shape[1]} x {shape[0]}: glare of 5e-4 and 6e-5 of the lamp's luminance at "
            f"{radii[0]:.3f} and {radii[1]:.3f} degrees; a pixel is {math.degrees(pitch):.3f}"
        )


def off_the_axis(size):
    """Print how much a lamp of one degree glares off the axis, over what it does on it."""
    shape, field = (150, 400), math.radians(100)
    psf = pattern(shape, field, math.radians(8), size)

    def total(place, known):
        source = lamp(shape, field, math.radians(1), place)
        out = glare.eye_composite(source, psf, known, "add", threshold=0.0, knee=0.0)
        return float((out.pixels - source.pixels).sum(dtype=np.float64))

    for degrees in (15, 30, 40):
        weighed, plain = (total(math.radians(degrees), to) / total(0.0, to) for to in (field, None))
        print(f"{degrees} degrees off the axis: {weighed:.4f} by solid angle, {plain:.4f} by pixels")


def hue_angle(rgb):
    """Return the CIE 1976 hue angle h_uv in degrees."""
    white = light.SPACES["rec709"].white
    (u, v), (u_white, v_white) = (
        (4 * x / (x + 15 * y + 3 * z), 9 * y / (x + 15 * y + 3 * z))
        for x, y, z in (light.to_xyz(rgb, "rec709", white=white), white)
    )
    return math.degrees(math.atan2(v - v_white, u - u_white))


def hues(size):
    """Print how far the hue of an orange lamp's glare turns as something before the lamp dims it."""
    shape = (120, 160)
    psf = pattern(shape, FIELD, math.radians(10), size)
    psf = Picture(np.repeat(psf.pixels.mean(axis=2, keepdims=True), 3, axis=2), metadata=psf.metadata)
    for share in (1.0, 0.6, 0.5, 0.4):
        pixels = np.zeros((*shape, 3), dtype=np.float32)
        pixels[58:62, 78:82] = ORANGE * share
        turns = []
        for knee in glare.KNEES:
            out = glare.eye_composite(
                Picture(pixels), psf, FIELD, "add", threshold=0.9, knee=0.0, knee_of=knee
            )
            added = (out.pixels - pixels).sum(axis=(0, 1), dtype=np.float64)
            turns.append(f"{hue_angle(added) - hue_angle(ORANGE):+.2f} degrees by '{knee}'")
        print(f"orange dimmed to {share:g}: hue turns by {', '.join(turns)}")


def stars(size):
    """Print how much the glare of a moving star wobbles, pixel by pixel and measured whole."""
    shape = (90, 160)
    psf = pattern(shape, FIELD, math.radians(25), size)
    weights = glare.solid_angle_weights(shape, FIELD)
    for resolution in glare.RESOLUTIONS:
        ready = glare.eye_prepare(psf, shape, FIELD, "add", resolution=resolution)
        for strength in (1.1, 1.3, 3.0):
            glows = {0: [], 1: []}
            for n in range(48):
                y, x = 44 + 0.0325 * n, 70 + 0.0725 * n
                pixels = np.full((*shape, 3), 0.01, dtype=np.float32)
                share = np.outer(*(np.array([1 - at % 1, at % 1]) for at in (y, x)))
                pixels[int(y) : int(y) + 2, int(x) : int(x) + 2] += (strength * share)[..., None]
                for star_size, found in glows.items():
                    out = glare.eye_composite(
                        Picture(pixels), ready, threshold=1.0, knee=0.2, star_size=star_size
                    )
                    found.append((out.pixels - pixels).sum(dtype=np.float64) / weights[round(y), round(x)])
            single, whole = (100 * (max(found) - min(found)) / max(found) for found in glows.values())
            print(
                f"star of {strength:g} thresholds, {resolution} resolution: wobble {single:.1f} % pixel by "
                f"pixel, {whole:.2f} % measured whole"
            )


def pictures(size, runs):
    """Print the night scene's sum and the time at both resolutions."""
    shape = (512, 910)
    source = picture.night_scene(shape)
    psf = pattern(shape, FIELD, math.radians(40), size)
    ready = {way: glare.eye_prepare(psf, shape, FIELD, resolution=way) for way in glare.RESOLUTIONS}
    times, outs = {way: [] for way in ready}, {}
    for _ in range(runs):
        for way, kernel in ready.items():
            start = time.process_time()
            outs[way] = glare.eye_composite(source, kernel).pixels
            times[way].append((time.process_time() - start) * 1e3)
    before = source.pixels.sum(dtype=np.float64)
    for way, out in outs.items():
        print(
            f"{way}: {statistics.median(times[way]):.0f} ms of processor time, the frame's sum changed by "
            f"{out.sum(dtype=np.float64) / before - 1:.1e}"
        )
    apart = np.percentile(100 * np.abs(outs["half"] / outs["full"] - 1), (50, 90, 99))
    print(
        "half resolution from full: {:.1f} % median, {:.0f} % at 90, {:.0f} % at 99 in 100 pixels".format(
            *apart
        )
    )


def limiter(runs):
    """Print flashes of a wave of 5 Hz before and after the limiter, and its time."""
    levels = np.where(np.floor(10 * np.arange(120) / 30) % 2 == 0, 0.1, 0.9).astype(np.float32)
    limit, shown = glare.FlashLimiter(30), []
    for level in levels:
        pixels = np.full((90, 160, 3), level)
        shown.append(glare.flash_measures(limit(pixels))[0])
    before, after = glare.flashes(levels, 30), glare.flashes(shown, 30)
    print(f"5 Hz for 4 s: {before} flashes in the worst second before, {after} after")
    scene = np.random.default_rng(1).random((512, 910, 3), dtype=np.float32)
    for name, rate in (("nothing to hold back", 0), ("held back", 5)):
        limit, times = glare.FlashLimiter(30), []
        for n in range(30 + runs):
            level = np.float32(0.1 if math.floor(2 * rate * n / 30) % 2 else 0.9)
            start = time.process_time()
            limit(scene * level)
            times.append((time.process_time() - start) * 1e3)
        print(f"limiter, {name}: {statistics.median(times[-runs:]):.0f} ms of processor time")


def main():
    """Print everything."""
    parser = argparse.ArgumentParser(description="Measure the eye's glare on pictures.")
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--size", type=int, default=1024, help="samples a side of the wave")
    given = parser.parse_args()
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, Aureole {aureole.__version__}"
    )
    sizes(given.size)
    off_the_axis(given.size)
    hues(given.size)
    stars(given.size)
    pictures(given.size, given.runs)
    limiter(given.runs)


if __name__ == "__main__":
    main()
