"""The notebooks of tools/python/notebooks run from their first cell to the last, and say what their texts claim.

Tried in it, and killed: a cell that raises; the shaft's disk in balance; the arm's controller without the weight; a sweep that forgets
its rows; a tilt of the four-bar that is not set.
"""

import importlib.util
import re

import pytest

from conftest import ROOT

NOTEBOOKS = ROOT / "tools" / "python" / "notebooks"
missing = [name for name in ("nbclient", "nbformat", "ipykernel", "matplotlib", "pandas") if importlib.util.find_spec(name) is None]
pytestmark = pytest.mark.skipif(bool(missing), reason=f"Python has no {', '.join(missing)} (tools/install-dependencies --with-site)")


def said_by(name):
    """All that the cells print and return; and how many pictures they draw."""
    import nbclient
    import nbformat

    notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert all(not cell.outputs and cell.execution_count is None for cell in notebook.cells if cell.cell_type == "code"), \
        "kept without outputs: they are made anew for the site"
    nbclient.NotebookClient(notebook, timeout=3600, startup_timeout=3600,  # a kernel starts slowly on a busy machine
                            resources={"metadata": {"path": str(NOTEBOOKS)}}).execute()
    text, pictures = "", 0
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            text += output.get("text", "") + output.get("data", {}).get("text/plain", "") + "\n"
            pictures += "image/png" in output.get("data", {})
            assert output.output_type != "error" and "Warning" not in output.get("text", "")
    return text, pictures


def test_all_are_tested():
    assert {file.stem for file in NOTEBOOKS.glob("*.ipynb")} == {"four_bar", "shaft", "controlled_arm", "sweep"}


def test_four_bar():
    said, pictures = said_by("four_bar")
    assert "complete>, True, 'pass')" in said.replace("\n", "") and pictures == 1
    table = {int(line.split()[0]): float(line.split()[2]) for line in said.splitlines() if "mm/deg" in line}
    assert table[0] == 0.0 and table[5] == pytest.approx(4.263, rel=1e-2)  # the model's
    assert table[2] == pytest.approx(2 * table[1], rel=0.02)


def test_shaft():
    said, pictures = said_by("shaft")
    frequencies = [float(number) for number in re.search(r"array\(\[(.*?)\]", said)[1].split(",")]
    assert 53.0 < frequencies[0] < 53.8 and 53.0 < frequencies[1] < 53.8 and pictures == 1
    assert float(re.search(r"largest ([0-9.]+) m", said)[1]) == pytest.approx(0.406, rel=0.03)  # as the model file says
    below = float(re.search(r"below .* = ([-+0-9.]+) m;", said)[1])
    above = float(re.search(r"above .* = ([-+0-9.]+) m;", said)[1])
    assert below > 0.03 and -0.12 < above < -0.03


def test_controlled_arm():
    said, pictures = said_by("controlled_arm")
    assert pictures == 1 and "('torque', 'N.m')" in said
    assert float(said.replace("(", " ").rsplit(",", 1)[1].strip(" )\n")) == pytest.approx(1, rel=1e-9)
    difference = float(re.search(r"largest difference ([0-9.e-]+) rad", said)[1])
    assert difference < 5e-3 and float(re.search(r"at the end ([0-9.]+)", said)[1]) == pytest.approx(0.3, abs=1e-4)


def test_sweep():
    said, pictures = said_by("sweep")
    assert "46 of 46 done" in said and pictures == 1
    assert 50 < float(re.search(r"with ([0-9.]+) rad/s at the end", said)[1]) < 58
    assert "46 rows were there, 3 were run" in said
