"""Real rays: focus of paraboloids and aplanats, Snell by hand, energy, symmetry, ways back and forth."""

from functools import cache

import numpy as np
import pytest

from aureole import flare, presets, refuse
from aureole.flare import coating, glass, paraxial, rays
from aureole.flare.prescription import Lens, Surface

load = cache(flare.load)


def lens_of(*surfaces, sensor=1.0):
    stop = Surface(0.0, sensor, 1.0, stop=True)
    return Lens("test", "Test", 0.1, 4.0, (0.036, 0.024), (*surfaces, stop))


def bundle(points, direction=(0.0, 0.0, 1.0), start=-0.01):
    """Return parallel rays through points of the plane in front of the lens."""
    points = np.atleast_2d(np.asarray(points, dtype=float))
    origins = np.column_stack([points, np.full(len(points), start)])
    return origins, np.tile(direction, (len(points), 1))


def disc(radius, count=400, seed=3):
    chance = np.random.default_rng(seed)
    r, turn = radius * np.sqrt(chance.random(count)), 2 * np.pi * chance.random(count)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn)])


def test_one_plane_bends_as_snell_says():
    lens = lens_of(Surface(0.0, 0.1, 0.5, glass.of_numbers(1.5)), Surface(0.0, 0.0, 0.5))
    angle = np.radians(40)
    found = rays.trace_reference(lens, (), *bundle([[0, 0]], (0, np.sin(angle), np.cos(angle)), start=0.0))
    inside = np.arcsin(np.sin(angle) / 1.5)
    assert found.points[2, 0, 1] == pytest.approx(0.1 * np.tan(inside), rel=1e-13)
    np.testing.assert_allclose(found.directions[0], [0, np.sin(angle), np.cos(angle)], atol=1e-15)
    assert found.cosines[0, 0] == pytest.approx(np.cos(angle), rel=1e-14)


def test_an_ellipsoid_of_glass_has_no_spherical_aberration():
    """A front of conic constant -1/n² brings parallel light to one point inside the glass (Descartes)."""
    n, radius = 1.5, 0.05
    focus = radius * n / (n - 1)
    lens = lens_of(
        Surface(1 / radius, focus, 0.04, glass.of_numbers(n), conic=-1 / n**2), Surface(0, 0, 0.04)
    )
    found = rays.trace_reference(lens, (), *bundle(disc(0.035)))
    assert found.passed.all()
    assert np.abs(found.points[2, :, :2]).max() < 1e-14
    sphere = lens_of(Surface(1 / radius, focus, 0.04, glass.of_numbers(n)), Surface(0, 0, 0.04))
    assert np.abs(rays.trace_reference(sphere, (), *bundle(disc(0.035))).points[2, :, :2]).max() > 1e-3


def test_an_asphere_that_repeats_a_conic_bends_alike():
    """The sag of a paraboloid is r²/(2R); a sphere's missing terms r⁴/8R³, r⁶/16R⁵, ... make it one."""
    radius, half = 0.05, 0.01
    terms = [1 / 8, 1 / 16, 5 / 128, 7 / 256, 21 / 1024, 33 / 2048]
    sphere_to_parabola = tuple(-t / radius ** (2 * m + 3) for m, t in enumerate(terms))
    one = Surface(1 / radius, 0.02, half, glass.of_numbers(1.6), conic=-1.0)
    other = Surface(1 / radius, 0.02, half, glass.of_numbers(1.6), asphere=sphere_to_parabola)
    rear = Surface(-10.0, 0.0, half)
    slanted = bundle(disc(half), (0.05, -0.1, 0.99))
    found = [rays.trace_reference(lens_of(first, rear), (), *slanted) for first in (one, other)]
    np.testing.assert_allclose(found[0].positions, found[1].positions, atol=1e-9)


def test_points_lie_on_their_surfaces():
    lens = load("heliar_tronnier_100mm")
    found = rays.trace_reference(lens, (4, 1), *bundle(disc(0.012), (0.1, 0.05, 1.0)))
    place = np.cumsum([0.0, *(surface.thickness for surface in lens.surfaces)])
    for k, points in zip(found.surfaces[:, 0], found.points[1:-1], strict=True):
        z, c = points[found.reached, 2] - place[k], lens.surfaces[k].curvature
        r = points[found.reached, :2]
        np.testing.assert_allclose(c * (np.sum(r**2, axis=1) + z**2), 2 * z, atol=1e-15)


