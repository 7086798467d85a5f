# SPDX-License-Identifier: Apache-2.0
"""Scenarios: what a simulated vehicle does and must show, from TOML.

Every key can be overridden on the command line.

The keys at the top are state, driver and road; a number may be a formula in quotes of what is known
of the drive (quantities.py), so that one scenario fits every drive. ``[needs]`` says what a drive
must have for it. Sections: ``[plant.SECTION]`` is the simulated world
where it is to differ from the drive's file, ``[drive.SECTION]`` the drive's file itself for plant
and controllers alike, ``[events.NAME]`` something that happens (events.py), ``[criteria.NAME]``
something that must be shown (criteria.py).
"""

import tomllib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, model_validator
from regen_table import installation, schema
from regen_table.schema import Drive
from regen_table.suggest import suggestion

from hubsim import files
from hubsim.errors import DoesNotApplyError, HubsimError
from hubsim.scenario import fitting, keys
from hubsim.scenario.criteria import Criterion, read_needs
from hubsim.scenario.events import Event, check_parameter, rising
from hubsim.scenario.fitting import changed
from hubsim.scenario.keys import Section, listed, listing, number
from hubsim.scenario.quantities import Quantities

DIRECTORY = Path(__file__).resolve().parent / "builtin"
MAX_FILE_BYTES = 1 << 20
FILES = ("cycle", "plant_flux_map")  # keys that name one

_POINTS = "a list of [time_s, value] with times from 0, rising"
Points = tuple[Annotated[tuple[float, float], Field(strict=False)], ...]
Named = dict[str, dict[str, Any]]


