"""Which of a file's channels are the picture: chosen by name, never by position."""

from collections.abc import Sequence

from aureole.picture.metadata import Colour

_ALPHA = ("a", "alpha")


def choose_colour(names: Sequence[str]) -> tuple[Colour | None, str]:
    """Choose the colour and alpha among a file's channels.

    Plain R, G, B come first, then luminance and chroma (Y, RY, BY), grey (Y), the first layer that
    has R, G and B ("beauty.R"), and last a file's only channel, whatever its name.

    Parameters
    ----------
    names : sequence of str
        The names of all channels, in the file's order.

    Returns
    -------
    tuple
        The choice, None where nothing is a picture, and a note where it needs one, else "".
    """
    plain = _colour_of_layer(names, "")
    if plain:
        return plain, ""
    layers = [name.rpartition(".")[0] for name in names if "." in name]
    for layer in dict.fromkeys(layers):
        found = _colour_of_layer(names, f"{layer}.")
        if found and len(found.names) == 3:
            return found, f"there is no plain R, G, B; the first layer, '{layer}', is read"
    return (Colour((names[0],)), "") if len(names) == 1 else (None, "")


def _colour_of_layer(names: Sequence[str], prefix: str) -> Colour | None:
    """Find the picture among the channels whose names begin with a prefix."""
    by_leaf = {
        name[len(prefix) :].lower(): name
        for name in reversed(names)
        if name.startswith(prefix) and "." not in name[len(prefix) :]
    }
    alpha = next((by_leaf[leaf] for leaf in _ALPHA if leaf in by_leaf), None)
    for wanted in (("r", "g", "b"), ("y", "ry", "by"), ("y",)):
        if all(leaf in by_leaf for leaf in wanted):
            return Colour(tuple(by_leaf[leaf] for leaf in wanted), alpha)
    return None
