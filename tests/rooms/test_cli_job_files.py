"""Job files: what is typed is what is saved, what is saved is what is run, and what is typed comes first."""

import json
import re
import tomllib

import numpy as np
import pytest
from typer.main import get_command

from aureole import Picture, picture, presets
from aureole.cli.app import app
from aureole.cli.job_commands import command_name, commands
from aureole.cli.job_files import to_toml
from aureole.cli.main import run

ROOT = get_command(app)
TABLE = dict(commands(ROOT))
# Text that a TOML file must not change, a number of each kind, a choice of a few words.
AWKWARD = 'a "b" \\ = #\t-5deg 3µm'
CANDIDATES = (AWKWARD, "1e-07", "7", "zero")
NAME = "-an odd name.exr"
KERNEL = "starburst --f-number 16 --blades 6 --size 33 --pixel-pitch 20um -o one.exr"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Stand in an empty folder, as a person does who types short names."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def lamp(here):
    """A small picture with one lamp."""
    pixels = np.zeros((24, 32, 3), dtype=np.float32)
    pixels[12, 16] = (90, 60, 20)
    picture.write(here / "lamp.exr", Picture(pixels))
    return here


def refused(words, capsys):
    """Run, and return the one line of the refusal."""
    assert run(words if isinstance(words, list) else words.split()) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    return lines[0].removeprefix("aureole: ")


def context(name, words):
    """A command as it stands before it runs."""
    return TABLE[name].make_context(name, list(words), parent=ROOT.make_context("aureole", ["presets"]))


def values(name, words):
    """What a command is given, by its keys."""
    made = context(name, words)
    return {key: made.params[one.name] for key, one in TABLE[name].parameters().items()}


def is_argument(parameter):
    return parameter.param_type_name == "argument"


def accepted(name, option, needed):
    """The first of the candidates that an option takes."""
    for text in CANDIDATES:
        try:
            context(name, [f"{option}={text}", *needed])
        except Exception:
            continue
        return f"{option}={text}"
    raise AssertionError(f"{option} of {name} takes none of the examples")


def everything(name):
    """Words for every flag and argument of a command."""
    parameters = TABLE[name].parameters()
    needed = [f"--{key}=x" for key, one in parameters.items() if not is_argument(one) and one.required]
    names = [NAME, "b.exr"] if any(one.nargs == -1 for one in parameters.values()) else [NAME]
    behind = ["--", *names] if any(is_argument(one) for one in parameters.values()) else []
    words = []
    for key, one in parameters.items():
        if is_argument(one):
            continue
        word = f"--{key}" if one.is_flag else accepted(name, f"--{key}", [*needed, *behind])
        words += [word] * (2 if getattr(one, "multiple", False) else 1)
    return [*words, *behind]


def test_all_commands_have_job_files():
    assert len(TABLE) >= 20
    assert {"glare", "flare", "eye", "starburst", "nearfield", "surface render", "bench eye"} <= set(TABLE)
    for command in TABLE.values():
        assert {"config", "save_config", "without"} <= {one.name for one in command.params}
    # Only the command that runs jobs is none itself.
    assert [name for name in ROOT.commands if name not in {key.split()[0] for key in TABLE}] == ["run"]


@pytest.mark.parametrize("name", sorted(TABLE))
def test_keys_are_unlike_each_other(name):
    command = TABLE[name]
    assert len(command.parameters()) == len(command.params) - 3 - (
        "as_json" in [p.name for p in command.params]
    )


