# SPDX-License-Identifier: Apache-2.0
"""The simulated world of a live vehicle, and what is changed in it while it runs."""

import contextlib
import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, Self

from hubsim import scenario as scenarios
from hubsim.errors import HubsimError
from hubsim.scenario import faults as known_faults
from hubsim.scenario import overrides
from regen_table import installation, schema
from regen_table.errors import OutputError

from hubfoc.errors import HubfocError
from hubfoc.live.faults import Active, Faults, can_be_of_one_wheel
from hubfoc.live.recorder import Recorder, axle, provenance
from hubfoc.live.vehicle import POSITIONS, LiveVehicle, SimulatedVehicle

# What can be changed by its short name: the engine's parameter.
SETTINGS = {
    "slope": "road.slope",
    "friction": "road.friction",
    "soc": "battery.initial_soc",
    "temperature_c": "thermal.winding_temperature_c",
}
SWITCHES_TOO = "thermal.switch_temperature_c"


class Broken(Protocol):
    """What is broken on purpose."""

    @property
    def silences(self) -> bool:
        """Whether the demands of others are not heard."""

    @property
    def active(self) -> Mapping[str, Active]:
        """The faults that are there."""


class LiveWorld(Protocol):
    """What a page is about: a simulated world, or real wheels (board.py)."""

    @property
    def real(self) -> bool:
        """Whether there are people to hurt."""

    @property
    def demands(self) -> bool:
        """Whether a page may send demands."""

    @property
    def drive(self) -> schema.Drive:
        """What drives it, or its front wheels."""

    @property
    def rear(self) -> schema.Drive | None:
        """What drives the rear wheels, where they differ."""

    @property
    def vehicle(self) -> LiveVehicle:
        """The present one."""

    @property
    def number(self) -> int:
        """Of vehicles until now."""

    @property
    def time_s(self) -> float:
        """Of the present vehicle."""

    @property
    def scenario(self) -> str | None:
        """Whose driver drives."""

    @property
    def paused(self) -> bool:
        """Whether the time stands."""

    @property
    def ends(self) -> bool:
        """Whether it ends with its scenario."""

    @property
    def faults(self) -> Broken:
        """What is broken on purpose."""

    def state(self) -> dict[str, Any]:
        """Return what can be changed, as it is."""

    def fault_list(self) -> list[dict[str, Any]]:
        """Return all that can be broken."""

    def scenarios(self) -> dict[str, str]:
        """Return the scenarios that this drive can have, with what they are."""

    def change(self, wanted: Mapping[str, Any]) -> dict[str, Any]:
        """Change what is named, and return the state after it."""

    def stop(self, why: str) -> None:
        """Let the vehicle go no further, for this reason."""


