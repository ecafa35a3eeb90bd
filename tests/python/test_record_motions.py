"""Baselines of records; velocities and displacements as base motion."""

import sys

import numpy as np
import pytest
from record_files import DT, at2, signal

import masonry

A = signal()  # m/s^2
G = 9.80665
T = DT * np.arange(401)
U = 0.05 * np.sin(np.pi * T / 4) ** 4 * np.sin(5 * T)  # m; at rest at both ends


def test_end_of_a_record(tmp_path):
    record = masonry.Record(0.5, [1.0, 1.0, 1.0])
    assert record.final_velocity == pytest.approx(1, rel=1e-15) and record.final_displacement == pytest.approx(0.5, rel=1e-15)
    assert str(record).endswith("the base ends 0.5 m from where it begins, at 1 m/s")
    assert masonry.Record(0.5, [1.0, 1.0, 1.0], scale=[1, 2]).final_velocity.tolist() == [1, 2]
    (tmp_path / "some.AT2").write_text(at2(A / G))
    read = masonry.read_record(tmp_path / "some.AT2", baseline="constant", scale=2)
    assert read.final_velocity == pytest.approx(0, abs=1e-15) and read.scale == 2
    assert str(read).split("\n")[1:] == ["  PEER file some.AT2: SOME STATION 090, unit G",
                                         f"  the base ends {read.final_displacement:.3g} m from where it begins, at 0 m/s"]


