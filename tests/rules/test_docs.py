"""What the manual says exists: commands parse, links lead somewhere, sources are cited where it is said."""

import pathlib
import re
import shlex
from typing import Any

import pytest
from typer.main import get_command

import aureole
from aureole import presets
from aureole.cli import job_commands
from aureole.cli.app import app

ROOT = pathlib.Path(__file__).parents[2]
SOURCE = pathlib.Path(aureole.__file__).parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
LARGEST_PICTURE = 300_000


def shell_lines(text: str) -> list[str]:
    """Every line of the fences marked sh, lines that end in a backslash joined with the next."""
    blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    return [line.strip() for block in blocks for line in block.replace("\\\n", " ").splitlines()]


def commands() -> list[str]:
    lines = [line for page in PAGES for line in shell_lines(page.read_text(encoding="utf-8"))]
    return [line for line in lines if line.startswith("aureole ")]


def parse(line: str) -> None:
    """Parse a command as the shell would hand it over, without running it."""
    # A # within a word is part of it, as in shot.####.exr.
    command, words = get_command(app), shlex.split(re.sub(r"\s#.*", "", line))
    context = command.make_context(words[0], words[1:])
    while hasattr(command, "resolve_command"):
        # A group keeps its own options; the first word that is left names the command.
        words = [*context._protected_args, *context.args]
        name, command, words = command.resolve_command(context, words)
        context = command.make_context(name, list(words), parent=context)
    if command.name == "run":
        parse_job(context)


def parse_job(context: Any) -> None:
    """Parse the command that a job file names, with the file and the words after it."""
    file, root = context.params["job"], context.find_root()
    name = presets.load("jobs", file).command
    dict(job_commands.commands(root.command))[name].make_context(
        name, ["--config", file, *context.args], parent=root
    )


def links() -> list[tuple[pathlib.Path, str]]:
    """Every link and picture that leads to a file of ours."""
    found = []
    for page in [*PAGES, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        targets = re.findall(r"\]\(([^)\s#]+)[^)]*\)", text)
        found += [(page, target) for target in targets if "://" not in target]
    return found


def job_files() -> list[tuple[str, str]]:
    """Every job file that a page shows: a fence marked toml, whose first line is a comment with its name."""
    shown = [page.read_text(encoding="utf-8") for page in PAGES]
    return [
        found
        for text in shown
        for found in re.findall(r"^```toml\n# (\S+\.toml)\n(.*?)^```", text, re.M | re.S)
    ]


@pytest.fixture
def manuals_files(tmp_path, monkeypatch):
    """Stand in a folder with the job files of the manual."""
    monkeypatch.chdir(tmp_path)
    for name, text in job_files():
        assert not (tmp_path / name).exists() or (tmp_path / name).read_text(encoding="utf-8") == text, name
        (tmp_path / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize("line", commands())
@pytest.mark.usefixtures("manuals_files")
def test_commands_of_the_manual_parse(line):
    parse(line)


def test_the_manual_has_commands():
    assert len(commands()) > 15


@pytest.mark.parametrize(
    "line", ["aureole starburst --dusts 10% -o a.exr", "aureole star", "aureole glare a.exr"]
)
def test_the_rule_sees_a_wrong_command(line):
    with pytest.raises(Exception, match=r"[Nn]o such|[Mm]issing"):
        parse(line)


def test_links_lead_to_files():
    lost = [f"{page.name}: {target}" for page, target in links() if not (page.parent / target).exists()]
    assert not lost, lost
    assert len(links()) > 15


def test_pictures_are_small_and_each_is_shown():
    shown = {(page.parent / target).resolve() for page, target in links()}
    for path in sorted((ROOT / "docs" / "pictures").iterdir()):
        assert path.resolve() in shown, f"{path.name} is on no page"
        assert path.name == "demo.jpg" or path.stat().st_size < LARGEST_PICTURE, path.name


@pytest.mark.parametrize(
    ("page", "script"),
    [
        ("far-field", "figures"),
        ("near-field", "near_figures"),
        ("flare", "flare_figures"),
        ("eye", "eye_figures"),
        ("surface", "surface_figures"),
        ("sequences", "sequence_figures"),
    ],
)
def test_each_picture_of_a_page_is_made_by_its_script(page, script):
    """Loops write some of them: over methods, over Fresnel numbers."""
    made = (ROOT / "docs" / f"{script}.sh").read_text(encoding="utf-8")
    # Scripts that it calls are part of it.
    for called in re.findall(r"sh (docs/\w+\.sh)", made):
        made += (ROOT / called).read_text(encoding="utf-8")
    looped = r"spectrum-(scaled|batch|coherence)\.jpg|near-(1|5|30|200)\.jpg"
    for name in re.findall(
        r"\(pictures/([\w.-]+)\)", (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    ):
        assert name in made or re.fullmatch(looped, name), name


def entries() -> list[dict[str, str]]:
    text = (ROOT / "docs" / "references.bib").read_text(encoding="utf-8")
    blocks = re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", text, flags=re.DOTALL | re.MULTILINE)
    field = re.compile(r"(\w+) = \{((?:[^{}]|\{[^{}]*\})*)\}")
    return [{"key": key} | dict(field.findall(body)) for key, body in blocks]


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry["key"])
def test_sources_are_cited_where_the_list_says(entry):
    text = (SOURCE / entry["usedin"]).read_text(encoding="utf-8")
    word = entry.get("number", "") if "institution" in entry else entry["author"].split(",")[0]
    assert word in text, f"{entry['usedin']} does not name {word}"


def test_targets_of_make_exist():
    made = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    said = {
        word for page in PAGES for word in re.findall(r"`make (\w+)`|^ *make (\w+)", page.read_text(), re.M)
    }
    assert {one or other for one, other in said} <= made