class World:
    """One vehicle at a time, of one drive; another scenario is another vehicle.

    Not for two threads: the one that steps the vehicle makes the changes as well.

    Parameters
    ----------
    config : path
        The drive's file.
    scenario : str, optional
        Its simulated driver drives; absent: nobody does, and the vehicle stands.
    rear : path, optional
        Of the wheels of the rear axle, where they differ.
    ends : bool
        Whoever steps the vehicle ends with its scenario; else the time stands then.
    """

    real = False
    demands = True

    def __init__(
        self,
        config: Path,
        scenario: str | None = None,
        *,
        ends: bool = False,
        rear: Path | None = None,
    ) -> None:
        self._files = (config, rear)
        self.ends = ends
        self.drive = schema.load(config)
        self.rear = None if rear is None else schema.load(rear)
        self.paused = False
        self.number = 0  # of vehicles until now
        self.ended: str | None = None  # why the time stands for good
        self._scenarios: dict[str, str] = {}
        self._key: bytes | None = None  # drawn by the first vehicle, and that of all
        self.recorder: Recorder | None = None
        self._latest: Recorder | None = None  # whose file is, or will be, complete
        self.records_itself = False  # into a file of its own
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self.vehicle = self._prepared(scenario)
        self._key = self.vehicle.key
        self._begin(scenario)

    def __enter__(self) -> Self:
        """Return the world itself."""
        return self

    def __exit__(self, *exc: object) -> None:
        """Free the vehicle."""
        self.stop_recording()
        if self._latest is not None:
            self._latest.wait()
        self.vehicle.__exit__(*exc)
        if self._folder is not None:
            self._folder.cleanup()

    @property
    def time_s(self) -> float:
        """Of the present vehicle."""
        return self.vehicle.time_s

    def state(self) -> dict[str, Any]:
        """Return what can be changed, as it is."""
        settings = {name: self.vehicle.get(parameter) for name, parameter in SETTINGS.items()}
        return {
            "time_s": self.time_s,
            **settings,
            "soc": self.vehicle.value("battery.soc"),
            "faults": {
                name: {
                    "wheel": None if active.wheel is None else POSITIONS[active.wheel],
                    "since_s": active.since_s,
                }
                for name, active in self.faults.active.items()
            },
            "scenario": self.scenario,
            "recording_s": None if self.recorder is None else self.recorded_ms / 1e3,
            "recorded": None if self.recorded is None else str(self.recorded),
            "completes": self._latest is not None and not self._latest.has_ended,
            "recording_failed": self._latest and self._latest.failure,
            "paused": self.paused,
            "ended": self.ended,
        }

    def fault_list(self) -> list[dict[str, Any]]:
        """Return every fault: name, group, text, whether one wheel can have it, why it cannot."""
        return [
            {
                "name": fault.name,
                "group": fault.group,
                "text": fault.text,
                "one_wheel": can_be_of_one_wheel(fault.name),
                "refused": self.faults.refused.get(fault.name),
            }
            for fault in known_faults.table().values()
        ]

    def scenarios(self) -> dict[str, str]:
        """Return the built-in scenarios that this drive can have, with what they are."""
        if not self._scenarios:
            for name in scenarios.builtin_names():
                with contextlib.suppress(HubsimError):
                    _, chosen, _ = scenarios.load(name, {}, self.drive)
                    if not chosen.uses_pedals:
                        self._scenarios[name] = chosen.description
        return self._scenarios

    def change(self, wanted: Mapping[str, Any]) -> dict[str, Any]:
        """Change what is named, and return the state after it."""
        accepted = (*SETTINGS, "fault", "on", "wheel", "scenario", "record", "paused")
        if unknown := set(wanted) - set(accepted):
            raise HubfocError(f"{min(unknown)!r} is not accepted, accepted: {', '.join(accepted)}")
        if "scenario" in wanted:
            self._restart(_text(wanted, "scenario"))
        if "record" in wanted:
            self._record(wanted["record"])
        for name in SETTINGS:
            if name in wanted:
                self._set(name, wanted[name])
        if "fault" in wanted:
            self._change_fault(wanted)
        if "paused" in wanted:
            self.paused = bool(wanted["paused"])
        return self.state()

    def stop(self, why: str) -> None:
        """Let the vehicle go no further, for this reason."""
        self.ended = why
        self.paused = True

    @property
    def recorded_ms(self) -> int:
        """How much is recorded until now."""
        return 0 if self.recorder is None else self.recorder.milliseconds

    def stop_recording(self) -> None:
        """Record no more; the file is completed meanwhile (``recorded``)."""
        recorder, self.recorder = self.recorder, None
        if recorder is None:
            return
        self.vehicle.end_log()
        recorder.end()
        self._latest = recorder

    @property
    def recorded(self) -> Path | None:
        """The latest complete recording."""
        latest = self._latest
        return latest.path if latest and latest.has_ended and latest.failure is None else None

    def _record(self, wanted: object) -> None:
        """Begin again with a recording: a path, true for one of this world's own; null ends it."""
        if wanted is None:
            self.stop_recording()
            return
        own = wanted is True
        if own:
            if self._folder is None:
                self._folder = tempfile.TemporaryDirectory(prefix="hubfoc-")
            wanted = str(Path(self._folder.name) / f"{self.drive.name}-{self.number}.parquet")
        if not isinstance(wanted, str):
            raise HubfocError(f"record: {wanted!r} is not accepted, accepted: a file, true, null")
        self._restart(self.scenario, Path(wanted))
        self.records_itself = own

    def _recorder(self, scenario: str | None, path: Path) -> Recorder:
        drives = zip((self.drive, self.rear), self._files, strict=True)
        axles = [axle(drive, file) for drive, file in drives if drive is not None and file]
        try:
            return Recorder(path, provenance(axles, scenario))
        except OutputError as error:
            raise HubfocError(str(error)) from error
        except ModuleNotFoundError as error:
            raise HubfocError(installation.missing(error)) from error

    def _change_fault(self, wanted: Mapping[str, Any]) -> None:
        name = _text(wanted, "fault") or ""
        if wanted.get("on", True):
            self.faults.put(name, _text(wanted, "wheel"), self.time_s)
        else:
            self.faults.take_away(name)

    def _set(self, name: str, value: object) -> None:
        if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
            raise HubfocError(f"{name}: {value!r} is not accepted, accepted: a number")
        try:
            self.vehicle.set(SETTINGS[name], value)
            if name == "temperature_c":
                self.vehicle.set(SWITCHES_TOO, value)
        except HubsimError as error:
            raise HubfocError(f"{name}: {error}") from error

    def _prepared(self, scenario: str | None, log: Recorder | None = None) -> SimulatedVehicle:
        if scenario is None:
            return SimulatedVehicle(self.drive, key=self._key, rear=self.rear, log=log)
        _, chosen, beside = scenarios.load(scenario, {}, self.drive)
        front, back = self._files
        drive = overrides.load_drive(front, overrides.parse([]), chosen)
        rear = None if back is None else overrides.load_drive(back, overrides.parse([]), chosen)
        return SimulatedVehicle(drive, chosen, beside, self._key, rear, log=log)

    def _begin(self, scenario: str | None) -> None:
        self.scenario = scenario
        self.ended = None
        self.faults = Faults(self.vehicle)
        self.number += 1

    def _restart(self, scenario: str | None, recording: Path | None = None) -> None:
        self.stop_recording()
        if recording is not None and self._latest is not None:
            self._latest.wait()  # it may be the same file
        recorder = None if recording is None else self._recorder(scenario, recording)
        try:
            vehicle = self._prepared(scenario, recorder)
        except HubsimError as error:
            if recorder is not None:
                recorder.end(complete=False)
            raise HubfocError(str(error)) from error
        if vehicle.wheels != self.vehicle.wheels:
            vehicle.__exit__()
            raise HubfocError(f"{scenario}: has another number of wheels")
        self.vehicle.__exit__()
        self.recorder = recorder
        self.vehicle = vehicle
        self.paused = False
        self._begin(scenario)


def _text(wanted: Mapping[str, Any], key: str) -> str | None:
    value = wanted.get(key)
    if value is not None and not isinstance(value, str):
        raise HubfocError(f"{key}: {value!r} is not accepted, accepted: a text")
    return value
