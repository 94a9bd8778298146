"""Scenes: lamps of several spectra, mirror lobes, shadows, turned tangents, lenses."""

from dataclasses import replace

import numpy as np
import pytest

from aureole import Refusal, light
from aureole.surface import (
    Cylinder,
    Disc,
    Material,
    Plane,
    Scene,
    ThinLens,
    area_lamp,
    circle_of_confusion,
    defocus,
    distant_lamp,
    lens_views,
    material_of,
    mesh_of,
    point_lamp,
    pose_of,
    render,
    render_stages,
    scatter_table,
    schlick,
    see,
    view_from,
)

VIEW = view_from((0, 0, 1.0), shape=(24, 32), height=0.1)
ABOVE = distant_lamp((0, 0, 1))


def sheet(function, size=65, white=(1.0, 1.0, 1.0), **rest):
    """Sample a function of h·t and h·b, alike in X, Y and Z of a white, at warp 1."""
    h = np.linspace(-2, 2, size)
    values = np.broadcast_to(function(h[None, :], -h[:, None]), (size, size))
    return scatter_table(values[..., None] * np.array(white), white, 2.0, 1, **rest)


def even(ht, hb):
    return 1.0 + 0 * ht


def test_lamps_of_other_spectra_have_their_own_tables_and_colours():
    incandescent = np.array([1.0985, 1.0, 0.3558])
    tables = sheet(even), sheet(even, white=incandescent)
    scene = Scene((ABOVE,), VIEW, material=Material(0.3, 0.2, 0.5))
    both = replace(scene, groups=(((ABOVE,), tables[1]),))
    first, together = (render(each, tables[0], Plane(1, 1)).pixels[..., :3] for each in (scene, both))
    warm = light.from_xyz(incandescent, "rec709", np.ones(3))
    assert warm[0] > 1.5 * warm[2]
    # All three parts of the second lamp's light have its colour, since the surface is white.
    np.testing.assert_allclose(together - first, first * warm, rtol=1e-4)
    np.testing.assert_allclose(first, first[..., :1] * np.ones(3), rtol=1e-4)


@pytest.mark.parametrize(
    ("share", "metadata"),
    [
        (0.3, {"zero_order_energy": (0.3 * 1.0985, 0.3, 0.3 * 0.3558)}),
        (
            0.2,
            {"zero_order_energy": (0.2 * 1.0985, 0.2, 0.2 * 0.3558), "zero_order_width": 0.06 * np.sqrt(2)},
        ),
    ],
)
@pytest.mark.parametrize("f0", [1.0, 0.6])
def test_a_zero_order_left_to_a_lobe_keeps_its_light_and_stays_white(share, metadata, f0):
    """Under a lamp that fills the lobe, a mirror of that share shows the lamp's radiance times it, and F²."""
    table = sheet(
        lambda ht, hb: 0 * ht, white=(1.0985, 1.0, 0.3558), zero_order="specular", metadata=metadata
    )
    material = material_of(table, Material(fresnel=schlick(f0)), roughness=0.06)
    assert material.roughness == pytest.approx(0.06)
    lamps = area_lamp((0, 0, 1.0), (-0.6, 0, 0), (0, 0.6, 0), 1.0, (60, 60))
    view = view_from((0, 0, 5.0), shape=(1, 1), height=1e-3)
    drawn = render(Scene(lamps, view, material=material), table, Plane(1, 1)).pixels[0, 0]
    np.testing.assert_allclose(drawn[:3], share * f0**2, rtol=0.01)
    # Without a material the table says it by itself.
    own = render(Scene(lamps, view), table, Plane(1, 1)).pixels[0, 0]
    assert own[1] > 0.9 * share * (1 if "zero_order_width" in metadata else 0.99)


