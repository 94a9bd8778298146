"""How right the far field and the point spread functions are: a table for the README.

    python benchmarks/accuracy.py

Every line compares with something that is not ours: closed forms, direct sums in float64, conservation.
"""

import os
import platform

import numpy as np
from scipy.special import j1

import aureole
from aureole import Grid, Picture, aperture, diffraction, glare, light

SEED = 3
FOCAL_LENGTH, F_NUMBER, WAVELENGTH = 50e-3, 16.0, 550e-9


def against_reference() -> list[tuple[str, float]]:
    """Return each method's largest error over masks, shapes and grids, of the peak."""
    generator = np.random.default_rng(SEED)
    width = 1e-3
    grids = [Grid((40, 41), (0.3 / width, 0.27 / width), (3 / width, -2 / width)), Grid((64, 65), (1e3, 1e3))]
    masks = [aperture.from_mask(generator.random((n, n)), width) for n in (32, 33)]
    shapes = [aperture.iris(7, width), aperture.iris(6, width, 0.5, 0.2), aperture.whirl(width)]
    rows = []
    for method, openings in (("polygons", shapes), ("quads", masks), ("chirpz", masks)):
        worst = 0.0
        for opening in openings:
            for grid in grids:
                truth = diffraction.far_field(opening, grid, "reference").amplitude
                found = diffraction.far_field(opening, grid, method).amplitude
                worst = max(worst, float(np.abs(found - truth).max()) / aperture.area(opening))
        rows.append((f"far field, '{method}' against direct sums, of the peak", worst))
    return rows


def against_airy() -> list[tuple[str, float]]:
    """Return the point spread function's error against the Airy pattern, and its first ring's energy."""
    size, pitch = 512, 1e-6
    camera = glare.camera(
        FOCAL_LENGTH, F_NUMBER, aperture.circle(1.0), pitch * size, pitch * size, (size, size)
    )
    psf = glare.camera_psf(camera, (size, size), light.line(WAVELENGTH), sample="point", border_fade=0)
    x = (np.arange(size) - size // 2) * pitch
    radius = np.hypot(x[:, None], x)
    z = np.where(radius == 0, 1, np.pi * radius / (WAVELENGTH * F_NUMBER))
    airy = np.where(radius == 0, 1, (2 * j1(z) / z) ** 2)
    found = psf.pixels[..., 1].astype(np.float64)
    areas = glare.camera_psf(camera, (size, size), light.line(WAVELENGTH), border_fade=0)
    ring = glare.encircled_energy(areas, 1.2197 * WAVELENGTH * F_NUMBER, camera.pixel_pitch)
    return [
        ("Airy pattern, point for point, of the peak", float(np.abs(found / found.max() - airy).max())),
        ("energy within the first dark ring (0.838)", ring),
    ]


def energy() -> list[tuple[str, float]]:
    """Return what a large kernel holds, and how a composited picture's sum changes."""
    size = 1025
    camera = glare.camera(FOCAL_LENGTH, F_NUMBER, aperture.iris(7, 1.0), resolution=(1280, 1920))
    psf = glare.camera_psf(camera, (size, size), light.illuminant("D65"), border_fade=0)
    pixels = np.zeros((1400, 1400, 3), dtype=np.float32)
    pixels[600:800, 600:800] = np.random.default_rng(SEED).lognormal(0, 3, (200, 200, 3))
    before = pixels.sum(axis=(0, 1), dtype=np.float64)
    after = glare.composite(Picture(pixels), psf).pixels.sum(axis=(0, 1), dtype=np.float64)
    return [
        ("energy in a kernel of 1025² pixels of 18.75 µm, f/16", psf.metadata["energy_inside"]),
        ("change of a picture's sum by 'replace'", float(np.abs(after / before - 1).max())),
    ]


def main() -> None:
    """Print the table."""
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, Aureole {aureole.__version__}, seed {SEED}\n"
    )
    for name, value in against_reference() + against_airy() + energy():
        print(f"{name:62}{value:12.3g}")


if __name__ == "__main__":
    main()
