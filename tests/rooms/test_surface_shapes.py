"""What a view sees of plane, disc, cylinder and mesh."""

import numpy as np
import pytest

from aureole import Refusal
from aureole.surface import Cylinder, Disc, Plane, mesh_of, pose_of, see, view_from

VIEW = view_from((0.3, 0.2, 1.1), (0.02, -0.01, 0.0), (37, 52), 0.3)


def grid_mesh(make, count=160, flip=False):
    """Triangles over a square of texture coordinates."""
    u, v = (axis.ravel() for axis in np.meshgrid(*[np.linspace(0, 1, count)] * 2))
    i = np.arange(count * count).reshape(count, count)
    a, b, c, d = i[:-1, :-1].ravel(), i[:-1, 1:].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel()
    triangles = np.vstack([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    texture = np.stack([1 - u if flip else u, v], 1)
    return mesh_of(make(u, v), triangles, texture=texture)


@pytest.mark.parametrize("shape", [Plane(0.3, 0.2), Disc(0.2, 0.06), Cylinder(0.1, 0.2, 2.0)])
def test_frames_are_orthonormal_and_lie_on_their_rays(shape):
    pose = pose_of((0.01, 0.02, -0.03), 0.3, -0.2, 0.5)
    seen = see(shape, VIEW, pose)
    on = seen.hit
    assert 0.05 < on.mean() < 0.95
    frame = np.stack([seen.normals[on], seen.tangents[on], seen.bitangents[on]], 1).astype(float)
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.eye(3)[None] + 0 * frame, atol=1e-6)
    away = VIEW.eye - seen.places[on]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    np.testing.assert_allclose(seen.outward[on], away, atol=1e-6)
    assert (np.sum(seen.normals[on] * seen.outward[on], axis=1) >= 0).all()
    depth = (seen.places[on] - VIEW.eye) @ VIEW.forward
    np.testing.assert_allclose(seen.depth[on], depth, rtol=1e-5)


def test_a_plane_seen_straight_on_covers_its_share_of_the_picture():
    view = view_from((0, 0, 2.0), shape=(100, 200), height=1.0)
    seen = see(Plane(0.5, 0.26), view)
    assert seen.hit.sum() == 50 * 26
    # Texture: u to the right, v upward.
    assert seen.texture[50, 110, 0] > 0.5
    assert seen.texture[45, 100, 1] > 0.5


def test_tangents_of_a_disc_are_radial():
    view = view_from((0, 0, 1.0), shape=(64, 64), height=0.13)
    seen = see(Disc(0.12, 0.046), view)
    on = seen.hit
    radius = np.linalg.norm(seen.places[on], axis=1)
    assert radius.min() >= 0.023
    assert radius.max() <= 0.06
    np.testing.assert_allclose(seen.tangents[on], seen.places[on] / radius[:, None], atol=1e-6)
    area = on.mean() * 0.13**2
    assert area == pytest.approx(np.pi * (0.06**2 - 0.023**2), rel=0.02)


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("height", [None, 0.4])
def test_a_fine_mesh_is_the_cylinder_it_follows(flip, height):
    radius, tall, sweep = 0.1, 0.2, 2.5
    view = view_from((0.3, 0.2, 1.1), (0.02, -0.01, 0.0), (37, 52), 0.3, height=height)

    def make(u, v):
        angle = (u - 0.5) * sweep
        return np.stack([radius * np.sin(angle), (v - 0.5) * tall, radius * np.cos(angle)], 1)

    pose = pose_of((0.01, 0.0, 0.02), 0.2, 0.1, 0.3)
    mesh, exact = see(grid_mesh(make, flip=flip), view, pose), see(Cylinder(radius, tall, sweep), view, pose)
    both = mesh.hit & exact.hit
    assert (mesh.hit ^ exact.hit).mean() < 0.01
    assert both.mean() > 0.1
    np.testing.assert_allclose(mesh.places[both], exact.places[both], atol=1e-4)
    np.testing.assert_allclose(mesh.normals[both], exact.normals[both], atol=5e-3)
    turn = -1.0 if flip else 1.0
    np.testing.assert_allclose(turn * mesh.tangents[both], exact.tangents[both], atol=5e-3)
    np.testing.assert_allclose(mesh.bitangents[both], exact.bitangents[both], atol=5e-3)
    u = mesh.texture[both, 0]
    np.testing.assert_allclose(1 - u if flip else u, exact.texture[both, 0], atol=2e-3)
    np.testing.assert_allclose(mesh.depth[both], exact.depth[both], rtol=1e-4)


def test_the_nearer_triangle_hides_the_farther_and_one_reaches_behind_the_eye():
    floor = [[-5, -0.1, 5], [5, -0.1, 5], [0, -0.1, -20]]
    wall = [[-1, -0.05, -1], [1, -0.05, -1], [0, 1, -1]]
    view = view_from((0, 0, 0), (0, 0, -1), (81, 81), 1.2)
    seen = see(mesh_of(np.array(floor + wall, float), [[0, 1, 2], [3, 4, 5]]), view)
    np.testing.assert_allclose(seen.places[40, 40], [0, 0, -1], atol=1e-6)
    bottom = seen.places[80, 40]
    assert bottom[1] == pytest.approx(-0.1, abs=1e-6)
    assert -1 < bottom[2] < 0
    # Every row below the wall's foot sees the floor.
    assert seen.hit[45:, 40].all()


def test_bands_of_rows_join_to_the_whole():
    whole = see(Disc(1.0), VIEW, samples=2)
    parts = [see(Disc(1.0), VIEW, samples=2, rows=rows).frames for rows in ((0, 11), (11, 74))]
    assert np.array_equal(np.vstack(parts)[whole.hit], whole.frames[whole.hit])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: see(Plane(0.0, 1.0), VIEW), "'width' must be a finite number > 0"),
        (lambda: see(Disc(1.0, 2.0), VIEW), "'hole' must be a number from 0 to 1"),
        (lambda: view_from((0, 0, 0)), "'target' must lie away from the eye"),
        (lambda: view_from((0, 1, 0)), "'up' must lie not along the line of sight"),
        (lambda: mesh_of(np.zeros((3, 3)), [[0, 1, 3]]), "'triangles' must hold whole numbers from 0 to 2"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(Refusal, match=message):
        call()
