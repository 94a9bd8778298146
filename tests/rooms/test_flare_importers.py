"""Lens files of other programs: shipped lenses written in each format come back as they were."""

import json
import re

import pytest

from aureole import flare, refuse
from aureole.flare import lint, paraxial

HELIAR = "heliar_tronnier_100mm"
SUFFIXES = (".zmx", ".seq", ".xml", ".json", ".lens", ".dat")


def rows(lens):
    """Return (radius, thickness, n_d, V_d, semi-aperture, stop) of each surface in millimetres."""
    return [
        (
            1e3 / s.curvature if s.curvature else 0.0,
            1e3 * s.thickness,
            s.glass.index,
            s.glass.abbe or 0.0,
            1e3 * s.semi_aperture,
            s.stop,
        )
        for s in lens.surfaces
    ]


def as_zmx(lens, unit="MM", scale=1.0):
    lines = ["MODE SEQ", f"NAME {lens.title}", f"UNIT {unit} X W X CM MR CPMM", f"FNUM {lens.f_number} 0"]
    lines += ["SURF 0", "  TYPE STANDARD", "  CURV 0.0", "  DISZ INFINITY"]
    for k, (r, t, n, v, semi, stop) in enumerate(rows(lens), 1):
        lines += [f"SURF {k}"] + ["  STOP"] * stop + ["  TYPE STANDARD"]
        lines += [f"  CURV {scale / r if r else 0.0!r} 0 0 0 0", f"  DISZ {t / scale!r}"]
        lines += [f"  GLAS ___BLANK 1 0 {n} {v} 0 0 0 0 0 0"] * (n != 1)
        lines += [f"  DIAM {semi / scale!r} 1 0 0 1"]
    return "\n".join([*lines, f"SURF {k + 1}", "  TYPE STANDARD", "  CURV 0.0", "  DISZ 0"])


def as_seq(lens):
    lines = ["RDM;LEN", f"TITLE '{lens.title}'", "EPD 28.9", "DIM M", "WL 587.6", "SO 0.0 0.1e14"]
    for r, t, n, v, semi, stop in rows(lens):
        # A made-up glass has its code for a name: three digits of n_d - 1, three of V_d.
        code = "" if n == 1 else f" {round(1000 * (n - 1))}.{round(10 * v)}"
        lines += [f"S {r!r} {t!r}{code}", f"  CIR {semi!r}"] + ["  STO"] * stop
    return "\n".join([*lines, "  PIM", "SI 0.0 0.0", "GO"])


def as_xml(lens):
    text = "<opticalSystem><name>test</name><fnumber>22</fnumber>"
    text += f"<effectiveFocalLength>{1e3 * lens.focal_length}</effectiveFocalLength>"
    text += "<filmWidth>36</filmWidth><filmHeight>24</filmHeight><elements>"
    for r, t, n, v, semi, stop in rows(lens):
        coat = 0 if stop else 620
        text += (
            f"<element><type>{'apertureStop' if stop else 'lensSpherical'}</type><height>{semi!r}</height>"
        )
        text += f"<thickness>{t!r}</thickness><radius>{r!r}</radius><refractiveIndex>{n}</refractiveIndex>"
        text += f"<abbeNumber>{v or 89.3}</abbeNumber><coatingLambda>{coat}</coatingLambda>"
        text += f"<coatingIor>{1.38 if coat else 0}</coatingIor></element>"
    text += "<element><type>sensor</type><height>18</height><thickness>0.001</thickness></element>"
    return text + "</elements></opticalSystem>"


def as_json(lens):
    keys = ("radius", "distance", "refractive_index", "abbe_nr", "height")
    elements = [dict(zip(keys, row[:5], strict=True)) for row in rows(lens)]
    model = {"name": lens.title, "patent_number": "2645156", "focal_length": 100, "fstop": 3.5}
    return json.dumps(model | {"aperture_index": lens.stop, "lens_elements": elements})


