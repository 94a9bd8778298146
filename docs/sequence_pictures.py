"""Pictures of docs/sequences.md that need more than one command. Run it from the repository's root.

    python docs/sequence_pictures.py shot FOLDER 12
    python docs/sequence_pictures.py stack OUT 480x120+200+260 FILES...
    python docs/sequence_pictures.py row OUT FILES...
    python docs/sequence_pictures.py smaller OUT FILE

`shot` writes the first frames of the page's shot; `stack` lays the same part of several pictures one below
the other, or pictures whole where no part is given (`all`); `row` lays pictures side by side;
`smaller` writes one as a JPEG file of lower quality, for pages.
"""

import sys
from pathlib import Path

import numpy as np
import OpenImageIO

from aureole import Picture, picture

GAP = 4


def shot(folder: str, count: str) -> None:
    """Write frames of a camera that pans over the bundled night."""
    scene = picture.night_scene((540, 1080))
    for k in range(int(count)):
        seen = Picture(scene.pixels[:, 2 * k : 2 * k + 960])
        picture.write(Path(folder) / f"shot.{1001 + k}.exr", seen, pixel_type="half")


def stack(out: str, part: str, *files: str) -> None:
    """Lay pictures one below the other with a thin line between."""
    pictures = [picture.read(name).pixels[..., :3] for name in files]
    if part != "all":
        size, left, top = part.split("+")
        columns, rows = (int(word) for word in size.split("x"))
        x, y = int(left), int(top)
        pictures = [each[y : y + rows, x : x + columns] for each in pictures]
    line = np.ones((GAP, pictures[0].shape[1], 3), dtype=np.float32)
    parts = [part for each in pictures for part in (each, line)][:-1]
    picture.write(out, Picture(np.concatenate(parts)))


def row(out: str, *files: str) -> None:
    """Lay pictures of one height side by side with a thin line between."""
    pictures = [picture.read(name).pixels[..., :3] for name in files]
    line = np.ones((len(pictures[0]), GAP, 3), dtype=np.float32)
    parts = [part for each in pictures for part in (each, line)][:-1]
    picture.write(out, Picture(np.concatenate(parts, axis=1)))


def smaller(out: str, file: str) -> None:
    """Write a picture as a JPEG file of lower quality."""
    pixels = OpenImageIO.ImageBuf(file)
    pixels.specmod().attribute("compression", "jpeg:90")
    pixels.write(out)


if __name__ == "__main__":
    {"row": row, "shot": shot, "smaller": smaller, "stack": stack}[sys.argv[1]](*sys.argv[2:])