class Scenario(Section):
    """One scenario; keys as in the TOML file and after ``--set``.

    Torques are at each driven wheel.
    """

    description: Annotated[str, Field(max_length=200, description="one line for people")] = ""
    cycle: Annotated[
        str | None, Field(description="a built-in cycle or a .csv file: the driver follows it")
    ] = None
    speed_scale: Annotated[
        float, number(0.01, 10.0, "the cycle's speeds are multiplied with it")
    ] = 1.0
    speed_trace_kmh: Annotated[
        Points | None, listing("instead of a cycle: speeds to follow over time, km/h", _POINTS)
    ] = None
    repeats: Annotated[int, number(1, 1000, "how many times the cycle is driven")] = 1
    initial_speed_kmh: Annotated[
        float, number(-300.0, 300.0, "speed at which the run begins, km/h, negative backwards")
    ] = 0.0
    demand_nm: Annotated[float, number(0.0, 1e5, "without a cycle: held braking demand, N m")] = 0.0
    drive_nm: Annotated[float, number(-1e5, 1e5, "without a cycle: held drive demand, N m")] = 0.0
    demand_trace_nm: Annotated[
        Points | None, listing("instead of demand_nm: brake pedal over time, N m", _POINTS)
    ] = None
    drive_trace_nm: Annotated[
        Points | None, listing("instead of drive_nm: drive pedal over time, N m", _POINTS)
    ] = None
    accelerator: Annotated[
        float | None,
        number(0.0, 1.0, "travel of the accelerator, with [drive.pedals] instead of drive_nm"),
    ] = None
    brake_pedal: Annotated[
        float | None,
        number(0.0, 1.0, "travel of the brake pedal, with [drive.pedals] instead of demand_nm"),
    ] = None
    accelerator_trace: Annotated[
        Points | None, listing("instead of accelerator: its travel over time", _POINTS)
    ] = None
    brake_pedal_trace: Annotated[
        Points | None, listing("instead of brake_pedal: its travel over time", _POINTS)
    ] = None
    boots_rolling: Annotated[
        bool,
        Field(
            description=(
                "the controllers boot when the run begins, on wheels that turn at"
                " initial_speed_kmh; false: at standstill, before it"
            )
        ),
    ] = False
    stop_at_standstill: Annotated[
        bool, Field(description="the run ends when the vehicle stands")
    ] = False
    max_duration_s: Annotated[
        float, number(0.001, 1e6, "the run ends at the latest; a cycle ends by itself")
    ] = 1e5
    drag: Annotated[bool, Field(description="false: no air drag and no rolling resistance")] = True
    slope_percent: Annotated[float, number(-50.0, 50.0, "of the road, positive uphill, %")] = 0.0
    winding_temperature_c: Annotated[
        float, number(-40.0, 250.0, "of all windings at the start, degC")
    ] = 25.0
    switch_temperature_c: Annotated[
        float, number(-40.0, 250.0, "of all inverters at the start, degC")
    ] = 25.0
    ambient_temperature_c: Annotated[float, number(-40.0, 60.0, "of the air, degC")] = 25.0
    initial_soc: Annotated[
        float | None, number(0.0, 1.0, "state of charge at the start; absent: the drive's own")
    ] = None
    noise: Annotated[
        bool, Field(description="false: sensors without the noise that the drive's file gives them")
    ] = True
    seed: Annotated[int, number(0, 1 << 53, "of all noise: same seed, same bytes")] = 1
    record_interval_s: Annotated[float, number(1e-5, 1e3, "distance of recorded rows, s")] = 0.01
    driver_bandwidth_rad_per_s: Annotated[
        float, number(1e-3, 100.0, "of the driver's speed regulator, rad/s")
    ] = 2.0
    driver_preview_s: Annotated[float, number(1e-3, 10.0, "preview time of the driver, s")] = 0.1
    driver_release_speed_m_per_s: Annotated[
        float, number(0.0, 1.0, "below it the driver eases the brake to a soft stop; 0: never, m/s")
    ] = 0.3
    plant_flux_map: Annotated[
        str | None,
        Field(
            description=(
                "a measured flux map (CSV, NPZ, Parquet; regen_table flux): the simulated motors'"
                " iron in place of their inductances and flux linkage"
            )
        ),
    ] = None
    needs: Annotated[
        dict[str, str],
        listed(
            "what the drive must have for this scenario, in words: where that does not hold, the"
            " scenario does not apply",
            "a section of words and formulas",
        ),
    ] = Field(default_factory=dict)
    drive: Annotated[
        Named,
        listed("sections of the drive's file that differ in this scenario", "sections of keys"),
    ] = Field(default_factory=dict)
    plant: Annotated[
        dict[str, float],
        listed("parameters that the simulated world alone has differently", "sections of numbers"),
    ] = Field(default_factory=dict)
    events: Annotated[
        dict[str, Event], listed("what happens during the run, by name", "sections of events")
    ] = Field(default_factory=dict)
    criteria: Annotated[
        dict[str, Criterion], listed("what the run must show, by name", "sections of criteria")
    ] = Field(default_factory=dict)

    _source: str = PrivateAttr(default="scenario")

    @model_validator(mode="after")
    def _fits_together(self) -> "Scenario":
        if (
            self.cycle is None
            and self.speed_trace_kmh is None
            and self.max_duration_s >= 1e5
            and not self.stop_at_standstill
        ):
            raise ValueError(
                "cycle: missing, accepted: a cycle, or max_duration_s, or stop_at_standstill = true"
            )
        if self.cycle is not None and self.speed_trace_kmh is not None:
            raise ValueError("speed_trace_kmh: accepted: either cycle or speed_trace_kmh")
        if self.uses_pedals and self.follows:
            raise ValueError("accelerator: accepted without cycle and speed_trace_kmh")
        for key in (
            "speed_trace_kmh",
            "demand_trace_nm",
            "drive_trace_nm",
            "accelerator_trace",
            "brake_pedal_trace",
        ):
            if (points := getattr(self, key)) is not None:
                rising(points, key)
        read_needs(self.needs)
        for name, value in self.plant.items():
            try:
                check_parameter(name, value)
            except ValueError as error:
                raise ValueError(f"plant.{error}") from error
        return self

    @property
    def source(self) -> str:
        """Where the scenario came from, for messages."""
        return self._source

    @property
    def drive_changes(self) -> dict[tuple[str, str], Any]:
        """Overrides of the drive file, by (section, key)."""
        return _by_key(self.drive)

    @property
    def follows(self) -> bool:
        """Whether the driver follows a speed over time."""
        return self.cycle is not None or self.speed_trace_kmh is not None

    @property
    def not_read(self) -> dict[str, str]:
        """Keys that this scenario's other keys leave without effect, each with the reason."""
        found: dict[str, str] = {}
        demands = ("demand_nm", "drive_nm", "demand_trace_nm", "drive_trace_nm")
        if self.follows:
            found |= dict.fromkeys(demands, "the driver follows a speed over time")
        else:
            keys = (
                *("speed_scale", "repeats", "driver_bandwidth_rad_per_s", "driver_preview_s"),
                "driver_release_speed_m_per_s",
            )
            found |= dict.fromkeys(keys, "the driver follows no speed over time")
        if self.uses_pedals:
            found |= dict.fromkeys(demands, "the demands come from wired pedals")
        for key, trace in (
            ("demand_nm", "demand_trace_nm"),
            ("drive_nm", "drive_trace_nm"),
            ("accelerator", "accelerator_trace"),
            ("brake_pedal", "brake_pedal_trace"),
        ):
            if getattr(self, trace) is not None:
                found.setdefault(key, f"{trace} is given")
        return found

    @property
    def uses_pedals(self) -> bool:
        """Whether the demands come from pedals wired to a controller instead of messages."""
        given = (
            self.accelerator,
            self.brake_pedal,
            self.accelerator_trace,
            self.brake_pedal_trace,
        )
        return any(value is not None for value in given)

    @property
    def constants(self) -> dict[str, float]:
        """What formulas may name besides signals.

        The scenario's own numbers and the times of its events.
        """
        own = {
            f"scenario.{key}": value
            for key, value in self
            if isinstance(value, int | float) and not isinstance(value, bool)
        }
        for name, event in self.events.items():
            own[f"events.{name}.at_s"] = event.at_s
            own[f"events.{name}.over_s"] = event.over_s
            if event.until_s is not None:
                own[f"events.{name}.until_s"] = event.until_s
            own |= {f"events.{name}.set.{key}": value for key, value in event.values.items()}
        return {key: float(value) for key, value in own.items()}


