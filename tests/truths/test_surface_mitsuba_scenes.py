"""Mitsuba's pictures of a scene have our renderer's mean, and its samples the density that they say."""

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.surface import mitsuba as plugin

FOUND = plugin.probe()
needs_mitsuba = pytest.mark.skipif(not FOUND.works, reason=FOUND.reason)
# Means of pictures; the noise of 256 samples a pixel is a fifth of it.
TOLERANCE = 0.01
ROWS, COLUMNS, SAMPLES = 45, 80, 256

METAL = surface.conductor((0.2, 0.9, 1.1), (3.0, 2.4, 2.5))
MATERIALS = {
    "diffracts": surface.Material(fresnel=surface.schlick(0.8)),
    "shines": surface.Material((0.1, 0.2, 0.05), 0.5, 0.3, fresnel=METAL),
    "stam": surface.Material(geometry="stam"),
    "window": surface.Material(0.1, window=(0.5, 0.3)),
}
LAMPS = (
    surface.point_lamp((0.5, 1.2, 4.0), 16.0),
    surface.distant_lamp((-1.0, 0.2, 1.5), (0.2, 0.4, 0.9)),
)
POSE = surface.pose_of((0.1, 0.0, 0.0), tilt=-0.4, turn=0.5, spin=0.2)


@pytest.fixture(scope="module")
def table():
    """Lobes that tell left from right and up from down."""
    h = surface.table.axis(129, warp=3)
    lobes = sum(
        np.exp(-((h[None, :] - m * 0.35 - 0.05) ** 2 + (h[::-1, None] - 0.1) ** 2) / 0.03)
        for m in range(-2, 3)
    )
    return surface.scatter_table(lobes[..., None] * np.array([0.09, 0.1, 0.12]), (1.0, 1.0, 1.0), warp=3)


def bent_sheet():
    line = np.linspace(-0.8, 0.8, 9)
    places = np.array([[x, y, 0.3 * x * y] for y in line for x in line])
    first = (9 * np.arange(8)[:, None] + np.arange(8)).reshape(-1, 1)
    triangles = np.add(first, [[0, 1, 10, 0, 10, 9]]).reshape(-1, 3)
    return surface.mesh_of(places, triangles, texture=(places[:, :2] + 0.8) / 1.6)


SCENES = [
    (surface.Disc(2.0, 0.6), "shines", {"field_of_view": 0.7}),
    (surface.Plane(1.8, 1.2), "window", {"height": 2.2}),
    (surface.Cylinder(0.6, 1.4, 4.0), "stam", {"field_of_view": 0.7}),
    (bent_sheet(), "diffracts", {"field_of_view": 0.7}),
]


def scene_of(material, **view):
    return surface.Scene(
        LAMPS, surface.view_from((0.3, 0.5, 3.0), shape=(ROWS, COLUMNS), **view), POSE, material
    )


def rendered(mitsuba, scene):
    return np.array(mitsuba.render(mitsuba.load_dict(scene), seed=3))[..., :3].astype(np.float64)


@needs_mitsuba
@pytest.mark.parametrize(("shape", "material", "view"), SCENES, ids=lambda value: type(value).__name__)
def test_the_mean_under_lamps_is_the_renderer_s(table, shape, material, view):
    mitsuba = plugin.use()
    scene = scene_of(MATERIALS[material], **view)
    ours = surface.render(scene, table, shape, samples=6).pixels[..., :3]
    theirs = rendered(mitsuba, surface.mitsuba_scene(scene, table, shape, samples=SAMPLES))
    np.testing.assert_allclose(theirs.mean(axis=(0, 1)), ours.mean(axis=(0, 1)), rtol=TOLERANCE)
    # Pixel by pixel, but for noise: turned, mirrored or moved pictures would differ by as much as they have.
    assert np.sqrt(np.mean((theirs - ours) ** 2)) < 0.15 * np.sqrt(np.mean(ours**2))


@needs_mitsuba
def test_the_mean_under_an_environment_is_the_correlation_s(table):
    mitsuba = plugin.use()
    rows = 64
    y = np.cos(np.pi * (np.arange(rows) + 0.5) / rows)[:, None]
    angle = 2.0 * np.pi * ((np.arange(2 * rows) + 0.5) / (2 * rows) - 0.5)[None, :]
    across = np.sqrt(1.0 - y**2)
    # Smooth light from the right, from above and behind the camera: in the middle column lies −z.
    x, z = across * np.sin(angle), -across * np.cos(angle)
    glow = [1.0 + 2.0 * np.exp(4.0 * (x - 1.0)), 1.0 + y, 0.2 + np.exp(3.0 * (z - 1.0)) + 0.0 * x]
    radiance = np.stack(np.broadcast_arrays(*glow), axis=-1)
    around = surface.Environment(np.ascontiguousarray(radiance, dtype=np.float32))
    shape = surface.Plane(1.8, 1.2)
    view = surface.view_from((0.3, 0.5, 3.0), shape=(ROWS, COLUMNS), field_of_view=0.7)
    scene = surface.Scene((), view, POSE, surface.Material())
    theirs = rendered(mitsuba, surface.mitsuba_scene(scene, table, shape, 64, around))

    seen = surface.see(shape, view, POSE, samples=2)
    frame = POSE.axes
    towards = seen.frames[seen.hit][:, 13:16].astype(np.float64) @ frame[:2].T
    ours = surface.EnvironmentReflection(table, size=255)(around, frame).towards(towards)
    mean = ours.sum(axis=0) / seen.hit.size
    np.testing.assert_allclose(theirs.mean(axis=(0, 1)), mean, rtol=TOLERANCE)


