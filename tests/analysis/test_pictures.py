"""render.py: POV-Ray's input, the camera, the output; films; errors."""

import hashlib
import io
import os
import re
import shutil
import time
import unittest
import unittest.mock
from concurrent.futures import ThreadPoolExecutor

import trajectories
import numpy as np
from PIL import Image
from rodsweep.drawing import camera, movie, povray, staging, tints
from rodsweep.reading import trajectory

NUMBER = r"-?[\d.]+(?:e[-+]?\d+)?"


def opened_picture(picture):
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")).astype(int)


def drawn(shown, *stages, frames=(0,)):
    """Pictures of all stages and frames, in parallel: POV-Ray sleeps for most of its 0.7 s."""
    colours = tints.colours(shown, "rod")
    scenes = [(povray.scene(shown, stage, colours, frame), stage.camera.size) for stage in stages for frame in frames]
    with ThreadPoolExecutor(len(scenes)) as pool:
        return [opened_picture(picture) for picture in pool.map(povray.picture, *zip(*scenes))]


def plain_picture(text, size, threads=1, fine=False):
    """Replaces povray.picture(): one colour that depends on the scene."""
    out = io.BytesIO()
    Image.new("RGB", size, "#" + hashlib.sha1(text.encode()).hexdigest()[:6]).save(out, "PNG")
    return out.getvalue()


def plain_pictures(picture=plain_picture):
    return unittest.mock.patch.object(povray, "picture", picture)


class Planted(trajectories.Planted):
    def stage(self, shown, frames=(0,), view=None, size=(240, 180), floor="auto"):
        return staging.staged(shown, list(frames), np.array([0.0, 1, 0]), view, size, floor)


class Geometry(Planted):
    def test_the_axis_of_a_segment_is_the_local_z_of_its_orientation(self):
        for name, expected in zip("xyz", np.eye(3)):
            np.testing.assert_allclose(trajectory.axis(np.array(trajectories.AXES[name])), expected, atol=1e-15)
        turn = np.random.default_rng(1).normal(size=(20, 4))
        turn /= np.linalg.norm(turn, axis=1, keepdims=True)
        w, v = turn[:, :1], turn[:, 1:]
        z = np.tile([0.0, 0, 1], (20, 1))
        rotated = z + 2 * np.cross(v, np.cross(v, z) + w * z)
        np.testing.assert_allclose(trajectory.axis(turn), rotated, atol=1e-14)

    def test_tubes_are_the_capsules_of_a_known_pose(self):
        shown = self.shown()
        text = povray.tubes(shown, tints.colours(shown, "rod"), frame=2)
        found = np.array([[float(v) for v in re.findall(NUMBER, line)] for line in text.splitlines()
                          if line.startswith("cylinder")])
        found = found[np.lexsort((found[:, 0], found[:, 2]))]
        start = np.tile([-0.3, -0.1, 0.1], 2)
        expected = np.column_stack([start, np.full(6, 1.2), np.repeat([0, 0.5], 3), start + 0.2, np.full(6, 1.2),
                                    np.repeat([0, 0.5], 3), np.full(6, 0.05)])
        np.testing.assert_allclose(found, expected, atol=1e-6)
        spheres = [line for line in text.splitlines() if line.startswith("sphere")]
        self.assertEqual(len(spheres), 12)
        self.assertTrue(all(line.endswith(",0.05}") for line in spheres))

    def test_a_wall_is_a_plate_behind_the_rod(self):
        shown = self.shown(walls=1, rods=1)
        text = povray.tubes(shown, tints.colours(shown, "rod"), frame=0)
        cylinders = [[float(v) for v in re.findall(NUMBER, line)] for line in text.splitlines()
                     if line.startswith("cylinder")]
        plate = [c for c in cylinders if c[6] > 0.06]
        self.assertEqual((len(cylinders), len(plate)), (6, 1))
        self.assertLess(plate[0][0], plate[0][3])   # thick towards -x, where there is no rod
        reach = staging.WALL_RADII * 0.05
        self.assertAlmostEqual(plate[0][6] ** 2 + (plate[0][3] - plate[0][0]) ** 2, reach ** 2, places=6)

    def test_colours_tell_rods_places_and_radii_and_held_segments_are_grey(self):
        shown = self.shown()
        for by, different in (("rod", 2), ("along", 2), ("radius", 1)):
            found = tints.colours(shown, by)
            number = found.numbers(0)
            self.assertIsNone(found.scale)
            self.assertTrue((number[[0, 3]] == len(found.palette) - 1).all())
            self.assertEqual(len(set(number[[1, 2, 4, 5]])), different, by)


