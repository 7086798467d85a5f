# SPDX-License-Identifier: Apache-2.0
"""The diagram is measured from its paths: widths from coordinates."""

from dataclasses import dataclass
from itertools import pairwise

import pytest
from hubsim.report import flows, lanes, sankey
from hubsim.report.flows import Flow

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.documents import Node, Step
from tests.unit.host_sim.report.ideal_vehicle import STRATEGIES, Run, drive, three

HALF_PX = 0.5


@dataclass
class Picture:
    """A drawn flow, measured in user units."""

    flow: Flow
    per_j: float
    trunk: list[Step]
    feed: list[Step]
    stems: list[tuple[str, float]]
    node: Node

    def leaving(self, *directions: str) -> float:
        return sum(width for where, width in self.stems if where in directions)


def stem_width(path: list[Step]) -> float:
    """Width of an outflow, after checking that start and end have the same width."""
    rises = [step.x for step in path if step.command == "V"]
    width = abs(rises[1] - rises[0])
    begin, end = path[0].y, path[-2].y
    assert abs(end - begin) == pytest.approx(width, abs=0.03)
    radii = [step.radius for step in path if step.command == "A"]
    assert radii[1] - radii[0] == pytest.approx(width, abs=0.03)
    return width


def measured(run: Run, others: list[Run] | None = None) -> Picture:
    flow = flows.flow_of(run)
    assert flow is not None
    known = [found for found in map(flows.flow_of, others or [run]) if found is not None]
    frame = lanes.frame(known)
    node = documents.read(sankey.draw(flow, frame, "picture", "Energy flow"))
    trunks = [documents.steps(path.attributes["d"]) for path in node.all("path", "trunk")]
    stems = []
    for path in node.all("path", "exit"):
        fill = path.attributes["fill"].removesuffix(")")
        stems.append((fill.rpartition("-")[2], stem_width(documents.steps(path.attributes["d"]))))
    return Picture(flow, frame.per_j, trunks[0], trunks[1] if len(trunks) > 1 else [], stems, node)


def drawn_width(picture: Picture) -> float:
    """Width of the upper lane at the battery: from its inner edge up to its outer one."""
    first, second = picture.trunk[:2]
    assert (first.command, second.command) == ("M", "V")
    return first.y - second.y


def turned_width(picture: Picture) -> float:
    outer, inner = (step.radius for step in picture.trunk if step.command == "A")
    return outer - inner


def returned_width(picture: Picture) -> float:
    """Width of the lower lane where its arrow begins, 0 without an arrow."""
    shoulder = next(
        (place for place, step in enumerate(picture.trunk) if step.command == "v"), None
    )
    if shoulder is None:
        return 0.0
    end = picture.trunk[shoulder + 3]
    assert end.command == "V"
    return picture.trunk[shoulder - 1].y - end.y


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_inflow_equals_outflow_in_both_lanes(strategy: str) -> None:
    picture = measured(drive(strategy), three())
    turned = turned_width(picture)
    assert drawn_width(picture) == pytest.approx(picture.leaving("up") + turned, abs=HALF_PX)
    assert turned == pytest.approx(picture.leaving("down") + returned_width(picture), abs=HALF_PX)
    assert turned > 10.0


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_width_is_proportional_to_its_energy(strategy: str) -> None:
    run, runs = drive(strategy), three()
    picture = measured(run, runs)
    assert picture.per_j == measured(runs[0], runs).per_j
    energy = run.summary["energy_j"]
    for width, energy_j in (
        (drawn_width(picture), energy["traction"]),
        (turned_width(picture), energy["braking_at_wheels"]),
        (returned_width(picture), energy["battery_returned"]),
    ):
        assert width == pytest.approx(energy_j * picture.per_j, abs=0.05)
    parts = [*picture.flow.upper, *picture.flow.road, *picture.flow.lower]
    assert len(parts) == len(picture.stems)
    for part, (_, width) in zip(parts, picture.stems, strict=True):
        assert width == pytest.approx(part.energy_j * picture.per_j, abs=0.03)


