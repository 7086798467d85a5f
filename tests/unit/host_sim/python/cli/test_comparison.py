# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path

import pytest
from hubsim import run, scenario
from hubsim.cli import comparison, console
from hubsim.errors import HubsimError
from regen_table import schema
from regen_table.schema import Drive
from rich.progress import Progress

ENERGIES = {
    "traction",
    "braking_at_wheels",
    "battery_returned",
    "hydraulic",
    "copper",
    "iron",
    "inverter",
    "battery",
}


@pytest.fixture
def hop(tmp_path: Path) -> Path:
    (tmp_path / "hop.csv").write_text(
        "time_s,speed_km_h\n0,0\n5,20\n9,20\n14,0\n15,0\n", encoding="utf-8"
    )
    (tmp_path / "hop.toml").write_text('cycle = "hop.csv"\n', encoding="utf-8")
    return tmp_path / "hop.toml"


def drives(drive: Drive) -> list[Drive]:
    out = []
    for strategy in run.STRATEGIES:
        data = drive.model_dump()
        data["brake"]["strategy"] = strategy
        out.append(schema.parse(data, drive.name, "test"))
    return out


def test_page_and_summary_are_written_and_the_summary_has_the_documented_keys(
    drive: Drive, hop: Path, tmp_path: Path
) -> None:
    name, loaded, beside = scenario.load(str(hop), {})
    output = tmp_path / "report"
    comparison.check_output(output)
    results = comparison.simulate_all(
        name, drives(drive), loaded, beside, {}, Progress(disable=True)
    )
    lines = comparison.write(results, output)
    assert sorted(path.name for path in output.iterdir()) == ["index.html", "summary.json"]
    summary = json.loads((output / "summary.json").read_text(encoding="utf-8"))
    assert set(summary) == {"provenance", "runs", "realtime_factor"}
    assert summary["realtime_factor"] > 0.0
    factor = f"{summary['realtime_factor']:.0f}"
    assert lines[0] == f"4 wheels at {factor} times real time on one core"
    assert [r["strategy"] for r in summary["runs"]] == [
        "parallel_ratio",
        "parallel_free_travel",
        "series_optimal",
    ]
    for r in summary["runs"]:
        assert set(r) == {
            "provenance",
            "cycle",
            "strategy",
            "energy_j",
            "residual_relative",
            "braking_share_stored",
        }
        assert set(r["energy_j"]) == ENERGIES
        assert r["cycle"] == "hop"
        assert r["braking_share_stored"] == pytest.approx(
            r["energy_j"]["battery_returned"] / r["energy_j"]["braking_at_wheels"]
        )
        assert r["residual_relative"] < 1e-4


def test_runs_of_a_comparison_equal_single_runs(drive: Drive, hop: Path) -> None:
    name, loaded, beside = scenario.load(str(hop), {})
    together = comparison.simulate_all(
        name, drives(drive), loaded, beside, {}, Progress(disable=True)
    )
    for one, result in zip(drives(drive), together, strict=True):
        alone = run.simulate(
            name, one, comparison.recorded(loaded, beside), beside, comparison.SIGNALS
        )
        assert alone.rows.tobytes() == result.rows.tobytes()
        assert alone.account_j == result.account_j


def test_the_page_contains_at_most_the_displayable_number_of_points(drive: Drive) -> None:
    for name in ("ece15", "udds"):
        _, loaded, beside = scenario.load(name, {})
        shown = comparison.recorded(loaded, beside)
        duration_s = {"ece15": 195.0, "udds": 1369.0}[name]
        assert duration_s / shown.record_interval_s + 1 <= 4000
        assert duration_s / (shown.record_interval_s - 0.001) + 1 > 4000


def test_the_table_relates_the_strategies_to_the_series_optimum(drive: Drive, hop: Path) -> None:
    name, loaded, beside = scenario.load(str(hop), {})
    results = comparison.simulate_all(
        name, drives(drive), loaded, beside, {}, Progress(disable=True)
    )
    table = console.energy_table(results)
    headings = [str(column.header) for column in table.columns]
    assert headings == ["", *run.STRATEGIES]
    first_column = list(table.columns[0].cells)
    assert "share of braking work stored" in first_column
    assert (
        list(table.columns[3].cells)[first_column.index("share of the series optimum")] == "100.0 %"
    )


def test_unwritable_output_is_refused_before_the_run(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(HubsimError, match="cannot be made"):
        comparison.check_output(tmp_path / "file")
