"""What a surface is made of besides its table: diffuse and mirror-like parts, Fresnel's factor, a window."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.surface.table import ScatterTable, neutral_white

GEOMETRY = ("one", "stam")
_COSINES = 1025


@dataclass(frozen=True, eq=False)
class Material:
    """The numbers of f_r = diffuse / π + specular · Cook-Torrance + 4π² F² G S_d(h).

    These are Equations 7 and 10 of the surface paper (Toisoul and Ghosh 2017).

    Parameters
    ----------
    diffuse : array_like, shape () or (3,)
        Albedo of the diffuse part, linear RGB.
    specular : array_like, shape () or (3,)
        Weight of the Cook-Torrance lobe (Beckmann's distribution), linear RGB.
    roughness : float
        Root mean square slope m of its facets.
    diffraction : float
        Weight of the table's part.
    fresnel : ndarray of float, shape (K, 3)
        F at cosines 0..1 between light and half vector, from `schlick` or `conductor`; used by both lobes.
    geometry : str
        "one": G = 1, so that a table is the share of light sent into each unit of direction cosines at every
        incidence; "stam": (1 + ω_i·ω_o)² / (4 cos cos), Stam's factor over the 4 that it has at normal
        incidence, which grows without bound towards grazing.
    window : tuple of float or None
        σ along tangent and bitangent of the Gaussian in h that multiplies the table (surface paper, 6.1).
    """

    diffuse: ArrayLike = 0.0
    specular: ArrayLike = 0.0
    roughness: float = 0.1
    diffraction: float = 1.0
    fresnel: NDArray[np.floating] | None = None
    geometry: str = "one"
    window: tuple[float, float] | None = None


def schlick(reflectance: ArrayLike = 1.0) -> NDArray[np.float32]:
    """Tabulate Schlick's Fresnel factor over the cosine (Schlick 1994, Eq. 15).

    Parameters
    ----------
    reflectance : array_like, shape () or (3,)
        F at normal incidence, linear RGB, 0..1.

    Returns
    -------
    ndarray of float32, shape (1025, 3)
        F at cosines from 0 to 1, evenly spaced.

    Raises
    ------
    refuse.Refusal
        Where a reflectance is not in 0..1.
    """
    normal = np.broadcast_to(refuse.all_finite("reflectance", reflectance), (3,))
    if (normal < 0).any() or (normal > 1).any():
        raise refuse.Refusal(f"'reflectance' must lie in 0..1, got {normal.tolist()}.")
    graze = (1.0 - np.linspace(0.0, 1.0, _COSINES))[:, None] ** 5
    return np.asarray(normal + (1.0 - normal) * graze, dtype=np.float32)


def conductor(index: ArrayLike, absorption: ArrayLike) -> NDArray[np.float32]:
    """Tabulate the reflectance of a metal for unpolarised light (Born and Wolf, 14.2).

    Parameters
    ----------
    index, absorption : array_like, shape () or (3,)
        Real and imaginary part of its refractive index at red, green and blue.

    Returns
    -------
    ndarray of float32, shape (1025, 3)
        F at cosines from 0 to 1, evenly spaced.

    Raises
    ------
    refuse.Refusal
        Where an index is not positive or an absorption negative.
    """
    n = np.broadcast_to(refuse.all_finite("index", index), (3,)).astype(np.float64)
    k = np.broadcast_to(refuse.all_finite("absorption", absorption), (3,)).astype(np.float64)
    if (n <= 0).any() or (k < 0).any():
        raise refuse.Refusal("'index' must be > 0 and 'absorption' >= 0.")
    cosine = np.linspace(0.0, 1.0, _COSINES)[:, None]
    squared = (n + 1j * k) ** 2
    inside = np.sqrt(squared - (1.0 - cosine**2))
    across = (cosine - inside) / (cosine + inside)
    along = (squared * cosine - inside) / (squared * cosine + inside)
    return np.asarray(0.5 * (np.abs(across) ** 2 + np.abs(along) ** 2), dtype=np.float32)


def material_of(table: ScatterTable, material: Material | None = None, roughness: float = 0.02) -> Material:
    """Give a material the mirror-like lobe that a table has left out.

    A table whose `zero_order` is "specular" says in its metadata how much light its order at h = 0 holds
    ("zero_order_energy": shares in X, Y and Z) and how wide it is ("zero_order_width": the root mean square
    of one component of h). As a lobe that light keeps the lamp's colour, where scaled with the wavelength it
    would not.

    Parameters
    ----------
    table : ScatterTable
        Any; the material stays as it is where nothing was left out.
    material : Material or None
        To be changed; None is a surface that only diffracts.
    roughness : float
        Of the lobe, where the table does not say how wide the order is.

    Returns
    -------
    Material
        With `specular` so that the lobe reflects at normal incidence what the order did, F² of it, and with
        `roughness` so that it is as wide.

    Raises
    ------
    refuse.Refusal
        Where the table has no number of its energy.
    """
    given = Material() if material is None else material
    if table.zero_order != "specular":
        return given
    if "zero_order_energy" not in table.metadata:
        raise refuse.Refusal(
            "The table's metadata must say its 'zero_order_energy' where its zero order is specular."
        )
    share = refuse.shape_of("zero_order_energy", table.metadata["zero_order_energy"], (3,)).astype(np.float64)
    white = np.asarray(table.white, dtype=np.float64)
    colour = light.from_xyz(
        refuse.all_finite("zero_order_energy", share), "rec709", neutral_white(white, "rec709")
    )
    colour = np.maximum(colour, 0.0)
    normal = 1.0 if given.fresnel is None else np.asarray(given.fresnel)[-1]
    # A facet of slope m about the mirror's has h twice as far out; each component spreads by m / √2.
    width = float(table.metadata.get("zero_order_width", 0.0)) / np.sqrt(2.0)
    return replace(given, specular=colour * normal, roughness=max(width, 1e-3) if width else roughness)


def shader_numbers(material: Material) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Check a material and write it as the shader's numbers.

    Parameters
    ----------
    material : Material
        The material.

    Returns
    -------
    numbers : ndarray of float32, shape (12,)
        As `_kernels_shade.shade` takes them, but for the last one.
    fresnel : ndarray of float32, shape (K, 3)
        Its Fresnel factors; of a perfect mirror where it has none.

    Raises
    ------
    refuse.Refusal
        Where a number is out of range.
    """
    diffuse, specular = _colour("diffuse", material.diffuse), _colour("specular", material.specular)
    diffraction = refuse.between("diffraction", material.diffraction, 0.0, np.inf)
    roughness = refuse.between("roughness", material.roughness, 1e-3, 10.0)
    window = (0.0, 0.0)
    if material.window is not None:
        along, across = (0.5 / refuse.positive("window", sigma) ** 2 for sigma in material.window)
        window = (along, across)
    stam = float(refuse.one_of("geometry", material.geometry, GEOMETRY) == "stam")
    fresnel = schlick(1.0) if material.fresnel is None else refuse.all_finite("fresnel", material.fresnel)
    if fresnel.ndim != 2 or fresnel.shape[0] < 2 or fresnel.shape[1] != 3:
        raise refuse.Refusal(f"'fresnel' must be an array of shape (K >= 2, 3), got {fresnel.shape}.")
    numbers = [*(diffuse / np.pi), specular.mean(), 4.0 * np.pi**2 * diffraction, roughness, *window, stam]
    return np.array([*numbers, *specular], dtype=np.float32), np.ascontiguousarray(fresnel, dtype=np.float32)


def _colour(name: str, value: ArrayLike) -> NDArray[np.float64]:
    colour = np.broadcast_to(refuse.all_finite(name, value), (3,)).astype(np.float64)
    if (colour < 0).any():
        raise refuse.Refusal(f"'{name}' must be >= 0, got {colour.tolist()}.")
    return colour
