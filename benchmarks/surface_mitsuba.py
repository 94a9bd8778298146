"""Time Mitsuba 3 with our BSDF, and compare the means of its pictures with our own renderer's.

    python benchmarks/surface_mitsuba.py [--rows 540] [--columns 960] [--samples 64] [--repeat 3]

A compact disc (preset "cd", table of 512 x 512) under a small lamp; a plane with the same table in a room
with lamps and windows (`lamps_and_windows`, 128 rows), whose mean our correlation gives; the disc under the
lamp in `llvm_ad_spectral`, from a pattern at 530 nm. Beside them Mitsuba's own `roughconductor` on the disc.
"first" holds the compiling (where the system has kept nothing), "again" is the median of the rest. Seeds are
0, 1, 2...
"""

import argparse
import os
import platform
import time

import numpy as np

from aureole import light, surface
from aureole.surface import mitsuba as plugin

POSE = surface.pose_of(tilt=-0.4, turn=0.3)
DISC, PLANE = surface.Disc(0.12, 0.046), surface.Plane(0.12, 0.08)
LAMP = surface.point_lamp((0.03, 0.08, 0.3), 0.09)
MATERIAL = surface.Material(0.02, 0.1, 0.1)


def timed(mitsuba, described, repeat):
    """Return the mean of the pictures, the first time and the median of the others."""
    begin = time.perf_counter()
    scene = mitsuba.load_dict(described)
    times, pictures = [], []
    for seed in range(repeat + 1):
        pictures.append(np.array(mitsuba.render(scene, seed=seed))[..., :3].astype(float))
        times.append(time.perf_counter() - begin)
        begin = time.perf_counter()
    assert all(np.isfinite(one).all() for one in pictures)
    return np.mean(pictures, axis=(0, 1, 2)), times[0], float(np.median(times[1:]))


def under_a_room(table, room, view):
    """Return the mean picture of the plane in a room, by correlation."""
    seen = surface.see(PLANE, view, POSE)
    towards = seen.frames[seen.hit][:, 13:16].astype(float) @ POSE.axes[:2].T
    light_of = surface.EnvironmentReflection(table, size=1023)(room, POSE.axes)
    return light_of.towards(towards).sum(axis=0, dtype=float) / seen.hit.size


def pattern_at_530():
    """Return a disc's orders at one wavelength, as a photograph would have them."""
    h = np.linspace(-1.0, 1.0, 1001)
    weights = 0.3 / np.maximum(np.abs(np.arange(-2, 3)), 1)
    lobes = [
        weight * np.exp(-((h - order * 530e-9 / 1.6e-6) ** 2) / 4e-3)
        for order, weight in zip(range(-2, 3), weights, strict=True)
    ]
    values = np.sum(lobes, axis=0)[None, :] * np.exp(-(h[:, None] ** 2) / 4e-3)
    return surface.diffraction_pattern(values, 1.0, 530e-9)


def rows_of(asked):
    """Yield name, first and median time, ratio of means to ours (or None)."""
    view = surface.view_from((0.0, 0.0, 0.3), shape=(asked.rows, asked.columns), field_of_view=0.45)
    scene = surface.Scene((LAMP,), view, POSE, MATERIAL)
    table = surface.table_from_grating("cd", size=512)

    mitsuba = plugin.use()
    described = surface.mitsuba_scene(scene, table, DISC, asked.samples)
    mean, first, again = timed(mitsuba, described, asked.repeat)
    ours = surface.render(scene, table, DISC, samples=4).pixels[..., :3].mean(axis=(0, 1), dtype=float)
    yield "disc, lamp", first, again, mean / ours

    metal = {**described, "shape": {**described["shape"], "bsdf": {"type": "roughconductor"}}}
    _, first, again = timed(mitsuba, metal, asked.repeat)
    yield "disc, lamp, roughconductor", first, again, None

    room = surface.lamps_and_windows(128)
    bare = surface.Scene((), view, POSE, surface.Material())
    described = surface.mitsuba_scene(bare, table, PLANE, asked.samples, room)
    mean, first, again = timed(mitsuba, described, asked.repeat)
    yield "plane, room", first, again, mean / under_a_room(table, room, view)

    mitsuba = plugin.use("llvm_ad_spectral")
    pattern = pattern_at_530()
    lit = surface.Scene((LAMP,), view, POSE, surface.Material())
    described = surface.mitsuba_scene(lit, pattern, DISC, asked.samples, spectrum="D65")
    mean, first, again = timed(mitsuba, described, asked.repeat)
    table = surface.table_from_pattern(pattern, "D65", size=1024)
    ours = surface.render(lit, table, DISC, samples=4).pixels[..., :3].mean(axis=(0, 1), dtype=float)
    yield "disc, lamp, spectral", first, again, mean / light.to_xyz(ours, white=table.white)


def main():
    """Print a line a scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, value in (("rows", 540), ("columns", 960), ("samples", 64), ("repeat", 3)):
        parser.add_argument(f"--{name}", type=int, default=value)
    asked = parser.parse_args()
    import mitsuba

    versions = f"Mitsuba {mitsuba.__version__}, Python {platform.python_version()}"
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} CPUs, {versions}")
    print(f"{asked.columns} x {asked.rows}, {asked.samples} samples a pixel; load {os.getloadavg()[0]:.1f}\n")
    print("| scene | first s | again s | mean over ours |\n|---|---|---|---|")
    for name, first, again, ratio in rows_of(asked):
        shown = "" if ratio is None else ", ".join(f"{part:.4f}" for part in ratio)
        print(f"| {name} | {first:.1f} | {again:.1f} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
