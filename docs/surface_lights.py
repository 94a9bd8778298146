"""Draw diffractive samples under lamps that are no points and in light from all around.

    python docs/surface_lights.py NAME PICTURE

hero: a compact disc in a hall, a lamp beside the camera.
lamps: a lamp of two LEDs: their two pictures added up, the lamp's mirror image, and one table that was
convolved with it (Fig. 22). Prints how far the last is from the first.
rooms: two screens and a sheet of holographic paper in two rooms (Fig. 23).
prefilter: a line across a sheet in a room, by the integral, by one correlation, and by the paper's
reflection map (Fig. 24). Prints how far the last two are from the first.
turned: a screen turned about its normal; the streaks turn with it (section 7).
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from surface_sheets import (
    COMPACT_DISC,
    ROOM_ROWS,
    SCREEN,
    SHEET,
    Pixels,
    drawn,
    facing,
    hall,
    holographic,
    lamp,
    sheet,
    shown,
    write,
)

from aureole import Picture, picture, surface

# The lamp's two LEDs: place before the sample's middle, radius (metres), colour.
LEDS = (
    ((-0.007, 0.0, 0.4), 0.0012, np.array([1.0, 0.62, 0.30])),
    ((0.007, 0.0, 0.4), 0.0012, np.array([0.62, 0.80, 1.0])),
)
STEP = 0.0006


def lamps() -> Pixels:
    """Return a screen under two LEDs, the lamp's mirror image, and the screen by a convolved table."""
    table = surface.table_from_grating("lcd-342ppi", size=1024, half_range=0.6)
    view = facing((280, 280), 0.056, 0.4)
    truth = np.zeros((280, 280, 3))
    for place, radius, colour in LEDS:
        for white in lamp(place, 1.0, radius):
            truth += colour * drawn(table, SCREEN, view, (white,), samples=1).pixels[..., :3]
    mirror = mirror_image()
    shape = surface.lamp_from_reflection(mirror, STEP)
    whole = surface.convolved(table, shape)
    # The shape is about the middle of the lamp's light, where the point lamp stands for it.
    bright = [float(colour @ (0.2126, 0.7152, 0.0722)) for _, _, colour in LEDS]
    middle = np.average([place for place, _, _ in LEDS], axis=0, weights=bright)
    found = drawn(whole, SCREEN, view, lamp(tuple(middle))).pixels[..., :3]
    found = found * (truth.sum() / found.sum())
    print(f"two LEDs: mean difference {np.abs(found - truth).mean() / np.abs(truth).mean():.1%} of the mean")
    scale = np.percentile(truth[..., 1], 98.5)
    image = np.repeat(np.repeat(mirror.pixels, 3, axis=0), 3, axis=1)[13:293, 13:293]
    return sheet([[shown(truth / scale, 0.0), shown(image, -1.0), shown(found / scale, 0.0)]])


def hero() -> Pixels:
    """Return a compact disc in a hall."""
    table = surface.table_from_grating("cd", size=1024)
    view = surface.view_from((0.0, -0.03, 0.30), (0.0, -0.002, 0.0), (440, 840), np.radians(21))
    pose = surface.pose_of(tilt=np.radians(-28.0), turn=np.radians(-12.0))
    seen = surface.see(COMPACT_DISC, view, pose)
    around = surface.environment_light(seen, table, hall(), 1536)
    # Samples lie at pixels' middles; at the rim a pixel takes its neighbour's light, by how much is covered.
    nearest = ndimage.distance_transform_edt(~seen.hit, return_distances=False, return_indices=True)
    around = around[tuple(nearest)]
    lamps = (*lamp((0.03, 0.16, 0.30), 1.0, 0.004), *lamp((-0.25, 0.02, 0.25), 0.6, 0.004))
    material = surface.Material(diffuse=0.004)
    scene = surface.Scene(lamps, view, pose, material)
    under = surface.render(scene, table, COMPACT_DISC, 3).pixels
    return shown(around * under[..., 3:] + 0.5 * under[..., :3], -1.5)


def mirror_image() -> Picture:
    """Return what a mirror in the sample's place shows of the lamp, over h."""
    steps = (np.arange(102 * 8) - 407.5) / 8 * STEP
    pixels = np.zeros((102, 102, 3))
    for place, radius, colour in LEDS:
        inside = np.hypot(steps - place[0] / 0.4, steps[:, None]) < radius / 0.4
        pixels += inside.reshape(102, 8, 102, 8).mean(axis=(1, 3))[..., None] * colour
    return Picture(pixels.astype(np.float32), "rec709")


