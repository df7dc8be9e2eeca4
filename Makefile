# rodsweep: each target does its own set-up, including packages. `make help` lists the targets.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.NOTPARALLEL:
MAKEFLAGS += --no-print-directory

CORES    := $(shell nproc)
BUILD    ?= build
PREFIX   ?= /usr/local
RESULTS  ?= results
BUILD_TYPE    ?=
PORTABLE      ?= 0
CHECKS        ?= 0
SKIP_PACKAGES ?= 0
FUZZ_SECONDS  ?= 600
SUITE         ?= trixie

yes = $(filter-out 0 no off,$(1))
packages = $(if $(call yes,$(SKIP_PACKAGES)),true,cmake/packages.sh packages.txt $(1))
# $(call configure,PRESET,FOLDER): by CMakePresets.json, quiet unless it fails. An existing folder keeps its generator.
configure = generator=$$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' $(2)/CMakeCache.txt 2>/dev/null) || true; \
  log=$$(cmake --preset $(1) -B $(2) $${generator:+"-G$$generator"} $(if $(BUILD_TYPE),-DCMAKE_BUILD_TYPE=$(BUILD_TYPE)) \
  $(if $(call yes,$(PORTABLE)),-DRODSWEEP_NATIVE=OFF) $(if $(call yes,$(CHECKS)),-DRODSWEEP_CHECKS=ON) 2>&1) \
  || { echo "$$log"; exit 1; }
sources = $$(find solver network runner tests -name '*.[ch]pp')

.PHONY: help configure build demo test test-long test-cluster test-debian test-arm bench sanitize fuzz schema docs format format-check tidy install uninstall clean

help:
	@echo 'make demo          build, run the demo sweep (half a minute; continued if it was stopped), write $(RESULTS)/report.html'
	@echo 'jobs/studies.py    the studies: a list; jobs/studies.py NAME... runs them'
	@echo 'make test          build, run the tests'
	@echo 'make test-long     the slow tests: physics, faults, the report in a browser; unit tests under the sanitizers'
	@echo 'make test-cluster  sweeps under a real Slurm and over hosts that die or are cut off, on this machine (as root, some minutes)'
	@echo 'make test-debian   SUITE=$(SUITE): make demo and make test in a clean clone on another Debian, in a chroot in $(BUILD)-debian/ (as root)'
	@echo 'make test-arm      tests of the solver, but for CG, and the networks for 64-bit ARM, run in qemu, in $(BUILD)-arm/'
	@echo 'make bench         build and run the benchmarks'
	@echo 'make install       PREFIX=$(PREFIX): program, jobs, analysis scripts, completion in bash; make uninstall'
	@echo 'make build         build only, into $(BUILD)/'
	@echo 'make sanitize      unit tests under the address and undefined-behaviour sanitizers, in $(BUILD)-sanitize/'
	@echo 'make fuzz          look for jobs that crash their reader, FUZZ_SECONDS=$(FUZZ_SECONDS) (tests/fuzz/README.md)'
	@echo 'make schema        refresh jobs/schema.json, docs/keys.md and constants of the Python package after a change of keys or planned columns'
	@echo 'make docs          write the pages with measured numbers (*.md.j2) anew, and all pages as a site, $(BUILD)/site/index.html'
	@echo 'make format        clang-format the tree; make format-check only looks, and checks the Python with flake8'
	@echo 'make tidy          clang-tidy'
	@echo 'make clean         remove $(BUILD)/ and those beside it (-sanitize/, -tidy/, ...); results stay'
	@echo
	@echo 'PORTABLE=1 builds for any processor of this kind, SKIP_PACKAGES=1 leaves apt-get alone; CHECKS=1: warnings are errors,'
	@echo 'and the standard library checks its preconditions, as in .ci/run.'

configure:
	@$(call packages,build run)
	@command -v cmake >/dev/null || { echo 'rodsweep: there is no cmake in the PATH; packages.txt names what is needed' >&2; exit 1; }
	@$(call configure,default,$(BUILD))

build: configure
	@cmake --build $(BUILD) -j $(CORES) --target rodsweep

demo: build
	@jobs/studies.py --build $(BUILD) --results $(RESULTS) demo report

# Seconds and names of the ten slowest tests.
slowest = echo 'slowest tests, s:'; awk '/^[0-9]+\/[0-9]+ Testing: / { name = $$3 } /^Test time = / { print $$4, name }' \
  $(BUILD)/Testing/Temporary/LastTest.log | sort -rn | sed -n '1,10s/^/  /p'

# Three tests per two cores, since tests under mpirun mostly wait.
test: configure
	@cmake --build $(BUILD) -j $(CORES)
	@code=0; ctest --preset default --test-dir $(BUILD) -j $$((3 * $(CORES) / 2)) || code=$$?; $(slowest); exit $$code

