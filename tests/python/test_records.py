"""Files of records: each format, as its definition says, gives back the signal that was written; what is wrong is refused with its line."""

import sys
import time
import types

import numpy as np
import pytest
from record_files import DT, afad, at2, cosmos, csmip_1, csmip_2, esm, fortran, knet, signal, smc

import masonry

A = signal()  # m/s^2
G = 9.80665
GAL = 100 * A


@pytest.fixture
def path(tmp_path):
    """Writes the text to a file and returns its path."""
    def write(text, name="record.txt", encoding="latin-1"):
        file = tmp_path / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return file

    return write


def brief(value):
    """Name of a parameter: files by their first words."""
    return str(value).split("\n")[0][:30]


def same(record, values, rounding=0.0):
    """The record has these accelerations, but for the last digit of the file (m/s^2) and round-off."""
    assert record.dt == pytest.approx(DT, rel=1e-12)
    assert record.samples.shape == values.shape
    np.testing.assert_allclose(record.samples, values, rtol=1e-12, atol=0.5001 * rounding)


# --- each format ---

# The rounding of 15.7E is half of 1e-7 of the decade of a value: 2 m/s^2 are 0.2 g.
@pytest.mark.parametrize("options, factor", [
    ({}, G), (dict(before=["a line", "CORRECTED BY SOMEBODY", ""]), G), (dict(after=["COLUMNS 5"]), G), (dict(per_line=1), G), (dict(per_line=8), G),
    (dict(points="{count:5d}   {dt:.4f}  NPTS, DT"), G), (dict(points="DT= {dt:.4f}SEC, NPTS= {count}"), G), (dict(points="NPTS={count}, DT=10 MSEC"), G),
    (dict(points="NPTS={count}, DT=.1000D-01 SEC"), G), (dict(points="{count},0.0100   NPTS, DT"), G), (dict(unit="ACCELERATION IN UNITS OF CM/S^2"), 0.01), (dict(unit="ACCELERATION (GAL)"), 0.01),
    (dict(unit="ACCELERATION TIME HISTORY IN UNITS OF G.  FILTER POINTS: HP=0.1 Hz"), G), (dict(form=fortran(15, 7, "D")), G),
    (dict(form=fortran(14, 7, "E")), G)])
def test_peer(path, options, factor):
    file = path(at2(A / factor, **options), "RSN6_180.AT2")
    record = masonry.read_record(file)
    same(record, A, 1e-7 * factor * np.abs(A / factor).max() * 10)
    assert (record.source.format, record.source.file, record.name) == ("PEER", "RSN6_180.AT2", "A QUAKE, 1/1/1990, SOME STATION, 090")
    assert (record.source.station, record.source.component) == ("SOME STATION", "090")


@pytest.mark.parametrize("end", ["\r\n", "\r\r\n", "\r", "mixed"])
@pytest.mark.parametrize("text", [at2(A / G), esm(GAL), knet(np.round(1e3 * A).astype(int)), smc(GAL), csmip_1(A / G), cosmos(GAL), afad([GAL, -GAL, 2 * GAL])],
                         ids=["PEER", "ESM", "K-NET", "SMC", "CSMIP", "COSMOS", "AFAD"])
def test_line_ends(path, text, end):
    options = dict(component="N-S") if text.startswith("STRONG") else {}
    wanted = masonry.read_record(path(text), **options)
    lines = text.split("\n")
    turned = "".join(line + ("\r\n", "\n", "\r\r\n")[k % 3] for k, line in enumerate(lines)) if end == "mixed" else end.join(lines)
    np.testing.assert_array_equal(masonry.read_record(path(turned), **options).samples, wanted.samples)


