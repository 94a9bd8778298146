"""Text as TOML writes it."""

import json


def toml_text(word: str) -> str:
    """Return text between quotes, as a TOML file holds it.

    Parameters
    ----------
    word : str
        Any text.

    Returns
    -------
    str
        What `tomllib` reads as the same text.
    """
    # Strings of TOML and of JSON have the same escapes.
    return json.dumps(word, ensure_ascii=False).replace("\x7f", "\\u007f")
