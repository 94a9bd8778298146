"""The peers, and their ways: those of the ones that are installed, and a note on those that are not."""

import contextlib
import importlib.util
import sys
import warnings
from collections.abc import Callable, Iterator
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from aureole.bench import peer_diffractsim, peer_dlux, peer_hcipy, peer_prysm, peer_scipy
from aureole.bench.optics import Intensity, Optics

PEERS = (peer_scipy, peer_prysm, peer_hcipy, peer_diffractsim, peer_dlux)
INSTALL = "pip install 'aureole[bench]'"
# 50 mm at f/16 in green light.
FOCAL_LENGTH, F_NUMBER, WAVELENGTH = 50e-3, 16.0, 550e-9
WIDTH = FOCAL_LENGTH / F_NUMBER


def peers_of(packages: tuple[str, ...]) -> list[ModuleType]:
    """Return the peers of some names.

    Parameters
    ----------
    packages : tuple of str
        Names on the package index in lower case; other words are passed over.

    Returns
    -------
    list of module
        All peers where none is named.
    """
    return [peer for peer in PEERS if peer.PACKAGE.lower() in packages] or list(PEERS)


def ways_of(
    peers: list[ModuleType], optics: Optics, notes: list[str]
) -> list[tuple[str, Intensity, ModuleType]]:
    """Return every way of the peers that are installed and work, each called once.

    Parameters
    ----------
    peers : list of module
        Who is asked.
    optics : Optics
        What they shall transform.
    notes : list of str
        Gets a line for each peer that is missing or fails.

    Returns
    -------
    list of tuple
        Name of the way, the intensity as a function of the wavelength, the peer.
    """
    return working(peers, lambda peer: peer.ways(optics), WAVELENGTH, notes)


def working(
    peers: list[ModuleType],
    ask: Callable[[ModuleType], dict[str, Intensity]],
    first: float,
    notes: list[str],
) -> list[tuple[str, Intensity, ModuleType]]:
    """Return every way of the peers that are installed and work, each called once.

    Parameters
    ----------
    peers : list of module
        Who is asked.
    ask : callable
        A peer's ways: name to a function of a number.
    first : float
        The number with which each is called once.
    notes : list of str
        Gets a line for each peer that is missing or fails.

    Returns
    -------
    list of tuple
        Name of the way, the function, the peer.
    """
    found = []
    for peer in peers:
        if importlib.util.find_spec(peer.MODULE) is None:
            notes.append(f"{peer.NAME}: not installed: {INSTALL}")
            continue
        # A peer that fails is no fault of the others.
        try:
            with _unheard():
                own = [(way, _quiet(at), peer) for way, at in ask(peer).items()]
                for _, at, _ in own:
                    at(first)
        except Exception as error:
            notes.append(f"{peer.NAME}: installed, but fails here: {type(error).__name__}: {error}")
            continue
        found += own
    return found


def _quiet(at: Intensity) -> Intensity:
    def quiet(number: float) -> NDArray[np.floating]:
        with _unheard():
            return at(number)

    return quiet


@contextlib.contextmanager
def _unheard() -> Iterator[None]:
    """Send what a peer prints to stderr, since stdout is the result's, and leave out its warnings."""
    with contextlib.redirect_stdout(sys.stderr), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
