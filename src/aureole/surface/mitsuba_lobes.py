"""What our BSDF of Mitsuba does to light, in the arrays of the variant that is set.

f_r = diffuse / π + specular · Cook-Torrance + 4π² F² G S_d(h), as `scene.render` has it. A direction is
drawn by one of three lobes (the table's own, Beckmann's facets, a cosine), each as often as it is bright; its
density is that of all three.
"""

import importlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.surface.albedo import albedo
from aureole.surface.integrate import table_from_pattern
from aureole.surface.material import Material, shader_numbers
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.table import MODELS, ScatterTable, axes, rgb

# The share of samples that leave by a cosine lobe in any case, so that no direction is left out.
COSINE_SHARE = 0.05
# Where a material's red, green and blue are taken to lie, where light has wavelengths.
COLOUR_WAVELENGTHS_NM = (620.0, 550.0, 450.0)
_DRAWN_SIZE = 257  # samples of the table by which directions of a pattern are drawn


@dataclass(frozen=True, eq=False)
class Kept:
    """A surface that a scene of Mitsuba refers to.

    Parameters
    ----------
    table : ScatterTable
        What it scatters; directions are drawn by it.
    material : Material
        The rest of it.
    patterns : tuple of DiffractionPattern
        What it scatters at each wavelength; empty where the table says all.
    model : str
        One of `MODELS`: the power of the wavelength for patterns.
    """

    table: ScatterTable
    material: Material
    patterns: tuple[DiffractionPattern, ...] = ()
    model: str = "phase"


def kept_patterns(patterns: tuple[DiffractionPattern, ...], material: Material, model: str) -> Kept:
    """Keep patterns, with a small table to draw directions by.

    Parameters
    ----------
    patterns : tuple of DiffractionPattern
        At one wavelength or several.
    material : Material
        The rest of the surface.
    model : str
        One of `MODELS`.

    Returns
    -------
    Kept
        For `Lobes`.
    """
    table = table_from_pattern(patterns, size=_DRAWN_SIZE, model=model)
    ordered = tuple(sorted(patterns, key=lambda one: one.wavelength))
    return Kept(table, material, ordered, model)


def sampling_density(table: ScatterTable) -> NDArray[np.float32]:
    """Return the density by which h is drawn, over the table's own u.

    Parameters
    ----------
    table : ScatterTable
        What the surface scatters.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Brightness times the stretch dh/du of both axes, rows from -h·b up; its largest is 1.
    """
    brightness = np.abs(rgb(table)).mean(axis=2).astype(np.float64)[::-1]
    rows, columns = (_stretch(length, table.warp) for length in brightness.shape)
    density = brightness * rows[:, None] * columns[None, :]
    largest = float(density.max())
    return np.asarray(density / largest if largest > 0 else np.ones_like(density), dtype=np.float32)


def windowed(kept: Kept) -> ScatterTable:
    """Return the table as the material's window leaves it.

    Parameters
    ----------
    kept : Kept
        The surface.

    Returns
    -------
    ScatterTable
        The table itself where there is no window.
    """
    if kept.material.window is None:
        return kept.table
    along, across = kept.material.window
    h_b, h_t = axes(kept.table)
    gauss = np.exp(-0.5 * ((h_b[:, None] / across) ** 2 + (h_t[None, :] / along) ** 2))
    return replace(kept.table, values=np.asarray(kept.table.values * gauss[..., None], dtype=np.float32))


def shares(kept: Kept) -> tuple[float, float, float]:
    """Return how often a direction is drawn by the table, by facets, by the cosine.

    Parameters
    ----------
    kept : Kept
        The surface.

    Returns
    -------
    tuple of float
        They add up to 1.
    """
    numbers, fresnel = shader_numbers(kept.material)
    bright = (
        max(float(albedo(windowed(kept))[1]), 0.0) * float(numbers[4]) / (4.0 * np.pi**2),
        float(numbers[3] * fresnel[-1].mean()),
        float(np.pi * numbers[:3].mean()),
    )
    scale = (1.0 - COSINE_SHARE) / max(sum(bright), 1e-30)
    by_table, by_facets = bright[0] * scale, bright[1] * scale
    return by_table, by_facets, 1.0 - by_table - by_facets


def _stretch(length: int, warp: int) -> NDArray[np.float64]:
    """Mean of n |u|^(n - 1) over each sample's cell: never zero, as the power itself is at the middle."""
    edges = np.linspace(-1.0, 1.0, length)
    edges = np.concatenate([edges[:1], 0.5 * (edges[1:] + edges[:-1]), edges[-1:]])
    return np.asarray(np.diff(np.sign(edges) * np.abs(edges) ** warp) / np.diff(edges))


