"""Views, pictures and films of histories made by hand."""

import math

import numpy as np
import pytest
from histories import ROUND, UPRIGHT, facade, history, rocking, turn
from masonry import _pose, results
from masonry.results import pictures, view
from matplotlib.figure import Figure

@pytest.fixture
def drawn(monkeypatch):
    """Figures that would have been saved."""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: figures.append(figure))
    return figures



def test_the_view_is_across_the_plane_of_motion():
    assert np.allclose(view.View(rocking([0, 0.1])).towards, [0, -1, 0])
    assert view.View(rocking([0, 0.1])).label() == "x (m)" and view.View(rocking([0, 0.1], (1, 0, 0))).label() == "y (m)"
    assert np.allclose(view.View(rocking([0, 0.1], (1, 0, 0))).towards, [1, 0, 0])
    yawed = view.View(rocking([0, 0.1], frame=turn(0.7, (0, 0, 1))))
    assert np.allclose(yawed.towards, [math.sin(0.7), -math.cos(0.7), 0]) and yawed.from_side
    both = rocking([0, 0.1])
    both.position[1, 1, 1] += 0.01
    assert view.plane_normal(both) is None and not view.View(both).from_side
    assert view.View(both, (0, -2, 0)).label() == "x (m)"


@pytest.mark.parametrize("move", [(0, 0, 0), (1e-7, 0, 0), (0, 1e-7, 0), (1e-7, 2e-7, -1e-7), (0, 0, 0.01)])
def test_a_facade_that_has_not_moved_sideways_is_seen_from_its_front(move):
    # 1e-7 m is less than 1e-6 of its size, 3 m.
    h = facade(move)
    assert np.allclose(view.View(h).towards, [0, -1, 0])
    quarter = turn(math.pi / 2, (0, 0, 1))
    turned = history(h.sizes, h.position @ _pose.matrices(quarter).T, np.tile(quarter, (2, 2, 1)))
    assert np.allclose(view.View(turned).towards, [1, 0, 0])


