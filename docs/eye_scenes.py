"""Small scenes in which an eye's glare shows, after the test cases of the thesis (Delavennat 2021, 4.2).

    python docs/eye_scenes.py NAME PICTURE

sunset, stars, water, sizes, occlusion, colours, blinking, moving: what is drawn. Scenes are in candela per
square metre, drawn in perspective, and every seed is written here.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import Picture, glare, picture
from aureole.picture.transfer import decode_srgb

# Samples a pixel each way.
FINER = 4
Pixels = NDArray[np.float32]
Reals = NDArray[np.float64]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
ORANGE, AZURE, APPLE, WHITE = (1.0, 0.42, 0.02), (0.03, 0.35, 1.0), (0.45, 1.0, 0.08), (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class View:
    """A perspective picture: (rows, columns), and degrees across its columns."""

    shape: tuple[int, int]
    field: float

    def angles(self) -> tuple[Reals, Reals]:
        """Return degrees to the right of the middle and above it, FINER² for each pixel."""
        rows, columns = (FINER * length for length in self.shape)
        scale = 2 * np.tan(np.radians(self.field) / 2) / columns
        across = (np.arange(columns) + 0.5 - columns / 2) * scale
        up = -(np.arange(rows) + 0.5 - rows / 2) * scale
        x, y = np.meshgrid(across, up)
        return np.degrees(np.arctan(x)), np.degrees(np.arctan(y / np.hypot(x, 1)))

    def heights(self, horizon: float) -> Reals:
        """Return degrees above a straight horizon so many degrees above the middle, for each sample."""
        rows, columns = (FINER * length for length in self.shape)
        scale = 2 * np.tan(np.radians(self.field) / 2) / columns
        up = -(np.arange(rows) + 0.5 - rows / 2) * scale
        return np.repeat(np.degrees(np.arctan(up))[:, None] - horizon, columns, axis=1)

    def picture(self, samples: Reals) -> Picture:
        """Return the mean over each pixel of samples (rows, columns, 3)."""
        rows, columns = self.shape
        parts = samples.reshape(rows, FINER, columns, FINER, 3)
        return Picture(np.ascontiguousarray(parts.mean(axis=(1, 3)), dtype=np.float32), "rec709")


def tinted(colour: Sequence[float], luminance: float) -> Reals:
    """Return a linear colour of the luminance that is asked for."""
    values = np.asarray(colour, dtype=float)
    return np.asarray(values * (luminance / (values @ LUMINANCE)))


def disc(view: View, x: float, y: float, diameter: float) -> NDArray[np.bool_]:
    """Return which samples lie within a round source; all in degrees."""
    across, up = view.angles()
    return np.asarray(np.hypot(across - x, up - y) < diameter / 2)


def dark(view: View, luminance: float) -> Reals:
    """Return samples of an even, slightly blue darkness."""
    rows, columns = (FINER * length for length in view.shape)
    return np.tile(tinted((0.8, 0.95, 1.2), luminance), (rows, columns, 1))


def pattern(view: View, state: "glare.EyeState", source: tuple[float, float] = (0.0, 0.0)) -> Picture:
    """Return an eye's pattern that reaches from any pixel of a view to any other."""
    shape, field = glare.pattern_shape(view.shape), glare.pattern_field(view.shape, np.radians(view.field))
    return glare.eye_psf(state, shape, field, projection="perspective", source=source)


def seen(scene: Picture, view: View, state: "glare.EyeState") -> Picture:
    """Return what the eye makes of a scene; light that would leave the frame stays where it was."""
    return glare.eye_composite(scene, pattern(view, state), field_of_view=np.radians(view.field))


def shown(scene: Picture, stops: float) -> Pixels:
    """Return a picture for a screen."""
    return picture.to_display(scene, stops, "filmic")


