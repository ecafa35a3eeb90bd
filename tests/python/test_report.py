"""Reports of histories made by hand: what they say, that they need no network, and what a browser draws of them."""

import base64
import html.parser
import json
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
from masonry import __main__, _pose, results
from masonry.results.reporting import view3d, words
from test_results import history, rocking

import masonry

CHROMIUM = shutil.which("chromium")
ABOUT = {"script": "wall.py", "versions": {"masonry": "0.1.0", "YADE": "2023.02a"}, "seed": 7,
         "model": {"dt": 1e-3, "steps": 2000, "model": "planar", "reason": "all in one plane", "method": "wall", "impact order": "simultaneous", "tolerance": 1e-3,
                   "gravity": [0, 0, -9.81]},
         "materials": [{"density": 2000, "frictionAngle": 0.6, "restitution": None, "noSlip": False, "normalStiffness": None, "shearStiffness": None, "ids": [10, 11]}],
         "motions": [{"kind": "RecordMotionEngine", "ids": [10], "direction": [1, 0, 0], "start": 0, "end": 2, "record": "El Centro <NS>", "interval": 0.02,
                      "samples": 101, "peak": 3.4, "scale": 1, "baseline": "constant"}],
         "solver": {"worstResidual": 1e-6, "failures": 2, "firstFailure": "In the step from t = 1 s the contact laws are missed.", "madeEnergy": 0, "lostEnergy": 0},
         "notes": ["a density is 2: densities are in kg/m^3"]}
IMPACTS = np.array([(0.5, 11, 10, np.nan, 0.8, 0.3, 1.25, 0.4, 0.1, True, False)],
                   dtype=[("time", float), ("body", int), ("support", int), ("restitution_asked", float), ("restitution", float), ("velocity", float),
                          ("energy_lost", float), ("friction_demand", float), ("application", float), ("switched", bool), ("capped", bool)])


@pytest.mark.parametrize("value, digits, text", [(1208, 3, "1210"), (44.37, 3, "44.4"), (14683.2, 4, "14680"), (0.01234, 3, "0.0123"), (-1208, 3, "-1210"), (0, 3, "0")])
def test_large_numbers_have_no_power_of_ten(value, digits, text):
    assert words.decimal(value, digits) == text


@pytest.mark.parametrize("model, made, lost, said", [("compliant", 7e-3, 0.04, 0), ("compliant", 8e-3, 0, 1), ("planar", 0.04, 0.04, 0), ("planar", 0.06, 0, 1), ("compliant", 13, 0.06, 2)])
def test_a_run_that_makes_or_loses_energy_is_not_to_be_trusted(model, made, lost, said):
    """made, lost: of what was turned over. 0.75 % of compliant joints, 5 % else (docs/limits.md)."""
    sentences = words.failures({"model": {"model": model}, "solver": {"madeEnergy": 4e3 * made, "lostEnergy": 4e3 * lost, "turnedOver": 4e3, "failures": 0}})
    assert len(sentences) == said and all(one.startswith("Do not trust this run: ") for one in sentences)


def test_a_run_that_has_not_warned_of_its_energies_is_not_called_untrustworthy():
    """A scene at rest turns over 1e-9 J and makes as little: nothing beside the energy that lifts its blocks, which the engine knows."""
    about = {"model": {"model": "planar"}, "solver": {"madeEnergy": 2e-9, "lostEnergy": 1e-9, "turnedOver": 3e-9, "failures": 0}}
    about["solver"].update(toldMade=0.0, toldLost=0.0)
    assert words.failures(about) == []
    about["solver"]["toldMade"] = 2e-9
    assert len(words.failures(about)) == 1


class Page(html.parser.HTMLParser):
    """Tags that are open, texts by section, and what is loaded from elsewhere. Raises where tags do not match."""

    VOID = {"meta", "link", "input", "br"}

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.texts, self.loaded, self.paths, self.section = [], [], {}, [], set(), ""
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids += [given["id"]] if "id" in given else []
        self.loaded += [given[name] for name in ("src", "href") if name in given]
        self.paths.add(tag)
        if tag == "section":
            self.section = given["id"]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in self.VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.texts[self.section] = self.texts.get(self.section, "") + data


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """(page, its text, its path) of a report that has all sections but that of forces."""
    folder = tmp_path_factory.mktemp("full")
    return *page(toppling(about=ABOUT, impacts=IMPACTS, motion=(0, 1.9)), folder, title="A <wall> & more"), folder / "report.html"


