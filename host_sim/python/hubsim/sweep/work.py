# SPDX-License-Identifier: Apache-2.0
"""Some runs of a sweep, done in the calling process, a row for each."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from regen_table import installation
from regen_table.errors import ConfigurationError
from regen_table.schema import Drive

from hubsim import configuration, run, scenario
from hubsim.errors import HubsimError
from hubsim.run import evaluation
from hubsim.run.results import RunResult
from hubsim.scenario import Scenario, expression, overrides

Row = dict[str, Any]
ENERGIES = (
    "traction",
    "braking_at_wheels",
    "battery_returned",
    "hydraulic",
    "copper",
    "iron",
    "inverter",
    "battery",
)


@dataclass(frozen=True)
class Job:
    """What all runs of a sweep have in common."""

    scenario: str
    config: Path
    strategy: str | None
    settings: tuple[str, ...]
    collect: tuple[tuple[str, str], ...]  # column, formula

    def prepared(
        self, point: Mapping[str, Any]
    ) -> tuple[str, Scenario, Path, Drive, dict[str, float]]:
        """Read and check everything that one run needs."""
        settings = overrides.parse(self.settings)
        for key, value in point.items():
            overrides.put(settings, key, value)
        name, chosen, beside = scenario.load(
            self.scenario, settings.scenario, _plain_drive(self.config), settings.drive
        )
        if self.strategy is not None:
            settings.drive["brake", "strategy"] = self.strategy
        return name, chosen, beside, _drive(self.config, chosen, settings), settings.plant


def _drive(config: Path, chosen: Scenario, settings: overrides.Overrides) -> Drive:
    """Read a drive.

    Runs that change nothing about it share one, and with it the tables made from it.
    """
    if settings.drive or chosen.drive:
        return overrides.load_drive(config, settings, chosen)
    return _plain_drive(config)


@lru_cache(maxsize=4)
def _plain_drive(config: Path) -> Drive:
    return overrides.load_drive(config, overrides.Overrides())


def origin(job: Job, seed: int, date: str | None) -> dict[str, Any]:
    """Return the provenance of a sweep: that of its drive as the file has it, and its own seed."""
    drive = _plain_drive(job.config)
    name = Path(job.scenario).stem
    return installation.provenance(
        drive.name, configuration.image_of(drive), scenario=name, seed=seed, date=date
    )


def check(job: Job, point: Mapping[str, Any]) -> None:
    """Refuse a sweep whose very first run could not be set up."""
    _, chosen, beside, drive, plant = job.prepared(point)
    vehicle, _ = run.prepare(drive, chosen, beside, plant)
    with vehicle:
        vehicle.start()
        known = vehicle.signals()
    for column, text in job.collect:
        try:
            evaluation.signals_named(
                expression.read(text).names, known, evaluation.scalars(chosen, drive, known)
            )
        except expression.ExpressionError as error:
            raise HubsimError(f"--collect {column}: {error}") from error
    evaluation.signals_of(chosen, drive, known)


def do(job: Job, numbers: Sequence[int], points: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Do some runs and return a row for each.

    A run that cannot be done leaves its reason in the row.
    """
    return [_row(job, number, point) for number, point in zip(numbers, points, strict=True)]


def _row(job: Job, number: int, point: Mapping[str, Any]) -> Row:
    row: Row = {
        "run": number,
        **{
            key: value if isinstance(value, bool | int | float | str) else str(value)
            for key, value in point.items()
        },
    }
    try:
        name, chosen, beside, drive, plant = job.prepared(point)
        result = run.simulate(
            name, drive, chosen, beside, (), plant, formulas=[text for _, text in job.collect]
        )
        evaluated = evaluation.evaluate(chosen, drive, result)
        row |= {
            column: evaluation.Evaluator(result, chosen, drive).single(text)
            for column, text in job.collect
        }
    except (
        HubsimError,
        ConfigurationError,
        expression.ExpressionError,
        expression.EmptyWindow,
    ) as error:
        return row | {"error": str(error) or "nothing recorded"}
    return row | _figures(result) | _criteria(evaluated)


def _figures(result: RunResult) -> Row:
    found = result.run_object
    out: Row = {"error": None, "strategy": result.strategy}
    out |= {f"{name}_j": found["energy_j"][name] for name in ENERGIES}
    out |= {name: found[name] for name in ("braking_share_stored", "residual_relative")}
    out |= {
        "kinetic_energy_j": result.kinetic_energy_j,
        "duration_s": result.duration_s,
        "distance_m": result.distance_m,
    }
    out |= {"soc_final": result.soc[1], "stopped": result.stopped, "faults": len(result.faults)}
    return out | {"first_fault": result.faults[0].reason if result.faults else None}


def _criteria(evaluated: Sequence[evaluation.CriterionResult]) -> Row:
    out: Row = {
        f"criteria.{v.name}": v.value if math.isfinite(v.value) else None for v in evaluated
    }
    return out | (
        {
            "passed": all(v.passed for v in evaluated),
            "failed": ",".join(v.name for v in evaluated if not v.passed),
        }
        if evaluated
        else {}
    )
