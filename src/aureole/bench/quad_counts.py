"""Table 1 of the quad paper: how many quads an aperture takes, and how their number grows."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.records import Stage

SIZES = (256, 512, 1024, 2048, 4096)
# Table 1, as printed.
PRINTED = {
    "box": (40, 40, 40, 617, 617),
    "circle": (109, 227, 440, 981, 1976),
    "heptagon": (176, 389, 730, 1613, 2996),
    "whirl": (303, 647, 1358, 2673, 5278),
}
COLUMNS = (
    Column("aperture", "{aperture}", words=True),
    Column("size", "{size}²"),
    Column("quads", "{quads}"),
    Column("printed", "{printed}"),
    Column("growth", "{growth:.2f}x"),
    Column("printed growth", "{printed_growth:.2f}x"),
    Column("repainted", "{repainted}"),
)
NOTES = (
    "Black and white masks in a window of which each aperture takes half; the tree starts at half the size, "
    "as the paper's does. The paper does not print the apertures' sizes, so growth is what should agree.",
    "repainted: whether painting the signed quads gives back every pixel of the mask.",
)


def count_quads(name: str, size: int) -> tuple[int, bool]:
    """Count the quads of an aperture at one size, and paint them again.

    Parameters
    ----------
    name : str
        box, circle, heptagon or whirl.
    size : int
        Pixels on each side; the tree starts at half of them.

    Returns
    -------
    tuple of int and bool
        The number of quads, and whether painting them gives back the mask exactly.
    """
    mask = shapes.mask(name, size // 2) >= 0.5
    quads = diffraction.quadtree(mask, 1.0)
    return len(quads), bool(np.array_equal(diffraction.paint(quads, size // 2, 1.0), mask))


def table_1(sizes: Sequence[int]) -> Iterator[Stage]:
    """Count quads at every size.

    Parameters
    ----------
    sizes : sequence of int
        Pixels on each side, each twice the one before.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    total = len(PRINTED) * len(sizes)
    for name in PRINTED:
        before: int | None = None
        for size in sizes:
            yield Stage(len(rows) / total, f"quads of the {name}, {size}²")
            found, repainted = count_quads(name, size)
            row: dict[str, Any] = {"aperture": name, "size": size, "quads": found, "repainted": repainted}
            if before is not None:
                row["growth"] = found / before
            rows.append(row | _printed(name, size))
            before = found
    table = Table("table-1", "Table 1: number of quads", COLUMNS, tuple(rows), NOTES)
    yield Stage(1.0, "quads", (table,))


def _printed(name: str, size: int) -> dict[str, Any]:
    """Return what the paper prints, where it has that size."""
    if size not in SIZES:
        return {}
    index = SIZES.index(size)
    row: dict[str, Any] = {"printed": PRINTED[name][index]}
    if index:
        row["printed_growth"] = PRINTED[name][index] / PRINTED[name][index - 1]
    return row