def as_lens(lens):
    lines = ["# Test", "# Patent: US2645156", f"# 9 surfaces, f/{lens.f_number}", "", "name: Test"]
    lines += [
        f"focal_length: {1e3 * lens.focal_length}",
        "",
        "surfaces:",
        "# radius thickness ior abbe semi_ap",
    ]
    before = 1.0
    for r, t, n, v, semi, stop in rows(lens):
        # The published library coats what leads into glass, and nothing else.
        coat = int(n != 1)
        lines.append(f"  {'stop' if stop else repr(r)} {t!r} {n} {v} {2 * semi!r} {coat}  # {before}")
        before = n
    return "\n".join(lines)


def as_dat(lens, before=False):
    lines = ["# A lens", "# radius distance index diameter"]
    gap = 0.0
    for r, t, n, _, semi, stop in rows(lens):
        lines.append(f"{r!r} {gap if before else t!r} {0 if stop else n} {2 * semi!r}")
        gap = t
    return "\n".join(lines)


WRITERS = dict(zip(SUFFIXES, (as_zmx, as_seq, as_xml, as_json, as_lens, as_dat), strict=True))


@pytest.fixture
def file_of(tmp_path):
    def write(content, name):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_lens_comes_back_from_every_format(suffix, file_of):
    lens = flare.load(HELIAR)
    found, _ = flare.import_lens(file_of(WRITERS[suffix](lens), "lens" + suffix))
    assert found.stop == lens.stop
    for one, other in zip(found.surfaces, lens.surfaces, strict=True):
        assert one.curvature == pytest.approx(other.curvature, rel=1e-12)
        assert one.semi_aperture == pytest.approx(other.semi_aperture, rel=1e-12)
        # A code has three digits of the index and of the Abbe number.
        assert one.glass.index == pytest.approx(other.glass.index, rel=1e-12)
        if other.glass.abbe and suffix != ".dat":
            assert one.glass.abbe == pytest.approx(other.glass.abbe, abs=0.051)
        assert one.thickness == pytest.approx(other.thickness, rel=1e-9)
    assert found.focal_length == pytest.approx(0.1, rel=0.01)
    assert paraxial.f_number(found) == pytest.approx(3.43, abs=0.005)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_imported_is_a_file_of_ours(suffix, file_of, tmp_path):
    found, _ = flare.import_lens(file_of(WRITERS[suffix](flare.load(HELIAR)), "lens" + suffix))
    flare.write(tmp_path / "out.toml", found)
    again = flare.load(tmp_path / "out.toml")
    assert flare.to_toml(again) == flare.to_toml(found)
    assert len(flare.ghosts(again)) == 13


def test_coatings_are_kept_where_they_belong(file_of):
    lens = flare.load(HELIAR)
    from_xml, _ = flare.import_lens(file_of(as_xml(lens), "a.xml"))
    layers = [s.coating.layers for s in from_xml.surfaces if s.coating]
    # The tile paper's authors coat cemented surfaces, too: kept as listed, and found by the check.
    assert layers == [(flare.quarter_wave(1.38, 620e-9),)] * 8
    assert [f.surface for f in lint.findings(from_xml) if f.kind == "coating"] == [2, 8]
    from_lens, notes = flare.import_lens(file_of(as_lens(lens), "a.lens"))
    assert "cemented surfaces that are coated in the file, bare here: 2" in notes
    said = [found.text for found in lint.findings(from_lens)]
    assert said == ["all 3 surfaces from glass to air are bare, those from air to glass are not"]


def test_diameters_become_semi_apertures(file_of):
    lens = flare.load(HELIAR)
    for text, name, column in ((as_lens(lens), "a.lens", "'semi_ap'"), (as_dat(lens), "a.dat", "fourth")):
        found, notes = flare.import_lens(file_of(text, name))
        assert found.surfaces[lens.stop].semi_aperture == pytest.approx(11.6e-3)
        assert any(column in note and "half" in note for note in notes)


@pytest.mark.parametrize(("unit", "scale"), [("CM", 10.0), ("IN", 25.4), ("METER", 1000.0)])
def test_units_of_zemax(unit, scale, file_of):
    found, notes = flare.import_lens(file_of(as_zmx(flare.load(HELIAR), unit, scale), "a.zmx"))
    assert paraxial.focal_length(found) == pytest.approx(99.2358e-3, rel=1e-5)
    assert f"lengths are multiplied by {scale:g} to be millimetres" in notes


