"""A glTF file carries the table's name and numbers in its material's extras, and stays a valid file."""

import json

import numpy as np
import pytest
import trimesh

from aureole import refuse, surface
from aureole.surface import export_gltf


@pytest.fixture
def table():
    return surface.scatter_table(np.ones((5, 6, 3)), (1.0, 1.0, 1.0), warp=3)


def test_a_gltf_material_carries_the_table_and_the_rest_stays(table, tmp_path):
    scene = {"asset": {"version": "2.0"}, "materials": [{"name": "a", "doubleSided": True}, {"name": "b"}]}
    (tmp_path / "in.gltf").write_text(json.dumps(scene))
    place = surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", tmp_path / "in.gltf", "a", f0=0.8)
    found = json.loads(place.read_text())
    extras = found["materials"][0].pop("extras")[export_gltf.GLTF_KEY]
    assert found == scene
    assert (extras["texture"], extras["f0"], extras["halfRange"], extras["warp"]) == ("cd.exr", 0.8, 2.0, 3)


@pytest.mark.parametrize(("shape", "area"), [("disc", np.pi * (0.06**2 - 0.023**2)), ("plane", 0.1 * 0.06)])
def test_a_new_file_holds_one_object_that_others_load(table, tmp_path, shape, area):
    place = surface.write_gltf(tmp_path / "new.gltf", table, "cd.exr", shape=shape)
    mesh = trimesh.load(place, force="mesh")
    # 128 segments leave out 4e-4 of a circle.
    assert mesh.area == pytest.approx(area, rel=5e-4)
    np.testing.assert_allclose(mesh.face_normals, np.tile([0.0, 0.0, 1.0], (len(mesh.faces), 1)), atol=1e-6)
    np.testing.assert_allclose(mesh.bounds[:, 2], 0.0)


@pytest.mark.parametrize("shape", ["disc", "plane"])
def test_a_new_file_keeps_the_standard(table, tmp_path, shape):
    scene = json.loads(surface.write_gltf(tmp_path / "new.gltf", table, "cd.exr", shape=shape).read_text())
    lengths = {"SCALAR": 4, "VEC2": 8, "VEC3": 12, "VEC4": 16}
    for accessor in scene["accessors"]:
        view = scene["bufferViews"][accessor["bufferView"]]
        assert view["byteLength"] == accessor["count"] * lengths[accessor["type"]]
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= scene["buffers"][0]["byteLength"]
    attributes = scene["meshes"][0]["primitives"][0]["attributes"]
    assert {"min", "max"} <= set(scene["accessors"][attributes["POSITION"]])
    assert set(attributes) == {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"}
    assert scene["asset"]["version"] == "2.0"


def test_refusals_name_what_would_fit(table, tmp_path):
    with pytest.raises(refuse.Refusal, match=r"There is no file '.*none\.gltf'"):
        surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", tmp_path / "none.gltf")
    (tmp_path / "in.gltf").write_text('{"asset": {}, "materials": [{"name": "metal"}, {"name": "wood"}]}')
    with pytest.raises(refuse.Refusal, match=r"has no 'metl'\. Did you mean 'metal'"):
        surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", tmp_path / "in.gltf", "metl")
    with pytest.raises(refuse.Refusal, match=r"'material' must name one of .*'metal', 'wood'"):
        surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", tmp_path / "in.gltf")
    with pytest.raises(refuse.Refusal, match="'shape' must be one of 'disc', 'plane'"):
        surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", shape="ball")
    with pytest.raises(refuse.Refusal, match="'f0' must"):
        surface.write_gltf(tmp_path / "out.gltf", table, "cd.exr", f0=1.5)
    assert not list(tmp_path.glob("out*"))
