"""Motions and readers."""

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

import masonry


@pytest.mark.parametrize("motion", [
    masonry.Rectangular(2.0, 0.4), masonry.HalfSine(-1.5, 0.4), masonry.Sine(2.0, 1.7, 1.4), masonry.Record(0.1, [0, 1, -2, 0.5, 1]),
    masonry.PulseTrain(0.2, [0.0, 0.25], shape="half-sine", duration=0.2)
])
def test_velocity_and_displacement_are_integrals(motion):
    for t in (0.15, 0.3, 0.7):
        points = np.arange(0.05, t, 0.05)
        assert motion.velocity(t) == pytest.approx(quad(motion.acceleration, 0, t, points=points, limit=200)[0], abs=1e-10)
        assert motion.displacement(t) == pytest.approx(quad(motion.velocity, 0, t, points=points, limit=200)[0], abs=1e-10)


def test_values_have_the_shape_of_the_motions_then_of_the_times():
    motion = masonry.Sine(np.array([[1.0], [2.0]]), np.array([1.0, 2.0, 3.0]))
    t = np.linspace(0, 0.2, 5)
    np.testing.assert_allclose(motion.acceleration(t)[1, 2], 2 * np.sin(6 * np.pi * t), rtol=1e-13, atol=1e-15)
    assert isinstance(masonry.Sine(1.0, 1.0).velocity(0.1), float)
    assert motion.displacement([]).shape == (2, 3, 0) and masonry.Sine(1.0, 1.0).displacement([]).shape == (0,)


def test_baselines_by_name():
    t = 0.01 * np.arange(500)
    samples = 0.2 + np.sin(7 * t)
    assert masonry.Record(0.01, samples, baseline="constant").velocity(4.99) == pytest.approx(0, abs=1e-12)
    left = masonry.Record(0.01, samples, baseline="linear")
    fine = np.linspace(0, 4.99, 20001)
    assert trapezoid(left.velocity(fine) * fine, fine) == pytest.approx(0, abs=1e-5)


def test_samples_have_the_scale():
    record = masonry.Record(0.1, [0, 1, -2], scale=3.0, name="a quake")
    np.testing.assert_array_equal(record.samples[:2], record.acceleration([0, 0.1]))  # after the last sample it is zero
    np.testing.assert_array_equal(record.scaled([1, 2]).samples, [[0, 3, -6], [0, 6, -12]])
    with pytest.raises(ValueError, match="read-only"):
        record.samples[0] = 1
    assert repr(record) == "Record(a quake: 3 samples, dt=0.1 s, at most 6 m/s^2, baseline='none')"
    with pytest.raises(ValueError, match="assembly = True: must be left out with 1 pulses"):
        masonry.PulseTrain(0.2, [0], assembly=True)
    assert repr(masonry.PulseTrain(0.2, [0, 1], assembly=True)) == "PulseTrain(impulse=0.2, times=[0.0, 1.0], assembly=True)"
    assert repr(masonry.PulseTrain(0.2, half_cycles=3)) == "PulseTrain(impulse=0.2, half_cycles=3)"


@pytest.mark.parametrize("text", [
    "PEER\nA QUAKE\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=   5, DT=   .0050 SEC,\n  .1E-01 -.2E-01  .3E-01\n .1-.25E+00\n",
    "PEER\nA QUAKE\nACCELERATION TIME HISTORY IN UNITS OF G\n    5   0.0050  NPTS, DT\n  .1E-01 -.2E-01  .3E-01\n .1-.25E+00\n",
])
def test_at2(tmp_path, text):
    path = tmp_path / "record.AT2"
    path.write_text(text)
    record = masonry.Record.from_at2(path)
    assert (record.dt, record.name) == (0.005, "A QUAKE")
    np.testing.assert_allclose(record.samples, 9.80665 * np.array([0.01, -0.02, 0.03, 0.1, -0.25]), rtol=1e-15)
    path.write_text(text.replace("5", "6", 1))
    with pytest.raises(ValueError, match="must be NPTS = 6"):
        masonry.Record.from_at2(path)