def test_zemax_writes_utf_16(file_of):
    text = as_zmx(flare.load(HELIAR))
    found, _ = flare.import_lens(file_of(text.encode("utf-16"), "a.ZMX"))
    assert found.title.startswith("Voigtländer")


def test_glass_by_name_and_what_no_catalogue_has(file_of):
    text = as_zmx(flare.load(HELIAR)).replace("___BLANK", "H-ODD1", 1).replace("___BLANK", "N-BK7", 1)
    found, notes = flare.import_lens(file_of(text.replace("___BLANK", "BK7", 1), "a.zmx"))
    assert found.surfaces[0].glass == flare.Glass("", 1.652, 58.57)
    assert found.surfaces[1].glass is flare.named("N-BK7")
    assert "glass BK7 is taken as N-BK7" in notes
    assert "glass H-ODD1 is in no catalogue here: the file's n_d 1.652 and V_d are used" in notes


def test_aspheres_of_zemax(file_of):
    text = as_zmx(flare.load(HELIAR))
    head, sep, tail = text.partition("SURF 1\n  TYPE STANDARD\n")
    asphere = "SURF 1\n  TYPE EVENASPH\n  CONI -0.5\n  PARM 1 0\n  PARM 2 1.5E-6\n  PARM 4 -2E-12\n"
    found, _ = flare.import_lens(file_of(head + asphere + tail, "a.zmx"))
    first = found.surfaces[0]
    assert first.conic == -0.5
    assert first.asphere == pytest.approx((1.5e-6 * 1e9, 0.0, -2e-12 * 1e21))
    with pytest.raises(refuse.Refusal, match=r"line 9: a term of r² cannot be read\.$"):
        flare.import_lens(file_of(head + asphere.replace("PARM 1 0", "PARM 1 1e-3") + tail, "b.zmx"))
    assert sep


def test_aspheres_curvatures_and_inches_of_code_v(file_of):
    """A plano-convex lens of one inch in inches, with its curvature and its terms."""
    text = (
        "RDM N\nLEN\nTITLE 'Singlet'\nEPD 0.5\nDIM I\nSO 0 1e10\nS 1.0 0.2 NBK7_SCHOTT\n  STO; ASP\n"
        "  K -0.6; A 0.1\n  B 0.02; C 0 &\n\nS 0 0\nSI 0 0\nGO\n"
    )
    found, notes = flare.import_lens(file_of(text.replace("C 0 &", "C 0"), "a.seq"))
    first = found.surfaces[0]
    assert first.curvature == pytest.approx(1 / 25.4e-3, rel=1e-9)
    assert first.conic == -0.6
    assert first.asphere == pytest.approx((0.1 / 25.4e-3**3, 0.02 / 25.4e-3**5, 0.0))
    # f = R / (n - 1); the sensor is set to the focus; the pupil sets the semi-apertures.
    assert found.focal_length == pytest.approx(25.4e-3 / 0.5168, rel=1e-4)
    assert paraxial.back_focus(found) == pytest.approx(found.sensor_distance, abs=1e-8)
    assert first.semi_aperture == pytest.approx(0.25 * 25.4e-3, rel=1e-4)
    assert "semi-apertures not in the file, set by the light on the axis: 2" in notes


def test_marks_in_air_are_left_out(file_of):
    """A plane 5 mm in front, and one between two lenses, say nothing; their distances stay."""
    text = as_seq(flare.load(HELIAR)).replace("SO 0.0 0.1e14", "SO 0.0 0.1e14\nS 0 5")
    text = text.replace("S 580.38 3.52\n", "S 580.38 1.52\nS 0 2\n")
    found, notes = flare.import_lens(file_of(text, "a.seq"))
    assert len(found.surfaces) == 9
    assert found.surfaces[2].thickness == pytest.approx(3.52e-3)
    assert "planes in air that only mark a place, left out: 2" in notes


def test_distances_in_front_of_surfaces(file_of):
    lens = flare.load(HELIAR)
    found, notes = flare.import_lens(file_of(as_dat(lens, before=True), "a.dat"))
    assert "distances stand before their surfaces in the file" in notes
    assert found.surfaces[0].thickness == pytest.approx(7.7e-3)
    # The last distance is not there: the sensor is set to the focus.
    assert found.sensor_distance == pytest.approx(lens.sensor_distance, abs=1e-6)