@pytest.mark.parametrize("units, factor", [("cm/s^2", 0.01), ("cm/s2", 0.01), ("gal", 0.01), ("m/s^2", 1), ("g", G), ("mm/s^2", 1e-3)])
def test_esm(path, units, factor):
    record = masonry.read_record(path(esm(A / factor, units)))
    same(record, A, 1e-6 * factor)
    assert (record.source.format, record.source.station, record.source.component, record.source.unit) == ("ESM", "XX.ABC", "HNE", units)
    assert str(record.source) == f"ESM file record.txt: XX.ABC HNE, unit {units}"


def test_afad(path):
    file = path(afad([GAL, -GAL, 2 * GAL]))
    for component, factor in (("N-S", 1), ("e-w", -1), ("UD", 2)):
        same(masonry.read_record(file, component), factor * A, 1e-8)
    with pytest.raises(ValueError, match="has 3 components: component= must say which: 'N-S', 'E-W', 'U-D'"):
        masonry.read_record(file)
    with pytest.raises(ValueError, match="component = 'Z': must be one of those of .*: 'N-S', 'E-W', 'U-D'"):
        masonry.read_record(file, "Z")


@pytest.mark.parametrize("factor, gal", [("3920(gal)/6182761", 3920 / 6182761), ("2000(gal)/8388608", 2000 / 8388608), ("3920.0(gal) / 6182761", 3920 / 6182761)])
def test_knet(path, factor, gal):
    counts = np.round(GAL / gal).astype(int)
    record = masonry.read_record(path(knet(counts, factor=factor)))
    same(record, A, 0.01 * gal)
    assert (record.source.format, record.source.station, record.source.component) == ("K-NET", "ABC001", "N-S")
    assert masonry.read_record(path(knet(counts, direction="4"))).source.component == "N-S"  # KiK-net numbers the directions


@pytest.mark.parametrize("options", [{}, dict(kind="1 UNCORRECTED ACCELEROGRAM"), dict(unknown=(0, 1e38)), dict(comments=()), dict(comments=["x"] * 30)])
def test_smc(path, options):
    record = masonry.read_record(path(smc(GAL, **options)))
    same(record, A, 1e-4 * 1e-2 * 1000)  # four decimals of the mantissa, of at most 1000 gal
    assert (record.source.station, record.source.component, record.source.unit) == ("ABC", "up", "cm/s^2")


@pytest.mark.parametrize("unit", [", in cm/sec2. (8f10.3)", ". (UNITS: CM/SEC/SEC)", " (in cm/sec/sec)"])
def test_csmip_volume_2(path, unit):
    channels = {(1, "360 Deg"): (GAL, GAL, GAL), (2, "Up"): (2 * GAL, GAL, GAL), (3, " 90 Deg"): (3 * GAL, GAL, GAL)}
    file = path(csmip_2(channels, unit))
    for component, factor in (("360", 1), (1, 1), ("Up", 2), (3, 3), ("90 deg", 3)):
        record = masonry.read_record(file, component)
        same(record, factor * A, 1e-5)
    assert (record.source.format, record.source.station, record.source.component) == ("CSMIP V1/V2", "89146 Some Creek", "90 Deg")
    with pytest.raises(ValueError, match="3 components: component= must say which: 1 '360 Deg', 2 'Up', 3 '90 Deg'"):
        masonry.read_record(file)
    with pytest.raises(ValueError, match="component = 4: must be one of"):
        masonry.read_record(file, 4)


@pytest.mark.parametrize("unit, factor", [("in units of g .", G), ("in units of cm/sec2.", 0.01), ("units: gal", 0.01)])
def test_csmip_volume_1(path, unit, factor):
    record = masonry.read_record(path(csmip_1(A / factor / (1 if factor == G else 100), unit)))
    same(record, A / (1 if factor == G else 100), 1e-6 * factor)
    assert record.source.component == "360 Deg"


def test_full_columns(path):
    """Numbers that fill their columns: the format on the line parts them; without it they are refused, not read as others."""
    values = np.array([1.5, 12.345678, 99.654321, -9.123456, 10.0, 20.0, 30.0, 40.0])
    text = csmip_1(values, "in units of cm/sec2 .")
    assert "12.34567899.654321-9.123456" in text
    np.testing.assert_allclose(masonry.read_record(path(text)).samples, 0.01 * values, rtol=1e-14)
    with pytest.raises(ValueError, match="line 9: '1.50000012.34.*' stands among the values"):
        masonry.read_record(path(text.replace("(8f9.6)", "")))