@pytest.mark.parametrize("line", ["NPTS= 1,000, DT= 1.0D-02 SEC", "DT= 0.1d-1SEC, NPTS=1000", "NPTS=1000,DT=.01", "1000 1.0E-02 NPTS, DT", "1000, 10.D-03 NPTS, DT"])
def test_at2_headers(tmp_path, line):
    path = tmp_path / "record.AT2"
    path.write_text(f"PEER\nA QUAKE\nACCELERATION IN UNITS OF G\n{line}\n" + "1.0D-01 " * 1000 + "\x1a")
    record = masonry.Record.from_at2(path, gravity=1)
    assert record.dt == pytest.approx(0.01, rel=1e-15) and len(record.samples) == 1000 and np.all(record.samples == 0.1)


@pytest.mark.parametrize("line, values, words", [
    ("NPTS= 5, DT= .01", ".1 .2 NaN .4 .5 .6", "'NaN' stands among the values: must be numbers"),
    ("NPTS= 5, DT= .01", ".1 .2 ***** .4 .5 .6", r"'\*\*\*\*\*' stands among"),
    ("NPTS= 5, DT= .01.5", ".1 .2 .3 .4 .5", "line 4 .* must give NPTS and DT"),
    ("NPTS= 5, DT= 1.0D-", ".1 .2 .3 .4 .5", "line 4 .* must give NPTS and DT"),
    ("NPTS= 5,000, DT= .01", ".1 .2 .3 .4 .5", "5 values: must be NPTS = 5000"),
])
def test_bad_at2(tmp_path, line, values, words):
    path = tmp_path / "record.AT2"
    path.write_text(f"PEER\nA QUAKE\nACCELERATION IN UNITS OF G\n{line}\n{values}\n")
    with pytest.raises(ValueError, match=words):
        masonry.Record.from_at2(path)


