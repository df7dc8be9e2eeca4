"""CSV and Parquet of export.py: numbers to the last digit, nulls, units, and the same rows in either; read back by a
reader of ours and, where npm can be reached, by another."""

import csv
import io
import json
import math
import subprocess
import unittest
import unittest.mock

import synthetic
import numpy as np
from parquet_file import ParquetFile
from rodsweep.reading.tidy import Column
from rodsweep.writing import decimals, delimited, parquet
from running import Scripts

READER = "hyparquet@1.31.5"    # fetched by the test, which is skipped where it can't be
READ = """
import { readFileSync } from "fs"; import { gunzipSync } from "zlib";
import { parquetReadObjects, parquetMetadata } from "hyparquet";
const bytes = readFileSync(process.argv[2]);
const file = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
const rows = await parquetReadObjects({ file, compressors: { GZIP: (page) => gunzipSync(page) } });
const metadata = parquetMetadata(file).key_value_metadata;
console.log(JSON.stringify({ rows, metadata }, (_, value) => typeof value == "bigint" ? Number(value) : value));
"""


def numbers(dtype, count, seed):
    """Of all sizes, with few digits and with many, and those at which a text changes its form."""
    random = np.random.Generator(np.random.PCG64(seed))
    info, bits = np.finfo(dtype), random.integers(0, 2 ** 63, count, dtype=np.int64)
    largest = 37 if dtype == np.float32 else 300
    some = [10 ** random.uniform(-9, 3, count), -10 ** random.uniform(-largest, largest, count),
            np.round(random.uniform(-10, 10, count), 3), np.rint(10 ** random.uniform(0, 15, count)),
            2.0 ** np.arange(-largest * 3, largest * 3),
            [0, -0.0, np.nan, np.inf, -np.inf, 1, 10, 1e15, 1e16, 1e-4, 1e-5, 9.9999e-5, 123456.7, .1 + .2, 8e-6, 0.02],
            [info.tiny, info.max, info.smallest_subnormal, info.tiny / 3, 1 + info.eps, 1 - info.epsneg]]
    raw = bits.view(np.float64) if dtype == np.float64 else (bits >> 31).astype(np.int32).view(np.float32)
    with np.errstate(invalid="ignore"):
        return np.concatenate([np.array(part).astype(dtype) for part in some] + [raw])


class Decimals(unittest.TestCase):
    def test_the_text_of_a_number_is_the_shortest_that_gives_it_back(self):
        for dtype in (np.float64, np.float32):
            values = numbers(dtype, 20_000, 5)
            lines = np.insert(decimals.text_bytes(values), decimals.WIDTH, ord("\n"), axis=1)
            found = np.array(lines.tobytes().translate(None, b"\0").decode().split("\n")[:-1])
            np.testing.assert_array_equal(found, np.where(np.isnan(values), "", values.astype(str)))

    def test_where_no_precision_is_to_spare_it_is_the_same(self):
        values = numbers(np.float64, 50, 6)
        with unittest.mock.patch.object(decimals, "EXTENDED", False):
            slow = decimals.text_bytes(values)
        for one, other in zip(slow, decimals.text_bytes(values)):
            self.assertEqual(one[one > 0].tobytes(), other[other > 0].tobytes())


class Fields(unittest.TestCase):
    def written(self, **columns):
        """The text of a block of columns, and its fields."""
        out = io.BytesIO()
        delimited.write(out, list(columns), [{name: Column(np.array(values)) for name, values in columns.items()}])
        text = out.getvalue().decode()
        return text, list(csv.reader(io.StringIO(text, newline="")))

    def test_texts_are_quoted_where_they_must_be(self):
        texts = ["plain", "", 'say "hi", you', "two\nlines", "äöü ‖b‖", "a,b"]
        text, rows = self.written(**{"a,b": texts, "n": np.arange(6)})
        self.assertEqual(rows, [["a,b", "n"], *([text, str(k)] for k, text in enumerate(texts))])
        self.assertIn("\nplain,0\n,1\n", text)

    def test_whole_numbers_of_any_range_are_written_and_those_that_are_missing_left_out(self):
        near, far = np.array([3, -1, 0, 7], dtype=np.int16), np.array([2 ** 62, -1, -(2 ** 62), 0])
        _, rows = self.written(near=near, far=far, unsigned=np.array([255, 0, 1, 2], dtype=np.uint8))
        self.assertEqual(rows[1:], [["3", str(2 ** 62), "255"], ["", "", "0"], ["0", str(-2 ** 62), "1"],
                                    ["7", "0", "2"]])


