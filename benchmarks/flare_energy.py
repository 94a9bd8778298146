"""Compare the energies of ghosts with those of random rays, and say which ghosts matter.

    python benchmarks/flare_energy.py [--rays 10000000] [--ghosts 10] [--lenses NAME ...] [--seed 0]

First table: a lens's strongest ghosts of all pairs, wide open, one wavelength, the light half way to the
right edge of the picture and a third of the way to the lower one. Energy by random rays (m² for each unit of
irradiance) with its standard error; then how far the sheets of `ghost_powers` and the sum of the rendered
picture are from it, in per cent; and the same for what falls on the sensor. Second table: how much of the
ghosts' light each rule leaves out, how many ghosts hold 90 and 99 % of it, and all ghosts' light over the
image's, beside figures measured before under settings that are not fully known (half field, 550 nm, wide
open).
"""

import argparse
import os
import platform
import time

import numpy as np

from aureole import flare, light
from aureole.flare import energy, lights

GREEN = 550e-9
STRONGEST_OF = ("heliar_tronnier_100mm", "zeiss_biotar_50mm", "canon_tele_zoom_135mm")
BASE = 256
# Percent of the same-side ghosts' light with the last surface; of all ghosts' light across the stop, on the
# sensor; how many same-side ghosts hold 90 and 99 %; all ghosts' light over the image's.
KNOWN = {
    "heliar_tronnier_100mm": (2.5, 27, 3, 11, 3.7e-4),
    "tronnier_double_gauss_100mm": (25.6, 61, 8, 13, 2.4e-4),
    "leica_summicron_r_50mm": (18, 63, None, None, None),
    "zeiss_biotar_50mm": (None, 65, None, None, 1.7e-2),
    "zeiss_sonnar_50mm": (62.2, 32, None, None, None),
    "itoh_wide_zoom_100mm": (35, 27, 35, 61, None),
    "nikon_tele_zoom_80mm": (None, 17, 64, 112, None),
    "canon_tele_zoom_135mm": (None, 25, 128, 243, None),
}


def strongest(name: str, count: int, sent: int, seed: int) -> None:
    """Print the table of one lens's strongest ghosts."""
    lens = flare.load(name)
    source = lights.light_on_picture(lens, (1440, 720), (1080, 1920), light.line(GREEN))
    direction = source.direction
    paths = energy.ranked(lens, flare.ghosts(lens, "all"), source)[:count]
    print(f"\n{name}, {sent:.0e} rays a ghost\n")
    part = f"{'±':>8}{'sheets':>9}"
    print(f"{'ghost':8}{'m²':>10}{part}{'on sensor':>12}{part}{'hits':>11}{'s':>7}")
    worst = 0.0
    for path in paths:
        start = time.perf_counter()
        truth = flare.monte_carlo(lens, path, direction, GREEN, rays=sent, seed=seed)
        took = time.perf_counter() - start
        off = []
        for within, right in (("plane", truth.energy[0]), ("frame", truth.in_frame[0])):
            found = flare.ghost_powers(lens, [path], direction, GREEN, base=BASE, within=within)[0, 0]
            off.append(100 * (found / right - 1) if right else 0.0)
        worst = max(worst, *map(abs, off))
        errors = [
            100 * error / max(value, 1e-300)
            for error, value in (
                (truth.error[0], truth.energy[0]),
                (truth.in_frame_error[0], truth.in_frame[0]),
            )
        ]
        print(
            f"{path.name:8}{truth.energy[0]:10.3e}{errors[0]:7.3f}%{off[0]:+8.3f}%"
            f"{truth.in_frame[0]:12.3e}{errors[1]:7.3f}%{off[1]:+8.3f}%{truth.hits[0]:11d}{took:7.1f}",
            flush=True,
        )
    print(f"largest difference {worst:.3f} %")


def shares(name: str) -> None:
    """Print one line of what the rules leave out and how many ghosts matter."""
    lens = flare.load(name)
    half_diagonal = np.arctan(np.hypot(*lens.sensor) / 2 / lens.focal_length) / 2
    source = lights.light_at(half_diagonal, 0.0, light.line(GREEN))
    every = energy.ranked(lens, flare.ghosts(lens, "all"), source, within="frame")
    carried = {path.reflections: path.energy or 0.0 for path in every}
    total = sum(carried.values())
    side = [carried[path.reflections] for path in flare.ghosts(lens)]
    paper = sum(carried[path.reflections] for path in flare.ghosts(lens, "paper"))
    ordered = np.cumsum(sorted(side, reverse=True)) / sum(side)
    most = [int(np.searchsorted(ordered, part)) + 1 for part in (0.9, 0.99)]
    whole = energy.ghost_to_image(lens, source)
    found = (100 * (1 - paper / sum(side)), 100 * (1 - sum(side) / total), *most, whole)
    columns = []
    for value, known, form in zip(found, KNOWN[name], (".1f", ".0f", "d", "d", ".2e"), strict=True):
        columns.append(f"{value:{form}} ({'-' if known is None else format(known, 'g')})")
    print(f"{name:30}" + "".join(f"{column:>20}" for column in columns), flush=True)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description="Compare the energies of ghosts with random rays.")
    parser.add_argument("--rays", type=int, default=10**7)
    parser.add_argument("--ghosts", type=int, default=10)
    parser.add_argument("--lenses", nargs="*", default=STRONGEST_OF)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print(f"{platform.platform()}, {os.cpu_count()} processors, NumPy {np.__version__}, seed {given.seed}")
    for name in given.lenses:
        strongest(name, given.ghosts, given.rays, given.seed)
    headings = ("last surface, %", "across stop, %", "ghosts for 90 %", "for 99 %", "ghosts / image")
    print(f"\n{'(in brackets: known)':30}" + "".join(f"{heading:>20}" for heading in headings))
    for name in KNOWN:
        shares(name)


if __name__ == "__main__":
    main()