class Lobes:
    """A surface with its table as a texture and as a distribution, for variants that hold RGB.

    Parameters
    ----------
    mitsuba : module
        With its variant set.
    kept : Kept
        The surface.
    """

    def __init__(self, mitsuba: Any, kept: Kept) -> None:
        self.mitsuba, self.dr = mitsuba, importlib.import_module("drjit")
        numbers, fresnel = shader_numbers(kept.material)
        self.diffuse = [float(value) for value in numbers[:3]]
        self.specular, self.weight, self.roughness, *window = (float(value) for value in numbers[3:8])
        self.window, self.stam = mitsuba.Vector2f(window), bool(numbers[8])
        self.windowed = max(window) > 0.0
        self.shares = shares(kept)
        self.half_range, self.warp = float(kept.table.half_range), int(kept.table.warp)
        self.lobe = mitsuba.MarginalContinuous2D0(sampling_density(windowed(kept)))
        self.mirror = mitsuba.Texture1f(mitsuba.TensorXf(fresnel), wrap_mode=self.dr.WrapMode.Clamp)
        self.mirror_size = len(fresnel)
        self.colours = self.texture(rgb(kept.table))

    def texture(self, values: NDArray[np.float32]) -> tuple[Any, Any]:
        """Lay values (rows, columns, channels) out, b upward: a texture and its size."""
        turned = np.ascontiguousarray(values[::-1], dtype=np.float32)
        laid = self.mitsuba.Texture2f(self.mitsuba.TensorXf(turned), wrap_mode=self.dr.WrapMode.Clamp)
        return laid, self.mitsuba.Vector2f(turned.shape[1], turned.shape[0])

    def read(self, texture: tuple[Any, Any], place: Any) -> list[Any]:
        """Read a texture on the unit square; its outer samples lie on the border."""
        found: list[Any] = texture[0].eval((place * (texture[1] - 1.0) + 0.5) / texture[1])
        return found

    def colour(self, channels: list[Any], si: Any) -> Any:
        """Return red, green and blue as the variant's colour."""
        return self.mitsuba.Color3f(*channels)

    def pattern(self, h: Any, si: Any) -> Any:
        """Return S_d(h), zero outside the table."""
        dr = self.dr
        inside = (dr.abs(h.x) <= self.half_range) & (dr.abs(h.y) <= self.half_range)
        return dr.select(inside, self.colour(self.read(self.colours, self.place_of(h)), si), 0.0)

    def place_of(self, h: Any) -> Any:
        """Find h on the unit square: u from -1 to 1 put to 0..1."""
        dr = self.dr
        u = dr.power(dr.abs(h) / self.half_range, 1.0 / self.warp)
        return 0.5 + 0.5 * self.mitsuba.Point2f(dr.mulsign(u.x, h.x), dr.mulsign(u.y, h.y))

    def drawn(self, wi: Any, sample1: Any, sample2: Any) -> tuple[Any, Any]:
        """Draw a direction by one of the lobes: it, and whether there is one."""
        dr, mitsuba = self.dr, self.mitsuba
        by_table, by_facets, _ = self.shares
        wo = mitsuba.warp.square_to_cosine_hemisphere(sample2)
        if by_facets > 0.0:
            facet = mitsuba.warp.square_to_beckmann(sample2, self.roughness)
            chosen = sample1 < by_table + by_facets
            wo = dr.select(chosen, 2.0 * dr.dot(wi, facet) * facet - wi, wo)
        # The table's h less the direction of the light: above the horizon, or there is none.
        u = 2.0 * self.lobe.sample(sample2)[0] - 1.0
        h = self.half_range * dr.power(dr.abs(u), self.warp)
        x, y = dr.mulsign(h.x, u.x) - wi.x, dr.mulsign(h.y, u.y) - wi.y
        rest = 1.0 - x * x - y * y
        scattered = mitsuba.Vector3f(x, y, dr.select(rest > 0.0, dr.safe_sqrt(rest), -1.0))
        wo = dr.select(sample1 < by_table, scattered, wo)
        return wo, wo.z > 0.0

    def reflected(self, wi: Any, wo: Any, si: Any) -> Any:
        """Return f_r cos."""
        dr, sum_ = self.dr, wi + wo
        oh = dr.clip(0.5 * dr.norm(sum_), 1e-6, 1.0)
        at = (oh * (self.mirror_size - 1) + 0.5) / self.mirror_size
        fresnel = self.colour(self.mirror.eval(self.mitsuba.Point1f(at)), si)
        h = self.mitsuba.Point2f(sum_.x, sum_.y)
        gain = self.weight
        if self.windowed:
            gain = gain * dr.exp(-dr.dot(self.window, h * h))
        if self.stam:
            gain = gain * oh * oh * oh * oh / (wi.z * wo.z)
        found = self.colour(self.diffuse, si) + gain * fresnel * fresnel * self.pattern(h, si)
        if self.specular > 0.0:
            shadow = dr.minimum(1.0, (wi.z + wo.z) / (oh * oh) * dr.minimum(wi.z, wo.z))
            facets = self.beckmann(sum_, oh)[0] * shadow / (4.0 * wi.z * wo.z)
            found = found + self.specular * facets * fresnel
        return found * wo.z

    def beckmann(self, sum_: Any, oh: Any) -> tuple[Any, Any]:
        """Return Beckmann's distribution of facets, and the cosine of the facet that mirrors."""
        dr, slope2 = self.dr, self.roughness**2
        cosine = dr.clip(0.5 * sum_.z / oh, 1e-6, 1.0)
        square = cosine * cosine
        return dr.exp(-(1.0 - square) / (square * slope2)) / (dr.pi * slope2 * square * square), cosine

    def density(self, wi: Any, wo: Any) -> Any:
        """Density over solid angle, all lobes together."""
        dr, sum_ = self.dr, wi + wo
        by_table, by_facets, by_cosine = self.shares
        h = self.mitsuba.Point2f(sum_.x, sum_.y)
        inside = (dr.abs(h.x) <= self.half_range) & (dr.abs(h.y) <= self.half_range)
        # Over u, times du/dh of both axes, times cos (ds = cos dω).
        place = self.place_of(h)
        u = 2.0 * place - 1.0
        stretch = 2.0 * self.half_range * self.warp * dr.power(dr.abs(u), self.warp - 1)
        area = dr.maximum(stretch.x, 1e-12) * dr.maximum(stretch.y, 1e-12)
        total = wo.z * dr.select(inside, by_table * self.lobe.eval(place) / area, 0.0)
        if by_facets > 0.0:
            oh = dr.clip(0.5 * dr.norm(sum_), 1e-6, 1.0)
            spread, cosine = self.beckmann(sum_, oh)
            total += by_facets * spread * cosine / (4.0 * oh)
        return total + by_cosine * dr.inv_pi * wo.z