class Camera(Planted):
    def test_it_sees_all_capsules_in_all_frames_and_touches_the_border(self):
        rng = np.random.default_rng(5)
        for size in ((400, 300), (300, 500)):
            for _ in range(20):
                view, up = rng.normal(size=3), np.eye(3)[rng.integers(3)]
                framing = camera.Framing(view, up, size)
                points, radius = rng.normal(size=(4, 30, 3)) * rng.uniform(0.1, 3, 3), rng.uniform(0.01, 0.3, 30)
                for frame in points:
                    framing.add(frame, radius)
                seen = framing.camera()
                across = rng.normal(size=(500, 3))
                across /= np.linalg.norm(across, axis=1, keepdims=True)
                surface = (points[:, :, None] + radius[:, None, None] * across).reshape(-1, 3)
                pixel, depth = seen.project(surface)
                self.assertGreater(depth.min(), 0)
                free = camera.MARGIN * np.array(size) / 2
                self.assertTrue((pixel >= free - 1e-9).all() and (pixel <= size - free + 1e-9).all())
                slack = np.concatenate([pixel.min(axis=0) - free, size - free - pixel.max(axis=0)]) / np.tile(size, 2)
                self.assertLess(min(slack[0] + slack[2], slack[1] + slack[3]), 0.05)

    def test_the_middle_of_the_picture_is_on_the_line_of_sight_and_up_is_up(self):
        shown = self.shown()
        seen = self.stage(shown, view="front").camera
        ahead = seen.eye + 2 * seen.forward
        (middle, above, right), depth = seen.project([ahead, ahead + 0.1 * seen.up, ahead + 0.1 * seen.right])
        np.testing.assert_allclose(middle, (120, 90))
        self.assertTrue(above[1] < 90 and right[0] > 120)
        np.testing.assert_allclose(depth, 2)
        np.testing.assert_allclose(seen.right, (1, 0, 0), atol=1e-12)

    def test_gravity_says_where_up_is(self):
        self.plant({"gravity_m_s2": (0.3, 0, -9.8)})
        np.testing.assert_array_equal(staging.upwards(self.opened(), 0), (0, 0, 1))

    def test_a_broad_scene_is_seen_from_its_broad_side(self):
        for along, broad in (("x", 0), ("z", 90)):
            shown = self.shown(rods=1, along=along)
            seen = self.stage(shown).camera
            azimuth = np.degrees(np.arctan2(-seen.forward[0], -seen.forward[2]))
            self.assertAlmostEqual(abs((azimuth - broad + 90) % 180 - 90), staging.TURN_DEG, places=6)

    def test_the_floor_is_under_the_lowest_point_of_all_frames(self):
        shown = self.shown()
        stage = self.stage(shown, range(4))
        self.assertTrue(0.9 < stage.floor < 0.95)
        self.assertIsNone(self.stage(shown, floor="none").floor)
        self.assertEqual(self.stage(shown, floor=-2.0).floor, -2)
        self.assertNotIn("plane", povray.surroundings(self.stage(shown, floor="none")))


