"""A scatter table as a BSDF of Mitsuba 3: ``pip install "aureole[mitsuba]"``.

Mitsuba's compiled variants need LLVM's library from the system, and a version that does not fit kills
the interpreter. So `probe` renders a few pixels in a process of its own first, and `use` refuses where
that fails.
"""

import functools
import glob
import importlib
import itertools
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface.table import ScatterTable, rgb

VARIANTS = ("llvm_ad_rgb", "cuda_ad_rgb")
PLUGIN = "aureole_surface"
INSTALL = 'install it with: pip install "aureole[mitsuba]"'
INSTALL_LLVM = "install LLVM's library, on Debian and Ubuntu with: apt-get install libllvm15"
# Where distributions put LLVM's library, for loaders that do not find it themselves.
_LLVM_PLACES = ("/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", "/usr/lib64/libLLVM*.so*")
_PROBE_SECONDS = 120
# The share of samples that leave by a cosine lobe, so that no direction is left out.
_COSINE_SHARE = 0.05

_PROBE = """
import sys
import mitsuba
mitsuba.set_variant(sys.argv[1])
scene = mitsuba.load_dict({
    "type": "scene", "integrator": {"type": "direct"}, "light": {"type": "constant"},
    "shape": {"type": "sphere", "bsdf": {"type": "roughconductor"}},
    "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 4, "height": 4}},
})
print(float(mitsuba.TensorXf(mitsuba.render(scene, spp=1)).array[0]))
"""

_keys = itertools.count()
_tables: dict[int, ScatterTable] = {}


@dataclass(frozen=True)
class Probe:
    """What became of a try to render with a variant in a process of its own.

    Parameters
    ----------
    variant : str
        Mitsuba's name of it.
    works : bool
        Whether it rendered.
    reason : str
        Where it did not, why, and what would help.
    environment : dict of str
        What must be in the environment before Mitsuba is imported.
    """

    variant: str
    works: bool
    reason: str = ""
    environment: dict[str, str] = field(default_factory=dict)


@functools.cache
def probe(variant: str = "llvm_ad_rgb") -> Probe:
    """Find out whether Mitsuba is here and a variant of it renders.

    Parameters
    ----------
    variant : str
        One of `VARIANTS`.

    Returns
    -------
    Probe
        Asked once a process; a crash of the library stays in the process that was started for it.

    Raises
    ------
    refuse.Refusal
        Where the variant is unknown.
    """
    refuse.one_of("variant", variant, VARIANTS)
    failed = _tried(variant, {})
    if failed is None:
        return Probe(variant, True)
    if "No module named" in failed:
        return Probe(variant, False, f"Mitsuba is not installed; {INSTALL}.")
    for library in _llvm_libraries() if variant.startswith("llvm") else ():
        named = {"DRJIT_LIBLLVM_PATH": library}
        if _tried(variant, named) is None:
            return Probe(variant, True, environment=named)
    hint = INSTALL_LLVM if variant.startswith("llvm") else "it needs an NVIDIA GPU and its driver"
    return Probe(variant, False, f"Mitsuba's variant '{variant}' fails here ({failed}); {hint}.")


def use(variant: str = "llvm_ad_rgb") -> Any:
    """Set Mitsuba's variant and register our BSDF with it.

    Parameters
    ----------
    variant : str
        One of `VARIANTS`. Python BSDFs want compiled variants; a scalar one is some seventy times slower.

    Returns
    -------
    module
        ``mitsuba``, which knows the plugin "aureole_surface" now.

    Raises
    ------
    refuse.Refusal
        Where Mitsuba or the library that it needs is missing, with the line that installs it.
    """
    found = probe(variant)
    if not found.works:
        raise refuse.Refusal(found.reason)
    os.environ.update(found.environment)
    import mitsuba

    mitsuba.set_variant(variant)
    _register(mitsuba)
    return mitsuba


