"""Paths of input files in a parsed job, or in a part of it; its checksum."""

import hashlib
import json

from rodsweep.reading.constants import PATHS

NO_PATHS = {("knn", "inputs")}          # the same name elsewhere
SWEEPS = ("grid", "zip")                # a path may stand in a list of these


def placed(value, place, keys=PATHS, key=""):
    """The value, which belongs to `key`, with place(path) for every path of these keys in it."""
    if isinstance(value, dict):
        def key_of(inner):
            return key if inner in SWEEPS else "" if (key, inner) in NO_PATHS else inner

        return {inner: placed(item, place, keys, key_of(inner)) for inner, item in value.items()}
    if isinstance(value, list):
        return [placed(item, place, keys, key) for item in value]
    return place(value) if key in keys and isinstance(value, str) else value


def given(value, keys=PATHS):
    """The paths of these keys in a value, each once."""
    found = {}
    placed(value, lambda path: found.setdefault(path, path), keys)
    return list(found)


def checksum(job):
    """Of what a parsed job means."""
    meant = {key: value for key, value in job.items() if key not in ("$schema", "name", "description")}
    return hashlib.sha256(json.dumps(meant, sort_keys=True).encode()).hexdigest()[:12]