def test_a_cylinder_bends_in_one_plane_only():
    lens = lens_of(
        Surface(20.0, 0.005, 0.02, glass.of_numbers(1.5), cylinder="y"), Surface(0.0, 0.0, 0.02), sensor=0.1
    )
    found = rays.trace_reference(lens, (), *bundle([[0.004, 0.003]]))
    assert found.positions[0, 0] == pytest.approx(0.004, rel=1e-14)
    plane = lens_of(Surface(20.0, 0.005, 0.02, glass.of_numbers(1.5)), Surface(0.0, 0.0, 0.02), sensor=0.1)
    assert found.positions[0, 1] == pytest.approx(
        rays.trace_reference(plane, (), *bundle([[0.0, 0.003]])).positions[0, 1], rel=1e-13
    )


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_light_from_afar_comes_to_a_small_spot(name):
    """On the axis at f/8 the spot is far smaller than defocus by 1 % of the focal length would make it."""
    lens = load(name)
    lens_radius = min(paraxial.focal_length(lens) / 16, paraxial.entrance_radius(lens)[0])
    found = rays.trace_reference(lens, (), *bundle(disc(lens_radius)))
    spot = np.sqrt(np.mean(np.sum(found.positions[found.passed, :2] ** 2, axis=1)))
    assert found.passed.mean() > 0.95
    limit = 0.00065 if name == "schneider_anamorphic_31mm" else 0.0003
    assert spot < limit * paraxial.focal_length(lens)


@pytest.mark.parametrize("name", ["heliar_tronnier_100mm", "canon_tele_zoom_135mm", "nikkor_50mm_f1_2"])
def test_a_mirrored_light_makes_a_mirrored_ghost(name):
    lens = load(name)
    ways = np.array([path.reflections for path in flare.ghosts(lens, "all")])[::5]
    points = np.tile(disc(0.01, 7), (len(ways), 1))
    ways = np.repeat(ways, 7, axis=0)
    one = rays.trace_reference(lens, ways, *bundle(points, (0.05, 0.02, 1.0)))
    other = rays.trace_reference(lens, ways, *bundle(points * [-1, 1], (-0.05, 0.02, 1.0)))
    np.testing.assert_array_equal(one.reached, other.reached)
    np.testing.assert_allclose(one.positions * [-1, 1, 1], other.positions, atol=1e-12)
    np.testing.assert_allclose(rays.power(lens, one), rays.power(lens, other), atol=1e-14)


def test_ways_of_each_ray_are_the_ways_one_by_one():
    lens = load("cooke_triplet_100mm")
    paths = [path.reflections for path in flare.ghosts(lens, "all")]
    origins, directions = bundle(disc(0.005, len(paths)), (0.02, 0.0, 1.0))
    found = rays.trace_reference(lens, paths, origins, directions)
    energy = rays.power(lens, found)
    for k, path in enumerate(paths):
        alone = rays.trace_reference(lens, path, origins[k : k + 1], directions[k : k + 1])
        np.testing.assert_array_equal(alone.positions[0], found.positions[k])
        assert alone.reached[0] == found.reached[k]
        assert rays.power(lens, alone)[0] == pytest.approx(energy[k], rel=1e-14)


def test_the_power_of_the_image_is_the_product_of_what_passes():
    lens = load("zeiss_biotar_50mm")
    found = rays.trace_reference(lens, (), *bundle([[0.0, 0.0]]))
    product = 1.0
    for k, surface in enumerate(lens.surfaces):
        one, other = lens.glass_before(k).index, surface.glass.index
        product *= 1 - ((one - other) / (one + other)) ** 2
    assert rays.power(lens, found)[0] == pytest.approx(product, rel=1e-12)


def test_the_power_of_a_ghost_has_two_reflections():
    lens = load("zeiss_biotar_50mm")
    found = rays.trace_reference(lens, (3, 0), *bundle([[0.0, 0.0]]))
    reflected = [
        ((a - b) / (a + b)) ** 2
        for a, b in [(lens.glass_before(k).index, s.glass.index) for k, s in enumerate(lens.surfaces)]
    ]
    through = [1 - r for r in reflected]
    # 0, 1, 2 forward, back through 2 and 1, forward through 1, 2, 3 and the rest.
    product = reflected[3] * reflected[0] * through[0] * through[1] ** 3 * through[2] ** 3
    product *= np.prod(through[3:])
    assert rays.power(lens, found)[0] == pytest.approx(product, rel=1e-12)


