"""Measure simulated samples on a simulated bench, and draw what comes of it beside what was there.

    python docs/surface_measured.py NAME PICTURE

bench: camera, lamp, filter and sample, and the angles that make h.
screens: two phones' screens in white light, and from a table measured under a green filter (Fig. 7).
table: the photograph, the pattern over h, and the table on its warped axes (Fig. 6).
channels: holographic paper in white light; from a red filter's photograph, from the channels of one
colour photograph (Fig. 16). Prints each one's difference from the first.
taylor: a screen's heights, exact, and by series of order 1, 2 and 5, shallow and deep (Fig. 13).
bokeh: a grating seen through a lens, sharpened, and fitted to the known profile (Fig. 29).
"""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from surface_sheets import SCREEN, SHEET, Pixels, drawn, facing, holographic, lamp, sheet, shown, write

from aureole import light, picture, surface

Reals = NDArray[np.float64]
Place = tuple[float, float, float]
Formula = Callable[[Reals, Reals, float], Reals]
CAMERA = surface.VirtualCamera(blur=0.7)
READING = {"black": 512.0, "saturation": 16383.0, "read_noise": 0.75, "gain": 4.0}
BRACKET = [4.0**k for k in range(8)]


def photographed(
    formula: Formula, band: "light.Spectrum", bench: "surface.BenchGeometry", size: int
) -> list[Reals]:
    """Return a bracket of a sample under a filter, its brightest pixel just below the sensor's range."""
    middle = (size / 2 - 0.5, size / 2 - 0.5)
    scene = surface.virtual.radiance(formula, band, bench, (size, size), middle)
    return surface.photograph(0.9 * scene / scene.max(), BRACKET, CAMERA)


def in_white_light(
    formula: Formula, shape: "surface.Shape", view: "surface.View", place: Place, name: str
) -> Pixels:
    """Return what a camera would see of a sample, wavelength by wavelength and without any table."""
    seen = surface.see(shape, view, samples=2)
    toward = np.asarray(place) - seen.places
    away = np.linalg.norm(toward, axis=-1, keepdims=True)
    toward /= away
    h = toward + seen.outward
    h_t, h_b = ((h * axis).sum(axis=-1)[seen.hit] for axis in (seen.tangents, seen.bitangents))
    irradiance = (toward * seen.normals).sum(axis=-1) * (place[2] / away[..., 0]) ** 2
    lit = light.illuminant(name)
    found = np.zeros((*seen.hit.shape, 3))
    for wavelength, weights in zip(*light.quadrature(lit, 301), strict=True):
        found[seen.hit] += formula(h_t, h_b, wavelength)[:, None] * weights
    colours = light.from_xyz(found * irradiance[..., None], "rec709", light.white(lit))
    rows, columns = view.shape
    return np.asarray(colours.reshape(rows, 2, columns, 2, 3).mean(axis=(1, 3)), dtype=np.float32)


def screens() -> Pixels:
    """Return two screens, seen and rendered from a measurement under a filter of 10 nm."""
    view, place = facing((400, 206), 0.1, 0.40), (0.0, 0.0, 0.40)
    bench = surface.BenchGeometry(0.40, 0.40, 0.1e-3)
    pictures = []
    for name in ("lcd-342ppi", "lcd-534ppi"):
        formula = surface.grating(name).pattern
        band = surface.virtual.gaussian_filter_spectrum(530e-9, 10e-9, 13)
        table = surface.table_from_photo(
            photographed(formula, band, bench, 1200),
            BRACKET,
            bench,
            530e-9,
            "F1",
            model="amplitude",
            table_size=1024,
            **READING,
        )
        truth = in_white_light(formula, SCREEN, view, place, "F1")
        found = drawn(table, SCREEN, view, lamp(place)).pixels[..., :3]
        pictures += [levelled(truth, 97), levelled(found, 97)]
    return sheet([pictures])


def levelled(pixels: NDArray[np.floating], percent: float) -> Pixels:
    """Return a picture for a screen whose brightness at a percentile is one."""
    return shown(pixels / np.percentile(pixels[..., 1], percent), 0.5)


def table() -> Pixels:
    """Return the longest but two of a bracket, the pattern, and the table."""
    bench = surface.BenchGeometry(0.40, 0.40, 0.1e-3)
    band = surface.virtual.gaussian_filter_spectrum(530e-9, 10e-9, 13)
    photos = photographed(surface.grating("lcd-342ppi").pattern, band, bench, 1000)
    pattern = surface.measure_pattern(photos, BRACKET, bench, 530e-9, **READING)
    warped = surface.table_from_pattern(pattern, size=420, model="amplitude")
    green = light.from_xyz(light.white(light.illuminant("line:530nm")), "rec709")
    counts = np.clip((photos[4] - 512.0) / (16383.0 - 512.0), 0, 1)[80:920:2, 80:920:2, None]
    dark = surface.diffraction_pattern(pattern.values, pattern.half_range, 530e-9).values
    middle = len(dark) // 2
    part = dark[middle - 420 : middle + 420 : 2, middle - 420 : middle + 420 : 2]
    logarithm = picture.to_display(np.repeat(np.maximum(part, 0)[..., None], 3, -1), tone="log", decades=5.0)
    photograph = shown(counts * np.maximum(green, 0) * 3, 0.0)
    return sheet([[photograph, logarithm, compressed(surface.rgb(warped))]])


