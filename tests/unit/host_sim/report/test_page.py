# SPDX-License-Identifier: Apache-2.0
import copy
import json
import math
import re
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hubsim.report import page, reading

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.documents import Node
from tests.unit.host_sim.report.ideal_vehicle import STRATEGIES, Run, drive, three

HOSTILE = "<b>&amp; \"x\" 'y' </script><script>alert(1)</script>"


def written(runs: list[Run]) -> Node:
    return documents.read(page.document(runs))


def cells(document: Node) -> dict[str, list[str]]:
    """Texts of the energy table's numbers by the name of their row."""
    rows = {}
    named = [t for t in document.all("table") if t.all("caption")[0].words().startswith("Energies")]
    for row in named[0].all("tr"):
        names = row.all("span", "name")
        if names:
            rows[names[0].words()] = [cell.words() for cell in row.all("td")]
    return rows


def test_the_table_contains_every_energy_of_every_strategy_in_kilojoules() -> None:
    runs = three()
    table = cells(written(runs))
    for row, key in {
        "Traction": "traction",
        "Braking work at the wheels": "braking_at_wheels",
        "Returned to the battery": "battery_returned",
        "Hydraulic heat": "hydraulic",
        "Copper loss": "copper",
        "Iron loss": "iron",
        "Inverter loss": "inverter",
        "Battery loss": "battery",
    }.items():
        unit, *values = table[row]
        assert unit == "kJ"
        assert values == [f"{run.summary['energy_j'][key] / 1e3:.2f}" for run in runs]


def test_shares_are_in_per_cent_relative_to_series_optimal() -> None:
    runs = three()
    table = cells(written(runs))
    shares = [run.summary["braking_share_stored"] for run in runs]
    assert table["Share stored"] == ["%", *[f"{100.0 * share:.1f}" for share in shares]]
    returned = [run.summary["energy_j"]["battery_returned"] for run in runs]
    assert table["Share of the series optimum"] == [
        "%",
        *[f"{100.0 * value / returned[2]:.1f}" for value in returned],
    ]
    runs[0].summary["residual_relative"] = 2.5e-7
    assert cells(written(runs))["Residual"][1] == "2.5 · 10⁻⁵"


def test_strategies_are_sorted_by_returned_energy_for_any_input_order() -> None:
    titles = [reading.STRATEGIES[name].title for name in STRATEGIES]
    headings = written(three()[::-1]).all("table")[0].all("thead")[0].all("th")
    assert [heading.words() for heading in headings][2:] == titles


def test_every_cycle_has_a_section_with_its_own_optimum() -> None:
    runs = [*three(), *[drive(strategy, cycle="udds") for strategy in STRATEGIES]]
    for run in runs[3:]:
        run.summary["energy_j"] = {
            name: 2.0 * value for name, value in run.summary["energy_j"].items()
        }
    document = written(runs)
    assert [section.attributes["data-cycle"] for section in document.all("section")] == [
        "ece15",
        "udds",
    ]
    for section in document.all("section"):
        assert cells(section)["Share of the series optimum"][-1] == "100.0"
    targets = {section.attributes["id"] for section in document.all("section")}
    assert {
        link.attributes["href"].removeprefix("#") for link in document.all("nav")[0].all("a")
    } == targets


