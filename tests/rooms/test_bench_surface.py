"""The bench of surfaces: what it compares is right, and what it prints is plain."""

import json

import pytest

from aureole import bench, refuse
from aureole.bench import surface_measured, surface_orders, surface_tables
from aureole.cli.main import run


def rows_of(stages):
    """Follow a part of the bench; return the rows of its only table."""
    every = list(stages)
    assert [stage.fraction for stage in every] == sorted(stage.fraction for stage in every)
    (table,) = every[-1].result
    return table.rows


def test_tables_are_compared_with_the_direct_sum():
    rows = []
    fractions = [stage.fraction for stage in surface_tables.compared(64, 40, 12, 1, rows)]
    assert fractions == sorted(fractions)
    cell, point = rows
    assert cell["way"] == "cell"
    assert 0 < cell["error"] < 1e-6
    assert 0 < point["error"] < 1e-6
    assert point["ratio"] == pytest.approx(point["direct_ms"] / point["busy_ms"])
    assert "printed" not in point


def test_a_whole_table_of_the_papers_size_takes_less_than_400_megabytes():
    """Section 4.3: 2048 × 2048 from 1000 × 1000; Python, NumPy and a compiler are part of it."""
    assert 100 < surface_tables.memory(2048, 1000, 81, "cell") < 400


def test_first_orders_stand_where_the_grating_equation_says():
    """Discs have 1.6, 0.74 and 0.32 micrometres from track to track."""
    rows = {
        (row["grating"], row["wavelength_nm"], row["incidence_deg"]): row
        for row in rows_of(surface_orders.orders(700))
    }
    for nanometres, angle in {380: 13.74, 532: 19.42, 650: 23.97, 780: 29.18}.items():
        assert rows["cd", nanometres, 0]["angle_deg"] == pytest.approx(angle, abs=0.005)
        assert "angle_deg" not in rows["bluray", nanometres, 0]
    found = [row["apart_deg"] for row in rows.values() if "apart_deg" in row]
    assert len(found) == 8 + 7 + 1
    assert max(found) < 0.05


def test_a_measured_screen_is_the_screen():
    made = surface_measured.Screen(200, 512)
    said = made.judged(made.photographed(0))
    assert said["luminance"] < 0.01
    assert said["colour"] < 0.5
    assert said["centre_px"] < 0.2


def test_names_and_numbers_are_checked(capsys):
    assert run(["bench", "surface", "--quick", "--only", "orders", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert [table["name"] for table in said["tables"]] == ["orders"]
    with pytest.raises(refuse.Refusal, match="only"):
        bench.run_surface(bench.SurfaceBench(only=("table-1",)))
    with pytest.raises(refuse.Refusal, match="runs"):
        bench.run_surface(bench.SurfaceBench(runs=0))
