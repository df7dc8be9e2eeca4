#!/usr/bin/python3
"""docs/keys.md: every key that a job may have, made from jobs/schema.json, which the program prints.

    docs/tools/keys.py                 checks that the page is current; exit code 1 if it is not
    docs/tools/keys.py --update        writes it (`make schema` does)
"""

import json
import os
import re
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCHEMA = os.path.join(ROOT, "jobs", "schema.json")
PAGE = os.path.join(ROOT, "docs", "keys.md")

HEAD = """# Keys of a job
Every key that a job file may have, as the program reads it. `make schema` makes this page of
[jobs/schema.json](../jobs/schema.json). What the keys are for: [jobs](jobs.md).

- *required*: the key has no default. An empty last cell: the key is allowed everywhere.
- Instead of a value that may be swept, write `{"grid": [...]}` or `{"zip": [...]}`; for a number also
  `{"uniform": [a, b]}` or `{"log_uniform": [a, b]}`, for any number `{"integer": [a, b]}`. Objects are swept as a whole or
  inside: [sweeps](jobs.md#sweeps).
- Paths of files are relative to the job file.
"""
SWEEPS = {"grid", "zip", "uniform", "log_uniform", "integer"}


def quoted(values):
    return ", ".join(f"`{value}`" for value in values)


def code(value):
    return f"`{json.dumps(value, ensure_ascii=False)}`"


def number(value):
    if value == 2 ** 53 - 1:
        return "2⁵³ − 1"
    return f"{value:g}".replace("e+0", "e").replace("e+", "e")


def is_sweep(way):
    return len(way.get("properties", {})) == 1 and set(way["properties"]) <= SWEEPS


class Schema:
    def __init__(self, schema):
        self.all, self.definitions = schema, schema["definitions"]

    def plain(self, node):
        """A node without sweeps and references."""
        while True:
            if "$ref" in node:
                node = self.definitions[node["$ref"].rpartition("/")[2]]
            elif list(node.get("allOf", [{}])[0]) == ["$ref"]:
                node = node["allOf"][0]
            elif any(is_sweep(way) for way in node.get("anyOf", ())):
                ways = [way for way in node["anyOf"] if not is_sweep(way)]
                node = ways[0] if len(ways) == 1 else {**node, "anyOf": ways}
            else:
                return node

    def named(self, name):
        return self.plain(self.definitions[name])

    def type_of(self, node):
        """Type and bounds in words."""
        node = self.plain(node)
        if node.get("description") == "initial guess of cg":
            return "[guess](#guesses)"
        if "anyOf" in node:
            return " or ".join(self.type_of(way) for way in node["anyOf"])
        if "enum" in node:
            return ", ".join(code(word) for word in node["enum"])
        kind = node["type"]
        if kind == "array":
            item = self.type_of(node["items"])
            return f"three times {item}" if "maxItems" in node else f"list: {item}"
        if kind in ("number", "integer"):
            bounds = [f"{sign} {number(node[name])}" for name, sign in
                      (("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤")) if name in node]
            return ", ".join(["whole number" if kind == "integer" else "number", *bounds])
        if kind == "string":
            return "path" if node.get("maxLength", 0) >= 4000 else "text"
        return "`true`, `false`" if kind == "boolean" else "object"


class Place:
    """Where a key is allowed and required, by the value of another key: the scene's type, the job's kind, ..."""

    def __init__(self, node, name):
        self.rules = []
        for rule in node.get("allOf", ()):
            if "if" in rule:
                (self.tag, test), = rule["if"]["properties"].items()
                self.rules.append((test["const"], rule["then"]))
        allowed = [word for word, then in self.rules if then.get("properties", {}).get(name) is not False]
        refused = [word for word, _ in self.rules if word not in allowed]
        needed = [word for word, then in self.rules if name in then.get("required", ())]
        few = quoted(allowed) if len(allowed) <= len(refused) else f"not {quoted(refused)}"
        self.words = few if refused else ""
        self.required = name in node.get("required", ()) or bool(needed) and needed == allowed
        if needed and needed != allowed:
            self.words += f"; required: {quoted(needed)}"
        others = {word: then.get("properties", {}).get(name) or {} for word, then in self.rules}
        self.defaults = "".join(f", {code(other['default'])} of `{word}`" for word, other in others.items()
                                if "default" in other)


def default_of(node, name, place):
    groups = [[way["required"][0] for way in rule["oneOf"]] for rule in node.get("allOf", ()) if "oneOf" in rule]
    for group in groups:
        if name in group:
            return f"this or {quoted(other for other in group if other != name)}"
    default = node["properties"][name].get("default")
    if place.required:
        return "*required*"
    return "" if default is None or isinstance(default, dict) else code(default) + place.defaults


