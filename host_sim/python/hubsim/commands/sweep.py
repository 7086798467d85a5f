# SPDX-License-Identifier: Apache-2.0
"""``hubsim sweep``: many runs of a scenario with keys that vary, into one table."""

import argparse
import hashlib
import sys
from pathlib import Path

from hubsim import __version__, commands, engine, files, scenario
from hubsim.errors import HubsimError


def main(options: argparse.Namespace) -> int:
    """Do the command and return the exit status."""
    # Dask and Arrow are big; no other command needs them.
    from hubsim.sweep import conduct, plan, store, work  # noqa: PLC0415

    for name, value, least in (
        ("--runs", options.runs, 1),
        ("--workers", options.workers, 1),
        ("--seed", options.seed, 0),
    ):
        if value is not None and value < least:
            raise HubsimError(f"{name} {value}: accepted: a whole number from {least}")
    store.kind_of(options.output)
    files.check_writable(options.output)
    found = plan.make(options.vary, options.runs, options.seed)
    job = work.Job(
        _place(options.scenario),
        options.config.resolve(),
        options.strategy,
        tuple(options.settings),
        _collected(options.collect),
    )
    work.check(job, next(found.points()))
    described = {
        "hubsim": __version__, "scenario": options.scenario, "config": options.config.name,
        "strategy": options.strategy, "set": options.settings, "vary": options.vary,
        "runs": found.runs, "seed": options.seed, "collect": options.collect,
    }  # fmt: skip
    kept = store.Store(
        options.output,
        described,
        plan.fingerprint(described | {"content": _content(options)}),
        work.origin(job, options.seed, options.date),
    )
    if options.restart:
        kept.forget()
    with commands.progress_bar("runs") as bar:
        task = bar.add_task(f"{options.scenario}", total=found.runs)
        try:
            table = conduct.conduct(
                job,
                found,
                kept,
                options.scheduler,
                options.workers,
                lambda done, planned: bar.update(task, completed=done, total=planned),
            )
        except KeyboardInterrupt:
            print("hubsim: interrupted; the same command goes on where it stopped", file=sys.stderr)
            raise
    for line in conduct.summary(table, [v.key for v in found.varied], options.output):
        print(line)
    return 0 if conduct.is_clean(table) else 1


def _place(name: str) -> str:
    """Return the scenario by a name that is the same in any directory."""
    return name if name in scenario.builtin_names() else str(Path(name).resolve())


def _collected(texts: list[str]) -> tuple[tuple[str, str], ...]:
    out = []
    for text in texts:
        column, equals, formula = (part.strip() for part in text.partition("="))
        if not column or not equals or not formula:
            raise HubsimError(f"--collect {text!r}: accepted: COLUMN=FORMULA")
        out.append((column, formula))
    return tuple(out)


def _content(options: argparse.Namespace) -> list[str]:
    """Return what a sweep's result depends on besides its command: files, and the engine itself."""
    path = (
        scenario.DIRECTORY / f"{options.scenario}.toml"
        if options.scenario in scenario.builtin_names()
        else Path(options.scenario)
    )
    return [
        hashlib.sha256(files.read_bytes(file)).hexdigest()
        for file in (path, options.config, engine.library_path())
    ]