def cross(a, b):
    """Of vectors of the plane, which np.cross does not take in every version of NumPy."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def test_blocks_behind_are_drawn_first():
    """Boxes of a regular pattern, in any order: along a ray towards the viewer the last face drawn is that of the nearest box."""
    rng = np.random.default_rng(3)
    center = np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(3)], dtype=float)[rng.permutation(27)]
    sizes = np.where(rng.random((27, 1)) < 0.5, [1.0, 0.4, 0.9], [0.3, 1.0, 1.0])
    h = history(np.vstack([[9, 9, 1], sizes]), [np.vstack([[1, 1, -1], center])])
    seen = view.View(h, (0.5, -1, 0.4))
    polygons, rows, bright = seen.faces(h.corners(0))
    assert np.allclose(np.unique(bright.round(9)), [0.7, 0.9, 1])  # flanks, fronts, tops
    turned = history([[9, 9, 1], [1, 0.4, 0.9]], [[[1, 1, -1], [0, 0, 0]]], np.array([[UPRIGHT, turn(math.pi / 6, (0, 0, 1))]]))
    assert np.allclose(np.sort(seen.faces(turned.corners(0)[1:])[2]), [0.9 - 0.2 * math.cos(math.pi / 6), 0.9 - 0.2 / 2, 1], rtol=0, atol=1e-12)
    assert all(cross(p[1] - p[0], p[2] - p[1]) > 0 for p in polygons)  # counterclockwise: outsides
    assert np.allclose(np.column_stack([seen.frame, seen.towards]).T @ np.column_stack([seen.frame, seen.towards]), np.eye(3), rtol=0, atol=1e-12)
    assert np.array_equal(view.View(h, (0, 0, 1)).frame, np.eye(3)[:, :2])
    # Parallelograms; of a box three faces show, each as large as its part across the view.
    assert np.allclose(polygons[:, 0] + polygons[:, 2], polygons[:, 1] + polygons[:, 3], rtol=0, atol=1e-12)
    areas = np.bincount(rows, cross(polygons[:, 1] - polygons[:, 0], polygons[:, 2] - polygons[:, 1]))
    assert np.allclose(areas, (np.roll(h.sizes, 1, axis=1) * np.roll(h.sizes, 2, axis=1)) @ np.abs(seen.towards), rtol=1e-12)
    for towards in ((0.5, -1, 0.4), (0, -1, 0)):  # of no blocks, no faces
        assert not any(map(len, view.View(h, towards).faces(h.corners(0)[:0])))
    depth = h.position[0] @ seen.towards
    checked = 0
    for point in rng.uniform(*np.quantile(polygons.reshape(-1, 2), (0.2, 0.8), axis=0), size=(500, 2)):
        edges = np.roll(polygons, -1, axis=1) - polygons
        inside = (cross(edges, point - polygons) > 1e-9).all(axis=1)
        if not inside.any():
            continue
        # How near the box is where the ray leaves it: the least over its three slabs.
        origin, near = seen.frame @ point, []
        for k in range(len(sizes) + 1):
            with np.errstate(divide="ignore"):
                exits = (np.sign(seen.towards) * h.sizes[k] / 2 - (origin - h.position[0, k])) / seen.towards
            near.append(exits.min())
        hit = np.unique(rows[inside])
        assert rows[np.flatnonzero(inside)[-1]] == max(hit, key=lambda k: near[k])
        checked += 1
    assert checked > 300 and len(np.unique(depth)) > 1


@pytest.mark.parametrize("pairs, depth, order", [([], [3, 1, 2], [1, 2, 0]),  # the deepest first
                                                 ([(2, 1), (1, 0)], [1, 2, 3], [2, 1, 0]),  # but behind comes before in front
                                                 ([(0, 1), (1, 2), (2, 0), (0, 3)], [3, 1, 2, 0], [1, 2, 0, 3])])  # of a circle too, not of what is before it
def test_the_order_of_drawing(pairs, depth, order):
    behind, before = np.array(pairs, dtype=int).reshape(-1, 2).T
    assert view._sorted(behind, before, np.array(depth, dtype=float)).tolist() == order


@pytest.mark.parametrize("side", [1, -1])
def test_a_small_block_at_the_end_of_a_long_one_hides_it_or_is_hidden(side):
    """In front its middle is the deeper one, behind the nearer one."""
    h = history([[9, 9, 1], [4, 0.3, 0.3], [0.3, 0.3, 0.3]], [[[0, 0, -5], [0, 0, 0], [1.9 * side, -0.35 * side, 0]]])
    assert view.View(h, (-0.8, -1, 0.4)).faces(h.corners(0)[1:])[1].tolist() == [0, 0, 0, 1, 1, 1][::side]


def test_pictures_show_the_movement_enlarged(tmp_path):
    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    painter = pictures._Painter(h, [1], 3.0, "rotation", None, "")
    painter.paint(1)
    drawn = np.concatenate([path.vertices for path in painter._blocks.get_paths()])
    assert abs(drawn[:, 0].max() - h.corners(1, 3.0)[:, :, 0].max()) < ROUND and "3 times" in painter.figure.axes[0].get_title()
    # The upper right corner of the block: movement times three. Half of the smallest block where no factor is given.
    start, moved = h.corners(0)[1], h.corners(1)[1]
    assert np.allclose(h.corners(1, 3.0)[1] - start, 3 * (moved - start), rtol=0, atol=ROUND)
    for samples in ([1], [0, 1, 2]):
        assert abs(view.enlargement(h, samples, 0.5) * np.linalg.norm(moved - start, axis=1).max() - 0.25) < ROUND
    assert view.enlargement(rocking([0, 0.2]), [1], 0.5) == 1  # its top moves by 0.4 m
    for name, act in (("shape", results.draw), ("joints", results.draw_joints)):
        act(h, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"


def test_a_picture_shows_the_sample_of_the_largest_drift(drawn, tmp_path):
    """Where no time is given."""
    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    results.draw(h, tmp_path / "shape.png", enlarge=1)
    vertices = np.concatenate([path.vertices for path in drawn[0].axes[0].collections[-1].get_paths()])
    assert abs(vertices[:, 0].max() - h.corners(1)[:, :, 0].max()) < ROUND


def test_what_solvers_leave_is_no_movement(tmp_path):
    for way, moved in ((2e-6, False), (4e-6, True)):  # 1e-6 of the size is 3e-6 m
        h = facade((way, 0, 0))
        painter = pictures._Painter(h, [1], None, "displacement", None, "")
        painter.paint(1)
        assert ("nothing moved" in painter.figure.axes[0].get_title()) != moved
        assert abs(painter._enlarge * (way / 0.15 if moved else 1) - 1) < 1e-9  # round-off of 1 m in 4e-6 m
        assert len(painter.figure.axes) == 1 + moved  # the scale
        results.draw_joints(h, tmp_path / "joints.png")


@pytest.mark.parametrize("moves, end, beyond", [([0.01, 0.02, 0.03, 0.02], 0.03, False),  # all stand
                                                ([0.01, 0.02, 0.03, 9.0], 0.03, True),  # one has fallen
                                                ([0.01, 7.0, 8.0, 9.0], 9.0, False),  # most have
                                                ([1e-7, 1e-7, 1e-7, 9.0], 9.0, False)])  # what stands has not moved
def test_colours_are_left_to_what_stands_and_to_a_heap(moves, end, beyond):
    # Those that have gone metres also lie by 2 m lower, which is more than half of their height.
    h = facade([[0, math.sqrt(m**2 - 4) if m > 1 else m, -2 if m > 1 else 0] for m in moves], blocks=4)
    assert results.fallen(h)[1, 1:].tolist() == [m > 1 for m in moves]
    painter = pictures._Painter(h, [1], 1.0, "displacement", None, "")
    label = painter.figure.axes[1].get_ylabel()
    assert abs(painter._map.norm.vmax - end) < 1e-12 and ("fallen" in label) == beyond
    painter = pictures._Painter(h, [1], 1.0, "displacement", (0, 0, 1), "")  # low: from above
    painter.figure.canvas.draw()
    label, canvas = painter.figure.axes[1].yaxis.label.get_window_extent(), painter.figure.bbox
    assert canvas.y0 <= label.y0 and label.y1 <= canvas.y1 and label.x1 <= canvas.x1, (label, canvas)  # nothing of it is cut off


@pytest.mark.parametrize("level, lacking, panels", [(1e6, 0, 1), (1e6, 1e-10, 1), (-1e6, 1e-10, 1), (1e6, 1e-3, 2)])
def test_a_balance_that_closes_by_definition_is_not_shown_as_its_error(drawn, tmp_path, level, lacking, panels):
    """What is lost is booked as the impacts' but for `lacking` J; 1e-10 J is round-off of a potential energy of 1e6 J, above or below z = 0."""
    h = rocking([0, 0.1, 0])
    energies = np.array([[0, level, 0, 0, 0, 0, 0], [3, level + 5, 0, 1, 0, 2, 11], [0, level, 0, 2, 0, 5 + lacking, 7]])
    h = history(h.sizes, h.position, h.orientation, energies=energies)
    results.draw_energy(h, tmp_path / "energy.png")
    lines = {line.get_label(): line.get_ydata().tolist() for line in drawn[0].axes[0].lines}
    assert lines["work of the base"] == [0, 11, 7] and lines["potential, since the start"] == [0, 5, 0] and lines["dissipated by friction"] == [0, 1, 2]
    assert panels == 1 or drawn[0].axes[1].lines[0].get_ydata().tolist() == h.energy["error"].tolist()
    texts = [text.get_text() for text in drawn[0].axes[0].get_legend().get_texts()]
    assert len(drawn[0].axes) == panels and ("dissipated by impacts and numerically" in texts) == (panels == 1)
    assert drawn[0].axes[-1].get_xlabel() == "time (s)"


