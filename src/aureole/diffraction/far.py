"""The far field of an aperture: one signature, several methods, and the chooser.

`far_field` returns F(u, v) = ∬ f(x, y) exp(−i2π (u x + v y)) dx dy in square metres, u and v in cycles
per metre, so that ∬|F|² du dv = ∬|f|² dx dy. `far_power` returns |F|² and stores no F where it can.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction import culling
from aureole.diffraction.chirpz import chirpz_field, chirpz_power, fft_field, fft_lengths, fft_power
from aureole.diffraction.cosines import cosines_serve
from aureole.diffraction.polygons import polygons_field, polygons_power
from aureole.diffraction.quads import quads_field, quads_power
from aureole.diffraction.quadtree import quadtree
from aureole.diffraction.reference import reference_field
from aureole.diffraction.rows import Factor, factor, multiplications, rows_field, rows_power, sample
from aureole.records import Aperture, Field, Grid

RASTER_SIZE = 1024
# Above so many edges an outline costs more than the chirp-z transform of its raster.
MOST_EDGES = 4000
# Seconds a call, and a unit of work, fitted to benchmarks/far_field.py on two cores.
ROWS_CALL, ROWS_PRODUCT, ROWS_OUTPUT, ROWS_PIXEL = 1e-3, 3e-11, 0.8e-9, 1e-9
CHIRP_CALL, CHIRP_SAMPLE, CHIRP_OUTPUT = 35e-5, 22e-9, 8e-9
FFT_CALL, FFT_SAMPLE, FFT_OUTPUT = 3e-4, 4e-9, 1e-9
COSINES_CALL, COSINES_SAMPLE, COSINES_OUTPUT = 4e-4, 2.2e-9, 0.6e-9


def _by_quads(aperture: Aperture, grid: Grid) -> NDArray[np.complex64]:
    assert aperture.mask is not None
    return quads_field(quadtree(aperture.mask, aperture.width), grid)


Method = Callable[..., NDArray[Any]]
METHODS: dict[str, Method] = {
    "reference": reference_field,
    "polygons": polygons_field,
    "quads": _by_quads,
    "rows": rows_field,
    "chirpz": chirpz_field,
    "fft": fft_field,
}


def _squared(field: Method) -> Method:
    """Return a method that squares another one's field."""

    def power(aperture: Aperture, grid: Grid, **options: Any) -> NDArray[Any]:
        amplitude = field(aperture, grid, **options)
        if amplitude.dtype == np.complex128:
            return np.asarray(amplitude.real**2 + amplitude.imag**2)
        from aureole.diffraction import _kernels_rows  # compiled code: loaded when first used

        out = np.empty(grid.shape, dtype=np.float32)
        _kernels_rows.square_field(amplitude, out)
        return out

    return power


def _power_by_quads(aperture: Aperture, grid: Grid) -> NDArray[np.float32]:
    assert aperture.mask is not None
    return quads_power(quadtree(aperture.mask, aperture.width), grid)


POWERS: dict[str, Method] = {name: _squared(METHODS[name]) for name in METHODS} | {
    "quads": _power_by_quads,
    "polygons": polygons_power,
    "rows": rows_power,
    "chirpz": chirpz_power,
    "fft": fft_power,
}
OF_PIXELS = ("quads", "rows", "chirpz", "fft")
OF_WAVEFRONTS = ("reference", "chirpz", "fft")


def far_field(
    aperture: Aperture,
    grid: Grid,
    method: str = "auto",
    raster_size: int = RASTER_SIZE,
    wavelength: float | None = None,
) -> Field:
    """Return the Fourier transform of an aperture on a regular grid of frequencies.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    grid : Grid
        Frequencies in cycles per metre; any spacing, any centre, odd and even sizes.
    method : str
        "reference", direct sums in float64; "polygons", exact for outlines; "quads", "rows",
        "chirpz" and "fft" for pixels; "auto" takes exact outlines where they exist and what should be
        the fastest transform of pixels elsewhere. A wavefront is served by "reference", "chirpz" and
        "fft".
    raster_size : int
        Pixels a side to which outlines are rasterized where the method works on pixels.
    wavelength : float, optional
        Metres; an aperture with a wavefront W needs it for the phase 2π W / λ. Then F(−u, −v) is no
        longer the conjugate of F(u, v).

    Returns
    -------
    Field
        F in square metres; complex64, complex128 from "reference".

    Raises
    ------
    refuse.Refusal
        Where the grid, the method or the wavelength does not fit.
    """
    aperture, transform = _chosen(METHODS, aperture, grid, method, raster_size, wavelength)
    return Field(transform(aperture, grid), grid)


