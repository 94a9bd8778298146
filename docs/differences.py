"""Draw near fields beside each other as the quad paper's Figures 6 and 7 do.

    python docs/differences.py levels FULL EIGHTH DIFFERENCE
    python docs/differences.py colours EXACT APPROXIMATE SCALED

levels: a heptagon behind a round shadow as 1024² pixels and as 128², and five times the difference.
colours: a heptagon in white light, every wavelength anew; one pattern scaled by 1 + 0.05 (1 − ρ); and scaled
as a far field is, which is wrong here.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import Grid, Picture, aperture, diffraction, light, picture

WIDTH, SIZE, EXTENT = 2e-3, 360, 2.6e-3
WAVELENGTH, MASK, TIMES = 550e-9, 1024, 5
LEVELS_AT, COLOURS_AT = 60, 30
GRID = Grid((SIZE, SIZE), (EXTENT / SIZE, EXTENT / SIZE))


def distance_of(fresnel_number: float) -> float:
    """Return the distance at which the opening has a Fresnel number, metres."""
    return (WIDTH / 2) ** 2 / (WAVELENGTH * fresnel_number)


def levels() -> list[NDArray[np.float32]]:
    """Return the paper's Figure 6 as three pictures of linear colour."""
    heptagon = aperture.shadow(aperture.iris(7, WIDTH), 0.2 * WIDTH, -0.12 * WIDTH, 0.45 * WIDTH)
    opening = aperture.from_mask(aperture.rasterize(heptagon, MASK), WIDTH)
    full, eighth = (
        diffraction.near_power(opening, GRID, distance_of(LEVELS_AT), WAVELENGTH, "quads", finest=finest)
        for finest in ("full", "eighth")
    )
    grey = (full, eighth, TIMES * np.abs(full - eighth))
    brightest = max(float(full.max()), float(eighth.max()))
    return [np.repeat(each[..., None], 3, axis=2) / np.float32(brightest) for each in grey]


def colours() -> list[NDArray[np.float32]]:
    """Return the paper's Figure 7 as three pictures of linear colour."""
    heptagon, lamp = aperture.iris(7, WIDTH), light.illuminant("E")
    ways = (("exact", 0.05), ("approximate", 0.05), ("approximate", -1.0))
    found = [
        light.convert(
            diffraction.near_picture(
                heptagon, GRID, distance_of(COLOURS_AT), lamp, way, samples=60, strength=strength
            ),
            "rec709",
        ).pixels
        for way, strength in ways
    ]
    return [each / np.float32(found[0].max()) for each in found]


def draw(kind: str, paths: list[Path]) -> None:
    """Write the pictures of one figure."""
    for pixels, path in zip({"levels": levels, "colours": colours}[kind](), paths, strict=True):
        picture.write(path, Picture(np.ascontiguousarray(np.clip(pixels, 0, 1)), "rec709"))


if __name__ == "__main__":
    draw(sys.argv[1], [Path(name) for name in sys.argv[2:]])
