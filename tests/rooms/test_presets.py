"""Presets: every shipped one loads and says its source; files of one's own, hostile ones refused."""

import re
from importlib import resources

import pytest
from pydantic import ValidationError

from aureole import presets, refuse

SHIPPED = [(kind, name) for kind in presets.KINDS for name in presets.names(kind)]
IRIS = 'title = "Mine"\nsource = "Geometry"\n'
CAMERA = IRIS + (
    "focal_length_mm = 50\nf_number = 16\nsensor_width_mm = 36\nsensor_height_mm = 24\n"
    'columns = 1920\nrows = 1280\niris = "heptagon"\n'
)


@pytest.fixture
def file_of(tmp_path):
    """Write a preset file and return its path."""

    def write(content, name="mine.toml"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    return write


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_shipped_presets_load(kind, name):
    preset = presets.load(kind, name)
    assert isinstance(preset, presets.KINDS[kind])
    assert len(preset.title) >= 5
    assert len(preset.source) >= 20


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_names_are_lower_case_words_joined_by_hyphens_or_lines(kind, name):
    assert re.fullmatch(r"[a-z0-9]+([-_][a-z0-9]+)*", name)


@pytest.mark.parametrize("kind", list(presets.KINDS))
def test_names_are_the_files_of_the_folder(kind):
    folder = resources.files("aureole.presets") / kind
    assert presets.names(kind) == sorted(entry.name[:-5] for entry in folder.iterdir())
    assert len(presets.names(kind)) >= 3


@pytest.mark.parametrize("name", presets.names("cameras"))
def test_a_camera_has_an_iris_that_ships_and_square_pixels(name):
    camera = presets.load("cameras", name)
    assert camera.iris in presets.names("irises")
    pitch_x = camera.sensor_width_mm / camera.columns
    pitch_y = camera.sensor_height_mm / camera.rows
    assert pitch_x == pytest.approx(pitch_y, rel=3e-3)
    # Its name says its focal length and f-number.
    assert f"-{camera.focal_length_mm:g}mm-f{camera.f_number:g}" in name


@pytest.mark.parametrize(
    ("name", "blades"), [("pentagon", 5), ("hexagon", 6), ("heptagon", 7), ("octagon", 8), ("nonagon", 9)]
)
def test_an_iris_has_the_blades_of_its_name(name, blades):
    iris = presets.load("irises", name)
    streaks = blades if blades % 2 == 0 else 2 * blades
    assert (iris.shape, iris.blades, iris.curvature) == ("iris", blades, 0.0)
    assert iris.title.startswith(f"{blades} ")
    assert f" {streaks} streaks" in iris.source


def test_a_file_of_ones_own(file_of):
    iris = presets.load("irises", file_of(IRIS + "blades = 11\ncurvature = 1\nrotation_deg = -12.5\n"))
    assert (iris.blades, iris.curvature, iris.rotation_deg, iris.obstruction) == (11, 1.0, -12.5, 0.0)
    camera = presets.load("cameras", file_of(CAMERA))
    assert (camera.focal_length_mm, camera.columns, camera.iris) == (50.0, 1920, "heptagon")


def test_presets_are_frozen():
    iris = presets.load("irises", "heptagon")
    with pytest.raises(ValidationError, match="frozen"):
        iris.blades = 8


def test_an_unknown_name_is_refused_with_the_nearest():
    with refused("presets/irises has no 'heptagn'. Did you mean 'heptagon'?"):
        presets.load("irises", "heptagn")
    with refused(f"presets/cameras has no '35'. Known: {', '.join(presets.names('cameras'))}."):
        presets.load("cameras", "35")


def test_names_lead_to_no_other_folder():
    with pytest.raises(refuse.Refusal, match=r"^presets/cameras has no '\.\./irises/circle'\."):
        presets.load("cameras", "../irises/circle")


def test_an_unknown_kind_is_refused():
    for ask in (presets.names, lambda kind: presets.load(kind, "circle")):
        with refused(
            "'kind' must be one of 'cameras', 'eyes', 'glasses', 'gratings', 'irises', 'jobs', 'lenses', "
            "'scenes', "
            "got 'iris'. Did you mean 'irises'?"
        ):
            ask("iris")


def test_an_unknown_key_is_refused_with_the_nearest(file_of):
    path = file_of(IRIS + "blade = 7\n")
    with refused(f"'{path}' has no 'blade'. Did you mean 'blades'?"):
        presets.load("irises", path)
    path = file_of(IRIS + "qqq = 7\n")
    with refused(
        f"'{path}' has no 'qqq'. Known: blades, curvature, obstruction, rotation_deg, shape, source, title."
    ):
        presets.load("irises", path)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('blades = "seven"', "'blades' in '{}': input should be a valid integer."),
        ('blades = "7"', "'blades' in '{}': input should be a valid integer."),
        ("blades = 7.5", "'blades' in '{}': input should be a valid integer."),
        ("blades = true", "'blades' in '{}': input should be a valid integer."),
        ("blades = [7]", "'blades' in '{}': input should be a valid integer."),
        ("blades = 2", "'blades' in '{}': input should be greater than or equal to 3."),
        ("blades = 101", "'blades' in '{}': input should be less than or equal to 100."),
        ("curvature = 1.01", "'curvature' in '{}': input should be less than or equal to 1."),
        ("curvature = nan", "'curvature' in '{}': input should be less than or equal to 1."),
        ("obstruction = 1", "'obstruction' in '{}': input should be less than 1."),
        ("rotation_deg = inf", "'rotation_deg' in '{}': input should be less than or equal to 360."),
        ('shape = "ellipse"', "'shape' in '{}': string should match pattern '^(circle|iris)$'."),
        ("[blades]\na = 1", "'blades' in '{}': input should be a valid integer."),
    ],
)
def test_wrong_values_are_refused(file_of, line, message):
    path = file_of(IRIS + line + "\n")
    with refused(message.format(path)):
        presets.load("irises", path)