@pytest.mark.parametrize("units, factor", [("cm/sec2(04)", 0.01), ("cm/s^2 (4)", 0.01), ("cm/s^2", 0.01), ("g (02)", G)])
@pytest.mark.parametrize("reals", [{62: 10.0, 63: 0.5}, {34: 0.01}, {34: 0.02, 62: 10.0}])
def test_cosmos(path, units, factor, reals):
    """The step of the data is in ms, that of the recorder, which may be another, in s."""
    long = signal(3000)
    reals = {**reals, 40: 123.0}
    record = masonry.read_record(path(cosmos(long / factor, units=units, reals=reals)))
    same(record, long, 1e-5 * factor)
    assert (record.source.format, record.source.component) == ("COSMOS", "90 deg")
    assert record.source.station == "37-000011 Code:XX-ABC XXX Some River"


def test_cosmos_forms_and_channels(path):
    same(masonry.read_record(path(cosmos(GAL, form=lambda value: f"{value:15.6E}"))), A, 1e-6 * 1e-2 * 1000)
    assert masonry.read_record(path(cosmos(GAL, kind="raw accel.  "))).samples.tolist() == masonry.read_record(path(cosmos(GAL))).samples.tolist()
    text = cosmos(GAL, direction="Up") + cosmos(2 * GAL, direction="  0 deg", channel="2") + cosmos(GAL, kind="velocity", units="cm/s(05)", direction="Up")
    same(masonry.read_record(path(text), "up"), A, 1e-7)
    same(masonry.read_record(path(text), 2), 2 * A, 1e-7)
    other = cosmos(GAL, channel="?", direction="Other", scnl="ABC.HNZ.XX.--") + cosmos(2 * GAL, channel="?", direction="Other", scnl="ABC.HNE.XX.--")
    same(masonry.read_record(path(other), "HNE"), 2 * A, 1e-7)


@pytest.mark.parametrize("text, options", [
    ("".join(f"{k * DT:.2f},{value}\n" for k, value in enumerate(A)), dict(unit="m/s^2")),
    ("time (s),acceleration (m/s^2)\n" + "".join(f"{k * DT:.2f},{value}\n" for k, value in enumerate(A)), {}),
    ("t a[g] b[gal]\n" + "".join(f"{k * DT:.2f} {7} {100 * value:.3f}\n" for k, value in enumerate(A)), dict(component="b[gal]")),
    ("a[g],b[gal]\n" + "".join(f"{7},{100 * value:.3f}\n" for value in A), dict(component="b[gal]", dt=DT)),
    ("# comment\n" + "".join(f"{value:.5f}{' ' if (k + 1) % 8 else chr(10)}" for k, value in enumerate(A)), dict(unit="m/s^2", dt=DT, columns="all")),
    ("time (s),N-S (gal),E-W (gal)\n" + "".join(f"{k * DT:.2f},{100 * value:.3f},1\n" for k, value in enumerate(A)), dict(columns=(0, 1)))], ids=brief)
def test_text_files(path, text, options):
    same(masonry.read_record(path(text, encoding="utf-8"), **options), A)


# --- velocities and displacements of files ---

T = DT * np.arange(401)
U = 0.05 * np.sin(np.pi * T / 4) ** 4 * np.sin(5 * T)  # m; at rest at both ends
V = np.gradient(U, DT)