def page(h, tmp_path, **given):
    path = tmp_path / "report.html"
    results.report(h, path, **given)
    text = path.read_text()
    return Page(text), text


def scene_of(text):
    return json.loads(re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.S).group(1))


def toppling(count=40, **given):
    """A block 0.6 x 0.5 x 2 on a base; it leans more and more, and lies beyond its critical angle (0.29) in the end."""
    h = rocking(np.linspace(0, 0.6, count), shift=(0.01, 0, 0))
    return results.WallHistory(0.05 * np.arange(count), h.ids, h.sizes, h.free, h.position, h.orientation, **given)


def test_it_says_what_was_run_what_came_out_and_what_to_doubt(full):
    found = full[0]
    verdict = results.collapse(toppling(motion=(0, 1.9)))
    assert f"Collapsed at {verdict.time:.4g} s" in found.texts[""] and "All 1.9 s of the motion have been run. 1 of 1 block has fallen." in found.texts[""]
    assert f"{100 * verdict.peak_drift:.3g} % of the height" in found.texts["numbers"]
    for said in ("2 steps missed the contact laws", "The first: In the step from t = 1 s", "A density is 2: densities are in kg/m^3."):
        assert said in found.texts["warnings"]
    for said in ("wall.py", "2 blocks: density 2000 kg/m^3, friction coefficient 0.684, natural restitution", "“El Centro <NS>”: 101 samples every 0.02 s, peak 3.4 m/s^2 (0.347 g)",
                 "planar: all in one plane", "Method", "wall", "0.001 s in the last of 2000 steps", "Seed", "7", "masonry 0.1.0, YADE 2023.02a"):
        assert said in found.texts["run"]
    assert "0.0001 of the speed that gravity gives in a step" in found.texts["residuals"]  # 1e-6 / (9.81 * 1e-3)
    assert "1 impact, which lost 1.25 J" in found.texts["impacts"] and "natural" in found.texts["impacts"]
    assert {"drift", "rotation", "phase-plane", "shape", "joints"} <= set(found.ids) and "energies" not in found.ids


@pytest.mark.parametrize("given, kind, said", [({}, "unknown", "whether it was over by the last sample is not known"),
                                               ({"motion": (0, 9)}, "unfinished", "whether the structure stands is not known yet"),
                                               ({"motion": (0, 1)}, "stands", None)])
def test_a_history_that_stands_ends_with_its_motion_or_the_report_says_so(tmp_path, given, kind, said):
    found, text = page(history([[2, 2, 0.2], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [x, 0, 0.2]] for x in (0, 0.01, 0.02)], **given), tmp_path)
    assert f'<header class="{kind}">' in text
    assert (said in found.texts["warnings"]) if said else "warnings" not in found.ids
    assert "does not say which script" in found.texts["run"]


def test_it_has_one_largest_opening(tmp_path):
    """That of results.joints(): in the numbers, at the head of the table, and on the curve, whose samples are fewer. The peak is one sample of 1,999."""
    angles = np.concatenate([[0.1] * 1999, np.linspace(0.1, 2, 200)])
    angles[0], angles[1001] = 0, 0.25
    h = rocking(angles)
    h = results.WallHistory(0.001 * np.arange(len(angles)), h.ids, h.sizes, h.free, h.position, h.orientation)
    table = results.joints(h)
    critical = np.arctan(0.3)
    last = angles[angles <= critical].max()  # of the block, until it has fallen
    assert results.collapse(h).collapsed and abs(table["opening"][0] - 0.6 * np.sin(last)) < 1e-12
    found, text = page(h, tmp_path)
    most = words.decimal(1e3 * table["opening"][0], 4)
    assert f"{most} mm, blocks 10 and 11" in found.texts["numbers"] and f"{1e3 * table['opening'][0]:.3f}" in found.texts["joints"]
    assert "until the first of the two blocks has fallen" in found.texts["joints"]
    from masonry.results.joints import movement
    assert np.nanmax(movement(h, range(len(h.time)))[0]) == table["opening"][0]


