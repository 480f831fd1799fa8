#!/usr/bin/env python3
"""Runs notebooks with all that they assert:  scenes/python/notebooks/run.py [--out FOLDER] [NAME…]

Needs the package and its extra `notebooks`.  The files stay as they are, without outputs; FOLDER gets copies with them, as
the site shows them.
"""

from __future__ import annotations

import argparse
import pathlib
import time

import nbformat
from nbclient import NotebookClient

FOLDER = pathlib.Path(__file__).resolve().parent


def run(name: str, out: pathlib.Path | None) -> float:
    """Seconds that it took."""
    notebook, start = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4), time.perf_counter()
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    if out:
        out.mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, out / f"{name}.ipynb")
    return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, metavar="FOLDER")
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    for name in options.names or sorted(file.stem for file in FOLDER.glob("*.ipynb")):
        print(f"{name}: {run(name, options.out):.1f} s", flush=True)


main()
