# SPDX-License-Identifier: Apache-2.0
"""The three strategies on one cycle, side by side: runs in parallel, page and summary."""

import os
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

from regen_table.schema import Drive
from rich.progress import Progress, TaskID

from hubsim import files, report, run
from hubsim.errors import HubsimError
from hubsim.run import course, evaluation, stops
from hubsim.run.results import (
    SIGNAL_POINTS_MAX,
    RunResult,
    as_json,
    criteria_object,
    realtime_factor,
)
from hubsim.scenario import Scenario, cycles
from hubsim.words import counted

PAGE, SUMMARY = "index.html", "summary.json"
SIGNALS = (*report.SIGNALS, *course.SIGNALS)


def check_output(directory: Path) -> None:
    """Make the directory, or refuse before any work is done."""
    files.make_directory(directory)
    for name in (PAGE, SUMMARY):
        files.check_writable(directory / name)


def recorded(scenario: Scenario, beside: Path) -> Scenario:
    """Return the scenario with the finest recording interval that the page can show.

    A whole number of milliseconds.
    """
    duration_s = scenario.max_duration_s
    if scenario.cycle is not None:
        duration_s = min(
            duration_s, cycles.load(scenario.cycle, beside).duration_s * scenario.repeats
        )
    interval_ms = duration_s * 1e3 // (SIGNAL_POINTS_MAX - 1) + 1
    return scenario.model_copy(update={"record_interval_s": interval_ms * 1e-3})


def simulate_all(
    name: str,
    drives: Sequence[Drive],
    scenario: Scenario,
    beside: Path,
    plant: dict[str, float],
    bar: Progress,
    date: str | None = None,
) -> list[RunResult]:
    """Run all drives at the same time, as many as there are cores.

    Results in the order of the drives.
    """
    shown = recorded(scenario, beside)

    stop = threading.Event()

    def one(drive: Drive, task: TaskID) -> RunResult:
        def progress(now_s: float, planned_s: float) -> None:
            if stop.is_set():
                raise HubsimError(f"{name}, {drive.brake.strategy}: stopped at {now_s:g} s")
            bar.update(task, completed=int(now_s), total=int(planned_s))

        result = run.simulate(name, drive, shown, beside, SIGNALS, plant, progress, date=date)
        evaluated = evaluation.evaluate(scenario, drive, result)
        return replace(
            result,
            criteria=[outcome.as_object() for outcome in evaluated],
            observed=course.observed(result, scenario),
        )

    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        waiting = [
            pool.submit(partial(one, drive, bar.add_task(drive.brake.strategy, total=None)))
            for drive in drives
        ]
        try:
            return [future.result() for future in waiting]
        except BaseException:  # one run failed or was interrupted: the others stop
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise


def not_met(results: Sequence[RunResult]) -> list[str]:
    """Return the criteria that were not met."""
    return [
        f"{result.strategy}: {criterion['name']}"
        for result in results
        for criterion in result.criteria
        if not criterion["passed"]
    ]


def extras(drives: Sequence[Drive], bar: Progress) -> report.Extras:
    """Simulate the stops and compute the map that the page shows besides the cycle."""
    task = bar.add_task("stops", total=len(drives) * len(stops.DEMANDS_NM))
    curves = stops.simulate(drives, progress=lambda: bar.advance(task))
    return report.Extras({drives[0].name: stops.optimum_map(drives[0])}, curves)


def write(
    results: Sequence[RunResult], directory: Path, beside: report.Extras | None = None
) -> list[str]:
    """Write page and summary; return the lines for the user."""
    factor = realtime_factor(results)
    runs = [
        {"provenance": result.origin} | result.run_object | criteria_object(result)
        for result in results
    ]
    summary = {"provenance": results[0].origin, "runs": runs, "realtime_factor": factor}
    report.write_report(list(results), directory, beside)
    files.write_text(directory / SUMMARY, as_json(summary))
    return [
        f"{counted(results[0].wheels, 'wheel')} at {factor:.0f} times real time on one core",
        f"report: {directory / PAGE}",
        f"summary: {directory / SUMMARY}",
    ]
