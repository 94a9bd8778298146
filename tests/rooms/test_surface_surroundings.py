"""Light from all around on samples of any shape: against the exact light on flat ones, and by its energy."""

import numpy as np
import pytest

from aureole import picture, refuse, surface
from aureole.records import Picture
from aureole.surface.environment import Environment, directions
from aureole.surface.surroundings import facets, shrunk
from aureole.surface.table import axis, energy

FRAME = surface.frame_of((0.2, 0.9, 0.3), (1, 0, 0), 0.4)
ROOT_MEAN_SQUARE = 0.1  # of the mean radiance, 512 cells


def lobes(size=257, width=0.05, seed=0, count=10):
    generator = np.random.default_rng(seed)
    h = axis(size)
    values = np.zeros((size, size))
    for k in range(count):
        x, y = generator.uniform(-1.2, 1.2, 2) * (k > 0)
        values += np.exp(-((h[:, None] + y) ** 2 + (h[None, :] - x) ** 2) / (2 * width**2))
    return surface.scatter_table(np.repeat(values[..., None], 3, axis=2), (1, 1, 1))


def seen_from(views, frame=FRAME):
    """Frames of a flat sample that is seen from some directions."""
    views = np.asarray(views, dtype=np.float64)
    frames = np.zeros((1, len(views), 17), dtype=np.float32)
    frames[..., 0], frames[..., 10] = 1, 1
    frames[..., 4:7], frames[..., 7:10] = frame[2], frame[0]
    up = np.sqrt(1 - (views**2).sum(axis=1))
    frames[0, :, 13:16] = views @ frame[:2] + up[:, None] * frame[2]
    return frames


def white(rows=16):
    return Environment(np.ones((rows, 2 * rows, 3), dtype=np.float32))


@pytest.fixture(scope="module")
def room():
    return surface.lamps_and_windows(64)


