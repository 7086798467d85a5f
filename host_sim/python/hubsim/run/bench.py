# SPDX-License-Identifier: Apache-2.0
"""The simulated vehicle to be driven from Python.

A complete controller in every driven wheel, a battery, a road.

    with hubsim.Bench("tools/motors/lu2013.toml", initial_speed_kmh=40.0, demand_nm=40.0,
    stop_at_standstill=True) as bench:
        recording = bench.run()
    recording["vehicle.speed_m_per_s"], recording.units["vehicle.speed_m_per_s"]

What can be set is a scenario's keys when the bench is made, and any parameter of the simulated
world (``parameters()``) then and at any later time: that is how a pedal moves or a fault happens.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import ValidationError
from regen_table.schema import Drive

from hubsim import configuration, scenario
from hubsim.configuration import Configuration
from hubsim.engine import Engine, Rows, parameters
from hubsim.errors import HubsimError
from hubsim.run import simulation
from hubsim.scenario import keys, overrides

__all__ = ["Bench", "Recording", "parameters"]

CHUNK_S = 10.0
LONGEST_S = 1e4  # of a run without a planned end


class Recording(Mapping[str, Rows]):
    """Recorded signals by name, each an array of shape (rows,).

    ``units`` and ``texts`` say what they are.

    Attributes
    ----------
    rows : array, shape (rows, signals)
        All of them, in the order of the names.
    units : dict
        Unit of each signal: "N.m", "m/s2", "degC" and so on, "1" for a share, "" for a code or a
        flag.
    texts : dict
        What each signal is.
    """

    def __init__(self, meanings: Mapping[str, tuple[str, str]], rows: Rows) -> None:
        self.rows = rows
        self.units = {name: unit for name, (unit, _) in meanings.items()}
        self.texts = {name: text for name, (_, text) in meanings.items()}
        self._places = {name: k for k, name in enumerate(meanings)}

    def __getitem__(self, name: str) -> Rows:
        """Return one signal, shape (rows,)."""
        if name not in self._places:
            raise KeyError(f"{name}: not recorded")
        return np.ascontiguousarray(self.rows[:, self._places[name]])

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._places)

    def __len__(self) -> int:
        """Return how many signals were recorded."""
        return len(self._places)


class Bench:
    """One simulated vehicle that has been brought to its initial speed.

    Not for two threads at the same time.

    Parameters
    ----------
    drive : Configuration, str or Path
        What the simulated world is made of, and, unless ``controller`` says otherwise, what the
        controllers are configured with. A keyword ``drive`` with sections is the scenario's key.
    scenario : str or Path
        A built-in scenario (``hubsim list``) or a TOML file; by default nothing happens that is not
        set.
    controller : Configuration, str or Path, optional
        Another configuration for the controllers: a drive with other values than the plant, or an
        image.
    rear : Configuration, str or Path, optional
        The drives of the rear axle, plant and controllers, where they differ from those in front.
    plant : mapping, optional
        Parameters of the simulated world alone, by name, as ``set`` takes them.
    record : sequence of str
        Signals to record, ``*`` for anything.
    settings
        Keys of the scenario: ``initial_speed_kmh=40.0``, ``record_interval_s=0.001`` and so on.
    """

    def __init__(
        self,
        drive: Configuration | str | Path | None = None,
        /,
        scenario: str | Path | None = None,
        *,
        controller: Configuration | str | Path | None = None,
        rear: Configuration | str | Path | None = None,
        plant: Mapping[str, float] | None = None,
        record: Sequence[str] = ("*",),
        **settings: Any,  # noqa: ANN401, whatever a scenario's keys take
    ) -> None:
        if drive is None and isinstance(settings.get("drive"), Configuration | str | Path):
            drive = settings.pop("drive")
        if drive is None:
            _scenario(scenario, settings, None)  # a wrong key is the more telling mistake
            raise HubsimError("drive: missing, accepted: a drive's .toml file or name")
        front = _drive(drive)
        chosen, beside = _scenario(scenario, settings, front)
        vehicle, at_rear = (
            d and overrides.changed(d, chosen.drive_changes, f"{chosen.source}: drive")
            for d in (front, None if rear is None else _drive(rear))
        )
        assert vehicle is not None
        self._engine, self.planned_s = simulation.prepare(
            vehicle, chosen, beside, dict(plant or {}), at_rear
        )
        self._happening = simulation.timeline(chosen, beside)
        if controller is not None:
            other = (
                controller
                if isinstance(controller, Configuration)
                else configuration.load(controller)
            )
            self._engine.load_config(other.image)
        self._engine.start()
        names = simulation.matching(self._engine.signals(), list(record)) if record else []
        self._engine.choose(names)
        known = self._engine.meanings()
        self._meanings = {name: known[name] for name in names}
        self._kept: list[Rows] = []

    def __enter__(self) -> Self:
        """Return the bench itself."""
        return self

    def __exit__(self, *arguments: object) -> None:
        """Free the vehicle now, not when the collector finds it."""
        self._engine.__exit__(*arguments)

    @property
    def time_s(self) -> float:
        """Time since the run began."""
        return self["time_s"]

    @property
    def ended(self) -> bool:
        """Whether the vehicle stands, where that was to end the run."""
        return self._engine.ended

    @property
    def period_s(self) -> float:
        """Distance of the controllers' fast steps, the smallest step of the bench."""
        return 1.0 / self._engine.get("inverter.pwm_frequency_hz")

    def __getitem__(self, name: str) -> float:
        """Return a signal now.

        Of a rate (``*_w``, ``*.motor_torque_nm``) the account it is the rate of.
        """
        return self._engine.value(name)

    def signals(self) -> dict[str, tuple[str, str]]:
        """Return unit and meaning of every signal by name."""
        return self._engine.meanings()

    def set(self, name: str, value: float) -> None:
        """Set a parameter of the simulated world from now on.

        ``hubsim.parameters()`` lists names, units and ranges.
        """
        self._engine.set(name, value)

    def get(self, name: str) -> float:
        """Return a parameter of the simulated world."""
        return self._engine.get(name)

    def step(self, duration_s: float | None = None) -> None:
        """Go on for a time, by default one PWM period.

        The scenario's events happen. Rows that fall due come with the next ``run``.
        """
        now_s = self.time_s
        until_s = now_s + (self.period_s if duration_s is None else duration_s)
        while not self.ended and now_s < until_s - 1e-3 * self.period_s:
            self._happening.apply(self._engine, now_s)
            rows = self._engine.run(min(until_s, self._happening.next_s(now_s)) - now_s)
            if len(rows):
                self._kept.append(rows)
            now_s = self.time_s

    def run(self, duration_s: float | None = None) -> Recording:
        """Go on for a time, by default to the end of the scenario.

        Returns what was recorded since the last ``run``.
        """
        until_s = self.planned_s if duration_s is None else self.time_s + duration_s
        rounding_s = 1e-3 * self.period_s
        while not self.ended and self.time_s < until_s - rounding_s:
            self.step(min(CHUNK_S, until_s - self.time_s))
        rows = np.concatenate(self._kept) if self._kept else np.empty((0, len(self._meanings)))
        self._kept = []
        return Recording(self._meanings, rows)

    @property
    def engine(self) -> Engine:
        """What the bench drives."""
        return self._engine

    def happen(self, now_s: float) -> None:
        """Let those of the scenario's events happen that are due."""
        self._happening.apply(self._engine, now_s)

    def happens_next_s(self, now_s: float) -> float:
        """Return the time of the next event, s; infinity if there is none."""
        return self._happening.next_s(now_s)

    def mode_text(self, mode: float) -> str:
        """Return the name of a controller's mode."""
        return self._engine.mode_text(mode)

    def reason_text(self, reason: float) -> str:
        """Return what a reason code means."""
        return self._engine.reason_text(reason)


def _drive(source: Configuration | str | Path) -> Drive:
    config = source if isinstance(source, Configuration) else configuration.load(source)
    if config.drive is None:
        raise HubsimError(
            f"{config.name}: an image does not say what the plant is, accepted: a drive's "
            ".toml file"
        )
    return config.drive


def _scenario(
    name: str | Path | None, settings: dict[str, Any], drive: Drive | None
) -> tuple[scenario.Scenario, Path]:
    if name is not None:
        try:
            _, chosen, beside = scenario.load(str(name), settings, drive)
        except HubsimError as error:
            raise HubsimError(str(error).removeprefix("--set ")) from error
        return chosen, beside
    try:
        return scenario.Scenario.model_validate({"max_duration_s": LONGEST_S} | settings), Path()
    except ValidationError as error:
        key, what = keys.first(error, scenario.Scenario)
        raise HubsimError(f"{key}: {what}" if key else what) from error
