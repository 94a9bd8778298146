"""Photograph a screen whose diffraction is known, measure it, and compare its table with the formula.

    python benchmarks/surface_measure.py [--size 1000] [--table 2048] [--only WORD]

A screen of pixels of 74.27 µm, 20 µm open, nine by nine lit (surface paper, Eq. 16), under E. The photograph
is of size x size pixels, 48 µrad of h each; a bracket has six exposures of 14 bits with shot and read noise,
seed 3, through a lens that blurs by a pixel (standard deviation). `table_from_photo` makes the table as a
user would: black level estimated, centre found. Errors are against Eq. 12 itself at the table's own places
whose light was photographed at all 81 wavelengths, where Y > 1e-4.

"plain" is told no band, "band" the band only, "band and blur" both. A colour photograph is of a camera with
the assumed sensitivities, its lamp E: each channel is a band of 70 to 90 nm (surface paper, Fig. 16).
"""

import argparse
import math
import os
import platform
import resource
import time

import numpy as np

from aureole import light, surface
from aureole.light.differences import difference_2000, lab
from aureole.surface import virtual
from aureole.surface.bandwidth import mean_wavelength
from aureole.surface.table import axes

WAVELENGTH, STEP, PITCH = 530e-9, 4.8e-5, 74.27e-6
EXPOSURES = (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0)
SCREEN = surface.lcd_screen(PITCH)
WHITE = light.white(light.illuminant("E"))


def truth(table, reach):
    """Return where to compare, and the screen's Eq. 12 there."""
    h_b, h_t = axes(table)
    rows, columns = np.abs(h_b) <= reach, np.abs(h_t) <= reach
    wavelengths, weights = light.quadrature(light.illuminant("E"), 81)
    planes = (SCREEN(h_t[columns][None, :], h_b[rows][:, None], float(w)) for w in wavelengths)
    total = sum(plane[..., None] * share for plane, share in zip(planes, weights, strict=True))
    return np.ix_(rows, columns), total


def errors(table, where, wanted):
    """Return the median relative error of Y, and mean and 95th percentile of ΔE00."""
    found = table.values[where].astype(float)
    seen = wanted[..., 1] > 1e-4
    apart = difference_2000(lab(wanted[seen], WHITE), lab(found[seen], WHITE))
    off = np.abs(found[..., 1] - wanted[..., 1])[seen] / wanted[..., 1][seen]
    return float(np.median(off)), float(apart.mean()), float(np.quantile(apart, 0.95))


def bracket(scene, blur=1.0):
    """Take the photographs, and say what their camera's maker would."""
    camera = surface.VirtualCamera(blur=blur)
    full = 0.9 * (camera.saturation - camera.black)
    return {
        "photos": surface.photograph(0.9 * scene, EXPOSURES, camera, seed=3),
        "exposures": [full * value for value in EXPOSURES],
        "black": "estimate",
        "saturation": camera.saturation,
        "read_noise": camera.read_noise / camera.gain,
        "gain": camera.gain,
    }