@pytest.mark.parametrize("text, quantity", [
    (at2(100 * U, "DISPLACEMENT TIME SERIES IN UNITS OF CM"), "displacement"), (at2(100 * V, "VELOCITY TIME SERIES IN UNITS OF CM/S"), "velocity"),
    (esm(100 * U, "cm", kind="DISPLACEMENT"), "displacement"), (esm(100 * V, "cm/s", kind="VELOCITY"), "velocity"),
    (smc(100 * U, "4 DISPLACEMENT"), "displacement"),
    (smc(100 * V, "3 VELOCITY"), "velocity"), (cosmos(100 * U, "displacement", "cm(06)"), "displacement"),
    ("".join(f"{1000 * u:.2f}\n" for u in U), "displacement")], ids=brief)
def test_velocities_and_displacements_of_files(path, text, quantity):
    record = masonry.read_record(path(text), **(dict(unit="mm", dt=DT) if text[0] in "-0" else {}))
    assert record.quantity == quantity
    moved, wanted = (record.displacement(T), U) if quantity == "displacement" else (record.velocity(T), V)
    # Five significant digits, of at most 0.25 m/s or 0.05 m, and the smoothing of these digits, which deviation states.
    assert np.abs(moved - wanted).max() <= 5.1e-5 * np.abs(wanted).max() + record.deviation
    assert record.deviation <= 1e-4 and "from its " + quantity in repr(record)


def test_quantity_of_a_file_with_all_three(path):
    file = path(csmip_2({(1, "360 Deg"): (GAL[:1].repeat(401), 100 * V, 100 * U)}))
    assert masonry.read_record(file).quantity == "acceleration"
    for quantity, wanted in (("velocity", V), ("displacement", U)):
        record = masonry.read_record(file, quantity=quantity)
        motion = record.velocity(T) if quantity == "velocity" else record.displacement(T)
        assert np.abs(motion - wanted).max() <= 1e-5  # three decimals of a centimetre
    with pytest.raises(ValueError, match="quantity = 'velocity': must be one of those of .*: acceleration"):
        masonry.read_record(path(at2(A / G)), quantity="velocity")
    with pytest.raises(ValueError, match="quantity = 'speed': must be one of acceleration, velocity, displacement"):
        masonry.read_record(file, quantity="speed")


# --- what is refused, with its line ---

def cut(text, lines):
    return "\n".join(text.split("\n")[:-lines - 1]) + "\n"


