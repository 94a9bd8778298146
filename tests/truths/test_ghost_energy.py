"""Energies of ghosts: plates and discs in closed form, lenses by random rays, none from blocked rays."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from aureole import flare, light
from aureole.flare import coating, energy, ghost_paths, pupil, random_rays, rays, tracing
from aureole.flare.ghost_paths import GhostPath
from aureole.flare.prescription import Lens, Surface
from aureole.records import Light

GREEN = 550e-9
load = cache(flare.load)


def towards(x_degrees, y_degrees=0.0):
    """Return the unit vector to a light so many degrees right and down."""
    found = np.array([np.tan(np.radians(x_degrees)), np.tan(np.radians(y_degrees)), 1.0])
    return tuple(found / np.linalg.norm(found))


def plate(index=1.5, stop=0.004):
    """Return a plate of glass with wide rims before a stop that alone limits the light."""
    surfaces = (
        Surface(0.0, 0.005, 0.05, flare.glass.of_numbers(index)),
        Surface(0.0, 0.002, 0.05),
        Surface(0.0, 0.03, stop, stop=True),
    )
    return Lens("plate", "Plate", 0.1, 4.0, (0.036, 0.024), surfaces)


def disc_sheet(radius, cells, **changed):
    """Return a sheet over [-1, 1]² whose rays are inside a circle, and weigh 1 + x/4."""
    y, x = np.mgrid[-1 : 1 : (cells + 1) * 1j, -1 : 1 : (cells + 1) * 1j].astype(np.float32)[:, None]
    level, zero = np.hypot(x, y) / np.float32(radius), np.zeros_like(x)
    given = {"x": x, "y": y, "weight": 1 + x / 4, "level": level, "stop_x": zero, "stop_y": zero}
    given |= {"reached": np.ones(x.shape, dtype=bool)} | changed
    return pupil.Sheet(
        path=(1, 0), rectangle=pupil.Rectangle(-1.0, -1.0, 1.0, 1.0), cell=(2.0 / cells) ** 2, **given
    )


def test_a_disc_holds_pi_r_squared():
    for radius in (0.45, 0.71, 0.95):
        assert energy.sheet_energy(disc_sheet(radius, 64))[0] == pytest.approx(np.pi * radius**2, rel=1e-3)


def test_the_error_of_an_edge_falls_with_the_cell_squared():
    wrong = [abs(energy.sheet_energy(disc_sheet(0.71, n))[0] / (np.pi * 0.71**2) - 1) for n in (16, 64)]
    assert wrong[1] < wrong[0] / 8


def test_the_iris_cuts_as_a_rim_does():
    y, x = np.mgrid[-1:1:65j, -1:1:65j].astype(np.float32)[:, None] / np.float32(0.6)
    by_iris = disc_sheet(5.0, 64, stop_x=x, stop_y=y)
    assert energy.sheet_energy(by_iris) == pytest.approx(energy.sheet_energy(disc_sheet(0.6, 64)), rel=1e-6)


def test_the_frame_cuts_straight():
    """Half planes through a disc: segments of known area, weighed by 1 + x/4."""
    whole = energy.sheet_energy(disc_sheet(0.8, 128), (10.0, 10.0))[0]
    inside = energy.sheet_energy(disc_sheet(0.8, 128), (10.0, 0.8))[0]
    half = 0.4
    expected = 2 * (half * np.sqrt(0.8**2 - half**2) + 0.8**2 * np.arcsin(half / 0.8))
    assert whole == pytest.approx(np.pi * 0.8**2, rel=1e-3)
    assert inside == pytest.approx(expected, rel=1e-3)


def test_rays_that_never_arrive_carry_nothing():
    """Half of the rays lost: the edge is half a cell beyond the last that arrived."""
    reached = np.ones((1, 65, 65), dtype=bool)
    reached[..., 33:] = False
    found = energy.sheet_energy(disc_sheet(5.0, 64, reached=reached, weight=np.ones((1, 65, 65))))
    assert found[0] == pytest.approx(2 * (1 + 0.5 / 32), rel=5e-3)
    assert energy.sheet_energy(disc_sheet(5.0, 64, reached=np.zeros((1, 65, 65), dtype=bool)))[0] == 0


@pytest.mark.parametrize("angle", [0.0, 25.0])
def test_a_plates_ghost_has_its_closed_form(angle):
    """Two plane faces: T R R T of the stop's area seen at the angle; four reflections: T R⁴ T."""
    lens, direction = plate(), towards(angle)
    cosine = np.cos(np.radians(angle))
    back, on = coating.reflectance((), flare.AIR, lens.surfaces[0].glass, cosine, GREEN)
    stop = np.pi * lens.surfaces[-1].semi_aperture ** 2 * cosine
    for path, part in (((), 1.0), ((1, 0), back**2), ((1, 0, 1, 0), back**4)):
        expected = stop * on**2 * part
        found = energy.ghost_powers(lens, [GhostPath(path)], direction, GREEN)[0, 0]
        assert found == pytest.approx(expected, rel=2e-3)
        sampled = random_rays.monte_carlo(lens, path, direction, GREEN, rays=200_000)
        assert abs(sampled.energy[0] - expected) < 5 * sampled.error[0] < 0.05 * expected


def test_the_standard_error_is_honest():
    """Over many seeds the scatter is no more than the stated error, and not far below it."""
    lens, direction = plate(), towards(10.0)
    found = [
        random_rays.monte_carlo(lens, (1, 0), direction, GREEN, rays=4000, seed=seed) for seed in range(40)
    ]
    scatter = np.std([one.energy[0] for one in found], ddof=1)
    stated = np.mean([one.error[0] for one in found])
    assert 0.5 * stated < scatter < 1.3 * stated


