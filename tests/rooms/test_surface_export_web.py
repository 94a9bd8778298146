"""The page holds the table it was given; GLSL and glTF say what a renderer needs to know."""

import base64
import gzip
import json
import re

import numpy as np
import pytest

from aureole import picture, refuse, surface
from aureole.surface import export_web


@pytest.fixture
def table():
    values = np.random.default_rng(3).exponential(size=(9, 12, 3)) ** 4
    return surface.scatter_table(values, (1.0, 1.0, 1.0), warp=3)


def element(page: str, name: str) -> str:
    return re.search(rf'<script id="{name}"[^>]*>(.*?)</script>', page, re.DOTALL).group(1)


def test_the_page_holds_the_table_to_half_float_precision(table, tmp_path):
    page = surface.write_page(tmp_path / "page.html", table).read_text(encoding="utf-8")
    said = json.loads(element(page, "table"))
    halves = np.frombuffer(gzip.decompress(base64.b64decode(element(page, "texels"))), dtype="<f2")
    found = halves.astype(np.float64).reshape(said["rows"], said["columns"], 3) * said["scale"]
    assert (said["half_range"], said["warp"]) == (2.0, 3)
    np.testing.assert_allclose(found, surface.rgb(table), rtol=2.0**-11, atol=2.0**-25 * said["scale"])


def test_the_page_needs_nothing_from_elsewhere(table, tmp_path):
    page = surface.write_page(tmp_path / "page.html", table, title="<i>A & B</i>").read_text(encoding="utf-8")
    assert not re.search(r"https?:|\bsrc=|\bhref=|\bimport\b|\bfetch\(", page)
    assert "@" not in re.sub(r"<script id=\"texels\".*?</script>", "", page, flags=re.DOTALL)
    assert "<title>&lt;i&gt;A &amp; B&lt;/i&gt;</title>" in page


def test_a_table_is_averaged_down_without_loss_of_what_is_even():
    even = np.full((37, 64, 3), 2.5, dtype=np.float32)
    np.testing.assert_allclose(export_web.reduced(even, 16), 2.5, rtol=1e-6)
    assert export_web.reduced(even, 16).shape == (16, 16, 3)
    assert export_web.reduced(even, 100).shape == even.shape


@pytest.mark.parametrize("length", [64, 65])
def test_averaging_keeps_a_slope_between_the_borders(length):
    slope = np.broadcast_to(np.linspace(-1, 1, length, dtype=np.float32)[:, None, None], (length, 5, 3))
    found = export_web.reduced(np.ascontiguousarray(slope), 17)[1:-1, 0, 0]
    np.testing.assert_allclose(found, np.linspace(-1, 1, 17)[1:-1], atol=1e-2)


def test_refusals_name_what_would_fit(table, tmp_path):
    with pytest.raises(refuse.Refusal, match=r"suffix of page\.txt"):
        surface.write_page(tmp_path / "page.txt", table)
    with pytest.raises(refuse.Refusal, match="'shape' must be one of 'plane', 'disc', 'cylinder'"):
        surface.write_page(tmp_path / "page.html", table, surface.WebView(shape="dis"))
    with pytest.raises(refuse.Refusal, match="'samples' must"):
        surface.write_page(tmp_path / "page.html", table, surface.WebView(samples=5))
    assert not list(tmp_path.glob("page*"))


def test_the_glsl_file_is_the_page_s_own_function(table, tmp_path):
    function = surface.write_glsl(tmp_path / "diffraction.glsl").read_text(encoding="utf-8")
    page = surface.write_page(tmp_path / "page.html", table).read_text(encoding="utf-8")
    assert function.startswith(element(page, "diffraction"))
    assert "three.js" in function.removeprefix(element(page, "diffraction"))
    assert "vec3 aureole_diffraction(" in function


def test_the_glsl_file_says_the_numbers_of_the_table_beside_it(table, tmp_path):
    function = surface.write_glsl(tmp_path / "foil.glsl", table).read_text(encoding="utf-8")
    assert "foil.exr: 12 x 9 samples" in function.splitlines()[0]
    assert "aureole_half_range = 2.0, aureole_warp = 3.0" in " ".join(function.splitlines()[:2])
    beside = picture.read(tmp_path / "foil.exr")
    np.testing.assert_allclose(beside.pixels[..., :3], surface.rgb(table), rtol=1e-6)
