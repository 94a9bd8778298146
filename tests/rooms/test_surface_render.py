"""The shader against the formula written out, and what must hold whatever the table."""

import numpy as np
import pytest

from aureole import Refusal
from aureole.surface import (
    Cylinder,
    Disc,
    Material,
    Plane,
    Scene,
    area_lamp,
    circle_of_confusion,
    conductor,
    defocus,
    distant_lamp,
    point_lamp,
    pose_of,
    render,
    scatter_table,
    schlick,
    see,
    shade,
    shader,
    view_from,
)

VIEW = view_from((0.02, 0.05, 0.5), shape=(31, 44), field_of_view=0.35)
POSE = pose_of(tilt=-0.3, spin=0.4)


def sheet(function, shape=(65, 65), warp=1, half_range=2.0, white=(1.0, 1.0, 1.0)):
    """Sample a function of h·t and h·b as a table whose row 0 is +h·b."""
    v, u = (np.linspace(1, -1, shape[0]), np.linspace(-1, 1, shape[1]))
    hb, ht = half_range * v[:, None] ** warp, half_range * u[None, :] ** warp
    values = np.stack([np.broadcast_to(part, shape) for part in function(ht, hb)], -1).astype(np.float32)
    return scatter_table(values, white, half_range, warp)


def plain(ht, hb):
    """Linear in both, so that bilinear look-ups are exact where warp is 1."""
    return 1.0 + 0.2 * ht + 0.1 * hb, 1.0 - 0.3 * ht + 0.05 * hb, 2.0 + 0.1 * ht - 0.4 * hb


def half(seen, lamp):
    toward = lamp.place - (0 if lamp.distant else seen.places.astype(float))
    distance = np.linalg.norm(toward, axis=-1, keepdims=True)
    w_i = toward / distance
    return w_i, w_i + seen.outward, (1.0 if lamp.distant else distance[..., 0])


def dot(a, b):
    return np.sum(a * b, axis=-1)


@pytest.mark.parametrize("warp", [1, 3, 5, 7])
@pytest.mark.parametrize("shape", [(257, 257), (512, 300)])
def test_the_table_is_looked_up_where_h_is(warp, shape):
    """A table that holds h itself gives h back: at every warp, at odd and even sizes."""
    table = sheet(lambda ht, hb: (ht + 3, hb + 3, 0 * ht), shape, warp)
    prepared = shader(table, Material(fresnel=np.ones((2, 3))), colour_space="xyz")
    for lamp in (point_lamp((0.3, 0.1, 0.4)), distant_lamp((-0.9, 0.3, 0.4))):
        seen = see(Disc(0.2), VIEW, POSE)
        w_i, h, distance = half(seen, lamp)
        got = shade(prepared, seen, [lamp])
        scale = 4 * np.pi**2 * dot(seen.normals, w_i) / distance**2
        on = seen.hit
        step = 2.0 * warp / (0.5 * min(shape))
        for channel, axis in enumerate((seen.tangents, seen.bitangents)):
            found = got[..., channel][on] / scale[on] - 3
            np.testing.assert_allclose(found, dot(h, axis)[on], atol=0.3 * step**2 + 1e-4)


@pytest.mark.parametrize("geometry", ["one", "stam"])
@pytest.mark.parametrize("lamp", [point_lamp((0.2, 0.1, 0.3), (1, 2, 3)), distant_lamp((0.5, -0.2, 1))])
def test_the_sum_of_all_parts_is_the_formula(geometry, lamp):
    material = Material((0.1, 0.2, 0.3), 0.4, 0.25, 0.01, schlick((0.9, 0.5, 0.1)), geometry, (0.5, 0.8))
    shape = Cylinder(0.05, 0.1, 2.5)
    seen = see(shape, VIEW, POSE)
    got = shade(shader(sheet(plain), material, colour_space="xyz"), seen, [lamp])
    w_i, h, distance = half(seen, lamp)
    ni, no = np.maximum(1e-6, dot(seen.normals, w_i)), np.maximum(1e-6, dot(seen.normals, seen.outward))
    unit = h / np.linalg.norm(h, axis=-1, keepdims=True)
    oh, nh = dot(unit, w_i), np.maximum(1e-2, dot(unit, seen.normals))
    fresnel = np.array([0.9, 0.5, 0.1]) + (1 - np.array([0.9, 0.5, 0.1])) * (1 - oh[..., None]) ** 5
    slope = (1 - nh**2) / nh**2
    beckmann = np.exp(-slope / 0.25**2) / (np.pi * 0.25**2 * nh**4)
    shadow = np.minimum(1, np.minimum(2 * nh * ni / oh, 2 * nh * no / oh))
    lobe = 0.4 * beckmann * shadow / (4 * ni * no)
    ht, hb = dot(h, seen.tangents), dot(h, seen.bitangents)
    window = np.exp(-(ht**2) / (2 * 0.5**2) - hb**2 / (2 * 0.8**2))
    stam = (1 + dot(w_i, seen.outward)) ** 2 / (4 * ni * no) if geometry == "stam" else 1.0
    table = np.stack(plain(ht, hb), -1) * (0.01 * 4 * np.pi**2 * window * stam)[..., None]
    f_r = np.array([0.1, 0.2, 0.3]) / np.pi + fresnel * lobe[..., None] + fresnel**2 * table
    wanted = f_r * (ni / distance**2)[..., None] * lamp.intensity
    on = seen.hit & (ni > 1e-3) & (no > 0.02)
    assert on.mean() > 0.1
    np.testing.assert_allclose(got[on][:, :3], wanted[on], rtol=2e-3)
    assert (got[seen.hit & (ni == 1e-6)][:, :3] == 0).all()


