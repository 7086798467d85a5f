# SPDX-License-Identifier: Apache-2.0
"""The README's table of the ports against a report."""

from __future__ import annotations

from typing import Any

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
        "memory": {
            "flash": 117000,
            "ram": 31000,
            "recordings": 8192,
            "stack": 2500,
            "modules": {"app": (14000, 14200), "foc": (10900, 0)},
        },
    }
    found["rows"] = {**ports.ride_rows(found), **ports.memory_rows(found["memory"])}
    return found


def test_the_table_has_a_column_for_each_port_and_is_written_between_its_marks() -> None:
    text = ports.updated(
        f"before\n{ports.BEGINS}of another time\n{ports.ENDS}after\n", {"x": port(1200)}
    )
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "another time" not in text
    assert "| PWM interrupt, cycles, warm: worst | 1100 to 1200 |" in text
    assert "| bytes of flash; of RAM without black box and scope | 117000, 22808 |" in text
    assert "| 31.9 %, 40.7 % |" in text
    assert "| PWM interrupt, cycles, warm: worst, stop | 1000 to 1150 |" in text
    assert "| bytes of stack, by analysis | 2500 |" in text
    assert "| bytes of flash, RAM: `app` | 14000, 14200 |" in text
    assert ports.updated(text, {"x": port(1200)}) == text


def test_the_readme_has_the_table_of_both_ports() -> None:
    table = ports.README.read_text().partition(ports.BEGINS)[2].partition(ports.ENDS)[0]
    assert all(name in table for name in (*ports.PORTS, *port(1200)["rows"]))
