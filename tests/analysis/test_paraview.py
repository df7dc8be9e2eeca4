"""paraview.py: all numbers that the XDMF refers to exist and equal the reader's; lines join segments."""

import os
import unittest
import unittest.mock
from xml.etree import ElementTree

import synthetic
import numpy as np

import trajectories
from rodsweep.reading import joints, trajectory
from rodsweep.reading.sweepfile import SweepFile
from trajectories import obstacle

BALL = {"centre_m": (1, 2, 3), "radius_m": 0.25}


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

    def test_lines_join_the_segments_of_a_rod(self):
        self.plant()
        root = self.document()
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
            np.testing.assert_array_equal(joints.pairs(shape(ends)), expected)
        self.assertEqual(len(joints.pairs(shape([(c, o), (o, a)], rod=np.array([0, 1])))), 0)   # a contact of two rods

    def test_segments_without_joints_are_points(self):
        self.plant(rods=6)
        lines = self.document().find("Domain/Topology")
        self.assertEqual((lines.get("TopologyType"), lines.get("NumberOfElements")), ("Polyvertex", "6"))
        np.testing.assert_array_equal(lines.find("DataItem").text.split(), [str(k) for k in range(6)])

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


if __name__ == "__main__":
    unittest.main()