@pytest.mark.parametrize("text, words", [
    (cut(at2(A / G), 2), "lines 5 to 13 hold 40 values: must be NPTS = 50"), (at2(A / G, points="NPTS= 51, DT= .01 SEC"), "hold 50 values: must be NPTS = 51"),
    (at2(A / G, points="NPTS= 49, DT= .01 SEC"), "hold 50 values: must be NPTS = 49"),
    (at2(A / G, "ACCELERATION IN UNITS OF M"), "line 3 is .* must state ACCELERATION, VELOCITY"),
    (at2(A / G, "VELOCITY IN UNITS OF G"), "line 3 is .* must state"), (at2(A / G, before=["a"], unit="ACCELERATION"), "line 4 is 'ACCELERATION': must state"),
    (at2(A / G).replace("0", "NaN", 1).replace("E-01", "*****", 1), "line .* stands among the values: must be numbers, NPTS = 50 of them"),
    (cut(esm(GAL), 7), "hold 43 values: must be NDATA = 50"), (esm(GAL, count=49), "hold 50 values: must be NDATA = 49"),
    (esm(GAL, "counts"), "line 12 is 'UNITS: counts': must give a unit"),
    (esm(GAL, ""), "line 12 is 'UNITS:': must give a unit"), (esm(GAL, skip=["UNITS"]), "the header, in which UNITS is missing"),
    (esm(GAL, "cm"), "line 16 is 'DATA_TYPE: ACCELERATION': must be DISPLACEMENT"),
    (esm(GAL, count="many"), "line 9 is 'NDATA: many': must give a whole number"),
    (esm(GAL).replace("\n" + f"{GAL[9]:.6f}\n", "\nNULL\n"), "line 28: 'NULL' stands among the values"),
    (knet([1] * 40, seconds=0.5), "hold 40 values: must be the rate times Duration Time = 50"),
    (knet([1] * 50, factor="3920/6182761"), "line 14 is 'Scale Factor      3920/6182761': must be"),
    (knet([1] * 50, factor="3920(mgal)/6182761"), r"line 14 is .*must give a unit of acceleration in brackets, such as 3920\(gal\)"),
    (knet([1] * 50, factor="3920(gal)/0"), "must have a divisor above 0"),
    (knet([1] * 50, rate="fast"), "line 11 is 'Sampling Freq.*fast': must be"), (knet([1] * 50, memo=""), "Memo"),
    (smc(GAL, count=51), "hold 50 values: must be the number in line 14 = 51"), (smc(GAL, count=48), "hold 50 values"),
    (smc(GAL, kind="5 RESPONSE SPECTRA"), "line 1 is '5 RESPONSE SPECTRA': must be 1 UNC"),
    (smc(GAL, rate=1.7e38), "line 18 is .*must give the values a second.*unequal steps"),
    (smc(GAL, comments=["a"]).replace("|a", "a"), r"line 28 is 'a': must be one of 1 comments"),
    (smc(np.where(np.arange(50) == 20, 1.7e38, GAL), comments=(), form=lambda value: f"{value:10.3E}"), "line 30 is .*must hold values that are known"),
    (smc(GAL, count=-32768), "line 14 is .*must begin with the number of values"),
    (csmip_1(A / G, "in units of counts"), "line 8 is .*must give a unit of acceleration"),
    (csmip_1(A / G, ""), "line 8 is .*must give a unit of acceleration"),
    (csmip_2({(1, "Up"): (GAL, GAL, GAL)}, count=51), "line 18: 'points' stands among the values: must be numbers, points = 51 of them, and comes after 50"),
    (cut(csmip_2({(1, "Up"): (GAL, GAL, GAL)}), 3), "hold 40 values: must be points = 50"),
    (csmip_2({(1, "Up"): (GAL, GAL, GAL)}, ", in cm/sec. (8f10.3)"), "line 10 is .*must give a unit of acceleration"),
    (cosmos(GAL, units="counts (50)", first="Raw"), "line .*units=counts.*not counts, which only the network can convert"),
    (cosmos(GAL, kind="raw accel.  ", units="counts (50)"), "line .*raw accel.*units=counts.*not counts, which only the network can convert"),
    (cosmos(GAL, units="g (04)"), "line .*must give values in a unit of acceleration"),
    (cosmos(GAL, units="cm/s^2 (05)"), "must give values in a unit"), (cosmos(GAL, units="cm/s (05)"), "must give values in a unit"),
    (cosmos(GAL, reals={1: 0.0}), "must agree with the step of the header, which gives none"),
    (cosmos(GAL, count=51), "'End-of-data' stands among the values: must be numbers, pts = 51 of them, and comes after 50"),
    (cosmos(np.tile(GAL, 20), reals={62: 0.01}), r"must agree with the step of the header, real-header value 62 \(1e-05 s\)"),
    (afad([GAL] * 3, unit="counts"), r"line 8 is .*must give its unit in brackets, such as \(gal\)"),
    (afad([GAL] * 3, count=51), "hold 150 values: must be three times NUMBER OF DATA = 153"),
    (afad([GAL] * 3).replace("SAMPLING", "SIMPLING"), "line 1 is .*must be followed by a line `SAMPLING INTERVAL"),
    ("0,1\n0.01,2\n", "unit = None: must be given for a text file of columns"), ("time,acceleration [furlongs]\n0,1\n0.01,2\n", "unit = None: must be given"),
    ("a report\nof something\nelse\n", "line 2 is 'of something': must be as many numbers.* read as columns, because it has the header of no other format"),
    ("", "0 lines of numbers: must be at least two")], ids=brief)
def test_refused(path, text, words):
    with pytest.raises(ValueError, match=words) as refused:
        masonry.read_record(path(text))
    assert "record.txt" in str(refused.value) and "\n" not in str(refused.value) and len(str(refused.value)) < 500


