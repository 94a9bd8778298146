"""The far shore of the night scene: hills, a town on the left, a suspension bridge."""

from collections.abc import Iterator

import numpy as np

from aureole.picture._canvas import PIXEL, Canvas, tint, turbulence

HORIZON = 0.60
TOWERS = (0.52, 0.80)


def hills(canvas: Canvas, generator: np.random.Generator) -> None:
    """Two ranges of hills, the farther one paler."""
    rows = canvas.rows(0.3, HORIZON)
    for scale, height, grain, colour in (
        (1.6, 0.045, 0.025, (0.014, 0.019, 0.042)),
        (3.1, 0.022, 0.014, (0.005, 0.0062, 0.013)),
    ):
        swell = 0.5 + 0.5 * np.tanh((canvas.x - 1.0) * 2.2)
        ridge = turbulence(canvas.x * scale, np.full_like(canvas.x, scale), generator, 6)
        top = HORIZON - height * (0.5 + 1.1 * swell) - grain * ridge
        canvas.cover((rows, slice(None)), canvas.below(top, rows, slice(None)), colour)


def city(canvas: Canvas, generator: np.random.Generator) -> None:
    """A town on the left shore: dark blocks, some windows lit, two neon signs."""
    blocks = [(0.325, 0.0150, 0.094), (0.372, 0.0215, 0.070)]  # the two that carry the signs
    for x in np.arange(0.225, 0.50, 0.0075):
        tallest = 0.020 + 0.085 * np.exp(-(((x - 0.345) / 0.07) ** 2))
        blocks.append((x, generator.uniform(0.007, 0.015), 0.016 + generator.random() * tallest))
    for x, width, height in blocks:
        shade = generator.uniform(0.5, 1.4)
        canvas.rectangle(
            x, HORIZON - height, x + width, HORIZON, (0.005 * shade, 0.0048 * shade, 0.0065 * shade)
        )
    for x, width, height in blocks:
        for left, top in _windows(x, width, height):
            chance, bright, kind = generator.random(3)
            if chance < 0.33:
                name = "sodium" if kind < 0.2 else "warm" if kind < 0.7 else "white" if kind < 0.9 else "cool"
                colour = tint(name, 1.5 * 30.0**bright)
                canvas.rectangle(left, top, left + 0.0012, top + 0.0016, tuple(colour))
    canvas.rectangle(0.3310, 0.512, 0.3340, 0.548, tuple(tint("magenta", 700)))
    canvas.rectangle(0.3750, 0.5330, 0.3905, 0.5358, tuple(tint("cyan", 900)))
    for x in np.arange(0.0, 0.86, 0.011):  # the far shore's road
        name = ("sodium", "sodium", "warm", "white")[int(generator.integers(4))]
        flux = tint(name, 200 * 10 ** generator.random()) * PIXEL**2
        canvas.splat(
            x + generator.uniform(-0.004, 0.004), HORIZON - generator.uniform(0.003, 0.009), PIXEL / 2, flux
        )


def _windows(x: float, width: float, height: float) -> Iterator[tuple[float, float]]:
    for top in np.arange(HORIZON - height + 0.003, HORIZON - 0.006, 0.0044):
        for left in np.arange(x + 0.0012, x + width - 0.002, 0.0029):
            yield float(left), float(top)


def bridge(canvas: Canvas) -> None:
    """A suspension bridge from the town to the hills on the right."""
    steel = (0.004, 0.0042, 0.006)
    for x in TOWERS:
        canvas.rectangle(x - 0.0035, 0.38, x - 0.0017, HORIZON, steel)
        canvas.rectangle(x + 0.0017, 0.38, x + 0.0035, HORIZON, steel)
        for y in (0.383, 0.43, 0.48, 0.53):
            canvas.rectangle(x - 0.0035, y, x + 0.0035, y + 0.003, steel)
    canvas.rectangle(0.40, 0.570, 0.98, 0.5745, steel)
    sag = 0.38 + 0.175 * (1 - ((canvas.x - 0.66) / 0.14) ** 2)
    shore = 0.38 + 0.19 * np.clip((np.abs(canvas.x - 0.66) - 0.14) / 0.14, 0, 1) ** 0.8
    cable = np.where(np.abs(canvas.x - 0.66) < 0.14, sag, shore)
    rows, columns = canvas.rows(0.37, 0.58), canvas.columns(0.38, 0.94)
    share = np.diff(canvas.below(np.stack([cable - 0.0008, cable + 0.0008]), rows, columns), axis=0)[0]
    canvas.cover((rows, columns), -share, steel)
    for x in np.arange(0.415, 0.91, 0.01):
        top = float(np.interp(x, canvas.x, cable))
        canvas.rectangle(x, top, x + 0.0004, 0.571, steel)
