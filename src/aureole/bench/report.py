"""What a bench finds: tables of plain rows, with the words to print them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Column:
    """One printed column.

    Parameters
    ----------
    head : str
        Over the column.
    form : str
        Format of a cell, with the row's keys in braces: "{median_ms:.1f} ms".
    words : bool
        Whether cells are words, which stand on the left; numbers stand on the right.
    """

    head: str
    form: str
    words: bool = False

    def cell(self, row: Mapping[str, Any]) -> str:
        """Return a row's cell; empty where the row has no such value.

        Parameters
        ----------
        row : mapping
            Plain values.

        Returns
        -------
        str
            Text of the cell.
        """
        try:
            return self.form.format(**row)
        except (KeyError, TypeError):
            return ""


@dataclass(frozen=True, eq=False)
class Table:
    """One table.

    Parameters
    ----------
    name : str
        Short name, as in `--only`.
    title : str
        What it shows.
    columns : tuple of Column
        What is printed of each row.
    rows : tuple of dict
        Plain values, units in their names.
    notes : tuple of str
        How it was measured and what is printed in the source.
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[dict[str, Any], ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Report:
    """All that a bench found.

    Parameters
    ----------
    bench : str
        Its name.
    environment : dict
        Machine, versions, threads.
    settings : dict
        What was asked for.
    tables : tuple of Table
        In the order they were measured.
    """

    bench: str
    environment: dict[str, Any]
    settings: dict[str, Any]
    tables: tuple[Table, ...]


def plain(report: Report) -> dict[str, Any]:
    """Return a report as plain values, for JSON.

    Parameters
    ----------
    report : Report
        What a bench found.

    Returns
    -------
    dict
        bench, environment, settings and tables; None for what is infinite, which JSON cannot say.
    """
    tables = [
        {
            "name": each.name,
            "title": each.title,
            "notes": list(each.notes),
            "rows": [_finite(row) for row in each.rows],
        }
        for each in report.tables
    ]
    return {
        "bench": report.bench,
        "environment": report.environment,
        "settings": report.settings,
        "tables": tables,
    }


def _finite(row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in row.items()
    }
