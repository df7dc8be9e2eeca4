#!/usr/bin/python3
"""Builds the pages as a static site with MkDocs (packages mkdocs, mkdocs-material). `make docs` calls it.

    docs/tools/site.py OUTPUT

A folder beside OUTPUT, OUTPUT-pages, gets links to all pages and to the files that they show and link. The layout is
that of the repository, so relative links still work. A warning of MkDocs is an error.
"""

import os
import shutil
import subprocess
import sys

import links

STYLE = "docs/tools/site.css"
ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def lay_out(root, folder):
    """Creates links below `folder` to all pages and the files that they need."""
    shutil.rmtree(folder, ignore_errors=True)
    pages = links.pages(root)
    for path in {STYLE, *pages, *(path for page in pages for path in links.files_of(root, page))}:
        place = os.path.join(folder, path)
        if os.path.isfile(os.path.join(root, path)):
            os.makedirs(os.path.dirname(place), exist_ok=True)
            os.symlink(os.path.join(root, path), place)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: docs/tools/site.py OUTPUT")
    output = os.path.abspath(sys.argv[1])
    lay_out(ROOT, f"{output}-pages")
    command = ["/usr/bin/mkdocs", "build", "--strict", "-f", os.path.join(ROOT, "mkdocs.yml"), "-d", output]
    done = subprocess.run(command, env={**os.environ, "RODSWEEP_SITE_PAGES": f"{output}-pages"}, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode == 0:
        shown = os.path.relpath(output)
        print(f"{shown}/index.html; for its search: python3 -m http.server -d {shown}, then http://localhost:8000")
    else:
        print(done.stdout, file=sys.stderr)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
