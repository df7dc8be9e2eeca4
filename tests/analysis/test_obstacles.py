"""Obstacles: those of a task, their place and surface in pictures; floors that belong to a scene. paraview.py: all numbers
that the XDMF refers to exist and equal the reader's; lines join segments."""

import os
import unittest.mock
from xml.etree import ElementTree

import synthetic
import numpy as np

import trajectories
from rodsweep.drawing import povray, staging, surfaces, tints
from rodsweep.reading import obstacles, trajectory
from rodsweep.reading.sweepfile import SweepFile
from test_pictures import drawn
from trajectories import obstacle

BALL = {"centre_m": (1, 2, 3), "radius_m": 0.25}
UP = np.array([0.0, 1, 0])
NONE = [np.nan] * 3


class Obstacles(trajectories.Planted):
    def plant(self, columns, scene="net", **settings):
        super().plant({"contact.friction": 0.3, **columns}, scene, **settings)

    def of(self, task):
        with SweepFile(self.path) as file:
            return obstacles.of_task(file, task)

    def staged(self, frames=(0,), size=(240, 180), view=(20, 20)):
        with SweepFile(self.path) as file:
            return staging.staged(trajectory.of_task(file, 0), frames, UP, view, size,
                                  touched=obstacles.of_task(file, 0))

    def test_a_task_has_those_of_its_own_columns(self):
        self.plant({**obstacle(0, "ball", centre_m=[(0, -1, 0), (0, -2, 0), NONE], radius_m=[0.2, 0.4, np.nan]),
                    **obstacle(0, "half_space", point_m=[NONE, NONE, (0, -3, 0)], normal=[NONE, NONE, (0, 3, 4)]),
                    **obstacle(1, "capsule", from_m=[NONE, (0, 0, 0), NONE], to_m=[NONE, (1, 0, 0), NONE],
                               radius_m=[np.nan, 0.1, np.nan])})
        ball, = self.of(0)
        self.assertEqual((*ball.start, *ball.end, ball.radius), (0, -1, 0, 0, -1, 0, 0.2))
        ball, capsule = self.of(1)
        self.assertEqual((ball.start[1], ball.radius), (-2, 0.4))
        self.assertEqual((*capsule.start, *capsule.end, capsule.radius), (0, 0, 0, 1, 0, 0, 0.1))
        slope, = self.of(2)
        np.testing.assert_allclose((*slope.point, *slope.normal), (0, -3, 0, 0, 0.6, 0.8))

    def test_without_contact_there_are_none_and_two_scenes_have_a_floor(self):
        ball = obstacle(0, "ball", centre_m=(0, -1, 0), radius_m=1)
        for scene, expected in (("coiling_rod", 2), ("falling_rods", 2), ("net", 1)):
            self.plant({**ball, "contact.friction": [0.3, np.nan, 0]}, scene=scene)
            self.assertEqual([len(self.of(task)) for task in range(3)], [expected, 0, expected])
        self.write(solves=False)
        self.assertEqual(self.of(0), [])

    def test_the_highest_level_plane_is_the_floor(self):
        self.plant({**obstacle(0, "half_space", point_m=(5, -2, 0), normal=(0, 2, 0)),
                    **obstacle(1, "half_space", point_m=(0, 3, 0), normal=(0, -1, 0))})
        stage = self.staged()
        self.assertEqual((stage.floor, len(stage.slopes)), (-2, 1))
        self.plant({}, scene="falling_rods")
        self.assertEqual(self.staged().floor, 0)

    def test_what_moves_is_drawn_where_it_is_at_the_time_and_is_no_floor(self):
        level = {"normal": (0, 1, 0)}
        self.plant({**obstacle(0, "half_space", point_m=(0, -1, 0), velocity_m_s=(0, 2, 0), **level),
                    **obstacle(1, "half_space", point_m=(0, -3, 0), velocity_m_s=(0, 0, 0), **level),
                    **obstacle(2, "ball", centre_m=(0.3, 1, 0), radius_m=0.1, velocity_m_s=(0, 0, 5))})
        plate, _, ball = (obstacle.at(0.5) for obstacle in self.of(0))
        np.testing.assert_array_equal(plate.point, (0, 0, 0))
        np.testing.assert_array_equal((ball.start, ball.end), [(0.3, 1, 2.5)] * 2)
        stage = self.staged(frames=(0, 3))
        self.assertEqual((stage.floor, len(stage.slopes), len(stage.solids)), (-3, 1, 1))
        with SweepFile(self.path) as file:
            shown = trajectory.of_task(file, 0)
            text = povray.scene(shown, stage, tints.colours(shown, "rod"), 3)
        self.assertIn(f"sphere{{<0.3, 1, {5 * shown.time_s[3]:.12g}>,0.1}}", text)
        pixel = stage.camera.project([(0.3, 1, 5 * time) for time in shown.time_s])[0]
        self.assertTrue((pixel > 0).all() and (pixel < (240, 180)).all())

    def test_what_stands_upright_on_a_wall_stands_on_the_floor(self):
        self.plant({}, along="y", walls=1, rods=1)
        with SweepFile(self.path) as file:
            foot = trajectory.of_task(file, 0).centres(0)[0, 1]
        self.assertAlmostEqual(self.staged().floor, foot, delta=1e-3)
        self.plant({}, along="x", walls=1, rods=1)
        self.assertLess(self.staged().floor, 0.9)

    def test_the_camera_sees_solids_near_the_rods_and_slopes(self):
        self.plant({**obstacle(0, "capsule", from_m=(0, 0, 0), to_m=(0.5, 0.2, 0), radius_m=0.2),
                    **obstacle(1, "half_space", point_m=(0, 0.5, 0), normal=(0.5, 1, 0))})
        stage = self.staged()
        solid, slope = stage.solids[0], stage.slopes[0]
        rim = staging.rim(slope, stage.centre, stage.extent)
        np.testing.assert_allclose((rim - slope.point) @ slope.normal, 0, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(rim - slope.disc(stage.centre, stage.extent)[0], axis=1),
                                   obstacles.DISC * stage.extent)
        shell = np.concatenate([end + solid.radius * np.concatenate([np.eye(3), -np.eye(3)])
                                for end in (solid.start, solid.end)])
        pixel, depth = stage.camera.project(np.concatenate([rim, shell]))
        self.assertGreater(depth.min(), 0)
        self.assertTrue((pixel > 0).all() and (pixel < (240, 180)).all())
        self.assertLess(stage.floor, min(rim[:, 1].min(), shell[:, 1].min()))

    def test_what_is_far_or_huge_does_not_move_the_camera(self):
        self.plant({})
        alone = self.staged()
        self.plant({**obstacle(0, "ball", centre_m=(0, -200, 0), radius_m=200),
                    **obstacle(1, "ball", centre_m=(50, 0, 0), radius_m=0.5)})
        beside = self.staged()
        np.testing.assert_array_equal(beside.camera.eye, alone.camera.eye)
        self.assertEqual(beside.floor, alone.floor)
        self.assertEqual(povray.obstacles(beside).count("sphere{"), 2)

    def test_a_ball_is_drawn_as_large_as_it_is_and_a_slope_is_glass_from_behind(self):
        self.plant(obstacle(0, "ball", centre_m=(0.1, 0.4, 0), radius_m=0.3), rods=1)
        stage = self.staged(view="front")
        with SweepFile(self.path) as file:
            picture, = drawn(trajectory.of_task(file, 0), stage)
        centre, top, right = stage.camera.project([[0.1, 0.4, 0], [0.1, 0.7, 0], [0.4, 0.4, 0]])[0]
        row = picture[int(centre[1]), :].max(axis=-1) < 235
        self.assertLess(abs(row.sum() / 2 - (right[0] - centre[0])), 2.5)
        red, green, blue = picture[int((centre[1] + top[1]) / 2), int(centre[0])]
        self.assertTrue(red > green > blue)   # stone
        self.plant(obstacle(0, "half_space", point_m=(0, 0.5, 0), normal=(0.1, 1, 0)))
        self.assertIn(povray.STONE, povray.obstacles(self.staged(view=(0, 20))))
        below = self.staged(view=(0, -30))
        self.assertIn(povray.GLASS, povray.obstacles(below))
        self.assertNotIn("plane", povray.surroundings(below))

    def test_surfaces_enclose_the_volume_of_their_solid_and_face_outwards(self):
        rng = np.random.default_rng(3)
        for length in (0.0, 2.0):
            start, along, radius = rng.normal(size=3), rng.normal(size=3), 0.7
            end = start + length * along / np.linalg.norm(along)
            points, triangles = surfaces.surface(obstacles.Capsule(start, end, radius), np.zeros(3), 5.0)
            a, b, c = (points[triangles[:, k]] - start for k in range(3))
            volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
            self.assertAlmostEqual(volume / (np.pi * radius ** 2 * (4 / 3 * radius + length)), 1, delta=0.03)
            axis = np.clip((points - start) @ (end - start) / (length ** 2 or 1), 0, 1)[:, None] * (end - start)
            np.testing.assert_allclose(np.linalg.norm(points - start - axis, axis=1), radius)
        slope = obstacles.HalfSpace(np.array([0.0, 2, 0]), np.array([0.6, 0.8, 0]))
        points, triangles = surfaces.joined([surfaces.surface(slope, np.ones(3), 4.0)] * 2)
        np.testing.assert_allclose((points - slope.point) @ slope.normal, 0, atol=1e-12)
        a, b, c = (points[triangles[:, k]] for k in range(3))
        area = np.cross(b - a, c - a) @ slope.normal / 2
        self.assertAlmostEqual(area.sum() / (2 * np.pi * (4 * obstacles.DISC) ** 2), 1, delta=0.01)