@pytest.mark.parametrize("name", sorted(TABLE))
def test_every_flag_of_every_command_comes_back(name, here):
    words = everything(name)
    before = values(name, words)
    assert all(value not in (None, False, [], ()) for value in before.values())
    (here / "job.toml").write_text(to_toml(name, before, {}), encoding="utf-8")
    after = values(name, ["--config", "job.toml"])
    assert after == before
    assert {key: type(value) for key, value in after.items()} == {
        key: type(value) for key, value in before.items()
    }
    # Written once more it is the same file.
    assert to_toml(name, after, {}) == (here / "job.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted(TABLE))
def test_the_least_of_every_command_comes_back(name, here):
    """With its defaults, which are values of the file then."""
    parameters = TABLE[name].parameters().items()
    needed = [f"--{key}=x" for key, one in parameters if not is_argument(one) and one.required]
    needed += ["x" for _, one in parameters if is_argument(one)]
    before = values(name, needed)
    (here / "job.toml").write_text(to_toml(name, {}, before), encoding="utf-8")
    assert values(name, ["--config", "job.toml"]) == before


@pytest.mark.parametrize("name", presets.names("jobs"))
def test_presets_of_jobs_fit_their_commands(name):
    job = presets.load("jobs", name)
    open_ = {"in": ["night.exr"], "output": ["-o", "out.exr"]}
    needed = [
        word
        for key, words in open_.items()
        if key in TABLE[job.command].parameters() and key not in job.job
        for word in words
    ]
    given = values(job.command, ["--config", name, *needed])
    for key, value in job.job.items():
        assert given[key] in (value, [value], str(value)), key


def test_a_saved_job_makes_the_same_file(here, capsys):
    assert run([*KERNEL.split(), "--save-config", "job.toml", "--json"]) == 0
    said = capsys.readouterr()
    assert said.err.strip() == "note: the job is in job.toml"
    assert json.loads(said.out)["files"] == ["one.exr"]
    first = (here / "one.exr").read_bytes()
    (here / "one.exr").unlink()
    assert run(["run", "job.toml"]) == 0
    assert (here / "one.exr").read_bytes() == first
    assert run(["starburst", "--config", "job.toml", "-o", "two.exr"]) == 0
    assert np.array_equal(picture.read("two.exr").pixels, picture.read("one.exr").pixels)
    capsys.readouterr()


def test_a_saved_job_holds_what_was_chosen_and_the_defaults(here, capsys):
    assert run([*KERNEL.split(), "--save-config", "job.toml"]) == 0
    capsys.readouterr()
    text = (here / "job.toml").read_text(encoding="utf-8")
    chosen, defaults = text.split("# What nobody chose: defaults.\n")
    assert tomllib.loads(chosen) == {
        "command": "starburst",
        "job": {"output": "one.exr", "f-number": 16.0, "pixel-pitch": "20um", "blades": 6, "size": "33"},
    }
    assert tomllib.loads(defaults)["illuminant"] == "E"
    assert tomllib.loads(defaults)["fade"] == 0.25
    assert not {"json", "config", "save-config", "without"} & set(tomllib.loads(text)["job"])


def test_what_is_typed_takes_the_place_of_a_line(here):
    (here / "job.toml").write_text(
        'command = "glare"\n[job]\nin = "no.exr"\noutput = "no.exr"\nf-number = 22\nblades = 5\n'
        'zernike = ["coma-x=40nm"]\n'
    )
    typed = "lamp.exr -o out.exr --blades 9 --zernike astigmatism-x=10nm --f-number 22"
    words = typed.removesuffix("--f-number 22").split()
    assert values("glare", ["--config", "job.toml", *words]) == values("glare", typed.split())
    words = ["--config", "job.toml", "lamp.exr", "-o", "out.exr", "--blades", "9", "--without", "zernike"]
    plain = ["lamp.exr", "-o", "out.exr", "--f-number", "22", "--blades", "9"]
    assert values("glare", words) == values("glare", plain)


def test_a_job_holds_a_sequence_and_goes_on_where_it_stopped(lamp, capsys):
    for number in range(1001, 1005):
        (lamp / f"shot.{number}.exr").write_bytes((lamp / "lamp.exr").read_bytes())
    (lamp / "job.toml").write_text(
        'command = "glare"\n[job]\nf-number = 22\nblades = 5\nkernel-size = "15"\npixel-pitch = "20um"\n'
        'frames = "1001-1002"\nlog = "shot.log"\npixel-type = "half"\n'
    )
    words = "glare shot.####.exr -o out.####.exr --frames 1001-1004x1 --config job.toml --json"
    assert run([*words.split(), "--save-config", "whole.toml"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert [frame["number"] for frame in report["frames"]] == [1001, 1002, 1003, 1004]
    assert len((lamp / "shot.log").read_text().splitlines()) == 4
    # What the file says of camera and kernel is what each frame is made with.
    typed = "glare lamp.exr -o one.exr --f-number 22 --blades 5 --kernel-size 15 --pixel-pitch 20um"
    assert run([*typed.split(), "--pixel-type", "half", "--json"]) == 0
    capsys.readouterr()
    made = picture.read(lamp / "out.1003.exr").pixels
    assert np.array_equal(made, picture.read(lamp / "one.exr").pixels)
    # The whole job from its own file makes what is missing alone.
    (lamp / "out.1002.exr").unlink()
    assert run(["run", "whole.toml", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["frames_done"], report["frames_kept"]) == (1, 3)
    # A shot's own file after the show's: other frames, the rest stays.
    (lamp / "shot.toml").write_text('[job]\nframes = "1004"\noverwrite = true\n')
    assert run(["run", "whole.toml", "--config", "shot.toml", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert [(frame["number"], frame["state"]) for frame in report["frames"]] == [(1004, "done")]


def test_what_is_typed_behind_a_job_is_run(here, capsys):
    (here / "job.toml").write_text(
        'command = "starburst"\n[job]\noutput = "no.exr"\nf-number = 22\nblades = 5\nsize = 33\n'
        'pixel-pitch = "20um"\n'
    )
    words = ["run", "job.toml", "-o", "out.exr", "--blades", "6", "--f-number", "16", "--json"]
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out)["files"] == ["out.exr"]
    assert run(KERNEL.split()) == 0
    assert np.array_equal(picture.read("out.exr").pixels, picture.read("one.exr").pixels)
    capsys.readouterr()


def test_later_files_take_the_place_of_earlier_ones(here):
    (here / "show.toml").write_text("[job]\nf-number = 22\nblades = 5\n")
    (here / "shot.toml").write_text("[job]\nblades = 9\n")
    both = ["--config", "show.toml", "--config", "shot.toml"]
    given = values("starburst", [*both, "-o", "a.exr"])
    assert (given["f-number"], given["blades"]) == (22, 9)
    given = values("starburst", [*both, "-o", "a.exr", "--without", "blades"])
    assert (given["f-number"], given["blades"]) == (22, None)


def test_flags_are_true_or_false(here):
    (here / "job.toml").write_text("[job]\neye = true\nquick = false\n")
    given = values("glare", ["--config", "job.toml", "a.exr", "-o", "b.exr"])
    assert (given["eye"], given["quick"]) == (True, False)
    given = values("glare", ["--config", "job.toml", "a.exr", "-o", "b.exr", "--without", "eye", "--quick"])
    assert (given["eye"], given["quick"]) == (False, True)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("blade = 7", "job in 'job.toml' has no 'blade'. Did you mean 'blades'?"),
        ("f_number = 7", "job in 'job.toml' has no 'f_number'. Did you mean 'f-number'?"),
        ("config = 'a'", "job in 'job.toml' has no 'config'."),
        ("json = true", "job in 'job.toml' has no 'json'."),
        ("blades = 7.5", "'blades' in 'job.toml': "),
        ("blades = 'seven'", "'blades' in 'job.toml': "),
        ("blades = true", "'blades' in 'job.toml' must be text or a number, got true."),
        ("blades = [7]", "'blades' in 'job.toml' must be one value, got a list."),
        ("blades = 2", "'blades' must be an integer >= 3, got 2."),
        ("blades = 1979-05-27", "'blades' in 'job.toml' must be text or a number, got '1979-05-27'."),
        ("f-number = {a = 1}", "'f-number' in 'job.toml' must be text or a number, got a table."),
        ("zernike = [[1]]", "'zernike' in 'job.toml' must be text or a number, got a list."),
        ("eye = 'yes'", "'eye' in 'job.toml' must be true or false, got 'yes'."),
        ("eye = 1", "'eye' in 'job.toml' must be true or false, got '1'."),
        ("focal-length = 50", "'focal-length' needs a unit (m, cm, mm, um or nm), got 50; write 50mm."),
        ("f-number = nan", "'f-number' must be a finite number > 0, got nan."),
        ("nan = 'mend'", "'nan' in 'job.toml': "),
    ],
)
def test_wrong_lines_are_refused(line, message, lamp, capsys):
    (lamp / "job.toml").write_text(f'command = "glare"\n[job]\n{line}\n')
    assert refused("run job.toml lamp.exr -o out.exr --save-config kept.toml", capsys).startswith(message)
    assert sorted(path.name for path in lamp.iterdir()) == ["job.toml", "lamp.exr"]


@pytest.mark.parametrize(
    ("text", "words", "message"),
    [
        (
            'command = "glare"',
            "starburst --config job.toml -o a.exr",
            "'job.toml' is a job of 'aureole glare', ",
        ),
        ('command = "glre"', "run job.toml", "aureole has no 'glre'. Did you mean 'glare'?"),
        ('command = "run"', "run job.toml", "aureole has no 'run'."),
        ("", "run job.toml", "'job.toml' has no 'command', such as command = \"glare\"."),
        ("blades = 7", "run job.toml", "'job.toml' has no 'blades'. Known: command, job, source, title."),
        ("job = 7", "run job.toml", "'job' in 'job.toml': input should be a valid dictionary."),
        ("[job", "run job.toml", "'job.toml' is not TOML: "),
        ("", "run other.toml", "'other.toml' cannot be read: No such file or directory."),
        ("", "run heliar-ghost", "presets/jobs has no 'heliar-ghost'. Did you mean 'heliar-ghosts'?"),
        ("", "glare a.exr -o b.exr --without eye", "The job file has no 'eye'."),
        ("", "run", "Missing argument"),
    ],
)
def test_wrong_files_are_refused(text, words, message, here, capsys):
    (here / "job.toml").write_text(text)
    assert refused(words, capsys).startswith(message)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("job.txt", "'suffix of 'save-config'' must be one of"),
        ("none/job.toml", "'none/job.toml' cannot be written: there is no folder 'none'."),
        ("mine.toml", "'mine.toml' is what 'iris' names; give the job file its own name."),
    ],
)
def test_a_job_file_needs_a_place_of_its_own(place, message, here, capsys):
    (here / "mine.toml").write_text('title = "Mine"\nsource = "Geometry"\nblades = 11\n')
    words = "starburst --iris mine.toml --size 33 --pixel-pitch 20um -o one.exr --save-config"
    assert refused([*words.split(), place], capsys).startswith(message)
    assert [path.name for path in here.iterdir()] == ["mine.toml"]


def test_a_job_file_is_written_over_itself(here, capsys):
    (here / "job.toml").write_text("[job]\nblades = 6\nf-number = 16\nsize = 33\npixel-pitch = '20um'\n")
    words = "starburst --config job.toml --blades 5 -o a.exr --save-config job.toml"
    assert run(words.split()) == 0
    assert tomllib.loads((here / "job.toml").read_text())["job"]["blades"] == 5
    capsys.readouterr()


def test_the_commands_name_is_that_of_the_command_line():
    made = context("surface render", ["cd", "-o", "a.png"])
    assert command_name(made) == "surface render"


def test_help_teaches_job_files_and_reads_none(capsys):
    for words in (["glare", "--config", "no.toml", "--help"], ["run", "heliar-ghosts", "--help"]):
        assert run(words) == 0
        said = re.sub(r"\s+", " ", capsys.readouterr().out)
        assert "--save-config" in said
        assert "--without" in said
