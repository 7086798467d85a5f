# SPDX-License-Identifier: Apache-2.0
"""Every built-in scenario as a whole: all signals and the figures of --json, bit for bit."""

import pytest
from hubsim import emulator, scenario
from test_pil import assert_same, simulated

LONG_S = 0.05
SHORT_S = 0.001


@pytest.mark.parametrize("name", scenario.builtin_names())
def test_the_emulated_run_is_the_hosts(name: str) -> None:
    interval_s = LONG_S if scenario.load(name, {})[1].follows else SHORT_S
    given = f"record_interval_s={interval_s}"
    assert_same(simulated(name, None, given), simulated(name, emulator.command(), given))
