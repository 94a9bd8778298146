"""Lens files of other programs, chosen by their suffix."""

import codecs
import os
from pathlib import Path

from aureole import refuse
from aureole.flare import (
    import_code_v,
    import_flaresim,
    import_openlensflare,
    import_pbrt,
    import_realflare,
    import_zemax,
)
from aureole.flare.import_draft import finish
from aureole.flare.prescription import Lens, load

READERS = {
    ".zmx": import_zemax.read,
    ".seq": import_code_v.read,
    ".xml": import_openlensflare.read,
    ".json": import_realflare.read,
    ".lens": import_flaresim.read,
    ".dat": import_pbrt.read,
}
LARGEST_FILE = 5_000_000


def import_lens(path: str | os.PathLike[str]) -> tuple[Lens, list[str]]:
    """Read a lens file of another program.

    Parameters
    ----------
    path : path_like
        Its suffix says the format: .zmx (Zemax), .seq (CODE V), .xml (OpenLensFlare), .json (realflare),
        .lens (FlareSim) or .dat (pbrt).

    Returns
    -------
    lens : Lens
        Checked, in metres.
    notes : list of str
        What was converted and what was added, a line each.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read or is no lens.
    """
    place = Path(path)
    suffix = refuse.one_of("suffix of the lens file", place.suffix.lower(), READERS)
    draft = READERS[suffix](_text(place), str(place))
    draft.title = draft.title or place.stem
    return finish(draft, str(place)), draft.notes


def open_lens(name: str | os.PathLike[str], state: str | None = None) -> tuple[Lens, list[str]]:
    """Return a lens by its name, from TOML, or from another program's file.

    Parameters
    ----------
    name : str or path_like
        A shipped lens's name or a file.
    state : str, optional
        One of a zoom's positions.

    Returns
    -------
    lens : Lens
        Checked.
    notes : list of str
        What was converted; empty for our own files.

    Raises
    ------
    refuse.Refusal
        Where there is no such lens, or the file is none.
    """
    if Path(name).suffix.lower() in READERS:
        lens, notes = import_lens(name)
        if state is not None:
            raise refuse.Refusal(f"'{name}' has no positions of a zoom.")
        return lens, notes
    return load(name, state), []


def _text(place: Path) -> str:
    try:
        with place.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise refuse.Refusal(f"'{place}' cannot be read: {reason}.") from None
    if len(data) > LARGEST_FILE:
        raise refuse.Refusal(f"'{place}' is larger than {LARGEST_FILE // 10**6} MB: no lens file is.")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")
