"""Even patterns with known shares, quick to make, in place of an eye's."""

import math

import numpy as np

from aureole.glare.glare_frames import pattern_shape

SHARES = {"halo": 0.05, "corona": 0.2, "streaks": 0.1}
NODES = {
    "bloom": {"pupil_diameter": (2e-3, 8e-3)},
    "halo": {"pupil_diameter": (4e-3, 6e-3, 8e-3)},
    "corona": {"pupil_diameter": (2e-3, 8e-3), "vitreous_angle": (-0.1, 0.0, 0.1)},
    "streaks": {"lid_opening": (0.2, 1.0)},
}


def patterns(shape, resolution="full"):
    """Return a function of a component's name and a state: its pattern and share."""
    reach = pattern_shape(shape, resolution)
    y, x = (np.arange(n) - n // 2 for n in reach)

    def pattern(name, state):
        seed = [*name.encode(), round(state.pupil_diameter * 1e6), 1000 + round(state.vitreous_angle * 1e3)]
        speckle = np.random.default_rng(seed).exponential(1, (*reach, 3))
        width = 20e-3 / state.pupil_diameter * (0.5 if name == "bloom" else 2)
        steep = 3 if name == "streaks" else 1
        found = (speckle + speckle[::-1, ::-1]) / (width**2 + y[:, None] ** 2 + (steep * x) ** 2)[
            ..., None
        ] ** 1.3
        share = SHARES.get(name, 1 - math.fsum(SHARES.values()))
        share *= {"halo": state.pupil_diameter / 8e-3, "streaks": state.lid_opening}.get(name, 1)
        return found / found.sum(axis=(0, 1)) * 0.97, share

    return pattern


def lights(shape, seed=4, most=1e4):
    """A dark picture with lamps."""
    generator = np.random.default_rng(seed)
    picture = generator.lognormal(0, 0.5, (*shape, 3))
    lamps = generator.random(shape) > 0.98
    picture[lamps] *= generator.uniform(10, most, (int(lamps.sum()), 1))
    return picture.astype(np.float32)