def test_a_map_of_angles_turns_the_pattern_as_turning_the_sheet_does():
    table = sheet(lambda ht, hb: 1 + 0.4 * ht + 0.1 * hb)
    lamp = point_lamp((0.3, 0.2, 0.5))
    turned = render(Scene((lamp,), VIEW, angles=np.full((3, 4), 0.7)), table, Plane(9, 9))
    spun = render(Scene((lamp,), VIEW, pose_of(spin=0.7)), table, Plane(9, 9))
    np.testing.assert_allclose(turned.pixels, spun.pixels, rtol=1e-4)
    halves = render(Scene((lamp,), VIEW, angles=[[0.0, 0.7]]), table, Plane(0.2, 0.2)).pixels
    plain = render(Scene((lamp,), VIEW), table, Plane(0.2, 0.2)).pixels
    np.testing.assert_allclose(halves[:, :16], plain[:, :16], rtol=1e-5)
    np.testing.assert_allclose(halves[:, 16:], spun.pixels[:, 16:], rtol=1e-4)


def two_squares():
    """A floor of side 0.2 and a square of side 0.04 that hovers 0.05 above its middle."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    vertices = np.vstack([0.1 * square, 0.02 * square + (0, 0, 0.05)])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    return mesh_of(vertices, np.vstack([faces, faces + 4]))


@pytest.mark.parametrize("lamp", [distant_lamp((0.6, 0, 0.8)), point_lamp((0.6, 0, 0.8), 1.0)])
def test_a_mesh_keeps_light_from_itself(lamp):
    view = view_from((0, 0, 1.0), shape=(80, 80), height=0.2)
    scene = Scene((lamp,), view)
    lit = render(scene, sheet(even), two_squares()).pixels
    free = render(replace(scene, shadows=False), sheet(even), two_squares()).pixels
    assert np.array_equal(lit[..., 3], free[..., 3])
    seen = see(two_squares(), view)
    # By hand: the ray from the floor to the lamp passes z = 0.05 within the small square.
    toward = lamp.place - (0 if lamp.distant else seen.places.astype(float))
    at = seen.places + toward * ((0.05 - seen.places[..., 2]) / toward[..., 2])[..., None]
    inside = (np.abs(at[..., :2]).max(axis=-1) < 0.02) & (seen.places[..., 2] < 0.01)
    dark = (lit[..., 1] == 0) & (free[..., 1] > 0)
    assert inside.sum() > 100
    # Only along the shadow's rim do the lamp's samples show.
    assert (dark != inside).sum() <= 0.1 * inside.sum()
    np.testing.assert_array_equal(lit[~inside & ~dark], free[~inside & ~dark])


def test_a_round_body_does_not_darken_where_it_is_lit():
    """A closed cylinder lit from outside: every sample that faces the lamp is reached."""
    view = view_from((0.1, 0.0, 1.0), shape=(60, 60), field_of_view=0.2)
    scene = Scene((distant_lamp((1, 0.3, 0.5)), point_lamp((-0.4, 0.2, 0.4))), view)
    shape = Cylinder(0.05, 0.3)
    pictures = [render(replace(scene, shadows=on), sheet(even), shape).pixels for on in (True, False)]
    np.testing.assert_allclose(pictures[0], pictures[1], atol=1e-5 * pictures[1].max())


def test_the_inside_of_a_cylinder_lies_in_its_own_shadow():
    view = view_from((0.0, 0.0, 1.0), shape=(40, 40), field_of_view=0.1)
    shape = Cylinder(0.05, 0.3, np.pi)
    pose = pose_of(turn=np.pi)  # its hollow side to the eye
    scene = Scene((distant_lamp((np.sin(1.2), 0, np.cos(1.2))),), view, pose)
    drawn = render(scene, sheet(even), shape).pixels
    seen = see(shape, view, pose)
    # The lamp shines in from the side: a chord towards it leaves through the open half, or meets the wall.
    place, toward = seen.places[20].astype(float), scene.lamps[0].place
    along = -2 * (place[:, 0] * toward[0] + place[:, 2] * toward[2])
    end = place + along[:, None] * toward
    free = end[:, 2] > 0
    faces = (seen.normals[20] @ toward > 0) & seen.hit[20]
    lit = drawn[20, :, 1] > 0
    assert 3 < (faces & free).sum() < faces.sum() - 3
    assert (lit != (faces & free)).sum() <= 2


def striped(focus, lens=None):
    """A striped sheet in a view that is focused somewhere."""
    view = view_from((0, 0, 1.0), shape=(48, 64), field_of_view=0.1)
    mask = (np.arange(32) % 8 < 4).astype(float)[None]
    return Scene((ABOVE,), view, mask=mask, lens=lens)


def test_a_lens_blurs_what_is_out_of_focus_as_its_circle_of_confusion_says():
    table, shape = sheet(even), Plane(0.2, 0.2)
    sharp = render(striped(1.0), table, shape).pixels
    focused = render(striped(1.0, ThinLens(0.02, 1.0, 16)), table, shape).pixels
    np.testing.assert_allclose(focused, sharp, rtol=2e-3, atol=1e-4 * sharp.max())
    lens = ThinLens(0.02, 1.5, 200)
    blurred = render(striped(1.5, lens), table, shape).pixels
    wide = circle_of_confusion(np.full((48, 64), 1.0), lens.focus, lens.diameter, striped(1.5).view)
    assert 2 < wide[0, 0] < 10
    after = defocus(sharp, wide)
    inner = (slice(10, -10), slice(10, -10), 1)
    scale = sharp[inner].max()
    assert np.abs(blurred[inner] - after[inner]).max() < 0.06 * scale
    assert np.abs(blurred[inner] - sharp[inner]).max() > 0.2 * scale


def test_an_order_is_in_focus_behind_its_surface():
    """A lamp before a grating has its orders' image as far behind it (surface paper, section 7)."""
    table = sheet(lambda ht, hb: np.exp(-(ht**2 + hb**2) / (2 * 0.01**2)), 2001)
    view = view_from((0, 0, 1.0), shape=(64, 64), field_of_view=0.2)

    def spread(focus):
        scene = Scene((point_lamp((0, 0, 0.5)),), view, lens=ThinLens(0.05, focus, 60))
        row = render(scene, table, Plane(1, 1)).pixels[32, :, 1].astype(float)
        x = np.arange(64) - 31.5
        return np.sqrt(np.sum(row * x**2) / np.sum(row))

    on_surface, between, behind = spread(1.0), spread(1.3), spread(1.5)
    assert behind < between < on_surface
    assert behind < 0.8 * on_surface