def test_cylinders_of_flaresim(file_of):
    text = as_lens(flare.load(HELIAR)).replace(" 1  # 1.0", " 1 cyl_y # 1.0", 1)
    found, _ = flare.import_lens(file_of(text, "a.lens"))
    assert found.surfaces[0].cylinder == "x"
    with pytest.raises(refuse.Refusal, match=r"line 10: surfaces of type 'toric' cannot be read\.$"):
        flare.import_lens(file_of(text.replace("cyl_y", "toric"), "b.lens"))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.zmx", "", "'{}' holds no lens: 0 surfaces were found."),
        ("a.seq", "LEN\nGO\n", "'{}' holds no lens: 0 surfaces were found."),
        ("a.seq", "S 1 x\n", "'{}' line 1: a number is needed, got 'x'."),
        ("a.seq", "S 1\n", "'{}' line 1: a surface needs its radius and its thickness."),
        ("a.seq", "S 1 2 BK7\nADE 3\n", "'{}' line 2: 'ADE' cannot be read; surfaces about one axis can."),
        ("a.seq", "S 1 nan\n", "'{}' line 1: a number is needed, got 'nan'."),
        (
            "a.seq",
            "S 1 2 NBK77\n",
            "the catalogue of glasses has no 'NBK77'. Did you mean 'N-BK7'?",
        ),
        ("a.xml", "<a", "'{}' is not XML: unclosed token: line 1, column 0."),
        ("a.xml", "<a/>", "'{}' is not an OpenLensFlare system: no <elements> in <opticalSystem>."),
        (
            "a.xml",
            "<!DOCTYPE a [<!ENTITY b 'c'>]><a/>",
            "'{}' has a document type; an OpenLensFlare system has none.",
        ),
        (
            "a.xml",
            "<opticalSystem><elements><element><type>lensAspherical</type></element></elements></opticalSystem>",
            "'{}': elements of type 'lensAspherical' cannot be read.",
        ),
        ("a.json", "{", "'{}' is not JSON."),
        ("a.json", "[" * 100000, "'{}' is not JSON."),
        ("a.json", "[]", "'{}' is not a realflare lens model: it has no list 'lens_elements'."),
        (
            "a.json",
            '{"lens_elements": [{"radius": "x"}, {"radius": 1}]}',
            "'{}': 'radius' of element 1 must be a number.",
        ),
        ("a.lens", "surfaces:\n1 2 3\n", "'{}' line 2: a surface needs five columns, got 3."),
        ("a.dat", "1 2 3\n", "'{}' line 1: a surface needs four numbers, got 3."),
        ("a.dat", "50 3 1.5 10\n-50 0 1 10\n", "'{}' has no stop: give one surface 'stop = true'."),
        (
            "a.dat",
            "-50 3 1.5 10\n50 3 1 10\n0 0 0 9\n",
            "'{}' has no focus behind the last surface: are the signs of its radii right?",
        ),
    ],
)
def test_hostile_files_are_refused_in_one_line(name, content, message, file_of):
    path = file_of(content, name)
    with refused(message.format(path)):
        flare.import_lens(path)


def test_other_files_are_refused(file_of, tmp_path):
    with pytest.raises(
        refuse.Refusal, match=r"^'suffix of the lens file' must be one of '\.zmx', .*'\.obj'\.$"
    ):
        flare.import_lens("lens.obj")
    missing = tmp_path / "missing.zmx"
    with refused(f"'{missing}' cannot be read: No such file or directory."):
        flare.import_lens(missing)
    large = file_of(b" " * 5_000_001, "large.zmx")
    with refused(f"'{large}' is larger than 5 MB: no lens file is."):
        flare.import_lens(large)


def test_lenses_open_by_name_or_file(file_of):
    lens, notes = flare.open_lens(HELIAR)
    assert (lens, notes) == (flare.load(HELIAR), [])
    path = file_of(as_json(lens), "a.json")
    assert len(flare.open_lens(path)[0].surfaces) == 9
    with refused(f"'{path}' has no positions of a zoom."):
        flare.open_lens(path, "wide")