@pytest.mark.parametrize("corner, order", [(0.1, 4), (0.2, 2), (0.5, 4)])
def test_high_pass(corner, order):
    """Of two sines, far above and far below the corner, the fast one stays as the amplitude of the filter says: 1/(1 + (corner/f)^(2 order)) for both passes. The
    drift of an offset goes, and base and filter come to rest: what the end of the padding cuts off is 1e-6 of the largest, with a margin of 100."""
    dt, fast, slow = 0.01, 10 * corner, corner / 10
    t = np.arange(0, 40 / corner, dt)
    bell = np.sin(np.pi * t / t[-1]) ** 2
    kept, lost = bell * np.sin(2 * np.pi * fast * t), 2 * bell * np.sin(2 * np.pi * slow * t) + 0.3
    record = masonry.Record(dt, kept + lost, baseline="high-pass", corner=corner, order=order)
    first = round(record.padding / dt)
    middle = slice(len(t) // 4, 3 * len(t) // 4)  # away from the ends, at which an offset is a step
    amplitudes = [1 / (1 + (corner / f) ** (2 * order)) for f in (fast, slow)]
    inside = record.samples[first:first + len(t)][middle]
    assert len(record.samples) == len(t) + 2 * first and record.padding == pytest.approx(1.5 * order / corner, abs=dt)
    assert np.abs(inside - kept[middle]).max() <= (1 - amplitudes[0]) + 2.5 * amplitudes[1] + 2e-3
    times = np.arange(len(record.samples)) * dt
    assert abs(record.final_velocity) <= 1e-4 * np.abs(record.velocity(times)).max()
    assert abs(record.final_displacement) <= 1e-4 * np.abs(record.displacement(times)).max()
    assert f"Butterworth filter of order {order} at {corner:g} Hz, forwards and backwards" in str(record)
    np.testing.assert_array_equal(record.scaled(2).samples, 2 * record.samples)  # not filtered twice


@pytest.mark.parametrize("options, words", [
    (dict(baseline="high-pass"), "corner = None: must be given"), (dict(baseline="high-pass", corner=-1.0), "corner = -1.0: must be positive"),
    (dict(baseline="high-pass", corner=60.0), "corner = 60.0: must be below 50 Hz"),
    (dict(baseline="high-pass", corner=0.1, order=0), "order = 0: must be a whole number"),
    (dict(corner=0.1), "corner = 0.1: must be left out with baseline='none'"),
    (dict(baseline="highpass"), "baseline = 'highpass': must be one of 'none', 'constant', 'linear', 'high-pass'"),
    (dict(resolution=0.1), "resolution = 0.1: must be left out"),
    (dict(displacement=A), "acceleration and displacement of acceleration, velocity and displacement is given: must be one of them")])
def test_bad_baselines(options, words):
    with pytest.raises(ValueError, match=words):
        masonry.Record(DT, A, **options)


# --- velocities and displacements as base motion ---

SHAKEN = 6.0  # s


def exact_displacement(t):
    """m, smooth, at rest at both ends; its accelerations reach 4 m/s^2."""
    return np.sin(np.pi * t / SHAKEN) ** 4 * (0.12 * np.sin(6 * t) + 0.01 * np.sin(14 * t + 1))


def exact_acceleration(t):
    h = 2e-4
    return (-exact_displacement(t - 2 * h) + 16 * exact_displacement(t - h) - 30 * exact_displacement(t) + 16 * exact_displacement(t + h)
            - exact_displacement(t + 2 * h)) / (12 * h * h)


FINE = np.arange(0, SHAKEN, 1e-3)
EXACT = masonry.Record(1e-3, exact_acceleration(FINE), unit="m/s^2")


def difference(block, record):
    """Largest difference of the block's angle from that under the exact acceleration, relative to its largest angle."""
    wanted, angles = (masonry.simulate(block, motion, t_end=SHAKEN).sample(FINE)[0] for motion in (EXACT, record))
    return np.nanmax(np.abs(angles - wanted)) / np.nanmax(np.abs(wanted))


@pytest.mark.parametrize("dt", [0.005, 0.01, 0.02])
@pytest.mark.parametrize("decimals", [3, 4, 5])
@pytest.mark.parametrize("half_width, half_height", [(0.35, 1.0), (0.3, 1.4)])
def test_rounded_displacements(dt, decimals, half_width, half_height):
    """Rounded to q = 1e-4 m and the like, a displacement moves the base nowhere farther than q from the exact one. The block's angle changes by what such an error
    must be expected to change: five times what the exact record does when it is scaled so that its largest displacement is q larger."""
    t = np.arange(0, SHAKEN + dt / 2, dt)
    q, rounded = 10.0**-decimals, np.round(exact_displacement(t), decimals)
    record = masonry.Record(dt, displacement=rounded, unit="m")
    assert np.abs(record.displacement(FINE) - exact_displacement(FINE)).max() <= q and record.deviation <= q
    assert abs(record.displacement(SHAKEN) - rounded[-1] + rounded[0]) < 1e-12 and abs(record.final_velocity) < 1e-12
    assert record.displacement(SHAKEN + 10) == pytest.approx(record.final_displacement, abs=1e-11)
    block = masonry.RockingBlock(half_width, half_height)
    history = masonry.simulate(block, EXACT, t_end=SHAKEN)
    assert len(history.impact_times) > 5 and np.abs(history.peak_angles).max() > 0.7 * block.critical_angle
    larger = difference(block, EXACT.scaled(1 + q / np.abs(exact_displacement(FINE)).max()))
    found = difference(block, record)
    errors = [np.abs(one.samples - exact_acceleration(t)).max() for one in (record, masonry.Record(dt, displacement=rounded, unit="m", resolution=0))]
    print(f"dt {dt} s, {decimals} decimals: angle off by {found:.4f}, scaled record {larger:.4f}; acceleration by {errors[0]:.3f}, interpolated {errors[1]:.3f} m/s^2")
    assert found <= 5 * larger
    # The interpolated displacement has accelerations of the order q/dt^2, up to 170 m/s^2, of which less than 2 % of the peak of 6 m/s^2 is left.
    assert errors[0] <= 0.12


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
def test_samples_without_rounding_are_met(quantity):
    t = np.arange(0, SHAKEN + DT / 2, DT)
    values = exact_displacement(t) - exact_displacement(0.0)
    if quantity == "velocity":
        values = (exact_displacement(t + 1e-5) - exact_displacement(t - 1e-5)) / 2e-5
    record = masonry.Record(DT, **{quantity: values})
    met = record.velocity(t) if quantity == "velocity" else record.displacement(t)
    # Round-off of a sum over 600 samples, of numbers below 1.
    assert np.abs(met[:-1] - values[:-1]).max() < 1e-10 and record.deviation < 1e-10
    # The spline's own error, of third or second order in dt: 1e-3 of the peak.
    assert np.abs(record.samples - exact_acceleration(t)).max() < 0.01


def test_resolutions_and_units():
    t = np.arange(0, SHAKEN + DT / 2, DT)
    u = exact_displacement(t)
    wanted = masonry.Record(DT, displacement=np.round(u, 4), unit="m")
    for factor, unit in ((100, "cm"), (1000, "mm")):
        record = masonry.Record(DT, displacement=factor * np.round(u, 4), unit=unit)
        np.testing.assert_allclose(record.samples, wanted.samples, atol=1e-6)
    counts = np.round(u / 3.1e-5)  # a converter's steps
    given, found = (masonry.Record(DT, displacement=3.1e-5 * counts, resolution=resolution) for resolution in (3.1e-5, None))
    np.testing.assert_allclose(given.samples, found.samples, atol=1e-6)
    double = masonry.Record(DT, displacement=np.round(u, 4)).scaled(2)
    assert double.final_displacement == pytest.approx(0, abs=1e-12) and double.deviation == 2 * wanted.deviation


@pytest.mark.parametrize("make, words", [
    (lambda: masonry.Record(DT, displacement=U, baseline="constant"), "baseline = 'constant': must be 'none' for a displacement"),
    (lambda: masonry.Record(DT, displacement=U, unit="g"), "unit = 'g': must be one of m, cm, mm"),
    (lambda: masonry.Record(DT, U, unit="m"), "unit = 'm': must be one of m/s"),
    (lambda: masonry.Record(DT, velocity=U + 1), r"velocity\[0\] = 1: must be 0, because the base starts from rest"),
    (lambda: masonry.Record(DT, displacement=U[:5]), "displacement has 5 samples: must be at least 8"),
    (lambda: masonry.Record(DT, displacement=np.ones((2, 9))), "has the shape"),
    (lambda: masonry.Record(DT, displacement=np.where(T == 1, np.nan, U)), r"displacement\[100\] = nan: must be finite"),
    (lambda: masonry.Record(0.0, displacement=U), "dt = 0.0"),
    (lambda: masonry.Record(DT, displacement=U, resolution=-1), "resolution = -1: must be 0 or positive"),
    (lambda: masonry.Record(DT), "nothing of acceleration")])
def test_bad_motions(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_displacements_in_millimetres_are_asked_for(recwarn):
    masonry.simulate(masonry.RockingBlock(0.2, 1.0), masonry.Record(DT, displacement=1000 * U))
    assert "of a displacement has no unit and reaches" in str(recwarn.list[0].message) and "is it in m? Give unit= to Record." in str(recwarn.list[0].message)


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
def test_motions_that_do_not_begin_or_end_at_rest(quantity, recwarn):
    """A motion that is cut off while it is under way is one that the base cannot have without a push."""
    t = np.arange(0, SHAKEN + DT / 2, DT)
    whole = exact_displacement(t) if quantity == "displacement" else np.gradient(exact_displacement(t), DT)
    cut_off = (whole[: len(t) // 2], whole[len(t) // 2:]) if quantity == "displacement" else ()
    assert masonry.Record(DT, unit={"velocity": "m/s"}.get(quantity, "m"), **{quantity: whole}).doubt() == ""
    for part in cut_off:
        record = masonry.Record(DT, displacement=part, unit="m", name="a table")
        assert record.doubt().startswith("The record 'a table' of a displacement does not begin or end at rest, as the base does: it reaches ")
        masonry.simulate(masonry.RockingBlock(0.2, 1.0), record)
    assert len(recwarn.list) == len(cut_off)


def test_packages_that_are_missing_are_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    for options, what in ((dict(displacement=U), "a record of velocities or displacements"), (dict(acceleration=A, baseline="high-pass", corner=0.1), "baseline='high-pass'")):
        monkeypatch.delitem(sys.modules, "scipy.signal", raising=False)
        with pytest.raises(ImportError, match=f"{what} needs python3-scipy: apt install python3-scipy"):
            masonry.Record(DT, **options)
