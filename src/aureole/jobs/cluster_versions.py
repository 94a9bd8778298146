"""What a machine has that frames depend on: Aureole itself, to the letter, and what it stands on."""

import functools
import hashlib
import importlib.metadata
import platform
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import aureole

# What a machine makes for itself out of the sources.
COMPILED = (".pyc", ".nbi", ".nbc")
# A requirement's name ends where its version or its condition begins.
_NAME = re.compile(r"[A-Za-z0-9._-]+")


@dataclass(frozen=True)
class Signature:
    """What a machine has.

    Parameters
    ----------
    version : str
        Aureole's.
    source : str
        Ten signs that differ where Aureole's files do.
    others : mapping of str to str
        Python, the processor's kind and the packages that Aureole needs, each with its version.
    """

    version: str
    source: str
    others: Mapping[str, str] = field(default_factory=dict)


@functools.cache
def signature() -> Signature:
    """Return what this machine has.

    Returns
    -------
    Signature
        The same in all processes of one installation.
    """
    return Signature(aureole.__version__, source_digest(Path(aureole.__file__).parent), _others())


def differences(ours: Signature, theirs: Signature) -> tuple[list[str], list[str]]:
    """Compare what two machines have.

    Parameters
    ----------
    ours, theirs : Signature
        What this machine has, and another.

    Returns
    -------
    wrong : list of str
        What they have for which no frame can be trusted to them.
    doubtful : list of str
        What they have by which last digits may differ.
    """
    wrong = []
    if theirs.version != ours.version:
        wrong.append(f"Aureole {theirs.version}, this machine {ours.version}")
    elif theirs.source != ours.source:
        wrong.append(f"other files of Aureole {ours.version} than this machine")
    names = sorted(ours.others.keys() | theirs.others.keys())
    pairs = [(name, theirs.others.get(name, "none"), ours.others.get(name, "none")) for name in names]
    return wrong, [f"{name} {they}, this machine {we}" for name, they, we in pairs if they != we]


def source_digest(folder: Path) -> str:
    """Return a short word for all that lies in a package.

    Parameters
    ----------
    folder : Path
        The package's.

    Returns
    -------
    str
        Ten signs that do not depend on the folder's place, nor on compiled files beside the sources.
    """
    told = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix not in COMPILED:
            told.update(path.relative_to(folder).as_posix().encode())
            told.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return told.hexdigest()[:10]


def _others() -> dict[str, str]:
    found = {"Python": platform.python_version(), "processor": platform.machine()}
    try:
        needed = importlib.metadata.requires("aureole") or []
    except importlib.metadata.PackageNotFoundError:
        return found
    for requirement in needed:
        match = _NAME.match(requirement)
        if match is not None and "extra ==" not in requirement:
            found[match[0].lower()] = _version(match[0])
    return found


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