def test_the_page_loads_no_external_resource() -> None:
    text = page.document(three())
    document = documents.read(text)
    assert not re.search(
        r"https?:|url\((?!#)|@import|//[a-z]", re.sub(r"^ *//.*$", "", text, flags=re.MULTILINE)
    )
    for node in document.all():
        for key in ("src", "href", "srcset", "data", "poster", "action"):
            assert node.attributes.get(key, "#").startswith(("#", "data:,")), (node.tag, key)
    policy = next(
        node
        for node in document.all("meta")
        if node.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy.attributes["content"].startswith("default-src 'none'")


def test_every_reference_inside_the_page_has_exactly_one_target() -> None:
    text = page.document([*three(), drive(cycle="udds")])
    document = documents.read(text)
    identities = Counter(
        node.attributes["id"] for node in document.all() if "id" in node.attributes
    )
    assert max(identities.values()) == 1
    for reference in re.findall(r"url\(#([^)]+)\)", text):
        assert reference in identities
    for node in document.all():
        for identity in node.attributes.get("aria-labelledby", "").split():
            assert identity in identities


def test_pictures_have_titles_and_table_headings_have_scopes() -> None:
    document = written(three())
    pictures = [svg for svg in document.all("svg") if svg.attributes.get("aria-hidden") != "true"]
    assert len(pictures) == 6
    for picture in pictures:
        assert picture.attributes["role"] == "img"
        assert picture.all("title")[0].words() and picture.all("desc")[0].words()
    assert all(heading.attributes.get("scope") in ("col", "row") for heading in document.all("th"))
    assert document.all("html")[0].attributes["lang"] == "en"
    assert document.all("meta")[0].attributes["charset"] == "utf-8"


def test_names_with_special_characters_are_escaped() -> None:
    run = drive()
    run.cycle = run.strategy = run.vehicle = HOSTILE
    run.summary["reason_texts"] = {"1": HOSTILE, "2": HOSTILE}
    document = written([run])
    assert len(document.all("script")) == 4  # the read-out and the data of three pictures
    assert not document.all("b")
    assert HOSTILE in document.all("section")[0].attributes["data-cycle"]
    assert HOSTILE in document.words()
    json.loads(document.all("script")[0].text)


@pytest.mark.parametrize("unknown", [math.nan, math.inf, None, "a lot", True])
def test_values_that_are_no_numbers_are_shown_as_a_dash(unknown: object) -> None:
    run = drive()
    run.summary["energy_j"]["copper"] = unknown
    run.summary["residual_relative"] = unknown
    table = cells(written([run]))
    assert table["Copper loss"] == ["kJ", "–"]
    assert table["Residual"] == ["%", "–"]


def test_a_run_without_signals_and_energies_gives_a_page() -> None:
    run = drive()
    run.summary, run.signals, run.time_s = {}, {}, np.array([])
    document = written([run])
    assert all(cell.words() in ("–", "kJ", "%") for cell in document.all("td"))
    assert "No signals were recorded" in document.words()


def test_zero_and_negative_returned_energies_are_shown_with_their_sign() -> None:
    run = drive("parallel_ratio")
    energy = run.summary["energy_j"]
    lost = energy["battery_returned"]
    run.summary["while_braking_j"]["copper"] += lost
    energy["battery_returned"] = 0.0
    run.summary["braking_share_stored"] = 0.0
    page_without_return = written([run])
    assert cells(page_without_return)["Returned to the battery"] == ["kJ", "0.00"]
    assert "Share of the series optimum" not in cells(page_without_return)  # there is no other run
    energy["battery_returned"] = -4000.0
    run.summary["while_braking_j"]["copper"] += 4000.0
    run.summary["braking_share_stored"] = -4000.0 / energy["braking_at_wheels"]
    less = written([run])
    assert cells(less)["Returned to the battery"] == ["kJ", "−4.00"]
    assert "taken from the cells" in less.words()


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_parts_of_the_braking_work_bar_sum_to_its_length(strategy: str) -> None:
    document = written([drive(strategy)])
    bar = document.all("article", "card")[0].all("svg")[0]
    rectangles = sorted(
        (float(r.attributes["x"]), float(r.attributes["width"])) for r in bar.all("rect")
    )
    assert rectangles[0][0] == 0.0
    for (x, width), (following, _) in pairwise(rectangles):
        assert x + width == pytest.approx(following, abs=0.02)
    assert sum(width for _, width in rectangles) == pytest.approx(100.0, abs=0.03)
    assert bar.attributes["viewbox"] == "0 0 100.00 10"


def test_signal_names_are_accepted_with_dot_underscore_or_short() -> None:
    run = drive()
    short, flat = copy.deepcopy(run), copy.deepcopy(run)
    short.signals = {name.partition(".")[2]: values for name, values in run.signals.items()}
    flat.signals = {name.replace(".", "_"): values for name, values in run.signals.items()}
    assert page.document([short]) == page.document([run]) == page.document([flat])


def test_the_page_of_a_long_noisy_run_is_below_3_megabytes() -> None:
    random = np.random.default_rng(1)
    runs = three()
    for run in runs:
        run.time_s = np.linspace(0.0, 2000.0, 4000)
        run.signals = {
            name: random.normal(0.0, 10.0, 4000) for name in run.signals if name != "wheel0.reason"
        }
        run.signals["wheel0.reason"] = random.integers(0, 21, 4000).astype(np.float64)
    assert len(page.document(runs).encode()) < 3_000_000


def test_equal_runs_give_identical_bytes() -> None:
    assert page.document(three()) == page.document(three())