@pytest.mark.parametrize(
    ("find", "put", "message"),
    [
        ("f_number = 16", "f_number = 0", "'f_number' in '{}': input should be greater than 0."),
        ("f_number = 16", "f_number = inf", "'f_number' in '{}': input should be a finite number."),
        ("f_number = 16", "f_number = nan", "'f_number' in '{}': input should be a finite number."),
        ("f_number = 16", 'f_number = "16"', "'f_number' in '{}': input should be a valid number."),
        ("rows = 1280", "rows = 0", "'rows' in '{}': input should be greater than or equal to 1."),
        ("rows = 1280", "", "'rows' in '{}': field required."),
        ('iris = "heptagon"', "iris = 7", "'iris' in '{}': input should be a valid string."),
    ],
)
def test_wrong_cameras_are_refused(file_of, find, put, message):
    path = file_of(CAMERA.replace(find, put))
    with refused(message.format(path)):
        presets.load("cameras", path)


def test_a_preset_needs_its_source(file_of):
    path = file_of('title = "Mine"\n')
    with refused(f"'source' in '{path}': field required."):
        presets.load("irises", path)


@pytest.mark.parametrize("text", ["a ==", "[", "a = 1\na = 2", "title = 'no end", "\x00"])
def test_what_is_not_toml_is_refused(file_of, text):
    path = file_of(text)
    with pytest.raises(refuse.Refusal, match=f"^'{re.escape(path)}' is not TOML: [^\n]*$"):
        presets.load("irises", path)


def test_nesting_without_end_is_refused(file_of):
    path = file_of("title = " + "[" * 20000)
    with pytest.raises(refuse.Refusal, match=r"nested too deeply|is not TOML"):
        presets.load("irises", path)


def test_files_that_cannot_be_read_are_refused(file_of, tmp_path):
    missing = str(tmp_path / "missing.toml")
    with refused(f"'{missing}' cannot be read: No such file or directory."):
        presets.load("irises", missing)
    folder = tmp_path / "folder.toml"
    folder.mkdir()
    with pytest.raises(refuse.Refusal, match="cannot be read: "):
        presets.load("irises", str(folder))
    with pytest.raises(refuse.Refusal, match="cannot be read: 'utf-8' codec"):
        presets.load("irises", file_of(b"title = '\xff\xfe'"))
    with pytest.raises(refuse.Refusal, match="cannot be read: "):
        presets.load("irises", "nul\x00.toml")