def bsdf(
    table: ScatterTable,
    f0: ArrayLike = 1.0,
    diffuse: ArrayLike = 0.0,
    diffraction: float = 1.0,
) -> dict[str, Any]:
    """Return what a scene of Mitsuba says to have a table as a BSDF.

    The light's spectrum is in the table, so that the scene's emitters are to be neutral. The shape's
    tangents (``dp_du``) are the table's: a ``disk`` has radial ones as an optical disc does; meshes want
    texture coordinates.

    Parameters
    ----------
    table : ScatterTable
        What the surface scatters.
    f0 : array_like, shape () or (3,)
        Reflectance at normal incidence, linear Rec.709; Schlick's factor follows from it.
    diffuse : array_like, shape () or (3,)
        Albedo of the diffuse part, linear Rec.709.
    diffraction : float
        Weight of the table's part.

    Returns
    -------
    dict
        For `mitsuba.load_dict`, after `use`.

    Raises
    ------
    refuse.Refusal
        Where a reflectance is not from 0 to 1.
    """
    key = next(_keys)
    _tables[key] = table
    entry: dict[str, Any] = {"type": PLUGIN, "table": key, "diffraction": float(diffraction)}
    for name, colour in (("f0", _reflectance("f0", f0)), ("diffuse", _reflectance("diffuse", diffuse))):
        entry.update({f"{name}_{channel}": value for channel, value in zip("rgb", colour, strict=True)})
    return entry


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


def _stretch(length: int, warp: int) -> NDArray[np.float64]:
    """Mean of n |u|^(n - 1) over each sample's cell: never zero, as the power itself is at the middle."""
    edges = np.linspace(-1.0, 1.0, length)
    edges = np.concatenate([edges[:1], 0.5 * (edges[1:] + edges[:-1]), edges[-1:]])
    return np.asarray(np.diff(np.sign(edges) * np.abs(edges) ** warp) / np.diff(edges))


class _Reflectance:
    """What a plugin knows of its table, in the arrays of the variant that is set."""

    def __init__(self, mitsuba: Any, properties: Any) -> None:
        self.mitsuba, self.dr = mitsuba, importlib.import_module("drjit")
        table = _tables[int(properties["table"])]
        self.weight = 4.0 * np.pi**2 * float(properties["diffraction"])
        self.f0, self.diffuse = (
            mitsuba.Color3f(*(float(properties[f"{name}_{channel}"]) for channel in "rgb"))
            for name in ("f0", "diffuse")
        )
        self.half_range, self.warp = float(table.half_range), int(table.warp)
        colours = np.ascontiguousarray(rgb(table)[::-1])
        self.size = mitsuba.Vector2f(colours.shape[1], colours.shape[0])
        dr = self.dr
        self.texture = mitsuba.Texture2f(
            mitsuba.TensorXf(colours), wrap_mode=dr.WrapMode.Clamp, filter_mode=dr.FilterMode.Linear
        )
        self.lobe = mitsuba.MarginalContinuous2D0(sampling_density(table))

    def place_of(self, h: Any) -> Any:
        """Find h on the unit square: u from -1 to 1 put to 0..1."""
        dr = self.dr
        u = dr.power(dr.abs(h) / self.half_range, 1.0 / self.warp)
        return 0.5 + 0.5 * self.mitsuba.Point2f(dr.mulsign(u.x, h.x), dr.mulsign(u.y, h.y))

    def drawn(self, wi: Any, sample: Any) -> tuple[Any, Any]:
        """Draw h by the table: the direction it goes to, and whether that is above the surface."""
        dr, place = self.dr, self.lobe.sample(sample)[0]
        u = 2.0 * place - 1.0
        h = self.half_range * dr.power(dr.abs(u), self.warp)
        x, y = dr.mulsign(h.x, u.x) - wi.x, dr.mulsign(h.y, u.y) - wi.y
        rest = 1.0 - x * x - y * y
        return self.mitsuba.Vector3f(x, y, dr.safe_sqrt(rest)), rest > 0.0

    def reflected(self, wi: Any, wo: Any) -> Any:
        """Return f_r cos."""
        dr, sum_ = self.dr, wi + wo
        h = self.mitsuba.Point2f(sum_.x, sum_.y)
        inside = (dr.abs(h.x) <= self.half_range) & (dr.abs(h.y) <= self.half_range)
        # The table's outer samples lie on its border, a texture's half a sample within it.
        place = (self.place_of(h) * (self.size - 1.0) + 0.5) / self.size
        colour = self.mitsuba.Color3f(*self.texture.eval(place))
        cosine = dr.clip(0.5 * dr.norm(sum_), 0.0, 1.0)
        fresnel = self.f0 + (1.0 - self.f0) * dr.power(1.0 - cosine, 5)
        scattered = dr.select(inside, self.weight * fresnel * fresnel * colour, 0.0)
        return (self.diffuse * dr.inv_pi + scattered) * wo.z

    def density(self, wi: Any, wo: Any) -> Any:
        """Density over solid angle: over u, times du/dh of both axes, times cos (ds = cos dω)."""
        dr, sum_ = self.dr, wi + wo
        h = self.mitsuba.Point2f(sum_.x, sum_.y)
        inside = (dr.abs(h.x) <= self.half_range) & (dr.abs(h.y) <= self.half_range)
        place = self.place_of(h)
        u = 2.0 * place - 1.0
        stretch = 2.0 * self.half_range * self.warp * dr.power(dr.abs(u), self.warp - 1)
        area = dr.maximum(stretch.x, 1e-12) * dr.maximum(stretch.y, 1e-12)
        by_table = dr.select(inside, self.lobe.eval(place) / area, 0.0)
        return wo.z * ((1.0 - _COSINE_SHARE) * by_table + _COSINE_SHARE * dr.inv_pi)


