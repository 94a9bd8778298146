"""Compare the energies of ghosts with those of random rays, and say which ghosts matter.

    python benchmarks/flare_energy.py [--rays 10000000] [--ghosts 10] [--lenses NAME ...] [--seed 0]

First table: a lens's strongest ghosts of all pairs, wide open, one wavelength, the light half way to the
right edge of the picture and a third of the way to the lower one. Energy by random rays (m² for each unit of
irradiance) with its standard error, and how far the sheets of `ghost_powers` are from it; then the same for
what falls on the sensor, and how far the sums of rendered pictures are from it, without merging and merged
heavily.

Second table: of all that falls on the sensor, which part each rule leaves out, how many same-side ghosts hold
90 and 99 % of theirs, and all ghosts' light over the image's; one wavelength, wide open, the light at half of
the half diagonal's angle. In brackets what was measured before, by other code, from the same patents. "as
the tile paper" coats cemented surfaces, too.
"""

import argparse
import os
import platform
from itertools import zip_longest

import numpy as np

from aureole import flare, light
from aureole.flare import energy, lights, pupil, raster, tracing
from aureole.flare.energy import Direction

GREEN = 550e-9
STRONGEST_OF = ("heliar_tronnier_100mm", "zeiss_biotar_50mm", "canon_tele_zoom_135mm")
BASE = 256
COLUMNS = 1920
PAPERS = [flare.quarter_wave(1.38, 620e-9)]
# Percent of the same-side ghosts' light with the last surface; of all ghosts' light across the stop; how many
# same-side ghosts hold 90 and 99 %; all ghosts' light over the image's.
KNOWN = {
    "heliar_tronnier_100mm": (),
    "heliar_tronnier_100mm as the tile paper": (2.5, 27, 3, 11, 3.7e-4),
    "tronnier_double_gauss_100mm": (25.6, 61, 8, 13, 2.4e-4),
    "leica_summicron_r_50mm": (18, 63),
    "zeiss_biotar_50mm": (None, 65, None, None, 1.7e-2),
    "zeiss_sonnar_50mm": (62.2, 32),
    "itoh_wide_zoom_100mm": (35, 27, 35, 61),
    "nikon_tele_zoom_200mm as the tile paper": (None, 17, 64, 112),
    "canon_tele_zoom_135mm as the tile paper": (None, 25, 128, 243),
}


def drawn(lens: flare.Lens, path: flare.GhostPath, direction: Direction, merge: str) -> float:
    """Return the sum of a ghost's picture, which is as large as the sensor."""
    prepared = tracing.prepare(lens, [GREEN])
    frame = flare.frame_of(lens, (round(COLUMNS * lens.sensor[1] / lens.sensor[0]), COLUMNS))
    sheets = pupil.sheets(prepared, [path], direction, BASE)
    quads = flare.construct(sheets, frame, merge=merge)
    return float(raster.rasterize(quads, [[1.0, 1.0, 1.0]], frame)[..., 1].sum(dtype=np.float64))


def strongest(name: str, count: int, sent: int, seed: int) -> None:
    """Print the table of one lens's strongest ghosts."""
    lens = flare.load(name)
    source = lights.light_on_picture(lens, (1440, 720), (1080, 1920), light.line(GREEN))
    direction = source.direction
    paths = energy.ranked(lens, flare.ghosts(lens, "all"), source, within="plane")[:count]
    print(f"\n{name}, {sent:.0e} rays a ghost\n")
    print(
        f"{'':8}{'all':>10}{'±':>8}{'sheets':>9}{'sensor':>11}{'±':>8}{'sheets':>9}{'picture':>9}{'heavy':>9}"
    )
    worst = 0.0
    for path in paths:
        truth = flare.monte_carlo(lens, path, direction, GREEN, rays=sent, seed=seed)
        whole, inside = float(truth.energy[0]), float(truth.in_frame[0])
        asked = lens, [path], direction, GREEN, None, BASE
        off = [100 * (flare.ghost_powers(*asked)[0, 0] / whole - 1)]
        found = [
            flare.ghost_powers(*asked, "frame")[0, 0],
            drawn(lens, path, direction, "none"),
            drawn(lens, path, direction, "heavy"),
        ]
        off += [100 * (value / inside - 1) if inside else 0.0 for value in found]
        worst = max(worst, *map(abs, off))
        error = 100 * truth.error[0] / whole, 100 * truth.in_frame_error[0] / (inside or 1.0)
        print(
            f"{path.name:8}{whole:10.2e}{error[0]:7.3f}%{off[0]:+8.3f}%{inside:11.2e}{error[1]:7.3f}%"
            + "".join(f"{value:+8.3f}%" for value in off[1:]),
            flush=True,
        )
    print(f"largest difference {worst:.3f} %")


def shares(name: str) -> None:
    """Print one line of what the rules leave out and how many ghosts matter."""
    word, _, paper = name.partition(" as ")
    lens = flare.load(word)
    if paper:
        lens = flare.with_coating(lens, PAPERS, cemented=True)
    half_diagonal = np.arctan(np.hypot(*lens.sensor) / 2 / lens.focal_length) / 2
    source = lights.light_at(half_diagonal, 0.0, light.line(GREEN))
    every = energy.ranked(lens, flare.ghosts(lens, "all"), source)
    carried = {path.reflections: path.energy or 0.0 for path in every}
    total = sum(carried.values())
    side = [carried[path.reflections] for path in flare.ghosts(lens)]
    without_last = sum(carried[path.reflections] for path in flare.ghosts(lens, "paper"))
    ordered = np.cumsum(sorted(side, reverse=True)) / sum(side)
    most = [int(np.searchsorted(ordered, part)) + 1 for part in (0.9, 0.99)]
    found = (100 * (1 - without_last / sum(side)), 100 * (1 - sum(side) / total), *most, total)
    columns = []
    for value, known, form in zip_longest(found, KNOWN[name], (".1f", ".0f", "d", "d", ".2e")):
        columns.append(f"{value:{form}} ({'-' if known is None else format(known, 'g')})")
    print(f"{name:42}" + "".join(f"{column:>20}" for column in columns), flush=True)


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
    print(f"\n{'':42}" + "".join(f"{heading:>20}" for heading in headings))
    for name in KNOWN:
        shares(name)


if __name__ == "__main__":
    main()
