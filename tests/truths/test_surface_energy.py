"""What a table sends back: closed forms, brute force in angles, the bound of one, reciprocity."""

import json

import numpy as np
import pytest

from aureole import light, surface
from aureole.refuse import Refusal
from aureole.surface.table import axes, cells, energy

LINE = light.line(550e-9)


def spot(width, offset=(0.0, 0.0), level=1.0):
    """Return S whose 4π² times integral over h is `level`."""

    def function(h_t, h_b, wavelength):
        squared = (h_t - offset[0]) ** 2 + (h_b - offset[1]) ** 2
        return level * np.exp(-squared / (2 * width**2)) / (2 * np.pi * width**2) / (4 * np.pi**2)

    return function


def table_of(function, size=301, warp=3, spectrum=LINE):
    return surface.table_from_function(function, spectrum, size, warp=warp, sample="point")


def by_angles(table, incidence, count=450):
    """Integrate f_r cos θ over the hemisphere in θ and φ by midpoints."""
    theta = (np.arange(count) + 0.5) * 0.5 * np.pi / count
    phi = (np.arange(2 * count) + 0.5) * np.pi / count
    sine = np.sin(theta)[:, None]
    found = surface.lookup(
        table, incidence[0] + sine * np.cos(phi)[None, :], incidence[1] + sine * np.sin(phi)[None, :]
    )[..., 1]
    weight = 4 * np.pi**2 * (np.sin(theta) * np.cos(theta))[:, None] * (0.5 * np.pi / count) * (np.pi / count)
    return float((found * weight).sum())


@pytest.mark.parametrize("warp", [1, 3, 5])
@pytest.mark.parametrize("size", [300, 301])
def test_a_mirror_like_spot_sends_back_its_integral(warp, size):
    table = table_of(spot(0.1), size, warp)
    assert energy(table)[1] * 4 * np.pi**2 == pytest.approx(1.0, rel=1e-3)
    # From any direction well above the horizon the whole lobe is above the horizon, too.
    assert surface.albedo(table, [[0.0, 0.0], [0.3, -0.4]])[:, 1] == pytest.approx([1.0, 1.0], rel=1e-3)


def test_a_constant_sends_back_the_disc():
    # S = 1/(4π³) is a white diffuser: f_r = 1/π and albedo 1; seen from the rim as well.
    table = table_of(lambda t, b, w: np.full(np.broadcast(t, b).shape, 1 / (4 * np.pi**3)), 400, 1)
    found = surface.albedo(table, [[0.0, 0.0], [1.0, 0.0], [0.0, -0.7]])[:, 1]
    assert found == pytest.approx(np.ones(3), rel=2e-3)


@pytest.mark.parametrize("incidence", [(0.0, 0.0), (0.6, 0.2), (-0.5, 0.8)])
def test_direction_cosines_give_what_angles_give(incidence):
    table = table_of(spot(0.4, (0.3, -0.5)), 401, 3)
    assert surface.albedo(table, incidence)[1] == pytest.approx(by_angles(table, incidence), rel=2e-3)


def test_orders_below_the_horizon_send_nothing_back():
    table = table_of(spot(0.05, (1.5, 0.0)), 401, 1)
    found = surface.albedo(table, [[0.0, 0.0], [-0.9, 0.0], [0.9, 0.0]])[:, 1]
    # The order lies at s_o = h − s_i: 1.5, 2.4 and 0.6.
    assert found == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)


def test_normalised_tables_send_back_no_more_than_came_at_any_incidence():
    orders = [spot(0.02, (t, b), 0.4) for t in (-0.9, 0.0, 0.9) for b in (-1.2, 0.0, 1.2)]
    table = table_of(lambda t, b, w: sum(order(t, b, w) for order in orders), 301)
    rng = np.random.default_rng(1)
    radius, angle = np.sqrt(rng.random(100)), 2 * np.pi * rng.random(100)
    incidences = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    before, bound = surface.albedo(table, incidences), surface.albedo_bound(table)
    assert before.max() > 1.0
    assert before.max() <= bound
    settled = surface.normalised(table)
    assert surface.albedo(settled, incidences).max() <= 1.0
    assert settled.metadata["normalised_by"] == pytest.approx(bound)
    # Once is enough, and what sends back less is left alone.
    assert np.array_equal(surface.normalised(settled).values, settled.values)
    assert surface.normalised(settled).metadata["normalised_by"] == 1.0


@pytest.mark.parametrize(("warp", "reach"), [(1, 2.0), (5, 2.0), (3, 1.3)])
def test_the_bound_is_close(warp, reach):
    """A perfect diffuser sends back all light: the bound may be above that by the discs' widening alone."""
    table = surface.scatter_table(np.full((401, 400, 3), 1 / (4 * np.pi**3)), [1.0, 1.0, 1.0], reach, warp)
    most = surface.albedo(table)[1]
    assert most <= surface.albedo_bound(table) <= 1.015 * most