@needs_mitsuba
@pytest.mark.parametrize("angle", [0.2, 0.8])
def test_samples_have_the_density_that_they_say(angle):
    """Pearson's test over the sphere; at an incidence of zero the lobe's peak would lie on its pole."""
    plugin.use()
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    h = surface.table.axis(65, warp=1)
    smooth = np.exp(-((h[None, :] - 0.3) ** 2 + (h[::-1, None] - 0.1) ** 2) / 0.2)
    even = surface.scatter_table(smooth[..., None] * [0.05, 0.05, 0.05], (1.0, 1.0, 1.0), warp=1)
    entry = plugin.bsdf(even, surface.Material(0.2, 0.3, 0.4))
    extra = f'<integer name="kept" value="{entry["kept"]}"/>'
    wi = [float(np.sin(angle)), 0.0, float(np.cos(angle))]
    sample, density = BSDFAdapter(entry["type"], extra, wi=wi)
    test = ChiSquareTest(
        SphericalDomain(), sample, density, sample_dim=3, sample_count=1 << 19, res=51, ires=16, seed=1
    )
    assert test.run(significance_level=0.01, test_count=2, quiet=True), test.messages
    assert 0.5 < test.histogram_sum[0] <= 1.0


@pytest.fixture(scope="module")
def patterns():
    h = np.linspace(-1.0, 1.0, 201)

    def pattern(wavelength, height):
        lobes = [
            height / (1 + abs(order)) * np.exp(-((h[None, :] - order * wavelength / 1.5e-6) ** 2) / 0.01)
            for order in range(-3, 4)
        ]
        return surface.diffraction_pattern(sum(lobes) * np.exp(-(h[::-1, None] ** 2) / 0.01), 1.0, wavelength)

    return [pattern(450e-9, 1.2), pattern(620e-9, 0.8)]


@needs_mitsuba
def test_spectral_rays_add_up_to_the_table_of_their_light(patterns):
    mitsuba = plugin.use("llvm_ad_spectral")
    scene = surface.Scene(LAMPS[:1], scene_of(None, height=2.2).view, POSE, surface.Material(0.2))
    shape = surface.Disc(2.0, 0.4)
    table = surface.table_from_pattern(patterns, "A", size=257, warp=1)
    ours = surface.render(scene, table, shape, samples=4).pixels[..., :3].mean(axis=(0, 1), dtype=np.float64)
    described = surface.mitsuba_scene(scene, patterns, shape, SAMPLES, spectrum="A")
    theirs = rendered(mitsuba, described).mean(axis=(0, 1))
    np.testing.assert_allclose(theirs, light.to_xyz(ours, white=table.white), rtol=TOLERANCE)


@needs_mitsuba
def test_a_scene_s_file_draws_the_same(table, tmp_path):
    mitsuba = plugin.use()
    scene, shape = scene_of(MATERIALS["shines"], field_of_view=0.7), surface.Disc(2.0, 0.6)
    surface.write_table(tmp_path / "lobes.exr", table)
    place = surface.write_mitsuba(tmp_path / "scene.xml", "lobes.exr", scene, shape, samples=64)
    read = np.array(mitsuba.render(mitsuba.load_file(str(place)), seed=3))[..., :3]
    given = rendered(mitsuba, surface.mitsuba_scene(scene, table, shape, samples=64))
    np.testing.assert_allclose(read.mean(axis=(0, 1)), given.mean(axis=(0, 1)), rtol=2e-3)


def test_a_scene_s_file_refuses_what_it_cannot_hold(tmp_path):
    scene = scene_of(surface.Material(), height=2.0)
    with pytest.raises(refuse.Refusal, match=r"suffix of scene\.txt"):
        surface.write_mitsuba(tmp_path / "scene.txt", "a.exr", scene, surface.Disc(1.0))
    with pytest.raises(refuse.Refusal, match="must be a Plane, Disc or Cylinder"):
        surface.write_mitsuba(tmp_path / "scene.xml", "a.exr", scene, bent_sheet())
    with pytest.raises(refuse.Refusal, match="must be a Disc with radial tangents"):
        surface.write_mitsuba(tmp_path / "scene.xml", "a.exr", scene, surface.Disc(1.0, radial=False))
    window = surface.area_lamp((0, 0, 1), (0.1, 0, 0), (0, 0.1, 0), samples=(1, 1))
    for other, word in (({"lamps": window}, "'lamps' must shine"), ({"mask": np.ones((2, 2))}, "'mask'")):
        parts = {"lamps": scene.lamps, "view": scene.view, **other}
        with pytest.raises(refuse.Refusal, match=word):
            surface.write_mitsuba(tmp_path / "scene.xml", "a.exr", surface.Scene(**parts), surface.Disc(1.0))
    assert not list(tmp_path.iterdir())


@needs_mitsuba
def test_variants_refuse_what_they_have_no_light_for(table, patterns):
    scene, shape = scene_of(surface.Material(), height=2.0), surface.Disc(1.0)
    mitsuba = plugin.use("llvm_ad_spectral")
    with pytest.raises(refuse.Refusal, match="'lamps' must be neutral"):
        surface.mitsuba_scene(scene, patterns, shape)
    with pytest.raises(RuntimeError, match="spectral variants want patterns"):
        mitsuba.load_dict(plugin.bsdf(table))
    mitsuba = plugin.use()
    with pytest.raises(RuntimeError, match="patterns want 'llvm_ad_spectral'"):
        mitsuba.load_dict(plugin.bsdf(patterns))