def builtin_names() -> list[str]:
    """Return the names of the built-in scenarios."""
    return sorted(path.stem for path in DIRECTORY.glob("*.toml"))


@lru_cache(maxsize=1)
def default_drive() -> Drive:
    """Return the drive for which a scenario is fitted where none is named."""
    return schema.load(installation.ROOT / "tools" / "motors" / "lu2013.toml")


def load(
    name: str,
    overrides: Mapping[str, Any],
    drive: Drive | None = None,
    drive_settings: Mapping[tuple[str, str], Any] | None = None,
) -> tuple[str, Scenario, Path]:
    """Read a scenario, apply what the command line sets, and fit it to a drive.

    Parameters
    ----------
    name : str
        A built-in scenario, or a TOML file.
    overrides : mapping
        Key to value; a key inside a section is dotted (``events.lost.at_s``).
    drive : Drive, optional
        As its file has it; absent: the default one. The scenario's formulas name its quantities.
    drive_settings : mapping, optional
        Of the drive's keys, by (section, key): what the command line sets.

    Returns
    -------
    name, scenario, directory
        The name results go under, and where the scenario's own files are looked for.

    Raises
    ------
    DoesNotApplyError
        Where the drive lacks what the scenario needs.
    """
    path = DIRECTORY / f"{name}.toml" if name in builtin_names() else Path(name)
    if path.suffix != ".toml":
        known = builtin_names()
        everything = f"accepted: {', '.join(known)} or a .toml file"
        raise HubsimError(f"no scenario {name!r}, {suggestion(name, known, everything)}")
    data = _flattened(_read(path))
    if name not in builtin_names() and isinstance(data.setdefault("plant", {}), dict):
        data["plant"].setdefault("thermal.active", 1.0)  # as the controllers' own model heats
    for key, value in overrides.items():
        _put(data, key, _from_here(value) if key in FILES else value)
    settings = drive_settings or {}
    base = changed(drive or default_drive(), settings, "--set")
    if lacking := fitting.missing(data.get("needs"), str(path), Quantities(base)):
        raise DoesNotApplyError(path.stem, base.name, lacking)
    used = fitting.named({key: value for key, value in data.items() if key != "criteria"})
    if used:
        data = fitting.fitted(
            data, str(path), base,
            lambda own: changed(changed(base, _by_key(own), f"{path}: drive"), settings, "--set"),
        )  # fmt: skip
    try:
        found = Scenario.model_validate(data)
    except ValidationError as error:
        key, what = keys.first(error, Scenario)
        guilty = next((given for given in overrides if _concerns(given, key)), None)
        if guilty is not None:
            rest = (
                ""
                if key == guilty
                else f"{key}: "
                if key and not guilty.startswith(f"{key}.")
                else ""
            )
            raise HubsimError(f"--set {guilty}: {rest}{what}") from error
        raise HubsimError(f"{path}: {key}: {what}" if key else f"{path}: {what}") from error
    found._source = str(path)
    for key in overrides:
        if (why := found.not_read.get(key)) and f"scenario.{key}" not in used:
            raise HubsimError(f"--set {key}: is not read, as {why}")
    return path.stem, found, path.parent


