#!/usr/bin/python3
"""Runs studies: their jobs, then the commands that make their figures and tables.

Results are in results/, figures and tables in analysis/results. A stopped study continues when it is started again, and
a complete job is not repeated. The first command that fails ends the run. Times are for 2 cores; measured times need a
machine that does nothing else.
"""

import argparse
import difflib
import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
OUT = "analysis/results"
JACOBI = "--select solve.preconditioner=jacobi"


class Study(NamedTuple):
    question: str
    time: str
    steps: list    # commands for bash, in the root of the repository, with build/ in the PATH


def run(*names):
    """Jobs of jobs/, in any folder."""
    paths = (next((ROOT / "jobs").rglob(f"{name}.json")) for name in names)
    return [f"rodsweep run {path.relative_to(ROOT)} -n $(nproc) -o results/{path.stem}.h5 --resume" for path in paths]


def results(names):
    return " ".join(f"results/{name}.h5" for name in names)


def show(script, *words):
    """Runs a script of analysis/ whose figures become those of the pages."""
    return " ".join([f"analysis/{script}.py", *words, f"-o {OUT}", "--format png"])


def draw(script, study, *words):
    return show(script, f"results/{study}.h5", *words)


def to(name, command, more=False):
    """Writes the output of a command into a table, without the paths of its figures."""
    return rf"{command} | sed '/\.png$/d' >{'>' * more}{OUT}/{name}.txt"


def summary(study, *words, more=False):
    return to(study, " ".join(["analysis/summary.py", f"results/{study}.h5", *words]), more)


def remove(study, *figures):
    return "rm " + " ".join(f"{OUT}/{study}-{figure}.png" for figure in figures)


def origins(*files):
    """Records what made the tables."""
    return f"{OUT}/origins.py {results(files)}"


def spatial(scene):    # the table has all guesses, the figures those that can be told apart
    study = f"spatial_{scene}"
    guesses = ("zero,quadratic,regression 6,subspace 10,deflation 10,copingnet rods 5 lag 8 to 0.01,copingnet rods-large,"
               f"first copingnet {scene}-paper,first copingnet {scene}-paper-best,knn 3")
    return [*run(f"{scene}_data", study), draw("spatial", study, JACOBI, f'--guess "{guesses}"'), summary(study),
            origins(study)]


def temporal(scene):
    study = f"temporal_{scene}"
    guesses = ("quadratic,regression 6,subspace 10,deflation 10,copingnet rods-large,"
               f"copingnet {scene}-paper,copingnet {scene}-paper-best,knn 3")
    return [*run(f"{scene}_data", study), draw("temporal", study, f'--tolerance 1e-2,1e-3,1e-4 --guess "{guesses}"'),
            summary(study), origins(study)]


def generalisation(what, key):
    study = f"generalisation_{what}"
    return [*run(study), draw("spatial", study, f"--x {key}"), summary(study, f"--by {key}"), origins(study)]


def combinations(*studies, words="", without=()):
    return [*run(*studies), *(to(study, draw("combinations", study, *words.split())) for study in studies),
            *(remove(study, "combinations") for study in without), origins(*studies)]


def variants(family):
    return f"{OUT}/variants.py rodsweep results {family}"


def ablation(scene):
    study, step = f"ablation_{scene}", f"ablation_{scene}_step"
    return [*run(f"{scene}_data", f"{scene}_data_100"), variants(study), *run(study, step),
            to(study, draw("ablation", study, f"results/{study}", "--tolerance 1e-1,1e-2,1e-3")),
            summary(step, "--by time.step_s"), origins(study, step)]


def film(job, task, name, colour, *words):
    """MP4 and GIF. Existing films are kept."""
    for kind in ("mp4", "gif --every 2 --rate 12"):
        path = f"results/figures/{name}.{kind.split()[0]}"
        yield " ".join([f"[ -e {path} ] || analysis/render.py results/{job}.h5 --task {task} --movie {kind} --size 480x360",
                        f"--colour {colour}", *words, f"-o {path}"])


NOT_SHOWN = ("speedup", "time", "four-curves")    # figures of a script that no page has

