"""Numbered files: names with #### for the frame's number, and lists of frames such as 1-100x2."""

import re
from pathlib import Path

from aureole import picture, refuse

_MARK = re.compile(r"#+")
_RANGE = re.compile(r"(\d+)(?:-(\d+)(?:x(\d+))?)?")
# More frames than this are a slip of the finger.
MOST = 1_000_000


def is_pattern(path: Path) -> bool:
    """Return whether a file's name has a place for the number.

    Parameters
    ----------
    path : Path
        Such as ring.####.exr.

    Returns
    -------
    bool
        Whether it has one.
    """
    return _MARK.search(path.name) is not None


def frame(pattern: Path, number: int) -> Path:
    """Return the file of a frame.

    Parameters
    ----------
    pattern : Path
        With one run of # in its name: so many digits at least.
    number : int
        The frame's.

    Returns
    -------
    Path
        Such as ring.0007.exr.

    Raises
    ------
    refuse.Refusal
        Where the name has several runs of #.
    """
    if len(_MARK.findall(pattern.name)) != 1:
        raise refuse.Refusal(f"'{pattern}' must have one run of # for the frame's number, as ring.####.exr.")
    return pattern.with_name(_MARK.sub(lambda mark: f"{number:0{len(mark[0])}d}", pattern.name))


def is_there(path: Path, words: str, overwrite: bool, what: str = "frame") -> bool:
    """Return whether a frame lies there whole; refuse one of another job unless it may be replaced.

    Parameters
    ----------
    path : Path
        The frame's file.
    words : str
        What the file says of itself where it is this job's.
    overwrite : bool
        Whether it may be replaced, whatever it is.
    what : str
        What a frame is, for the refusal.

    Returns
    -------
    bool
        Whether it need not be made again.

    Raises
    ------
    refuse.Refusal
        Where another file lies there, or the place cannot be written.
    """
    picture.writable(path)
    if overwrite or not path.exists():
        return False
    try:
        header = picture.header_of(picture.read(path))
        found = header and header.attributes.get("ImageDescription")
    except refuse.Refusal:
        found = None
    if not found or found.value != words:
        raise refuse.Refusal(f"'{path}' is there and is no {what} of this job; --overwrite replaces it.")
    return True


def numbers(text: str, name: str = "frames") -> tuple[int, ...]:
    """Read a list of frames.

    Parameters
    ----------
    text : str
        Numbers and ranges parted by commas: "1-100", "1-100x2" for each second one, "3,7,10-20".
    name : str
        The flag's name.

    Returns
    -------
    tuple of int
        Rising, each once.

    Raises
    ------
    refuse.Refusal
        Where the text is no such list.
    """
    found: set[int] = set()
    for part in text.replace(" ", "").split(","):
        match = _RANGE.fullmatch(part)
        first, last, step = (0, -1, 0) if match is None else _range(match)
        if last < first or step < 1 or last > MOST:
            raise refuse.Refusal(f"'{name}' must be frames such as 1-100, 1-100x2 or 3,7,9, got '{text}'.")
        found.update(range(first, last + 1, step))
    return tuple(sorted(found))


def _range(match: re.Match[str]) -> tuple[int, int, int]:
    first = int(match[1])
    return first, int(match[2] or first), int(match[3] or 1)
