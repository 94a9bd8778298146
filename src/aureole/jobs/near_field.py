"""The near-field job: the light behind an opening, or behind an obstacle, on a plane at a distance."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, light, picture, refuse, units
from aureole.diffraction.near_picture import METHODS as SPECTRAL
from aureole.diffraction.near_picture import wavelengths_needed
from aureole.jobs import optics
from aureole.jobs.optics import Opening
from aureole.records import Aperture, Field, Grid, Picture, Spectrum, Stage

HALF_PLANE = "half-plane"
SHAPES = (*optics.SHAPES, HALF_PLANE)
EXACT_METHODS = ("auto", "polygons", "reference")
# Of no effect on its light: it ends a thousand million of these away.
HALF_PLANE_WIDTH = 1e-3
WAVELENGTH = 550e-9
# The plane is so many widths of the opening wide; behind a half plane, which has none, so many √(λz).
WIDTHS, FRINGES = 2.0, 10.0
# A plane that grows with the distance gains so many λz / width, the far field's scale.
SPREAD = 8.0
# Measured peaks, rounded up: planes, and tables of each row and column against the opening's pixels.
BYTES_PER_PIXEL = 80
BYTES_PER_TABLE_ENTRY = 40


@dataclass(frozen=True)
class NearFieldJob:
    """What near field to make: a plane wave of irradiance 1 falls on the opening.

    Parameters
    ----------
    opening : Opening
        Its shape; besides those of a camera, "half-plane" is a straight edge through the axis, beyond
        which, along its rotation, light is blocked.
    iris : str, optional
        Iris preset for what the opening leaves out.
    obstacle : bool
        Whether the shape blocks the light, and all else lets it through.
    distance : float, optional
        Of the plane from the opening, metres.
    fresnel_number : float, optional
        In place of the distance: (width/2)² / (λ distance).
    wavelength : float, optional
        Metres; 550 nm where neither this nor the illuminant is given.
    illuminant : str, optional
        As `aureole.light.illuminant` reads it, for colour; Fresnel numbers are then those of 550 nm.
    spectral : str
        "exact", each wavelength by itself, or "approximate", one pattern scaled (not accurate).
    samples : int, optional
        Wavelengths of the colour.
    shape : tuple of int
        (rows, columns) of the plane's samples.
    extent : float, optional
        Width of the plane, metres; twice the opening's where it is left out.
    centre : tuple of float
        Place of the plane's middle sample as (x, y), metres from the axis, y downward.
    method, finest : str
        As in `aureole.diffraction.near_field`.
    cull : float, optional
        Irradiance below which tiles of the plane may be left dark.
    colour_space : str
        Primaries of the result.
    amplitude : bool
        Whether to keep the complex amplitude, too.
    memory : int, optional
        Most bytes to use; three quarters of what is free otherwise.
    """

    opening: Opening = field(default_factory=Opening)
    iris: str | None = None
    obstacle: bool = False
    distance: float | None = None
    fresnel_number: float | None = None
    wavelength: float | None = None
    illuminant: str | None = None
    spectral: str = "exact"
    samples: int | None = None
    shape: tuple[int, int] = (512, 512)
    extent: float | None = None
    centre: tuple[float, float] = (0.0, 0.0)
    method: str = "auto"
    finest: str = "full"
    cull: float | None = None
    colour_space: str = "rec709"
    amplitude: bool = False
    memory: int | None = None


@dataclass(frozen=True, eq=False)
class NearFieldResult:
    """The light on a plane.

    Parameters
    ----------
    picture : Picture
        Irradiance, 1 where nothing is in the way: three equal channels, or colour in which the light
        itself is white.
    irradiance : ndarray of float32, shape (rows, columns)
        The same as one number; of colour the luminance.
    grid : Grid
        The plane, metres.
    report : dict
        Plain numbers with units in their names.
    description : str
        What it is in words, and a digest that only the same plane of the same job has.
    amplitude : Field, optional
        Where the job asked for it.
    """

    picture: Picture
    irradiance: NDArray[np.float32]
    grid: Grid
    report: dict[str, Any]
    description: str
    amplitude: Field | None = None


@dataclass(frozen=True, eq=False)
class NearSetup:
    """A job whose words have become an aperture and a light: what all its planes share.

    Parameters
    ----------
    job : NearFieldJob
        The job.
    aperture : Aperture
        Its opening, or its obstacle.
    lamp : Spectrum, optional
        The light, for colour.
    wavelength : float
        Metres; of colour the one that Fresnel numbers are told at.
    digest : str
        Another for each other aperture.
    """

    job: NearFieldJob
    aperture: Aperture
    lamp: Spectrum | None
    wavelength: float
    digest: str

    @property
    def has_width(self) -> bool:
        """Whether the opening ends somewhere."""
        return self.job.opening.shape != HALF_PLANE

    def fresnel_number(self, distance: float) -> float:
        """Return (width/2)² / (λ distance), which has no unit."""
        half = self.aperture.width / 2
        return half * half / self.wavelength / distance

    def grid(self, distance: float, zoom: bool = False) -> Grid:
        """Return the plane's samples; it grows with the distance on request, or where nothing has a width."""
        rows, columns = self.job.shape
        extent = WIDTHS * self.aperture.width
        if not self.has_width:
            extent = FRINGES * math.sqrt(self.wavelength * distance)
        if self.job.extent is not None:
            extent = self.job.extent
        if zoom and self.has_width:
            extent += SPREAD * self.wavelength * distance / self.aperture.width
        x, y = self.job.centre
        return Grid((rows, columns), (extent / columns, extent / columns), (y, x))

    def words(self) -> str:
        """Return what stands in the light."""
        return f"{'obstacle' if self.job.obstacle else 'opening'} '{self.aperture.name}'"

    def description(self, grid: Grid, distance: float) -> str:
        """Return words for a plane, and a digest of all that its numbers depend on."""
        shared = replace(
            self.job, opening=Opening(), iris=None, distance=None, fresnel_number=None, memory=None
        )
        digest = hashlib.sha256(repr((shared, self.digest, grid, distance)).encode()).hexdigest()
        return f"near field {units.metres_as_text(distance)} behind {self.words()}, job {digest[:16]}"


