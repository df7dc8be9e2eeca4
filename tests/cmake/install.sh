#!/bin/sh
# install.sh CMAKE: the installed program, jobs, analysis scripts and Python package work away from the source tree.
set -eu
"$1" --install "$BUILD_DIR" --prefix "$PWD/a prefix" >install.log || { cat install.log; exit 1; }
share="$PWD/a prefix/share/rodsweep"
mkdir elsewhere
cd elsewhere
"../a prefix/bin/rodsweep" validate "$share"/jobs/*.json
"../a prefix/bin/rodsweep" run "$share/jobs/smoke.json" -o smoke.h5 | tee run.txt
sh -c "$(sed -n 's/^next: //p' run.txt)" | tee summary.txt
[ -s summary.txt ]

bin="$PWD/../a prefix/bin"
for script in "$share"/analysis/*.py; do
  name=$(basename "$script" .py | tr _ -)
  [ -x "$bin/rodsweep-$name" ] && [ "$(realpath "$bin/rodsweep-$name")" = "$(realpath "$script")" ] ||
    { echo "FAILED: $bin/rodsweep-$name does not lead to $script"; exit 1; }
done
"$bin/rodsweep-summary" smoke.h5 | cmp - summary.txt
"$bin/rodsweep-summary" --help | grep -q '^  rodsweep-summary results/demo.h5'
PYTHONPATH="$share/analysis" /usr/bin/python3 -c 'import rodsweep; print(rodsweep.open("smoke.h5"))' | grep 'tasks ok, none failed'
"$bin/rodsweep-report" smoke.h5    # style, scripts and libraries of the page were installed too
grep -q 'Observable Plot' smoke.html
