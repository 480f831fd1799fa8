#!/usr/bin/env python3
"""Runs notebooks with all that they assert:  scenes/python/notebooks/run.py [NAME…]

Needs the package and its extra `notebooks`.  The files stay as they are, without outputs.
"""

import pathlib
import sys
import time

import nbformat
from nbclient import NotebookClient

FOLDER = pathlib.Path(__file__).resolve().parent


def run(file: pathlib.Path) -> float:
    """Seconds that it took."""
    notebook, start = nbformat.read(file, as_version=4), time.perf_counter()
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    return time.perf_counter() - start


def main() -> None:
    names = sys.argv[1:] or sorted(file.stem for file in FOLDER.glob("*.ipynb"))
    for name in names:
        print(f"{name}: {run(FOLDER / f'{name}.ipynb'):.1f} s", flush=True)


main()
