#!/usr/bin/python3
"""The recipes for other machines agree with CMakeLists.txt and packages.txt: names, versions, options, files."""

import ast
import json
import os
import re
import shutil
import subprocess
import tomllib
import unittest

import yaml

SOURCE_DIR = os.environ["SOURCE_DIR"]
RECIPES = "cmake/recipes"
PACKAGE = f"{RECIPES}/spack_repo/rodsweep/packages/rodsweep/package.py"

# Names in CMake, Spack, conda-forge and Debian.
LIBRARIES = [("MPI", "mpi", "openmpi", "libopenmpi-dev"), ("HDF5", "hdf5", "hdf5", "libhdf5-openmpi-dev"),
             ("PETSC", "petsc", "petsc", "libpetsc-real-dev"), ("METIS_LIBRARY", "metis", "metis", "libmetis-dev"),
             ("Eigen3", "eigen", "eigen", "libeigen3-dev"), ("nanoflann", "nanoflann", "nanoflann", "libnanoflann-dev"),
             ("nlohmann_json", "nlohmann-json", "nlohmann_json", "nlohmann-json3-dev"),
             ("CLI11", "cli11", "cli11", "libcli11-dev"), ("fmt", "fmt", "fmt", "libfmt-dev"),
             ("Catch2", "catch2", "catch2", "catch2"), ("PkgConfig", "pkgconfig", "pkg-config", "pkg-config"),
             ("pybind11", "py-pybind11", "pybind11", "pybind11-dev")]
TOOLCHAIN = {"OpenMP", "benchmark"}  # of the compiler; a variant in Spack only


def text_of(path):
    with open(os.path.join(SOURCE_DIR, path), encoding="utf-8") as file:
        return file.read()


def debian_packages(*groups):
    rows = [line.split() for line in text_of("packages.txt").splitlines() if line and not line.startswith("#")]
    return [package for group, package in rows if not groups or group in groups]


class Libraries(unittest.TestCase):
    def setUp(self):
        cmake = text_of("CMakeLists.txt") + text_of("tests/CMakeLists.txt")
        self.cmake = {name: version for name, version in
                      re.findall(r"(?:find_package|pkg_check_modules|find_library)\((\w+)(?: ([\d.]+))?", cmake)}
        self.cmake["cmake"] = re.search(r"cmake_minimum_required\(VERSION ([\d.]+)", cmake)[1]
        calls = [node for node in ast.walk(ast.parse(text_of(PACKAGE))) if isinstance(node, ast.Call)]
        specs = [call.args[0].value for call in calls if getattr(call.func, "id", None) == "depends_on"]
        self.spack = {re.split("[@+~]", spec)[0]: spec for spec in specs}
        self.conda = {re.split("[<>=]", spec)[0]: spec for spec in
                      yaml.safe_load(text_of(f"{RECIPES}/environment.yml"))["dependencies"]}

    def test_every_recipe_has_what_cmake_looks_for(self):
        self.assertEqual({row[0] for row in LIBRARIES} | TOOLCHAIN | {"cmake"}, self.cmake.keys())
        for _, spack, conda, debian in LIBRARIES:
            with self.subTest(library=spack):
                self.assertIn(spack, self.spack)
                self.assertIn(conda, self.conda)
                self.assertIn(debian, debian_packages("build"))

    def test_versions_begin_where_cmake_lets_them(self):
        for name, spack, conda in [(row[0], row[1], row[2]) for row in LIBRARIES] + [("cmake", "cmake", "cmake")]:
            version = self.cmake[name]
            with self.subTest(library=spack, version=version):
                if version:
                    self.assertRegex(self.spack[spack], f"@{version}[.:]")
                    self.assertRegex(self.conda[conda], f">?={version}($|,)")

    def test_headers_without_a_package_file(self):
        self.assertIn("boost", self.spack)
        self.assertIn("libboost-headers", self.conda)

    def test_python_packages_of_the_scripts(self):
        for debian in debian_packages("run"):
            name = {"python3-pil": "pillow"}.get(debian, debian.removeprefix("python3-"))
            if debian.startswith("python3-"):
                self.assertIn(f"py-{name}", self.spack)
                self.assertTrue({name, f"{name}-base"} & self.conda.keys(), name)

    def test_python_is_the_one_that_the_scripts_want(self):
        lowest = tomllib.loads(text_of("analysis/pyproject.toml"))["project"]["requires-python"].removeprefix(">=")
        self.assertEqual(self.spack["python"], f"python@{lowest}:")
        self.assertEqual(self.conda["python"], f"python>={lowest}")
        self.assertIn(f"Python {lowest},", text_of("docs/python.md"))

    def test_headers_have_the_lines_of_the_page(self):
        page = text_of("docs/installing.md").splitlines()
        for recipe in (f"{RECIPES}/environment.yml", PACKAGE):
            lines = re.findall(r"^#   (\S.*)", text_of(recipe), re.M)
            self.assertGreaterEqual(len(lines), 2, recipe)
            for line in lines:
                self.assertIn(line, [shown.partition("  #")[0].rstrip() for shown in page])

    def test_mpi_is_one(self):
        variants = [spec for spec in self.conda.values() if "mpi_" in spec]
        self.assertEqual(len(variants), 2)
        for spec in variants:
            self.assertTrue(spec.endswith("=*=mpi_openmpi*"), spec)

    def test_options_are_those_of_cmake(self):
        options = set(re.findall(r"^option\((\w+)", text_of("CMakeLists.txt"), re.M))
        presets = json.loads(text_of("CMakePresets.json"))["configurePresets"]
        named = {name for preset in presets for name in preset["cacheVariables"]}
        named |= set(re.findall(r'"(RODSWEEP_\w+)"', text_of(PACKAGE)))
        self.assertLessEqual({name for name in named if name.startswith("RODSWEEP_")}, options)


