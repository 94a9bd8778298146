"""Time the near field in colour, and judge how many wavelengths it needs.

    python benchmarks/near_field_colour.py [--size 512] [--mask 1024] [--runs 5] [--numbers 30 100 200]
    python benchmarks/near_field_colour.py --wavelengths
    python benchmarks/near_field_colour.py --ringing

The aperture is a heptagon of pixels, upright (it mirrors in one axis) and turned by a random angle (in
none); the plane is twice as wide. Light is of equal energy, from 380 to 780 nm, 30 wavelengths. "one by one"
calls `near_field` for each, squares the modulus and adds it to three channels with NumPy; "exact" and
"approximate" are `near_picture`. The runs alternate; ratios are those of the medians.

--wavelengths gives the RMS and the largest error of 15 to 240 wavelengths, and of the number that is taken
where none is asked for, against 480, over X, Y and Z, where 1 is the unblocked luminance.

--ringing times ringing textures of an iris and of a cat's eye, and tells what they keep.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np

from aureole import Grid, aperture, light
from aureole.diffraction import near_field, near_picture, ringing_texture
from aureole.diffraction.near_picture import wavelengths_needed
from aureole.records import Aperture

SEED = 7
WIDTH = 2e-3
WAVELENGTH = 529e-9
SAMPLES = 30
TRUE_SAMPLES = 480
GREY = light.illuminant("E")


def heptagon(mask: int, turned: bool) -> Aperture:
    """Draw a heptagon of pixels, upright or turned by a random angle."""
    turn = float(np.random.default_rng(SEED).uniform(0, 2 * np.pi / 7)) if turned else 0.0
    shape = aperture.iris(7, WIDTH, rotation=turn)
    return aperture.from_mask(aperture.rasterize(shape, mask), WIDTH)


def distance_at(number: float) -> float:
    """Return the distance at which (width / 2)² / (λz) is this, at 529 nm."""
    return (WIDTH / 2) ** 2 / (WAVELENGTH * number)


def one_by_one(shape: Aperture, grid: Grid, distance: float) -> np.ndarray:
    """Call `near_field` for each wavelength and add up."""
    total = np.zeros((*grid.shape, 3), dtype=np.float32)
    for wavelength, weight in zip(*light.quadrature(GREY, SAMPLES), strict=True):
        amplitude = near_field(shape, grid, distance, float(wavelength)).amplitude
        power = amplitude.real**2 + amplitude.imag**2
        for channel in range(3):
            total[..., channel] += np.float32(weight[channel]) * power
    return total


def seconds(task: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def compare(size: int, mask: int, numbers: list[float], runs: int) -> None:
    """Time all ways for both heptagons at each Fresnel number."""
    grid = Grid((size, size), (2 * WIDTH / size,) * 2)
    print(f"{size}², mask {mask}², {SAMPLES} wavelengths, {runs} runs, medians\n")
    print(f"{'':10}{'N_F':>6}{'one by one':>13}{'exact':>11}{'ratio':>7}{'approximate':>14}{'exact/':>9}")
    for turned in (False, True):
        shape = heptagon(mask, turned)
        for number in numbers:
            distance = distance_at(number)
            tasks: dict[str, Callable[[], object]] = {
                "one by one": lambda s=shape, d=distance: one_by_one(s, grid, d),
                "exact": lambda s=shape, d=distance: near_picture(s, grid, d, GREY, samples=SAMPLES),
                "approximate": lambda s=shape, d=distance: near_picture(s, grid, d, GREY, "approximate"),
            }
            taken: dict[str, list[float]] = {name: [] for name in tasks}
            for run in range(runs + 1):
                for name, task in tasks.items():
                    spent = seconds(task)
                    if run:  # the first warms up
                        taken[name].append(spent)
            separate, exact, approximate = (1e3 * statistics.median(times) for times in taken.values())
            print(
                f"{'turned' if turned else 'upright':10}{number:6.0f}{separate:10.0f} ms{exact:8.0f} ms"
                f"{exact / separate:7.2f}{approximate:11.1f} ms{exact / approximate:8.1f}x"
            )


def judge(numbers: list[float]) -> None:
    """Print what too few wavelengths leave."""
    shape, grid = heptagon(256, True), Grid((64, 128), (2 * WIDTH / 128 * 0.73, 2 * WIDTH / 128))
    print(f"{'N_F':>6}{'wavelengths':>13}{'RMS':>10}{'largest':>10}")
    for number in numbers:
        distance = distance_at(number)
        truth = near_picture(shape, grid, distance, GREY, samples=TRUE_SAMPLES).pixels
        taken = wavelengths_needed(shape, grid, distance, WAVELENGTH)
        for samples in sorted({15, 30, 60, 120, 240, taken}):
            error = near_picture(shape, grid, distance, GREY, samples=samples).pixels - truth
            mark = " taken" if samples == taken else ""
            rms, largest = np.sqrt(np.mean(error**2)), np.abs(error).max()
            print(f"{number:6.0f}{samples:13d}{rms:10.5f}{largest:10.5f}{mark}")


def ring(runs: int) -> None:
    """Time ringing textures, and tell what they keep."""
    iris = aperture.iris(7, WIDTH)
    shapes = {"iris": iris, "cat's eye": aperture.cats_eye(iris, WIDTH, (0.3 * WIDTH, 0.1 * WIDTH))}
    print(f"{'':12}{'N_F':>6}{'time':>11}{'kept':>10}{'border':>10}")
    for name, shape in shapes.items():
        for number in (5.0, 30.0, 200.0):
            texture = ringing_texture(shape, number)
            spent = statistics.median(
                seconds(lambda s=shape, n=number: ringing_texture(s, n)) for _ in range(runs)
            )
            print(f"{name:12}{number:6.0f}{1e3 * spent:8.0f} ms{texture.kept:10.4f}{texture.border:10.5f}")


def main() -> None:
    """Read the command line and do what it says."""
    parser = argparse.ArgumentParser(description="Time and judge the near field in colour.")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--mask", type=int, nargs="+", default=[512, 1024])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--numbers", type=float, nargs="+", default=[30.0, 200.0])
    parser.add_argument("--wavelengths", action="store_true", help="judge numbers of wavelengths instead")
    parser.add_argument("--ringing", action="store_true", help="time ringing textures instead")
    given = parser.parse_args()
    names = ("aureole", "numpy", "scipy", "numba")
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in names)
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, "
        f"{versions}, seed {SEED}"
    )
    if given.wavelengths:
        judge([1.0, 5.0, 30.0, 100.0, 300.0])
    elif given.ringing:
        ring(given.runs)
    else:
        for mask in given.mask:
            compare(given.size, mask, given.numbers, given.runs)


if __name__ == "__main__":
    main()
