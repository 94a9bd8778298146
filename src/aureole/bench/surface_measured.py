"""A screen whose diffraction is known, photographed by a virtual camera, measured, and compared."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, surface
from aureole.bench.report import Column, Table
from aureole.light.differences import difference_2000, lab
from aureole.light.lookups import stretched_at
from aureole.records import Stage
from aureole.surface import virtual

WAVELENGTH, STEP = 530e-9, 4.8e-5  # of h from pixel to pixel
EXPOSURES, SEED = (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0), 3
WIDTHS_NM = (10, 20, 40)
COLUMNS = (
    Column("photograph", "{case}", words=True),
    Column("median error of Y", "{luminance:.2%}"),
    Column("mean ΔE00", "{colour:.2f}"),
    Column("95 %", "{colour_95:.2f}"),
    Column("centre", "{centre_px:.3f} px"),
)


def measured(photo: int) -> Iterator[Stage]:
    """Measure photographs, better and worse.

    Parameters
    ----------
    photo : int
        Pixels of a photograph on each side.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    bench = _Bench(photo)
    rows = []
    cases = bench.cases()
    for index, (case, how) in enumerate(cases.items()):
        yield Stage(index / len(cases), f"measuring, {case}")
        rows.append({"case": case} | bench.judged(how))
    title = f"A screen measured from photographs of {photo}²"
    notes = (
        f"Pixels of 74.27 µm, nine of them lit, at 530 nm over |h| < {photo * STEP / 2:.3g}. The table under "
        "E, at the places of a table of 2049², warp 5, beside the same from the screen's own formula at each "
        "wavelength; where Y is above 10⁻⁴ of the largest. noise: six exposures, 14 bits, electrons that "
        f"arrive at random, seed {SEED}, a lens that blurs by a pixel; the width of the filter is known and "
        "undone. centre: how far the zero order was found from its place.",
    )
    yield Stage(1.0, "measurement", (Table("measurement", title, COLUMNS, tuple(rows), notes),))


class _Bench:
    """A screen, a camera, and the table's places where every wavelength was photographed."""

    def __init__(self, photo: int) -> None:
        self.photo, self.screen = photo, surface.lcd_screen()
        self.geometry = surface.UniformGeometry(STEP)
        self.centre = (photo / 2 + 1.37, photo / 2 - 2.18)
        self.wavelengths, self.weights = light.quadrature(light.illuminant("E"), 81)
        places = 2.0 * np.linspace(-1.0, 1.0, 2049) ** 5
        self.places = places[np.abs(places) <= 0.49 * photo * STEP * 380e-9 / WAVELENGTH]
        self.truth = sum(
            self.screen(self.places[None, :], -self.places[:, None], float(wavelength))[..., None] * weight
            for wavelength, weight in zip(self.wavelengths, self.weights, strict=True)
        )

    def cases(self) -> dict[str, dict[str, Any]]:
        """Return photographs and what is known of them, by name."""
        found = {"without noise": self._clean()}
        for width in WIDTHS_NM:
            band = virtual.gaussian_filter_spectrum(WAVELENGTH, width * 1e-9)
            found[f"noise, filter of {width} nm"] = self._noisy(band)
        return found

    def judged(self, how: dict[str, Any]) -> dict[str, float]:
        """Measure and compare."""
        pattern = surface.measure_pattern(
            geometry=self.geometry, wavelength=WAVELENGTH, irradiance=1 / (4 * np.pi**2), **how
        )
        scales = WAVELENGTH / self.wavelengths
        weights = self.weights * scales[:, None] ** 2
        found = stretched_at(surface.on_grid(pattern), scales, weights, self.places, self.places, 2)
        return self._apart(found.astype(np.float64)) | {"centre_px": self._off(how)}

    def _apart(self, found: NDArray[np.float64]) -> dict[str, float]:
        luminance = self.truth[..., 1]
        seen = luminance > 1e-4 * luminance.max()
        white = light.white(light.illuminant("E"))
        colours = difference_2000(lab(self.truth[seen], white), lab(found[seen], white))
        return {
            "luminance": float(np.median(np.abs(found[..., 1] - luminance)[seen] / luminance[seen])),
            "colour": float(colours.mean()),
            "colour_95": float(np.quantile(colours, 0.95)),
        }

    def _off(self, how: dict[str, Any]) -> float:
        photos = how["photos"] if isinstance(how["photos"], list) else [how["photos"]]
        merged = surface.merge(
            photos,
            how["exposures"] if isinstance(how["exposures"], list) else [how["exposures"]],
            how.get("black", 0.0),
            how.get("saturation"),
            how.get("read_noise", 1.0),
            how.get("gain", 1.0),
        )
        found = surface.find_centre(merged.values)
        return float(np.hypot(found.row - self.centre[0], found.column - self.centre[1]))

    def _scene(self, band: Any) -> NDArray[np.float64]:
        return virtual.radiance(self.screen, band, self.geometry, (self.photo, self.photo), self.centre)

    def _clean(self) -> dict[str, Any]:
        return {"photos": self._scene(light.line(WAVELENGTH)), "exposures": 1.0}

    def _noisy(self, band: Any) -> dict[str, Any]:
        camera = surface.VirtualCamera(blur=1.0)
        full = 0.9 * (camera.saturation - camera.black)
        return {
            "photos": surface.photograph(0.9 * self._scene(band), EXPOSURES, camera, SEED),
            "exposures": [full * exposure for exposure in EXPOSURES],
            "black": "estimate",
            "saturation": camera.saturation,
            "read_noise": camera.read_noise / camera.gain,
            "gain": camera.gain,
            "band": band,
            "blur": 1.0,
            "power": 2.0,
        }
