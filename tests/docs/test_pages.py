"""Pages of the repository: valid links, tables and lists; all pages are in the navigation; docs/keys.md is complete."""

import glob
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
TOOLS = os.path.join(ROOT, "docs", "tools")
sys.path.insert(0, TOOLS)
import keys  # noqa: E402
import links  # noqa: E402

NAV = "site_name: x\nnav:\n  - Start: README.md\n  - More:\n      - A page: docs/page.md\nextra: {}\n"
PAGE = """# A page of `two_words`, once … more
See [up](../README.md#what-it-is), [here](#a-page-of-two_words-once--more), ![a picture](a.png), [far](https://x.org/no).

- `[not](a link)`

```
[nor](this.md)
```
"""


class Links(unittest.TestCase):
    def check(self, page=PAGE, readme="# x\n## What it is\n[page](docs/page.md)\n", nav=NAV):
        with tempfile.TemporaryDirectory() as root:
            os.mkdir(os.path.join(root, "docs"))
            for path, text in (("docs/page.md", page), ("README.md", readme), ("mkdocs.yml", nav), ("docs/a.png", "")):
                with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                    file.write(text)
            return links.check(root)

    def test_what_leads_somewhere_is_passed(self):
        self.assertEqual(self.check(), [])

    def test_what_leads_nowhere_is_named_with_its_line(self):
        for change, words in ((("a.png", "b.png"), "docs/page.md:2: b.png: there is no docs/b.png"),
                              (("#what-it-is", "#what-it-was"), "README.md has no heading #what-it-was"),
                              (("#a-page", "#page"), "docs/page.md has no heading #page-of-two_words-once--more"),
                              (("../README", "README"), "there is no docs/README.md"),
                              (("![a picture](a.png)", "[a\n  picture](b.png)"), "docs/page.md:3: b.png: there is no")):
            wrong = self.check(PAGE.replace(*change))
            self.assertEqual(len(wrong), 1, wrong)
            self.assertIn(words, wrong[0])

    def test_pages_and_navigation_agree(self):
        wrong = self.check(nav=NAV.replace("page.md", "p.md"))
        self.assertEqual(wrong, ["mkdocs.yml: docs/page.md is in the navigation 0 times",
                                 "mkdocs.yml: there is no docs/p.md"])

    def test_rows_have_the_cells_of_their_head(self):
        table = "\n| a | b |\n|---|---|\n| `|y|` | 2 |\n"
        self.assertIn("docs/page.md:12: 4 cells, but the table's head has 2", self.check(PAGE + table)[0])
        self.assertEqual(self.check(PAGE + table.replace("|y|", "\\|y\\|")), [])

    def test_a_list_right_behind_a_paragraph_is_no_list_everywhere(self):
        self.assertIn("docs/page.md:10: a list begins", self.check(PAGE + "Words:\n- one\n- two\n")[0])
        self.assertEqual(self.check(PAGE + "Words:\n\n- one\n  more\n- two\n"), [])

    def test_sentences_and_paragraphs_have_a_longest_length(self):
        self.assertEqual(self.check(PAGE + "\n" + "word " * 60 + "end. " + "[page](page.md) " * 60 + "\n"),
                         ["docs/page.md:10: a sentence of 61 words; at most 60"])
        self.assertEqual(self.check(PAGE + "\n" + "A sentence. " * 75 + "\n\n- " + "Another. " * 99 + "\n"), [])
        self.assertIn("docs/page.md:10: a paragraph of 911 characters", self.check(PAGE + "\n" + "A sentence. " * 76 + "\n")[0])

    def test_this_repository(self):
        self.assertEqual(links.check(ROOT), [])