class Images(unittest.TestCase):
    def test_the_shell_reads_the_script(self):
        subprocess.run(["sh", "-n", f"{SOURCE_DIR}/{RECIPES}/debian.sh"], check=True)

    def test_both_recipes_take_all_steps_and_files_that_exist(self):
        steps = re.findall(r"^(\w+)\)$", text_of(f"{RECIPES}/debian.sh"), re.M)
        self.assertEqual(steps, ["packages", "build", "runtime"])
        for recipe in ("Dockerfile", "rodsweep.def"):
            with self.subTest(recipe=recipe):
                self.assertEqual(re.findall(r"(?:RUN|^ ) .*debian\.sh (\w+)", text_of(f"{RECIPES}/{recipe}"), re.M), steps)
                self.assertEqual(set(re.findall(r"debian:\S+", text_of(f"{RECIPES}/{recipe}"))), {"debian:12-slim"})
        for path in re.findall(r"^COPY (?!--from)(.+) \S+$", text_of(f"{RECIPES}/Dockerfile"), re.M):
            self.assertTrue(os.path.exists(os.path.join(SOURCE_DIR, path)), path)

    @unittest.skipUnless(shutil.which("apt-cache"), "apt-cache is not installed")
    def test_debian_has_the_packages(self):
        named = set(debian_packages())
        said = subprocess.run(["apt-cache", "pkgnames"], capture_output=True, text=True, check=True).stdout.split()
        if "libpetsc-real-dev" not in said:
            self.skipTest("no list of packages here: apt-get update")
        self.assertLessEqual(named, set(said))


class Release(unittest.TestCase):
    def test_the_version_is_one(self):
        """In CMakeLists.txt, the Python package, the citation and the changelog, of which the last two have its date."""
        version = re.search(r"project\(rodsweep VERSION ([\d.]+)", text_of("CMakeLists.txt"))[1]
        self.assertIn(f'__version__ = "{version}"', text_of("analysis/rodsweep/__init__.py"))
        citation = yaml.safe_load(text_of("CITATION.cff"))
        last = re.search(r"^## \[(.+)\] - (.+)$", text_of("CHANGELOG.md"), re.M)
        self.assertEqual((citation["version"], str(citation.get("date-released", "unreleased"))), (version, last[2]))
        self.assertEqual(last[1], version)

    def test_the_citation_keeps_to_the_rules_of_its_format(self):
        """Schema 1.2.0: required keys, persons and entities, types, form of a DOI."""
        citation = yaml.safe_load(text_of("CITATION.cff"))
        self.assertEqual(citation["cff-version"], "1.2.0")
        self.assertLessEqual({"message", "title", "authors"}, citation.keys())
        self.assertIn(citation["type"], ("software", "dataset"))
        for work in citation["references"]:
            self.assertLessEqual({"type", "title", "authors"}, work.keys())
            self.assertIn(work["type"], ("article", "conference-paper"))
            self.assertRegex(work.get("doi", "10.1/x"), r"^10\.\d+(\.\d+)?/[A-Za-z0-9:/_;\-.()\[\]\\]+$")
            for author in work["authors"]:
                self.assertEqual(author.keys(), {"given-names", "family-names"})


if __name__ == "__main__":
    unittest.main()
