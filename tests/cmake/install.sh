#!/bin/sh
# install.sh CMAKE: the installed program, job and analysis scripts work away from the source tree.
set -eu
"$1" --install "$BUILD_DIR" --prefix "$PWD/a prefix" >install.log || { cat install.log; exit 1; }
share="$PWD/a prefix/share/rodsweep"
mkdir elsewhere
cd elsewhere
"../a prefix/bin/rodsweep" validate "$share"/jobs/*.json
"../a prefix/bin/rodsweep" run "$share/jobs/smoke.json" -o smoke.h5 | tee run.txt
sh -c "$(sed -n 's/^next: //p' run.txt)" | tee summary.txt
[ -s summary.txt ]