def test_light_and_eye_may_change_places():
    """Reciprocity of f_r: the same radiance over irradiance, exact to rounding."""
    one, other = np.array([0.3, 0.2, 0.8]), np.array([-0.1, 0.4, 0.5])
    one, other = one / np.linalg.norm(one), other / np.linalg.norm(other)
    material = Material(0.2, 0.5, 0.3, fresnel=conductor((0.2, 0.9, 1.1), (3.9, 2.4, 2.2)), geometry="stam")
    prepared = shader(sheet(lambda ht, hb: (np.exp(ht), 1 + hb**2, 2 + ht * hb)), material)
    values = []
    for eye, lamp in ((one, other), (other, one)):
        view = view_from(eye, shape=(1, 1), height=1e-6)
        values.append(shade(prepared, see(Plane(1, 1), view), [distant_lamp(lamp)])[0, 0, :3] / lamp[2])
    np.testing.assert_allclose(values[0], values[1], rtol=2e-6)


def test_lamps_add_up_and_an_area_is_its_small_lamps():
    prepared = shader(sheet(plain))
    seen = see(Plane(0.2, 0.2), VIEW, POSE)
    lamps = area_lamp((0.0, 0.1, 0.4), (-0.01, 0, 0), (0, 0.01, 0), 2.0, (3, 2))
    # It shines along half_width × half_height, so it faces the surface.
    assert lamps[0].facing @ (0, 0, -1) == pytest.approx(1.0)
    together = shade(prepared, seen, lamps)[..., :3]
    apart = sum(shade(prepared, seen, [lamp])[..., :3] for lamp in lamps)
    np.testing.assert_allclose(together[seen.hit], apart[seen.hit], rtol=1e-5)


def test_diffuse_light_of_an_area_is_the_integral_over_it():
    """Irradiance below the middle of a square of side 2a at height a: 4 L times the corner's form factor."""
    prepared = shader(sheet(plain), Material(diffuse=1.0, diffraction=0.0))
    view = view_from((0, 0, 5.0), shape=(1, 1), height=1e-3)
    lamps = area_lamp((0, 0, 1.0), (-1, 0, 0), (0, 1, 0), 1.0, (60, 60))
    got = shade(prepared, see(Plane(1, 1), view), lamps)[0, 0, 0]
    side = 1 / np.sqrt(2)
    assert got == pytest.approx(4 * side * np.arctan(side) / np.pi, rel=1e-3)


def test_orders_of_a_grating_lie_where_the_grating_equation_says():
    """A ridge of the table at h·t = λ/d is seen on a disc at the radius where 2 sin θ = λ/d."""
    order = 532e-9 / 1.6e-6
    table = sheet(lambda ht, hb: (np.exp(-(((ht + order) / 4e-3) ** 2) / 2) + 0 * hb,) * 3, (3, 4097))
    away = 0.25
    view = view_from((0, 0, away), shape=(801, 801), field_of_view=2 * np.arctan(0.06 / away))
    picture = render(Scene((point_lamp((0, 0, away)),), view), table, Disc(0.12), colour_space="xyz")
    row = picture.pixels[400, 400:, 1].astype(float)
    radius = np.arange(401) * 2 * 0.06 / 801
    found = np.sum(row * radius) / np.sum(row)
    wanted = away * np.tan(np.arcsin(order / 2))
    assert found == pytest.approx(wanted, abs=2e-4)


