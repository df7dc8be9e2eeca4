#!/bin/bash
# Draws the figures and tables of this folder from the files of the studies in RESULTS: `make studies` calls it.
set -euo pipefail
cd "$(dirname "$0")/../.."
results=${1:?usage: analysis/results/draw.sh RESULTS}
out=analysis/results

script() { /usr/bin/python3 "analysis/$1.py" "$results/$2.h5" "${@:3}"; }
figures() { script "$@" -o $out; }
table() { script "$@" >"$out/$2.txt"; }

for study in spatial_bending spatial_helix learned_bending learned_helix; do
  figures spatial $study
  table summary $study
done
for study in temporal_bending temporal_helix; do
  figures temporal $study --tolerance 1e-1,1e-2,1e-3
  table summary $study
done
figures heatmap step_size --x time.step_s --y tolerance
figures heatmap step_size --x time.step_s --y solve.preconditioner --measure iterations
figures heatmap stiffness --x scene.youngs_modulus_pa --y scene.segments
figures heatmap stiffness --x scene.youngs_modulus_pa --y scene.segments --measure speedup-guess-cg
table summary step_size --by time.step_s
table summary stiffness --by scene.youngs_modulus_pa
figures newton newton >"$out/newton.txt"
figures long_term long_term >"$out/long_term.txt"
sed -i '/\.\(png\|pdf\)$/d' "$out"/*.txt   # the paths of the figures
rm -f $out/*.pdf
