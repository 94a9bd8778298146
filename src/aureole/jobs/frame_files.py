"""Numbered files: names with #### for the frame's number, and lists of frames such as 1-100x2."""

import re
from collections.abc import Iterable
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


def of(path: Path, number: int) -> Path:
    """Return a frame's own file where each has one, or the one that serves all.

    Parameters
    ----------
    path : Path
        With or without a place for the number.
    number : int
        The frame's.

    Returns
    -------
    Path
        A file's.
    """
    return frame(path, number) if is_pattern(path) else path


def own(path: Path | None, number: int) -> tuple[Path, ...]:
    """Return the file that belongs to one frame alone.

    Parameters
    ----------
    path : Path, optional
        With or without a place for the number.
    number : int
        The frame's.

    Returns
    -------
    tuple of Path
        One, or none where one file serves all frames.
    """
    return () if path is None or not is_pattern(path) else (frame(path, number),)


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
        ours = header is not None and _says(header, words)
    except refuse.Refusal:
        ours = False
    if not ours:
        raise refuse.Refusal(f"'{path}' is there and is no {what} of this job; --overwrite replaces it.")
    return True


def lies_whole(path: Path, words: str) -> bool:
    """Return whether a frame of this job lies there and can be read to its end.

    Parameters
    ----------
    path : Path
        The frame's file.
    words : str
        What the file says of itself where it is this job's.

    Returns
    -------
    bool
        Whether it need not be made again.
    """
    if not path.exists():
        return False
    try:
        header = picture.header_of(picture.read(path))
    except refuse.Refusal:
        return False
    return header is not None and _says(header, words)


def refuse_strangers(paths: Iterable[tuple[Path, str]]) -> None:
    """Refuse, before any work, to replace files that are not of this job, from their headers alone.

    Parameters
    ----------
    paths : iterable of (Path, str)
        Each frame's file, and what it says of itself where it is this job's.

    Raises
    ------
    refuse.Refusal
        Where another file lies at a frame's place, or the place cannot be written.
    """
    for path, words in paths:
        picture.writable(path)
        if not path.exists():
            continue
        try:
            ours = _says(picture.describe(path), words)
        except refuse.Refusal:
            ours = False
        if not ours:
            raise refuse.Refusal(f"'{path}' is there and is no frame of this job; --overwrite replaces it.")


def found(pattern: Path) -> tuple[int, ...]:
    """Return the numbers of the frames that lie there.

    Parameters
    ----------
    pattern : Path
        With one run of # in its name: so many digits at least.

    Returns
    -------
    tuple of int
        Rising.

    Raises
    ------
    refuse.Refusal
        Where the name has several runs of #, the folder cannot be read, or no frame lies there.
    """
    frame(pattern, 0)
    before, after = _MARK.split(pattern.name)
    shape = re.compile(re.escape(before) + r"(\d+)" + re.escape(after))
    try:
        names = [entry.name for entry in pattern.parent.iterdir()]
    except OSError:
        raise refuse.Refusal(f"the folder '{pattern.parent}' of the frames cannot be read.") from None
    matches = [match for match in map(shape.fullmatch, names) if match is not None]
    # A number with too many or too few digits is another sequence's.
    there = {int(match[1]) for match in matches if frame(pattern, int(match[1])).name == match[0]}
    if not there:
        raise refuse.Refusal(f"no frame of '{pattern}' is there.")
    return tuple(sorted(there))


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
    listed: set[int] = set()
    for part in text.replace(" ", "").split(","):
        match = _RANGE.fullmatch(part)
        first, last, step = (0, -1, 0) if match is None else _range(match)
        if last < first or step < 1 or last > MOST:
            raise refuse.Refusal(f"'{name}' must be frames such as 1-100, 1-100x2 or 3,7,9, got '{text}'.")
        listed.update(range(first, last + 1, step))
    return tuple(sorted(listed))


def _says(header: picture.Header, words: str) -> bool:
    said = header.attributes.get("ImageDescription")
    return said is not None and said.value == words


def _range(match: re.Match[str]) -> tuple[int, int, int]:
    first = int(match[1])
    return first, int(match[2] or first), int(match[3] or 1)