def test_a_film_has_the_frames_asked_for(tmp_path, capfd):
    from PIL import Image

    h = rocking([0, 0.1, -0.05, 0.02, 0.2], shift=(0.4, 0, 0))
    capfd.readouterr()
    results.film(h, tmp_path / "h.gif", frames_per_second=4)  # 2 s of motion
    assert capfd.readouterr().err == ""  # no terminal, no bar
    with Image.open(tmp_path / "h.gif") as gif:
        durations = []
        for k in range(gif.n_frames):
            gif.seek(k)
            durations.append(gif.info["duration"])
    assert len(durations) == 5 and sum(durations) == 9 * 250  # frames of one sample are one, shown longer
    results.film(h, tmp_path / "slow.gif", start=0.5, end=1.0, frames_per_second=1, speed=0.5, progress=False)
    with Image.open(tmp_path / "slow.gif") as gif:
        assert gif.n_frames == 2
    results.film(h, tmp_path / "end.gif", end=1.5, frames_per_second=9, speed=2.7, progress=False)  # 5 times 2.7/9 s is 1.5 s and round-off
    for window in ((0.5, 0.5), (None, 0.0), (2.0, None), (0.4, 0.6)):  # one sample
        results.film(h, tmp_path / "still.gif", *window, progress=False)
        with Image.open(tmp_path / "still.gif") as gif:
            assert gif.n_frames == 1