class Pictures(Planted):
    def test_a_picture_is_not_blank_and_a_tube_is_as_wide_as_it_is(self):
        shown = self.shown(rods=1)
        stage = self.stage(shown, view="front", floor="none")
        picture, = drawn(shown, stage)
        self.assertEqual(picture.shape, (180, 240, 3))
        tube = picture.min(axis=-1) < 200
        self.assertTrue((picture[~tube] > 200).all())
        self.assertTrue(0.01 < tube.mean() < 0.5)
        centre, depth = stage.camera.project([[0.1, 1, 0], [0.1, 1 + 0.05, 0]])
        column = tube[:, int(centre[0, 0])]
        focal = 240 / (2 * stage.camera.tangents[0])
        self.assertAlmostEqual(column.sum() / 2, 0.05 * focal / depth[0], delta=1)
        self.assertAlmostEqual(np.flatnonzero(column).mean() + 0.5, centre[0, 1], delta=1)
        ends = stage.camera.project([[-0.65, 1, 0], [0.65, 1, 0]])[0][:, 0]
        found = np.flatnonzero(tube.any(axis=0))
        np.testing.assert_allclose((found[0], found[-1] + 1), ends, atol=1.5)

    def test_fine_pictures_have_the_rods_that_are_thinner_than_a_pixel(self):
        shown = self.shown(rods=1, radius=0.001)
        stage = self.stage(shown, view=(20, 10), floor="none")
        text = povray.scene(shown, stage, tints.colours(shown, "rod"), 0)
        ends = stage.camera.project(np.concatenate(shown.ends(0)))[0][:, 0]
        columns = slice(int(ends.min()) + 2, int(ends.max()) - 2)
        with ThreadPoolExecutor(2) as pool:
            drawings = [pool.submit(povray.picture, text, (240, 180), fine=fine) for fine in (False, True)]
        pictures = [opened_picture(drawing.result()) for drawing in drawings]
        found = [(picture.min(axis=(0, 2))[columns] < 250).mean() for picture in pictures]
        self.assertGreater(found[1], max(0.95, found[0]))

    def test_handedness_x_is_to_the_right_from_the_front_and_z_is_near(self):
        shown = self.shown()  # rods at z = 0 and at 0.5, which is nearer
        stage = self.stage(shown, view=(0, 30), floor="none")
        picture, = drawn(shown, stage)
        for segment, rod in ((2, 0), (5, 1)):
            (x, y), _ = stage.camera.project(shown.centres(0)[segment])
            red, _, blue = picture[int(y), int(x)]
            self.assertEqual(red > blue, rod == 1, (segment, picture[int(y), int(x)]))   # blue, then red
        rows = stage.camera.project(shown.centres(0)[[2, 5]])[0][:, 1]
        self.assertGreater(rows[1], rows[0])

    def test_the_floor_takes_a_shadow(self):
        shown = self.shown()
        stages = [self.stage(shown, view=(20, 40), floor=floor) for floor in ("auto", "none")]
        grey = [(np.ptp(picture, axis=-1) < 12) & (picture[..., 0] > 110) & (picture[..., 0] < 225)
                for picture in drawn(shown, *stages)]
        self.assertGreater(grey[0].mean(), 3 * grey[1].mean())   # held segments are grey too

    @plain_pictures()
    def test_stills_have_names_and_are_not_replaced_unasked(self):
        self.plant()
        size = ("--size", "60x40")
        self.assertEqual(self.run_script("render.py", "sweep.h5", *size).stdout, "figures/sweep-task0-frame0003.png\n")
        said = self.run_script("render.py", "sweep.h5", *size, "--frame", "0", "-2", "-o", "out").stdout
        self.assertEqual(said.split(), ["out/sweep-task0-frame0000.png", "out/sweep-task0-frame0002.png"])
        said = self.run_script("render.py", "sweep.h5", *size, "--every", "3", "-o", "some").stdout
        self.assertEqual(said.split(), ["some/sweep-task0-frame0000.png", "some/sweep-task0-frame0003.png"])
        self.refused("render.py", "sweep.h5", *size, words="sweep-task0-frame0003.png already exists")
        self.refused("render.py", "sweep.h5", *size, "-o", "sweep.h5", "--force", words="already exists")
        self.run_script("render.py", "sweep.h5", *size, "--force")
        with open("figures/sweep-task0-frame0003.png", "rb") as a, open("some/sweep-task0-frame0003.png", "rb") as b:
            self.assertNotEqual(a.read(), b.read())   # from another view, since two frames must fit
        self.assertEqual(sorted(os.listdir(self.folder)), ["figures", "out", "some", "sweep.h5"])


