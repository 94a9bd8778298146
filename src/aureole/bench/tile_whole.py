"""Whole pictures of ghosts by `aureole.flare.render` as it comes: time, and distance from fine grids."""

from collections.abc import Generator, Iterator, Sequence
from typing import Any

from aureole import flare
from aureole.bench.report import Column, Table
from aureole.bench.tile_measures import exposed_psnr
from aureole.bench.tile_systems import PLACES, System
from aureole.bench.timing import alternate, within
from aureole.records import Picture, Stage

WAVELENGTHS = 3
# Which ghosts, and whether colours between the traced wavelengths are drawn.
WAYS = (("paper", "flat"), ("same-side", "flat"), ("same-side", "blended"))
COLUMNS = (
    Column("lens", "{system}", words=True),
    Column("f/", "{f_number:g}"),
    Column("ghosts", "{ghosts}", words=True),
    Column("colours", "{blend}", words=True),
    Column("time", "{seconds:.2f} s"),
    Column("PSNR", "{psnr:.1f} dB"),
    Column("unclipped", "{open_psnr:.1f} dB"),
)


def whole(systems: Sequence[System], shape: tuple[int, int], base: int, runs: int) -> Iterator[Stage]:
    """Time whole pictures of one light and compare each with the same from grids of base² rays, unmerged.

    Parameters
    ----------
    systems : sequence of System
        The lenses.
    shape : tuple of int
        Rows and columns.
    base : int
        Rays along each side of the fine grids.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    cases = [(system, ghosts, blend) for system in systems for ghosts, blend in WAYS]
    for index, (system, ghosts, blend) in enumerate(cases):
        for stage in _case(system, ghosts, blend, shape, base, runs, rows):
            yield Stage((index + stage.fraction) / len(cases), stage.label)
    note = (
        f"One light, {WAVELENGTHS} wavelengths, the rest as it comes, compiled before. PSNR to the same "
        f"picture from grids of {base}² rays a ghost, unmerged, exposed as in Table 3. flat: a colour a "
        "wavelength, as the paper has it; blended: bands of colour between them."
    )
    title = f"Whole pictures, {shape[1]} x {shape[0]}"
    yield Stage(1.0, "whole pictures", (Table("whole", title, COLUMNS, tuple(rows), (note,)),))


def _case(
    system: System,
    ghosts: str,
    blend: str,
    shape: tuple[int, int],
    base: int,
    runs: int,
    rows: list[dict[str, Any]],
) -> Generator[Stage, None, None]:
    lens = flare.load(system.lens)
    source = flare.light_on_picture(lens, (PLACES[0][0] * shape[1], PLACES[0][1] * shape[0]), shape)
    label = f"{system.label}, {ghosts}, {blend}"

    def render(**options: Any) -> Picture:
        return flare.render(
            lens,
            source,
            shape,
            ghosts=ghosts,
            f_number=system.f_number,
            wavelengths=WAVELENGTHS,
            blend=blend,
            **options,
        )

    times = yield from within(alternate({label: render}, runs), 0.0, 0.8)
    yield Stage(0.8, f"{label}, fine grids")
    truth = render(grid=base, adapt="bounds", merge="none", method="reference")
    clipped, unclipped = exposed_psnr(render().pixels, truth.pixels)
    rows.append(
        {
            "system": system.label,
            "f_number": system.f_number,
            "ghosts": ghosts,
            "blend": blend,
            "seconds": 1e-3 * times[label],
            "psnr": clipped,
            "open_psnr": unclipped,
        }
    )
