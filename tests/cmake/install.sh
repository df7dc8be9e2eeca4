#!/bin/sh
# install.sh CMAKE: the installed program, job and analysis scripts work away from the source tree.
set -eu
"$1" --install "$BUILD_DIR" --prefix "$PWD/prefix" >install.log || { cat install.log; exit 1; }
share=$PWD/prefix/share/rodsweep
mkdir elsewhere
cd elsewhere
../prefix/bin/rodsweep validate "$share"/jobs/*.json
../prefix/bin/rodsweep run "$share/jobs/smoke.json" -o smoke.h5
/usr/bin/python3 "$share/analysis/summary.py" smoke.h5 | tee summary.txt
[ -s summary.txt ]
