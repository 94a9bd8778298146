"""Glare over the frame: what a lens's rims leave open, and the time that many places' kernels take.

    python benchmarks/glare_field.py [--places 5x3] [--size 960x540] [--runs 3]

The first table compares traced rims and rims near the axis with the power of real rays through the whole
lens, each over its own value on the axis. The second takes, all in turn in one run, a convolution for each
place; the shared transform with kernels' spectra made anew; and the same with spectra kept from the picture
before.
"""

import argparse
import math
import time

import numpy as np

from aureole import aperture, flare, glare, picture
from aureole.flare import paraxial, pupil, tracing

LENSES = ("nikkor_50mm_f1_2", "zeiss_biotar_50mm", "heliar_tronnier_100mm", "cooke_triplet_100mm")
DEGREES = (0.0, 4.0, 8.0, 14.0)


def open_parts(name: str) -> dict[str, list[float]]:
    """Return what is open at each angle, over what is open on the axis, by three ways."""
    lens, _ = flare.open_lens(name)
    _, radius = paraxial.entrance_pupil(lens)
    whole, rims = aperture.circle(2 * radius), flare.housing_rims(lens)
    housing, prepared = flare.TracedHousing(lens, radius), tracing.prepare(lens, [550e-9])
    found: dict[str, list[float]] = {"rays": [], "traced": [], "paraxial": []}
    for degrees in DEGREES:
        right = math.radians(degrees)
        power = float(pupil.image_power(prepared, (math.tan(right), 0.0, 1.0))[0])
        found["rays"].append(power / math.cos(right))
        seen = housing.seen_from((right, 0.0))
        left = whole if seen.outline is None else aperture.intersection(whole, seen.outline)
        found["traced"].append(aperture.energy(left) * seen.stretch)
        found["paraxial"].append(aperture.energy(aperture.behind_rims(whole, rims, (right, 0.0))))
    return {way: [value / values[0] for value in values] for way, values in found.items()}


def convolutions(nodes: tuple[int, int], shape: tuple[int, int], runs: int) -> None:
    """Time the ways to convolve a picture with a kernel for each place."""
    rng = np.random.default_rng(1)
    light = rng.random((*shape, 3), dtype=np.float32)
    shares = [
        np.outer(y, x).astype(np.float32) for y in hats(shape[0], nodes[0]) for x in hats(shape[1], nodes[1])
    ]
    side = max(shape) | 1
    kernels = [rng.random((side, side, 3), dtype=np.float32) for _ in shares]
    anew = picture.PlacesConvolver(kernels, shares, most_bytes=0)
    kept = picture.PlacesConvolver(kernels, shares)
    kept(light)

    def one_by_one() -> None:
        total = np.zeros_like(light)
        for share, kernel in zip(shares, kernels, strict=True):
            total += picture.convolve(light * share[..., None], kernel, "fft")

    ways = {
        "one by one": one_by_one,
        "shared, anew": lambda: anew(light),
        "shared, kept": lambda: kept(light),
    }
    times: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(runs):
        for way, task in ways.items():
            start = time.perf_counter()
            task()
            times[way].append(time.perf_counter() - start)
    first = float(np.median(times["one by one"]))
    for way, seconds in times.items():
        median = float(np.median(seconds))
        print(f"{way:14}{median:8.2f} s{first / median:7.1f}x")


def hats(length: int, count: int) -> list[np.ndarray]:
    """Return the shares of places along an axis."""
    nodes = np.array(glare.axis_nodes(length, count))
    return [np.interp(np.arange(length), nodes, row) for row in np.eye(count)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", default="5x3")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args()
    print(f"{'open part':24}{'':10}" + "".join(f"{degrees:8g}°" for degrees in DEGREES))
    for name in LENSES:
        for way, values in open_parts(name).items():
            print(f"{name:24}{way:10}" + "".join(f"{value:9.3f}" for value in values))
    across, down = (int(word) for word in asked.places.split("x"))
    columns, rows = (int(word) for word in asked.size.split("x"))
    print(f"\n{across} x {down} places on {columns} x {rows} pixels, single precision")
    convolutions((down, across), (rows, columns), asked.runs)


if __name__ == "__main__":
    main()