def test_it_needs_no_network_and_no_name_twice(full):
    found, text, _ = full
    assert all(one.startswith(("#", "data:")) for one in found.loaded)
    assert len(found.ids) == len(set(found.ids))
    assert "A <wall> & more" in found.texts[""]  # escaped
    for address in re.findall(r"https?://[^\s\"'<>]+", text):
        assert not re.search(r"(src|href|url\(|import|fetch)\W{0,3}" + re.escape(address), text)


def test_the_view_has_the_motion_relative_to_the_base_and_that_of_the_base(full):
    h = toppling()
    scene = scene_of(full[1])
    assert scene["ids"] == [10, 11] and scene["free"] == [False, True] and np.allclose(scene["time"], h.time, rtol=0, atol=1e-6)
    poses = np.frombuffer(base64.b64decode(scene["poses"]), dtype="<f4").reshape(len(h.time), 2, 7)
    base = np.frombuffer(base64.b64decode(scene["base"]), dtype="<f4").reshape(len(h.time), 7)
    assert scene["bases"] == [0, 0]
    exact = 1e-6  # of numbers of order one in single precision
    assert np.abs(poses[..., :3] - h.relative_position).max() < exact and np.abs(poses[..., 3:] - h.relative_orientation).max() < exact
    world = np.einsum("sab,snb->sna", _pose.matrices(base[:, 3:]), poses[..., :3]) + base[:, None, :3]
    assert np.abs(world - h.position).max() < 2 * exact
    assert scene["start"] == results.collapse(h).peak_drift_time and scene["enlarge"] == 1


def in_the_view(h, tmp_path):
    """(what its JSON holds, places (frames, n, 3) relative to the bases, and in the world) of the 3D view, from its own origin."""
    scene = scene_of(page(h, tmp_path)[1])
    frames, count = len(scene["time"]), len(scene["ids"])
    poses = np.frombuffer(base64.b64decode(scene["poses"]), dtype="<f4").reshape(frames, count, 7).astype(float)
    base = np.frombuffer(base64.b64decode(scene["base"]), dtype="<f4").reshape(-1, frames, 7).astype(float)[scene["bases"]]
    return scene, poses[..., :3], np.einsum("nsab,snb->sna", _pose.matrices(base[..., 3:]), poses[..., :3]) + base[..., :3].swapaxes(0, 1)


@pytest.mark.parametrize("far", [(5e5, 4.5e6, 0), (-4.5e6, 5e5, 300)])
def test_places_far_from_the_origin_keep_their_digits(tmp_path, far):
    """Map coordinates: eastings of 5e5 m, northings of 4.5e6 m, whose round-off is 1e-9 m. The views, the openings and the drifts are those at the origin."""
    near = toppling(20)
    moved = results.WallHistory(near.time, near.ids, near.sizes, near.free, near.position + far, near.orientation)
    exact = 1e-8
    for one, other in zip(in_the_view(near, tmp_path)[1:], in_the_view(moved, tmp_path)[1:]):
        apart = other - one
        assert np.abs(apart - apart[0, 0]).max() < 1e-6  # of single precision, of numbers of order one
    assert np.abs(moved.drift() - near.drift()).max() < exact and np.abs(moved.displacement - near.displacement).max() < exact
    assert np.abs(moved.rotation - near.rotation).max() < exact and np.array_equal(results.fallen(moved), results.fallen(near))
    for name in ("opening", "slip", "area"):
        assert np.nanmax(np.abs(results.joints(moved)[name] - results.joints(near)[name])) < exact, name


