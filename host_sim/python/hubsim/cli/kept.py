# SPDX-License-Identifier: Apache-2.0
"""The kept share (``unguarded``) of the urban cycles as ``hubsim sim`` shows it."""

import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np
from regen_table.schema import Drive
from rich.progress import Progress, TaskID

from hubsim import run, scenario
from hubsim.errors import HubsimError
from hubsim.run import stops, unguarded
from hubsim.run.results import RunResult

BESIDE = {"ece15": "udds"}  # the longer cycle that goes with the one of the comparison
LEAST = 0.99
CRITERION = "kept_share"
RECORD_S = 0.05
CHUNK_S = 10.0


def one_wheel(
    drive: Drive,
    name: str,
    plant: Mapping[str, float],
    bar: Progress,
    task: TaskID,
    stop: threading.Event,
) -> float:
    """Return what a drive keeps of the ideal on a built-in scenario.

    One wheel with its share of the vehicle stands for all of them: the share is the same (stops).
    """
    _, chosen, beside = scenario.load(name, {"record_interval_s": RECORD_S}, drive)
    engine, planned_s = run.prepare(drive, chosen, beside, dict(plant))
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(unguarded.SIGNALS)
        parts = []
        while (now_s := engine.value("time_s")) < planned_s - RECORD_S:
            if stop.is_set():
                raise HubsimError(f"{name}: stopped at {now_s:g} s")
            bar.update(task, completed=int(now_s), total=int(planned_s))
            parts.append(engine.run(min(planned_s - now_s, CHUNK_S)))
        returned_j = -engine.value("braking.chemical_j")
    signals = dict(zip(unguarded.SIGNALS, np.concatenate(parts).T, strict=True))
    return unguarded.kept_share(drive, signals, returned_j, 1)


@contextmanager
def meanwhile(
    drives: Sequence[Drive], name: str, plant: Mapping[str, float], bar: Progress
) -> Iterator[dict[str, Future[float]]]:
    """Run the longer cycle of a built-in scenario, if it has one, beside what the caller does.

    The one of the drives that has the series brake.
    """
    drive = next(drive for drive in drives if drive.brake.strategy == "series_optimal")
    stop = threading.Event()
    with ThreadPoolExecutor(max_workers=1) as pool:
        cycles = [BESIDE[name]] if name in BESIDE else []
        tasks = {cycle: bar.add_task(cycle, total=None) for cycle in cycles}
        try:
            yield {
                cycle: pool.submit(one_wheel, drive, cycle, plant, bar, task, stop)
                for cycle, task in tasks.items()
            }
        except BaseException:  # the caller failed or was interrupted
            stop.set()
            raise


def of_results(results: Sequence[RunResult]) -> dict[str, float]:
    """Return the share of the series brake where its scenario has that criterion, by cycle."""
    return {
        result.cycle: criterion["value"]
        for result in results
        if result.strategy == "series_optimal"
        for criterion in result.criteria
        if criterion["name"] == CRITERION
    }


def line(shares: Mapping[str, float]) -> str:
    """Return the sentence about the shares."""
    found = ", ".join(f"{100.0 * share:.2f} % on {name}" for name, share in shares.items())
    return (
        f"series_optimal returns {found} of what braking that only physics bounds returns (at "
        f"least {100.0 * LEAST:.0f} %)"
    )