STUDIES = {
    "spatial": Study("effect of the number of segments: the network of Shao et al., ours, all classical guesses", "30 min",
                     [*spatial("bending"), *spatial("helix")]),
    "temporal": Study("development over simulated time", "8 min",
                      [*temporal("bending"), *temporal("helix")]),
    "side_by_side": Study("one rod by the direct solve, by CG with a learned guess and by networks alone", "1 min", [
        *run("side_by_side"), to("side_by_side", draw("side_by_side", "side_by_side", "--log-time --moments 1,2,4")),
        origins("side_by_side")]),
    "long_term": Study("20,000 steps in closed loops with networks, as a guess and instead of the solve", "5 min", [
        *run("long_term_learned"), to("long_term_learned", draw("long_term", "long_term_learned", "--log-time")),
        origins("long_term_learned")]),
    "learned_rods": Study("the general networks on ten kinds of scene, on long rods, in closed loops", "13 min", [
        *run("learned_rods", "learned_rods_length", "learned_rods_closed"),
        summary("learned_rods"),
        "echo >>analysis/results/learned_rods.txt", summary("learned_rods", "--newton all", more=True),
        "echo >>analysis/results/learned_rods.txt", summary("learned_rods", "--scene ring --by scene.clamp", more=True),
        *(draw("front", "learned_rods", f"--scene {scene} --tolerance 1e-2,1e-3,1e-4") for scene in ("bending_rod", "helix")),
        summary("learned_rods_length", "--by scene.segments"),
        draw("spatial", "learned_rods_length"), remove("learned_rods_length", *NOT_SHOWN),
        summary("learned_rods_closed", "--by scene.segments --newton all"),
        origins("learned_rods", "learned_rods_length", "learned_rods_closed")]),
    "generalisation": Study("inside and outside the training range of segments, stiffness, length and time step", "1 hour", [
        *generalisation("segments", "scene.segments"), *generalisation("segments_helix", "scene.segments"),
        *generalisation("stiffness", "scene.youngs_modulus_pa"), *generalisation("length", "scene.length_m"),
        *generalisation("step", "time.step_s")]),
    "trees": Study("trees of 40 to 1,093 segments in wind", "3 min", [
        *run("tree_wind"), draw("spatial", "tree_wind", "--x scene.depth", JACOBI),
        remove("tree_wind", *(f"{stage}-by-depth" for stage in NOT_SHOWN)), summary("tree_wind", "--by scene.depth"),
        origins("tree_wind")]),
    "contact": Study("rods with and without contact", "2 min", [
        *run("collision_falling", "knot"), draw("spatial", "knot", "--x scene.contact", JACOBI),
        remove("knot", "time-by-contact", "four-curves-by-contact"),
        *(summary(study, "--by scene.contact.friction") for study in ("collision_falling", "knot")),
        origins("collision_falling", "knot")]),
    "integrators": Study("error of the motion over the time step, and energies, with Euler and BDF2", "1 min", [
        *run("integrators"), to("integrators", draw("integrators", "integrators", "--energy-step 0.01")),
        origins("integrators")]),
    "balance": Study("the step of Shao et al., that in balance, and the default, on 20 rods of a user", "2 min", [
        *run("balance", "default_steps"), to("balance", draw("balance", "balance")),
        to("default_steps", "analysis/balance.py results/default_steps.h5 --motion --format png"),
        origins("balance", "default_steps")]),
    "lattices": Study("cubic lattices: number of joints, all preconditioners with all guesses, closed loops", "2 hours",
                      combinations("lattice_swing", "lattice_preconditioners", "lattice_closed",
                                   without=("lattice_preconditioners", "lattice_closed"))),
    "nets": Study("nets in wind: number of joints, closed loops", "16 min",
                  combinations("net_gusts", "net_closed", words="--x scene.rows", without=("net_closed",))),
    "pretrained": Study("how the trained networks learned", "seconds", [
        to("pretrained", show("loss", "network/pretrained/{rods,rods-large,bending-paper,bending-paper-best,helix-paper,"
                                      "helix-paper-best}.h5")),
        to("pretrained_scenes", show("loss", "network/pretrained/{knot,tree,falling,stiff}-paper-best.h5 "
                                             "network/pretrained/lattices.h5 network/pretrained/seeds/*.h5")),
        f"rm {OUT}/knot-paper-best-and-*-loss.png"]),
}
OTHERS = {
    "score": Study("the cheapest way to an error of the motion, by kind and scene (docs/score.md)", "10 hours", [
        "analysis/score.py --errors", "analysis/score.py --times", to("score", show("score"))]),
    "score_networks": Study("the networks of the score: trains three of each", "3 hours", [
        *(variants(family) for family in ("score_rods", "score_rods_large", "score_lattices")),
        "mkdir -p network/pretrained/score",
        "cp results/score_rods/rods*.h5 results/score_lattices/lattices*.h5 network/pretrained/score"]),
    "ablation": Study("what the network of Shao et al. owes to each of its settings: trains some 70 variants", "1 hour", [
        *ablation("bending"), *ablation("helix"), *run("ablation_long_term"),
        to("ablation_long_term", draw("long_term", "ablation_long_term", "--log-time")), origins("ablation_long_term")]),
    "variants": Study("what rods.h5 and lattices.h5 could have been: trains networks with one setting changed", "1 hour", [
        *run("rods_data", "lattices_data"), variants("rods"), variants("lattices"), *run("rods_front", "lattices_front"),
        *(to(f"{family}_variants", f"analysis/loss.py $(ls results/{family}_variants/*.h5 | grep -v /set_) "
                                   f"-o results/{family}_variants --format png") for family in ("rods", "lattices")),
        summary("rods_front"), summary("lattices_front"),
        *(step for scene in ("bending_rod", "helix") for words in [f"--scene {scene} --tolerance 1e-2,1e-3"] for step in (
            to("rods_front", draw("front", "rods_front", words), more=True),
            draw("front", "rods_front", words, '--guess "zero,subspace 10,regression 6,copingnet factors_16,'
                                               'copingnet factors_64,copingnet rods 3 to 0.01"'))),
        origins("rods_front", "lattices_front")]),
    "pictures": Study("films of what there is to see, in results/figures; installs ffmpeg, for MP4", "30 min", [
        "[ -x \"$(command -v ffmpeg)\" ] || cmake/packages.sh packages.txt pictures", "mkdir -p results/figures",
        *run("pictures", "side_by_side", "lattice_sag", "lattice_dropped", "lattice_pressed", "net_wind", "twisted", "pulled"),
        *film("pictures", 0, "helix", "along"), *film("pictures", 1, "net", "rod"), *film("pictures", 2, "ring", "along"),
        *film("pictures", 3, "tree", "radius", "--fine"), *film("pictures", 4, "falling", "rod"),
        *film("pictures", 5, "knot", "along"), *film("pictures", 6, "drape", "rod"),
        *film("side_by_side", 0, "side_by_side", "rod", "--beside 2 3 4 --apart 0,0,0.7"),
        *film("lattice_sag", 0, "lattice", "along"), *film("lattice_dropped", 0, "dropped", "along"),
        *film("lattice_pressed", 0, "pressed", "along"), *film("net_wind", 0, "wind", "along"),
        *film("twisted", 0, "twisted", "along"), *film("pulled", 0, "pulled", "along")]),
    "benchmark": Study("linear systems and our iterations on them, for use elsewhere: results/benchmark, 350 MB", "10 min", [
        *run("benchmark"), "analysis/benchmark_data.py results/benchmark.h5 -o results/benchmark"]),
    "demo": Study("a first report", "half a minute", run("demo")),
}


