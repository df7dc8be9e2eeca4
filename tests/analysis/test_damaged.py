"""Scripts on truncated or incomplete files: one plain line and exit code 2, or the figures, never a traceback.

Bytes are not flipped here: on some such files libhdf5 1.10 crashes, and with it the process."""

import random
import unittest

import h5py
import running

SCRIPTS = (("summary.py",), ("summary.py", "--json"), ("export.py",), ("spatial.py",))


class Damaged(running.Scripts):
    def setUp(self):
        super().setUp()
        self.write(scenes=("helix",), samples=2)
        with open(self.path, "rb") as whole:
            self.whole = whole.read()

    def plant(self, contents):
        with open(self.path, "wb") as damaged:
            damaged.write(contents)

    def assert_plain(self, script, *arguments):
        done = running.run(script, self.path, *arguments)
        if done.code:
            self.assertEqual(done.code, 2, done.stderr)
            *warnings, error = done.stderr.splitlines()
            self.assertTrue(error.startswith(f"{script}: "), done.stderr)
            self.assertTrue(all(": ignored /" in line for line in warnings), done.stderr)
        return done.code

    def test_a_file_that_was_cut_short(self):
        for part in range(16):
            with self.subTest(part=part):
                self.plant(self.whole[:len(self.whole) * part // 16])
                self.assertEqual(self.assert_plain(*SCRIPTS[part % len(SCRIPTS)]), 2)

    def test_datasets_that_are_missing_or_of_another_shape_or_kind(self):
        paths = []
        with h5py.File(self.path) as file:
            file.visititems(lambda name, item: paths.append(name) if isinstance(item, h5py.Dataset) else None)
        draw = random.Random(5)
        for number, path in enumerate(draw.sample(paths, 24)):
            script = SCRIPTS[number % len(SCRIPTS)]
            with self.subTest(path=path, script=script):
                self.plant(self.whole)
                with h5py.File(self.path, "a") as file:
                    values = file[path][()]
                    del file[path]
                    if number % 4 == 1:
                        file[path] = values.ravel()[:1]
                    elif number % 4 == 2:
                        file[path] = "text"
                    elif number % 4 == 3:
                        file.create_group(path)
                self.assert_plain(*script)


if __name__ == "__main__":
    unittest.main()
