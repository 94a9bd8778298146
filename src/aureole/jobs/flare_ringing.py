"""Ghosts whose ringing is that of what the housing leaves of the iris (quad paper §6.2, Fig. 15).

Each ghost's light meets other rims on its way, and each light's, so each has a texture of its own.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from aureole import aperture as apertures
from aureole import diffraction, flare
from aureole.flare import GhostPath, Lens
from aureole.records import Aperture, Light, Picture, Stage


def cropped_stages(
    lens: Lens,
    lights: Sequence[Light],
    paths: Sequence[GhostPath],
    shape: tuple[int, int],
    iris: Aperture,
    fresnel_number: float,
    **how: Any,
) -> Iterator[Stage]:
    """Draw ghosts one by one, each light's with its own ringing.

    Parameters
    ----------
    lens : Lens
        The lens.
    lights : sequence of Light
        Before it.
    paths : sequence of GhostPath
        The ghosts.
    shape : tuple of int
        (rows, columns).
    iris : Aperture
        As along the axis; its width stands for the stop's diameter.
    fresnel_number : float
        Of the fringes, as in `aureole.diffraction.ringing_texture`.
    **how : object
        Further options of `aureole.flare.render`.

    Yields
    ------
    Stage
        The last one holds the picture, XYZ.
    """
    whole: diffraction.RingingTexture | None = None
    total = np.zeros((*shape, 3))
    pairs = [(path, lamp) for path in paths for lamp in lights]
    for number, (path, lamp) in enumerate(pairs):
        yield Stage(number / len(pairs), f"ghost {path.name}")
        outline = flare.stop_outline(lens, path, lamp.direction, iris, how.get("f_number"))
        if outline is None:
            whole = whole or diffraction.ringing_texture(iris, fresnel_number)
            texture = whole
        else:
            left = apertures.intersection(iris, outline)
            texture = diffraction.ringing_texture(left, fresnel_number)
        made = flare.render(lens, [lamp], shape, ghosts=[path], iris=texture, **how)
        total += made.pixels
    yield Stage(1.0, "ghosts", Picture(total.astype(np.float32), "xyz"))