class SpectralLobes(Lobes):
    """The same for variants that follow wavelengths: S_λ(h) = (λ_m / λ)^p M(λ_m h / λ) of each.

    Parameters
    ----------
    mitsuba : module
        With its variant set.
    kept : Kept
        The surface, with patterns.
    """

    def __init__(self, mitsuba: Any, kept: Kept) -> None:
        super().__init__(mitsuba, kept)
        self.power = MODELS[kept.model]
        self.bands = [
            (1e9 * one.wavelength, float(one.half_range), self.texture(one.values[..., None]))
            for one in kept.patterns
        ]

    def colour(self, channels: list[Any], si: Any) -> Any:
        """Return red, green and blue at the light's wavelengths, linear between, constant beyond."""
        red, green, blue = channels
        low, middle, high = reversed(COLOUR_WAVELENGTHS_NM)
        dr = self.dr
        colder = dr.clip((middle - si.wavelengths) / (middle - low), 0.0, 1.0)
        warmer = dr.clip((si.wavelengths - middle) / (high - middle), 0.0, 1.0)
        return self.mitsuba.UnpolarizedSpectrum(green + colder * (blue - green) + warmer * (red - green))

    def pattern(self, h: Any, si: Any) -> Any:
        """Return S_λ(h) at the light's wavelengths, bands mixed linearly."""
        found = [self.at_wavelength(h, si.wavelengths[k]) for k in range(len(si.wavelengths))]
        return self.mitsuba.UnpolarizedSpectrum(*found)

    def at_wavelength(self, h: Any, wavelength: Any) -> Any:
        """Return S_λ(h) at one wavelength."""
        dr, total = self.dr, 0.0
        for k, (own, half_range, texture) in enumerate(self.bands):
            scale = own / wavelength
            place = 0.5 + 0.5 * scale * h / half_range
            inside = dr.all((place >= 0.0) & (place <= 1.0))
            share = self.share(k, wavelength)
            value = self.read(texture, self.mitsuba.Point2f(place))[0]
            total = total + dr.select(inside, share * dr.power(scale, self.power) * value, 0.0)
        return total

    def share(self, k: int, wavelength: Any) -> Any:
        """Return the weight of a band: 1 at its own wavelength, 0 at its neighbours'."""
        dr, own, share = self.dr, self.bands[k][0], 1.0
        if k > 0:
            below = self.bands[k - 1][0]
            share = share * dr.clip((wavelength - below) / (own - below), 0.0, 1.0)
        if k + 1 < len(self.bands):
            above = self.bands[k + 1][0]
            share = share * dr.clip((above - wavelength) / (above - own), 0.0, 1.0)
        return share
