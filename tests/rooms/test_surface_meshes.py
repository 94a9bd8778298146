"""Meshes from files, and how many triangles a view may have."""

import numpy as np
import pytest

from aureole import Refusal
from aureole.surface import (
    Disc,
    Plane,
    Scene,
    distant_lamp,
    mesh_of,
    read_mesh,
    render,
    scatter_table,
    see,
    view_from,
)

VIEW = view_from((0.05, -0.1, 1.0), (0.02, -0.01, 0.0), (37, 52), 0.3)
CORNERS = [(-0.15, -0.1, 0), (0.15, -0.1, 0), (0.15, 0.1, 0), (-0.15, 0.1, 0)]
TEXTURE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def write_obj(path, texture=True, scale=1.0):
    lines = [f"v {scale * x} {scale * y} {scale * z}" for x, y, z in CORNERS]
    lines += [f"vt {u} {v}" for u, v in TEXTURE] if texture else []
    lines += ["f 1/1 2/2 3/3", "f 1/1 3/3 4/4"] if texture else ["f 1 2 3", "f 1 3 4"]
    path.write_text("\n".join(lines) + "\n")


def write_ply(path):
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    body = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS) + "3 0 1 2\n3 0 2 3\n"
    path.write_text(head + body)


@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_an_obj_with_texture_coordinates_is_the_plane_it_holds(tmp_path, scale):
    write_obj(tmp_path / "sheet.obj", scale=scale)
    mesh = read_mesh(tmp_path / "sheet.obj", scale=1 / scale)
    got, wanted = see(mesh, VIEW), see(Plane(0.3, 0.2), VIEW)
    assert (got.hit != wanted.hit).sum() == 0
    np.testing.assert_allclose(got.frames, wanted.frames, atol=1e-5)


@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_a_mesh_without_texture_takes_its_tangent_from_the_caller(tmp_path, suffix):
    path = tmp_path / f"sheet.{suffix}"
    if suffix == "obj":
        write_obj(path, texture=False)
    else:
        write_ply(path)
    seen = see(read_mesh(path, direction=(1.0, 1.0, 3.0)), VIEW)
    np.testing.assert_allclose(
        seen.tangents[seen.hit], np.sqrt([0.5, 0.5, 0]) + 0 * seen.tangents[seen.hit], atol=1e-6
    )
    np.testing.assert_allclose(seen.normals[seen.hit][:, 2], 1.0, atol=1e-6)


def test_seams_of_texture_coordinates_stay_apart(tmp_path):
    """Two triangles that share an edge but not its texture coordinates, as where a texture is cut."""
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 0", "vt 0 1", "vt 1 1"]
    (tmp_path / "seam.obj").write_text("\n".join([*lines, "f 1/1 2/2 3/3", "f 1/4 3/5 4/6"]) + "\n")
    seen = see(read_mesh(tmp_path / "seam.obj"), VIEW)
    lower = seen.hit & (seen.places[..., 1] * 0.15 < seen.places[..., 0] * 0.1)
    upper = seen.hit & ~lower
    np.testing.assert_allclose(seen.tangents[lower], (1.0, 0, 0) + 0 * seen.tangents[lower], atol=1e-5)
    # There u grows from corner 3 to corner 4 and not from 1 to 3: along (-1, 0) and a part across.
    edges = np.array([[0.3, 0.2], [0.0, 0.2]])
    grow = np.linalg.solve(edges, [0.0, 1.0])
    u = seen.texture[upper][:, 0]
    place = seen.places[upper][:, :2] - np.array([-0.15, -0.1])
    np.testing.assert_allclose(u, place @ grow, atol=1e-5)


def ball(rows, columns):
    """A sphere of radius 0.1 with texture coordinates."""
    v, u = (
        part.ravel()
        for part in np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    )
    x, z = np.sin(np.pi * v) * np.sin(2 * np.pi * u), np.sin(np.pi * v) * np.cos(2 * np.pi * u)
    corners = 0.1 * np.stack([x, -np.cos(np.pi * v), z], axis=1)
    i = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]))
    triangles = np.vstack([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    return mesh_of(corners, triangles, normals=corners, texture=np.stack([u, v], 1))


def test_a_hundred_thousand_triangles_make_a_round_ball():
    """Samples lie on the sphere, none behind is seen through it, and it casts no shadow on its lit side."""
    mesh = ball(226, 226)
    assert len(mesh.triangles) > 100_000
    view = view_from((0, 0, 0.5), shape=(60, 80), field_of_view=0.5)
    seen = see(mesh, view)
    places = seen.places[seen.hit].astype(float)
    np.testing.assert_allclose(np.linalg.norm(places, axis=1), 0.1, atol=2e-5)
    np.testing.assert_allclose(seen.normals[seen.hit], places / 0.1, atol=2e-3)
    # The nearer of the two places along each ray.
    assert (np.sum(places * seen.outward[seen.hit], axis=1) > 0).all()
    disc = np.tan(np.arcsin(0.1 / 0.5)) / np.tan(0.25) * 30
    assert seen.hit.sum() == pytest.approx(np.pi * disc**2, rel=0.01)
    table = scatter_table(np.ones((2, 2, 3)), (1, 1, 1), warp=1)
    scene = Scene((distant_lamp((1.0, 0.2, 0.4)),), view)
    lit = render(scene, table, mesh).pixels[..., 1]
    toward = scene.lamps[0].place
    cosine = np.where(seen.hit, seen.normals @ toward, 0)
    np.testing.assert_allclose(lit[cosine > 0.1], 4 * np.pi**2 * cosine[cosine > 0.1], rtol=1e-4)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.obj", None, "cannot be read as a mesh"),
        ("broken.ply", "ply\nformat ascii 1.0\nelement vertex x\n", "cannot be read as a mesh"),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "has no triangles|cannot be read"),
        ("photo.png", "", "'mesh' must be one of"),
    ],
)
def test_files_that_hold_no_mesh_are_refused_in_one_line(tmp_path, name, content, message):
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(Refusal, match=message) as refused:
        read_mesh(tmp_path / name)
    assert "\n" not in str(refused.value)


def test_frames_of_a_mesh_and_a_disc_share_their_layout():
    assert see(Disc(0.1), VIEW).frames.shape == see(ball(9, 9), VIEW).frames.shape == (37, 52, 17)
