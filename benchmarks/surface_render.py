"""Time pictures of diffractive surfaces: a compact disc under a lamp, and a mesh of many triangles.

    python benchmarks/surface_render.py [--runs 31] [--size 2048] [--picture disc.png]

The disc is that of the preset `cd`, seen from above by an eye beside the lamp, so that its first order lies
around the middle as a rainbow, violet inside; it fills the picture of 960 x 540 so that about half of its
pixels see it. One sample a pixel, one lamp, a mirror-like lobe. Wall is the time that passes; CPU is that of
all threads together, which other programs on the machine disturb less. The ball has 100 352 triangles with a
normal and texture coordinates at each corner, and casts shadows on itself. Before the first picture the
kernels are compiled, once for a machine and a version: its time is shown first, with caches as they are.
"""

import argparse
import os
import platform
import statistics
import time
from functools import partial

import numpy as np

from aureole import picture, surface
from aureole.records import Picture


def disc_scene():
    """Return the scene of the disc: lamp and eye above its middle."""
    view = surface.view_from((0.0, 0.0, 0.18), shape=(540, 960))
    lamps = (surface.point_lamp((0.015, 0.012, 0.19), 0.3),)
    return surface.Scene(lamps, view, material=surface.Material(specular=0.02, roughness=0.05))


def ball(count=225):
    """Return a sphere of triangles."""
    v, u = (part.ravel() for part in np.meshgrid(*[np.linspace(0, 1, count)] * 2, indexing="ij"))
    x, z = np.sin(np.pi * v) * np.sin(2 * np.pi * u), np.sin(np.pi * v) * np.cos(2 * np.pi * u)
    corners = 0.05 * np.stack([x, -np.cos(np.pi * v), z], axis=1)
    i = np.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]))
    triangles = np.vstack([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    return surface.mesh_of(corners, triangles, normals=corners, texture=np.stack([u, v], 1))


def timed(work, runs):
    """Return medians of wall and CPU milliseconds, and the least CPU's."""
    walls, cpus = [], []
    for _ in range(runs):
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        cpus.append(1e3 * (time.process_time() - cpu))
        walls.append(1e3 * (time.perf_counter() - wall))
    return statistics.median(walls), statistics.median(cpus), min(cpus)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--runs", type=int, default=31)
    parser.add_argument("--size", type=int, default=2048, help="samples along the table's sides")
    parser.add_argument("--picture", help="where to write the disc's picture")
    options = parser.parse_args()
    print(f"{platform.platform()}, Python {platform.python_version()}, {os.cpu_count()} processors,", end=" ")
    print(f"load {os.getloadavg()[0]:.1f}")
    scene, table = disc_scene(), surface.table_from_grating("cd", size=options.size)
    prepared = surface.shader(table, scene.material)
    mesh = ball()
    shapes = [("disc", surface.Disc(0.12, 0.046)), ("disc, 2 x 2", surface.Disc(0.12, 0.046))]
    shapes += [("cylinder", surface.Cylinder(0.05, 0.09)), (f"{len(mesh.triangles)} triangles", mesh)]
    print("| shape | first, s | share seen | wall, ms | CPU, ms (least) | CPU, ns a sample seen |")
    print("|---|---|---|---|---|---|")
    for name, shape in shapes:
        samples = 2 if "2 x 2" in name else 1
        start = time.perf_counter()
        drawn = surface.render(scene, prepared, shape, samples)
        first = time.perf_counter() - start
        runs = options.runs if samples == 1 else max(1, options.runs // 4)
        wall, cpu, least = timed(partial(surface.render, scene, prepared, shape, samples), runs)
        seen = float((drawn.pixels[..., 3] > 0).mean())
        each = 1e6 * cpu / max(1.0, seen * drawn.pixels[..., 3].size * samples**2)
        print(f"| {name} | {first:.1f} | {seen:.3f} | {wall:.1f} | {cpu:.1f} ({least:.1f}) | {each:.0f} |")
        if options.picture and name == "disc":
            bright = np.percentile(drawn.pixels[..., :3].max(axis=2), 90)
            picture.write(options.picture, Picture(drawn.pixels[..., :3] / bright, drawn.colour_space))


if __name__ == "__main__":
    main()
