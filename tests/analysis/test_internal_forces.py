"""Tension, bending, torsion and stress of segments: closed forms, invariances, colours in pictures, ParaView's arrays."""

import io
import os
import unittest
import unittest.mock
from types import SimpleNamespace
from xml.etree import ElementTree

import h5py
import trajectories
import numpy as np
from PIL import Image
from rodsweep.drawing import colourbar, povray, tints
from rodsweep.reading import internal_forces, trajectory

N, H, RADIUS = 6, 0.2, 0.05    # segments of a rod, their length, their radius
LENGTH = N * H
ALONG = np.arange(1, N) * H    # of the joints, from the first end
MIDDLE = (np.arange(N) + 0.5) * H
X, Y, Z = np.eye(3)
AREA, SECOND_MOMENT = np.pi * RADIUS ** 2, np.pi / 4 * RADIUS ** 4


def rod(force, moment, **changes):
    """A straight rod along x with these forces and moments of its joints, as of a Trajectory."""
    centre = MIDDLE[:, None] * X
    pairs = np.stack([np.arange(N - 1), np.arange(1, N)], axis=1)
    return made(**{"centre": centre, "axis": np.tile(X, (N, 1)), "length": np.full(N, H), "pairs": pairs,
                   "position": ALONG[:, None] * X, "force": force, "moment": moment, **changes})


def made(centre, axis, length, pairs, position, force, moment, radius=RADIUS, wall=np.inf):
    def still(values):
        return lambda frame: np.asarray(values, dtype=float)
    return SimpleNamespace(length=length, radius=np.full(len(length), radius), wall=wall, centres=still(centre),
                           axes=still(axis), joint_segments=lambda: np.asarray(pairs), joint_positions=still(position),
                           joint_forces=still(force), joint_moments=still(moment))


def of(shown):
    return internal_forces.of_segments(shown, 1)


def bent(force_n=3.0, moment_nm=0.7):
    """Joints of a rod that hangs along x under its weight, is bent by a force at its tip, and twisted."""
    force = 5 * (LENGTH - ALONG)[:, None] * X - force_n * Y
    moment = moment_nm * X - force_n * (LENGTH - ALONG)[:, None] * Z
    return force, moment


class ClosedForms(unittest.TestCase):
    def test_the_tension_of_a_hanging_rod_is_the_weight_below(self):
        weight_n_m = 1000 * AREA * 9.81
        found = of(rod(weight_n_m * (LENGTH - ALONG)[:, None] * X, np.zeros((N - 1, 3))))
        np.testing.assert_allclose(found["tension"][1:-1], weight_n_m * (LENGTH - MIDDLE)[1:-1])
        np.testing.assert_allclose(found["tension"][[0, -1]], weight_n_m * (LENGTH - ALONG)[[0, -1]])   # of one joint
        np.testing.assert_allclose(found["stress"], found["tension"] / AREA)
        self.assertFalse(found["bending"].any() or found["torsion"].any())

    def test_the_torsion_of_a_twisted_rod_is_gj_theta_over_l_with_the_sign_of_its_screw(self):
        for theta in (2.5, -2.5):
            torque = 4e5 * np.pi / 2 * RADIUS ** 4 * theta / LENGTH
            found = of(rod(np.zeros((N - 1, 3)), np.tile(torque * X, (N - 1, 1))))
            np.testing.assert_allclose(found["torsion"], torque)
            self.assertFalse(found["tension"].any() or found["bending"].any() or found["stress"].any())

    def test_a_cantilever_has_the_moment_of_its_tip_force_and_the_stress_of_its_section(self):
        for wall, inner in ((np.inf, 0), (0.02, RADIUS - 0.02), (0.07, 0)):
            found = of(rod(*bent(), wall=wall))
            bending, tension = 3 * (LENGTH - MIDDLE), 5 * (LENGTH - MIDDLE)
            stress = (tension / (np.pi * (RADIUS ** 2 - inner ** 2)) +
                      bending * RADIUS / (np.pi / 4 * (RADIUS ** 4 - inner ** 4)))
            for name, expected in (("bending", bending), ("tension", tension), ("stress", stress)):
                np.testing.assert_allclose(found[name][1:-1], expected[1:-1], err_msg=name)
        self.assertNotIn("stress", of(rod(*bent(), wall=None)))

    def test_a_pushed_rod_has_negative_tension_and_positive_stress(self):
        found = of(rod(np.tile(-2 * X, (N - 1, 1)), np.zeros((N - 1, 3))))
        np.testing.assert_allclose(found["tension"], -2)
        np.testing.assert_allclose(found["stress"], 2 / AREA)

    def test_branches_add_up_and_joints_at_the_middle_do_not_count(self):
        centre = [-X, X, Y, -X]     # a trunk that ends in two branches and is crossed by another rod
        force, moment = np.array([3 * X, 4 * X + Y, 100 * X]), np.array([X, 2 * X + 5 * Z, 100 * X])
        found = of(made(centre, [X, X, Y, Z], np.full(4, 2.0), [[0, 1], [0, 2], [0, 3]], [0 * X, 0 * X, -0.99 * X], force,
                        moment))
        np.testing.assert_allclose([found[name][0] for name in ("tension", "bending", "torsion")], [7, 5, 3])
        np.testing.assert_allclose(found["tension"][1:3], [3, 1])
        self.assertTrue(np.isnan(found["tension"][3]))

    def test_a_wall_has_no_values(self):
        shown = rod(*bent())
        shown.length[0] = shown.radius[0] = 0
        found = of(shown)
        self.assertTrue(all(np.isnan(values[0]) and np.isfinite(values[1:]).all() for values in found.values()))