def all_over(count=60, seed=5):
    generator = np.random.default_rng(seed)
    radius, angle = np.sqrt(generator.uniform(0, 0.8, count)), generator.uniform(0, 2 * np.pi, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def test_sums_over_cells_agree_with_the_correlation_and_more_cells_agree_better(room):
    table, views = lobes(513), all_over()
    exact = surface.reflect(table, room, FRAME, 511).towards(views)
    ready = surface.surroundings(room)

    def off(samples):
        found = surface.environment_light(seen_from(views), table, ready, samples)[0]
        return np.sqrt(((found - exact) ** 2).mean()) / exact.mean()

    assert off(512) <= ROOT_MEAN_SQUARE
    assert off(2048) < 0.6 * off(512)


def test_white_light_from_all_around_shows_the_albedo():
    table, views = lobes(), [[0.0, 0.0], [0.3, -0.2], [-0.6, 0.5]]
    found = surface.environment_light(seen_from(views), table, white(), 2048)[0]
    np.testing.assert_allclose(found[:, 1], surface.albedo(table, views)[:, 1], rtol=0.01)


def test_cells_keep_the_tables_energy_and_crowd_where_it_is():
    table = lobes()
    cells = surface.table_cells(table, 300)
    np.testing.assert_allclose(cells[:, 4:].sum(axis=0), 4 * np.pi**2 * energy(table), rtol=1e-3)
    one = surface.table_cells(lobes(count=1), 64)
    # All cells of a lobe of width 0.05 lie about it, and their spread is the lobe's.
    weight = one[:, 5] / one[:, 5].sum()
    assert weight @ (one[:, 0] ** 2) == pytest.approx(0.05**2, rel=0.05)
    assert np.abs(weight @ one[:, :2]).max() < 1e-3


def test_a_mirror_shows_the_patch_behind_it_and_a_rough_one_keeps_white():
    radiance = np.zeros((64, 128, 3), dtype=np.float32)
    radiance[20:24, 60:64] = 5.0
    latitude, longitude = np.pi / 2 - np.pi * 22 / 64, 2 * np.pi * 62 / 128 - np.pi
    toward = [
        np.cos(latitude) * np.sin(longitude),
        np.sin(latitude),
        -np.cos(latitude) * np.cos(longitude),
    ]
    along = FRAME[:2] @ toward
    for side, bright in ((-1.0, 5.0), (1.0, 0.0)):
        found = surface.mirror_light(seen_from([side * along]), Environment(radiance))
        np.testing.assert_allclose(found[0, 0], bright, atol=0.05)
    rough = surface.mirror_light(seen_from([[0.0, 0.0], [0.3, 0.0]]), white(), 0.1)
    np.testing.assert_allclose(rough, 1.0, rtol=0.01)


def test_a_rough_mirror_is_cook_and_torrances_lobe_summed_over_all_directions(room):
    """Beckmann, V grooves, Schlick: direction by direction over the room, for views all over."""
    roughness, fresnel, views = 0.15, surface.schlick(0.3), all_over(20)
    found = surface.mirror_light(seen_from(views), room, roughness, fresnel)[0]
    expected = np.zeros_like(found, dtype=np.float64)
    for places, energies, count in directions(room, FRAME, 4):
        s, energy = places[:count], energies[:count]
        above = np.sqrt(np.maximum(0.0, 1 - (s**2).sum(axis=1)))
        for k, view in enumerate(views):
            eye = np.sqrt(1 - view @ view)
            half = np.column_stack([s + view, above + eye])
            length = np.linalg.norm(half, axis=1)
            n_h, o_h = half[:, 2] / length, 0.5 * length
            slope = (1 - n_h**2) / (n_h**2 * roughness**2)
            facet = np.exp(-slope) / (np.pi * roughness**2 * n_h**4)
            shadow = np.minimum(1.0, 2 * n_h * np.minimum(above, eye) / o_h)
            mirror = 0.3 + 0.7 * (1 - o_h) ** 5
            lobe = mirror * facet * shadow / (4 * np.maximum(above, 1e-4) * eye)
            expected[k] += lobe @ energy
    assert np.median(np.abs(found / expected - 1)) <= 0.08
    assert found.sum() == pytest.approx(expected.sum(), rel=0.1)


def test_facets_have_beckmanns_mean_square_slope():
    cut = facets(0.2)
    assert cut[:, 3].sum() == pytest.approx(1)
    # Of slopes (p, q) with p² + q² of mean m²; rings stand at their middles, so a little is missing.
    assert cut[:, 3] @ (cut[:, 0] ** 2 + cut[:, 1] ** 2) == pytest.approx(0.2**2, rel=0.1)


def test_irradiance_of_a_white_sky_over_black_ground_follows_the_tilt():
    sky = np.zeros((64, 128, 3), dtype=np.float32)
    sky[:32] = 1.0
    for tilt in (0.0, 0.7, np.pi / 2, 2.0):
        frame = surface.frame_of((np.sin(tilt), np.cos(tilt), 0.0), (0, 0, 1))
        found = surface.irradiance(seen_from([[0.0, 0.0]], frame), Environment(sky))
        np.testing.assert_allclose(found, np.pi * (1 + np.cos(tilt)) / 2, rtol=2e-3, atol=2e-3)


def test_fresnels_factor_is_squared_and_a_window_narrows():
    table, frames = lobes(), seen_from([[0.1, 0.1]])
    whole = surface.environment_light(frames, table, white(), 256)
    dim = surface.environment_light(frames, table, white(), 256, np.full((2, 3), 0.5))
    np.testing.assert_allclose(dim, 0.25 * whole, rtol=1e-5)
    narrow = surface.environment_light(frames, table, white(), 256, window=(0.1, 0.1))
    # Of the lobe about h = 0 the window leaves 1 / (1 + 0.05² / 0.1²), and nothing of the others.
    lobe = 4 * np.pi**2 * 2 * np.pi * 0.05**2 / 1.25
    np.testing.assert_allclose(narrow[0, 0], lobe, rtol=0.02)


def test_a_disc_turned_about_its_axis_under_an_even_light_looks_the_same(room):
    table = lobes(129)
    view = surface.view_from((0, 0, 0.3), (0, 0, 0), (9, 9), 0.4)
    seen = surface.see(surface.Disc(0.12, 0.03), view)
    bands = np.repeat(room.radiance.mean(axis=1, keepdims=True), 128, axis=1)
    # Even about y: lay the disc with its axis up, seen from above.
    upward = surface.view_from((0, 0.3, 0), (0, 0, 0), (9, 9), 0.4, up=(0, 0, -1))
    lying = surface.see(surface.Disc(0.12, 0.03), upward, surface.pose_of(tilt=-np.pi / 2))
    found = surface.environment_light(lying, table, Environment(bands.astype(np.float32)), 256)
    assert np.array_equal(seen.hit, lying.hit)
    np.testing.assert_allclose(found, found[::-1, ::-1], rtol=0.02)
    np.testing.assert_allclose(found, np.rot90(found), rtol=0.02)
    assert (found[~lying.hit] == 0).all()
    assert (found[lying.hit] > 0).all()


def test_smaller_copies_keep_the_light():
    radiance = surface.lamps_and_windows(50).radiance
    solid = -np.diff(np.sin(np.pi / 2 - np.pi * np.arange(51) / 50))
    small = shrunk(radiance, 16)
    fewer = -np.diff(np.sin(np.pi / 2 - np.pi * np.arange(17) / 16))
    np.testing.assert_allclose(
        fewer @ small.mean(axis=1), solid @ radiance.mean(axis=1, dtype=np.float64), rtol=2e-2
    )


def test_a_turned_room_looks_the_same_to_a_sample_that_turns_with_it():
    room = surface.lamps_and_windows(32)
    cosine, sine = np.cos(np.pi / 8), np.sin(np.pi / 8)
    about_up = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    # By four columns of sixty-four, to the right or to the left.
    assert any(
        np.array_equal(surface.rotated(room, about_up).radiance, np.roll(room.radiance, shift, axis=1))
        for shift in (4, -4)
    )
    axes = surface.frame_of((0.3, 0.8, -0.4), (1, 0.2, 0.1), 0.7)
    seen = seen_from([[0.0, 0.0]])
    turned = seen_from([[0.0, 0.0]], FRAME @ axes)
    first = surface.irradiance(seen, room)
    np.testing.assert_allclose(surface.irradiance(turned, surface.rotated(room, axes)), first, rtol=0.02)
    with pytest.raises(refuse.Refusal, match="right-handed"):
        surface.rotated(room, np.diag([1.0, 1.0, -1.0]))


@pytest.mark.parametrize("suffix", ["exr", "hdr"])
def test_a_latitude_longitude_file_is_light_from_all_around(tmp_path, suffix):
    room = surface.lamps_and_windows(16)
    path = tmp_path / f"room.{suffix}"
    picture.write(path, Picture(room.radiance))
    read = surface.environment_from_picture(picture.read(path))
    np.testing.assert_allclose(read.radiance, room.radiance, rtol=0.02, atol=0.02)
    assert read.colour_space == "rec709"


def test_pictures_that_are_no_light_from_all_around_are_refused():
    with pytest.raises(refuse.Refusal, match="twice as wide as high, got 30 x 20"):
        surface.environment_from_picture(Picture(np.ones((20, 30, 3), dtype=np.float32)))
    broken = np.ones((16, 32, 3), dtype=np.float32)
    broken[3, 4] = np.nan
    with pytest.raises(refuse.Refusal, match="picture"):
        surface.environment_from_picture(Picture(broken))


def test_wrong_arguments_are_refused():
    frames = seen_from([[0.0, 0.0]])
    with pytest.raises(refuse.Refusal, match="'samples'"):
        surface.environment_light(frames, lobes(65), white(), 0)
    with pytest.raises(refuse.Refusal, match="'seen'"):
        surface.environment_light(np.zeros((3, 3)), lobes(65), white())
    with pytest.raises(refuse.Refusal, match="'regions'"):
        surface.environment_light(frames, lobes(65), white(), 4, regions=[[1]])
    with pytest.raises(refuse.Refusal, match="'geometry'"):
        surface.environment_light(frames, lobes(65), white(), 4, geometry="two")


def drawn(shape, material=None, light=None, **rest):
    """A picture of a shape in light from all around, and where it is."""
    view = surface.view_from((0.0, 0.06, 0.3), shape=(12, 16))
    scene = surface.Scene((), view, material=material, environment=light or white(), **rest)
    pixels = surface.render(scene, lobes(257, 0.2), shape).pixels
    return pixels[..., :3], pixels[..., 3] > 0


@pytest.mark.parametrize("shape", [surface.Disc(0.1, 0.02), surface.Cylinder(0.05, 0.1)])
def test_pictures_in_white_light_show_each_part_by_its_weight(shape):
    """The furnace: diffuse light is the albedo, a smooth mirror its weight, and parts add up."""
    diffuse, on = drawn(shape, surface.Material(diffuse=0.4, diffraction=0.0))
    np.testing.assert_allclose(diffuse[on], 0.4, rtol=5e-3)
    assert (diffuse[~on] == 0).all()
    mirror, _ = drawn(shape, surface.Material(specular=(0.2, 0.3, 0.4), roughness=1e-3, diffraction=0.0))
    np.testing.assert_allclose(mirror[on], (0.2, 0.3, 0.4) + 0 * mirror[on], rtol=5e-3)
    sheet, _ = drawn(shape)
    whole, _ = drawn(shape, surface.Material(0.4, (0.2, 0.3, 0.4), 1e-3))
    np.testing.assert_allclose(whole, diffuse + mirror + sheet, rtol=1e-4, atol=1e-6)


def test_a_picture_of_a_flat_sheet_shows_its_albedo_in_white_light():
    """By reciprocity what it sends to each pixel is the albedo from there; the cells of a table agree."""
    exact, on = drawn(surface.Plane(0.1, 0.1))
    view = surface.view_from((0.0, 0.06, 0.3), shape=(12, 16))
    views = surface.see(surface.Plane(0.1, 0.1), view).outward[on][:, :2]
    wanted = surface.albedo(lobes(257, 0.2), views)
    np.testing.assert_allclose(exact[on], wanted, rtol=0.01)
    cells, _ = drawn(surface.Plane(0.1, 0.1), angles=np.zeros((1, 1)))
    np.testing.assert_allclose(cells[on], exact[on], rtol=0.03)
    half, _ = drawn(surface.Plane(0.1, 0.1), mask=np.full((1, 1), 0.5))
    np.testing.assert_allclose(half, 0.5 * exact, rtol=1e-5, atol=1e-7)


def test_a_pixels_samples_share_one_lobe_where_they_are_seen():
    """Finer samples change how much of a pixel is covered, hardly the light of those wholly covered."""
    shape, view = surface.Disc(0.1, 0.02), surface.view_from((0.0, 0.06, 0.3), shape=(24, 32))
    scene = surface.Scene((), view, environment=white())
    coarse, fine = (surface.render(scene, lobes(257, 0.2), shape, samples).pixels for samples in (1, 3))
    inside = fine[..., 3] > 0.999
    assert inside.any()
    np.testing.assert_allclose(fine[inside], coarse[inside], rtol=1e-4)
    # Light is associated with coverage.
    rim = (fine[..., 3] > 0) & ~inside
    light, whole = fine[rim, 1] / fine[rim, 3], fine[inside, 1]
    assert 0.9 * whole.min() < light.min() <= light.max() < 1.1 * whole.max()
