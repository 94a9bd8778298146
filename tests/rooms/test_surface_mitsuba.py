"""Mitsuba's BSDF of a table: its values, densities and samples; who has no Mitsuba is told what to do."""

import sys

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.surface import mitsuba as plugin
from aureole.surface.mitsuba_lobes import sampling_density

FOUND = plugin.probe()
needs_mitsuba = pytest.mark.skipif(not FOUND.works, reason=FOUND.reason)
INCIDENCES = (0.05, 0.3, 0.9)
COUNT = 1 << 18


@pytest.fixture(scope="module")
def table():
    h = surface.table.axis(129)
    lobes = sum(
        np.exp(-((h[None, :] - m * 0.35) ** 2 + h[::-1, None] ** 2) / 0.02) for m in (-2, -1, 0, 1, 2)
    )
    return surface.scatter_table(lobes[..., None] * np.array([0.09, 0.1, 0.12]), (1.0, 1.0, 1.0))


def interaction(mitsuba, angle):
    import drjit

    si = drjit.zeros(mitsuba.SurfaceInteraction3f, COUNT)
    si.wi = mitsuba.Vector3f(float(np.sin(angle)), 0.0, float(np.cos(angle)))
    return si


def uniform_directions(mitsuba):
    x, y = np.random.default_rng(5).random((2, COUNT)).astype(np.float32)
    return mitsuba.warp.square_to_uniform_hemisphere(mitsuba.Point2f(mitsuba.Float(x), mitsuba.Float(y)))


def draws(mitsuba, bsdf, si):
    x, y, z = np.random.default_rng(6).random((3, COUNT)).astype(np.float32)
    place = mitsuba.Point2f(mitsuba.Float(y), mitsuba.Float(z))
    return bsdf.sample(mitsuba.BSDFContext(), si, mitsuba.Float(x), place)


@needs_mitsuba
@pytest.mark.parametrize("angle", INCIDENCES)
def test_values_are_the_table_s(table, angle):
    mitsuba = plugin.use()
    bsdf = mitsuba.load_dict(plugin.bsdf(table))
    wo = uniform_directions(mitsuba)
    found = np.array(bsdf.eval(mitsuba.BSDFContext(), interaction(mitsuba, angle), wo)).T
    out = np.array(wo)
    h_t, h_b = out[0] + np.sin(angle), out[1]
    xyz = surface.lookup(table, h_t, h_b)
    wanted = 4 * np.pi**2 * out[2][:, None] * np.asarray(light.from_xyz(xyz, white=table.white))
    np.testing.assert_allclose(found, wanted, atol=1e-4 * np.abs(wanted).max())


@needs_mitsuba
@pytest.mark.parametrize("angle", INCIDENCES)
def test_samples_weigh_as_much_as_the_albedo(table, angle):
    mitsuba = plugin.use()
    bsdf = mitsuba.load_dict(plugin.bsdf(table))
    weights = np.array(draws(mitsuba, bsdf, interaction(mitsuba, angle))[1]).T
    wanted = light.from_xyz(surface.albedo(table, (np.sin(angle), 0.0)), white=table.white)
    np.testing.assert_allclose(weights.mean(axis=0), wanted, rtol=0.01)


@needs_mitsuba
@pytest.mark.parametrize("angle", INCIDENCES)
def test_the_density_integrates_to_the_share_of_samples_that_leave(table, angle):
    mitsuba = plugin.use()
    bsdf, si = mitsuba.load_dict(plugin.bsdf(table)), interaction(mitsuba, angle)
    density = np.array(bsdf.pdf(mitsuba.BSDFContext(), si, uniform_directions(mitsuba)))
    left = np.array(draws(mitsuba, bsdf, si)[0].pdf) > 0
    assert 0.3 < left.mean() <= 1.0
    np.testing.assert_allclose(2 * np.pi * density.mean(), left.mean(), rtol=0.04)


def test_the_sampling_density_is_brightness_per_step_of_u(table):
    even = surface.scatter_table(np.ones((33, 33, 3)), (1.0, 1.0, 1.0), warp=3)
    density = sampling_density(even)
    u = np.linspace(-1, 1, 33)[1:-1]
    np.testing.assert_allclose(density[16, 24] / density[16, 20], (u[23] / u[19]) ** 2, rtol=0.01)
    assert density.min() > 0
    assert density.max() == 1


def test_without_mitsuba_the_line_that_installs_it_is_named(monkeypatch, table):
    monkeypatch.setattr(plugin, "_PROBE", "import no_such_mitsuba")
    found = plugin.probe.__wrapped__("llvm_ad_rgb")
    assert not found.works
    assert found.reason == 'Mitsuba is not installed; install it with: pip install "aureole[mitsuba]".'
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    scene = surface.Scene((), surface.view_from((0.0, 0.0, 1.0)))
    with pytest.raises(refuse.Refusal, match=r"Mitsuba is not installed; install it with: pip install"):
        surface.mitsuba_scene(scene, table, surface.Disc(1.0))


def test_a_library_that_kills_the_process_is_named_and_kills_nothing_here(monkeypatch, tmp_path):
    (tmp_path / "libLLVM-99.so").touch()
    monkeypatch.setattr(plugin, "_LLVM_PLACES", (str(tmp_path / "libLLVM*.so"),))
    monkeypatch.setattr(plugin, "_PROBE", "import os; os.abort()")
    found = plugin.probe.__wrapped__("llvm_ad_rgb")
    assert not found.works
    assert found.reason == (
        "Mitsuba's variant 'llvm_ad_rgb' fails here (with libLLVM-99.so: the process ended with -6); "
        "install LLVM's library, on Debian and Ubuntu with: apt-get install libllvm15."
    )


def test_a_library_that_works_is_found_where_the_first_does_not(monkeypatch, tmp_path):
    (tmp_path / "libLLVM-15.so").touch()
    monkeypatch.setattr(plugin, "_LLVM_PLACES", (str(tmp_path / "libLLVM*.so"),))
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(plugin, "_PROBE", "import os, sys; sys.exit('DRJIT_LIBLLVM_PATH' not in os.environ)")
    found = plugin.probe.__wrapped__("llvm_ad_rgb")
    assert found.works
    assert found.environment == {"DRJIT_LIBLLVM_PATH": str(tmp_path / "libLLVM-15.so")}


def test_a_library_loaded_before_is_refused(monkeypatch):
    wanted = plugin.Probe("llvm_ad_rgb", True, environment={"DRJIT_LIBLLVM_PATH": "/lib/libLLVM-15.so"})
    monkeypatch.setattr(plugin, "probe", lambda variant: wanted)
    monkeypatch.setitem(sys.modules, "drjit", sys)
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    with pytest.raises(
        refuse.Refusal, match=r"imported already; set DRJIT_LIBLLVM_PATH=/lib/libLLVM-15\.so first"
    ):
        plugin.use()


def test_refusals_say_what_is_allowed(table):
    with pytest.raises(refuse.Refusal, match="'variant' must be one of 'llvm_ad_rgb'"):
        plugin.probe("llvm_rgb")
    with pytest.raises(refuse.Refusal, match="'specular' must"):
        plugin.bsdf(table, surface.Material(specular=-1.0))
