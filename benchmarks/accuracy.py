"""How right the far field, the near field and the point spread functions are: a table for the README.

    python benchmarks/accuracy.py

Every line compares with something that is not fast: closed forms, direct sums in float64, conservation.
The near field is that of 1024² places on a plane twice as wide as the opening, at some of them.
"""

import os
import platform

import numpy as np
from scipy.special import j1

import aureole
from aureole import Aperture, Grid, Picture, aperture, diffraction, glare, light
from aureole.diffraction.near import METHODS

SEED = 3
FOCAL_LENGTH, F_NUMBER, WAVELENGTH = 50e-3, 16.0, 550e-9
NEAR_SIZE, FRESNEL_NUMBERS = 1024, (0.1, 1, 10, 100, 1000)
LATTICES, LATTICE = 10, (4, 5)
NEAR_METHODS = [name for name in METHODS if name != "reference"]


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


def near_fields() -> list[tuple[str, float]]:
    """Return each near-field method's largest error at some places over three shapes, of the mean."""
    width, step = 2e-3, 4e-3 / NEAR_SIZE
    grid = Grid((NEAR_SIZE, NEAR_SIZE), (step, step))
    shapes = [aperture.iris(7, width), aperture.circle(width), aperture.whirl(width)]
    rows = []
    for number in FRESNEL_NUMBERS:
        distance = (width / 2) ** 2 / (WAVELENGTH * number)
        worst: dict[str, float] = {}
        for outline in shapes:
            raster = aperture.from_mask(aperture.rasterize(outline, NEAR_SIZE), width)
            exact, of_pixels = (truths(each, grid, distance) for each in (outline, raster))
            compared = {"pixels": (of_pixels, exact)}
            for method in NEAR_METHODS:
                opening, truth = (outline, exact) if method == "polygons" else (raster, of_pixels)
                found = diffraction.near_power(opening, grid, distance, WAVELENGTH, method)
                compared[method] = (np.concatenate([found[at].ravel() for at in places()]), truth)
            for name, (found, truth) in compared.items():
                worst[name] = max(worst.get(name, 0), float(np.abs(found - truth).max() / truth.mean()))
        for name, error in worst.items():
            about = f"{NEAR_SIZE}² pixels for the outline" if name == "pixels" else f"'{name}'"
            rows.append((f"near field, Fresnel number {number:g}, {about}, of the mean", error))
    return rows


def truths(opening: Aperture, grid: Grid, distance: float) -> np.ndarray:
    """Return the irradiance at all places by direct sums, one after another."""
    axis = grid.axes()[0]
    found = []
    for rows, columns in places():
        lattice = [axis[index] for index in (rows.ravel(), columns.ravel())]
        spacing = [float(line[1] - line[0]) for line in lattice]
        middle = [float(line[len(line) // 2]) for line in lattice]
        few = Grid((len(lattice[0]), len(lattice[1])), (spacing[0], spacing[1]), (middle[0], middle[1]))
        found.append(diffraction.near_power(opening, few, distance, WAVELENGTH, "reference").ravel())
    return np.concatenate(found)


def places() -> list[tuple[np.ndarray, np.ndarray]]:
    """Return 200 places of the plane: ten lattices of 4 × 5, their steps and corners drawn by chance."""
    generator = np.random.default_rng(SEED)
    found = []
    for _ in range(LATTICES):
        lines = []
        for count in LATTICE:
            step = generator.integers(1, NEAR_SIZE // count)
            first = generator.integers(0, NEAR_SIZE - step * (count - 1))
            lines.append(first + step * np.arange(count))
        found.append(np.ix_(*lines))
    return found


def main() -> None:
    """Print the table."""
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, Aureole {aureole.__version__}, seed {SEED}\n"
    )
    for name, value in against_reference() + near_fields() + against_airy() + energy():
        print(f"{name:76}{value:10.3g}")


if __name__ == "__main__":
    main()
