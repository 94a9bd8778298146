"""OpenColorIO configurations, where one is given: from a named space to the working one, and back.

OpenImageIO carries OpenColorIO with it, so this needs no further package.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import primaries

Config = str | os.PathLike[str] | None


def to_working(
    pixels: NDArray[np.float32], config: Config, space: str
) -> tuple[NDArray[np.float32], str, tuple[str, ...]]:
    """Convert from a configuration's space to its scene-linear one.

    Parameters
    ----------
    pixels : ndarray of float32, shape (rows, columns, 3 or 4)
        The file's numbers.
    config : path_like or None
        The configuration; "ocio://..." names a built-in one, None is $OCIO or OpenImageIO's own.
    space : str
        Name, alias or role of the numbers' space.

    Returns
    -------
    tuple
        Linear pixels, the name of their space in `aureole.light.SPACES`, and notes.

    Raises
    ------
    refuse.Refusal
        Where the configuration cannot be read or has no such space.
    """
    known = _loaded(config)
    source, working = _space(known, config, space), _working(known, config)
    ours = _ours(known, working)
    note = f"the configuration does not say which primaries '{working}' has; they are treated as working RGB"
    return _converted(pixels, config, source, working), ours or "rec709", () if ours else (f"{note}.",)


def from_working(
    pixels: NDArray[np.float32], colour_space: str, config: Config, space: str
) -> tuple[NDArray[np.float32], str | None]:
    """Convert linear colour to a configuration's named space.

    Parameters
    ----------
    pixels : ndarray of float32, shape (rows, columns, 3 or 4)
        Linear colour.
    colour_space : str
        Its space, one of the names in `aureole.light.SPACES`.
    config : path_like or None
        The configuration; "ocio://..." names a built-in one, None is $OCIO or OpenImageIO's own.
    space : str
        Name, alias or role of the wanted space.

    Returns
    -------
    tuple
        The numbers to write, and the space's name in `aureole.light.SPACES` or None.

    Raises
    ------
    refuse.Refusal
        Where the configuration cannot be read or has no such space.
    """
    known = _loaded(config)
    target, working = _space(known, config, space), _working(known, config)
    # Where the configuration does not say its working primaries, they are the picture's.
    ours = _ours(known, working) or colour_space
    numbers = _converted(primaries.converted(pixels, colour_space, ours), config, working, target)
    return numbers, _ours(known, target)


def _loaded(config: Config) -> Any:
    import OpenImageIO

    # A missing file is told apart here, as OpenImageIO falls back to its own spaces.
    builtin = config is None or str(config).startswith("ocio://")
    if not builtin and not Path(str(config)).is_file():
        raise refuse.Refusal(f"There is no colour configuration '{config}'.")
    known = OpenImageIO.ColorConfig() if config is None else OpenImageIO.ColorConfig(str(config))
    error = known.geterror()
    if error:
        raise refuse.Refusal(f"The colour configuration '{config}' cannot be read: {error.splitlines()[0]}.")
    return known


def _space(known: Any, config: Config, name: str) -> str:
    if known.getColorSpaceIndex(name) >= 0:
        return name
    names = [*known.getColorSpaceNames(), *known.getRoles()]
    raise refuse.unknown_key(f"The colour configuration '{config or 'default'}'", name, names)


def _working(known: Any, config: Config) -> str:
    for role in ("scene_linear", "default"):
        name = known.getColorSpaceNameByRole(role)
        if name:
            return str(name)
    raise refuse.Refusal(f"The colour configuration '{config}' has no role 'scene_linear'.")


def _ours(known: Any, space: str) -> str | None:
    return primaries.INTERCHANGE.get(known.get_color_interop_id(space) or "")


def _converted(pixels: NDArray[np.float32], config: Config, source: str, target: str) -> NDArray[np.float32]:
    import OpenImageIO

    # Colour stays associated with alpha: it is never divided by it.
    image = OpenImageIO.ImageBuf(np.ascontiguousarray(pixels))
    path = "" if config is None else str(config)
    result = OpenImageIO.ImageBufAlgo.colorconvert(image, source, target, False, "", "", path)
    if result.has_error:
        reason = result.geterror().splitlines()[0]
        raise refuse.Refusal(f"No way from '{source}' to '{target}': {reason}")
    return np.asarray(result.get_pixels("float"), dtype=np.float32)