def compressed(colours: NDArray[np.floating]) -> Pixels:
    """Return colours whose brightness is drawn by its fourth root, so that the dim ones are seen."""
    lit = np.maximum(colours, 0.0)
    bright = np.maximum(lit.max(axis=-1, keepdims=True), 1e-12)
    return shown(lit / bright * (bright / bright.max()) ** 0.25, 0.0)


# Middle and width of what a colour camera's channels see of white light, and of a red filter; metres.
CHANNELS = {"red": (600e-9, 80e-9), "green": (540e-9, 90e-9), "blue": (460e-9, 80e-9)}
RED_FILTER = (680e-9, 10e-9)


def channels() -> Pixels:
    """Return holographic paper in white light, and rendered from four photographs."""
    formula, place = holographic().pattern, (0.0, 0.0, 0.2)
    view, bench = facing((280, 280), 0.122, 0.2), surface.BenchGeometry(0.2, 0.2, 0.2e-3)
    truth = in_white_light(formula, SHEET, view, place, "E")
    pictures = [levelled(truth, 96)]
    for name, (middle, width) in ({"red filter": RED_FILTER} | CHANNELS).items():
        band = surface.virtual.gaussian_filter_spectrum(middle, width, 25)
        photos = photographed(formula, band, bench, 600)
        table = surface.table_from_photo(
            photos, BRACKET, bench, middle, model="amplitude", table_size=512, warp=1, **READING
        )
        found = drawn(table, SHEET, view, lamp(place)).pixels[..., :3]
        found = found * (truth[140, 140, 1] / found[140, 140, 1])
        near = np.abs(found - truth)[truth.max(axis=-1) > 0].mean() / np.abs(truth).mean()
        print(f"{name}: mean difference {near:.1%} of the mean")
        pictures.append(shown(found / np.percentile(truth[..., 1], 96), 0.5))
    return sheet([pictures])


def screen_heights(depth: float, period: float = 16e-6, samples: int = 64) -> "surface.HeightField":
    """Return sub-pixels of a screen: low openings with rounded corners, a small electrode in each."""
    x = (np.arange(samples) + 0.5) / samples - 0.5
    across, down = np.meshgrid(x, x)
    opening = ((np.abs(across) / 0.36) ** 6 + (np.abs(down) / 0.42) ** 6) < 1
    electrode = (np.abs(across + 0.18) < 0.12) & (np.abs(down - 0.28) < 0.1)
    return surface.height_field(depth * (opening - 0.6 * electrode), period / samples)


def taylor() -> Pixels:
    """Return a shallow and a deep screen, exactly and by series of order 1, 2 and 5."""
    view, lit = facing((210, 210), 0.1, 0.4), lamp((0.0, 0.0, 0.4), 1.0, 0.0005)
    rows = []
    for depth in (20e-9, 180e-9):
        heights = screen_heights(depth)
        line = []
        for method, order in (("exact", 1), ("taylor", 1), ("taylor", 2), ("taylor", 5)):
            table = surface.table_from_height(heights, size=512, half_range=0.6, method=method, order=order)
            found = drawn(table, surface.Plane(0.1, 0.1), view, lit).pixels[..., :3]
            line.append(found)
            error = surface.taylor_error(heights, 450e-9, order) if method == "taylor" else 0.0
            print(f"{depth * 1e9:.0f} nm, {method} {order}: {error:.2%} of the light elsewhere at 450 nm")
        scale = np.percentile(line[0][..., 1], 98)
        rows.append([shown(found / scale, 0.0) for found in line])
    return sheet(rows)


