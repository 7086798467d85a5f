# SPDX-License-Identifier: Apache-2.0
"""How a sweep scales with workers: the same stops on one worker and on more, within one call.

    ./tools/dev python tools/benchmark/sweep_scaling.py --runs 1000

Needs the engine, which any ./tools/dev hubsim or sim builds. Throughput is counted from the first
finished batch on, so that starting the workers, a second or two in either case, is told apart. The
ratio means something on a machine that does nothing else.
"""

import argparse
import json
import os
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from hubsim.cli import DEFAULT_CONFIG
from hubsim.sweep import conduct, plan, store, work


@dataclass(frozen=True)
class Measured:
    """One sweep: runs, wall time until the last, and runs a second after the first batch."""

    workers: int
    runs: int
    seconds: float
    runs_per_second: float


def measure(runs: int, workers: int, output: Path) -> Measured:
    """Sweep a stop over demands from 5 to 120 N m."""
    planned = plan.make([f"demand_nm=range(5,120,{runs})"], None, 1)
    job = work.Job("stop", DEFAULT_CONFIG, None, (), ())
    seen: list[tuple[float, int]] = []
    begin = time.perf_counter()

    def progress(done: int, _: int) -> None:
        if done:
            seen.append((time.perf_counter() - begin, done))

    conduct.conduct(job, planned, store.Store(output, {}, "scaling"), None, workers, progress)
    (first_s, first_done), (last_s, last_done) = seen[0], seen[-1]
    return Measured(
        workers,
        runs,
        last_s,
        (last_done - first_done) / (last_s - first_s) if last_s > first_s else float("nan"),
    )


def main() -> int:
    """Measure, print, and check that both tables are equal."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--runs", type=int, default=200, metavar="N", help="stops a sweep, at least 8; default: 200"
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=os.cpu_count() or 2,
        metavar="N",
        help="beside one; default: all cores",
    )
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    options = parser.parse_args()
    if options.runs < 2 * conduct.BATCH_RUNS or options.workers < 1:
        parser.error(f"accepted: --runs from {2 * conduct.BATCH_RUNS}, --workers from 1")
    with tempfile.TemporaryDirectory() as directory:
        outputs = [Path(directory) / f"{workers}.parquet" for workers in (1, options.workers)]
        one, more = (
            measure(options.runs, workers, path)
            for workers, path in zip((1, options.workers), outputs, strict=True)
        )
        same = outputs[0].read_bytes() == outputs[-1].read_bytes()
    found = {
        "one": asdict(one),
        "more": asdict(more),
        "ratio": more.runs_per_second / one.runs_per_second,
        "same_table": same,
    }
    if options.json:
        print(json.dumps(found, indent=2))
    else:
        for sweep in (one, more):
            print(
                f"{sweep.workers} worker(s): {sweep.runs} stops in {sweep.seconds:.1f} s,"
                f" {sweep.runs_per_second:.2f} a second"
            )
        print(
            f"ratio {found['ratio']:.2f}; 1000 stops on {more.workers}:"
            f" {1000.0 / more.runs_per_second:.0f} s; same table: {same}"
        )
    return 0 if same else 1


if __name__ == "__main__":
    raise SystemExit(main())