@dataclass(frozen=True, eq=False)
class NearPlane:
    """Places for which a setup is ready, at any distance.

    Parameters
    ----------
    setup : NearSetup
        What falls on them, through what.
    grid : Grid
        The places, metres.
    operator : NearOperator
        What of the aperture needs finding only once.
    """

    setup: NearSetup
    grid: Grid
    operator: diffraction.NearOperator


def run_near_field(job: NearFieldJob) -> Iterator[Stage]:
    """Run a near-field job.

    Parameters
    ----------
    job : NearFieldJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `NearFieldResult`.
    """
    if (job.distance is None) == (job.fresnel_number is None):
        both = "both say where the plane is" if job.distance is not None else "are both missing"
        raise refuse.Refusal(f"'distance' and 'fresnel_number' {both}; give one of them.")
    yield Stage(0.0, "aperture")
    setup = set_up(job)
    distance = _distance(setup)
    yield from plane_stages(on_grid(setup, setup.grid(distance)), distance)


def set_up(job: NearFieldJob) -> NearSetup:
    """Check a job's words and make what they mean.

    Parameters
    ----------
    job : NearFieldJob
        Any.

    Returns
    -------
    NearSetup
        Ready for planes at any distance.

    Raises
    ------
    refuse.Refusal
        Where values do not fit, or do not go together.
    """
    rows, columns = (refuse.at_least("size", count, 1) for count in job.shape)
    refuse.one_of("spectral", job.spectral, SPECTRAL)
    refuse.one_of("finest", job.finest, diffraction.FINEST)
    refuse.one_of("colour_space", job.colour_space, light.SPACES)
    if job.extent is not None:
        refuse.positive("extent", job.extent)
    for value in job.centre:
        refuse.finite("centre", value)
    lamp, wavelength = _light(job)
    _refuse_what_clashes(job, lamp)
    _refuse_memory(job, rows, columns)
    aperture = _aperture(job)
    if job.obstacle and aperture.wavefront is not None:
        raise refuse.Refusal("an obstacle has no wavefront; leave out 'obstacle' or the wavefront.")
    return NearSetup(job, aperture, lamp, wavelength, _digest(aperture))