def test_a_battery_that_supplies_braking_is_a_source_of_the_losses() -> None:
    run = drive("parallel_ratio")
    run.summary["while_braking_j"]["copper"] += 9000.0
    run.summary["energy_j"]["battery_returned"] -= 9000.0
    picture = measured(run)
    fed = picture.feed[1].y - picture.feed[0].y
    assert fed == pytest.approx(
        -run.summary["energy_j"]["battery_returned"] * picture.per_j, abs=0.05
    )
    assert fed == pytest.approx(picture.leaving("feed"), abs=HALF_PX)
    assert turned_width(picture) == pytest.approx(picture.leaving("down"), abs=HALF_PX)
    assert returned_width(picture) == 0.0


def test_zero_returned_energy_has_no_arrow_and_the_diagram_balances() -> None:
    run = drive("series_optimal")
    returned = run.summary["energy_j"]["battery_returned"]
    run.summary["while_braking_j"]["hydraulic"] += returned
    run.summary["energy_j"] |= {"battery_returned": 0.0}
    picture = measured(run)
    assert returned_width(picture) == 0.0
    assert turned_width(picture) == pytest.approx(picture.leaving("down"), abs=HALF_PX)


def test_a_stop_is_one_lane_from_kinetic_energy_to_the_battery() -> None:
    run = drive("parallel_free_travel")
    run.summary["while_driving_j"] = dict.fromkeys(run.summary["while_driving_j"], 0.0)
    work = run.summary["energy_j"]["braking_at_wheels"]
    run.summary["energy_j"] |= {
        "traction": 0.0,
        "drag": 500.0,
        "rolling": 3000.0,
        "stored_kinetic": -work - 3500.0,
    }
    picture = measured(run)
    first, second = picture.trunk[:2]
    assert first.x == lanes.RIGHT
    width = next(step.y for step in picture.trunk if step.command == "V") - first.y
    assert second.x == lanes.RIGHT
    assert width == pytest.approx((work + 3500.0) * picture.per_j, abs=0.05)
    assert width == pytest.approx(picture.leaving("down") + returned_width(picture), abs=HALF_PX)


@pytest.mark.parametrize("bearing_j", [0.0, 6000.0])
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_labels_and_leader_lines_stay_inside_and_leader_lines_do_not_touch(
    strategy: str, bearing_j: float
) -> None:
    run = drive(strategy)
    run.summary["while_driving_j"]["bearing"] = bearing_j
    run.summary["energy_j"]["traction"] += bearing_j
    picture = measured(run)
    for direction in ("up", "down"):
        places = []
        for path in picture.node.all("path", "exit"):
            if direction in path.attributes["fill"]:
                rises = [
                    step.x for step in documents.steps(path.attributes["d"]) if step.command == "V"
                ]
                places.append((min(rises[:2]), max(rises[:2])))
        places.sort()
        assert places[0][0] > lanes.LEFT and places[-1][1] < lanes.WIDTH
        for (_, right), (left, _) in pairwise(places):
            assert left - right > 2.0


def test_lower_labels_alternate_between_two_rows_if_one_is_too_narrow() -> None:
    parts = tuple(flows.Part(f"part {place}", 100.0, "loss") for place in range(8))
    for lower, rows in ((parts, 2), (parts[:4], 1)):
        work = 1000.0 + flows.total(lower)
        motion = (flows.Part("motion", work, "motion"),)
        flow = flows.Flow(0.0, (), (), motion, 0.0, lower, 1000.0, work, split=True, net=True)
        node = documents.read(sankey.draw(flow, lanes.frame([flow]), "picture", "Energy flow"))
        places: dict[str, list[float]] = {}
        for label in node.all("text"):
            if label.words().startswith("part"):
                places.setdefault(label.attributes["y"], []).append(float(label.attributes["x"]))
        assert len(places) == rows
        for row in places.values():
            assert len(row) == 4
            assert all(after - before >= lanes.NARROW for before, after in pairwise(sorted(row)))


def test_the_diagram_has_a_text_alternative() -> None:
    picture = measured(drive("series_optimal"))
    svg = picture.node.all("svg")[0]
    assert svg.attributes["role"] == "img"
    named = {node.attributes["id"]: node for node in picture.node.all() if "id" in node.attributes}
    title, description = (named[identity] for identity in svg.attributes["aria-labelledby"].split())
    assert title.words() == "Energy flow"
    for word in ("155 kJ from the battery", "iron 16.2 kJ", "rolling", "back into the cells"):
        assert word in description.words()
