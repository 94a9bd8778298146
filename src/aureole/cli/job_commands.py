"""Commands with job files: `--config`, `--save-config` and `--without` for each, and `aureole run`."""

import contextlib
import functools
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from aureole import picture, presets, refuse
from aureole.cli import output
from aureole.cli.job_files import Line, is_given, key_of, read, to_toml, words
from aureole.cli.pupil_options import with_flags

JOB_FILES = "Job files"
SUFFIX = ".toml"
# What says how a command is used, not what it makes.
NO_PART = ("config", "save-config", "without", "json")


@dataclass(frozen=True)
class JobFileFlags:
    """The flags of job files; each field's option teaches its use.

    Parameters
    ----------
    config, without : list of str
        Files to read, and lines to leave out.
    save_config : Path, optional
        File to write.
    """

    config: Annotated[
        list[str] | None,
        typer.Option(
            "--config",
            help="Read flags from a job file (TOML), or from a preset of `aureole presets`. What is typed "
            "takes the place of the file's line; so do files that come later.",
            rich_help_panel=JOB_FILES,
        ),
    ] = None
    without: Annotated[
        list[str] | None,
        typer.Option(
            "--without", help="Leave this line of the job file out; repeat it.", rich_help_panel=JOB_FILES
        ),
    ] = None
    save_config: Annotated[
        Path | None,
        typer.Option(
            "--save-config",
            help="Also write all flags of this run, defaults too, as a job file for --config and "
            "`aureole run`: TOML.",
            rich_help_panel=JOB_FILES,
        ),
    ] = None


class JobCommand(TyperCommand):
    """A command that reads its flags from job files, too, and writes them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the words of job files before those that were typed."""
        typed, _, _ = self.make_parser(ctx).parse_args(list(args))
        if ctx.resilient_parsing or "help" in typed:
            return super().parse_args(ctx, args)
        parameters = self.parameters()
        files, without = typed.get("config") or (), typed.get("without") or ()
        lines = read(files, without, command_name(ctx), list(parameters))
        options, arguments = words(lines, parameters, typed)
        # Behind two dashes even a name that begins with one is no flag.
        dashes = ["--"] if arguments and "--" not in args else []
        try:
            return super().parse_args(ctx, [*options, *args, *dashes, *arguments])
        except typer.BadParameter as error:
            raise _refusal(error, lines, typed) or error from None

    def invoke(self, ctx: Any) -> Any:
        """Run the command, and write its job file unless it is refused."""
        place = ctx.params.get("save_config")
        text = None if place is None else self._text(ctx, place)
        try:
            return super().invoke(ctx)
        except refuse.Refusal:
            text = None
            raise
        finally:
            if text is not None:
                _write(place, text)

    def parameters(self) -> dict[str, Any]:
        """Return what a job file may hold: the parameters by their keys."""
        found = {key_of(parameter): parameter for parameter in self.params}
        return {key: parameter for key, parameter in found.items() if key not in NO_PART}

    def _text(self, ctx: Any, place: Path) -> str:
        """Return the job file's text, or refuse where it could not be written."""
        refuse.one_of("suffix of 'save-config'", place.suffix.lower(), (SUFFIX,))
        picture.writable(place)
        named = {key: ctx.params[parameter.name] for key, parameter in self.parameters().items()}
        for key, value in named.items():
            values = value if isinstance(value, list | tuple) else [value]
            if any(_same(place, word) for word in values):
                raise refuse.Refusal(f"'{place}' is what '{key}' names; give the job file its own name.")
        chosen = [
            key
            for key, parameter in self.parameters().items()
            if getattr(ctx.get_parameter_source(parameter.name), "name", "") == "COMMANDLINE"
        ]
        return to_toml(
            command_name(ctx),
            {key: value for key, value in named.items() if key in chosen},
            {key: value for key, value in named.items() if key not in chosen},
        )


def teach(app: typer.Typer) -> None:
    """Give all commands of an application their job files.

    Parameters
    ----------
    app : Typer
        With all its commands and groups.
    """
    for info in app.registered_commands:
        assert info.callback is not None
        info.callback, info.cls = _with_files(info.callback), JobCommand
    for group in app.registered_groups:
        if group.typer_instance is not None:
            teach(group.typer_instance)


def run(
    ctx: typer.Context,
    job: Annotated[
        str, typer.Argument(metavar="JOB", help="A job file (TOML), or a preset of `aureole presets`.")
    ],
) -> None:
    """Run a job from its file.

    What --save-config wrote, or a file of your own: the command's name, and its flags without dashes.
    Flags and arguments after the file take the place of its lines; --without KEY leaves a line out.

        command = "glare"

        [job]
        in = "night.exr"
        output = "out.exr"
        f-number = 16
        blades = 7

    Examples:

        aureole run job.toml

        aureole run job.toml --blades 9 -o nine.exr

        aureole run street-at-night night.exr -o seen.exr
    """
    table = dict(commands(ctx.find_root().command))
    name = presets.load("jobs", job).command
    if not name:
        raise refuse.Refusal(f"'{job}' has no 'command', such as command = \"glare\".")
    if name not in table:
        raise refuse.unknown_key("aureole", name, table)
    typed = ["--config", job, *ctx.args]
    with table[name].make_context(name, typed, parent=ctx.find_root()) as made:
        table[name].invoke(made)


def commands(group: Any, before: str = "") -> Iterator[tuple[str, JobCommand]]:
    """Find the commands that read job files.

    Parameters
    ----------
    group : Group
        An application's.
    before : str
        Names of the groups around it.

    Yields
    ------
    tuple of str and JobCommand
        Such as "surface render".
    """
    for name, found in group.commands.items():
        if hasattr(found, "commands"):
            yield from commands(found, f"{before}{name} ")
        elif isinstance(found, JobCommand):
            yield f"{before}{name}", found


def command_name(ctx: Any) -> str:
    """Return a command's name with its groups', as a job file has it.

    Parameters
    ----------
    ctx : Context
        The command's.

    Returns
    -------
    str
        Such as "surface render".
    """
    names = []
    while ctx.parent is not None:
        names.append(str(ctx.info_name))
        ctx = ctx.parent
    return " ".join(reversed(names))


def _with_files(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the flags of job files, which it need not know."""

    @functools.wraps(command)
    def bare(job_files: JobFileFlags, **given: Any) -> None:
        command(**given)

    return with_flags("job_files", JobFileFlags)(bare)


def _write(place: Path, text: str) -> None:
    with picture.whole_file(place) as part:
        part.write_text(text, encoding="utf-8")
    output.say_notes([f"the job is in {place}"])


def _refusal(error: Any, lines: Mapping[str, Line], typed: Mapping[str, Any]) -> refuse.Refusal | None:
    """Return the refusal of a file's value; None where the value was typed."""
    key = "" if error.param is None else key_of(error.param)
    if key not in lines or is_given(typed.get(error.param.name)):
        return None
    message = " ".join(str(error.message).split()).rstrip(".")
    return refuse.Refusal(f"'{key}' in '{lines[key].file}': {message}.")


def _same(place: Path, word: Any) -> bool:
    """Return whether a value of a flag names a file."""
    if not isinstance(word, str | Path):
        return False
    with contextlib.suppress(ValueError):
        return os.path.abspath(word) == os.path.abspath(place)
    return False