test-long: configure
	@$(call packages,long)
	@cmake --build $(BUILD) -j $(CORES)
	@ctest --preset long --test-dir $(BUILD) -j $(CORES)
	@$(MAKE) sanitize

# With its own Slurm and hosts, in namespaces that end with the test. Runs tests one by one, since they report times.
test-cluster: configure
	@$(call packages,cluster)
	@cmake --build $(BUILD) -j $(CORES) --target program_tests
	@ctest --preset cluster --test-dir $(BUILD)

# For a release: the README's commands on SUITE, in a chroot that stays in $(BUILD)-debian/ (3 GB).
test-debian: build
	@$(call packages,debian)
	@rm -f $(BUILD)/smoke.h5; $(BUILD)/rodsweep run jobs/smoke.json -o $(BUILD)/smoke.h5 >/dev/null
	@tests/debian.sh $(SUITE) $(BUILD)-debian/$(SUITE) $(BUILD)/smoke.h5

# Finds what `make test` on x86 does not: two doubles per register, other rounding, another compiler's code.
test-arm:
	@$(call packages,build arm)
	@$(call configure,arm,$(BUILD)-arm)
	@cmake --build $(BUILD)-arm -j $(CORES)
	@ctest --preset arm --test-dir $(BUILD)-arm -j $(CORES)

# Only this target builds and runs the bench programs; they are not in `all`.
bench:
	@$(call packages,build run develop)
	@$(call configure,bench,$(BUILD))
	@cmake --build $(BUILD) -j $(CORES) --target benchmarks </dev/null

sanitize:
	@$(call packages,build run)
	@$(call configure,sanitize,$(BUILD)-sanitize)
	@cmake --build $(BUILD)-sanitize -j $(CORES) --target unit_tests
	@ctest --preset sanitize --test-dir $(BUILD)-sanitize -j $(CORES)

# Uses clang, whose coverage guides the search.
fuzz: export CC = clang
fuzz: export CXX = clang++
fuzz:
	@$(call packages,build run fuzz)
	@$(call configure,sanitize,$(BUILD)-fuzz)
	@cmake --build $(BUILD)-fuzz -j $(CORES) --target fuzz_jobs
	@tests/fuzz/run.sh $(BUILD)-fuzz/tests $(FUZZ_SECONDS)

schema: build
	@$(BUILD)/rodsweep schema >$(BUILD)/schema.json && mv $(BUILD)/schema.json jobs/schema.json
	@sed -n 's/^"x-files": //p' jobs/schema.json >analysis/rodsweep/reading/constants.json
	@docs/tools/keys.py --update

# Writes README.md, docs/claims.md and others from the templates beside them and the tables of analysis/results first.
docs:
	@$(call packages,docs)
	@docs/tools/pages.py
	@docs/tools/site.py $(BUILD)/site

format:
	@$(call packages,format)
	@clang-format -i $(sources)

format-check:
	@$(call packages,format)
	@clang-format --dry-run -Werror $(sources)
	@flake8
	@echo 'format: clean'

# Has its own build folder, since clang cannot read the compiler's precompiled headers.
tidy:
	@$(call packages,build run develop)
	@$(call configure,tidy,$(BUILD)-tidy)
	@cmake --build $(BUILD)-tidy --target revision_header
	@run-clang-tidy -quiet -p $(BUILD)-tidy -j $(CORES) '^$(CURDIR)/(solver|network|runner)/.*\.cpp$$'

# `make uninstall` reads the list of installed files, which is installed with them.
installed = share/rodsweep/installed.txt
install: build
	@prefix=$$(realpath -m -- "$(PREFIX)"); cmake --install $(BUILD) --prefix "$$prefix"; \
	{ cat $(BUILD)/install_manifest.txt; echo; echo "$$prefix/$(installed)"; } >"$${DESTDIR:-}$$prefix/$(installed)"; \
	echo "Installed in $$prefix. On one machine: $$prefix/share/rodsweep/mpi-env.sh mpirun -n $$(($(CORES) + 1)) $$prefix/bin/rodsweep run JOB"

uninstall:
	@prefix=$${DESTDIR:-}$$(realpath -m -- "$(PREFIX)"); list=$$prefix/$(installed); \
	[ -e "$$list" ] || { echo "rodsweep: nothing was installed in $$prefix by this Makefile: there is no $$list" >&2; exit 1; }; \
	sed "s:^:$${DESTDIR:-}:" "$$list" | tr '\n' '\0' | xargs -0 rm -f --; \
	for folder in {share,share/doc,include,lib}/rodsweep; do [ ! -d "$$prefix/$$folder" ] || find "$$prefix/$$folder" -depth -type d -empty -delete; done; \
	echo "Uninstalled from $$prefix."

clean:
	@for folder in $(BUILD) $(BUILD)-{sanitize,fuzz,tidy,arm,portable,develop,debug}; do [ ! -e $$folder/CMakeCache.txt ] || rm -rf $$folder; done; rm -rf $(BUILD)-debian
