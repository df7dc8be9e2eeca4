#!/bin/sh
# install.sh CMAKE: the installed program, jobs, analysis scripts, Python package, completion and MPI settings work
# outside the source tree.
set -eu
fail() { echo "FAILED: $*"; exit 1; }
"$1" --install "$BUILD_DIR" --prefix "$PWD/a prefix" >install.log || { cat install.log; exit 1; }
prefix="$PWD/a prefix"
share="$prefix/share/rodsweep"
mkdir elsewhere
cd elsewhere
"../a prefix/bin/rodsweep" validate --later "$share"/jobs/*.json "$share"/jobs/*/*.json
"../a prefix/bin/rodsweep" run "$share/jobs/smoke.json" -o smoke.h5 | tee run.txt
sh -c "$(sed -n 's/^next: //p' run.txt)" | tee summary.txt
[ -s summary.txt ]

bin="$prefix/bin"
for script in "$share"/analysis/*.py; do
  name=$(basename "$script" .py | tr _ -)
  [ -x "$bin/rodsweep-$name" ] && [ "$(realpath "$bin/rodsweep-$name")" = "$(realpath "$script")" ] ||
    fail "$bin/rodsweep-$name does not lead to $script"
done
"$bin/rodsweep-summary" smoke.h5 | cmp - summary.txt
"$bin/rodsweep-summary" --help | grep -q '^  rodsweep-summary results/demo.h5'
PYTHONPATH="$share/analysis" /usr/bin/python3 -c 'import rodsweep; print(rodsweep.open("smoke.h5"))' | grep 'tasks ok, none failed'
found=$(env -u RODSWEEP PYTHONPATH="$share/analysis" /usr/bin/python3 -c 'from rodsweep import program; print(program.path())')
[ "$found" -ef "$bin/rodsweep" ] || fail "rodsweep.Job runs $found"
"$bin/rodsweep-report" smoke.h5    # the page's style, scripts and libraries are installed
grep -q 'Observable Plot' smoke.html
"$share/mpi-env.sh" "$MPIRUN" -n 2 "../a prefix/bin/rodsweep" --version

bash -c 'source "$1"; COMP_WORDS=("$2" mer); COMP_CWORD=1; _rodsweep; [ "${COMPREPLY[*]}" = merge ]' \
  - "$prefix/share/bash-completion/completions/rodsweep" "$prefix/bin/rodsweep" || fail "bash completes nothing"