def on_grid(setup: NearSetup, grid: Grid) -> NearPlane:
    """Make a setup ready for places.

    Parameters
    ----------
    setup : NearSetup
        What falls on them, through what.
    grid : Grid
        The places, metres.

    Returns
    -------
    NearPlane
        For any distance.

    Raises
    ------
    refuse.Refusal
        Where the method does not serve the aperture, or the grid does not fit.
    """
    job = setup.job
    endless = job.method == "auto" and not setup.has_width
    method = "polygons" if endless else job.method
    operator = diffraction.NearOperator(setup.aperture, grid, method, finest=job.finest)
    return NearPlane(setup, grid, operator)


def plane_stages(plane: NearPlane, distance: float) -> Iterator[Stage]:
    """Make the light on one plane.

    Parameters
    ----------
    plane : NearPlane
        What falls where, through what.
    distance : float
        Metres.

    Yields
    ------
    Stage
        The last one holds a `NearFieldResult`.
    """
    setup, grid, amplitude = plane.setup, plane.grid, None
    if setup.lamp is None:
        yield Stage(0.1, "near field")
        irradiance, amplitude = _of_one_wavelength(plane, distance)
        shown = Picture(np.repeat(irradiance[..., None], 3, axis=2), setup.job.colour_space)
    else:
        xyz = None
        for stage in _colours(plane, distance, setup.lamp):
            xyz = stage.result
            yield Stage(0.98 * stage.fraction, stage.label)
        assert isinstance(xyz, Picture)
        irradiance = np.ascontiguousarray(xyz.pixels[..., 1])
        shown = light.convert(xyz, setup.job.colour_space)
    report = _report(plane, irradiance, distance)
    words = setup.description(grid, distance)
    yield Stage(1.0, "near field", NearFieldResult(shown, irradiance, grid, report, words, amplitude))


def _light(job: NearFieldJob) -> tuple[Spectrum | None, float]:
    """Return the spectrum, None for one wavelength, and the wavelength that Fresnel numbers are told at."""
    if job.illuminant is None:
        return None, WAVELENGTH if job.wavelength is None else refuse.positive("wavelength", job.wavelength)
    if job.wavelength is not None:
        raise refuse.Refusal("'wavelength' and 'illuminant' both say the light; give one of them.")
    lamp = light.illuminant(job.illuminant)
    if lamp.kind == "lines" and len(lamp.wavelengths) == 1:
        return None, float(lamp.wavelengths[0])
    return lamp, WAVELENGTH


def _refuse_what_clashes(job: NearFieldJob, lamp: Spectrum | None) -> None:
    if lamp is None:
        for name, given in (("samples", job.samples), ("spectral", job.spectral == "approximate")):
            if given:
                raise refuse.Refusal(f"'{name}' is for light of many wavelengths; give 'illuminant', too.")
    else:
        for name, given in (("amplitude", job.amplitude), ("cull", job.cull is not None)):
            if given:
                raise refuse.Refusal(f"'{name}' is for one wavelength; give 'wavelength', no 'illuminant'.")
    for name, given in (("obstacle", job.obstacle), ("amplitude", job.amplitude)):
        if job.cull is not None and given:
            raise refuse.Refusal(f"'cull' does not go with '{name}'; leave out one of them.")


