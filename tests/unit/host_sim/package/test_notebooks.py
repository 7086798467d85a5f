# SPDX-License-Identifier: Apache-2.0
"""The shipped notebooks: every cell runs with the installed wheel, outside the repository.

Cells are plain Python, so a kernel is not needed: they are executed one after the other in one
name space, and the value of a cell's last expression is shown, as a kernel does: as the picture
that it makes of itself, or else as text.
"""

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import nbformat
import pytest
from environments import PROJECT, Installed

pytest_plugins = ("wheel_fixtures",)

NOTEBOOKS = sorted((PROJECT / "notebooks").glob("*.ipynb"))

RUN = """
import ast, json, sys
import matplotlib
matplotlib.use("Agg")
notebook = json.load(open(sys.argv[1], encoding="utf-8"))
cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
names, pictures, texts = {}, [], []
for number, cell in enumerate(cells):
    tree, place = ast.parse("".join(cell["source"])), f"code cell {number}"
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, place, "exec"), names)
    shown = eval(compile(ast.Expression(last.value), place, "eval"), names) if last else None
    if hasattr(shown, "_repr_svg_"):
        pictures.append(shown._repr_svg_())
    elif shown is not None:
        texts.append(repr(shown))
assert names["hubsim"].__file__.startswith(sys.prefix), names["hubsim"].__file__
Figure = matplotlib.figure.Figure
figures = {name: value for name, value in names.items() if isinstance(value, Figure)}
curves = names["simulated"]
for name, figure in figures.items():
    figure.savefig(f"{name}.png")
print("RESULTS " + json.dumps({
    "pictures": pictures, "texts": texts,
    "figures": {
        name: sum(len(axes.get_lines()) for axes in figure.axes) for name, figure in figures.items()
    },
    "optimum": {int(rpm): float(best) for rpm, best in names["optimum"].items()},
    "stored": {curve.strategy: dict(zip(curve.demand_nm, curve.stored)) for curve in curves},
    "ideal": {curve.strategy: dict(zip(curve.demand_nm, curve.settled)) for curve in curves},
}))
"""


@pytest.fixture(scope="session")
def results(installed: Installed) -> dict[str, Any]:
    """Run the notebook of the paper's figures and return what it found."""
    printed = installed.run("python", "-c", RUN, PROJECT / "notebooks" / "paper_figures.ipynb")
    (line,) = (line for line in printed.splitlines() if line.startswith("RESULTS "))
    found: dict[str, Any] = json.loads(line.removeprefix("RESULTS "))
    return found


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_valid_and_stored_without_outputs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)


def test_every_notebook_is_executed() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["paper_figures"]


def test_the_papers_three_figures_are_drawn(results: dict[str, Any], installed: Installed) -> None:
    assert results["figures"].keys() == {"fig5", "fig13", "fig14"}
    assert all(lines >= 3 for lines in results["figures"].values())
    for name in results["figures"]:
        assert (installed.place / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_a_reader_sees_pictures_and_no_name_of_an_object(results: dict[str, Any]) -> None:
    assert results["texts"] == []
    titles = ("regions of a demand", "no power", "stop from 40 km/h")
    assert len(results["pictures"]) == len(titles)
    for picture, title in zip(results["pictures"], titles, strict=True):
        svg = ElementTree.fromstring(picture)
        assert svg.tag == "{http://www.w3.org/2000/svg}svg"
        assert title in "".join(svg.itertext())
        curves = [
            path for path in svg.iter("{http://www.w3.org/2000/svg}path")
            if path.get("d", "").count("L") > 10
        ]  # fmt: skip
        assert len(curves) >= 3, title


def test_the_optimum_equals_the_papers_equation(results: dict[str, Any]) -> None:
    """Equation (20), T = 3 p^2 psi^2 omega / 4 R, holds where iron and bridge losses are small."""
    assert results["optimum"].keys() == {"50", "100", "150"}
    best = [results["optimum"][rpm] for rpm in ("50", "100", "150")]
    assert best == sorted(best)
    assert best[0] > 10.0
    assert (best[2] - best[1]) / (best[1] - best[0]) == pytest.approx(1.0, abs=0.05)


def test_simulated_stops_agree_with_the_ideal_ones(results: dict[str, Any]) -> None:
    """Within the figures of the README: a settled battery stores up to 1.6 % less than a rested
    one.
    """
    assert results["stored"].keys() == {"parallel_ratio", "parallel_free_travel", "series_optimal"}
    for strategy, stored in results["stored"].items():
        for demand, share in stored.items():
            assert share == pytest.approx(results["ideal"][strategy][demand], abs=0.02)
    at_40 = {strategy: stored["40.0"] for strategy, stored in results["stored"].items()}
    assert at_40["parallel_ratio"] < at_40["parallel_free_travel"] < at_40["series_optimal"]