def bench(path: Path) -> None:
    """Draw the bench from above: camera, lamp, filter, sample, and the two unit vectors whose sum is h."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(8.4, 3.9), layout="constrained")
    camera, flash, point = np.array([-0.55, 3.0]), np.array([0.75, 2.75]), np.array([0.9, 0.0])
    axes.add_patch(pyplot.Rectangle((-2.0, -0.14), 4.0, 0.14, color="#94a3b8"))
    axes.text(-1.95, -0.36, "sample, flat", fontsize=9)
    axes.add_patch(pyplot.Rectangle((camera[0] - 0.3, camera[1]), 0.6, 0.34, color="#334155"))
    axes.text(camera[0] - 0.36, camera[1] + 0.1, "camera, raw, a bracket", ha="right", fontsize=9)
    axes.plot(*flash, "o", color="#f59e0b", ms=9)
    axes.text(flash[0] + 0.15, flash[1] + 0.22, "small lamp (a phone's flash, an LED)", fontsize=9)
    axes.plot([flash[0] - 0.3, flash[0] + 0.3], [flash[1] - 0.3] * 2, color="#16a34a", lw=5)
    axes.text(flash[0] + 0.4, flash[1] - 0.36, "narrow filter, λ", color="#16a34a", fontsize=9)
    # The mirror's law gives the zero order's place: as far along as heights divide.
    zero = camera[0] + (flash[0] - camera[0]) * camera[1] / (camera[1] + flash[1])
    for end, colour in ((camera, "#2563eb"), (flash, "#f59e0b")):
        axes.plot([zero, end[0]], [0, end[1]], ":", color="#64748b", lw=1)
        axes.plot([point[0], end[0]], [0, end[1]], color=colour, lw=0.8, alpha=0.6)
        unit = 0.85 * (end - point) / np.hypot(*(end - point))
        axes.annotate("", point + unit, point, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2})
    axes.text(point[0] - 0.78, 0.62, "ω$_o$", color="#2563eb", fontsize=11)
    axes.text(point[0] + 0.06, 0.62, "ω$_i$", color="#b45309", fontsize=11)
    whole = 0.85 * sum((end - point) / np.hypot(*(end - point)) for end in (camera, flash))
    arrow = {"arrowstyle": "-|>", "color": "#dc2626", "lw": 2.5}
    axes.annotate("", point + np.array([whole[0], 0.0]), point, arrowprops=arrow)
    axes.text(point[0] + whole[0] / 2 - 0.12, 0.1, "h · t", color="#dc2626", fontsize=11)
    axes.text(zero - 0.1, -0.36, "zero order: h = 0", fontsize=9)
    axes.annotate("", (2.0, -0.07), (1.5, -0.07), arrowprops={"arrowstyle": "-|>", "color": "black"})
    axes.text(2.05, -0.13, "t", fontsize=11)
    axes.set(xlim=(-2.4, 3.1), ylim=(-0.5, 3.5), aspect="equal")
    axes.axis("off")
    with picture.whole_file(path) as part:
        figure.savefig(part, format=path.suffix.removeprefix("."), dpi=100)
    pyplot.close(figure)


def bokeh(path: Path) -> None:
    """Draw a bokeh of a blazed grating as the paper's: seen, sharpened, fitted, and what was there."""
    from matplotlib import pyplot

    pixel, period, rise = 0.083e-6, 1e-3 / 600, 0.253e-6
    x = np.arange(0, 2048) * pixel
    known = rise * ((x / period) % 1.0)
    generator = np.random.default_rng(5)
    light_in = gaussian_filter1d(200.0 + 3000.0 * known / rise, 1.5, mode="wrap")
    seen = generator.poisson(np.repeat(light_in[None, :], 24, axis=0)).astype(float)
    sharp = surface.richardson_lucy(seen, 1.5, 100)
    figure, axes = pyplot.subplots(figsize=(8.4, 3.2), layout="constrained")
    part = slice(200, 320)
    for label, values, colour in (("as seen", seen, "#94a3b8"), ("sharpened", sharp, "#ea580c")):
        a, b, error = surface.fit_heights(values.mean(axis=0), known)
        heights = a * (values.mean(axis=0) - b)
        axes.plot(x[part] * 1e6, heights[part] * 1e9, color=colour, label=f"{label}: {error:.1%} off")
        print(f"bokeh, {label}: {error:.2%} of the range, root mean square")
    axes.plot(x[part] * 1e6, known[part] * 1e9, color="#2563eb", lw=1, label="the grating")
    print(f"lines counted: {surface.count_lines(seen.mean(axis=0)):.2f} of {x.size * pixel / period:.2f}")
    print(f"Abbe's limit of the paper's lens: {surface.abbe_limit(0.85, 0.25, 5.6) * 1e6:.2f} um")
    axes.set(xlabel="µm across the grating", ylabel="height, nm")
    axes.legend(frameon=False, fontsize=8, loc="upper right", ncols=3)
    axes.margins(y=0.2)
    axes.grid(alpha=0.25)
    with picture.whole_file(path) as place:
        figure.savefig(place, format=path.suffix.removeprefix("."), dpi=100)
    pyplot.close(figure)


NAMES = {"screens": screens, "table": table, "channels": channels, "taylor": taylor}
FIGURES = {"bench": bench, "bokeh": bokeh}

if __name__ == "__main__":
    matplotlib.use("Agg")
    name, target = sys.argv[1], Path(sys.argv[2])
    if name in FIGURES:
        FIGURES[name](target)
    else:
        write(NAMES[name](), target)