def outputs(*studies):
    """Results files of the jobs of studies."""
    return list(dict.fromkeys(re.search(r"-o (\S+)", step)[1] for study in studies for step in study.steps
                              if step.startswith("rodsweep run ")))


COMPARED = [file for file in outputs(*STUDIES.values()) if not file.endswith("_data.h5")]
ARCHIVED = " ".join([*outputs(*STUDIES.values()), "CITATION.cff LICENSE jobs network/pretrained", OUT])
OTHERS |= {
    "report": Study("results/report.html: the demo and the studies that were run, as a page to read", "seconds", [
        f"analysis/report.py $(ls results/demo.h5 {' '.join(COMPARED)} results/pictures.h5 2>/dev/null) --skip "
        "--title 'What the sweeps found' -o results/report.html --force"]),
    "archive": Study("results/archive.tar: results of all studies, models, tables, with checksums", "minutes", [
        f"for file in {ARCHIVED}; do [ -e $file ] || {{ echo \"There is no $file: run 'jobs/studies.py all' first.\"; "
        "exit 1; }; done",
        f"find {ARCHIVED} -type f -print0 | sort -z | xargs -0 sha256sum >results/SHA256SUMS",
        "tar --create --file results/archive.tar --transform \"s,^,rodsweep-$(git rev-parse --short HEAD)/,\" "
        f"results/SHA256SUMS {ARCHIVED}",
        "ls -lh results/archive.tar"]),
}
ALL = STUDIES | OTHERS
SOME_FAILED = 3    # exit code of a sweep whose other tasks are complete; the tables say so