def table(schema, node, first=None):
    """The table of an object's keys; `first` is the text of an additional first column."""
    lines = []
    for name, child in node["properties"].items():
        place = Place(node, name)
        text = child.get("description", "")
        unit = re.search(r" \[([^][]+)\]$", text)
        lines.append([f"`{name}`", schema.type_of(child), unit.group(1) if unit else "", default_of(node, name, place),
                      text[:unit.start()] if unit else text, place.words])
    tags = {place.tag for place in (Place(node, name) for name in node["properties"]) if place.rules}
    heads = ["key", "type and bounds", "unit", "default", "meaning", f"allowed by {quoted(sorted(tags))}"]
    if first is not None:
        heads.insert(0, "guess")
        lines = [[first, *line] for line in lines]
    kept = [k for k, head in enumerate(heads) if head not in ("unit", "allowed by ") or any(line[k] for line in lines)]
    return [heads[k] for k in kept], [[line[k] for k in kept] for line in lines]


def written(heads, lines):
    rows = [heads, ["---"] * len(heads), *lines]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |\n" for row in rows)


def section(title, remark, *tables):
    return f"\n## {title}\n{remark}\n\n" + "\n".join(tables)


def guesses(schema):
    ways = schema.named("guess")["anyOf"]
    words = next(way["enum"] for way in ways if "enum" in way)
    kinds = next(way["properties"] for way in ways if "properties" in way)
    heads, lines = [], []
    for name, child in kinds.items():
        own = {**child, "properties": {key: value for key, value in child["properties"].items() if key != "label"}}
        heads, more = table(schema, own, f"`{name}`") if own["properties"] else (heads, [])
        lines += more
    label = next(iter(kinds.values()))["properties"]["label"]["description"]
    return section("`guesses`", "A list. Each is an object with one key, as in `{\"subspace\": {\"size\": 10}}`, or for "
                   f"{quoted(words)} the word alone. Each may be swept. Each may have a `label`, a text of at most 60 "
                   f"characters ({label}), but for one within another.",
                   written(["guess", "what it is"], [[f"`{name}`", kinds[name]["description"]] for name in kinds]),
                   written(heads, lines))


def page(text):
    schema = Schema(json.loads(text))

    def keys(name):
        node = schema.named(name)
        node = next((way for way in node.get("anyOf", ()) if "properties" in way), node)
        return written(*table(schema, node))

    obstacles = [f"`{{\"{name}\": {{...}}}}`, {child['description']}:\n\n" + keys(f"scene.obstacles.item.{name}")
                 for name, child in schema.named("scene.obstacles.item")["properties"].items()]
    parts = [HEAD,
             section("The job", "Swept may be `evaluation`, `scene`, `start`, `time`, `solve`, and each of the `guesses`.",
                     written(*table(schema, schema.all))),
             section("`scene`", "All may be swept but `type`, for which whole scenes are.", keys("scene")),
             section("`scene.section`", "All may be swept but `type`, for which whole sections are.",
                     keys("scene.section")),
             section("`scene.tip_motion`", "All may be swept.", keys("scene.tip_motion")),
             section("`scene.wind`", "All may be swept.", keys("scene.wind")),
             section("`scene.contact`", "All may be swept; `{}` is contact with all defaults.", keys("scene.contact")),
             *(section(f"`scene.{name}`", "A list; all may be swept.", keys(f"scene.{name}.item"))
               for name in ("loads", "motions", "gravity_changes")),
             section("`scene.obstacles`", "A list of objects with one key each; all may be swept.", *obstacles),
             section("`start`", "All may be swept.", keys("start")),
             section("`time`", "All may be swept.", keys("time")),
             section("`time.until`", "It may be swept.", keys("time.until")),
             section("`solve`", "All may be swept.", keys("solve")),
             guesses(schema)]
    for name in ("record", "network", "training"):
        hidden = [f"`{key}` is not for `{rule['if']['properties']['kind']['const']}`." for rule in schema.all["allOf"]
                  for key in ((rule["then"]["properties"].get(name) or {}).get("properties", {}))]
        parts.append(section(f"`{name}`", " ".join(["None may be swept.", *hidden]),
                             written(*table(schema, schema.all["properties"][name]))))
    return "".join(parts)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main():
    text = page(read(SCHEMA))
    if "--update" in sys.argv[1:]:
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(text)
        return 0
    current = read(PAGE) == text
    print("docs/keys.md is current" if current else "docs/keys.md does not match jobs/schema.json: run `make schema`")
    return 0 if current else 1


if __name__ == "__main__":
    sys.exit(main())
