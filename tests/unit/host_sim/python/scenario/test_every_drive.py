# SPDX-License-Identifier: Apache-2.0
"""Every built-in scenario passes with every drive in tools/motors, or states what the drive lacks.

A run of the tests takes a share of the drives for each scenario, another one for the next scenario;
a long one takes all of them.
"""

import os
from pathlib import Path

import pytest
from hubsim import run, scenario
from hubsim.engine import ROOT
from hubsim.errors import DoesNotApplyError
from hubsim.run import evaluation
from hubsim.scenario import overrides
from regen_table import schema

FILES = sorted(
    path for path in (ROOT / "tools" / "motors").rglob("*.toml") if path.stem != "lu2013"
)  # with that one test_builtin_scenarios.py runs them all
FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
SHARE, STRIDE = 2, 3  # of the drives for each scenario, and to those of the next
SHORTER = {} if FOR_LONG else {"udds": {"max_duration_s": 200.0}}
NOT_LONG = ("ece15", "descent_full")  # one drive each

# What the firmware does not do yet: the criteria that fail, and no others.
KNOWN = {
    ("descent_full", "leaf"): ["charge_limit"],  # 3.0 A into a pack whose limit fades to zero
}
if FOR_LONG:  # 98.7 of 99 %: it brakes with 0.32 N m on average, three steps of the message
    KNOWN["udds", "hoverboard"] = ["kept_share"]
# Written for the tyres, masses or figures of the paper's vehicle alone.
OF_THE_PAPER = {
    *("ice_stop", "low_bus_stop", "mu_jump", "mu_split", "ramp150", "rolling_start_fast"),
}


def chosen() -> list[tuple[str, Path]]:
    """Return the scenarios and drives of this run."""
    pairs = []
    for k, name in enumerate(scenario.builtin_names()):
        count = len(FILES) if FOR_LONG else 1 if name in NOT_LONG else SHARE
        pairs += [(name, FILES[(k * STRIDE + j) % len(FILES)]) for j in range(count)]
    known = [(name, path) for path in FILES for name, drive in KNOWN if path.stem == drive]
    return [*dict.fromkeys([*pairs, *known])]


@pytest.mark.parametrize(
    ("name", "path"), chosen(), ids=[f"{name}-{path.stem}" for name, path in chosen()]
)
def test_a_scenario_passes_or_states_what_the_drive_lacks(name: str, path: Path) -> None:
    drive = schema.load(path)
    try:
        title, fitted, beside = scenario.load(name, SHORTER.get(name, {}), drive)
    except DoesNotApplyError as stated:
        assert stated.needs
        assert f"{name} does not apply to {path.stem}, needs: {stated.needs[0]}" in str(stated)
        return
    assert name not in OF_THE_PAPER
    changed = overrides.load_drive(path, overrides.Overrides(), fitted)
    result = run.simulate(title, changed, fitted, beside, ())
    found = evaluation.evaluate(fitted, changed, result)
    for outcome in found:
        assert outcome.applies or outcome.remark.startswith("does not apply: needs ")
    assert any(outcome.applies for outcome in found)
    failed = [outcome.name for outcome in found if not outcome.passed]
    assert failed == KNOWN.get((name, path.stem), []), found


def test_no_scenario_but_those_of_the_paper_is_for_one_vehicle_alone() -> None:
    vehicles = [schema.load(path) for path in FILES]
    lonely = set()
    for name in scenario.builtin_names():
        fits = 0
        for drive in vehicles:
            try:
                scenario.load(name, {}, drive)
                fits += 1
            except DoesNotApplyError:
                pass
        if fits < len(vehicles) // 3:
            lonely.add(name)
    assert lonely == OF_THE_PAPER
