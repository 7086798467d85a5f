# SPDX-License-Identifier: Apache-2.0
"""``hubsim swarm``: from its options to its exit status."""

import argparse
import hashlib
import itertools
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from regen_table import installation

from hubsim import configuration, engine, files, progress
from hubsim.cli.arguments import DEFAULT_CONFIG
from hubsim.errors import HubsimError
from hubsim.run.results import as_json
from hubsim.swarm import conduct, draw, summary, text, work
from hubsim.swarm.draw import Case
from hubsim.swarm.reduce import RUNS_MAX, Reduction
from hubsim.swarm.work import Record, Task
from hubsim.sweep.drives import DRIVES

SECONDS_PER_HOUR = 3600.0


def command(options: argparse.Namespace) -> int:
    """Do what the options ask for."""
    _refuse(options)
    if options.reduce is not None:
        return _reduce(options)
    if options.seed is not None:
        return _one(options, _task(options, options.seed))
    if options.scenario is not None:
        return _one(options, _of_file(options))
    return _many(options)


def _refuse(options: argparse.Namespace) -> None:
    """Refuse options that do not go together, and outputs that could not be written."""
    if (options.small is None) != (options.reduce is None):
        raise HubsimError("--reduce N -o S.toml: accepted: both or neither")
    if options.config is not None and options.scenario is None:
        raise HubsimError("--config: accepted: with --scenario")
    single = (options.reduce, options.seed, options.scenario)
    if options.output is not None and any(each is not None for each in single):
        raise HubsimError("--output: accepted: with --seeds or --hours")
    for path in filter(None, (options.small, options.json)):
        files.check_writable(path)


def _task(options: argparse.Namespace, seed: int) -> Task:
    return {"seed": seed, "drives": options.drives, "healthy": options.healthy}


def _of_file(options: argparse.Namespace) -> Task:
    config = options.config or DEFAULT_CONFIG
    if config.stem not in DRIVES:
        raise HubsimError(f"--config {config}: accepted: one of {', '.join(DRIVES)}")
    case = text.read(options.scenario, config.stem)
    return {"seed": case.seed, "config": case.config, "data": case.data}


def _one(options: argparse.Namespace, task: Task) -> int:
    """Make one run and show all that it came to."""
    with progress.shown("runs") as bar:
        bar.add_task("swarm", total=1)
        record = next(conduct.records([task], 1))
    print(f"seed {record['seed']}: {record['drive']}, {record['kind'] or 'no fault'}, image "
          f"{record['image_crc32']}")  # fmt: skip
    for name, found in record["worst"].items():
        limits = f"{summary.number(found['value'])} of {summary.number(found['limit'])}"
        where = "" if found["wheel"] is None else f", wheel {found['wheel']}"
        print(f"  {name}: {limits} {found['unit']} at "
              f"{found['time_s']:.3f} s{where} {found['text']}".rstrip())  # fmt: skip
    return _concluded(options, [record], {})


def _concluded(
    options: argparse.Namespace, records: list[Record], scenarios: dict[int, str]
) -> int:
    whole = summary.summed(records, installation.commit(), scenarios)
    if options.json is not None:
        files.write_text(options.json, as_json(whole))
    print(*summary.lines(whole), sep="\n")
    return 1 if whole["violations"] else 0


def _many(options: argparse.Namespace) -> int:
    until_s = float("inf")
    wanted: Iterable[int] = options.seeds
    if options.hours is not None:
        until_s = time.monotonic() + SECONDS_PER_HOUR * options.hours
        wanted = itertools.count()
    kept = None if options.output is None else conduct.Kept(options.output, _described(options))
    done = {} if kept is None else kept.open()
    if options.hours is None:
        done = {seed: record for seed, record in done.items() if seed in options.seeds}
    tasks = (_task(options, seed) for seed in wanted if seed not in done)
    found = list(done.values())
    try:
        for record in _shown(options, tasks, len(found), until_s):
            if kept is not None:
                kept.put(record)
            found.append(record)
    except KeyboardInterrupt:
        hint = "" if kept is None else "the same command goes on where it stopped"
        raise KeyboardInterrupt(hint) from None
    scenarios = {}
    for record in found if kept is not None else ():
        if record["violations"] and kept is not None:
            scenarios[record["seed"]] = kept.scenario(record["seed"], _text(options, record))
    return _concluded(options, found, scenarios)


def _shown(
    options: argparse.Namespace, tasks: Iterator[Task], done: int, until_s: float
) -> Iterator[Record]:
    """Yield records, the progress shown."""
    workers = options.workers or os.cpu_count() or 1
    timed = options.hours is not None
    began_s = time.monotonic()
    with progress.shown("s" if timed else "runs") as bar:
        total = SECONDS_PER_HOUR * options.hours if timed else len(options.seeds)
        task = bar.add_task("swarm", total=int(total), completed=0 if timed else done)
        for number, record in enumerate(conduct.records(tasks, workers, until_s), done + 1):
            bar.update(task, completed=int(time.monotonic() - began_s) if timed else number)
            yield record


def _described(options: argparse.Namespace) -> dict[str, Any]:
    """Return what a run depends on besides its seed."""
    package = Path(work.__file__).parent
    programs = [path.read_bytes() for path in sorted(package.glob("*.*"))]
    content = (engine.library_path().read_bytes(), *configuration.program(), *programs)
    digest = hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in content))
    return {
        "schema": summary.SCHEMA,
        "commit": installation.commit(),
        "content": digest.hexdigest(),
        "healthy": options.healthy,
        "drives": options.drives,
    }


def _text(options: argparse.Namespace, record: Record) -> str:
    task = _task(options, record["seed"])
    return text.toml_of(work.case_of(task), _description(record["seed"], record["violations"][0]))


def _description(seed: int, violation: dict[str, Any]) -> str:
    value = summary.number(violation["value"])
    return (f"swarm seed {seed}: {violation['invariant']} {value}, right: at most "
            f"{summary.number(violation['limit'])} {violation['unit']}")  # fmt: skip


def _reduce(options: argparse.Namespace) -> int:
    case: Case = draw.case(options.reduce, options.drives, options.healthy or None)
    with progress.shown("runs") as bar, conduct.servers(1) as (server,):
        task = bar.add_task(f"seed {case.seed}", total=RUNS_MAX)

        def run(wanted: Task) -> Record:
            server.begin(wanted)
            found = None
            while found is None:
                found = server.answer()
            bar.advance(task)
            return found

        reduction = Reduction(case, run)
        if reduction.found is None:
            print(f"seed {case.seed} violates nothing")
            return 0
        reduction.go()
    small, found = reduction.case, reduction.found
    files.write_text(options.small, text.toml_of(small, _description(small.seed, found)))
    print(
        f"{_description(small.seed, found)}; {small.kind or 'no fault'}, "
        f"{small.data['max_duration_s']:g} s, {reduction.runs} runs: {options.small}"
    )
    return 1