class Invariances(unittest.TestCase):
    def same(self, shown):
        expected = of(rod(*bent()))
        for name, values in of(shown).items():
            np.testing.assert_allclose(values, expected[name], rtol=1e-12, err_msg=name)

    def test_a_turned_scene_has_the_same_values(self):
        turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
        turn *= np.linalg.det(turn)
        shown = rod(*bent())
        self.same(made(shown.centres(1) @ turn.T + [1, 2, 3], shown.axes(1) @ turn.T, shown.length, shown.joint_segments(),
                       shown.joint_positions(1) @ turn.T + [1, 2, 3], *(vectors @ turn.T for vectors in bent())))

    def test_neither_the_direction_of_axes_nor_the_order_of_a_joint_matters(self):
        shown = rod(*bent())
        self.same(rod(*bent(), axis=shown.axes(1) * np.resize([1, -1], N)[:, None]))
        self.same(rod(*(-vectors for vectors in bent()), pairs=shown.joint_segments()[:, ::-1]))


class Pictures(trajectories.Planted):
    def plant_rod(self, columns=None, **settings):
        """plant()'s rod along x with the joints of bent(); its first segment is held."""
        self.plant(columns, rods=1, **settings)
        pairs = np.stack([np.arange(N - 1), np.arange(1, N)], axis=1)
        position = (ALONG - LENGTH / 2)[:, None] * X + Y
        trajectories.plant_joints(self.path, pairs, position, *bent())
        return trajectory.of_task(self.opened(), 0)

    def test_planted_values_are_read_in_every_frame_but_the_first(self):
        shown = self.plant_rod()
        for frame in (1, 3):
            for name, values in shown.internal_forces(frame).items():
                np.testing.assert_allclose(values, of(rod(*bent()))[name], err_msg=name)
        self.assertTrue(all(np.isnan(values).all() for values in shown.internal_forces(0).values()))

    def test_signed_scales_are_symmetric_and_the_same_in_all_frames(self):
        self.plant_rod()
        file = self.changed(("trajectories/joint_force_n", slice(5, 10), lambda force: -2 * force))    # frame 1
        shown = trajectory.of_task(file, 0)
        found = tints.colours(shown, "tension", range(4))
        self.assertEqual(found.scale, tints.Scale("tension", "N", -9.0, 9.0))    # twice 5 N/m by 0.9 m
        pushed, pulled = found.numbers(1), found.numbers(3)
        held = len(found.palette) - 1
        self.assertEqual((pushed[0], pulled[0], set(found.numbers(0))), (held, held, {held}))
        self.assertEqual((pushed[1], pulled[1]), (0, round((tints.SHADES - 1) * 0.75)))
        red, _, blue = found.palette[pushed[1]]
        self.assertGreater(blue, red)
        self.assertEqual(tints.colours(shown, "bending", range(4)).scale, tints.Scale("bending", "N m", 0.0, 2.7))

    def test_a_scale_of_nothing_but_zeros_is_one(self):
        self.plant_rod()
        file = self.changed(("trajectories/joint_moment_nm", slice(5, None), 0.0))
        found = tints.colours(trajectory.of_task(file, 0), "torsion", range(4))
        self.assertEqual((found.scale.low, found.scale.high), (-1, 1))

    def test_the_bar_shows_the_shades_from_low_to_high(self):
        shades = np.linspace([0, 0, 1], [1, 0, 0], tints.SHADES)
        bar = np.asarray(colourbar.strip(tints.Scale("tension", "N", -2.0, 2.0), shades, (400, 40))).astype(int)
        self.assertEqual(bar.shape, (40, 400, 3))
        row = bar[12, 125:276]
        self.assertTrue((np.diff(row[:, 0]) >= 0).all() and (np.diff(row[:, 2]) <= 0).all())
        self.assertTrue(row[0, 2] > 240 and row[-1, 0] > 240)

    def test_a_picture_with_a_bar_has_the_size_asked_for(self):
        self.plant_rod()
        drawn = []

        def blank(_, size, *__):
            drawn.append(size)
            out = io.BytesIO()
            Image.new("RGB", size, "white").save(out, "PNG")
            return out.getvalue()

        with unittest.mock.patch.object(povray, "picture", blank):
            for by in internal_forces.QUANTITIES:
                self.run_script("render.py", "sweep.h5", "--size", "300x200", "--colour", by, "-o", f"{by}.png")
                with Image.open(f"{by}.png") as picture:
                    self.assertEqual(picture.size, (300, 200))
                    self.assertTrue((np.asarray(picture)[:drawn[-1][1]] == 255).all())
                    self.assertLess(np.asarray(picture)[drawn[-1][1]:].min(), 100)
            self.run_script("render.py", "sweep.h5", "--size", "300x200", "--colour", "stress", "--movie", "gif", "-o", "a.gif")
            self.run_script("render.py", "sweep.h5", "--size", "300x200", "--colour", "stress", "--beside", "1", "-o", "b.png")
        with Image.open("a.gif") as film:
            self.assertEqual((film.n_frames, film.size), (4, (300, 200)))

    def test_files_without_forces_and_sections_without_a_stress_are_refused(self):
        self.plant(rods=1)
        self.refused("render.py", "sweep.h5", "--colour", "tension", words="set record.forces in the job to true")
        self.plant_rod()
        self.refused("render.py", "sweep.h5", "--colour", "bending", "--frame", "0",
                     words="the first frame is the initial state")
        for kind, wall, expected in (("tube", 0.02, 0.02), ("rectangle", np.nan, None)):
            self.plant_rod()
            file = self.changed(("tasks/parameters/scene.section.type", None, np.array(3 * [kind], dtype=h5py.string_dtype())),
                                ("tasks/parameters/scene.section.wall_m", None, np.full(3, wall)))
            self.assertEqual(trajectory.of_task(file, 0).wall, expected)
        self.refused("render.py", "sweep.h5", "--colour", "stress", words="neither a solid circle nor a tube")

    def test_paraview_has_the_values_of_every_frame_where_forces_were_recorded(self):
        shown = self.plant_rod()
        self.run_script("paraview.py", "sweep.h5")
        grids = ElementTree.parse("sweep-task0.xdmf").getroot().findall("Domain/Grid/Grid")
        for frame, grid in enumerate(grids):
            for name, values in shown.internal_forces(frame).items():
                item = grid.find(f"Attribute[@Name='{name}']/DataItem")
                self.assertEqual(item.get("Dimensions"), str(N))
                np.testing.assert_allclose(np.array(item.text.split(), dtype=float), np.nan_to_num(values), rtol=1e-8)
        self.plant(rods=1)
        os.remove("sweep-task0.xdmf")
        self.run_script("paraview.py", "sweep.h5")
        with open("sweep-task0.xdmf", encoding="utf-8") as written:
            self.assertNotIn("tension", written.read())