def sheet(rows: Sequence[Sequence[Pixels]], gap: int = 6) -> Pixels:
    """Put pictures of one size below and beside each other, white between them."""
    strips = [picture.side_by_side(row, gap) for row in rows]
    line = np.ones((gap, strips[0].shape[1], 3), np.float32)
    parts = [part for strip in strips for part in (strip, line)]
    return np.concatenate(parts[:-1])


# Elevation of the sun in degrees, air masses towards it (Kasten and Young 1989), the sky's luminance, stops.
SUNSET = ((8.0, 6.9, 4000.0), (4.0, 12.3, 2200.0), (1.5, 22.0, 1000.0), (0.4, 33.0, 420.0))
# Optical depth of one air mass in red, green and blue, and the sun above the air.
DEPTHS, SUN, SUN_SIZE = (0.085, 0.125, 0.22), 1.9e9, 0.53


def sunset() -> Pixels:
    """The sun goes down: it dims by orders and turns orange, and its glare with it."""
    view = View((270, 480), 40.0)
    frames = []
    for elevation, masses, luminance in SUNSET:
        scene = view.picture(_evening(view, elevation, masses, luminance))
        state = glare.EyeState.at(1.0, luminance, field_of_view=np.radians(view.field), blinking=False)
        frames.append(shown(seen(scene, view, state), -np.log2(2.2 * luminance)))
    return sheet([frames[:2], frames[2:]])


def _evening(view: View, elevation: float, masses: float, luminance: float) -> Reals:
    """Return samples of a sun over the sea, the horizon four degrees below the middle."""
    x, _ = view.angles()
    height = view.heights(-4.0)
    sunlight = np.exp(-np.array(DEPTHS) * masses)
    glow = np.exp(-np.hypot(x, 1.6 * (height - elevation)) / 14)[..., None]
    low = np.exp(-np.abs(height) / 7)[..., None]
    warm = tinted(sunlight**0.35 * (1, 0.95, 0.9), luminance)
    blue = tinted((0.45, 0.7, 1.2), 0.55 * luminance)
    sky = blue * (1 - 0.75 * low) + warm * (0.75 * low + 1.2 * glow)
    sky[np.hypot(x, height - elevation) < SUN_SIZE / 2] += SUN * sunlight
    # The sea mirrors a fifth of the sky's light, more of the horizon's where a wave leans away.
    far = 2.0 / np.tan(np.radians(np.maximum(-height, 0.1)))
    _, lean = _slopes(far * np.tan(np.radians(x)), far)
    sea = 0.22 * (0.6 * blue + warm * np.exp(-((x / 5) ** 2))[..., None]) * (1 + 6 * lean[..., None])
    return np.where((height > 0)[..., None], sky, np.maximum(sea, 0))


def stars() -> Pixels:
    """A clear night: stars of all strengths, one bright planet, a far lamp."""
    view = View((360, 640), 20.0)
    generator = np.random.default_rng(5)
    samples = dark(view, 6e-4)
    scene = view.picture(samples)
    pixels, solid = scene.pixels, np.radians(view.field / view.shape[1]) ** 2
    count = 420
    # Ten times as many stars for every two magnitudes.
    magnitudes = np.concatenate([2 * np.log10(generator.uniform(0.02, 900, count)), [-4.2]])
    places = np.concatenate([generator.random((count, 2)) * np.array(view.shape), [(105.3, 455.6)]])
    heat = np.append(generator.normal(0, 0.25, count), -0.05)
    for magnitude, (row, column), warmth in zip(magnitudes, places, heat, strict=True):
        lux = 2.54e-6 * 10 ** (-0.4 * magnitude)
        colour = tinted((1 + warmth, 1, 1 - warmth), lux / solid)
        _splat(pixels, row, column, colour)
    state = glare.EyeState.at(2.0, 1e-3, field_of_view=np.radians(view.field), blinking=False)
    return shown(seen(scene, view, state), 3.2)