def test_a_near_lamp_far_away_is_a_distant_one():
    """Each point has its own direction to a near lamp, which the paraxial look-up of the paper has not."""
    table = sheet(lambda ht, hb: 1 + 0.3 * ht - 0.2 * hb)
    toward = np.array([0.3, -0.2, 0.9]) / np.sqrt(0.94)
    far = render(Scene((point_lamp(1e4 * toward, 1e8),), VIEW), table, Plane(1, 1)).pixels
    sun = render(Scene((distant_lamp(toward),), VIEW), table, Plane(1, 1)).pixels
    near = render(Scene((point_lamp(0.2 * toward, 0.04),), VIEW), table, Plane(1, 1)).pixels
    np.testing.assert_allclose(far, sun, rtol=1e-4)
    assert np.abs(near - sun).max() > 0.1 * sun.max()


def test_stages_rise_to_the_picture():
    scene = Scene((ABOVE,), VIEW, lens=None)
    through = replace(scene, view=view_from((0, 0, 1), shape=(24, 32)), lens=ThinLens(0.01, 1.0, 5))
    for each in (scene, through):
        stages = list(render_stages(each, sheet(even), Disc(0.05)))
        done = [stage.fraction for stage in stages]
        assert done == sorted(done)
        assert done[-1] == 1.0
        assert np.array_equal(stages[-1].result.pixels, render(each, sheet(even), Disc(0.05)).pixels)
    assert len(stages) == 5


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: render(Scene((), view_from((0, 0, 1), shape=(10**6, 10**6))), sheet(even), Disc(1.0)),
            "memory",
        ),
        (lambda: render(Scene((replace(ABOVE, light=1),), VIEW), sheet(even), Disc(1.0)), "'light' must be"),
        (lambda: render(Scene((), VIEW, mask=[[2.0]]), sheet(even), Disc(1.0)), "'mask' must lie in 0..1"),
        (lambda: lens_views(VIEW, ThinLens(0.1, 1.0)), "'view' must be in perspective"),
        (lambda: material_of(sheet(even, zero_order="specular")), "'zero_order_energy'"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(Refusal, match=message):
        call()
