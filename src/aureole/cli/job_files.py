"""Job files: flags read from TOML and written to it.

A line of a file is worth what its flag is worth when it is typed: its value becomes words of the command
line, so there is one way to read and to refuse them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from aureole import __version__, presets, refuse


@dataclass(frozen=True)
class Line:
    """A line of a job file.

    Parameters
    ----------
    value : object
        As TOML holds it.
    file : str
        Where it stands.
    """

    value: Any
    file: str


def key_of(parameter: Any) -> str:
    """Return a flag's name in a job file: without dashes; an argument's is in lower case.

    Parameters
    ----------
    parameter : Parameter
        A command's.

    Returns
    -------
    str
        Such as "f-number" or "in".
    """
    if _is_argument(parameter):
        return str(parameter.metavar or parameter.name).lower().rstrip(".")
    return str(max(parameter.opts, key=len)).lstrip("-")


def read(files: Sequence[str], without: Sequence[str], command: str, keys: Sequence[str]) -> dict[str, Line]:
    """Read job files for a command.

    Parameters
    ----------
    files : sequence of str
        Presets' names or files; later ones take the place of earlier ones, line by line.
    without : sequence of str
        Keys to leave out.
    command : str
        The command's name.
    keys : sequence of str
        What the command knows.

    Returns
    -------
    dict of str to Line
        The lines by key.

    Raises
    ------
    refuse.Refusal
        Where a file cannot be read, is another command's, or has a key that the command does not know.
    """
    lines: dict[str, Line] = {}
    for name in files:
        found = presets.load("jobs", name)
        if found.command not in ("", command):
            raise refuse.Refusal(
                f"'{name}' is a job of 'aureole {found.command}', not of 'aureole {command}'."
            )
        for key, value in found.job.items():
            if key not in keys:
                raise refuse.unknown_key(f"job in '{name}'", key, keys)
            lines[key] = Line(value, name)
    for key in without:
        if key not in lines:
            raise refuse.unknown_key("The job file", key, lines)
    return {key: line for key, line in lines.items() if key not in without}


def words(
    lines: Mapping[str, Line], parameters: Mapping[str, Any], typed: Mapping[str, Any]
) -> tuple[list[str], list[str]]:
    """Return what job files add to what was typed, as it would be typed.

    Parameters
    ----------
    lines : mapping
        Lines by key.
    parameters : mapping
        The command's parameters by key.
    typed : mapping
        What was typed, by the parameters' names.

    Returns
    -------
    tuple of list of str
        Options, and arguments.

    Raises
    ------
    refuse.Refusal
        Where a value cannot be typed.
    """
    options: list[str] = []
    arguments: list[str] = []
    for key, line in lines.items():
        found = _words(key, line, parameters[key])
        if not is_given(typed.get(parameters[key].name)):
            (arguments if _is_argument(parameters[key]) else options).extend(found)
    return options, arguments


def is_given(value: Any) -> bool:
    """Return whether a word was typed for a parameter.

    Parameters
    ----------
    value : object
        What the command line's parser found; its versions have several ways to say nothing.

    Returns
    -------
    bool
        True for text, a flag that is set, and lists that are not empty.
    """
    return isinstance(value, str | bool) or (isinstance(value, list | tuple) and len(value) > 0)


def to_toml(command: str, chosen: Mapping[str, Any], defaults: Mapping[str, Any]) -> str:
    """Return a job file's text.

    Parameters
    ----------
    command : str
        The command's name.
    chosen, defaults : mapping
        Values by key: those that were given, and the others. What says nothing is left out.

    Returns
    -------
    str
        What `read` reads.
    """
    lines = [
        f"# A job of Aureole {__version__}, for `aureole run`; flags that are typed come before these.",
        f"command = {presets.toml_text(command)}",
        "",
        "[job]",
        *_toml_lines(chosen),
    ]
    others = _toml_lines(defaults)
    if others:
        lines += ["", "# What nobody chose: defaults.", *others]
    return "\n".join(lines) + "\n"


def _words(key: str, line: Line, parameter: Any) -> list[str]:
    """Return a line as it would be typed."""
    where, value = f"'{key}' in '{line.file}'", line.value
    if not _is_argument(parameter) and parameter.is_flag:
        if not isinstance(value, bool):
            raise refuse.Refusal(f"{where} must be true or false, got {_shown(value)}.")
        return [f"--{key}"] if value else []
    many = parameter.nargs == -1 or getattr(parameter, "multiple", False)
    if isinstance(value, list) and not many:
        raise refuse.Refusal(f"{where} must be one value, got a list.")
    values = value if isinstance(value, list) else [value]
    for part in values:
        if isinstance(part, bool) or not isinstance(part, str | int | float):
            raise refuse.Refusal(f"{where} must be text or a number, got {_shown(part)}.")
    return [str(part) if _is_argument(parameter) else f"--{key}={part}" for part in values]


def _toml_lines(values: Mapping[str, Any]) -> list[str]:
    silent = (None, False)
    said = {key: value for key, value in values.items() if not any(value is word for word in silent)}
    return [f"{key} = {_toml(value)}" for key, value in said.items() if value not in ([], ())]


def _toml(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(_toml(part) for part in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, int | float) else presets.toml_text(_utf8(str(value)))


def _utf8(text: str) -> str:
    """Refuse a file's name that no text file can hold."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise refuse.Refusal(f"{text!r} cannot stand in a job file: it is not UTF-8.") from None
    return text


def _shown(value: Any) -> str:
    if isinstance(value, dict | list):
        return "a table" if isinstance(value, dict) else "a list"
    return str(value).lower() if isinstance(value, bool) else f"'{value}'"


def _is_argument(parameter: Any) -> bool:
    return bool(parameter.param_type_name == "argument")
