"""Draw diffractive samples under lamps, after the figures of the surface paper (Toisoul and Ghosh 2017).

    python docs/surface_pictures.py NAME PICTURE

discs: compact disc, DVD and Blu-ray, seen from above and from aside.
spectra: a screen under equal energy, incandescent, its inverse, and fluorescent light (Fig. 15).
cylinder: a sheet of holographic paper, flat and bent (Fig. 17).
blazed: 600 lines per millimetre as slits and as blazed facets (Fig. 19).
mask: a radial pattern on a whole sheet, the mask, and the pattern on its stripes (Fig. 20).
disc: a compact disc beside the lamp (Fig. 21).
focus: a screen's edge sharp, and its pattern sharp (section 7).
regions: a sheet of four patterns, and one whose lines turn from place to place (Fig. 25).
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from surface_sheets import (
    COMPACT_DISC,
    SCREEN,
    SHEET,
    Pixels,
    drawn,
    facing,
    holographic,
    lamp,
    sheet,
    shown,
    write,
)

from aureole import light, surface

DIM = surface.Material(diffuse=0.01)


def discs() -> Pixels:
    """Return three discs from above, and under light from aside."""
    tables = [surface.table_from_grating(name, size=1024) for name in ("cd", "dvd", "bluray")]
    above = facing((320, 320), 0.126, 0.26)
    aside = surface.view_from((0.0, -0.24, 0.17), (0.0, 0.0, 0.0), (240, 320), np.radians(21))
    beside, low = lamp((0.0, 0.05, 0.26), 1.0, 0.004), lamp((0.0, -0.30, 0.16), 1.0, 0.03)
    return sheet(
        [
            [shown(drawn(table, COMPACT_DISC, above, beside, DIM), 0.0) for table in tables],
            [shown(drawn(table, COMPACT_DISC, aside, low, DIM), 1.5) for table in tables],
        ]
    )


def disc() -> Pixels:
    """Return a compact disc with the lamp beside the camera: violet is inside in every order."""
    table = surface.table_from_grating("cd", size=2048)
    lit = lamp((0.02, 0.0, 0.24), 1.0, 0.003)
    return shown(drawn(table, COMPACT_DISC, facing((540, 840), 0.128, 0.24), lit, DIM, 3), -2.3)


def spectra() -> Pixels:
    """Return a screen's pattern under four lights, their own colour left in."""
    incandescent = light.illuminant("A")
    inverse = 1.05 * incandescent.values.max() - incandescent.values
    cool = light.spectrum(incandescent.wavelengths, inverse, "power", "inverse of A")
    pictures = []
    for lit in (light.illuminant("E"), incandescent, cool, light.illuminant("F1")):
        table = surface.table_from_grating("lcd-534ppi", lit, size=1024, half_range=1.0)
        # A camera set to daylight keeps the light's colour.
        table = replace(table, white=tuple(light.white(light.illuminant("D65"))))
        view = facing((300, 300), 0.056, 0.40)
        pictures.append(shown(drawn(table, SCREEN, view, lamp((0.0, 0.0, 0.40), 1.0, 0.0005)), -3.5))
    return sheet([pictures])


def cylinder() -> Pixels:
    """Return a sheet of holographic paper, flat and bent, under the same lamp."""
    table = surface.table_from_grating(holographic(), size=1024)
    view = facing((400, 420), 0.128, 0.22)
    bent = surface.Cylinder(0.045, 0.12, 0.12 / 0.045)
    lit = lamp((0.0, 0.0, 0.22), 1.0, 0.003)
    flat = drawn(table, SHEET, view, lit, DIM)
    rolled = surface.Scene(lit, view, surface.pose_of((0.0, 0.0, -0.045)), DIM)
    return sheet([[shown(flat, 0.0), shown(surface.render(rolled, table, bent, 2), 0.0)]])