def _refuse_memory(job: NearFieldJob, rows: int, columns: int) -> None:
    """Refuse a plane that would not fit, before any work."""
    needed = BYTES_PER_PIXEL * rows * columns + BYTES_PER_TABLE_ENTRY * (rows + columns) * optics.LARGEST_SIZE
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"a plane of {columns} x {rows} samples needs about {needed / 1e9:.3g} GB of memory, "
            f"{limit / 1e9:.3g} GB are allowed; see --memory and --size."
        )


def _aperture(job: NearFieldJob) -> Aperture:
    opening = job.opening
    if opening.shape is not None:
        refuse.one_of("aperture", opening.shape, SHAPES)
    if opening.shape != HALF_PLANE:
        return opening.at_default_camera(job.iris)
    for part in fields(opening):
        if part.name not in ("shape", "rotation") and getattr(opening, part.name) is not None:
            raise refuse.Refusal(
                f"'{part.name}' does not go with aperture 'half-plane', which is one straight edge."
            )
    if job.method not in EXACT_METHODS or job.finest != "full":
        raise refuse.Refusal("a half plane has no end and so no pixels; use method 'polygons'.")
    return apertures.half_plane(rotation=opening.rotation or 0.0, width=HALF_PLANE_WIDTH)


def _digest(aperture: Aperture) -> str:
    digest = hashlib.sha256(repr(aperture.width).encode())
    for ring in aperture.outlines:
        digest.update(ring.vertices.tobytes() + ring.bulges.tobytes() + repr(ring.transmittance).encode())
    for raster in (aperture.mask, aperture.wavefront):
        digest.update(b"none" if raster is None else raster.tobytes())
    return digest.hexdigest()


def _distance(setup: NearSetup) -> float:
    job = setup.job
    if job.distance is not None:
        return refuse.positive("distance", job.distance)
    if not setup.has_width:
        raise refuse.Refusal("a half plane has no width and so no Fresnel number; give 'distance'.")
    assert job.fresnel_number is not None
    # The formula is its own inverse: λ × distance × number is one constant.
    return setup.fresnel_number(refuse.positive("fresnel_number", job.fresnel_number))


def _of_one_wavelength(plane: NearPlane, distance: float) -> tuple[NDArray[np.float32], Field | None]:
    """Return the irradiance, and the amplitude where the job asks for it."""
    job, wavelength = plane.setup.job, plane.setup.wavelength
    if not job.amplitude:
        return _power(plane, distance, wavelength), None
    values = _amplitude(plane, distance, wavelength)
    return _squared(values), Field(values, plane.grid)


def _power(plane: NearPlane, distance: float, wavelength: float) -> NDArray[np.float32]:
    job = plane.setup.job
    if job.obstacle:
        return _squared(_amplitude(plane, distance, wavelength))
    power = plane.operator.power(distance, wavelength, job.cull)
    return power.astype(np.float32, copy=False)


def _amplitude(plane: NearPlane, distance: float, wavelength: float) -> NDArray[np.complexfloating]:
    """Return D; behind an obstacle 1 − D, since the two add up to the free wave (Babinet)."""
    field = plane.operator.field(distance, wavelength).amplitude
    return np.asarray(1 - field) if plane.setup.job.obstacle else field


def _squared(values: NDArray[np.complexfloating]) -> NDArray[np.float32]:
    return (values.real**2 + values.imag**2).astype(np.float32, copy=False)


def _colours(plane: NearPlane, distance: float, lamp: Spectrum) -> Iterator[Stage]:
    """Make the plane in XYZ."""
    # The operator's aperture has been rasterized already where its method takes pixels.
    job, aperture = plane.setup.job, plane.operator.aperture
    if job.obstacle:
        if aperture.mask is not None:
            yield from _colours_round_pixels(plane, distance, lamp)
            return
        aperture = apertures.obstacle(aperture)
    yield from diffraction.near_picture_stages(
        aperture,
        plane.grid,
        distance,
        lamp,
        job.spectral,
        job.samples,
        field_method=plane.operator.method,
    )