@pytest.mark.parametrize("angles", [[0.1, 0.2], [0, 0], [0, 0.1]])
def test_a_map_without_joints_says_so(drawn, tmp_path, angles):
    """A block that leans in the first sample has no joint with the base: that nothing opened would be wrong."""
    results.draw_joints(rocking(angles), tmp_path / "joints.png")
    titles = [axes.get_title() for axes in drawn[0].axes[:2]]
    assert [("no blocks touch at first" in t) for t in titles] == [angles[0] != 0] * 2
    assert ["nothing" in t for t in titles] == [angles == [0, 0], angles[0] == 0]


def falling(depth):
    """A wall of 4 x 3 m; its upper block falls off the base, and down by `depth` m."""
    places = np.array([[[0, 0, -0.1], [0, 0, 0.5], [0, 0, 1.5], [0, 0, 2.5]]] * 3)
    places[1:, 3] += [[3, 0, -1], [9, 0, -depth]]
    return history([[5, 2, 0.2], [4, 0.5, 1], [4, 0.5, 1], [4, 0.5, 1]], places)


def test_pictures_and_films_are_of_the_structure_and_not_of_what_falls_away():
    """The first shape, and what stands; fallen blocks only within its size, 4 m, beside it. How deep a block falls changes nothing."""
    frames = []
    for depth in (2.6, 20.0):
        axes = pictures._Painter(falling(depth), [0, 1, 2], 1.0, "displacement", None, "").figure.axes[0]
        frames.append((*axes.get_xlim(), *axes.get_ylim()))
    assert frames[0] == frames[1]
    left, right, low, high = frames[0]
    assert left < -2 and right > 2 and low < 0 and high > 3  # all of the first shape
    assert right - left < 12 * 1.2 and high - low < 3 + 2 * 0.06 * 8 + 0.1
    # Seen from above, what has fallen towards the viewer is in the picture too: 2 m in front of the wall.
    h = falling(2.6)
    h.position[1:, 3, :2] = 0, -2
    painter = pictures._Painter(h, [2], 1.0, "displacement", (0.4, -1, 0.5), "")
    axes, corner = painter.figure.axes[0], painter._view.place(h.corners(2)[3])
    assert axes.get_ylim()[0] < corner[:, 1].min() + 0.4
    # Blocks that stand are in the picture, wherever they have gone and however much they are enlarged.
    h = facade((30, 0, 0))
    axes = pictures._Painter(h, [1], 2.0, "displacement", None, "").figure.axes[0]
    assert axes.get_xlim()[1] > 61 and axes.get_xlim()[0] < -1