class Keys(unittest.TestCase):
    def test_the_page_is_current(self):
        command = [sys.executable, os.path.join(TOOLS, "keys.py")]
        said = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual((said.returncode, said.stdout), (0, "docs/keys.md is current\n"))

    def test_every_key_of_the_schema_has_a_row(self):
        text = keys.read(keys.SCHEMA)
        page, found = keys.page(text), set()

        def walk(node):
            if isinstance(node, dict):
                found.update(node.get("properties", {}) if "additionalProperties" in node else ())
                for child in node.values():
                    walk(child)
            elif isinstance(node, list):
                for child in node:
                    walk(child)

        walk(json.loads(text))
        self.assertGreater(len(found), 140)
        for name in found - keys.SWEEPS - {"label"}:
            self.assertTrue(f"| `{name}` |" in page or f"{{\"{name}\": {{...}}}}" in page, name)

    def test_what_the_page_says_may_be_swept_may_and_nothing_else(self):
        schema = keys.Schema(json.loads(keys.read(keys.SCHEMA)))

        def is_swept(node):
            while "$ref" in node or "allOf" in node:
                node = schema.definitions[node["$ref"].rpartition("/")[2]] if "$ref" in node else node["allOf"][0]
            return any(keys.is_sweep(way) for way in node.get("anyOf", ()))

        def fixed(node):
            return {name for name, child in node["properties"].items() if not is_swept(child)}

        self.assertEqual(fixed(schema.named("scene")), {"type"})
        for name in ("time", "solve", *(f"scene.obstacles.item.{kind}" for kind in ("half_space", "ball", "capsule"))):
            self.assertEqual(fixed(schema.named(name)), set(), name)
        top = schema.all["properties"]
        self.assertEqual(set(top) - fixed({"properties": top}), {"evaluation", "scene", "start", "time", "solve"})
        for name in ("record", "network", "training"):
            self.assertEqual(fixed(top[name]), set(top[name]["properties"]), name)

    def test_a_row_has_type_bounds_unit_default_meaning_and_place(self):
        schema = {"definitions": {}, "properties": {}, "allOf": [
            {"if": {"properties": {"type": {"const": word}}}, "then": then} for word, then in (
                ("rod", {"required": ["n"], "properties": {"soft": {"default": False}}}),
                ("net", {"properties": {"n": False}}), ("ring", {"required": ["n"]}))]}
        node = {**schema, "properties": {
            "n": {"type": "integer", "minimum": 1, "maximum": 1000000, "description": "how many"},
            "wide_m": {"type": "number", "exclusiveMinimum": 0, "default": 0.5, "description": "width [m]"},
            "soft": {"type": "boolean", "default": True, "description": "gives way"}}}
        self.assertEqual(keys.table(keys.Schema(schema), node)[1], [
            ["`n`", "whole number, ≥ 1, ≤ 1e6", "", "*required*", "how many", "not `net`"],
            ["`wide_m`", "number, > 0", "m", "`0.5`", "width", ""],
            ["`soft`", "`true`, `false`", "", "`true`, `false` of `rod`", "gives way", ""]])


class Extending(unittest.TestCase):
    def test_the_files_that_it_names_exist(self):
        text = keys.read(os.path.join(ROOT, "docs", "extending.md")) + keys.read(os.path.join(ROOT, "ARCHITECTURE.md"))
        paths = set(re.findall(r"[`(](?:\.\./)?((?:solver|network|runner|analysis|tests|jobs)/[\w/]+\.\w+)[`)]", text))
        self.assertGreater(len(paths), 20)
        self.assertEqual({path for path in paths if "NAME" not in path and not os.path.exists(os.path.join(ROOT, path))}, set())


class Environment(unittest.TestCase):
    def test_every_variable_that_is_read_has_a_row(self):
        table = keys.read(os.path.join(ROOT, "docs", "running.md")).partition("## Environment")[2]
        told = set(re.findall(r"`(\w+)`", "".join(row.split("|")[1] for row in re.findall(r"^\|.*\|$", table, re.M))))
        sources = [os.path.join(folder, name) for layer in ("runner", "network", "solver")
                   for folder, _, names in os.walk(os.path.join(ROOT, layer)) for name in names if name.endswith("pp")]
        asked = {name for path in sources for name in re.findall(r'getenv\("(\w+)"\)', keys.read(path))}
        asked |= set(re.findall(r"\$\{(RODSWEEP\w*)", keys.read(os.path.join(ROOT, "jobs", "slurm", "sweep.sbatch"))))
        self.assertGreater(len(asked), 5)
        self.assertEqual(asked - told, set())


class Jobs(unittest.TestCase):
    NO_KEYS = {"points", "radius", "from_stretch"}    # keys of files of curves, a word

    def test_keys_in_texts_and_in_the_plugins_header_exist(self):
        names, header = set(), os.path.join("solver", "plugin", "plugin.h")

        def walk(node):
            if isinstance(node, (dict, list)):
                names.update(node.get("properties", ()) if isinstance(node, dict) else ())
                for child in node.values() if isinstance(node, dict) else node:
                    walk(child)

        walk(json.loads(keys.read(keys.SCHEMA)))
        for page in (*links.pages(ROOT), header):
            text = re.sub(r"^```.*?^```", "", keys.read(os.path.join(ROOT, page)), flags=re.S | re.M)
            said = set(re.findall(r'"(\w+)":', text))
            self.assertEqual(said - names - self.NO_KEYS, set(), page)
            self.assertTrue(page != header or said)

    def test_every_job_says_what_it_is_for(self):
        for path in glob.glob(os.path.join(ROOT, "jobs", "**", "*.json"), recursive=True):
            if os.path.basename(path) != "schema.json":
                self.assertGreater(len(json.loads(keys.read(path)).get("description", "")), 20, path)
