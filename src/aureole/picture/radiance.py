"""Words in the header of Radiance pictures (.hdr), which other writers leave out.

The header is lines of text that end with an empty one; lines of the form NAME=value may be anybody's (Ward,
"Real Pixels", Graphics Gems II, 1991, and Radiance's filefmts).
"""

from pathlib import Path

WORDS = b"ImageDescription="
# A header that is longer is none.
LONGEST = 1 << 16


def set_words(path: Path, words: str) -> None:
    """Put words into a file's header.

    Parameters
    ----------
    path : Path
        The file.
    words : str
        One line; ends of lines become blanks.
    """
    held = path.read_bytes()
    end = held.index(b"\n\n") + 1
    line = WORDS + " ".join(words.split()).encode() + b"\n"
    path.write_bytes(held[:end] + line + held[end:])


def words_of(path: Path) -> str | None:
    """Return the words in a file's header.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    str or None
        None where there are none.
    """
    with path.open("rb") as file:
        header = file.read(LONGEST).partition(b"\n\n")[0]
    lines = [line for line in header.split(b"\n") if line.startswith(WORDS)]
    return lines[-1].removeprefix(WORDS).decode("utf-8", "replace") if lines else None