def _colours_round_pixels(plane: NearPlane, distance: float, lamp: Spectrum) -> Iterator[Stage]:
    """Make the plane in XYZ for an obstacle of pixels, from the amplitude of each wavelength."""
    job = plane.setup.job
    if job.spectral == "approximate":
        raise refuse.Refusal("spectral 'approximate' does not serve an obstacle of pixels; use 'exact'.")
    samples = job.samples or wavelengths_needed(plane.setup.aperture, plane.grid, distance, WAVELENGTH)
    wavelengths, weights = light.quadrature(lamp, samples)
    total = np.zeros((*plane.grid.shape, 3), dtype=np.float32)
    for index, (wavelength, weight) in enumerate(zip(wavelengths, weights, strict=True)):
        yield Stage(index / len(wavelengths), f"near field at {wavelength * 1e9:.0f} nm")
        total += _power(plane, distance, float(wavelength))[..., None] * weight.astype(np.float32)
    yield Stage(1.0, "near field", light.in_white_of(lamp, total))


def _report(plane: NearPlane, irradiance: NDArray[np.float32], distance: float) -> dict[str, Any]:
    """Return the plain numbers of a plane."""
    setup, grid = plane.setup, plane.grid
    report = shared_report(plane)
    report["distance_m"] = distance
    if setup.has_width:
        report["fresnel_number"] = setup.fresnel_number(distance)
    report["largest_irradiance"] = float(irradiance.max())
    report["mean_irradiance"] = float(irradiance.mean(dtype=np.float64))
    axis = _axis(grid)
    if axis is not None:
        report["irradiance_on_axis"] = float(irradiance[axis])
    if setup.has_width and not setup.job.obstacle:
        through = float(irradiance.sum(dtype=np.float64)) * grid.spacing[0] * grid.spacing[1]
        report["energy_through_plane"] = through / apertures.energy(setup.aperture)
    report["finest_fringe_pixels"] = _finest_fringe(setup, grid, distance) / grid.spacing[1]
    return report


def shared_report(plane: NearPlane) -> dict[str, Any]:
    """Return the plain numbers that do not depend on the distance.

    Parameters
    ----------
    plane : NearPlane
        Any.

    Returns
    -------
    dict
        Units in the names.
    """
    setup, (rows, columns), (step_y, step_x) = plane.setup, plane.grid.shape, plane.grid.spacing
    x, y = setup.job.centre
    report: dict[str, Any] = {"aperture": setup.aperture.name, "obstacle": setup.job.obstacle}
    if setup.has_width:
        report["aperture_width_m"] = setup.aperture.width
    report |= {
        "plane_m": [columns * step_x, rows * step_y],
        "plane_centre_x_m": x,
        "plane_centre_y_m": y,
        "size": [columns, rows],
    }
    if setup.lamp is None:
        report["wavelength_m"] = setup.wavelength
    else:
        report |= {"illuminant": setup.lamp.name, "spectral": setup.job.spectral}
    return report | {"method": plane.operator.method}


def _axis(grid: Grid) -> tuple[int, int] | None:
    """Return the sample that lies on the axis, if one does."""
    found = []
    for count, step, centre in zip(grid.shape, grid.spacing, grid.centre, strict=True):
        place = count // 2 - centre / step
        if abs(place - round(place)) > 1e-6 or not 0 <= round(place) < count:
            return None
        found.append(round(place))
    return found[0], found[1]


def _finest_fringe(setup: NearSetup, grid: Grid, distance: float) -> float:
    """Return λz over the longest way between two sources that interfere at one place of the plane.

    Behind an opening these are two places of its edge. The free wave round an obstacle seems to come
    from straight ahead.
    """
    reach = setup.aperture.width
    if setup.job.obstacle or not setup.has_width:
        corner = max(float(np.abs(axis).max()) for axis in grid.axes())
        reach = corner + (reach / 2 if setup.has_width else 0.0)
    return setup.wavelength * distance / reach