def test_csv(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("# a laboratory\ntime,acceleration\n0.00,1\n0.02,-2\n0.04,3\n")
    record = masonry.Record.from_csv(path, "cm/s^2")
    assert record.dt == pytest.approx(0.02)
    np.testing.assert_allclose(record.samples, [0.01, -0.02, 0.03])
    path.write_text("1\n-2\n3\n")
    np.testing.assert_allclose(masonry.Record.from_csv(path, "g", dt=0.01).samples, 9.80665 * np.array([1, -2, 3]))
    with pytest.raises(ValueError, match="dt = None"):
        masonry.Record.from_csv(path, "g")
    path.write_text("0,1\n0.02,-2\n", encoding="utf-8-sig")  # as spreadsheets write it
    np.testing.assert_allclose(masonry.Record.from_csv(path, "m/s^2").samples, [1, -2])
    for text, line in (("0,1\n0.02\n", 2), ("0;1\n0.02;2\n0.04;3\n", 2), ("# of a laboratory\n\ntime,a\ns,g\n0,1\n", 4)):
        path.write_text(text)
        with pytest.raises(ValueError, match=f"record.csv: line {line} is .*must be as many numbers"):
            masonry.Record.from_csv(path, "m/s^2")
    with pytest.raises(ValueError, match="unit = 'gal'"):
        masonry.Record.from_csv(path, "gal", dt=0.01)
    path.write_bytes("time (s),Beschleunigung (m/s²)\n0,1\n0.02,-2\n".encode("latin-1"))
    np.testing.assert_allclose(masonry.Record.from_csv(path, "m/s^2").samples, [1, -2])
    path.write_text("0.02,1\n0.01,-2\n0,3\n")
    with pytest.raises(ValueError, match="record.csv: steps of time from -0.01 to -0.01 s: must be positive"):
        masonry.Record.from_csv(path, "m/s^2")
    for name, value, words in (("dt", np.nan, "must be positive and finite"), ("dt", "0.01", "must be a number"), ("gravity", "9.81", "must be a number"),
                               ("gravity", -9.81, "must be positive and finite")):
        with pytest.raises(ValueError, match=f"{name} = {value!r}: {words}"):
            masonry.Record.from_csv(path, "g", **{name: value})


def test_the_unit_g_of_a_peer_file_is_positive(tmp_path):
    with pytest.raises(ValueError, match="gravity = -9.81: must be positive and finite, in m/s"):
        masonry.Record.from_at2(tmp_path / "none.AT2", gravity=-9.81)


@pytest.mark.parametrize("make, words", [
    (lambda: masonry.PulseTrain(1.0, [0, 2, 1]), r"times\[2\] = 1: must be increasing"),
    (lambda: masonry.PulseTrain(np.nan, [0]), "impulse = nan"),
    (lambda: masonry.PulseTrain(1.0, [0], shape="triangle"), "shape = 'triangle'"),
    (lambda: masonry.PulseTrain(1.0, half_cycles=0), "half_cycles = 0"),
    (lambda: masonry.PulseTrain(1.0, half_cycles=2.7), "half_cycles = 2.7: must be a whole number, at least 1"),
    (lambda: masonry.PulseTrain(1.0, [0], half_cycles=2), "half_cycles = 2: must be left out with times"),
    (lambda: masonry.PulseTrain(1.0, [0], duration=0.2), "duration = 0.2: must be left out .* for dirac"),
    (lambda: masonry.PulseTrain(1.0, duration=0.2), "duration = 0.2: must be left out .* for dirac"),
    (lambda: masonry.PulseTrain(1.0, [0], shape="rectangular", duration="0.2"), "duration = '0.2': must be a number"),
    (lambda: masonry.PulseTrain(1.0, ["0", "1"]), r"times = \['0', '1'\]: must be a number or an array"),
    (lambda: masonry.PulseTrain("a"), "impulse = 'a': must be a number"),
    (lambda: masonry.Record(0.01, [1.0, 2.0], scale="2"), "scale = '2': must be a number"),
    (lambda: masonry.Rectangular(1.0, 0.0), "duration = 0"),
    (lambda: masonry.Sine(1.0, -1.0), "frequency = -1"),
    (lambda: masonry.Sine("a", 1.0), "amplitude = 'a': must be a number"),
    (lambda: masonry.Record(0.01, [1.0]), "1 samples"),
    (lambda: masonry.Record(0.01, [[1, 2], [3, 4]]), r"acceleration has the shape \(2, 2\): must be one row"),
    (lambda: masonry.Record(0.01, "abc"), "acceleration = 'abc': must be a number or an array"),
    (lambda: masonry.Record("fast", [1.0, 2.0]), "dt = 'fast': must be a number"),
    (lambda: masonry.Record(0.01, [1.0, np.nan]), r"acceleration\[1\] = nan"),
    (lambda: masonry.Record(0.01, [1.0, 2.0], baseline="cubic"), "baseline = 'cubic'"),
    (lambda: masonry.Record(0.01, [1.0, -9.97e36]), r"acceleration\[1\] = -9.97e\+36: must be at most 1e\+06 m/s\^2 without its sign; files have such numbers"),
    (lambda: masonry.Record(0.01, [0.1] * 9 + [2e5], unit="g"), r"acceleration\[9\] = 200000 g: must be at most 1e\+06 m/s\^2"),
    (lambda: masonry.Record(0.01, velocity=[0.0] * 20 + [1e20]), r"velocity\[20\] = 1e\+20: must be at most 1e\+06 m/s"),
    (lambda: masonry.Record(0.01, displacement=[0.0] * 20 + [1e38]), r"displacement\[20\] = 1e\+38: must be at most 1e\+06 m"),
    (lambda: masonry.Record(0.01, [0.0, 2.0], scale=[1, 1e6]), "acceleration of the base at 0.01 s = 2000000: must be at most"),
    (lambda: masonry.Sine(1e38, 1.0), r"acceleration of the base at 0 s = 1e\+38: must be at most 1e\+06 m/s\^2 without its sign"),
    (lambda: masonry.HalfSine(1e38, 1.0), "acceleration of the base"), (lambda: masonry.Rectangular([1.0, -1e38], 1.0), "acceleration of the base"),
    (lambda: masonry.PulseTrain(1e38, [0.0]), "velocity jump of the base at 0 s"),
    (lambda: masonry.simulate(masonry.RockingBlock(0.2, 1), masonry.PulseTrain(1e38), half_cycles=2), r"impulse = 1e\+38: must be at most 1e6 m/s"),
    (lambda: masonry.simulate(masonry.RockingBlock(0.2, 1), initial_velocity=1e15), r"initial_velocity = 1e\+15: must be at most 1e6 rad/s"),
    (lambda: masonry.simulate(masonry.RockingBlock(1e-40, 5e-40), masonry.Sine(3.0, 1.0)), "the motion is too fast to be followed"),
    (lambda: masonry.simulate(masonry.RockingBlock(0.2, 1), masonry.Sine(3.0, 1.0), vertical=masonry.Rectangular(1e38, 1.0)), "acceleration of the base"),
    (lambda: masonry.overturning_amplitude(masonry.RockingBlock(0.2, 1), masonry.Sine(1.0, 1.0), bracket=(1, 1e38)), "acceleration of the base"),
    (lambda: masonry.spectra.rocking(masonry.Sine, 0.4, 5, amplitude=[1, 1e40], frequency=1), "acceleration of the base"),
    (lambda: masonry.spectra.response(masonry.Sine(1.0, 1.0), 1e-9), "period = 1e-09: must be longer"),
    (lambda: masonry.spectra.response(masonry.artificial_record(1, 1.0), [0.1, 1e-6]), "period = 1e-06: must be longer"),
])
def test_bad_input(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("fill", ["1e20", "9.96921e36", "1d38", "-3.4028235e38"])
def test_a_file_with_a_fill_value_is_refused(tmp_path, fill):
    path = tmp_path / "record.csv"
    path.write_text("time (s),acc (m/s^2)\n" + "".join(f"{0.01 * k:.2f},{fill if k == 30 else 0.5}\n" for k in range(60)))
    with pytest.raises(ValueError, match=r"record.csv: acceleration\[30\] = .* m/s\^2: must be at most 1e\+06 m/s\^2 without its sign"):
        masonry.read_record(path)


def test_units_of_a_text_file(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("1\n-2\n")
    for unit, factor in (("m/s^2", 1), ("cm/s^2", 0.01), ("mm/s^2", 0.001), ("g", 9.80665)):
        np.testing.assert_allclose(masonry.Record.from_csv(path, unit, dt=0.01).samples, factor * np.array([1, -2]), rtol=1e-15)


def test_steps_of_a_text_file(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("0,1\n0.01,-2\n0.03,3\n0.04,1\n")
    with pytest.raises(ValueError, match="equal to 1 in 1000"):
        masonry.Record.from_csv(path, "m/s^2")
    path.write_text("0,1\n0.01,-2\n0.02,3\n")
    with pytest.raises(ValueError, match="dt = 0.02: must be the step of the file"):
        masonry.Record.from_csv(path, "m/s^2", dt=0.02)


def test_a_scaled_train_is_the_train_times_the_factor():
    t = np.linspace(0, 3, 7)
    for train in (masonry.PulseTrain(0.2, [0, 1, 2], assembly=True), masonry.PulseTrain(0.2, [0, 1, 2], shape="half-sine", duration=0.3)):
        np.testing.assert_allclose(train.scaled(3).velocity(t), 3 * train.velocity(t), rtol=1e-14)


def test_records_have_a_unit_and_a_peak(recwarn):
    block = masonry.RockingBlock(0.3, 1.5)
    plain = masonry.Record(0.01, [0, -0.35, 0.2])
    assert plain.peak == 0.35 and not plain.unit_given
    for unit, factor in (("m/s^2", 1), ("cm/s^2", 0.01), ("mm/s^2", 0.001), ("g", 9.80665)):
        record = masonry.Record(0.01, [0, -0.35, 0.2], unit=unit)
        assert record.unit_given and record.peak == pytest.approx(factor * 0.35, rel=1e-15)
        assert record.scaled(2).unit_given and record.scaled(-2).peak == pytest.approx(factor * 0.7, rel=1e-15)
    assert masonry.Record(0.01, [0, 1], unit="g", gravity=10).peak == 10
    assert masonry.Record(0.01, [0, 3], scale=[1, -2]).peak.tolist() == [3, 6]
    for quiet in (masonry.Record(0.01, [0, -0.35], unit="g"), masonry.Record(0.01, [0, -0.09]), masonry.Record(0.01, [0, 1.6]), masonry.artificial_record(1, 1.0)):
        masonry.simulate(block, quiet)
    assert not recwarn.list
    masonry.simulate(block, plain)
    assert [str(warning.message) for warning in recwarn.list] == [
        "The record has no unit and a peak of 0.35: is it in g? It is taken in m/s^2, 0.036 g. Give unit='g' or unit='m/s^2' to Record."]
    recwarn.clear()
    masonry.simulate(block, masonry.Record(0.01, [0, 293, 0], unit="m/s^2"))      # cm/s^2 taken for m/s^2
    assert [str(warning.message) for warning in recwarn.list] == ["The record reaches 293 m/s^2 before its scale, 29.9 g: is its unit right?"]
    recwarn.clear()
    masonry.simulate(block, masonry.Record(10, [0, 1, 0], unit="m/s^2"))          # 10 ms taken for 10 s
    assert [str(warning.message) for warning in recwarn.list] == ["The record has steps of 10 s: are they in ms? dt is in s."]
    with pytest.raises(ValueError, match="unit = 'gal': must be one of"):
        masonry.Record(0.01, [0, 1], unit="gal")


AT2 = "PEER\nA QUAKE\n{unit}\nNPTS= 2, DT= {dt}\n .5 -.25\n"


@pytest.mark.parametrize("line, factor", [
    ("ACCELERATION TIME SERIES IN UNITS OF G", 9.80665), ("ACCELERATION TIME HISTORY IN UNITS OF G.  FILTER POINTS: HP=0.1 Hz LP=20.0 Hz", 9.80665),
    ("ACCELERATION (G)", 9.80665), ("Acceleration in g's", 9.80665), ("ACCELERATION TIME SERIES IN UNITS OF G/10", 0.980665), ("ACCELERATION, UNITS: %G", 0.0980665),
    ("ACCELERATION IN UNITS OF % OF G", 0.0980665), ("ACCELERATION TIME SERIES IN UNITS OF CM/SEC/SEC", 0.01), ("ACCELERATION IN CM/S**2", 0.01),
    ("ACCELERATION IN UNITS OF CM/SEC2", 0.01), ("ACCELERATION (GAL)", 0.01), ("ACCELERATION TIME SERIES IN UNITS OF M/S^2", 1), ("ACCELERATION (M/SEC^2)", 1),
    ("ACCELERATION IN UNITS OF M/S/S", 1), ("ACCELERATION IN METERS", None), ("VELOCITY TIME SERIES IN UNITS OF CM/S", None), ("VELOCITY IN UNITS OF G", None),
    ("DISPLACEMENT TIME SERIES IN UNITS OF CM", None), ("ACCELERATION IN UNITS OF G*1000", None), ("ACCELERATION IN UNITS OF CM/S^2 (NOT G)", None),
    ("ACCELERATION IN UNITS OF G/20", None), ("ACCELERATION", None), ("", None)])
def test_units_of_at2(tmp_path, line, factor):
    path = tmp_path / "record.AT2"
    path.write_text(AT2.format(unit=line, dt=".01 SEC"))
    if factor:
        np.testing.assert_allclose(masonry.Record.from_at2(path).samples, factor * np.array([0.5, -0.25]), rtol=1e-15)
    else:
        with pytest.raises(ValueError, match="line 3 is .*must state ACCELERATION in units of G, "):
            masonry.Record.from_at2(path)


@pytest.mark.parametrize("text, dt", [("5 MSEC", 0.005), ("5 ms,", 0.005), (".005 SEC", 0.005), (".005", 0.005), ("5 MIN", None), (".005 HZ", None), ("5 USEC", None)])
def test_steps_of_at2(tmp_path, text, dt):
    path = tmp_path / "record.AT2"
    path.write_text(AT2.format(unit="ACCELERATION IN UNITS OF G", dt=text))
    if dt:
        assert masonry.Record.from_at2(path).dt == pytest.approx(dt, rel=1e-15)
    else:
        with pytest.raises(ValueError, match="line 4 is .*must give DT in SEC or MSEC"):
            masonry.Record.from_at2(path)


@pytest.mark.parametrize("text, arguments", [
    ("0.00, 1.5D0\n0.01, -2.0D+0\n0.02, 3d0\n", {}), ("% matlab\n# numpy\n 0 1.5\n 0.01\t-2\n 0.02 3\n", {}),
    ("t,x,a\n0,7,1.5\n.01,8,-2\n.02,9,3\n", dict(columns=("t", "a"))), ("t,x,a\n0,7,1.5\n.01,8,-2\n.02,9,3\n", dict(columns=[0, 2])),
    ("t,x,a\n0,7,1.5\n.01,8,-2\n.02,9,3\n", dict(columns="a", dt=0.01)), ("0.00,1.5,\n0.01,-2,\n0.02,3,\n", {}), ("t (s), a\n0, 1.5\n1E-2, -2\n2E-2, 3\n", {})])
def test_text_files_that_are_read(tmp_path, text, arguments):
    path = tmp_path / "record.csv"
    path.write_text(text)
    record = masonry.Record.from_csv(path, "m/s^2", **arguments)
    assert record.dt == pytest.approx(0.01, rel=1e-12)
    np.testing.assert_array_equal(record.samples, [1.5, -2, 3])


@pytest.mark.parametrize("text, arguments, words", [
    ("0,00 1,5\n0,01 -2,0\n", {}, "line 1 is .*decimal points"), ("0,00;1,5\n0,01;-2,0\n", {}, "line 1 is .*decimal points"),
    ("0,00\t1,5\n0,01\t-2,0\n", {}, "line 1 is .*decimal points"), ("1,25\n1,5\n2,125\n", {}, "line 2 is 0 s after"),
    ("t,x,a\n0,7,1\n.01,8,-2\n", {}, r"line 2 has 3 columns: columns=\(time, acceleration\) must say which.*'t', 'x', 'a'"),
    ("0,7,1\n.01,8,-2\n", dict(columns="a"), "columns = 'a': must be .*which has none"), ("0,7,1\n.01,8,-2\n", dict(columns=3), r"columns = 3: .*0 to 2"),
    ("0,1\n.01,,2\n", {}, "line 2 is '.01,,2'"), ("0,nan\n.01,2\n", {}, "line 1 is '0,nan'"), ("0,1\n.01,nan\n", {}, "line 2 is '.01,nan'"), ("time,a\ns,g\n0,1\n.01,2\n", {}, "line 2 is 's,g'")])
def test_text_files_that_are_refused(tmp_path, text, arguments, words):
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=words) as refused:
        masonry.Record.from_csv(path, "m/s^2", **arguments)
    assert len(str(refused.value)) < 300 + len(str(path))


# The times are those of equal steps, written with so many digits: the step is known to the last digit over their number.
@pytest.mark.parametrize("step, form", [(1 / 256, "{:.3f}"), (1 / 300, "{:.4f}"), (0.01 / 3, "{:.6g}"), (1 / 128, "{:.5e}")])
def test_rounded_times(tmp_path, step, form):
    path = tmp_path / "record.csv"
    times = [form.format(k * step) for k in range(20001)]
    path.write_text("".join(f"{t},1\n" for t in times))
    assert masonry.Record.from_csv(path, "m/s^2").dt == pytest.approx(step, rel=1e-4)
    path.write_text("".join(f"{t},1\n" for t in times[:12000] + times[12001:]))
    with pytest.raises(ValueError, match="line 12001 is .* s after"):
        masonry.Record.from_csv(path, "m/s^2")
