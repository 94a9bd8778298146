"""A room with lamps and windows, made by code: light from all around for tests and examples.

In: a size and a seed; out: an `Environment`. Radiance is relative: walls a tenth, windows tens, lamps
thousands, as lamps are that are not covered.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.surface.environment import Environment

LAMPS = 14
# Longitude and latitude of the middle, width and height, in radians: two windows ahead, one behind.
WINDOWS = ((-0.75, 0.25, 0.55, 0.7), (0.35, 0.25, 0.55, 0.7), (2.6, 0.2, 0.4, 0.5))
DAYLIGHT = (18.0, 22.0, 28.0)
WARM, COOL = np.array([1.0, 0.72, 0.42]), np.array([0.85, 0.95, 1.0])


def lamps_and_windows(rows: int = 256, seed: int = 1) -> Environment:
    """Make a room with walls, three windows and small lamps.

    Parameters
    ----------
    rows : int
        Height of the latitude-longitude picture; it is twice as wide. Another size shows the same room.
    seed : int
        Of the lamps' places, sizes and colours.

    Returns
    -------
    Environment
        In linear Rec.709.
    """
    count = refuse.at_least("rows", rows, 16)
    generator = np.random.default_rng(refuse.at_least("seed", seed, 0))
    latitude = np.pi / 2 - np.pi * (np.arange(count) + 0.5) / count
    longitude = np.pi * ((np.arange(2 * count) + 0.5) / count - 1.0)
    radiance = _walls(latitude, 2 * count)
    for window in WINDOWS:
        cover = _window(latitude, longitude, window, np.pi / count)
        radiance += cover[..., None] * (np.asarray(DAYLIGHT) - radiance)
    toward = _unit(latitude[:, None], longitude[None, :])
    for _ in range(LAMPS):
        # Lamps hang anywhere but straight below, and are half a degree to two degrees wide.
        where = _unit(np.arcsin(generator.uniform(-0.3, 0.95)), generator.uniform(-np.pi, np.pi))
        radius, warmth = np.deg2rad(generator.uniform(0.25, 1.0)), generator.uniform()
        colour = generator.uniform(1000.0, 4000.0) * (warmth * WARM + (1.0 - warmth) * COOL)
        cover = np.clip((radius - np.arccos(np.clip(toward @ where, -1, 1))) * count / np.pi + 0.5, 0, 1)
        radiance += cover[..., None] * colour
    return Environment(radiance.astype(np.float32), "rec709", f"lamps and windows {seed}")


def _walls(latitude: NDArray[np.float64], columns: int) -> NDArray[np.float64]:
    """Walls that get lighter upwards, the same all around."""
    height = 0.5 + 0.5 * np.sin(latitude)
    shade = 0.04 + 0.16 * height[:, None] * np.array([1.0, 0.95, 0.88])
    return np.repeat(shade[:, None, :], columns, axis=1)


def _window(
    latitude: NDArray[np.float64],
    longitude: NDArray[np.float64],
    window: tuple[float, float, float, float],
    pixel: float,
) -> NDArray[np.float64]:
    """The share of each pixel that a window covers."""
    middle, up, width, height = window
    across = np.abs((longitude - middle + np.pi) % (2 * np.pi) - np.pi)
    columns = np.clip((width / 2 - across) / pixel + 0.5, 0, 1)
    rows = np.clip((height / 2 - np.abs(latitude - up)) / pixel + 0.5, 0, 1)
    return np.asarray(rows[:, None] * columns[None, :], dtype=np.float64)


def _unit(
    latitude: NDArray[np.float64] | float, longitude: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Directions in the world: x right, y up, the middle of the picture towards −z."""
    parts = np.broadcast_arrays(
        np.cos(latitude) * np.sin(longitude), np.sin(latitude), -np.cos(latitude) * np.cos(longitude)
    )
    return np.stack(parts, axis=-1)