class Paraview(trajectories.Planted):
    def document(self, *arguments, name="sweep-task0.xdmf"):
        """The root element of the script's output."""
        self.assertEqual(self.run_script("paraview.py", "sweep.h5", *arguments).stdout, name + "\n")
        return ElementTree.parse(os.path.join(self.folder, name)).getroot()

    def values(self, parent, folder):
        """The rows of the dataset under an element, as an XDMF reader selects them."""
        slab, = parent.findall("DataItem")
        selection, whole = slab.findall("DataItem")
        start, stride, count = np.array(selection.text.split(), dtype=int).reshape(
            [int(n) for n in selection.get("Dimensions").split()])
        self.assertEqual(slab.get("Dimensions").split(), [str(n) for n in count])
        self.assertTrue((stride == 1).all())
        path, dataset = whole.text.split(":")
        with synthetic.h5py.File(os.path.join(folder, path)) as h5:
            found = h5[dataset]
            self.assertEqual(whole.get("Dimensions").split(), [str(n) for n in found.shape])
            self.assertEqual(int(whole.get("Precision")), found.dtype.itemsize)
            kind = {"Float": "f", "Int": "i", "Char": "i"}[whole.get("NumberType")]
            self.assertEqual(found.dtype.kind, kind)
            self.assertTrue((start + count <= found.shape).all())
            return found[tuple(slice(a, a + n) for a, n in zip(start, count))]

    def test_every_frame_points_at_its_rows_of_the_file(self):
        self.plant()
        os.mkdir(os.path.join(self.folder, "there"))
        for arguments, name in (((), "sweep-task0.xdmf"), (("--task", "2", "-o", "there/a.xdmf"), "there/a.xdmf")):
            root = self.document(*arguments, name=name)
            grids = root.findall("Domain/Grid/Grid")
            with SweepFile(self.path) as file:
                shown = trajectory.of_task(file, 2 if arguments else 0)
                self.assertEqual(len(grids), shown.frames())
                for frame, grid in enumerate(grids):
                    at = os.path.dirname(os.path.join(self.folder, name))
                    self.assertEqual(float(grid.find("Time").get("Value")), shown.time_s[frame])
                    np.testing.assert_array_equal(self.values(grid.find("Geometry"), at), shown.centres(frame))
                    found = {a.get("Name"): self.values(a, at) for a in grid.findall("Attribute")}
                    np.testing.assert_array_equal(trajectory.axis(found["orientation"]), shown.axes(frame))
                    for attribute, expected in (("radius", shown.radius), ("length", shown.length), ("rod", shown.rod),
                                                ("static", shown.static)):
                        np.testing.assert_array_equal(found[attribute], expected)

    def test_lines_join_the_segments_of_a_rod_and_segments_without_joints_are_points(self):
        self.plant(rods=6)
        points = self.document().find("Domain/Topology")
        self.assertEqual((points.get("TopologyType"), points.get("NumberOfElements")), ("Polyvertex", "6"))
        np.testing.assert_array_equal(points.find("DataItem").text.split(), [str(k) for k in range(6)])
        self.plant()
        root = self.document("--force")
        lines = root.find("Domain/Topology")
        self.assertEqual((lines.get("TopologyType"), lines.get("NumberOfElements")), ("Polyline", "4"))
        pairs = np.array(lines.find("DataItem").text.split(), dtype=int).reshape(-1, 2)
        np.testing.assert_array_equal(pairs, [[0, 1], [1, 2], [3, 4], [4, 5]])
        for grid in root.findall("Domain/Grid/Grid"):
            self.assertEqual(grid.find("Topology").get("Reference"), "/Xdmf/Domain/Topology[1]")

    def test_joints_of_walls_branches_loops_and_crossings(self):
        def shape(ends, **known):
            low, high = np.array(ends, dtype=float)[:, 0], np.array(ends, dtype=float)[:, 1]
            length = np.linalg.norm(high - low, axis=1)
            return unittest.mock.Mock(length=length, rod=known.get("rod", np.zeros(len(ends), dtype=int)),
                                      ends=lambda frame: (low, high), centres=lambda frame: (low + high) / 2)
        o, a, b, c = (0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, -1, 0)
        for ends, expected in (([(o, o), (o, a)], [[0, 1]]), ([(c, o), (o, a), (o, b)], [[0, 1], [0, 2]]),
                               ([(a, b), (b, c), (c, a)], [[0, 1], [0, 2], [1, 2]]),
                               ([((-1, 0, 0), a), ((0, -1, 0), b)], [[0, 1]]), ([(o, a), (b, c)], np.empty((0, 2)))):
            np.testing.assert_array_equal(trajectory.joints(shape(ends)), expected)
        self.assertEqual(len(trajectory.joints(shape([(c, o), (o, a)], rod=np.array([0, 1])))), 0)   # a contact of two rods

    def test_obstacles_are_a_grid_that_stands_still(self):
        self.plant({"contact.friction": 0.3, **obstacle(0, "ball", **BALL),
                    **obstacle(1, "half_space", point_m=(0, -1, 0), normal=(0, 1, 0))})
        root = self.document()
        self.assertEqual(len(root.findall("Domain/Grid/Grid")), 4)
        grid, = (grid for grid in root.findall("Domain/Grid") if grid.get("Name") == "obstacles")
        triangles, points = (np.array(item.text.split(), dtype=float).reshape(-1, 3)
                             for item in (grid.find("Topology/DataItem"), grid.find("Geometry/DataItem")))
        self.assertEqual(grid.find("Topology").get("NumberOfElements"), str(len(triangles)))
        self.assertEqual(set(triangles.ravel()), set(range(len(points))))
        on_ball = np.isclose(np.linalg.norm(points - (1, 2, 3), axis=1), 0.25)
        self.assertTrue(on_ball.any() and (~on_ball).any() and np.isclose(points[~on_ball, 1], -1).all())

    def test_obstacles_that_move_are_a_grid_a_frame(self):
        self.plant({"contact.friction": 0.3, **obstacle(0, "ball", **BALL, velocity_m_s=(0, 10, 0))})
        series, = (grid for grid in self.document().findall("Domain/Grid") if grid.get("Name") == "obstacles")
        self.assertEqual(len(series.findall("Grid")), 4)
        for grid in series.findall("Grid"):
            time = float(grid.find("Time").get("Value"))
            points = np.array(grid.find("Geometry/DataItem").text.split(), dtype=float).reshape(-1, 3)
            np.testing.assert_allclose(np.linalg.norm(points - (1, 2 + 10 * time, 3), axis=1), 0.25, rtol=1e-6)

    def test_mistakes_are_one_line_and_exit_code_2(self):
        self.write(scenes=("helix",), solves=False)
        self.refused("paraview.py", "sweep.h5", words="record.trajectory_every")
        self.plant()
        self.document()
        self.refused("paraview.py", "sweep.h5", words="sweep-task0.xdmf already exists")
        self.run_script("paraview.py", "sweep.h5", "--force")
        self.assertEqual(sorted(os.listdir(self.folder)), ["sweep-task0.xdmf", "sweep.h5"])
