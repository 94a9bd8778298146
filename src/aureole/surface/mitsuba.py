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
from numpy.typing import NDArray

from aureole import refuse
from aureole.surface.material import Material, material_of, shader_numbers
from aureole.surface.mitsuba_lobes import Kept, Lobes, SpectralLobes, kept_patterns
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.table import MODELS, ScatterTable
from aureole.surface.table_files import read_table

VARIANTS = ("llvm_ad_rgb", "llvm_ad_spectral", "cuda_ad_rgb", "cuda_ad_spectral")
PLUGIN = "aureole_surface"
INSTALL = 'install it with: pip install "aureole[mitsuba]"'
INSTALL_LLVM = "install LLVM's library, on Debian and Ubuntu with: apt-get install libllvm15"
# Where distributions put LLVM's library, for loaders that do not find it themselves.
_LLVM_PLACES = ("/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", "/usr/lib64/libLLVM*.so*")
_PROBE_SECONDS = 120
_FILE_COSINES = 65  # Fresnel's factors in a scene's file

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
_kept: dict[int, Kept] = {}


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
    if not variant.startswith("llvm"):
        needs = "it needs an NVIDIA GPU and its driver"
        return Probe(variant, False, f"Mitsuba's variant '{variant}' fails here ({failed}); {needs}.")
    tried = []
    for library in _llvm_libraries():
        named = {"DRJIT_LIBLLVM_PATH": library}
        failed = _tried(variant, named)
        if failed is None:
            return Probe(variant, True, environment=named)
        tried.append(os.path.basename(library))
    found = f"with {', '.join(tried)}: {failed}" if tried else failed
    return Probe(variant, False, f"Mitsuba's variant '{variant}' fails here ({found}); {INSTALL_LLVM}.")


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
    # A library that does not fit ends the process as soon as it compiles: it must not be loaded already.
    unset = {name: value for name, value in found.environment.items() if os.environ.get(name) != value}
    if unset and "drjit" in sys.modules:
        said = " ".join(f"{name}={value}" for name, value in unset.items())
        raise refuse.Refusal(f"Mitsuba was imported already; set {said} first, or call 'use' before it.")
    os.environ.update(unset)
    import mitsuba

    mitsuba.set_variant(variant)
    _register(mitsuba)
    return mitsuba


def bsdf(
    table: ScatterTable | DiffractionPattern | Sequence[DiffractionPattern],
    material: Material | None = None,
    model: str = "phase",
) -> dict[str, Any]:
    """Return what a scene of Mitsuba says to have a table or patterns as a BSDF.

    A table holds its light's spectrum, so that the scene's emitters are to be neutral, in a variant of RGB.
    Patterns want a spectral variant, where each ray's own wavelengths are looked up, and emitters have
    spectra of their own. The shape's tangents (``dp_du``) are the table's: a ``disk`` has radial ones as an
    optical disc does; meshes want texture coordinates.

    Parameters
    ----------
    table : ScatterTable, DiffractionPattern or sequence of DiffractionPattern
        What the surface scatters.
    material : Material or None
        The rest of it; None only diffracts (`material_of` its table). Colours are linear Rec.709; where
        light has wavelengths, they are taken at 620, 550 and 450 nm and linearly between.
    model : {"phase", "amplitude", "paper"}
        Power of the wavelength for patterns, as in `table_from_pattern`.

    Returns
    -------
    dict
        For `mitsuba.load_dict`, after `use`; the surface is kept for the life of the process.

    Raises
    ------
    refuse.Refusal
        Where the material is not as described or the model unknown.
    """
    made = material
    if made is None:
        made = material_of(table) if isinstance(table, ScatterTable) else Material()
    shader_numbers(made)
    if isinstance(table, ScatterTable):
        kept = Kept(table, made)
    else:
        patterns = (table,) if isinstance(table, DiffractionPattern) else tuple(table)
        kept = kept_patterns(patterns, made, refuse.one_of("model", model, MODELS))
    key = next(_keys)
    _kept[key] = kept
    return {"type": PLUGIN, "kept": key}


def bsdf_of_file(table: str | os.PathLike[str], material: Material | None = None) -> dict[str, Any]:
    """Return what a scene of Mitsuba says to have a table from a file as a BSDF: plain words and numbers.

    Parameters
    ----------
    table : path_like
        A file that `read_table` reads; where it is relative, Mitsuba seeks it beside the scene's file.
    material : Material or None
        The rest of the surface.

    Returns
    -------
    dict
        For `mitsuba.load_dict` or a scene's file.

    Raises
    ------
    refuse.Refusal
        Where the material is not as described.
    """
    made = Material() if material is None else material
    numbers, fresnel = shader_numbers(made)
    cosines = np.linspace(0.0, 1.0, _FILE_COSINES)
    own = np.linspace(0.0, 1.0, len(fresnel))
    factors = np.stack([np.interp(cosines, own, channel) for channel in fresnel.T], axis=1)
    entry = {
        "type": PLUGIN,
        "table": os.fspath(table),
        "diffuse": _words(np.pi * numbers[:3]),
        "specular": float(numbers[3]),
        "roughness": float(made.roughness),
        "diffraction": float(made.diffraction),
        "geometry": made.geometry,
        "fresnel": _words(factors.ravel()),
    }
    return entry if made.window is None else {**entry, "window": _words(np.array(made.window))}


