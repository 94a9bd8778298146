"""Time whole starbursts: every wavelength, every pixel's integral, as `aureole glare` needs them.

    python benchmarks/starburst.py [--size 1921] [--runs 5]

A 50 mm lens at f/16 on pixels of 18.75 µm (full frame, 1920 pixels wide), light D65.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np

import aureole
from aureole import aperture, glare, light

IRISES = {
    "7 straight blades": aperture.iris(7, 1.0),
    "9 blades, curvature 0.8": aperture.iris(9, 1.0, 0.8),
    "circle": aperture.circle(1.0),
}


def main() -> None:
    """Time each iris in turn and print the table."""
    parser = argparse.ArgumentParser(description="Time whole point spread functions.")
    parser.add_argument("--size", type=int, default=1921)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    shape = (given.size, given.size)
    lamp = light.illuminant("D65")
    cameras = {name: glare.camera(50e-3, 16, iris, resolution=(1280, 1920)) for name, iris in IRISES.items()}
    held = {name: glare.camera_psf(c, shape, lamp).metadata["energy_inside"] for name, c in cameras.items()}
    times: dict[str, list[float]] = {name: [] for name in cameras}
    for _ in range(given.runs):
        for name, camera in cameras.items():
            start = time.perf_counter()
            glare.camera_psf(camera, shape, lamp)
            times[name].append(time.perf_counter() - start)
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, Aureole {aureole.__version__}\n{given.size}² pixels, RGB, {given.runs} runs\n"
    )
    print(f"{'':28}{'median':>10}{'fastest':>10}{'energy':>10}")
    for name, taken in times.items():
        print(f"{name:28}{statistics.median(taken):8.2f} s{min(taken):8.2f} s{held[name]:10.5f}")


if __name__ == "__main__":
    main()
