#!/usr/bin/python3
"""What made the tables of this folder: origins.txt, one row per results file.

    analysis/results/origins.py FILE...    adds or replaces the rows of results files (jobs/studies.py calls it)
    analysis/results/origins.py            names the tables that are older than their job or models; exit code 1 if any is

A row has the study's name, the revision of the program, the day of its first run, its minutes, instructions and
processor, its tasks and how many of them failed, the share of the time of solves that interruptions took (interrupted
solves are left out of times), and checksums of the job and its models. The job's checksum ignores name and description.
A table is older than its job or models if they have other checksums now; docs/tools/pages.py quotes no number of such a
table.
"""

import hashlib
import json
import math
import os
import re
import sys
from datetime import datetime
from pathlib import Path

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
sys.path.insert(0, os.path.join(ROOT, "analysis"))
from rodsweep.reading import measures, remarks, texts, timings  # noqa: E402
from rodsweep.reading.job_paths import checksum  # noqa: E402
from rodsweep.reading.sweepfile import SweepFile  # noqa: E402
ORIGINS = os.path.join(HERE, "origins.txt")
COLUMNS = ("study", "revision", "day", "minutes", "processor", "tasks", "failed", "disturbed", "job", "models")


def models_checksum(job, folder):
    """Of the models of a parsed job that come along, whose paths start at a folder; "-" without models."""
    paths = sorted(path for path in set(re.findall(r'"model": "([^"]+)"', json.dumps(job))) if "/results/" not in path)
    digest = hashlib.sha256()
    for path in paths:
        with open(os.path.join(folder, path), "rb") as file:
            digest.update(file.read())
    return digest.hexdigest()[:12] if paths else "-"


def read(path=ORIGINS):
    """{study: {column: text}}; empty without the file."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        rows = [re.split(r" {2,}", line.strip()) for line in file if line.strip()]
    return {row[0]: dict(zip(rows[0], row)) for row in rows[1:]}


def find_job(name):
    """Path of a job that comes along, or None."""
    return next(Path(ROOT, "jobs").rglob(f"{name}.json"), None)


def older(origins):
    """{study: why} of those that are older than their job or models."""
    found = {}
    for name, row in origins.items():
        path = find_job(name)
        if path is None:
            continue    # made by a script from another job
        with open(path, encoding="utf-8") as file:
            job = json.load(file)
        where = os.path.relpath(path, ROOT)
        try:
            models = models_checksum(job, os.path.dirname(path))
        except FileNotFoundError as missing:
            found[name] = f"{where} has a model that does not exist: {missing.filename}"
            continue
        if checksum(job) != row["job"]:
            found[name] = f"{where} has changed since"
        elif models != row["models"]:
            found[name] = f"a model of {where} has changed since"
    return found


def row_of(path):
    with SweepFile(path) as file:
        job, runs = file.job(), file.runs()
        spans = [[datetime.fromisoformat(run[name] or run["begin"]) for name in ("begin", "end")] for run in runs]
        seconds = sum((end - begin).total_seconds() for begin, end in spans)
        processors = dict.fromkeys(run["versions"].split("; ")[-1] for run in runs)
        made = [job["name"], remarks.revisions(file), runs[0]["begin"][:10],
                f"{seconds / 60:.1f}", " / ".join(processors), str(file.task_count),
                str(int((file.complete & ~file.ok).sum())), disturbed(file), checksum(job),
                models_checksum(job, os.path.dirname(runs[-1]["job"]))]
    return dict(zip(COLUMNS, made))


def disturbed(file):
    """Share of the time of solves that interruptions took; "-" if no single solve was timed."""
    if not timings.timed(file):
        return "-"
    sims = measures.simulations(file, file.complete)
    if not len(sims):
        return "-"
    share = timings.lost_share(timings.times(file, sims)["all"], sims)
    return f"{100 * share:.1f} %" if not math.isnan(share) else "-"


def write(rows):
    lines = [COLUMNS, *([rows[name][column] for column in COLUMNS] for name in sorted(rows))]
    with open(ORIGINS, "w", encoding="utf-8") as file:
        file.write("\n".join(texts.aligned(lines, [False] * len(COLUMNS))) + "\n")


def main():
    rows = read()
    if len(sys.argv) == 1:
        found = older(rows)
        for name, why in found.items():
            print(f"{name}: {why}")
        return 1 if found else 0
    for path in sys.argv[1:]:
        row = row_of(path)
        rows[row["study"]] = row
    write(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
