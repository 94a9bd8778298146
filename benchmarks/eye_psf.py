"""Compare the eye's point spread function with CIE 135, find its halo, and time it.

    python benchmarks/eye_psf.py [--seeds 1 2 3] [--runs 5]

Ratios are those of the mean over rings, ten to a decade of angle, to CIE 135 for the age and brown eyes. The
rings from 0.1 to 3 degrees are those of wave optics alone, on pixels of 0.02 degrees; the wide ones are those
of the whole function, on pixels of 0.125 degrees from 0.5 degrees on and of 0.02 degrees before. The eye is
the standard one, its pupil what `EyeState.at` gives without blinks.

The halo is that of a single line at 568 nm: where the mean over rings is highest above that of the same eye
without fibres, and the largest excess over it.
"""

import argparse
import math
import os
import platform
import statistics
import time
from dataclasses import replace

import numpy as np

from aureole import glare, light
from aureole.glare import veil
from aureole.glare.eye_psf import eye_psf_stages

LUMINANCES, AGES = (0.1, 1.0, 10.0, 100.0), (25, 70)
LUMINANCE_OF_RGB = np.array([0.2126, 0.7152, 0.0722])
HALO_LINE = 568e-9


def rings(psf, values, edges):
    """Return the mean density over rings between angles in degrees, 1 / steradian."""
    rows, columns = values.shape
    step = psf.metadata["degrees_per_pixel"]
    angle = np.hypot((np.arange(rows) - rows // 2)[:, None], np.arange(columns) - columns // 2) * step
    area = math.radians(step) ** 2 * np.sinc(np.radians(angle) / np.pi)
    place = np.digitize(angle.ravel(), edges)
    energy, areas = (np.bincount(place, each.ravel(), len(edges) + 1)[1:-1] for each in (values, area))
    return energy / areas


def over_cie(psf, age, edges):
    """Return the rings' means over CIE 135's."""
    rows, columns = psf.pixels.shape[:2]
    step = psf.metadata["degrees_per_pixel"]
    angle = np.hypot((np.arange(rows) - rows // 2)[:, None], np.arange(columns) - columns // 2) * step
    area = math.radians(step) ** 2 * np.sinc(np.radians(angle) / np.pi)
    glare_there = veil.cie_135(np.radians(angle), age) * area
    return rings(psf, psf.pixels @ LUMINANCE_OF_RGB, edges) / rings(psf, glare_there, edges)


def ratios(state, age):
    """Return the extreme ratios of the whole function and of wave optics alone, and the energy's error."""
    near, far = np.geomspace(0.1, 3, 16), np.geomspace(0.5, 30, 19)
    wide = glare.eye_psf(state, (512, 512), math.radians(64))
    close = glare.eye_psf(state, (320, 320), math.radians(6.4))
    alone = glare.eye_psf(state, (320, 320), math.radians(6.4), tail=False)
    whole = np.concatenate([over_cie(close, age, near), over_cie(wide, age, far)])
    wave = over_cie(alone, age, near)
    hemisphere = glare.eye_psf(state, (180, 180), math.pi)
    energy = hemisphere.pixels.sum(axis=(0, 1), dtype=float)
    return whole.min(), whole.max(), wave.min(), wave.max(), np.abs(energy - 1).max()


def halo(eye, diameter, low, high):
    """Return where a halo stands out most between two angles in degrees, and by how much."""
    step = 0.02 if high > 1 else 0.004
    side = math.ceil(2.1 * high / step) // 2 * 2 + 1
    edges = np.linspace(low, high, 31)
    means = []
    for one in (eye, replace(eye, fibre_depth=0.0)):
        state = glare.EyeState(one, pupil_diameter=diameter)
        psf = glare.eye_psf(state, (side, side), side * math.radians(step), light.line(HALO_LINE), tail=False)
        means.append(rings(psf, psf.pixels[..., 1], edges))
    contrast = means[0] / means[1] - 1
    # The ring stands where fibres add most light.
    best = int(np.argmax(means[0] - means[1]))
    return (edges[best] + edges[best + 1]) / 2, contrast.max()


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    print(
        f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors, numpy {np.__version__}"
    )
    print("\nratio to CIE 135           whole, 0.1-30 deg    wave alone, 0.1-3 deg   energy - 1")
    for age in AGES:
        for luminance in LUMINANCES:
            for seed in options.seeds:
                eye = glare.Eye(age=age, seed=seed)
                state = glare.EyeState.at(0.5, luminance, eye=eye, blinking=False)
                low, high, wave_low, wave_high, error = ratios(state, age)
                print(
                    f"{age:3d} y {luminance:6g} cd/m2 seed {seed} {state.pupil_diameter * 1e3:5.2f} mm "
                    f"{low:6.2f} to {high:5.2f}      {wave_low:8.2f} to {wave_high:5.2f}        {error:9.1e}",
                    flush=True,
                )
    print("\nhalo at 568 nm                          angle  contrast")
    for name, diameter, low, high in (
        ("standard", 7e-3, 2.5, 4.0),
        ("standard", 5e-3, 2.5, 4.0),
        ("standard", 3e-3, 2.5, 4.0),
        ("ritschel-2009", 7e-3, 0.2, 0.5),
    ):
        for seed in options.seeds:
            eye = glare.eye_named(name, seed=seed)
            angle, contrast = halo(eye, diameter, low, high)
            print(
                f"{name:14s} {diameter * 1e3:g} mm pupil, seed {seed}: {angle:9.2f} {contrast:9.1%}",
                flush=True,
            )
    times(options.runs)


def times(runs: int) -> None:
    """Print the seconds of each stage, medians."""
    print("\nseconds, medians            parts  pattern   whole")
    for diameter, side, field in (
        (7.4e-3, 1024, 60),
        (7.4e-3, 1024, 10),
        (4e-3, 1024, 60),
        (7.4e-3, 2048, 60),
    ):
        state = glare.EyeState(pupil_diameter=diameter)
        spans = []
        for _ in range(runs + 1):
            stages = eye_psf_stages(state, (side, side), math.radians(field))
            marks = [time.perf_counter() for _ in stages]
            spans.append(np.diff(marks))
        medians = [statistics.median(column) for column in np.transpose(spans[1:])]
        print(
            f"{diameter * 1e3:g} mm, {side}^2 at {field:2d} deg   "
            + "".join(f"{value:8.2f}" for value in (*medians, sum(medians)))
        )


if __name__ == "__main__":
    main()