def _words(numbers: NDArray[np.floating]) -> str:
    return " ".join(f"{number:.7g}" for number in numbers)


def _surface_of(mitsuba: Any, properties: Any) -> Kept:
    """Find what a scene's entry refers to: a surface of this process, or a table's file."""
    key = int(properties.get("kept", -1))
    if key >= 0:
        return _kept[key]
    texts = {
        name: [float(word) for word in properties.get(name, start).split()]
        for name, start in (("diffuse", "0 0 0"), ("fresnel", "1 1 1 1 1 1"), ("window", ""))
    }
    material = Material(
        texts["diffuse"],
        float(properties.get("specular", 0.0)),
        float(properties.get("roughness", 0.1)),
        float(properties.get("diffraction", 1.0)),
        np.array(texts["fresnel"]).reshape(-1, 3),
        properties.get("geometry", "one"),
        (texts["window"][0], texts["window"][1]) if texts["window"] else None,
    )
    place = mitsuba.file_resolver().resolve(properties["table"])
    return Kept(read_table(str(place)), material)


def _lobes_of(mitsuba: Any, kept: Kept) -> Lobes:
    """Refuse a surface that the variant has no light for."""
    spectral = "spectral" in mitsuba.variant()
    if spectral and not kept.patterns:
        raise refuse.Refusal(
            "'table' holds a light's spectrum already; spectral variants want patterns, tables 'llvm_ad_rgb'."
        )
    if kept.patterns and not spectral:
        raise refuse.Refusal("'table' must be a table in a variant of RGB; patterns want 'llvm_ad_spectral'.")
    return SpectralLobes(mitsuba, kept) if spectral else Lobes(mitsuba, kept)


def _register(mitsuba: Any) -> None:
    """Define the BSDF for the variant that is set: its base class is another in each."""
    dr = importlib.import_module("drjit")

    class SurfaceBSDF(mitsuba.BSDF):  # type: ignore[misc]
        """The material of `scene.render`, drawn by its own lobes."""

        def __init__(self, properties: Any) -> None:
            super().__init__(properties)
            self.of = _lobes_of(mitsuba, _surface_of(mitsuba, properties))
            flags = mitsuba.BSDFFlags
            flag = flags.GlossyReflection | flags.FrontSide | flags.BackSide | flags.Anisotropic
            self.m_components, self.m_flags = [flag], flag

        def traverse(self, callback: Any) -> None:
            """Offer nothing: a table is not a parameter to be optimised."""

        def turned(self, si: Any, direction: Any) -> Any:
            """Turn a back side up, with t and b where they were; b follows the texture's v."""
            b = dr.mulsign(direction.y, dr.dot(dr.cross(si.n, si.dp_du), si.dp_dv))
            return mitsuba.Vector3f(direction.x, b, dr.abs(direction.z))

        def sample(self, context: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            """Draw a direction; its weight is f_r cos / p."""
            wi = self.turned(si, si.wi)
            wo, above = self.of.drawn(wi, sample1, sample2)
            active &= above & (wi.z > 0.0)
            density = dr.select(active, self.of.density(wi, wo), 0.0)
            found = dr.zeros(mitsuba.BSDFSample3f)
            out = self.turned(si, wo)
            found.wo = mitsuba.Vector3f(out.x, out.y, dr.mulsign(wo.z, si.wi.z))
            found.pdf = density
            found.eta = 1.0
            found.sampled_type = mitsuba.UInt32(+self.m_flags)
            found.sampled_component = 0
            active &= density > 0.0
            return found, dr.select(active, self.of.reflected(wi, wo, si) / density, 0.0)

        def eval(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Return f_r cos."""
            return self.eval_pdf(context, si, wo, active)[0]

        def pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Return the density of `sample` over solid angle."""
            return self.eval_pdf(context, si, wo, active)[1]

        def eval_pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            """Return both; directions on two sides see nothing of each other."""
            active &= si.wi.z * wo.z > 0.0
            wi, out = self.turned(si, si.wi), self.turned(si, wo)
            value = dr.select(active, self.of.reflected(wi, out, si), 0.0)
            return value, dr.select(active, self.of.density(wi, out), 0.0)

        def to_string(self) -> str:
            """Name the plugin."""
            return PLUGIN

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