def _by_key(sections: Mapping[str, Mapping[str, Any]]) -> dict[tuple[str, str], Any]:
    return {(section, key): v for section, keys in sections.items() for key, v in keys.items()}


def _from_here(file: object) -> object:
    """Return a file of the command line, which is not beside the scenario's."""
    return str(Path(file).resolve()) if isinstance(file, str) and "." in file else file


def _concerns(given: str, key: str) -> bool:
    return bool(key) and (
        given == key or given.startswith(f"{key}.") or key.startswith(f"{given}.")
    )


def _flattened(data: dict[str, Any]) -> dict[str, Any]:
    """Bring sections of parameters (``[plant.battery]``, ``set.driver.x``) to dotted names."""
    if isinstance(data.get("plant"), dict):
        data["plant"] = _dotted(data["plant"])
    events = data.get("events")
    for event in events.values() if isinstance(events, dict) else ():
        if isinstance(event, dict) and isinstance(event.get("set"), dict):
            event["set"] = _dotted(event["set"])
    return data


def _dotted(data: Mapping[str, Any]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in data.items():
        if isinstance(value, dict):
            out |= {f"{key}.{name}": inner for name, inner in _dotted(value).items()}
        else:
            out[key] = value
    return out


def _put(data: dict[str, Any], key: str, value: object) -> None:
    """Set a key; one of an event or criterion that the file has is dotted.

    ``events.NAME.KEY``, ``events.NAME.set.PARAMETER``.
    """
    head, _, rest = key.partition(".")
    if head not in {"events", "criteria"}:
        data[key] = value
        return
    name, _, inner = rest.partition(".")
    known = data.get(head) or {}
    section = known.get(name) if isinstance(known, dict) else None
    if not isinstance(section, dict) or not inner:
        accepted = f"{head}.NAME.KEY with NAME one of {', '.join(known) or 'none here'}"
        sections = [f"{head}.{section}" for section in known]
        hint = suggestion(f"{head}.{name}", sections, f"accepted: {accepted}")
        raise HubsimError(f"--set {key}: {hint}")
    if inner.startswith("set."):
        section = section.setdefault("set", {})
        inner = inner.removeprefix("set.")
    section[inner] = value


def _read(path: Path) -> dict[str, Any]:
    text = files.read_text(path, MAX_FILE_BYTES)
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise HubsimError(f"{path}: not valid TOML: {' '.join(str(error).split())}") from error


def accepted(key: str) -> str:
    """Describe what a key takes."""
    return keys.accepted(Scenario.model_fields[key])
