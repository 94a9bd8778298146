"""The near field of a mask by every library: time and error in one run."""

from collections.abc import Callable, Generator, Iterator
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction
from aureole.bench import peer_diffractsim, peer_lightpipes, peer_scipy, shapes
from aureole.bench.optics import Irradiance, Plane
from aureole.bench.peer_ways import working
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Grid, Stage

PEERS = (peer_scipy, peer_diffractsim, peer_lightpipes)
OURS, CENTRED, AMPLITUDE = "Aureole", "Aureole, a place on the axis", "Aureole, and the amplitude"
FRESNEL_NUMBERS = (30, 100, 200)
# So large that the Fresnel approximation holds to 1e-4 at every distance here, which is fair to those
# that do not make it.
WIDTH, WAVELENGTH = 0.2, 550e-9
COLUMNS = (
    Column("irradiance on the plane", "{way}", words=True),
    *(
        column
        for number in FRESNEL_NUMBERS
        for column in (
            Column(f"{number}, ms", f"{{ms_{number}:.0f}} ({{ratio_{number}:.1f}}x)"),
            Column("error", f"{{error_{number}:.0e}}"),
        )
    ),
)
NOTES = (
    "A heptagon across half of the mask, and as many places on the plane behind it, as far apart, at three "
    "Fresnel numbers of the opening. Medians, and times the first row's in brackets. error: root mean square "
    "difference of the irradiance from direct sums in float64 over the mask's square pixels, of its mean, at "
    "each library's own places.",
    "The others take pixels for samples and have their places at the pixels' middles; so has Aureole's first "
    "row. SciPy convolves in complex64 in a frame of zeros twice as wide; diffractsim and LightPipes as they "
    "come, without a frame.",
)


def near_peers(size: int, runs: int, peers: list[ModuleType]) -> Iterator[Stage]:
    """Time every way at three distances.

    Parameters
    ----------
    size : int
        Pixels of the mask and places on the plane on each side.
    runs : int
        How often each is timed.
    peers : list of module
        Whom to compare with.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    plane = Plane(shapes.mask("heptagon", size), WIDTH, WAVELENGTH)
    rows: dict[str, dict[str, Any]] = {}
    said: list[str] = []
    yield Stage(0.0, "peers")
    first = plane.distance(FRESNEL_NUMBERS[0])
    ways = own_ways(plane) | {
        way: at for way, at, _ in working(peers, lambda peer: peer.near_ways(plane), first, said)
    }
    for index, number in enumerate(FRESNEL_NUMBERS):
        for stage in _distance(plane, number, runs, ways, rows):
            yield Stage((index + stage.fraction) / len(FRESNEL_NUMBERS), stage.label)
    title = f"Near field of a {size}² mask, {size}² places, at Fresnel numbers 30, 100 and 200"
    yield Stage(1.0, "peers", (Table("peers", title, COLUMNS, tuple(rows.values()), (*NOTES, *said)),))


def own_ways(plane: Plane) -> dict[str, Irradiance]:
    """Return our ways to the irradiance.

    Parameters
    ----------
    plane : Plane
        Mask and wavelength.

    Returns
    -------
    dict
        Name to a function of the distance: at the others' places, with a place on the axis, and at the
        others' places by way of the stored amplitude.
    """
    aperture, wavelength = plane.aperture, plane.wavelength

    def by_amplitude(distance: float) -> NDArray[np.floating]:
        field = diffraction.near_field(aperture, plane.grid, distance, wavelength).amplitude
        return np.asarray(field.real**2 + field.imag**2)

    return {
        OURS: lambda z: diffraction.near_power(aperture, plane.grid, z, wavelength),
        CENTRED: lambda z: diffraction.near_power(aperture, plane.centred, z, wavelength),
        AMPLITUDE: by_amplitude,
    }


def _distance(
    plane: Plane, number: int, runs: int, ways: dict[str, Irradiance], rows: dict[str, dict[str, Any]]
) -> Generator[Stage, None, None]:
    """Time one distance by every way and put what is found into the ways' rows."""
    distance = plane.distance(number)
    yield Stage(0.0, f"Fresnel number {number}, reference")
    truths = {grid: _truth(plane, grid, distance) for grid in {plane.grid, plane.centred}}
    tasks: dict[str, Callable[[], NDArray[Any]]] = {way: _at(at, distance) for way, at in ways.items()}
    times = yield from alternate(tasks, runs, label=f"Fresnel number {number},")
    for way, spent in times.items():
        row = rows.setdefault(way, {"way": way})
        row[f"ms_{number}"], row[f"ratio_{number}"] = spent, spent / times[OURS]
        truth = truths[plane.centred if way == CENTRED else plane.grid]
        difference = np.abs(tasks[way]().astype(np.float64) - truth)
        row[f"error_{number}"] = float(np.sqrt(np.mean(difference**2)) / truth.mean())
        row[f"largest_{number}"] = float(difference.max() / truth.mean())


def _truth(plane: Plane, grid: Grid, distance: float) -> NDArray[np.float64]:
    found: NDArray[np.float64] = diffraction.near_power(
        plane.aperture, grid, distance, plane.wavelength, "reference"
    )
    return found


def _at(at: Irradiance, distance: float) -> Callable[[], NDArray[Any]]:
    return lambda: at(distance)
