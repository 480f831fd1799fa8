"""The Python example of solvers/simulator/FORCES.md."""

import pytest
from conftest import ROOT


def test_the_crate_on_the_page():
    page = (ROOT / "solvers/simulator/FORCES.md").read_text()
    example = page.split("```python\n")[1].split("```\n")[0]
    names = {}
    exec(compile(example, "FORCES.md", "exec"), names)
    assert names["on_crate"] == pytest.approx([-10, 0, 20 * 9.81], abs=1e-6)
    assert names["world"].twists[names["crate"], 3] == pytest.approx(0, abs=1e-9)  # friction holds it