TWO = csmip_2({(1, "Up"): (GAL, 0.5 * GAL, 0.3 * GAL), (2, "90 Deg"): (2 * GAL, GAL, 0.6 * GAL)})
THREE = cosmos(GAL) + cosmos(0.5 * GAL, kind="velocity", units="cm/s(05)") + cosmos(0.3 * GAL, kind="displacement", units="cm(06)")
PAIR = csmip_1(A / G) + csmip_1(A / G / 2, direction="90 Deg").replace("Chan  1", "Chan  2")


@pytest.mark.parametrize("text, options, old, new, words", [
    *((TWO, dict(component=component), "points of accel data", new, f"line .*{new}.*must say how many values of accel, veloc or displ data follow")
      for new in ("points of acc. data", "points of Accelerations, equally", "poin ts of accel data", "points of acel data") for component in (1, 2)),
    (TWO, dict(component=2), "points of veloc data", "points of vel. data", "line .*points of vel. data.*must say how many"),
    (TWO, dict(component=1), "Chan  2", "Chn  2", "line .*At equally-spaced.*stand in the header of a channel, such as 'Chan"),
    (PAIR, dict(component=2), "Accelerogram points", "Accelerogram pts", "line 8 .*Accelerogram pts.*must say how many"),
    (THREE, {}, "Corrected acceleration    (Format v", "Corrected acceleration    (Formt v", "line .* must stand in a record, which begins with a line such as"),
    (THREE, {}, "50 acceleration pts", "50 acceleration points", "line 48 is '50 acceleration points.*must be a comment.*or a line such as"),
    (THREE, dict(quantity="velocity"), "50 velocity pts", "50 velocty", "50 velocty.*must be a comment.*or a line such as"),
    (at2(A / G) + at2(A / G), {}, "", "", "line .*NPTS=    50.*must not be followed by values: those of the motion have ended above it"),
    (at2(A / G, points="NPTS= " + "9" * 5000 + ", DT= .01 SEC"), {}, "", "", "line 2 is .*read as columns, because it has the header of no other format"),
    (esm(GAL) + esm(GAL), {}, "", "", "must not be followed by values"), (esm(GAL), {}, "DURATION_S", "NDATA", "line 10 .*must not give NDATA again: line 9 has given it"),
    (smc(GAL, kind="3 CORRECTED ACCELEROGRAM"), {}, "", "", "line 1 is '3 CORRECTED ACCELEROGRAM': must be 1 UNC"),
    (csmip_1(A / G), {}, "at 100 pts/sec", "at 0 pts/sec", "line 8 .*must give a step, or a number of points a second, above 0"),
    (knet([1] * 50), {}, "100Hz", "1.0.0Hz", "line 11 .*must give a number above 0"), (afad([GAL] * 3), dict(component="N-S"), ": 0.01", ": 0.0l", "line 7 .*number of seconds above 0"),
    (esm(GAL), {}, ": 0.010000", ": 1_0", "line 8 .*must give a number of seconds above 0"), (esm(GAL), {}, f"{GAL[9]:.6f}", "1e400", "line 28 is '1e400': must hold numbers below 1.8e308"),
    ("time (ms),a (g)\n0,1\n10,2\n20,1\n", {}, "", "", r"the column of the times is named 'time \(ms\)': must be in seconds"),
    ("O.0,1.5\n0.1,2.5\n0.2,1\n", dict(unit="g"), "", "", "line 1 is 'O.0,1.5': must be numbers, or words that name the columns"),
    ("t (s),x (cm),y (gal)\n0,1\n1,2\n", {}, "", "", "unit = None: must be given"), ("time,a (g)\n0,1\n1d400,2\n", {}, "", "", "line 3 is '1d400,2': must be as many numbers"),
    ("time,a (g)\n0e400,1\n1,2\n2,1e999\n", {}, "", "", "line 4 is '2,1e999': must be as many numbers")], ids=brief)