def cases(size):
    """Yield (case, geometry, centre, photographs and what is known of them)."""
    line = light.line(WAVELENGTH)
    even = surface.UniformGeometry(STEP)
    centre = (size / 2 + 1.37, size / 2 - 2.18)

    def scene(band, geometry=even):
        return virtual.radiance(SCREEN, band, geometry, (size, size), centre)

    yield "ideal", even, centre, {"photos": scene(line), "exposures": 1.0}
    yield "noise", even, centre, bracket(scene(line), 0.0)
    yield "noise, blur", even, centre, bracket(scene(line))
    for width in (10, 20, 40, 80):
        band = virtual.gaussian_filter_spectrum(WAVELENGTH, width * 1e-9)
        photos = bracket(scene(band))
        yield f"filter {width} nm, plain", even, centre, photos
        yield f"filter {width} nm, band", even, centre, {**photos, "band": band}
        yield f"filter {width} nm, band and blur", even, centre, {**photos, "band": band, "blur": 1.0}
        if width > 10:
            continue
        for off in (5, 20):
            wrong = virtual.gaussian_filter_spectrum(WAVELENGTH + off * 1e-9, width * 1e-9)
            told = {**photos, "band": wrong, "wavelength": WAVELENGTH + off * 1e-9}
            yield f"filter 10 nm, wavelength {off} nm off", even, centre, told
        away = (centre[0] + 3.0, centre[1])
        yield "filter 10 nm, centre 3 px off", even, centre, {**photos, "band": band, "centre": away}
    yield from colour_cases(scene, even, centre)
    scale = STEP / (1 / 0.6 + 1 / 0.4)
    tilted = surface.BenchGeometry(
        0.6, 0.4, scale, tilt=(math.radians(7), math.radians(-4)), rotation=math.pi
    )
    photo = scene(line, tilted)
    yield "bench tilted by 8°", tilted, centre, {"photos": photo, "exposures": 1.0}
    yield "bench tilted by 8°, taken as even", even, centre, {"photos": photo, "exposures": 1.0}


def colour_cases(scene, geometry, centre):
    """Yield a colour photograph: one of its channels taken for a wavelength, and all three as bands."""
    curves = surface.assumed_sensitivities()
    channels = []
    for curve in curves:
        places = np.linspace(400e-9, 720e-9, 65)
        powers = np.interp(places, curve.wavelengths, curve.values) * (places[1] - places[0])
        channels.append(scene(light.spectrum(places, powers, "lines")))
    for name, channel, curve in zip(("red", "green", "blue"), channels, curves, strict=True):
        told = {"photos": channel, "exposures": 1.0, "wavelength": mean_wavelength(curve)}
        yield f"colour, {name} alone, plain", geometry, centre, told
        yield f"colour, {name} alone, band", geometry, centre, {**told, "band": curve, "blur": 0.0}
    yield "colour, three channels", geometry, centre, {"colour": np.stack(channels, axis=-1)}


def made(geometry, how, size):
    """Make the table."""
    scale = 1 / (4 * np.pi**2)
    if "colour" in how:
        patterns = surface.measure_channels(
            how["colour"], 1.0, geometry, power=2.0, blur=0.0, irradiance=scale
        )
        return surface.table_from_measured(patterns, model="amplitude", table_size=size)
    return surface.table_from_photo(
        geometry=geometry, model="amplitude", irradiance=scale, table_size=size, **how
    )


def main():
    """Print a line a case."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--size", type=int, default=1000)
    parser.add_argument("--table", type=int, default=2048)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    print(f"{platform.machine()}, {os.cpu_count()} CPUs, Python {platform.python_version()}, seed 3")
    print(f"photograph {options.size}², table {options.table}², warp 5")
    heads = ("case", "median Y error", "mean ΔE00", "95 %", "centre off", "period off", "CPU time")
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    known = None
    for case, geometry, centre, how in cases(options.size):
        if options.only not in case:
            continue
        start = time.process_time()
        if "colour" not in how:
            how = {"wavelength": WAVELENGTH, **how}
        table = made(geometry, how, options.table)
        took = time.process_time() - start
        if known is None:
            known = truth(table, 0.96 * STEP * options.size / 2 * 380 / 530)
        luminance, colour, most = errors(table, *known)
        said = table.metadata["patterns"][0]
        off = math.hypot(said["centre"][0] - centre[0], said["centre"][1] - centre[1])
        period = "none" if said["period"][0] is None else f"{100 * (said['period'][0] / PITCH - 1):+.2f} %"
        cells = (f"{100 * luminance:.2f} %", f"{colour:.2f}", f"{most:.2f}", f"{off:.3f} px", period)
        print(f"| {case} | " + " | ".join(cells) + f" | {took:.1f} s |", flush=True)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"largest memory of the process {peak:.0f} MB")


if __name__ == "__main__":
    main()
