"""pbrt .dat: radius, distance, index and clear diameter of each surface, no dispersion."""

from typing import Any

from aureole import refuse
from aureole.flare.import_draft import Draft, number


def read(text: str, where: str) -> Draft:
    """Read the text of a lens file of pbrt's realistic camera.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        Diameters are halved; the stop has index 0; glass does not disperse.

    Raises
    ------
    aureole.refuse.Refusal
        Where a line has not four numbers.
    """
    draft = Draft(title="", source="A pbrt lens file.")
    rows: list[list[float]] = []
    for line, raw in enumerate(text.splitlines(), 1):
        body, _, comment = raw.partition("#")
        words = body.split()
        if not words:
            # The first comment with words says what it is.
            draft.title = draft.title or " ".join(comment.split())[:120]
            continue
        if len(words) != 4:
            raise refuse.Refusal(f"'{where}' line {line}: a surface needs four numbers, got {len(words)}.")
        rows.append([number(word, where, line) for word in words])
    if rows and rows[0][1] == 0 and rows[-1][1] != 0:
        # Some files give the distance in front of each surface.
        gaps = [row[1] for row in rows[1:]]
        rows = [[row[0], gap, *row[2:]] for row, gap in zip(rows, [*gaps, 0.0], strict=True)]
        draft.notes.append("distances stand before their surfaces in the file")
    draft.surfaces = [_surface(row) for row in rows]
    draft.notes.append("the fourth column holds diameters: semi-apertures are half of it")
    draft.notes.append("the file has no Abbe numbers: its glass does not disperse")
    return draft


def _surface(row: list[float]) -> dict[str, Any]:
    radius, distance, index, diameter = row
    found: dict[str, Any] = {
        "radius_mm": radius,
        "thickness_mm": distance,
        "semi_aperture_mm": diameter / 2,
    }
    if index == 0 or (radius == 0 and index == 1):
        return found | {"stop": True}
    return found if index == 1 else found | {"index": index}