@pytest.mark.parametrize(
    ("name", "pairs"),
    [
        ("heliar_tronnier_100mm", ["5-7", "3-4", "1-9"]),
        ("zeiss_biotar_50mm", ["7-9", "3-7"]),
        ("schneider_anamorphic_31mm", ["8-11"]),
    ],
)
def test_sheets_hold_what_random_rays_bring(name, pairs):
    lens, direction = load(name), towards(7.0, 3.0)
    for pair in pairs:
        path = ghost_paths.path_named(lens, pair)
        sampled = random_rays.monte_carlo(lens, path, direction, GREEN, rays=200_000)
        for within, truth, error in (
            ("plane", sampled.energy[0], sampled.error[0]),
            ("frame", sampled.in_frame[0], sampled.in_frame_error[0]),
        ):
            found = energy.ghost_powers(lens, [path], direction, GREEN, base=128, within=within)[0, 0]
            assert truth > 0
            assert abs(found - truth) < 4 * error + 0.005 * truth


@pytest.mark.parametrize("f_number", [None, 8.0])
def test_both_tracers_bring_the_same(f_number):
    """The same rays through the fast tracer and the slow one."""
    lens, direction = load("heliar_tronnier_100mm"), towards(5.0, -6.0)
    both = [
        random_rays.monte_carlo(
            lens, (6, 2), direction, [450e-9, 620e-9], 10_000, 3, f_number, (24, 36), method
        )
        for method in random_rays.METHODS
    ]
    assert np.abs(both[0].hits - both[1].hits).max() <= 2
    np.testing.assert_allclose(both[0].energy, both[1].energy, rtol=2e-3)
    np.testing.assert_allclose(both[0].in_frame, both[1].in_frame, rtol=5e-3)
    for one in both:
        np.testing.assert_allclose(one.picture.sum(axis=(1, 2)), one.in_frame, rtol=1e-5)


def test_no_energy_comes_from_rays_outside_a_semi_aperture():
    """Each ray that counts crosses every surface inside its rim, measured on the points themselves."""
    lens, direction = load("zeiss_biotar_50mm"), towards(9.0)
    chance = np.random.default_rng(1)
    low, high = random_rays.front(lens, direction)
    points = low + chance.random((4000, 2)) * (high - low)
    rims = np.array([surface.semi_aperture for surface in lens.surfaces])
    prepared = tracing.prepare(lens, np.array([GREEN]))
    origins = np.column_stack([points, np.zeros(len(points))])
    heading = tracing.travel(direction)
    for path in flare.ghosts(lens, "all")[::6]:
        truth = rays.trace_reference(lens, path.reflections, origins, np.tile(heading, (4000, 1)), GREEN)
        beyond = np.hypot(truth.points[1:-1, :, 0], truth.points[1:-1, :, 1]) / rims[truth.surfaces]
        found = tracing.trace(prepared, path, points, direction)
        counted = found.passed[0]
        assert counted.any()
        assert beyond[:, counted].max() < 1 + 1e-4
        assert (counted == truth.passed).mean() > 0.998


def test_a_closed_rim_lets_nothing_through():
    lens, direction = load("heliar_tronnier_100mm"), towards(4.0)
    for k in (2, lens.stop, 7):
        closed = list(lens.surfaces)
        closed[k] = dataclasses.replace(closed[k], semi_aperture=1e-9)
        shut = dataclasses.replace(lens, surfaces=tuple(closed))
        assert random_rays.monte_carlo(shut, (4, 1), direction, GREEN, rays=20_000).energy[0] == 0
        assert energy.ghost_powers(shut, [GhostPath((4, 1))], direction, GREEN)[0, 0] < 1e-15


def test_no_light_is_made():
    """The image and all ghosts of two and four reflections carry less than enters; bare glass most of it."""
    lens = load("zeiss_biotar_50mm")
    direction = towards(6.0)
    paths = [GhostPath(()), *flare.ghosts(lens, "all")]
    found = energy.ghost_powers(lens, paths, direction, GREEN, base=32)[:, 0]
    entering = np.pi * lens.surfaces[0].semi_aperture ** 2 * direction[2]
    assert 0.2 * entering < found[0] < found.sum() < entering
    assert (found >= 0).all()


def test_a_mirrored_light_has_ghosts_of_the_same_energy():
    lens = load("heliar_tronnier_100mm")
    paths = flare.ghosts(lens)
    one, other = (energy.ghost_powers(lens, paths, towards(*at), GREEN, 32) for at in ((6, 2), (-6, -2)))
    np.testing.assert_allclose(one, other, rtol=2e-3, atol=1e-12)


def test_the_ratio_is_that_of_the_powers():
    lens, source = load("heliar_tronnier_100mm"), Light(towards(5.0), light.line(GREEN), 3.0)
    paths = flare.ghosts(lens)
    found = energy.ghost_energies(lens, paths, source, wavelengths=1)
    image = energy.ghost_powers(lens, [GhostPath(())], source.direction, GREEN, base=128)[0, 0]
    np.testing.assert_allclose(
        found,
        energy.ghost_powers(lens, paths, source.direction, GREEN, within="frame")[:, 0] / image,
        rtol=2e-3,
    )
    assert energy.ghost_to_image(lens, source, "same-side", wavelengths=1) == pytest.approx(found.sum())
