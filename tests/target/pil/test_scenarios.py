# SPDX-License-Identifier: Apache-2.0
"""Every built-in scenario as a whole: all signals and the figures of --json, bit for bit."""

import pytest
import times
from hubsim import emulator, scenario
from test_pil import assert_same, simulated

LONG_S = 0.05
SHORT_S = 0.001


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_the_emulated_run_is_the_hosts(name: str) -> None:
    interval_s = LONG_S if scenario.load(name, {})[1].follows else SHORT_S
    given = f"record_interval_s={interval_s}"
    spent = [times.spent_s()]
    here = simulated(name, None, given)
    spent.append(times.spent_s())
    there = simulated(name, emulator.command(), given)
    spent.append(times.spent_s())
    assert_same(here, there)
    times.note(name, float(here.rows[-1, here.names.index("time_s")]), spent)
