# SPDX-License-Identifier: Apache-2.0
import pytest
from hubsim.report import stop_curves

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_extras import Curve, curves


def test_every_simulated_stop_is_drawn_as_a_circle_at_its_values() -> None:
    drawn = documents.read(stop_curves.draw(curves(), "s"))
    groups = drawn.all("g", "rings")
    assert [len(group.all("circle")) for group in groups] == [3, 3, 3]
    first, second, _ = (float(ring.attributes["cx"]) for ring in groups[0].all("circle"))
    # Linear scale: positions of 5 and 40 N m are proportional to their values.
    assert (second - stop_curves.LEFT) / (first - stop_curves.LEFT) == pytest.approx(
        40.0 / 5.0, rel=1e-2
    )
    low, high = (
        float(groups[0].all("circle")[0].attributes["cy"]),
        float(groups[2].all("circle")[0].attributes["cy"]),
    )
    assert high < low, "more stored energy has to be higher up"


def test_the_table_contains_the_deviation_from_the_ideal() -> None:
    table = documents.read(stop_curves.table(curves()))
    rows = [[cell.words() for cell in row.all("td")] for row in table.all("tbody")[0].all("tr")]
    assert rows[1] == ["16.0 (+1.0)", "75.0 (+1.0)", "77.0 (+1.0)"]
    assert rows[0] == ["−14.0 (0.0)", "64.0 (0.0)", "64.0 (0.0)"]


def test_unknown_strategies_and_missing_demands_are_accepted() -> None:
    odd = Curve("mine<b>", (5.0,), (0.5,), (0.5,), (5.0, 120.0), (0.5, 0.2))
    drawn = documents.read(stop_curves.draw([*curves(), odd], "s"))
    assert "mine<b>" in drawn.words()
    assert not drawn.all("b")
    table = documents.read(stop_curves.table([*curves(), odd]))
    assert table.all("tbody")[0].all("tr")[2].all("td")[-1].words() == "–"


def test_differences_are_taken_at_the_simulated_demands() -> None:
    curve = Curve("series_optimal", (10.0, 30.0), (0.5, 0.5), (0.2, 0.6), (0.0, 40.0), (0.0, 0.8))
    assert stop_curves.differences(curve) == pytest.approx([0.3, -0.1])


def test_the_effect_of_an_unsettled_battery_is_stated_in_numbers() -> None:
    assert stop_curves.unsettled(curves()) == pytest.approx(0.007)