def test_what_is_not_understood_is_refused(path, text, options, old, new, words):
    with pytest.raises(ValueError, match=words) as refused:
        masonry.read_record(path(text.replace(old, new, 1)), **options)
    assert "record.txt" in str(refused.value) and "\n" not in str(refused.value) and len(str(refused.value)) < 500


@pytest.mark.parametrize("text, options", [
    (at2(A / G), {}), (esm(GAL), {}), (knet(np.round(1e3 * A).astype(int)), {}), (smc(GAL), {}), (PAIR, dict(component=2)), (TWO, dict(component=2)),
    (TWO, dict(component=1, quantity="velocity")), (THREE, {}), (THREE, dict(quantity="velocity")), (afad([GAL, 2 * GAL, 3 * GAL]), dict(component="E-W"))], ids=brief)
def test_a_damaged_line_of_words_changes_no_reading(path, text, options):
    """A letter of a heading that has become an x, and a line that is lost, doubled, or the last one: the same motion is read, or the file is refused."""
    def reading(lines):
        record = masonry.read_record(path("\n".join(lines)), **options)
        return record.dt, record.quantity, record.samples.tolist()

    lines, refused = text.split("\n"), 0
    whole = reading(lines)
    for at, line in enumerate(lines):
        damaged = [lines[:at] + lines[at + 1:], lines[:at + 1] + lines[at:], lines[:at + 1]]
        damaged += [lines[:at] + [line[:k] + "x" + line[k + 1:]] + lines[at + 1:] for k in range(at % 2, len(line), 2) if line[k].isalpha() and len(line.split()) > 1]
        for changed in damaged:
            try:
                assert reading(changed) == whole, changed[at]
            except ValueError:
                refused += 1
    assert refused > 50


def test_units_that_are_said_twice(path):
    file = path("time,acceleration [gal]\n0,1\n0.01,2\n")
    assert masonry.read_record(file, unit="cm/s^2").peak == 0.02
    for arguments, words in ((dict(unit="g"), "unit = 'g': must be left out, or that of the first line, gal"), (dict(unit="gal"), "unit = 'gal': must be one of m/s"),
                             (dict(component="acceleration [gal]", columns=1), "component = .*must be left out where columns are given"),
                             (dict(component="a"), r"component = 'a': must be the name of a column in the first line of .*'acceleration \[gal\]'")):
        with pytest.raises(ValueError, match=words):
            masonry.read_record(file, **arguments)
    with pytest.raises(ValueError, match=r"columns = \(0, 0\): must be acceleration or \(time, acceleration\), two columns"):
        masonry.read_record(file, columns=(0, 0))
    for arguments in (dict(unit="g"), dict(dt=0.01), dict(columns=1)):
        with pytest.raises(ValueError, match=f"{next(iter(arguments))} = .*must be left out for .*, a PEER file, which says it"):
            masonry.read_record(path(at2(A / G)), **arguments)
    with pytest.raises(ValueError, match="gravity = -9.81: must be positive and finite"):
        masonry.read_record(path(at2(A / G)), gravity=-9.81)
    assert masonry.read_record(path(at2(A / G)), gravity=10).peak == pytest.approx(10 / G * np.abs(A).max(), rel=1e-7)


class Trace:
    """What masonry reads of an obspy.Trace."""

    def __init__(self, channel, data):
        self.data, self.stats = data, types.SimpleNamespace(channel=channel, delta=DT, network="XX", station="ABC", starttime="1990-01-01")


def test_encodings(path):
    text = "time (s),a (m/s²)\n" + "".join(f"{k * DT:.2f},{value}\n" for k, value in enumerate(A))
    for encoding in ("utf-8", "utf-8-sig", "latin-1", "utf-16"):
        same(masonry.read_record(path(text, encoding=encoding)), A)
    for read in (masonry.Record.from_at2, lambda file: masonry.Record.from_csv(file, "g")):
        with pytest.raises(ValueError, match="record.txt: must be a text file"):
            read(path(b"1\0\0\0"))