def _splat(pixels: Pixels, row: float, column: float, colour: Reals) -> None:
    """Share a star among the four pixels about it."""
    top, left = int(np.floor(row - 0.5)), int(np.floor(column - 0.5))
    down, right = row - 0.5 - top, column - 0.5 - left
    for i, j, share in (
        (0, 0, (1 - down) * (1 - right)),
        (0, 1, (1 - down) * right),
        (1, 0, down * (1 - right)),
        (1, 1, down * right),
    ):
        if 0 <= top + i < pixels.shape[0] and 0 <= left + j < pixels.shape[1]:
            pixels[top + i, left + j] += share * colour


def water() -> Pixels:
    """A low sun on ripples: hundreds of small, bright mirrors."""
    view = View((360, 640), 50.0)
    x, _ = view.angles()
    height = view.heights(6.0)
    down = np.maximum(-height, 0.1)
    # Places on the water, from an eye two metres above it.
    far = 2.0 / np.tan(np.radians(down))
    slope_x, slope_y = _slopes(far * np.tan(np.radians(x)), far)
    # A facet mirrors the sun where it stands half-way between the eye and the sun, 10 degrees high.
    off = np.hypot(slope_x - np.radians(x) / 2, slope_y - np.radians(10.0 - down) / 2)
    glints = 4e6 * np.exp(-((off / np.radians(0.27)) ** 2))[..., None] * tinted((1, 0.93, 0.8), 1.0)
    sea = tinted((0.35, 0.7, 0.9), 90.0) * np.clip(1 + 8 * slope_y, 0.3, 3)[..., None]
    scene = view.picture(np.where((height > 0)[..., None], dark(view, 900.0), sea + glints))
    state = glare.EyeState.at(3.0, 900.0, field_of_view=np.radians(view.field), blinking=False)
    return shown(seen(scene, view, state), -np.log2(2200.0))


def _slopes(x: Reals, z: Reals) -> tuple[Reals, Reals]:
    """Return the slopes of forty waves of random heading, the short ones left out where they are not seen."""
    generator = np.random.default_rng(8)
    slope_x, slope_y = np.zeros_like(x), np.zeros_like(x)
    for length in np.geomspace(0.12, 6.0, 40):
        heading, phase = generator.normal(0, 0.7), generator.uniform(0, 2 * np.pi)
        wave = np.cos(2 * np.pi * (x * np.sin(heading) + z * np.cos(heading)) / length + phase)
        steep = 0.028 * np.exp(-((z * z * 0.0003 / length) ** 2))
        slope_x += steep * np.sin(heading) * wave
        slope_y += steep * np.cos(heading) * wave
    return slope_x, slope_y


def sizes() -> Pixels:
    """Sources of three sizes (across) and three luminances (down)."""
    view = View((150, 220), 24.0)
    state = glare.EyeState.at(1.0, 1.0, field_of_view=np.radians(view.field), blinking=False)
    rows = []
    for luminance in (1e3, 2e4, 4e5):
        row = []
        for diameter in (0.15, 0.5, 1.6):
            samples = dark(view, 0.3)
            samples[disc(view, 0, 0, diameter)] = tinted(WHITE, luminance)
            row.append(shown(seen(view.picture(samples), view, state), -4.5))
        rows.append(row)
    return sheet(rows)


def occlusion() -> Pixels:
    """An orange source, free and behind things; last, the thesis's threshold in each channel by itself."""
    view = View((180, 260), 24.0)
    state = glare.EyeState.at(1.0, 3.0, field_of_view=np.radians(view.field), blinking=False)
    x, y = view.angles()
    source = disc(view, 0, 0, 2.4)
    light = tinted(ORANGE, 2e4)
    below = y < 0.0
    comb = below & (np.abs((x / 0.5) % 1 - 0.5) < 0.28)
    frames = []
    for cover, share in ((None, 1.0), (below, 0.0), (comb, 0.0), (below, 0.5), (np.ones_like(below), 0.5)):
        samples = dark(view, 1.0)
        samples[source] = light
        if cover is not None:
            samples[cover] *= share
        frames.append(shown(seen(view.picture(samples), view, state), -7.5))
    return sheet([frames[:3], [*frames[3:], _channelwise(view, state, source, light)]])