def in_room(
    table: "surface.ScatterTable",
    shape: "surface.Shape",
    view: "surface.View",
    room: "surface.Environment",
    frame: NDArray[np.float64],
) -> Picture:
    """Return a sample in light from all around, over black."""
    scene = surface.Scene((), view, surface.Pose(frame, np.zeros(3)), environment=room)
    return surface.render(scene, table, shape, 2)


def windows() -> "surface.Environment":
    """Return a room with windows and lamps on the sample's side."""
    room = surface.lamps_and_windows(ROOM_ROWS, 3)
    return surface.Environment(np.roll(room.radiance, ROOM_ROWS, axis=1), room.colour_space, room.name)


def rooms() -> Pixels:
    """Return two screens and holographic paper in two rooms."""
    rows = []
    samples = [
        (surface.table_from_grating("lcd-342ppi", size=1024), SCREEN),
        (surface.table_from_grating("lcd-534ppi", size=1024), SCREEN),
        (surface.table_from_grating(holographic(), size=1024), SHEET),
    ]
    for room, normal in ((hall(), (0.0, 0.17, 1.0)), (windows(), (0.03, 0.13, 1.0))):
        frame = surface.frame_of(normal, (1.0, 0.0, 0.0))
        line = []
        for table, shape in samples:
            height = 0.104 if shape is SCREEN else 0.13
            view = facing((330, 240 if shape is SCREEN else 330), height, 0.25)
            line.append(shown(in_room(table, shape, view, room, frame), -1.0))
        rows.append(line)
    return sheet(rows)


def turned() -> Pixels:
    """Return a screen in a room, turned about its normal."""
    table = surface.table_from_grating("lcd-342ppi", size=1024)
    view = facing((240, 240), 0.115, 0.25)
    pictures = []
    for turn in (0.0, 20.0, 45.0):
        frame = surface.frame_of((0.0, 0.17, 1.0), (1.0, 0.0, 0.0), np.radians(turn))
        pictures.append(shown(in_room(table, SCREEN, view, hall(), frame), -1.0))
    return sheet([pictures])


def prefilter(path: Path) -> None:
    """Draw a line across holographic paper in a room, three ways."""
    from matplotlib import pyplot

    table = surface.table_from_grating(holographic(), size=256)
    room = surface.lamps_and_windows(64, 3)
    room = surface.Environment(np.roll(room.radiance, 64, axis=1), room.colour_space)
    frame = surface.frame_of((0.03, 0.13, 1.0), (1.0, 0.0, 0.0))
    views = np.stack([np.linspace(-0.3, 0.3, 41), np.full(41, 0.1)], axis=1)
    truth = surface.quadrature(table, room, frame, views).radiance[:, 1]
    figure, axes = pyplot.subplots(figsize=(8.4, 3.2), layout="constrained")
    axes.plot(views[:, 0], truth, "o", color="#334155", ms=4, label="integral over all light")
    ways = {
        "one correlation": (surface.reflect(table, room, frame, 1023).towards(views)[:, 1], "#2563eb"),
        "the paper's map": (surface.prefiltered(table, room, frame, views)[:, 1], "#ea580c"),
    }
    for name, (found, colour) in ways.items():
        error = np.sqrt(np.mean((found - truth) ** 2)) / truth.mean()
        print(f"{name}: root mean square error {error:.3%} of the mean")
        axes.plot(views[:, 0], found, color=colour, lw=1.2, label=f"{name}: {error:.1%} off")
    axes.set(xlabel="view's direction cosine along the tangent", ylabel="green light", ylim=(0, None))
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.25)
    with picture.whole_file(path) as part:
        figure.savefig(part, format=path.suffix.removeprefix("."), dpi=100)
    pyplot.close(figure)


NAMES = {"hero": hero, "lamps": lamps, "rooms": rooms, "turned": turned}

if __name__ == "__main__":
    if sys.argv[1] == "prefilter":
        matplotlib.use("Agg")
        prefilter(Path(sys.argv[2]))
    else:
        write(NAMES[sys.argv[1]](), Path(sys.argv[2]))
