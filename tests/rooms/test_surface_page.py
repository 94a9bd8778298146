"""The page opened in a browser shows what our renderer draws; where it cannot, it says so."""

import dataclasses
import json
import re
import shutil
import subprocess
import urllib.parse

import numpy as np
import pytest

from aureole import picture, refuse, surface

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
INSTALL = "no browser; install it with: apt-get install chromium"
needs_browser = pytest.mark.skipif(BROWSER is None, reason=INSTALL)
ROWS, COLUMNS = 270, 480
WEBGL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
PSNR = 35.0
# Wavelengths in micrometres, and linear colours of about their hue.
BANDS = ((0.44, (0.3, 0.05, 1.6)), (0.48, (0.1, 0.3, 0.6)), (0.54, (0.4, 1.0, 0.02)), (0.6, (1.0, 0.6, 0.0)))

METAL = surface.Material(
    (0.15, 0.1, 0.2), 0.4, 0.25, fresnel=surface.conductor((0.2, 0.9, 1.1), (3.0, 2.4, 2.5))
)
SCREEN = surface.Material((0.05, 0.2, 0.3), 0.2, 0.3, geometry="stam", window=(1.0, 0.5))
LACQUER = surface.Material(0.1, 0.3, 0.3, fresnel=surface.schlick((0.9, 0.7, 0.5)))
NEAR = surface.point_lamp((0.5, 1.2, 4.0), (16.0, 14.0, 11.0))
SUN = surface.distant_lamp((-0.5, 0.3, 1.0), (1.0, 1.1, 1.2))
# Shape, its place and angles, lamp, material, exposure in stops.
OBJECTS = {
    "disc": (surface.Disc(2.0, 0.5), ((0.05, 0.02, 0.0), -0.3, 0.4, 0.3), NEAR, METAL, 0.5),
    "plane": (surface.Plane(2.6, 1.6), ((0.0, 0.0, 0.0), 0.3, 0.5, 0.0), SUN, SCREEN, 0.0),
    "cylinder": (surface.Cylinder(0.9, 1.7, 4.0), ((0.0, 0.0, 0.0), 0.2, 0.2, 0.0), NEAR, LACQUER, 1.5),
}


@pytest.fixture(scope="module")
def table():
    h = surface.table.axis(257, warp=3)
    values = np.zeros((257, 257, 3))
    for wavelength, colour in BANDS:
        for order in range(-3, 4):
            lobe = np.exp(-200.0 * ((h[None, :] - order * wavelength / 1.6) ** 2 + h[::-1, None] ** 2))
            values += 0.04 * lobe[..., None] * np.array(colour)
    return surface.scatter_table(values, (1.0, 1.0, 1.0), warp=3)


def scene_of(name):
    shape, (place, tilt, turn, spin), lamp, material, exposure = OBJECTS[name]
    view = surface.view_from((0.2, 0.1, 3.2), (0.05, 0.0, 0.0), (ROWS, COLUMNS), 0.6)
    return surface.Scene((lamp,), view, surface.pose_of(place, tilt, turn, spin), material), shape, exposure


def browse(folder, url, *flags):
    command = [BROWSER, "--headless=new", "--no-sandbox", "--no-first-run", "--hide-scrollbars"]
    command += [f"--user-data-dir={folder}/profile", "--force-device-scale-factor=1"]
    command += ["--virtual-time-budget=8000", *flags, url]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def screenshot(folder, page):
    state = urllib.parse.quote(json.dumps({"bare": True, "size": [COLUMNS, ROWS]}))
    shot = folder / "shot.png"
    window = f"--window-size={COLUMNS},{ROWS}"
    browse(folder, f"{page.as_uri()}#{state}", *WEBGL, window, f"--screenshot={shot}")
    return picture.encode_srgb(picture.read(shot).pixels[..., :3])


@needs_browser
@pytest.mark.parametrize("name", OBJECTS)
def test_the_page_shows_the_renderer_s_picture(table, tmp_path, name):
    scene, shape, exposure = scene_of(name)
    page = surface.write_page(tmp_path / "page.html", table, surface.web_view(scene, shape, exposure))
    drawn = surface.render(scene, table, shape, samples=2).pixels[..., :3] * np.float32(2.0**exposure)
    wanted = picture.encode_srgb(np.clip(drawn, 0.0, 1.0))
    assert (wanted.max(axis=2) > 0.2).mean() > 0.3, "a dark picture proves little"
    error = np.mean((screenshot(tmp_path, page) - wanted) ** 2)
    assert -10.0 * np.log10(error) >= PSNR


@needs_browser
def test_without_webgl_2_the_page_says_what_it_needs(table, tmp_path):
    page = surface.write_page(tmp_path / "page.html", table)
    shown = browse(tmp_path, page.as_uri(), "--disable-gpu", "--disable-3d-apis", "--dump-dom")
    assert 'data-ready="no"' in shown
    assert "This page needs WebGL 2" in shown.split("<script")[0]


@needs_browser
def test_the_page_finds_an_exposure_of_its_own(table, tmp_path):
    scene, shape, _ = scene_of("disc")
    page = surface.write_page(tmp_path / "page.html", table, surface.web_view(scene, shape))
    shown = browse(tmp_path, page.as_uri(), *WEBGL, "--window-size=320,180", "--dump-dom")
    exposure = float(re.search(r'data-exposure="([-\d.]+)"', shown).group(1))
    drawn = surface.render(scene, table, shape).pixels
    bright = (drawn[..., :3] * 2.0**exposure).max(axis=2)[drawn[..., 3] > 0]
    mean, burnt = picture.encode_srgb(np.clip(bright, 0.0, 1.0)).mean(), (bright >= 1.0).mean()
    assert 0.1 < mean < 0.45
    assert burnt < 0.015
    assert mean > 0.4 or burnt > 0.006


def test_a_page_refuses_what_it_cannot_show(table):
    scene, shape, _ = scene_of("disc")
    for lamps in ((), (NEAR, SUN), surface.area_lamp((0, 0, 1), (0.1, 0, 0), (0, 0.1, 0), samples=(1, 1))):
        with pytest.raises(refuse.Refusal, match="'lamps' must be one lamp"):
            surface.web_view(dataclasses.replace(scene, lamps=lamps), shape)
    with pytest.raises(refuse.Refusal, match="neither 'mask' nor 'regions'"):
        surface.web_view(dataclasses.replace(scene, mask=np.ones((2, 2))), shape)
    with pytest.raises(refuse.Refusal, match="'shape' must be a Plane, Disc or Cylinder"):
        surface.web_view(scene, surface.mesh_of(np.eye(3), [[0, 1, 2]]))