def overview():
    width = max(map(len, ALL))
    studies, others = ([f"  {name:<{width}}  {study.question} ({study.time})" for name, study in table.items()]
                       for table in (STUDIES, OTHERS))
    return "\n".join(["studies, 'all' runs these (four hours):", *studies, "others:", *others])


def wanted(name):
    """The steps of a study, or of all studies."""
    if name == "all":
        return [step for study in STUDIES.values() for step in study.steps]
    if name not in ALL:
        near = ([study for study, of in ALL.items() if f"results/{name}.h5" in outputs(of)] or    # a job of it
                difflib.get_close_matches(name, ["all", *ALL], 1, 0.4))
        sys.exit(f"studies.py: unknown study '{name}'" + (f": did you mean '{near[0]}'?" if near else "") +
                 f"\nIt may be all, {', '.join(ALL)}.")
    return ALL[name].steps


def reads_results(steps):
    """Whether steps read results/ otherwise than by their words: in a job, or in a script with a folder of its own."""
    jobs = [ROOT / step.split()[2] for step in steps if step.startswith("rodsweep run ")]
    return any("/results/" in job.read_text(encoding="utf-8") for job in jobs) or any(
        script in step for script in ("variants.py", "score.py") for step in steps)


def main():
    made = argparse.ArgumentParser(description=__doc__, epilog=overview(),
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("studies", nargs="*", metavar="STUDY", help="run in this order (default: list them)")
    made.add_argument("--build", default="build", metavar="FOLDER", help="where the program was built (default: build)")
    made.add_argument("--results", default="results", metavar="FOLDER", help="where results go (default: results)")
    made.add_argument("--dry-run", action="store_true", help="print the commands only")
    options = made.parse_args()
    if options.results != "results" and (fixed := [name for name in options.studies if reads_results(wanted(name))]):
        sys.exit(f"studies.py: {', '.join(fixed)} needs results/ of this folder: leave out --results")
    folder = shlex.quote(os.path.abspath(options.results)) if options.results != "results" else "results"
    steps = [re.sub(r"(?<![\w/])results/", lambda _: f"{folder}/", step) for name in options.studies for step in wanted(name)]
    if options.dry_run or not steps:
        print("\n".join(steps) or overview())
        return
    os.makedirs(os.path.join(ROOT if options.results == "results" else "", options.results), exist_ok=True)
    os.chdir(ROOT)
    if not os.access(f"{options.build}/rodsweep", os.X_OK):
        sys.exit(f"studies.py: there is no {options.build}/rodsweep: run `make build`")
    signal.signal(signal.SIGINT, lambda *_: None)    # the command gets it too and ends in its own way
    environment = {**os.environ, "PATH": f"{os.path.abspath(options.build)}:{os.environ['PATH']}"}
    for step in steps:
        bash = ["bash", "-o", "pipefail", "-c", step]
        code = subprocess.run(bash, stdin=subprocess.DEVNULL, env=environment, check=False).returncode
        if code and not (code == SOME_FAILED and step.startswith("rodsweep run ")):
            sys.exit(f"studies.py: exit code {code}, the next call continues here:\n  {step}")


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)    # the list's reader may close the pipe
    main()
