"""Compare ways to merge a ray grid's cells: how many primitives are left, and what the picture loses.

    python benchmarks/flare_merging.py [LENS ...] [--base 64] [--f-number N]

The tile paper's five systems at its f-numbers, ghosts by its count, one light, three wavelengths, 1920×1080.
PSNR against the unmerged primitives laid down quad by quad, exposed so that the 99.9th percentile is 1,
clipped to 0..1. Times are of this machine, building primitives from rays, medians of five.
"""

import argparse
import statistics
import time

import numpy as np

from aureole import flare, picture
from aureole.flare import primitives, pupil, raster, tracing

SYSTEMS = {
    "heliar_tronnier_100mm": 16.0,
    "itoh_wide_zoom_123mm_seed": 32.0,
    "nikon_tele_zoom_140mm_seed": 16.0,
    "canon_tele_zoom_135mm": 32.0,
    "canon_tele_zoom_200mm": 32.0,
}
WAVES = (600e-9, 550e-9, 460e-9)
DIRECTION = np.array([0.1, 0.03, 1.0]) / np.linalg.norm([0.1, 0.03, 1.0])
TURNS = 5


def compare(name: str, f_number: float, base: int) -> None:
    """Print a line for each way to merge."""
    lens = flare.load(name)
    frame = flare.frame_of(lens)
    sheets = pupil.sheets(
        tracing.prepare(lens, WAVES, f_number), flare.ghosts(lens, "paper"), DIRECTION, base
    )
    truth, peak = None, 0.0
    print(f"{name}, f/{f_number:g}, {len(sheets)} ghosts of {base}² rays × {len(WAVES)} wavelengths")
    for merge in primitives.MERGES:
        seconds = []
        for _ in range(TURNS):
            start = time.perf_counter()
            found = flare.construct(sheets, frame, merge=merge)
            seconds.append(time.perf_counter() - start)
        method = "reference" if truth is None else "tiles"
        drawn = raster.rasterize(found, np.eye(3), frame, method)
        if truth is None:
            truth, peak, most = drawn, float(np.quantile(drawn, 0.999)), len(found.area)
            loss = "the reference"
        else:
            pair = np.minimum(drawn, peak).ravel()[None], np.minimum(truth, peak).ravel()[None]
            loss = (
                f"{float(picture.psnr(*pair, peak=peak)):5.1f} dB, power {drawn.sum() / truth.sum() - 1:+.1e}"
            )
        count = len(found.area)
        ms = 1e3 * statistics.median(seconds)
        print(
            f"  {merge:16s} {count:9,d} {most / max(count, 1):5.1f}x fewer  {ms:6.0f} ms  {loss}", flush=True
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("lenses", nargs="*", default=list(SYSTEMS))
    parser.add_argument("--base", type=int, default=64)
    parser.add_argument("--f-number", type=float)
    options = parser.parse_args()
    for lens_name in options.lenses:
        compare(lens_name, options.f_number or SYSTEMS.get(lens_name, 8.0), options.base)