@pytest.mark.parametrize("sizes", [(0.4, 0.5, 2), (0.8, 0.2, 2), (8, 0.5, 1)])
@pytest.mark.parametrize("far, forces", [(0, False), (4.5e6, True)])
def test_labels_do_not_lie_over_each_other(drawn, tmp_path, sizes, far, forces):
    """Of slender and long walls, small movement and large (openings of 12,345 mm), at the origin and at map coordinates."""
    for way in (0.01234, 12.345):
        place = np.array([[far, 0, -0.1], [far, 0, sizes[2] / 2]])
        h = history([[20, 20, 0.2], sizes], [place, place + [[0, 0, 0], [way / 20, 0, 0]], place + [[0, 0, 0], [way / 10, 0, way]]])
        if forces:
            h.forces = np.array([(1, 10, 11, (0, 0, 5), (far, 0, 0))], dtype=[("sample", int), ("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)])
        results.draw(h, tmp_path / "shape.png")
        results.draw_joints(h, tmp_path / "joints.png")
    for figure in drawn:
        figure.draw_without_rendering()
        axises = [(axis, *sorted(limits)) for axes in figure.axes for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim()))]
        texts = [text for axis, _, _ in axises for text in (axis.label, axis.offsetText)] + [axes.title for axes in figure.axes]
        texts += [tick.label1 if tick.label1.get_visible() else tick.label2 for axis, low, high in axises for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        texts = [text for text in texts if text.get_text() and text.get_visible()]
        boxes = [text.get_window_extent() for text in texts]
        for k, box in enumerate(boxes):
            inside = figure.bbox.x0 - 1 <= box.x0 and box.x1 <= figure.bbox.x1 + 1 and figure.bbox.y0 - 1 <= box.y0 and box.y1 <= figure.bbox.y1 + 1
            over = [texts[j].get_text() for j, other in enumerate(boxes) if j != k and box.overlaps(other)]
            assert inside and not over, (texts[k].get_text(), over, box, figure.bbox)


def test_titles_are_in_the_picture(tmp_path):
    """The border of a saved picture is white: its title is not cut off."""
    from matplotlib.image import imread

    place = np.array([[0, 0, -0.1], [0, 0, 0.875]])
    h = history([[20, 20, 0.2], (2, 0.2, 1.75)], [place, place + [[0, 0, 0], [0.1, 0, 0]], place + [[0, 0, 0], [0.2, 0, 0.4]]])
    results.draw_joints(h, tmp_path / "joints.png")
    picture = imread(tmp_path / "joints.png")
    assert min(side.min() for side in (picture[:3], picture[-3:], picture[:, :3], picture[:, -3:])) == 1


@pytest.mark.parametrize("sizes", [(0.4, 0.5, 2), (8, 0.5, 1)])
def test_joint_maps_fit_a_page_and_thrust_has_a_scale(drawn, tmp_path, sizes):
    """Three maps on 7.4 x 9 inches. The resultant of 5 kN is in the picture as a whole, and the scale of 2 kN is 2/5 as long."""
    place = np.array([[0, 0, -0.1], [0, 0, sizes[2] / 2]])
    h = history([[20, 20, 0.2], sizes], [place, place + [[0, 0, 0], [0.02, 0, 0]]])
    h.forces = np.array([(1, 10, 11, (3000, 0, 4000), (0.02, 0, 0))], dtype=[("sample", int), ("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)])
    results.draw_joints(h, tmp_path / "joints.png", title="a wall")
    assert (drawn[0].get_size_inches() <= (7.4, 9.0)).all() and [text.get_text() for text in drawn[0].texts] == ["a wall"]
    axes = next(one for one in drawn[0].axes if one.get_title().startswith("thrust"))
    (low, high), (ends,) = sorted(axes.get_ylim()), axes.collections[1].get_segments()
    assert low < ends[:, 1].min() and ends[:, 1].max() < high and np.allclose((ends[1] - ends[0]) / (2 * sizes[2]), (0.6, 0.8))
    bar = next(text for text in axes.texts)
    assert bar.get_text().strip() == "2 kN" and np.ptp(axes.lines[1].get_xdata()) == pytest.approx(0.4 * 2 * sizes[2])


def test_scales_of_joint_maps_leave_out_what_has_fallen(drawn, tmp_path):
    """The second block has slid by 0.05 m; the one above it by 3 m when it has not yet fallen."""
    h = falling(2.6)
    h.position[1:, 2, 0] += 0.05
    h.position[1, 3, 0], h.position[1, 3, 2] = 0.9, 2.5
    results.draw_joints(h, tmp_path / "joints.png")
    labels = {one.get_ylabel().split("\n")[0]: one for one in drawn[0].axes if "fallen" in one.get_ylabel()}
    assert labels.keys() == {"slip (mm)"} and labels["slip (mm)"].get_ylim()[1] == pytest.approx(50)