def test_structures_on_two_bases_have_their_own_motions_in_the_view(tmp_path):
    from test_results import on_two_bases

    h = on_two_bases(turned=True)
    scene, relative, world = in_the_view(h, tmp_path)
    assert scene["bases"] == [0, 1, 0, 1, 1]
    assert np.abs(relative - h.relative_position).max() < 1e-6 and np.abs(world - h.position).max() < 2e-6
    h.forces = np.array([(1, 10, 12, (1, 0, 50), (7.1, 0, 0)), (1, 11, 13, (2, 0, 70), (4, -5, 0))],
                        dtype=[("sample", int), ("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)])
    found, _ = page(h, tmp_path)
    assert "of base 10" in found.texts["forces-10"] and "of base 11" in found.texts["forces-11"] and "thrust, at" in found.texts["thrust"]
    assert "base 10, along x" in found.texts["drift"] and "base 11, along y" in found.texts["drift"]


def test_long_histories_are_thinned_and_keep_their_ends_and_their_peak():
    h = toppling(2000)
    rows = view3d.frames(h)
    assert len(rows) <= 301 and rows[0] == 0 and rows[-1] == 1999 and int(np.argmax(h.drift())) in rows


def test_without_three_js_it_says_what_to_install_and_has_all_else(tmp_path, monkeypatch):
    monkeypatch.setattr(view3d, "_LIBRARY", tmp_path / "nowhere.js")
    found, text = page(toppling(), tmp_path)
    assert "apt install libjs-three" in found.texts["view"] and "canvas" not in found.paths and "drift" in found.ids and len(text) < 5e5


def test_without_jinja2_it_names_the_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(ImportError, match="apt install python3-jinja2"):
        results.report(toppling(), tmp_path / "report.html")


def test_a_part_of_a_motion_is_told(tmp_path):
    block, motion = masonry.RockingBlock(0.3, 1.5), masonry.Sine(2.5, 1.0, 4)
    part, whole = (page(masonry.simulate(block, motion, t_end=end), tmp_path)[0].texts[""] for end in (3, 4))
    assert "Does not overturn so far" in part and "The run ends at 3 s, after 3 of 4 s of the motion." in part
    assert "so far" not in whole and "The run ends at 4 s." in whole


@pytest.mark.parametrize("restoring", ["exact", "linear"])
def test_one_block_is_compared_with_the_exact_solution(tmp_path, restoring):
    block = masonry.RockingBlock(0.3, 1.5)
    given = dict(restitution=0.9, initial_angle=0.12, t_end=6)
    simulated = masonry.simulate(block, restoring=restoring, **given)
    found, text = page(simulated, tmp_path)
    assert "Does not overturn" in found.texts[""] and {"rotation", "phase-plane", "impacts"} <= set(found.ids)
    if restoring == "linear":
        time = np.linspace(0, 6, 2000)
        apart = np.abs(simulated.sample(time)[0] - masonry.simulate(block, **given).sample(time)[0]).max()
        assert f"largest difference {apart:.3g} rad" in found.texts["rotation"]
    else:
        assert "This is the exact solution." in found.texts["rotation"]
    # The block of the view turns about its lower edges: their lowest point stays on the base.
    scene = scene_of(text)
    poses = np.frombuffer(base64.b64decode(scene["poses"]), dtype="<f4").reshape(len(scene["time"]), 2, 7)[:, 1].astype(float)
    low = _pose.corners(poses[:, :3], poses[:, 3:], np.array(scene["sizes"][1]))[..., 2].min(axis=1)
    assert np.abs(low).max() < 1e-6


def test_a_computed_block_is_compared_with_the_exact_history_that_is_given(tmp_path):
    exact = masonry.simulate(masonry.RockingBlock(0.3, 1.0), restitution=0.9, initial_angle=0.1, t_end=2)
    time = 0.05 * np.arange(41)
    h = rocking(exact.sample(time)[0] + 1e-3)
    h = results.WallHistory(time, h.ids, h.sizes, h.free, h.position, h.orientation)
    found, _ = page(h, tmp_path, exact=exact)
    assert "largest difference 0.001 rad" in found.texts["rotation"]


@pytest.mark.parametrize("given, word", [({"path": "report.txt"}, "must end in .html"), ({"exact": 3}, "exact = 3"), ({"history": 3}, "history = 3")])
def test_bad_input_is_named(tmp_path, given, word):
    given = {"history": toppling(3), "path": "report.html", **given}
    with pytest.raises(ValueError, match=re.escape(word)):
        results.report(given.pop("history"), tmp_path / given.pop("path"), **given)


def test_about_and_impacts_are_kept_in_files_and_older_files_load(tmp_path):
    h = toppling(about=ABOUT, impacts=IMPACTS)
    h.save(tmp_path / "wall.npz")
    back = results.WallHistory.load(tmp_path / "wall.npz")
    assert back.about == ABOUT and back.impacts.dtype == IMPACTS.dtype and np.array_equal(back.impacts["energy_lost"], [1.25])
    with np.load(tmp_path / "wall.npz") as file:
        old = {name: file[name] for name in file.files if name not in ("about", "impacts")}
    np.savez_compressed(tmp_path / "old.npz", **old)
    back = results.WallHistory.load(tmp_path / "old.npz")
    assert back.about == {} and back.impacts is None


def test_the_command_writes_it_beside_the_history(tmp_path, monkeypatch):
    def run(*given):
        return subprocess.run([sys.executable, "-m", "masonry", "report", *map(str, given)], capture_output=True, text=True)

    toppling(about=ABOUT).save(tmp_path / "wall.npz")
    assert run(tmp_path / "wall.npz").returncode == 0 and "Collapsed at" in (tmp_path / "wall.html").read_text()
    asked = []
    monkeypatch.setattr(results, "report", lambda history, path, title: asked.append((len(history.time), path, title)))
    monkeypatch.setattr(sys, "argv", ["masonry", "report", str(tmp_path / "wall.npz"), "-o", str(tmp_path / "other.html"), "--title", "Mine"])
    __main__.main()
    assert asked == [(40, tmp_path / "other.html", "Mine")]
    missing = run(tmp_path / "none.npz")
    assert missing.returncode == 2 and "none.npz" in missing.stderr and "Traceback" not in missing.stderr


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium here (Debian: apt install chromium): what a browser draws of the report is not looked at")
def test_a_browser_draws_the_blocks_and_says_nothing_on_its_console(full, tmp_path):
    """One start of the browser: the page after its scripts, its console, and a picture."""
    from matplotlib.image import imread

    done = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", f"--user-data-dir={tmp_path}/profile",
                           "--window-size=900,1000", "--virtual-time-budget=3000", "--enable-logging=stderr", f"--screenshot={tmp_path}/page.png",
                           full[2].as_uri()], capture_output=True, text=True, timeout=240)
    assert (tmp_path / "page.png").exists(), done.stderr[-1000:]
    said = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    assert not said, said
    picture = (255 * imread(tmp_path / "page.png")[290:740, 60:840, :3]).astype(int)  # of the canvas
    colours, counts = np.unique(picture.reshape(-1, 3), axis=0, return_counts=True)
    base = (np.ptp(picture, axis=2) < 30) & (picture.max(axis=2) < 200) & (picture.min(axis=2) > 90)  # grey, darker than the background
    block = picture[..., 0] - picture[..., 2] > 60  # yellow to red
    assert len(colours) > 30 and base.sum() > 5000 and block.sum() > 2000, (len(colours), base.sum(), block.sum())


def test_recorded_forces_are_shown(full, tmp_path):
    from test_forces import two_blocks

    found, _ = page(two_blocks(), tmp_path)
    assert "Base shear, overturning moment and thrust" in found.texts["forces"] and "base shear x" in found.texts["forces"] and "thrust, at" in found.texts["forces"]
    assert "forces" not in full[0].ids
    h = two_blocks()
    alone = results.WallHistory(h.time, h.ids[1:], h.sizes[1:], h.free[1:], h.position[:, 1:], h.orientation[:, 1:], forces=h.forces[2:3])
    found, _ = page(alone, tmp_path)
    assert "Thrust" in found.texts["forces"] and "Base shear" not in found.texts["forces"]