def test_a_coating_is_met_from_its_own_side():
    """Light that comes back to a coated front meets the layers the other way round."""
    layers = (coating.quarter_wave(1.38, 550e-9), coating.quarter_wave(2.1, 400e-9))
    coated = coating.Coating("two", layers)
    dense = glass.of_numbers(1.7)
    lens = lens_of(Surface(0.0, 0.01, 0.1, dense, coated), Surface(0.0, 0.0, 0.1))
    found = rays.trace_reference(lens, (1, 0), *bundle([[0.0, 0.0]], (0.3, 0.0, 1.0)), 480e-9)
    outside = 1 / np.hypot(1, 0.3)
    inside = np.sqrt(1 - (1 - outside**2) / 1.7**2)
    enter = coating.reflectance(layers, glass.AIR, dense, outside, 480e-9)[1]
    back, leave = coating.reflectance((), dense, glass.AIR, inside, 480e-9)
    again = coating.reflectance(layers[::-1], dense, glass.AIR, inside, 480e-9)[0]
    assert rays.power(lens, found)[0] == pytest.approx(enter * back * again * leave, rel=1e-12)


def test_no_energy_is_made():
    """The image and all ghosts of a ray together carry no more than the ray; bare glass loses the rest."""
    lens = load("zeiss_biotar_50mm")
    ways = [path.reflections for path in flare.ghosts(lens, "all")]
    origins, directions = bundle(np.zeros((len(ways), 2)))
    ghosts = rays.power(lens, rays.trace_reference(lens, ways, origins, directions)).sum()
    image = rays.power(lens, rays.trace_reference(lens, (), *bundle([[0.0, 0.0]])))[0]
    assert 0.5 < image < image + ghosts < 1


def test_rays_outside_a_semi_aperture_are_blocked_but_traced_on():
    lens = load("heliar_tronnier_100mm")
    radius, _ = paraxial.entrance_radius(lens)
    found = rays.trace_reference(lens, (), *bundle([[0, 0.9 * radius], [0, 1.1 * radius]]))
    assert found.reached.all()
    assert found.passed.tolist() == [True, False]
    assert found.relative_radius[1] > 1


def test_lost_rays_stay_where_they_were():
    """A ray far off misses the ball; one that meets a plane from inside at 60 degrees is wholly reflected."""
    ball = lens_of(Surface(100.0, 0.02, 0.009, glass.of_numbers(1.5)), Surface(-100.0, 0.0, 0.009))
    found = rays.trace_reference(ball, (), *bundle([[0.0, 0.0], [0.0, 0.02]]))
    assert found.reached.tolist() == [True, False]
    np.testing.assert_array_equal(found.positions[1], found.points[0, 1])
    wedge = lens_of(Surface(40.0, 0.02, 0.02, glass.of_numbers(1.9)), Surface(0.0, 0.0, 0.02))
    lost = rays.trace_reference(wedge, (), *bundle([[0.0, 0.0245]]))
    assert not lost.reached[0]
    assert rays.power(wedge, lost)[0] == 0
    for traced in (found, lost):
        for values in (traced.positions, traced.directions, traced.points, traced.relative_radius):
            assert np.isfinite(values).all()


def test_the_stops_coordinate():
    lens = load("nikkor_50mm_f1_2")
    _, radius = paraxial.entrance_pupil(lens)
    turns = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    near = 1e-4 * radius * np.column_stack([np.cos(turns), np.sin(turns)])
    found = rays.trace_reference(lens, (), *bundle(near))
    expected = near / radius * np.sign(paraxial.heights(lens)[lens.stop][0, 0])
    np.testing.assert_allclose(rays.stop_points(lens, found), expected, rtol=1e-6, atol=1e-12)


def test_colours_part():
    lens = load("heliar_tronnier_100mm")
    origins, directions = bundle([[0.0, 0.01]] * 2)
    found = rays.trace_reference(lens, (), origins, directions, [glass.F_LINE, glass.C_LINE])
    assert abs(found.positions[0, 1] - found.positions[1, 1]) > 1e-7


def test_refusals():
    lens = load("cooke_triplet_100mm")
    with pytest.raises(refuse.Refusal, match=r"^'directions' must head for the lens: z > 0\.$"):
        rays.trace_reference(lens, (), [[0, 0, -1]], [[0, 0, -1]])
    with pytest.raises(refuse.Refusal, match=r"^'directions' must be an array of shape \(2, 3\), got"):
        rays.trace_reference(lens, (), [[0, 0, -1], [0, 0, -1]], [[0, 0, 1]])
    with pytest.raises(refuse.Refusal, match=r"^'reflections' must turn back and forth"):
        rays.trace_reference(lens, (1, 1), [[0, 0, -1]], [[0, 0, 1]])
    with pytest.raises(refuse.Refusal, match=r"^'origins' must hold finite numbers"):
        rays.trace_reference(lens, (), [[0, np.nan, -1]], [[0, 0, 1]])