def far_power(
    aperture: Aperture,
    grid: Grid,
    method: str = "auto",
    raster_size: int = RASTER_SIZE,
    wavelength: float | None = None,
    cull: float | None = None,
) -> NDArray[Any]:
    """Return |F|² of an aperture on a regular grid of frequencies, F as of `far_field`.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    grid : Grid
        Frequencies in cycles per metre; any spacing, any centre, odd and even sizes.
    method : str
        As for `far_field`.
    raster_size : int
        Pixels a side to which outlines are rasterized where the method works on pixels.
    wavelength : float, optional
        As for `far_field`.
    cull : float, optional
        A level, of the power at frequency zero: what lies below it may be left at zero where that saves
        time. Methods "auto" and "rows" take it; None or 0 leaves nothing out.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Metres to the fourth; float64 from "reference". An array and no `Pattern`, since frequencies in
        cycles per metre belong to no wavelength.

    Raises
    ------
    refuse.Refusal
        Where the grid, the method, the wavelength or the level does not fit.
    """
    methods = POWERS
    if cull:
        culling.check_level(cull)
        if refuse.one_of("method", method, ("auto", *METHODS)) not in ("auto", "rows"):
            raise refuse.Refusal(
                f"method '{method}' computes every frequency and cannot cull; use 'rows' or 'auto'."
            )
        if method == "auto" and aperture.mask is not None and aperture.wavefront is None:
            check_grid(grid)
            return _culled(aperture, grid, cull)
        methods = POWERS | {"rows": partial(culling.culled_power, level=cull)}
    aperture, transform = _chosen(methods, aperture, grid, method, raster_size, wavelength)
    return transform(aperture, grid)