def test_masks_and_regions_choose_over_the_texture():
    ones, twos = sheet(lambda ht, hb: (1 + 0 * ht,) * 3), sheet(lambda ht, hb: (2 + 0 * ht,) * 3)
    view = view_from((0, 0, 1), shape=(4, 4), height=1.0)
    lamp = distant_lamp((0, 0, 1))
    drawn = shade(
        shader([ones, twos], mask=[[1, 0.5]], regions=[[0], [1]], colour_space="xyz"),
        see(Plane(1, 1), view),
        [lamp],
    )[..., 0] / (4 * np.pi**2)
    np.testing.assert_allclose(drawn[:2, :2], 1, rtol=1e-5)
    np.testing.assert_allclose(drawn[:2, 2:], 0.5, rtol=1e-5)
    np.testing.assert_allclose(drawn[2:, :2], 2, rtol=1e-5)
    np.testing.assert_allclose(drawn[2:, 2:], 1, rtol=1e-5)


@pytest.mark.parametrize("samples", [1, 3])
@pytest.mark.parametrize("shape", [Disc(0.12, 0.05), Plane(0.1, 0.1), Cylinder(0.05, 0.1)])
def test_the_picture_is_the_mean_of_what_its_samples_show(shape, samples):
    lamps = (point_lamp((0.1, 0.1, 0.3)), distant_lamp((0.2, 0, 1)))
    prepared = shader(sheet(plain), Material(0.1, 0.2, 0.2))
    picture = render(Scene(lamps, VIEW, POSE, shadows=False), prepared, shape, samples).pixels
    drawn = shade(prepared, see(shape, VIEW, POSE, samples), lamps)
    rows, columns = VIEW.shape
    wanted = drawn.reshape(rows, samples, columns, samples, 4).mean(axis=(1, 3))
    np.testing.assert_allclose(picture, wanted, rtol=1e-4, atol=1e-5)


def test_white_stays_white():
    """A table that reflects all wavelengths alike shows its light's white as neutral."""
    white = np.array([1.0985, 1.0, 0.3558])  # of illuminant A
    table = sheet(lambda ht, hb: (white[0] + 0 * ht, white[1] + 0 * ht, white[2] + 0 * ht), white=white)
    colour = render(Scene((distant_lamp((0, 0, 1)),), VIEW), table, Plane(1, 1)).pixels[10, 10]
    np.testing.assert_allclose(colour[:3], colour[0], rtol=1e-4)


def test_a_metal_reflects_at_normal_incidence_as_its_index_says():
    n, k = 1.37, 7.6
    assert conductor(n, k)[-1, 0] == pytest.approx(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2), rel=1e-6)
    np.testing.assert_allclose(conductor(n, k)[0], 1.0, atol=1e-6)


def test_defocus_keeps_the_light_and_spreads_it_over_the_disc():
    pixels = np.zeros((61, 61, 4), dtype=np.float32)
    pixels[30, 30] = 1.0
    wide = circle_of_confusion(np.full((61, 61), 2.0), 1.0, 0.01, view_from((0, 0, 1), shape=(61, 61)))
    assert wide[0, 0] == pytest.approx(0.01 * 0.5 / (2 * np.tan(np.pi / 12) / 61))
    spread = defocus(pixels, np.full((61, 61), 20.0))
    assert spread.sum() == pytest.approx(4.0, rel=1e-4)
    assert (spread[..., 0] > 1e-6).sum() == pytest.approx(np.pi * 10**2, rel=0.15)
    np.testing.assert_allclose(defocus(pixels, np.zeros((61, 61))), pixels, atol=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: shader(sheet(plain), Material(geometry="smyth")), "'geometry' must be one of"),
        (lambda: shader(sheet(plain), Material(diffuse=-1)), "'diffuse' must be >= 0"),
        (lambda: shader([sheet(plain), sheet(plain, warp=3)]), "'table' must be tables of one size"),
        (lambda: shader(sheet(plain), regions=[[0, 1]]), "'regions' must hold whole numbers from 0 to 0"),
        (lambda: point_lamp((0, 0, 1), -1), "'intensity' must be >= 0"),
        (lambda: schlick(1.2), "'reflectance' must lie in 0..1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(Refusal, match=message):
        call()