def _channelwise(view: View, state: "glare.EyeState", source: NDArray[np.bool_], light: Reals) -> Pixels:
    """Return the half-covered source under Eq. 3.2 of the thesis: each channel less 0.9, below it nothing."""
    samples = dark(view, 1.0)
    # The source's green stands just below 0.9 of the picture's white once it is half covered.
    white = light[1] * 0.5 / 0.88
    samples[source] = 0.5 * light
    scene = view.picture(samples)
    over = np.maximum(scene.pixels - np.float32(0.9 * white), 0) * np.float32(
        1 / (1 - 0.9 * white / light[0])
    )
    spread = seen(Picture(np.ascontiguousarray(over), "rec709"), view, state)
    return shown(Picture(scene.pixels + spread.pixels, "rec709"), -7.5)


def colours() -> Pixels:
    """Colours that break where channels are cut one by one: azure, orange, apple green."""
    view = View((300, 640), 50.0)
    samples = dark(view, 0.5)
    for place, colour in zip((-15.0, 0.0, 15.0), (AZURE, ORANGE, APPLE), strict=True):
        samples[disc(view, place, 0, 0.9)] = tinted(colour, 3e5)
    state = glare.EyeState.at(1.0, 2.0, field_of_view=np.radians(view.field), blinking=False)
    return shown(seen(view.picture(samples), view, state), -5.5)


def blinking() -> Pixels:
    """A lamp while the lids come down: it dims, the streaks grow and bend, less of the pupil is left."""
    view = View((270, 270), 16.0)
    open_eye = glare.EyeState.at(1.0, 1.0, field_of_view=np.radians(view.field), blinking=False)
    scene = view.picture(_lamp(view, 0.0, 0.0))
    frames = []
    for opening in (1.0, 0.6, 0.4, 0.25):
        state = replace(open_eye, lid_opening=opening)
        through = seen(scene, view, state)
        dimmed = through.pixels * np.float32(glare.open_share(state) / glare.open_share(open_eye))
        frames.append(shown(Picture(dimmed, "rec709"), -5.3))
    return sheet([frames])


def _lamp(view: View, x: float, y: float) -> Reals:
    """Return samples of a small, warm lamp in the dark."""
    samples = dark(view, 0.1)
    samples[disc(view, x, y, 0.08)] = tinted((1, 0.93, 0.8), 6e6)
    return samples


def moving() -> Pixels:
    """Three lamps in one wide frame: other lashes stand in the way of each."""
    view = View((320, 960), 48.0)
    open_eye = glare.EyeState.at(1.0, 0.3, field_of_view=np.radians(view.field), blinking=False)
    state = replace(open_eye, lid_opening=0.75)
    samples = sum(_lamp(view, x, y) for x, y in ((-16.0, 1.0), (0.0, 0.0), (16.0, -1.0)))
    ready = glare.eye_field(partial(pattern, view, state), view.shape, np.radians(view.field), (1, 7))
    return shown(glare.eye_composite(view.picture(samples), ready), -5.3)


def draw(name: str, path: Path) -> None:
    """Draw a scene and write it."""
    pixels = SCENES[name]()
    picture.write(path, Picture(decode_srgb(np.ascontiguousarray(pixels, dtype=np.float32)), "rec709"))


SCENES: dict[str, Callable[[], Pixels]] = {
    "sunset": sunset,
    "stars": stars,
    "water": water,
    "sizes": sizes,
    "occlusion": occlusion,
    "colours": colours,
    "blinking": blinking,
    "moving": moving,
}

if __name__ == "__main__":
    draw(sys.argv[1], Path(sys.argv[2]))
