#!/bin/bash
# Draws the figures and tables of this folder from the files of the studies in RESULTS: `make studies` calls it.
set -euo pipefail
shopt -s extglob
cd "$(dirname "$0")/../.."
results=${1:?usage: analysis/results/draw.sh RESULTS [variants|ablation|score]}
out=analysis/results

declare -A drawn
script() { drawn[$2]=1; /usr/bin/python3 "analysis/$1.py" "$results/$2.h5" "${@:3}"; }
figures() { script "$@" -o $out; }
table() { script "$@" >"$out/$2.txt"; }
clean() { sed -i "/\.\(png\|pdf\)\$/d" $out/*.txt; rm -f $out/*.pdf; }  # no paths of figures, no PDFs
trap clean EXIT
origins() { $out/origins.py "${@/#/$results/}"; }
origins_of_drawn() { local names=("${!drawn[@]}"); origins "${names[@]/%/.h5}"; }

if [ "${2:-}" = variants ]; then
  for family in rods lattices; do
    /usr/bin/python3 analysis/loss.py "$results"/${family}_variants/!(set_*).h5 -o "$results/${family}_variants" >$out/${family}_variants.txt
  done
  for study in rods_front lattices_front; do table summary $study; done
  for scene in bending_rod helix; do  # all in the table, those that a figure can tell apart in it
    figures front rods_front --scene $scene --tolerance 1e-2,1e-3 >>$out/rods_front.txt
    figures front rods_front --scene $scene --tolerance 1e-2,1e-3 --guess "zero,subspace 10,regression 6,copingnet factors_16,\
copingnet factors_64,copingnet rods 3 to 0.01" >/dev/null
  done
  origins_of_drawn
  exit
fi
if [ "${2:-}" = score ]; then
  files=(score/{bending_rod,helix,tree,forest,net,lattice,falling_rods,knot}_tuning.h5)
  /usr/bin/python3 analysis/score.py "${files[@]/#/$results/}" -o $out >$out/score.txt
  cp "$results"/score/*_test.json jobs/score  # as deep as results/score: its paths stay right
  origins "${files[@]}" "${files[@]/_tuning/_test}"
  exit
fi
if [ "${2:-}" = ablation ]; then
  for scene in bending helix; do
    figures ablation ablation_$scene "$results/ablation_$scene" --tolerance 1e-1,1e-2,1e-3 >$out/ablation_$scene.txt
    table summary ablation_${scene}_step --by time.step_s
  done
  figures long_term ablation_long_term --log-time >$out/ablation_long_term.txt
  origins_of_drawn
  exit
fi
jacobi="--select solve.preconditioner=jacobi"
for scene in bending helix; do  # all in the table, those that a figure can tell apart in it
  figures spatial spatial_$scene $jacobi --guess "zero,quadratic,regression 6,subspace 10,deflation 10,copingnet rods 5 lag 8 to 0.01,\
copingnet rods-large,first copingnet $scene-paper,first copingnet $scene-paper-best,knn 3"
  table summary spatial_$scene
done
pretrained=network/pretrained
/usr/bin/python3 analysis/loss.py $pretrained/{rods,rods-large,bending-paper,bending-paper-best,helix-paper,helix-paper-best}.h5 \
  -o $out >$out/pretrained.txt
/usr/bin/python3 analysis/loss.py $pretrained/{knot,tree,falling,stiff}-paper-best.h5 $pretrained/lattices.h5 $pretrained/seeds/*.h5 \
  -o $out >$out/pretrained_scenes.txt
rm $out/knot-paper-best-and-*-loss.png
for study in temporal_bending temporal_helix; do
  figures temporal $study --tolerance 1e-2,1e-3,1e-4
  table summary $study
done
figures side_by_side side_by_side --log-time >"$out/side_by_side.txt"
figures long_term long_term_learned --log-time >"$out/long_term_learned.txt"
table summary learned_rods
for scene in bending_rod helix; do figures front learned_rods --scene $scene --tolerance 1e-2,1e-3,1e-4; done
{ echo; script summary learned_rods --newton all; echo; script summary learned_rods --scene ring --by scene.clamp; } >>"$out/learned_rods.txt"
table summary learned_rods_length --by scene.segments
figures spatial learned_rods_length && rm $out/learned_rods_length-{speedup,time,four-curves}.png
table summary learned_rods_closed --by scene.segments --newton all
for by in stiffness:scene.youngs_modulus_pa length:scene.length_m step:time.step_s; do
  study=generalisation_${by%%:*}
  figures spatial "$study" --x "${by#*:}"
  table summary "$study" --by "${by#*:}"
done
figures spatial tree_wind --x scene.depth $jacobi && rm $out/tree_wind-{speedup,time,four-curves}-by-depth.png
table summary tree_wind --by scene.depth
figures spatial knot --x scene.contact $jacobi && rm $out/knot-{time,four-curves}-by-contact.png
for study in collision_falling knot; do table summary $study --by scene.contact.friction; done
figures integrators integrators --energy-step 0.01 >$out/integrators.txt
figures balance balance >"$out/balance.txt"
script balance balance_scenes >"$out/balance_scenes.txt"
for study in lattice_swing lattice_preconditioners lattice_closed; do figures combinations $study >"$out/$study.txt"; done
for study in net_gusts net_closed; do figures combinations $study --x scene.rows >"$out/$study.txt"; done
rm $out/{lattice_preconditioners,lattice_closed,net_closed}-combinations.png
origins_of_drawn
