"""A screen whose diffraction is known, photographed by a virtual camera, measured, and compared."""

import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, surface
from aureole.bench.report import Column, Table
from aureole.light.differences import difference_2000, lab
from aureole.records import Spectrum, Stage
from aureole.surface import virtual
from aureole.surface.table import axes

WAVELENGTH, STEP = 530e-9, 4.8e-5  # of h from pixel to pixel
EXPOSURES, SEED = (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0), 3
WIDTHS_NM = (10, 20, 40)
# Luminances, of a mirror's, below which there is nothing to compare.
FAINT = 1e-4
COLUMNS = (
    Column("photograph", "{case}", words=True),
    Column("median error of Y", "{luminance:.2%}"),
    Column("mean ΔE00", "{colour:.2f}"),
    Column("95 %", "{colour_95:.2f}"),
    Column("centre", "{centre_px:.3f} px"),
    Column("time", "{seconds:.1f} s"),
)


def measured(photo: int, size: int) -> Iterator[Stage]:
    """Measure photographs, better and worse.

    Parameters
    ----------
    photo : int
        Pixels of a photograph on each side.
    size : int
        Samples of the tables on each side.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    screen = Screen(photo, size)
    rows: list[dict[str, Any]] = []
    cases = ["without noise", *(f"noise, filter of {width} nm" for width in WIDTHS_NM)]
    for index, (case, width) in enumerate(zip(cases, (0, *WIDTHS_NM), strict=True)):
        yield Stage(index / len(cases), f"measuring, {case}")
        rows.append({"case": case} | screen.judged(screen.photographed(width)))
    title = f"A screen measured from photographs of {photo}²"
    notes = (
        f"Pixels of 74.27 µm, nine of them lit, at 530 nm over |h| < {photo * STEP / 2:.3g}; a table of "
        f"{size}² under E beside the screen's own formula at its places, where all wavelengths were "
        "photographed and Y is above 10⁻⁴ of a mirror's. noise: six exposures, 14 bits, electrons that "
        f"arrive at random, seed {SEED}, a lens that blurs by a pixel; black level and centre are found, the "
        "filter's width is known and undone. centre: how far the zero order was found from its place.",
    )
    yield Stage(1.0, "measurement", (Table("measurement", title, COLUMNS, tuple(rows), notes),))


class Screen:
    """A screen before a virtual camera.

    Parameters
    ----------
    photo : int
        Pixels of a photograph on each side.
    size : int
        Samples of the tables on each side.
    """

    def __init__(self, photo: int, size: int) -> None:
        self.photo, self.size, self.formula = photo, size, surface.lcd_screen()
        self.geometry = surface.UniformGeometry(STEP)
        self.centre = (photo / 2 + 1.37, photo / 2 - 2.18)
        # Violet was photographed least far out.
        self.reach = 0.48 * STEP * photo * 380e-9 / WAVELENGTH
        self.truth: NDArray[np.float64] | None = None

    def photographed(self, width_nm: float) -> dict[str, Any]:
        """Take photographs, and say what their maker knows.

        Parameters
        ----------
        width_nm : float
            Of the filter; 0 is a single line and a camera without noise.

        Returns
        -------
        dict
            What `table_from_photo` takes.
        """
        if not width_nm:
            return {"photos": self._seen(light.line(WAVELENGTH)), "exposures": 1.0}
        band = virtual.gaussian_filter_spectrum(WAVELENGTH, width_nm * 1e-9)
        camera = surface.VirtualCamera(blur=1.0)
        full = 0.9 * (camera.saturation - camera.black)
        return {
            "photos": surface.photograph(0.9 * self._seen(band), EXPOSURES, camera, SEED),
            "exposures": [full * exposure for exposure in EXPOSURES],
            "black": "estimate",
            "saturation": camera.saturation,
            "read_noise": camera.read_noise / camera.gain,
            "gain": camera.gain,
            "band": band,
            "blur": 1.0,
        }

    def judged(self, how: dict[str, Any]) -> dict[str, float]:
        """Measure photographs and compare the table with the screen's formula.

        Parameters
        ----------
        how : dict
            What `table_from_photo` takes.

        Returns
        -------
        dict
            luminance, colour, colour_95, centre_px, seconds.
        """
        start = time.perf_counter()
        table = surface.table_from_photo(
            geometry=self.geometry,
            wavelength=WAVELENGTH,
            model="amplitude",
            irradiance=1 / (4 * np.pi**2),
            table_size=self.size,
            **how,
        )
        seconds = time.perf_counter() - start
        found = self._within(table)
        if self.truth is None:
            self.truth = self._summed(table)
        seen = self.truth[..., 1] > FAINT
        truth, found = self.truth[seen], found[seen]
        white = light.white(light.illuminant("E"))
        colours = difference_2000(lab(truth, white), lab(found, white))
        row, column = table.metadata["patterns"][0]["centre"]
        return {
            "luminance": float(np.median(np.abs(found[:, 1] - truth[:, 1]) / truth[:, 1])),
            "colour": float(colours.mean()),
            "colour_95": float(np.quantile(colours, 0.95)),
            "centre_px": math.hypot(row - self.centre[0], column - self.centre[1]),
            "seconds": seconds,
        }

    def _seen(self, band: Spectrum) -> NDArray[np.float64]:
        shape = (self.photo, self.photo)
        return virtual.radiance(self.formula, band, self.geometry, shape, self.centre)

    def _within(self, table: surface.ScatterTable) -> NDArray[np.float64]:
        rows, columns = (np.abs(line) <= self.reach for line in axes(table))
        return table.values[np.ix_(rows, columns)].astype(np.float64)

    def _summed(self, table: surface.ScatterTable) -> NDArray[np.float64]:
        h_b, h_t = (line[np.abs(line) <= self.reach] for line in axes(table))
        total = np.zeros((h_b.size, h_t.size, 3))
        for wavelength, weight in zip(*light.quadrature(light.illuminant("E"), 81), strict=True):
            total += self.formula(h_t[None, :], h_b[:, None], float(wavelength))[..., None] * weight
        return total