def test_fresnels_factor_counts_squared():
    """Under the normal the half vector is at half the angle of the eye: ∫ F(cos θ/2)² 2r dr of a diffuser."""
    table = surface.scatter_table(np.full((400, 401, 3), 1 / (4 * np.pi**3)), [1.0, 1.0, 1.0], warp=1)
    r = (np.arange(2000) + 0.5) / 2000
    cosine = np.sqrt(0.5 * (1 + np.sqrt(1 - r**2)))
    for factors in (surface.schlick(0.04), surface.conductor([0.2, 0.9, 1.1], [3.4, 2.3, 2.0])):
        wanted = [(np.interp(cosine, np.linspace(0, 1, 1025), one) ** 2 * 2 * r).mean() for one in factors.T]
        found = surface.albedo(table, fresnel=factors)
        colours = light.from_xyz(found, "rec709", table.white)
        assert colours == pytest.approx(wanted, rel=2e-3)
    half = surface.albedo(table, [[0.6, 0.0], [0.0, 0.0]], np.full(5, 0.5))
    assert half == pytest.approx(0.25 * surface.albedo(table, [[0.6, 0.0], [0.0, 0.0]]), rel=1e-5)


def test_a_report_holds_the_albedo_and_the_energy():
    table = table_of(spot(0.1, level=0.7), 121)
    said = surface.describe(table)
    assert said["energy"][1] == pytest.approx(0.7, rel=1e-3)
    assert list(said["albedo"].values()) == pytest.approx(
        surface.albedo(table, [[0.0, 0.0], [0.5, 0.0], [np.sqrt(0.75), 0.0]])[:, 1].tolist()
    )
    assert said["albedo"]["60_deg"] < said["albedo"]["0_deg"] <= said["albedo_bound"] <= 0.71
    assert (said["rows"], said["warp"], said["illuminant"], said["zero_order"]) == (
        121,
        3,
        "550 nm",
        "keep",
    )
    assert "normalised_by" not in said
    assert surface.describe(surface.normalised(table))["normalised_by"] == 1.0
    json.dumps(said, allow_nan=False)


@pytest.mark.parametrize("fresnel", [1.0, [0.5], np.ones((4, 2)), [1.0, -0.1], [np.nan, 1.0]])
def test_fresnel_factors_that_are_refused(fresnel):
    with pytest.raises(Refusal, match="'fresnel'"):
        surface.albedo(surface.scatter_table(np.ones((4, 4, 3)), [1.0, 1.0, 1.0]), fresnel=fresnel)


def test_the_albedo_is_relative_to_the_light():
    for name in ("A", "D65", "E"):
        table = table_of(spot(0.1, level=0.5), 121, spectrum=light.illuminant(name))
        assert surface.albedo(table) == pytest.approx([0.5, 0.5, 0.5], rel=1e-3)
        neutral = surface.rgb(table)[60, 60]
        assert neutral == pytest.approx(np.full(3, neutral[1]), rel=1e-4)


def test_light_and_eye_exchanged_read_the_same_value():
    rng = np.random.default_rng(2)
    table = surface.scatter_table(rng.random((40, 41, 3)), [1.0, 1.0, 1.0])
    to_light, to_eye = rng.uniform(-0.7, 0.7, (2, 500, 2))
    there = surface.lookup(table, to_light[:, 0] + to_eye[:, 0], to_light[:, 1] + to_eye[:, 1])
    back = surface.lookup(table, to_eye[:, 0] + to_light[:, 0], to_eye[:, 1] + to_light[:, 1])
    assert np.array_equal(there, back)


@pytest.mark.parametrize("warp", [1, 3, 5])
@pytest.mark.parametrize("shape", [(8, 8), (9, 12)])
def test_look_ups_give_the_samples_and_straight_lines_between_them(warp, shape):
    rng = np.random.default_rng(3)
    table = surface.scatter_table(rng.random((*shape, 3)), [1.0, 1.0, 1.0], 1.5, warp)
    h_b, h_t = axes(table)
    found = surface.lookup(table, h_t[None, :], h_b[:, None])
    assert np.allclose(found, table.values, atol=1e-6)
    # Half-way in u, which is where cells end, lies the mean of two neighbours.
    between = cells(shape[1], 1.5, warp)[1][:-1]
    means = 0.5 * (table.values[:, 1:] + table.values[:, :-1])
    assert np.allclose(surface.lookup(table, between[None, :], h_b[:, None]), means, atol=1e-6)
    assert not surface.lookup(table, [1.51, 0.0, -9.0], [0.0, -1.51, 9.0]).any()


@pytest.mark.parametrize("incidence", [[0.9, 0.9], [np.nan, 0.0], [0.1, 0.1, 0.9]])
def test_directions_below_the_surface_are_refused(incidence):
    table = surface.scatter_table(np.ones((4, 4, 3)), [1.0, 1.0, 1.0])
    with pytest.raises(Refusal, match="'incidence' must"):
        surface.albedo(table, incidence)
