#!/usr/bin/python3
"""Checks the pages of this repository, for GitHub and for the site.

    docs/tools/links.py [ROOT]

Every relative link needs an existing file and, if it names one, a heading in it. Every page is in the navigation
(mkdocs.yml), and every entry of the navigation is a page. Rows of a table have as many cells as their head; as on
GitHub, a | within code ends a cell too. A list has an empty line before it, which the site's Markdown needs. A
sentence has at most 60 words, a paragraph at most 900 characters. Errors are printed with their line; exit code 1.
"""

import os
import re
import sys

TOP = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "analysis/results/README.md")
LINK = re.compile(r"(?<!\\)\[(?:[^][]|\[[^][]*\])*\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)"
                  r"|<(?:a|img)\s[^>]*?(?:href|src)=\"([^\"]+)\"")
FENCE = re.compile(r"^(```|~~~)")
ITEM = re.compile(r"^(?:[-*] |\d+\. )")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$")
SENTENCE_END = re.compile(r"(?<=[.!?])[)*”]*\s+")
LINK_TEXT = re.compile(r"(!?)\[([^]]*)\]\([^)]*\)")
MOST_WORDS, MOST_CHARACTERS = 60, 900
CODE = re.compile(r"(?<!`)(`+)(?!`)(?:(?!\n *\n).)*?(?<!`)\1(?!`)", re.S)
COMMENT = re.compile(r"<!--.*?-->", re.S)
BAR = re.compile(r"(?<!\\)\|")


def pages(root):
    """Paths of all pages below `root`."""
    found = [path for path in TOP if os.path.exists(os.path.join(root, path))]
    return found + sorted(f"docs/{name}" for name in os.listdir(os.path.join(root, "docs")) if name.endswith(".md"))


def lines_of(root, page):
    """Yields (number, line) of a page outside fenced code."""
    with open(os.path.join(root, page), encoding="utf-8") as file:
        fenced = False
        for number, line in enumerate(file.read().splitlines(), 1):
            if FENCE.match(line):
                fenced = not fenced
            elif not fenced:
                yield number, line


def anchor(heading):
    """GitHub's anchor of a heading's text."""
    text = LINK_TEXT.sub(r"\2", heading)
    text = re.sub(r"[^\w\- ]", "", re.sub(r"<!--.*?-->|<[^>]+>", "", text).lower())
    return text.strip().replace(" ", "-")


def anchors(root, page):
    found = {}
    for _, line in lines_of(root, page):
        heading = HEADING.match(line)
        if heading:
            name = anchor(heading.group(1))
            found[name] = found.get(name, -1) + 1
        for named in re.findall(r"<a (?:id|name)=\"([^\"]+)\"", line):
            found[named] = 0
    return {name if k == 0 else f"{name}-{k}" for name, last in found.items() for k in range(last + 1)}


def targets(root, page):
    """(number of the line, target) of every relative link, also if its text goes on in the next line."""
    text, count = "", 0
    for number, line in lines_of(root, page):
        text += "\n" * (number - count) + line
        count = number
    for ignored in (CODE, COMMENT):
        text = ignored.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)
    for found in LINK.finditer(text):
        target = found.group(1) or found.group(2)
        if not re.match(r"[a-z]+:|//", target):
            yield text.count("\n", 0, found.end()), target


def files_of(root, page):
    """Paths below `root` of the files that a page links or shows."""
    for _, target in targets(root, page):
        path = target.partition("#")[0]
        if path:
            yield os.path.normpath(os.path.join(os.path.dirname(page), path))


def wrong_links(root, page, known):
    for number, target in targets(root, page):
        path, _, name = target.partition("#")
        file = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if not os.path.exists(os.path.join(root, file)):
            yield f"{page}:{number}: {target}: there is no {file}"
        elif name and file.endswith(".md"):
            if file not in known:
                known[file] = anchors(root, file)
            if name not in known[file]:
                yield f"{page}:{number}: {target}: {file} has no heading #{name}"


def wrong_tables(root, page):
    cells = before = 0
    for number, line in lines_of(root, page):
        if not line.startswith("|"):
            cells = 0
            continue
        count = len(BAR.findall(line))
        if cells == 0 or number != before + 1:
            cells = count
        elif count != cells:
            yield f"{page}:{number}: {count - 1} cells, but the table's head has {cells - 1} (a | within a cell is \\|)"
        before = number


def wrong_lists(root, page):
    before = words = False    # whether the paragraph so far has an item, a text
    for number, line in lines_of(root, page):
        if not line.strip() or line.startswith("#"):
            before = words = False
        elif ITEM.match(line):
            if words and not before:
                yield f"{page}:{number}: a list begins without an empty line before it"
            before = True
        elif not line.startswith(" "):
            words = True


def paragraphs(root, page):
    """(number of its first line, text without links' targets and pictures) of every paragraph and item."""
    first, words = 0, []
    for number, line in [*lines_of(root, page), (0, "")]:
        apart = not line.strip() or line.startswith(("#", "|"))
        if words and (apart or ITEM.match(line.lstrip())):
            text = LINK_TEXT.sub(lambda link: "" if link.group(1) else link.group(2), " ".join(words))
            yield first, " ".join(text.split())
            words = []
        if not apart:
            first = first if words else number
            words += line.split()


def wrong_lengths(root, page):
    for number, text in paragraphs(root, page):
        longest = max(len(sentence.split()) for sentence in SENTENCE_END.split(text))
        if longest > MOST_WORDS:
            yield f"{page}:{number}: a sentence of {longest} words; at most {MOST_WORDS}"
        if len(text) > MOST_CHARACTERS:
            yield f"{page}:{number}: a paragraph of {len(text)} characters; at most {MOST_CHARACTERS}"


def navigation(root):
    with open(os.path.join(root, "mkdocs.yml"), encoding="utf-8") as file:
        nav = file.read().partition("\nnav:\n")[2]
    return re.findall(r"^ +- .*?([\w./-]+\.md)$", re.split(r"^\S", nav, 1, re.M)[0], re.M)


def wrong_navigation(root):
    listed, there = navigation(root), pages(root)
    for page in there:
        if listed.count(page) != 1:
            yield f"mkdocs.yml: {page} is in the navigation {listed.count(page)} times"
    for page in listed:
        if not os.path.exists(os.path.join(root, page)):
            yield f"mkdocs.yml: there is no {page}"


def check(root):
    known, wrong = {}, []
    for page in pages(root):
        wrong += [*wrong_links(root, page, known), *wrong_tables(root, page), *wrong_lists(root, page),
                  *wrong_lengths(root, page)]
    return wrong + list(wrong_navigation(root))


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    parted = check(sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", ".."))
    print("\n".join(parted) or "all links lead somewhere")
    sys.exit(1 if parted else 0)