def _culled(aperture: Aperture, grid: Grid, level: float) -> NDArray[Any]:
    """Cull where the tiles that are left take less time than the fastest whole transform."""
    assert aperture.mask is not None
    size = len(aperture.mask)
    name, seconds = _rival(aperture, grid)
    rows, columns = computed(grid)
    factors = factor(aperture.mask)
    # The test takes two products of thin matrices a tile and axis.
    whole, test = (multiplications(factors, count, columns) for count in (rows, 4 * rows // culling.TILE))
    if _rows_seconds(size, test, grid) > seconds:
        return POWERS[name](aperture, grid)
    found = culling.survey(aperture, grid, level, factors)
    share = 1.0 if found is None else found.share()
    if _rows_seconds(size, int(test + share * (whole - test)), grid) > seconds:
        return POWERS[name](aperture, grid)
    if found is None:
        return rows_power(aperture, grid, factors)
    return culling.evaluate(found, aperture, grid)


def _chosen(
    methods: dict[str, Method],
    aperture: Aperture,
    grid: Grid,
    method: str,
    raster_size: int,
    wavelength: float | None,
) -> tuple[Aperture, Method]:
    """Return the aperture as the method needs it, and the method."""
    check_grid(grid)
    name = refuse.one_of("method", method, ("auto", *METHODS))
    if aperture.wavefront is not None:
        apertures.check_wavefront(aperture, wavelength)
        name = _for_wavefront(aperture, grid, name)
        return aperture, partial(methods[name], wavelength=wavelength)
    if name == "auto" and aperture.mask is None:
        name = "polygons" if _edges(aperture) <= MOST_EDGES else "chirpz"
    if name == "polygons" and aperture.mask is not None:
        raise refuse.Refusal("method 'polygons' needs outlines and this aperture is a raster; use 'quads'.")
    if name in OF_PIXELS and aperture.mask is None:
        mask = apertures.rasterize(aperture, raster_size)
        aperture = Aperture(aperture.width, mask=mask, name=aperture.name)
    if name != "auto":
        return aperture, methods[name]
    name, factors = _fastest(aperture, grid)
    return aperture, methods[name] if factors is None else partial(methods[name], factors=factors)


def check_grid(grid: Grid) -> None:
    """Refuse a grid without samples, with a spacing that is not above zero, or with a lost centre.

    Parameters
    ----------
    grid : Grid
        Any.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    for name, pair in (("shape", grid.shape), ("spacing", grid.spacing), ("centre", grid.centre)):
        refuse.shape_of(f"grid {name}", pair, (2,))
    for axis, count, spacing, centre in zip(
        ("rows", "columns"), grid.shape, grid.spacing, grid.centre, strict=True
    ):
        refuse.at_least(f"grid {axis}", count, 1)
        refuse.positive(f"grid spacing of the {axis}", spacing)
        refuse.finite(f"grid centre of the {axis}", centre)


def _edges(aperture: Aperture) -> int:
    return sum(len(ring.vertices) for ring in aperture.outlines)


def _fastest(aperture: Aperture, grid: Grid) -> tuple[str, list[Factor] | None]:
    """Name the transform of a raster that should take the least time; what was found of its rows."""
    assert aperture.mask is not None
    size = len(aperture.mask)
    rival, seconds = _rival(aperture, grid)
    rows, columns = computed(grid)
    half = (size + 1) // 2
    if _rows_seconds(size, 4 * half * columns * (rows + half), grid) <= seconds:
        return "rows", None
    quadrants, lines = sample(aperture.mask)
    if _rows_seconds(size, quadrants * lines * rows * columns, grid) > seconds:
        return rival, None
    # Where a few rows look promising the whole mask decides; what was found is used, and is paid for.
    factors = factor(aperture.mask)
    spent = ROWS_PIXEL * size**2
    if _rows_seconds(size, multiplications(factors, rows, columns), grid) <= seconds + spent:
        return "rows", factors
    return rival, None


def _rival(aperture: Aperture, grid: Grid) -> tuple[str, float]:
    """Name the faster of 'chirpz' and 'fft', and what it should take."""
    assert aperture.mask is not None
    rivals = {"chirpz": _chirp_seconds(len(aperture.mask), grid)}
    lengths = fft_lengths(aperture, grid)
    if lengths is not None:
        rivals["fft"] = _fft_seconds(aperture, lengths, grid)
    name = min(rivals, key=lambda each: rivals[each])
    return name, rivals[name]


def computed(grid: Grid) -> tuple[int, int]:
    """Return how many rows and columns 'rows' computes; the others mirror them.

    Parameters
    ----------
    grid : Grid
        Any.

    Returns
    -------
    tuple of int
        About half as many as the grid has along an axis centred on zero.
    """
    rows, columns = (
        count // 2 + 1 if centre == 0 else count
        for count, centre in zip(grid.shape, grid.centre, strict=True)
    )
    return rows, columns


def _for_wavefront(aperture: Aperture, grid: Grid, name: str) -> str:
    """Name the method that transforms an aperture with a wavefront."""
    if name not in ("auto", *OF_WAVEFRONTS):
        raise refuse.Refusal(
            f"method '{name}' takes real transmittances and this aperture has a wavefront; use 'chirpz'."
        )
    if name != "auto":
        return name
    assert aperture.mask is not None
    lengths = fft_lengths(aperture, grid)
    # A complex transform takes twice the real one's time.
    chirp = _chirp_seconds(len(aperture.mask), grid)
    return "fft" if lengths is not None and 2 * _fft_seconds(aperture, lengths, grid) < chirp else "chirpz"


def _rows_seconds(size: int, products: int, grid: Grid) -> float:
    """Return what 'rows' should take with so many multiplications."""
    outputs = grid.shape[0] * grid.shape[1]
    return ROWS_CALL + ROWS_PRODUCT * products + ROWS_OUTPUT * outputs + ROWS_PIXEL * size**2


def _chirp_seconds(size: int, grid: Grid) -> float:
    """Return what 'chirpz' should take."""
    rows, columns = grid.shape
    samples = size * (size + columns) + columns * (size + rows)
    return CHIRP_CALL + CHIRP_SAMPLE * samples + CHIRP_OUTPUT * rows * columns


def _fft_seconds(aperture: Aperture, lengths: tuple[int, int], grid: Grid) -> float:
    """Return what 'fft' should take at its own lengths."""
    outputs = grid.shape[0] * grid.shape[1]
    if aperture.wavefront is not None or not cosines_serve(aperture, grid, lengths):
        return FFT_CALL + FFT_SAMPLE * lengths[0] * lengths[1] + FFT_OUTPUT * outputs
    assert aperture.mask is not None
    half = len(aperture.mask) // 2
    samples = half * lengths[0] // 2 + (grid.shape[0] // 2 + 1) * lengths[1] // 2
    return (
        COSINES_CALL
        + COSINES_SAMPLE * samples * sample(aperture.mask)[0]
        + COSINES_OUTPUT * (outputs + 4 * half**2) / 2
    )
