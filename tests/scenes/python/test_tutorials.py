"""The Python blocks of scenes/examples/tutorials run as they stand, in the order of each page."""

import re

import pytest
from conftest import ROOT


def run(page):
    text = (ROOT / f"scenes/examples/tutorials/{page}.md").read_text()
    names = {}
    for block in re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S):
        exec(compile(block, page, "exec"), names)
    return names


def test_first_mechanism():
    names = run("first_mechanism")
    assert names["world"].time == pytest.approx(1, abs=1e-9)
    assert names["world"].positions[names["rods"][0], 2] < 0  # it has fallen
    assert (names["world"].positions[names["rods"][0]] ** 2).sum() == pytest.approx(0.25, abs=1e-8)  # its hinge holds


def test_contacts():
    assert run("contacts")["weight"] == pytest.approx([0, 0, 20 * 9.81], abs=1e-6)
