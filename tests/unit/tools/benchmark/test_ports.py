# SPDX-License-Identifier: Apache-2.0
"""The README's table of the ports against a report."""

from __future__ import annotations

from typing import Any

import pytest
from benchmark import ports


def port(worst: int) -> dict[str, Any]:
    """Figures of one port; worst: cycles of its longest PWM interrupt, warm."""
    counts = {"median": 300, "max": 800}
    found: dict[str, Any] = {
        "config": "lu2013",
        "instructions": counts,
        "cycles": {
            "pwm_interrupt": {
                "least": {"median": 700, "max": worst - 100},
                "most": {"median": 780, "max": worst},
                "cold": {"median": 1000, "max": 1700},
            },
            "millisecond_interrupt": {
                "least": {"median": 14000, "max": 18000},
                "most": {"median": 16000, "max": 21000},
                "cold": {"median": 20000, "max": 27000},
            },
            "load_warm": 0.319,
            "load_cold": 0.407,
        },
        "other_rides": {"stop": {"least": 1000, "most": 1150}},
        "memory": size(),
    }
    found["rows"] = {**ports.ride_rows(found), **ports.memory_rows(found["memory"])}
    return found


def size(flash: int = 117000, stack: int = 2500, app: int = 14000) -> dict[str, Any]:
    """Memory of an image."""
    modules = {"app": (app, 14200), "foc": (10900, 0)}
    return {"flash": flash, "ram": 31000, "black_box": 8192, "stack": stack, "modules": modules}


def test_the_table_has_a_column_for_each_port_and_is_written_between_its_marks() -> None:
    text = ports.updated(
        f"before\n{ports.BEGINS}of another time\n{ports.ENDS}after\n", {"x": port(1200)}
    )
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "another time" not in text
    assert "| PWM interrupt, cycles, warm: worst | 1100 to 1200 |" in text
    assert "| bytes of flash; of RAM without the black box | 117000, 22808 |" in text
    assert "| 31.9 %, 40.7 % |" in text
    assert "| PWM interrupt, cycles, warm: worst, stop | 1000 to 1150 |" in text
    assert "| bytes of stack, by analysis | 2500 |" in text
    assert "| bytes of flash, RAM: `app` | 14000, 14200 |" in text
    assert ports.updated(text, {"x": port(1200)}) == text


def test_a_row_is_out_of_date_if_a_figure_deviates_by_more_than_2_percent() -> None:
    text = ports.updated(ports.BEGINS + ports.ENDS, {"x": port(1200)})
    assert ports.out_of_date(text, {"x": port(1210)}) == []
    assert len(ports.out_of_date(text, {"x": port(1300)})) == 1
    assert ports.out_of_date(text, {"x": port(1200), "y": port(1200)}) != []


def test_a_report_without_the_image_has_no_table_of_the_ports(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert ports.status({"compiler": "gcc) 12.2"}, update=False) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("now", "complaints"),
    [
        (size(), 0),
        (size(flash=117500, app=14280), 0),
        (size(flash=117600), 1),
        (size(stack=2508), 1),
        (size(app=14300), 1),
    ],
)
def test_memory_is_out_of_date_if_the_linked_image_has_another(
    now: dict[str, Any], complaints: int
) -> None:
    """Sums by 0.5 %, the stack by a byte, a module by 2 %."""
    text = ports.updated(ports.BEGINS + ports.ENDS, {"x": port(1200)})
    assert len(ports.memory_out_of_date(text, {"x": now})) == complaints


def test_a_port_or_a_module_that_the_table_lacks_is_out_of_date() -> None:
    text = ports.updated(ports.BEGINS + ports.ENDS, {"x": port(1200)})
    assert len(ports.memory_out_of_date(text, {"y": size()})) == 4
    more = size()
    more["modules"]["new"] = (1, 1)
    assert len(ports.memory_out_of_date(text, {"x": more})) == 1


def test_the_readme_has_the_table_of_both_ports() -> None:
    table = ports.README.read_text().partition(ports.BEGINS)[2].partition(ports.ENDS)[0]
    assert all(name in table for name in (*ports.PORTS, *port(1200)["rows"]))
