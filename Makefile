# rodsweep: each target does its own set-up, including packages. `make help` lists the targets.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.NOTPARALLEL:
MAKEFLAGS += --no-print-directory

CORES    := $(shell nproc)
BUILD    ?= build
PREFIX   ?= /usr/local
PYTHON   := /usr/bin/python3
BUILD_TYPE    ?=
PORTABLE      ?= 0
CHECKS        ?= 0
SKIP_PACKAGES ?= 0
FUZZ_SECONDS  ?= 600

yes = $(filter-out 0 no off,$(1))
packages = $(if $(call yes,$(SKIP_PACKAGES)),true,cmake/packages.sh packages.txt $(1))
# $(call configure,PRESET,FOLDER): by CMakePresets.json, quiet unless it fails. An existing folder keeps its generator.
configure = generator=$$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' $(2)/CMakeCache.txt 2>/dev/null) || true; \
  log=$$(cmake --preset $(1) -B $(2) $${generator:+"-G$$generator"} $(if $(BUILD_TYPE),-DCMAKE_BUILD_TYPE=$(BUILD_TYPE)) \
  $(if $(call yes,$(PORTABLE)),-DRODSWEEP_NATIVE=OFF) $(if $(call yes,$(CHECKS)),-DRODSWEEP_CHECKS=ON) 2>&1) \
  || { echo "$$log"; exit 1; }
