"""Histories of convex blocks: boxes that are given by corners and faces give what boxes give; wedges have their own corners, faces, files and pictures."""

import json
import math
import shutil
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest
from histories import ROUND, about_edge, history, rocking, turn
from masonry import _polyhedra, _pose, results
from matplotlib.image import imread
from masonry._shapes import box_corners
from masonry.results import pictures, view
from masonry.results.reporting import view3d
from test_history_files import decoded

CHROMIUM = shutil.which("chromium")
# A triangle prism along y: base 2, height 3, depth 1; its centre of mass is the origin.
WEDGE = np.array([(x, y, z - 1.0) for y in (-0.5, 0.5) for x, z in ((-1, 0), (1, 0), (0, 3))])
LOOPS = [[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]]


def as_shapes(h):
    """The same history, whose boxes are polyhedra with their corners in another order."""
    shapes = results.Shapes.boxes(h.sizes)
    order = np.array([3, 1, 7, 5, 0, 2, 6, 4])
    number = np.argsort(order)
    blocks = [(own[order], [[int(number[k]) for k in loop] for loop in loops]) for own, loops in zip(np.split(shapes.vertices, shapes.vertex_start[1:-1]), shapes.loops)]
    return results.WallHistory(h.time, h.ids, h.sizes, h.free, h.position, h.orientation, shapes=results.Shapes.of(blocks))


def wedge_on_base(angles, **given):
    """A wedge on a base that turns about its right edge."""
    positions = [[[0, 0, -0.1], about_edge([0, 0, 1.0], [1, 0, 0], turn(a, (0, 1, 0)))] for a in angles]
    orientations = np.array([[[1.0, 0, 0, 0], turn(a, (0, 1, 0))] for a in angles])
    shapes = results.Shapes.of([(results.Shapes.boxes([[4, 4, 0.2]]).vertices, _pose.BOX_FACES), (WEDGE, LOOPS)])
    return history([[4, 4, 0.2], [2, 1, 3]], positions, orientations, shapes=shapes, **given)


@pytest.mark.parametrize("angles", ([0, 0.1, -0.05], [0, 0.2, 0.4, 1.2]))
def test_boxes_as_polyhedra_give_what_boxes_give(angles):
    boxes = rocking(angles, shift=(0.4, 0, 0))
    convex = as_shapes(boxes)
    assert convex.convex.all() and not boxes.convex.any()
    assert np.allclose(convex.lean, boxes.lean, rtol=0, atol=ROUND) and np.allclose(convex.drift(), boxes.drift(), rtol=0, atol=ROUND)
    assert np.array_equal(results.fallen(convex), results.fallen(boxes))
    for towards in ((0, -1, 0), (0.45, -1, 0.4)):
        drawn = []
        for h in (boxes, convex):
            polygons, rows, bright = view.View(h, towards).faces(h.corners(1))
            drawn.append(sorted((int(row), round(float(light), 9), *map(tuple, sorted(polygon.round(9).tolist()))) for polygon, row, light in zip(polygons, rows, bright)))
        assert drawn[0] == drawn[1]


@pytest.mark.parametrize("angle,down", ((0.7, False), (0.79, True)))
def test_a_wedge_has_overturned_where_its_weight_passes_its_edge(angle, down):
    """Critical angle of the triangle: atan(1 / 1), as its centre is 1 m over the middle of a base of 2 m."""
    h = wedge_on_base([0, angle])
    assert results.fallen(h)[:, 1].tolist() == [False, down] and math.atan(1) == pytest.approx(math.pi / 4)
    assert h.lean[1, 1] == pytest.approx(angle) and h.extent[1][1] == pytest.approx(3)
    assert h.drift()[1] == pytest.approx(np.linalg.norm(h.corners(1)[1, 2, 0] - h.corners(0)[1, 2, 0]) / 3)