def _register(mitsuba: Any) -> None:
    """Define the BSDF for the variant that is set: its base class is another in each."""
    dr = importlib.import_module("drjit")

    class SurfaceBSDF(mitsuba.BSDF):  # type: ignore[misc]
        """f_r = diffuse / π + 4π² F² S_d(h), sampled by the table and a cosine lobe."""

        def __init__(self, properties: Any) -> None:
            super().__init__(properties)
            self.of = _Reflectance(mitsuba, properties)
            flags = mitsuba.BSDFFlags
            flag = flags.GlossyReflection | flags.FrontSide | flags.BackSide | flags.Anisotropic
            self.m_components, self.m_flags = [flag], flag

        def traverse(self, callback: Any) -> None:
            """Offer nothing: a table is not a parameter to be optimised."""

        def sample(self, context: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            """Draw a direction; its weight is f_r cos / p."""
            wi = mitsuba.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z))
            by_table = sample1 >= _COSINE_SHARE
            scattered, above = self.of.drawn(wi, sample2)
            wo = dr.select(by_table, scattered, mitsuba.warp.square_to_cosine_hemisphere(sample2))
            active &= (wi.z > 0.0) & (wo.z > 0.0) & (~by_table | above)
            density = dr.select(active, self.of.density(wi, wo), 0.0)
            found = dr.zeros(mitsuba.BSDFSample3f)
            found.wo = mitsuba.Vector3f(wo.x, wo.y, wo.z * mitsuba.Float(dr.sign(si.wi.z)))
            found.pdf = density
            found.eta = 1.0
            found.sampled_type = mitsuba.UInt32(+self.m_flags)
            found.sampled_component = 0
            active &= density > 0.0
            return found, dr.select(active, self.of.reflected(wi, wo) / density, 0.0)

        def eval(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Return f_r cos."""
            return self.eval_pdf(context, si, wo, active)[0]

        def pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Return the density of `sample` over solid angle."""
            return self.eval_pdf(context, si, wo, active)[1]

        def eval_pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Turn a back side up, and return both; directions on two sides see nothing of each other."""
            active &= si.wi.z * wo.z > 0.0
            wi = mitsuba.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z))
            out = mitsuba.Vector3f(wo.x, wo.y, dr.abs(wo.z))
            value = dr.select(active, self.of.reflected(wi, out), 0.0)
            return value, dr.select(active, self.of.density(wi, out), 0.0)

        def to_string(self) -> str:
            """Name the plugin."""
            return f"{PLUGIN}[{int(self.of.size.x[0])} x {int(self.of.size.y[0])}]"

    mitsuba.register_bsdf(PLUGIN, SurfaceBSDF)


def _tried(variant: str, environment: dict[str, str]) -> str | None:
    """Render in another process; None where it worked, else why it did not."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROBE, variant],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=_PROBE_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no picture within {_PROBE_SECONDS} s"
    if done.returncode == 0:
        return None
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return lines[-1] if lines else f"the process ended with {done.returncode}"


def _llvm_libraries() -> Sequence[str]:
    """List LLVM's libraries on this machine, the newest name first."""
    return sorted({path for place in _LLVM_PLACES for path in glob.glob(place)}, reverse=True)


def _reflectance(name: str, value: ArrayLike) -> list[float]:
    colour = np.broadcast_to(refuse.all_finite(name, value), (3,))
    if (colour < 0).any() or (colour > 1).any():
        raise refuse.Refusal(f"'{name}' must lie in 0..1, got {colour.tolist()}.")
    return [float(part) for part in colour]