def same(text, value):
    """Whether a field of CSV is a value of Parquet; numbers may be of single precision."""
    if value is None or isinstance(value, str):
        return text == (value or "")
    return int(text) == value if isinstance(value, int) else value in (float(text), float(np.float32(text)))


class Parquet(Scripts):
    def setUp(self):
        super().setUp()
        plant = synthetic.Plant()
        plant.reached = lambda guess, tolerance, newton, segments, draw: guess != "previous" or tolerance > 1e-3
        self.write(plant=plant, failed={3: "diverged"}, pending=(4,), counts_in_rows=True, samples=3)
        values = np.random.Generator(np.random.PCG64(2)).normal(size=18 * 2)
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["steps/joint_gap"][:] = values
            h5["steps/joint_gap"][3] = np.nan
            h5["solves/rhs_norm"] = np.random.Generator(np.random.PCG64(3)).normal(size=18 * 6)
            h5["solves/iterations"].attrs.update({"unit": np.bytes_("1"), "meaning": np.bytes_("CG iterations")})

    def both(self, *arguments):
        """The rows of the CSV, and the Parquet file, of the same choices."""
        for ending in ("csv", "parquet"):
            self.run_script("export.py", "sweep.h5", *arguments, "-o", f"out.{ending}", "--force")
        with open("out.csv", encoding="utf-8", newline="") as text:
            return list(csv.DictReader(text)), ParquetFile("out.parquet")

    def assert_same(self, rows, columns):
        self.assertEqual(list(rows[0]), list(columns))
        for name, values in columns.items():
            for row, value in zip(rows, values, strict=True):
                self.assertTrue(same(row[name], value), (name, row[name], value))

    def test_all_levels_hold_the_rows_of_the_csv(self):
        for level, count in (("tasks", 17 * 4 * 8), ("solves", 17 * 6 * 4), ("steps", 17 * 2)):
            rows, file = self.both("--level", level)
            self.assertEqual(file.groups, [count])
            self.assert_same(rows, file.columns)

    def test_row_groups_are_of_bounded_size(self):
        with unittest.mock.patch.object(parquet, "GROUP_ROWS", 50):
            rows, file = self.both("--level", "solves")
        self.assertEqual(sum(file.groups), len(rows))
        self.assertGreater(len(file.groups), 2)
        self.assert_same(rows, file.columns)

    def test_types_are_those_of_the_file_and_repetition_is_a_dictionary(self):
        _, file = self.both("--level", "solves")
        logical = {name: element.get(10) for name, element in file.schema.items()}
        self.assertEqual(logical["iterations_1e-2"], {10: {1: 16, 2: True}})
        self.assertEqual(logical["guess"], {1: {}})
        self.assertEqual((file.schema["cg_s"][1], file.schema["rhs_norm"][1]), (4, 5))
        self.assertLessEqual({"guess", "task", "scene.type", "start_matvecs"}, file.dictionaries)
        self.assertEqual({element[3] for element in file.schema.values()}, {1})

    def test_units_and_meanings_are_in_the_metadata(self):
        _, file = self.both("--level", "solves")
        self.assertEqual(file.metadata["iterations_1e-2.meaning"], "CG iterations; 1e-2")
        self.assertEqual(file.metadata["scene.youngs_modulus_pa.unit"], "Pa")

    def test_no_rows_are_a_file_too(self):
        self.run_script("export.py", "sweep.h5", "--where", "outcome=nothing", "-o", "none.parquet")
        self.assertEqual(ParquetFile("none.parquet").groups, [])

    def test_another_reader_reads_the_same(self):
        with open("package.json", "w", encoding="utf-8") as package:
            json.dump({"type": "module"}, package)
        try:
            subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--fetch-retries=0", READER], check=True,
                           capture_output=True, timeout=60, stdin=subprocess.DEVNULL)
        except (OSError, subprocess.SubprocessError) as error:
            self.skipTest(f"{READER} cannot be fetched from npm: {error}")
        with open("read.mjs", "w", encoding="utf-8") as script:
            script.write(READ)
        for level in ("tasks", "solves", "steps"):
            rows, file = self.both("--level", level)
            done = subprocess.run(["node", "read.mjs", "out.parquet"], check=True, capture_output=True, text=True)
            found = json.loads(done.stdout)
            self.assertEqual({pair["key"]: pair["value"] for pair in found["metadata"]}, file.metadata)
            for name, values in file.columns.items():
                read = [row.get(name) for row in found["rows"]]
                self.assertEqual([None if v is None or v != v or isinstance(v, float) and math.isinf(v) else v
                                  for v in values], read, name)


if __name__ == "__main__":
    unittest.main()
