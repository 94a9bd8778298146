"""A lens's ghosts as a table: which surfaces make them, and how much light each carries."""

import math
from typing import Any

from aureole import flare, light
from aureole.flare import energy
from aureole.flare.ghost_paths import WHICH
from aureole.flare.lights import light_at
from aureole.flare.prescription import Lens
from aureole.jobs.lens_drawing import field_angle

FOLLOWED = 400


def lens_ghosts(
    lens: Lens,
    angles: tuple[float, float] | None = None,
    which: str = "top:20",
    f_number: float | None = None,
    illuminant: str = "E",
    within: str = "frame",
    bounces: int = 2,
) -> dict[str, Any]:
    """Return a lens's ghosts for one light, the strongest first.

    Parameters
    ----------
    lens : Lens
        The lens.
    angles : tuple of float, optional
        Of the light to the right and downward, radians; without it half way to the picture's lower edge.
    which : str
        "same-side", "paper" or "all" for all of these; "top:20" or "90%" for the strongest of all.
    f_number : float, optional
        Wide open without it.
    illuminant : str
        The light's spectrum.
    within : {"plane", "frame"}
        All that reaches the sensor's plane, or what falls on the sensor.
    bounces : {2, 4}
        Reflections of each ghost; of four the `FOLLOWED` strongest by few rays are followed closely.

    Returns
    -------
    dict
        "ghost_to_image" is all ghosts' light over that of the light's image; "ghosts" lists each with its
        "energy" over the image, its "share" of the ghosts' light, and the "cumulative" one.

    Raises
    ------
    refuse.Refusal
        Where a word is unknown or the light is not in front of the lens.
    """
    energy.checked(which)
    x, y = angles or (0.0, field_angle(lens) / 2.0)
    source = light_at(x, y, light.illuminant(illuminant))
    pool = which if which in WHICH else "all"
    paths = flare.four_bounces(lens, pool) if bounces == 4 else flare.ghosts(lens, pool)
    count = len(paths)
    if bounces == 4:
        paths = energy.shortlist(lens, paths, source, FOLLOWED, f_number)
    every = energy.ranked(lens, paths, source, f_number, within=within)
    shown = every if which in WHICH else energy.strongest(every, which)
    total = sum(path.energy or 0.0 for path in every)
    lines, sum_so_far = [], 0.0
    for path in shown:
        share = (path.energy or 0.0) / total if total else 0.0
        sum_so_far += share
        lines.append(
            {"ghost": path.name, "energy": path.energy, "share": share, "cumulative": min(sum_so_far, 1.0)}
        )
    return {
        "lens": lens.name,
        "light_deg": [math.degrees(x), math.degrees(y)],
        "f_number": f_number,
        "out_of": {"which": pool, "bounces": bounces, "count": count},
        "ghost_to_image": total,
        "ghosts": lines,
    }
