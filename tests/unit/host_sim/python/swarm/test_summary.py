# SPDX-License-Identifier: Apache-2.0
"""What many records come to."""

from typing import Any

import pytest
from hubsim.swarm import summary, work


def finding(share: float | None, **changes: Any) -> dict[str, Any]:  # noqa: ANN401
    found = {"invariant": "current", "wheel": 0, "time_s": 1.5, "value": 0.5, "limit": 1.0,
             "unit": "A", "text": "", "share": share}  # fmt: skip
    return found | changes


def record(seed: int, kind: str = "", **changes: Any) -> dict[str, Any]:  # noqa: ANN401
    return {"seed": seed, "config": "lu2013", "drive": "a drive", "kind": kind,
            "image_crc32": "0x12345678", "worst": {}, "violations": [], "coverage": [],
            "cpu_s": 0.5} | changes  # fmt: skip


RECORDS = [
    record(7, "hall_a_low", worst={"current": finding(0.5)}, coverage=["a b", "a c"]),
    record(3, "hall_b_low", worst={"current": finding(2.0, value=2.0)}, coverage=["a c", "b c"],
           violations=[finding(2.0, value=2.0)]),
    record(5, worst={"stored_share": finding(0.4, value=0.004)},
           violations=[finding(None, invariant="warning", value=12.0, limit=0.0, unit="ms",
                               text="FLUX_WEAK")]),
    record(4, worst={"stored_share": finding(0.2, value=0.002)}),
]  # fmt: skip


def test_the_object_of_json() -> None:
    found = summary.summed(RECORDS, "abc123+", {3: "seed3.toml"})
    assert list(found) == ["schema", "commit", "dirty", "runs", "healthy", "violations", "worst",
                           "coverage", "cpu_s"]  # fmt: skip
    assert (found["commit"], found["dirty"], found["runs"]) == ("abc123", True, 4)
    assert found["healthy"] == {"runs": 2, "warnings": 1, "worst_share_gap": 0.004}
    assert found["violations"] == [
        {"seed": 3, "invariant": "current", "wheel": 0, "time_s": 1.5, "value": 2.0, "limit": 1.0,
         "unit": "A", "image_crc32": "0x12345678", "kind": "hall_b_low", "scenario": "seed3.toml"},
        {"seed": 5, "invariant": "warning", "wheel": 0, "time_s": 1.5, "value": 12.0, "limit": 0.0,
         "unit": "ms", "image_crc32": "0x12345678", "kind": "FLUX_WEAK", "scenario": None},
    ]  # fmt: skip
    assert found["worst"]["current"] == {"value": 2.0, "limit": 1.0, "unit": "A", "seed": 3}
    assert found["coverage"] == {"seen": 3, "possible": work.possible()}
    assert found["cpu_s"] == pytest.approx(2.0)


def test_the_order_in_which_runs_are_done_does_not_matter() -> None:
    assert summary.summed(RECORDS, "a", {}) == summary.summed(RECORDS[::-1], "a", {})


def test_what_is_said() -> None:
    lines = summary.lines(summary.summed(RECORDS, "abc123", {}))
    assert lines[0] == "seed 3, wheel 0, 1.500 s: current 2 of 1 A (hall_b_low)"
    assert lines[2] == "4 runs, 2 with a violation; current 1; warning 1"
    assert "2 runs, 1 with a warning, stored share at most 0.40 %" in lines[3]


def test_a_gap_without_a_number_is_unknown_and_the_worst() -> None:
    gap = {"stored_share": finding(None, value=None)}
    found = summary.summed([*RECORDS, record(9, worst=gap)], "a", {})
    assert found["healthy"]["worst_share_gap"] is None
    assert found["worst"]["stored_share"]["seed"] == 9
    assert "unknown" in summary.lines(found)[3]


def test_pairs_that_are_possible_are_more_than_any_run_can_see() -> None:
    assert work.possible() > 1000