def test_obspy(path, monkeypatch):
    file = path(b"000001D \0\0\0", "record.mseed")
    monkeypatch.setitem(sys.modules, "obspy", None)
    with pytest.raises(ValueError, match=r"must be unpacked, if it is compressed, or be one that ObsPy reads, where it is installed \(python3 -m pip install obspy\)"):
        masonry.read_record(file, unit="m/s^2")
    stream = [Trace("HNE", A), Trace("HNN", 2 * A)]
    monkeypatch.setitem(sys.modules, "obspy", types.SimpleNamespace(read=lambda name: stream))
    same(masonry.read_record(file, "HNN", unit="m/s^2"), 2 * A)
    assert masonry.read_record(file, "HNE", unit="m/s^2").source.station == "XX.ABC"
    same(masonry.read_record(path("TIMESERIES XX_ABC\n1 2\n3\n"), "HNE", unit="m/s^2"), A)  # a text that only ObsPy knows
    for arguments, words in ((dict(), "unit = None: must be given for what ObsPy reads"), (dict(unit="m/s^2"), "2 components: component= must say which: 'HNE', 'HNN'")):
        with pytest.raises(ValueError, match=words):
            masonry.read_record(file, **arguments)
    stream.append(Trace("HNE", A))
    with pytest.raises(ValueError, match="channel HNE has 2 pieces: must have no gaps"):
        masonry.read_record(file, "HNE", unit="m/s^2")
    stream[:] = [Trace("HNE", np.ma.masked_equal(A, A[3]))]
    with pytest.raises(ValueError, match="channel HNE has missing values"):
        masonry.read_record(file, unit="m/s^2")


def test_long_files_are_read_at_once(path):
    """20,000 lines: the time is printed, and not asserted."""
    long = signal(20000)
    files = [path(text, f"{k}.txt") for k, text in enumerate([at2(long / G, per_line=1), esm(100 * long), smc(100 * long), knet(np.round(1e4 * long).astype(int)),
                                                             "".join(f"{k * DT:.2f},{value}\n" for k, value in enumerate(long))])]
    seconds = []
    for file in files:
        begun = time.process_time()
        assert len(masonry.read_record(file, unit="m/s^2" if file.name.startswith("4") else None).samples) == 20000
        seconds.append(time.process_time() - begun)
    print("CPU seconds to read 20,000 values:", [f"{s:.2f}" for s in seconds])


def test_damaged_files(path):
    """A file with a line missing, doubled or cut, or with a wrong letter, is read or refused with a sentence; no reader fails otherwise."""
    random = np.random.default_rng(1)
    texts = [at2(A / G), esm(GAL), knet(np.round(1e3 * A).astype(int)), smc(GAL), csmip_1(A / G), csmip_2({(1, "Up"): (GAL, GAL, GAL)}), cosmos(GAL),
             afad([GAL, GAL, GAL]), "time,a (g)\n" + "".join(f"{k * DT:.2f},{value}\n" for k, value in enumerate(A))]
    refused = 0
    for text in texts:
        for k in range(60):
            lines = text.split("\n")
            at = random.integers(len(lines))
            if k % 4 == 0:
                del lines[at]
            elif k % 4 == 1:
                lines.insert(at, lines[at])
            elif k % 4 == 2:
                lines[at] = lines[at][: random.integers(len(lines[at]) + 1)]
            else:
                place = random.integers(len(lines[at]) + 1)
                lines[at] = lines[at][:place] + random.choice(list("x-.9 :")) + lines[at][place + 1:]
            try:
                masonry.read_record(path("\n".join(lines)), **(dict(component="N-S") if text.startswith("STRONG") else {}))
            except ValueError as error:
                refused += 1
                assert "record.txt" in str(error) and "\n" not in str(error)
    assert refused > 100