def blazed() -> Pixels:
    """Return 600 lines per millimetre as slits and as facets, under a lamp that the camera looks past."""
    period = 1e-3 / 600
    slits = surface.multislit_grating(period, 0.5 * period, 39)
    view = facing((240, 420), 0.07, 0.2)
    lit = lamp((0.0, 0.0, 0.2), 1.0, 0.001)
    pictures = []
    for grating in (slits, surface.grating("blazed-600")):
        table = surface.table_from_grating(grating, size=1024)
        pictures.append(shown(drawn(table, surface.Plane(0.12, 0.06), view, lit, DIM), -3.2))
    return sheet([pictures])


def mask() -> Pixels:
    """Return a radial pattern on a sheet, a mask of stripes, and the two together."""
    lines = surface.Lines(2.4e-6, 0.8e-6, 6)
    table = surface.table_from_grating(surface.radial_grating(lines, 0.03), size=1024, zero_order="remove")
    material = surface.Material(diffuse=(0.02, 0.02, 0.025), specular=0.05, roughness=0.05)
    stripes = np.zeros((1, 480), np.float32)
    for left in (60, 130, 215, 245, 330, 410):
        stripes[0, left : left + 22] = 1.0
    view, lit = facing((280, 280), 0.124, 0.2), lamp((0.0, 0.0, 0.2), 1.0, 0.002)
    whole = drawn(table, SHEET, view, lit, material)
    striped = drawn(table, SHEET, view, lit, material, mask=stripes)
    seen = stripes[0, np.linspace(0, 479, 280).astype(int)]
    plain = np.broadcast_to(0.8 * seen[None, :, None], (280, 280, 3))
    return sheet([[shown(whole, 1.0), plain, shown(striped, 1.0)]])


def focus() -> Pixels:
    """Return a screen through a lens that is focused on it, and on the lamp's mirror image behind it."""
    table = surface.table_from_grating("lcd-342ppi", size=1024, half_range=0.6)
    view = facing((300, 420), 0.05, 0.35)
    # A pen's strokes on the glass show where the screen is sharp.
    strokes = np.ones((98, 56), np.float32)
    strokes[::7] = 0.0
    pictures = []
    for depth in (0.35, 0.70):
        lens = surface.ThinLens(0.008, depth, 48)
        found = drawn(table, SCREEN, view, lamp((0.0, 0.0, 0.35)), DIM, 1, mask=strokes, lens=lens)
        pictures.append(shown(found, -2.0))
    return sheet([pictures])


def regions() -> Pixels:
    """Return a sheet whose parts have four patterns, and a sheet whose lines turn with the place."""
    makers = [
        holographic(),
        surface.radial_grating(surface.Lines(2.4e-6, 0.8e-6, 6), 0.03),
        surface.multislit_grating(1.6e-6, 0.5e-6, 12, 0.06),
        surface.grating("blazed-600"),
    ]
    tables = [surface.table_from_grating(each, size=512, zero_order="remove") for each in makers]
    view, lit = facing((400, 420), 0.124, 0.22), lamp((0.0, 0.03, 0.22), 1.0, 0.003)
    parts = np.add.outer(2 * (np.arange(6) % 2), np.arange(6) % 2).astype(np.int32)
    patches = drawn(tables, SHEET, view, lit, DIM, regions=parts)
    x = np.linspace(-1, 1, 256)
    angles = 2 * np.pi * (np.hypot(x, x[:, None]) % 0.25) / 0.25 + np.arctan2(-x[:, None], x)
    waves = drawn(tables[2], SHEET, view, lit, DIM, angles=angles)
    return sheet([[shown(patches, 1.5), shown(waves, 0.0)]])


NAMES = {
    "discs": discs,
    "disc": disc,
    "spectra": spectra,
    "cylinder": cylinder,
    "blazed": blazed,
    "mask": mask,
    "focus": focus,
    "regions": regions,
}

if __name__ == "__main__":
    write(NAMES[sys.argv[1]](), Path(sys.argv[2]))