# $(call job,NAME): the file of a job. The shell searches for it, since NAME may be a shell variable.
job = $$(ls jobs/$(1).json jobs/*/$(1).json 2>/dev/null)
# $(call study,NAME): runs a job; continues it if it was stopped, does nothing if it is done.
study = [ -e results/$(1).h5 ] && resume=--resume || resume=; \
  cmake/mpi-env.sh mpirun -n $$(($(CORES) + 1)) $(BUILD)/rodsweep run $(call job,$(1)) -o results/$(1).h5 $$resume </dev/null || [ $$? = 3 ]
studies = bending_data helix_data spatial_bending spatial_helix temporal_bending temporal_helix side_by_side \
  long_term_learned learned_rods learned_rods_length learned_rods_closed \
  generalisation_stiffness generalisation_length generalisation_step \
  tree_wind collision_falling knot integrators balance balance_scenes \
  lattice_swing lattice_preconditioners lattice_closed net_gusts net_closed
score_scenes = bending_rod helix tree forest net lattice falling_rods knot
sources = $$(find solver network runner tests -name '*.[ch]pp')

.PHONY: help configure build demo report score studies archive benchmark-data variants ablation pictures test test-long test-cluster test-arm bench sanitize fuzz schema pages docs format format-check tidy install uninstall clean

help:
	@echo 'make demo          build, run the demo sweep (a few minutes; continued if it was stopped), write results/report.html'
	@echo 'make report        results/report.html again: what the demo found, and the studies that were run, as a page to read'
	@echo 'make score         the cheapest way to an error of the motion, with and without guesses, by scene (two hours; likewise)'
	@echo 'make studies       run the studies of jobs/, draw analysis/results (two hours; continued if it was stopped)'
	@echo 'make archive       results of make score and make studies, models and tables, with checksums: results/archive.tar'
	@echo 'make benchmark-data   linear systems for those who try guesses elsewhere, results/benchmark (ten minutes)'
	@echo 'make variants      train what rods.h5 and lattices.h5 could have been, draw how they were chosen (an hour; likewise)'
	@echo 'make ablation      train some forty variants of the network of the paper on each scene, try and draw them (an hour; likewise)'
	@echo 'make pictures      run the jobs to look at (pictures, lattice_*, net_wind, curves), draw their films (installs ffmpeg, for MP4)'
	@echo 'make test          build, run the tests'
	@echo 'make test-long     the slow tests: physics, faults, the report in a browser; unit tests under the sanitizers'
	@echo 'make test-cluster  sweeps under a real Slurm and over hosts that die or are cut off, on this machine (as root, some minutes)'
	@echo 'make test-arm      tests of the solver, but for CG, and the networks for 64-bit ARM, run in qemu, in $(BUILD)-arm/'
	@echo 'make bench         build and run the benchmarks'
	@echo 'make install       PREFIX=$(PREFIX): program, jobs, analysis scripts, completion in bash; make uninstall'
	@echo 'make build         build only, into $(BUILD)/'
	@echo 'make sanitize      unit tests under the address and undefined-behaviour sanitizers, in $(BUILD)-sanitize/'
	@echo 'make fuzz          look for jobs that crash their reader, FUZZ_SECONDS=$(FUZZ_SECONDS) (tests/fuzz/README.md)'
	@echo 'make schema        refresh jobs/schema.json and docs/keys.md after a change of the keys of jobs'
	@echo 'make pages         write the pages with measured numbers (*.md.j2) anew'
	@echo 'make docs          the same, and all pages as a site, $(BUILD)/site/index.html'
	@echo 'make format        clang-format the tree; make format-check only looks'
	@echo 'make tidy          clang-tidy'
	@echo 'make clean         remove $(BUILD)/ and those beside it (-sanitize/, -tidy/, ...); results stay'
	@echo
	@echo 'PORTABLE=1 builds for any processor of this kind, SKIP_PACKAGES=1 leaves apt-get alone; CHECKS=1: warnings are errors,'
	@echo 'and the standard library checks its preconditions, as in .ci/run.'

configure:
	@$(call packages,build run)
	@$(call configure,default,$(BUILD))

build: configure
	@cmake --build $(BUILD) -j $(CORES) --target rodsweep

# The page of the demo and of the studies that exist; prints its path. Data sets have nothing to compare.
write_report = files=; for study in demo $(filter-out %_data,$(studies)) pictures; do \
  [ ! -e results/$$study.h5 ] || files+=" results/$$study.h5"; done; \
  $(PYTHON) analysis/report.py $$files --skip --title 'What the sweeps found' -o results/report.html --force

# One worker per core; the master sleeps, so it shares a core. Exit code 3: some tasks failed, the report is of the rest.
demo: build
	@mkdir -p results; resume=; [ ! -e results/demo.h5 ] || resume=--resume; \
	code=0; cmake/mpi-env.sh mpirun -n $$(($(CORES) + 1)) $(BUILD)/rodsweep run jobs/demo.json -o results/demo.h5 $$resume </dev/null || code=$$?; \
	[ $$code = 0 ] || [ $$code = 3 ] || { echo "The demo stopped early; 'make demo' continues it."; exit $$code; }; \
	$(write_report); exit $$code

ifeq ($(wildcard results/demo.h5),)
report: demo
else
report:
	@$(call packages,build)
	@$(write_report)
endif

# Tuning draws choose settings, test draws measure them. Its times need a machine that does nothing else.
score: build
	@mkdir -p results/score; for scene in $(score_scenes); do \
	  $(BUILD)/rodsweep run jobs/score/$${scene}_tuning.json -n $(CORES) -o results/score/$${scene}_tuning.h5 --resume </dev/null || [ $$? = 3 ] || exit; \
	  $(PYTHON) analysis/score.py --jobs results/score/$${scene}_tuning.h5; \
	  $(BUILD)/rodsweep run results/score/$${scene}_test.json -n $(CORES) -o results/score/$${scene}_test.h5 --resume </dev/null || [ $$? = 3 ] || exit; \
	done; analysis/results/draw.sh results score

# Draws everything in analysis/results except its README.
studies: build
	@mkdir -p results; for study in $(studies); do \
	  $(call study,$$study); \
	done
	@analysis/results/draw.sh results

# What the tables were made of, as one file to upload. Stops if a study has not been run.
archive:
	@set -e; files="$(studies:%=results/%.h5) $(foreach scene,$(score_scenes),results/score/$(scene)_tuning.h5 results/score/$(scene)_test.h5) \
	  CITATION.cff LICENSE jobs network/pretrained analysis/results"; \
	ls -d $$files >/dev/null || { echo "Run 'make score' and 'make studies' first."; exit 1; }; \
	find $$files -type f -print0 | sort -z | xargs -0 sha256sum >results/SHA256SUMS; \
	tar --create --file results/archive.tar --transform 's,^,rodsweep-$(shell git rev-parse --short HEAD)/,' results/SHA256SUMS $$files; \
	ls -lh results/archive.tar

# Systems to try guesses and preconditioners on outside of rodsweep, 350 MB, with reference counts of iterations.
benchmark-data: build
	@mkdir -p results; $(call study,benchmark)
	@PATH="$$PWD/$(BUILD):$$PATH" $(PYTHON) analysis/benchmark_data.py results/benchmark.h5 -o results/benchmark

# Variants of rods.h5 and lattices.h5 with one setting changed each: their validation results and their costs.
variants: build
	@mkdir -p results; $(call study,rods_data); $(call study,lattices_data)
	@for family in rods lattices; do analysis/results/variants.py $(BUILD)/rodsweep results $$family; done
	@$(call study,rods_front); $(call study,lattices_front)
	@analysis/results/draw.sh results variants

# The effect of each setting on the network of the paper.
ablation: build
	@mkdir -p results; for data in bending_data bending_data_100 helix_data helix_data_100; do $(call study,$$data); done
	@for scene in bending helix; do analysis/results/variants.py $(BUILD)/rodsweep results ablation_$$scene; \
	  for study in ablation_$$scene ablation_$${scene}_step; do $(call study,$$study); done; done; $(call study,ablation_long_term)
	@analysis/results/draw.sh results ablation

# By job and task. A film of the forest would take as long as all of these. Existing films are kept.
picture_jobs = pictures side_by_side lattice_sag lattice_dropped lattice_pressed net_wind twisted pulled
pictures = pictures:0:helix:along pictures:1:net:rod pictures:2:ring:along pictures:3:tree:radius \
  pictures:4:falling:rod pictures:5:knot:along pictures:6:drape:rod side_by_side:0:side_by_side:rod \
  lattice_sag:0:lattice:along lattice_dropped:0:dropped:along lattice_pressed:0:pressed:along net_wind:0:wind:along twisted:0:twisted:along pulled:0:pulled:along
pictures: build
	@$(call packages,pictures)
	@mkdir -p results/figures; for job in $(picture_jobs); do [ -e results/$$job.h5 ] && resume=--resume || resume=; \
	  $(BUILD)/rodsweep run $(call job,$$job) -o results/$$job.h5 $$resume </dev/null; \
	done
	@for picture in $(pictures); do IFS=: read job task name colour <<<$$picture; \
	  for film in mp4 'gif --every 2 --rate 12'; do path=results/figures/$$name.$${film%% *}; \
	    [ -e $$path ] || $(PYTHON) analysis/render.py results/$$job.h5 --task $$task --movie $$film --size 480x360 \
	      --colour $$colour $$([ $$name != tree ] || echo --fine) \
	      $$([ $$name != side_by_side ] || echo --beside 2 3 4 --apart 0,0,0.7) -o $$path; \
	  done; \
	done

# Three tests per two cores, since tests under mpirun mostly wait.
test: configure
	@cmake --build $(BUILD) -j $(CORES)
	@ctest --preset default --test-dir $(BUILD) -j $$((3 * $(CORES) / 2))

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
	@docs/tools/keys.py --update

# Writes README.md, docs/claims.md and others from the templates beside them and the tables of analysis/results.
pages:
	@docs/tools/pages.py

docs: pages
	@$(call packages,docs)
	@docs/tools/site.py $(BUILD)/site

format:
	@$(call packages,format)
	@clang-format -i $(sources)

format-check:
	@$(call packages,format)
	@clang-format --dry-run -Werror $(sources) && echo 'format: clean'

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
	@for folder in $(BUILD) $(BUILD)-{sanitize,fuzz,tidy,arm,portable,develop,debug}; do [ ! -e $$folder/CMakeCache.txt ] || rm -rf $$folder; done
