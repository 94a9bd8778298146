"""The preset "railing", 48 frames of 960 x 540: its light against areas, and its changes against a bound.

    aureole lights glare railing -o FOLDER/shot.####.exr --samples 5
    python benchmarks/occlusion.py FOLDER

Reads the frames that the command has written, takes the background away (the railing stands still), and
compares each with the lamp's visible area, found anew: bars' shadows cut the iris strip by strip, for many
points of the lamp. The change from frame to frame, moved back by the lamp's five pixels, is held against

    sum over points w (sqrt(D (D + 4 I)) + 2 D) / A,

D and I being what of the iris one frame shows and the other does not, and what both show, A the iris. The
root bounds the change of the spread, by Cauchy and Schwarz; 2 D bounds that of the lamp's visible part.
"""

import sys
from pathlib import Path

import numpy as np

from aureole import glare, jobs, light, picture
from aureole.glare.camera import pupil
from aureole.jobs.lamp_glare import seen_past
from aureole.jobs.scene import scene_at

POINTS, STRIPS, STEP = 81, 20001, 5


def chords(vertices, x):
    """Return how high a convex polygon is at each place."""
    low, high = np.full(x.shape, np.inf), np.full(x.shape, -np.inf)
    for (ax, ay), (bx, by) in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if ax == bx:
            continue
        inside = (x >= min(ax, bx)) & (x <= max(ax, bx))
        y = ay + (by - ay) * (x - ax) / (bx - ax)
        low, high = np.where(inside, np.minimum(low, y), low), np.where(inside, np.maximum(high, y), high)
    return np.where(high > low, high - low, 0.0)


def openness(scene, file, x):
    """Return for points across the lamp which strips of the iris are open, and the points' weights."""
    lamp, bars = scene.lamps[0].light, file.scene.occluders[0]
    half = lamp.shape.width / 2
    at = (np.arange(POINTS) + 0.5) / POINTS * 2 - 1
    weights = np.sqrt(1 - at**2)
    toward = lamp.toward[0] + half * at
    distance = bars.distance_m
    crossed = x[None, :] * (1 - distance / lamp.distance) + distance * toward[:, None]
    pitch = (bars.bar_mm + bars.gap_mm) * 1e-3
    # An odd number of bars has one in the middle.
    off = np.abs((crossed + pitch / 2) % pitch - pitch / 2)
    return off > bars.bar_mm * 1e-3 / 2, weights / weights.sum()


def main() -> None:
    folder = Path(sys.argv[1])
    file = jobs.read_scene("railing")
    first = scene_at(file, 1)
    iris = pupil(first.camera)
    x = np.linspace(-iris.width / 2, iris.width / 2, STRIPS)
    height = chords(iris.outlines[0].vertices, x)
    whole = height.sum()
    lamp = first.lamps[0]
    unhidden = np.asarray(lamp.radiance) * glare.lamp_patch(first.camera, lamp.light).pixels
    behind = seen_past(first, first.background)
    luminance = light.SPACES["rec709"].to_xyz[1]
    print("frame  visible  light  difference   change  bound")
    before, worst, ratios = None, 0.0, []
    for number in range(1, file.scene.frames + 1):
        pixels = picture.read(folder / f"shot.{number:04d}.exr").pixels - behind
        shares = (pixels / unhidden) @ luminance
        opened, weights = openness(scene_at(file, number), file, x)
        visible = float(weights @ (opened @ height)) / whole
        total = float(shares.sum(dtype=np.float64))
        worst = max(worst, abs(total - visible))
        line = f"{number:5d}  {visible:7.4f}  {total:6.4f}  {total - visible:+9.4f}"
        if before is not None:
            old_shares, old_opened = before
            change = float(np.abs(shares[:, STEP:] - old_shares[:, :-STEP]).sum(dtype=np.float64))
            one, both = (opened ^ old_opened) @ height, (opened & old_opened) @ height
            bound = float(weights @ (np.sqrt(one * (one + 4 * both)) + 2 * one)) / whole
            ratios.append(change / bound)
            line += f"    {change:6.4f}  {bound:6.4f}"
        print(line)
        before = shares, opened
    print(f"largest difference of light from visible area: {worst:.4f} of the unhidden lamp's light")
    print(f"largest change over its bound: {max(ratios):.3f}")


if __name__ == "__main__":
    main()