def test_a_block_that_would_not_stand_alone_has_fallen_at_a_right_angle():
    """A parallelepiped whose centre is 0.1 m beside its base: it leans on another at first."""
    corners = np.array([(x + 1.2 * z, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
    shapes = results.Shapes.of([(corners, _pose.BOX_FACES)])
    angles = 0, 1.5, 1.6
    h = history([[2.2, 1, 1]], [[[0, 0, 0.5]]] * 3, np.array([[turn(a, (0, 1, 0))] for a in angles]), free=[True], shapes=shapes)
    assert results.fallen(h)[:, 0].tolist() == [False, False, True]


def test_saved_and_loaded(tmp_path):
    h = wedge_on_base([0, 0.1])
    h.save(tmp_path / "h.npz")
    file, again = np.load(tmp_path / "h.npz"), results.WallHistory.load(tmp_path / "h.npz")
    assert file["vertex_start"].tolist() == [0, 8, 14] and file["face_start"][-1] == len(file["faces"]) == 24 + 18
    assert np.array_equal(again.corners(1), h.corners(1)) and again.shapes.loops == h.shapes.loops
    rocking([0, 0.1]).save(tmp_path / "boxes.npz")
    assert "vertices" not in np.load(tmp_path / "boxes.npz") and results.WallHistory.load(tmp_path / "boxes.npz").shapes is None


def test_paraview_has_polyhedra(tmp_path):
    h = wedge_on_base([0, 0.1])
    results.write_paraview(h, tmp_path / "h.pvd")
    piece = ElementTree.parse(tmp_path / "h/h_000001.vtu").getroot().find(".//Piece")
    arrays = {node.get("Name"): decoded(node) for node in piece.iter("DataArray")}
    assert piece.get("NumberOfPoints") == "14" and arrays["types"].ravel().tolist() == [42, 42] and arrays["offsets"].ravel().tolist() == [8, 14]
    faces, ends = arrays["faces"].ravel().tolist(), arrays["faceoffsets"].ravel().tolist()
    assert ends == [31, 31 + 1 + 4 + 4 + 15] and faces[0] == 6 and faces[31] == 5 and faces[32:36] == [3, 8, 9, 10]
    assert np.allclose(arrays["Points"][8:], h.corners(1)[1, :6], rtol=0, atol=ROUND) and len(arrays["displacement"]) in (2, 14)


def test_a_vtk_reader_finds_the_volume(tmp_path):
    """Where VTK is installed: the polyhedra have the volumes 3.2 and 3 m^3."""
    vtk = pytest.importorskip("vtk")
    results.write_paraview(wedge_on_base([0, 0.1]), tmp_path / "h.pvd")
    reader, measure = vtk.vtkXMLUnstructuredGridReader(), vtk.vtkCellSizeFilter()
    reader.SetFileName(str(tmp_path / "h/h_000001.vtu"))
    measure.SetInputConnection(reader.GetOutputPort())
    measure.Update()
    volumes = measure.GetOutput().GetCellData().GetArray("Volume")
    assert [volumes.GetValue(k) for k in range(2)] == pytest.approx([3.2, 3])


def test_the_view_of_a_report_has_the_shapes():
    scene = json.loads(view3d.scene(wedge_on_base([0, 0.1]), 0))
    assert scene["shape"] == [0, 1] and scene["shapes"][1]["faces"] == LOOPS and scene["shapes"][1]["vertices"] == WEDGE.ravel().tolist()
    two = json.loads(view3d.scene(rocking([0, 0.1]), 0))
    assert [len(shape["vertices"]) for shape in two["shapes"]] == [24, 24]


def test_pictures_and_reports_are_written(tmp_path):
    h = wedge_on_base([0, 0.1, 0.2])
    results.draw(h, tmp_path / "h.png", view=(1, -1, 0.5))
    results.draw_joints(h, tmp_path / "joints.png")
    results.report(h, tmp_path / "h.html")
    assert "free block of 1 shape," in (tmp_path / "h.html").read_text()
    painter = pictures._Painter(h, [1], 1.0, "displacement", (0, -1, 0), "")
    painter.paint(1)
    drawn = np.concatenate([path.vertices for path in painter._blocks.get_paths()])
    assert abs(drawn[:, 1].max() - h.corners(1)[1, :6, 2].max()) < ROUND


def test_joints_of_convex_blocks_are_those_of_boxes():
    boxes = rocking([0, 0.1, -0.05])
    one, other = results.joints(boxes), results.joints(as_shapes(boxes))
    for name in ("id1", "id2", "center", "area", "opening", "slip", "opening_time"):
        assert np.allclose(one[name], other[name], rtol=0, atol=1e-12), name
    h = wedge_on_base([0, 0.1])
    (joint,) = results.joints(h)
    assert joint["area"] == pytest.approx(2) and joint["opening"] == pytest.approx(2 * math.sin(0.1)) and np.allclose(joint["normal"], [0, 0, 1], atol=1e-12)
    assert results.patches(h).shape == (1, 8, 3)


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium here (Debian: apt install chromium): what a browser draws of the report is not looked at")
def test_a_browser_draws_a_wedge(tmp_path):
    """The console stays silent, and the upright triangle, seen from the front, is coloured over half of the rectangle around it."""
    h = wedge_on_base([0, 0.1])
    results.report(h, tmp_path / "h.html")
    page = tmp_path / "front.html"
    page.write_text((tmp_path / "h.html").read_text().replace("</body>", "<script>masonryReport.look('front'); masonryReport.go(0.5)</script></body>"))
    done = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", f"--user-data-dir={tmp_path}/profile",
                           "--window-size=900,1000", "--virtual-time-budget=3000", "--enable-logging=stderr", f"--screenshot={tmp_path}/page.png", page.as_uri()],
                          capture_output=True, text=True, timeout=240)
    said = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    assert not said, said
    picture = (255 * imread(tmp_path / "page.png")[190:625, 50:850, :3]).astype(int)  # of the canvas
    block = picture[..., 0] - picture[..., 2] > 60  # yellow to red
    rows, columns = (np.flatnonzero(block.any(axis=k)) for k in (1, 0))
    share = block.sum() / (np.ptp(rows) + 1) / (np.ptp(columns) + 1)
    assert block.sum() > 2000 and 0.4 < share < 0.6, (block.sum(), share)


def test_what_hides_what():
    """Two wedges, the second in front of the first: it is drawn later from the front, and earlier from behind."""
    shapes = results.Shapes.of([(results.Shapes.boxes([[4, 9, 0.2]]).vertices, _pose.BOX_FACES), (WEDGE, LOOPS), (WEDGE, LOOPS)])
    h = history([[4, 9, 0.2], [2, 1, 3], [2, 1, 3]], [[[0, 0, -0.1], [0, 1, 1], [0.3, -1, 1]]] * 2, shapes=shapes)
    rows = np.array([1, 2])
    for towards, last in (((0.1, -1, 0.3), 1), ((0.1, 1, 0.3), 0)):
        assert view.View(h, towards).faces(h.corners(0)[1:], rows)[1][-1] == last


def on_top(h, towards, point):
    """Of the faces that show at a point of the picture: the depth of the nearest, and the depths of those that are drawn last there."""
    seen = view.View(h, towards)
    def has(polygon):
        side = np.roll(polygon, -1, axis=0) - polygon
        off = point - polygon
        return (side[:, 0] * off[:, 1] - side[:, 1] * off[:, 0] > -1e-12).all()
    depths = []
    for block, loops in enumerate(h.shapes.loops):
        for loop in loops:
            corners = h.corners(0)[block][loop]
            normal, flat = np.cross(corners[1] - corners[0], corners[2] - corners[1]), seen.place(corners)
            if normal @ seen.towards > 1e-9 and has(flat):
                ray = point @ seen.frame.T
                depths.append((normal @ (corners[0] - ray) / (normal @ seen.towards), flat))
    last = [polygon for polygon in seen.faces(h.corners(0))[0] if has(polygon)]
    drawn = [depth for depth, flat in depths if last and len(flat) == len(last[-1]) and np.allclose(flat, last[-1])]
    return max((depth for depth, _ in depths), default=None), drawn


def union(*boxes):
    """(corners, faces) of a union of boxes between two x, y and z."""
    corners = [np.array([(x, y, z) for z in ends[2] for y in ends[1] for x in ends[0]], dtype=float) for ends in boxes]
    return np.concatenate(corners), [[k + 8 * number for k in loop] for number in range(len(boxes)) for loop in _pose.BOX_FACES]


@pytest.mark.parametrize("towards", ((0.5, -1, 0.45), (-0.7, -1, 0.3), (0.3, 1, 0.6)))
def test_the_parts_of_unions_hide_each_other(towards):
    """A block in the notch of an L, and a U: at every point of the picture the face nearest to the viewer, along the ray, is the one that is drawn last."""
    l_block, u_block = union(((0, 2), (0, 1), (0, 0.5)), ((0, 0.5), (0, 1), (0.5, 2))), union(((3, 5), (0, 1), (1, 1.4)), ((3, 3.4), (0, 1), (0, 1)), ((4.6, 5), (0, 1), (0, 1)))
    shapes = results.Shapes.of([l_block, union(((0.6, 1.2), (0.2, 0.9), (0.5, 1.1))), u_block, union(((3.8, 4.2), (0.1, 2), (0, 0.6)))])
    h = history([[1, 1, 1]] * 4, [[[0, 0, 0]] * 4] * 2, free=[True] * 4, shapes=shapes)
    seen, rng, looked = view.View(h, towards), np.random.default_rng(3), 0
    flat = seen.place(shapes.vertices)
    for point in rng.uniform(flat.min(axis=0), flat.max(axis=0), (400, 2)):
        nearest, drawn = on_top(h, towards, point)
        if nearest is not None:
            looked += 1
            assert min(drawn) == pytest.approx(nearest, abs=1e-9), point
    assert looked > 100


WRONG = [((WEDGE, [0, 5], [0, 1, 2], [0, 3]), "vertex_start: must go from 0 to 6"), ((WEDGE, [0, 6], [0, 1, 6], [0, 3]), "faces: must be numbers of corners, below 6"),
         ((WEDGE, [0, 3, 6], [0, 1, 2], [0, 3]), "faces: each block must have some"), ((WEDGE * np.nan, [0, 6], [0, 1, 2], [0, 3]), "vertices: must be finite")]


@pytest.mark.parametrize("arrays,sentence", WRONG)
def test_wrong_shapes_are_refused(arrays, sentence):
    with pytest.raises(ValueError, match=sentence):
        results.Shapes(*arrays)


def test_shapes_must_be_those_of_the_blocks():
    h = rocking([0, 0.1])
    with pytest.raises(ValueError, match="must be the Shapes of 2 blocks, or None"):
        results.WallHistory(h.time, h.ids, h.sizes, h.free, h.position, h.orientation, shapes=results.Shapes.boxes(h.sizes[:1]))


def test_parts_of_unions_are_found_by_their_faces():
    """Two boxes of one block have no corner in common: they are parts, and gaps are those of the nearest parts, not of the hull of the whole."""
    foot, stem = box_corners([1.0, 0.4, 0.2]) + [0, 0, 0.1], box_corners([0.3, 0.4, 0.8]) + [-0.35, 0, 0.6]
    union = np.concatenate([foot, stem]), [*_pose.BOX_FACES, *[[8 + k for k in loop] for loop in _pose.BOX_FACES]]
    shapes = results.Shapes.of([union, (box_corners([0.2, 0.2, 0.2]), _pose.BOX_FACES), union])
    assert shapes.part_start.tolist() == [0, 8, 16, 24, 32, 40] and shapes.block_of_part.tolist() == [0, 0, 1, 2, 2]
    places = np.array([(0, 0, 0), (0.25, 0, 0.5), (9.0, 0, 0)])
    still = np.tile([1.0, 0, 0, 0], (3, 1))
    pairs = np.array([(0, 1), (0, 2)])
    # The small box stands in the notch: 0.2 m above the foot (z = 0.4 to 0.2), 0.35 m from the stem (x = 0.15 to -0.2).
    assert _polyhedra.gaps(shapes, places, still, pairs) == pytest.approx([0.2, 8.0])
    found = _polyhedra.pairs_of(shapes, np.ones(3, dtype=bool), places, still, np.full(3, 0.3))
    assert found.pairs.tolist() == [[0, 1], [0, 1]] and found.gaps == pytest.approx([0.2, 0.35])