class Films(Planted):
    def test_a_gif_has_all_frames_their_time_and_their_pixels(self):
        shown = self.shown()
        self.run_script("render.py", "sweep.h5", "--movie", "gif", "--size", "120x90", "--rate", "20", "-j", "4",
                        "-o", "a.gif")
        stage = self.stage(shown, range(4), size=(120, 90))
        with Image.open("a.gif") as film:
            self.assertEqual((film.n_frames, film.size), (4, (120, 90)))
            self.assertEqual((film.info["loop"], film.info["duration"]), (0, 50))
            for frame, exact in enumerate(drawn(shown, stage, frames=range(4))):
                film.seek(frame)
                self.assertLess(np.abs(np.asarray(film.convert("RGB")).astype(int) - exact).mean(), 2)

    def test_the_order_of_frames_does_not_depend_on_how_many_are_drawn_at_a_time(self):
        def slower_at_first(text, size, threads=1, fine=False):
            time.sleep(delays.pop())
            return plain_picture(text, size)

        self.plant()
        films = []
        for jobs in ("1", "3"):
            delays = [0.01, 0.02, 0.04, 0.08] * 2    # of four samples of the colours, then of four frames
            with plain_pictures(slower_at_first):
                self.run_script("render.py", "sweep.h5", "--movie", "gif", "--size", "60x40", "-j", jobs, "-o",
                                f"{jobs}.gif")
            with open(f"{jobs}.gif", "rb") as film:
                films.append(film.read())
        self.assertEqual(*films)
        with Image.open("3.gif") as film:
            self.assertEqual(film.n_frames, 4)

    def test_frames_that_do_not_change_and_colours_that_are_rare_are_kept(self):
        def png(colour):
            image = Image.new("RGB", (8, 6), "white")
            image.paste(colour, (5, 2, 6, 3))
            out = io.BytesIO()
            image.save(out, "PNG")
            return out.getvalue()
        pictures = [png("red"), png("red"), png("blue")]
        path = "still.gif"
        movie.write_gif(path, iter(pictures), 10, pictures)
        with Image.open(path) as film:
            self.assertEqual(film.n_frames, 3)
            for frame, picture in enumerate(pictures):
                film.seek(frame)
                np.testing.assert_array_equal(np.asarray(film.convert("RGB")), opened_picture(picture))

    def with_programs(self, **scripts):
        """A PATH with replacements of programs, and with povray."""
        os.makedirs("programs")
        if "povray" not in scripts:
            os.symlink(shutil.which("povray"), "programs/povray")
        for name, lines in scripts.items():
            with open(f"programs/{name}", "w", opener=lambda path, flags: os.open(path, flags, 0o755)) as script:
                script.write("#!/bin/sh\n" + lines)
        return unittest.mock.patch.dict(os.environ, {"PATH": os.path.abspath("programs")})

    def test_a_machine_that_is_too_busy_for_povray_is_asked_again(self):
        asked = os.path.join(self.folder, "asked")
        with self.with_programs(povray=f'if [ -e {asked} ]; then printf "\\211PNG"; exit 0; fi\n: >{asked}\n'
                                       f'echo "{povray.BUSY.decode()}" >&2\nexit 1\n'):
            self.assertEqual(povray.picture("", (3, 2)), b"\x89PNG")

    @plain_pictures()
    def test_an_mp4_is_what_ffmpeg_makes_of_the_pictures_in_order(self):
        self.plant()
        with self.with_programs(ffmpeg='for last; do :; done\n/bin/cat >"$last"\n'):
            self.run_script("render.py", "sweep.h5", "--movie", "mp4", "--size", "60x40", "--every", "2", "-o", "a.mp4")
        with open("a.mp4", "rb") as film:
            self.assertEqual(film.read().count(b"\x89PNG"), 2)

    @plain_pictures()
    def test_an_ffmpeg_that_fails_is_said_and_leaves_nothing(self):
        self.plant()
        with self.with_programs(ffmpeg="echo no such encoder >&2\nexit 1\n"):
            self.refused("render.py", "sweep.h5", "--movie", "mp4", "--size", "60x40", "-o", "a.mp4",
                         words="ffmpeg failed: no such encoder")
        self.assertEqual(sorted(os.listdir(self.folder)), ["programs", "sweep.h5"])

    def test_programs_that_are_missing_are_named(self):
        self.plant()
        with self.with_programs():
            self.refused("render.py", "sweep.h5", "--movie", "mp4", words="package ffmpeg")
        with unittest.mock.patch.dict(os.environ, {"PATH": self.folder}):
            self.refused("render.py", "sweep.h5", words="package povray")


class Mistakes(Planted):
    def test_they_are_one_line_and_exit_code_2(self):
        self.write(scenes=("helix",), solves=False)
        self.refused("render.py", "sweep.h5", words="record.trajectory_every")
        self.plant(last=2)
        for words, *arguments in (("task 0 has frames 0 to 1, not 2", "--frame", "2"),
                                  ("has tasks 0 to 2, not 9", "--task", "9"),
                                  ("remove --frame", "--movie", "gif", "--frame", "1"),
                                  ("must be even", "--movie", "mp4", "--size", "61x40"),
                                  ("scene 'net' is not in the file", "--scene", "net")):
            self.refused("render.py", "sweep.h5", *arguments, words=words)
        self.changed(("trajectories/position_m", 0, np.nan))
        self.refused("render.py", "sweep.h5", "--frame", "0", words="positions that are not numbers")
        self.changed(lambda h5: h5.pop("trajectories/segments"))
        self.refused("render.py", "sweep.h5", words="an older rodsweep wrote it")

    @plain_pictures()
    def test_tasks_that_are_not_complete_have_no_picture(self):
        self.write(scenes=("helix",), grid={"scene.segments": [6]}, samples=3, solves=False, pending=(0,))
        trajectories.plant(self.path)
        self.refused("render.py", "sweep.h5", "--task", "0", words="task 0 of sweep.h5 is not complete yet")
        said = self.run_script("render.py", "sweep.h5", "--size", "30x20").stdout
        self.assertIn("task1", said)
