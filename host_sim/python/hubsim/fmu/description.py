# SPDX-License-Identifier: Apache-2.0
"""What a unit has inside and outside.

Its variables with role, type, unit of measure and start value, for both kinds of unit. The standard
wants units of measure as powers of SI base units, with factor and offset. The engine's lists write
them as names with powers, multiplied with a dot or a blank, divided with a slash; every slash
divides by what follows up to the next one.
"""

import hashlib
import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from hubsim import configuration, reasons, run
from hubsim import variables as ports
from hubsim.configuration import Configuration
from hubsim.controller import Controller
from hubsim.engine import mode_text, parameters, reason_text
from hubsim.errors import HubsimError
from hubsim.fmu import KINDS
from hubsim.run import plant
from hubsim.scenario import Scenario
from hubsim.words import counted

REAL, FLAG, CODE = "REAL", "FLAG", "CODE"
MODE, REASON = "mode", "reason"  # codes whose values have names
UNKNOWN_MODE = "unknown mode"
# Names of variables, after the last dot, whose codes are reasons although they are not called so.
_REASONS = frozenset({"waits_for", "present_warning"})
FIXED, TUNABLE, INPUT, OUTPUT = "FIXED", "TUNABLE", "INPUT", "OUTPUT"

# Inputs for other models in a co-simulation; every other quantity of the plant is a
# parameter.
VEHICLE_INPUTS = frozenset({
    "driver.brake_demand_nm", "driver.drive_demand_nm", "driver.demand_age_s", "driver.silent",
    "driver.enable", "driver.abs_active", "driver.direction", "road.slope", "road.wind_m_per_s",
    "bus.contactor_open",
})  # fmt: skip
# Read once, when the run begins.
VEHICLE_FIXED = frozenset(
    {
        "battery.initial_soc",
        "run.seed",
        "run.initial_speed_m_per_s",
        "run.boots_rolling",
        "run.rotor_turn",
        "run.rotor_spread_turn",
    }
)
# Of no use here, or not to be changed without the configuration: there is no speed trace, and the
# importer ends the run.
VEHICLE_SETTINGS = frozenset({
    "driver.follow_trace", "driver.bandwidth_rad_per_s", "driver.preview_s",
    "driver.release_speed_m_per_s", "driver.most_drive_nm", "driver.most_brake_nm",
    "run.stop_at_standstill", "run.record_interval_s", "vehicle.driven_wheels",
    "inverter.pwm_frequency_hz",
})  # fmt: skip

_BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_DERIVED: dict[str, dict[str, float]] = {
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "Wb": {"kg": 1, "m": 2, "s": -2, "A": -1},
    "turn": {"rad": 1, "factor": 2.0 * math.pi},
    "deg": {"rad": 1, "factor": math.pi / 180.0},
    "h": {"s": 1, "factor": 3600.0},
    "min": {"s": 1, "factor": 60.0},
}
_DEGREE = {"degC": {"K": 1.0, "offset": 273.15}}  # of a temperature, never part of another unit
_TOKEN = re.compile(r"([A-Za-z]+)(\d*)")


@dataclass(frozen=True)
class Item:
    """One value of an enumeration."""

    name: str
    value: int
    text: str


def enumerations() -> dict[str, tuple[Item, ...]]:
    """Return the named values of modes and reasons, by the name of their type."""
    modes = itertools.takewhile(
        lambda item: item.name != UNKNOWN_MODE,
        (Item(mode_text(k), k, "") for k in itertools.count()),
    )
    listed = sorted(reasons.codes().items(), key=lambda entry: entry[1])
    return {
        MODE: tuple(modes),
        REASON: tuple(Item(name, code, reason_text(code)) for name, code in listed),
    }


def enumeration_of(name: str) -> str:
    """Return the enumeration that the codes of a variable are, empty for none."""
    last = name.rpartition(".")[2]
    if last == MODE:
        return MODE
    return REASON if last.endswith(REASON) or last in _REASONS else ""


@dataclass(frozen=True)
class Variable:
    """One variable of a unit; ``unit`` is empty for a share, a flag or a code."""

    name: str
    kind: str
    role: str
    unit: str
    text: str
    start: float = 0.0
    lowest: float | None = None
    highest: float | None = None

    @property
    def enumeration(self) -> str:
        """The enumeration that its codes are, empty for none."""
        return enumeration_of(self.name) if self.kind == CODE else ""


@dataclass(frozen=True)
class Description:
    """An FMU. ``settings`` are fixed parameters of its model.

    ``curve`` is soc (1) and voltage (V).
    """

    kind: str
    config: Configuration
    text: str
    period_s: float
    step_s: float
    variables: tuple[Variable, ...]
    settings: dict[str, float] = field(default_factory=dict)
    curve: tuple[Sequence[float], Sequence[float]] = ((), ())

    @property
    def identifier(self) -> str:
        """Name of the binary."""
        return f"hubfoc_{self.kind}"

    @property
    def token(self) -> str:
        """Token that identifies a matching description and binary."""
        described = (
            repr((self.kind, self.variables, sorted(self.settings.items()), self.curve)).encode()
            + self.config.image
        )
        return "{" + hashlib.sha256(described).hexdigest()[:32] + "}"


def describe(kind: str, path: Path) -> Description:
    """Describe a unit made of a drive's TOML file."""
    config = configuration.load(path)
    if config.drive is None:
        raise HubsimError(f"{path}: accepted: a drive's .toml file")
    if kind not in KINDS:
        raise HubsimError(f"{kind}: no such kind of unit, accepted: {', '.join(KINDS)}")
    return _controller(config) if kind == "controller" else _vehicle(config)


def _controller(config: Configuration) -> Description:
    controller = Controller(config)
    kinds = {ports.REAL: REAL, ports.FLAG: FLAG, ports.CODE: CODE}
    found = []
    for name, port in (("fast_input", ports.FAST_INPUT), ("slow_input", ports.SLOW_INPUT)):
        for k, v in enumerate(ports.of_port(port)):
            zero, per_unit = controller.scale(port, k)
            edges = (
                ()
                if v.unit in {"turn", ""}
                else ((v.lowest_raw - zero) / per_unit, (v.highest_raw - zero) / per_unit)
            )
            lowest, highest = (
                (float(v.lowest_raw), float(v.highest_raw))
                if v.kind == ports.CODE
                else edges or (None, None)
            )
            found.append(
                Variable(
                    f"{name}.{v.name}",
                    kinds[v.kind],
                    INPUT,
                    standard_unit(v.unit),
                    v.text,
                    controller.start(port, k),
                    lowest,
                    highest,
                )
            )
    for name, port in (("fast_output", ports.FAST_OUTPUT), ("slow_output", ports.SLOW_OUTPUT)):
        found += [
            Variable(f"{name}.{v.name}", kinds[v.kind], OUTPUT, standard_unit(v.unit), v.text)
            for v in ports.of_port(port)
        ]
    text = (
        f"hubfoc: the controller of one wheel with the configuration {config.name}. Inputs are "
        "sampled when a step begins; what the "
        f"bridge is commanded acts one step later. One step is {1e6 * controller.period_s:g} us "
        "or a multiple of it."
    )
    return Description(
        "controller", config, text, controller.period_s, controller.period_s, tuple(found)
    )


def _vehicle(config: Configuration) -> Description:
    assert config.drive is not None
    if config.drive.motor.has_map:
        raise HubsimError(
            f"{config.name}: motor.flux_map: accepted: a drive without map and curves; the unit's"
            " motor has constants"
        )
    wheels = config.drive.vehicle.driven_wheels
    engine, _ = run.prepare(config.drive, Scenario(max_duration_s=1.0), Path(), {})
    with engine:
        starts = {name: engine.get(name) for name in parameters()}
        engine.start()
        meanings = engine.meanings()
    found, settings = [], {}
    for name, p in parameters().items():
        if name in VEHICLE_SETTINGS or _of_wheel(name) >= wheels:
            settings[name] = starts[name]
            continue
        role = INPUT if name in VEHICLE_INPUTS else FIXED if name in VEHICLE_FIXED else TUNABLE
        kind = REAL if p.unit else FLAG if (p.lowest, p.highest) == (0.0, 1.0) else CODE
        found.append(
            Variable(
                name,
                kind,
                role,
                standard_unit(p.unit),
                p.text or _words(name),
                starts[name],
                p.lowest,
                p.highest,
            )
        )
    for name, (unit, text) in meanings.items():
        found.append(Variable(name, REAL if unit else CODE, OUTPUT, standard_unit(unit), text))
    text = (
        f"hubfoc: the simulated vehicle {config.name}, {counted(wheels, 'wheel')} with a complete "
        "controller each, on one battery and one road. It boots standing and is brought to its "
        "initial speed before time 0. Powers and forces are means over the last step."
    )
    period_s = 1.0 / starts["inverter.pwm_frequency_hz"]
    return Description(
        "vehicle",
        config,
        text,
        period_s,
        0.01,
        tuple(found),
        settings,
        plant.voltage_curve(config.drive),
    )


def _words(name: str) -> str:
    """Return a description derived from a name."""
    return name.replace(".", ", ").replace("_", " ")


def _of_wheel(name: str) -> int:
    """Return the wheel a parameter belongs to, -1 for all."""
    section = name.partition(".")[0].removeprefix("wheel")
    return int(section) if section.isdigit() else -1


def standard_unit(unit: str) -> str:
    """Return a unit of the engine's lists as the standard spells it.

    "" for a share, a code or a flag.
    """
    spelt = unit.replace(" ", ".")
    if spelt in {"", "1"}:
        return ""
    base_powers(spelt)
    return spelt


def base_powers(unit: str) -> dict[str, float]:
    """Return the powers of base units, with ``factor`` and ``offset``.

    Value in SI = factor * value + offset.
    """
    if unit in _DEGREE:
        return _DEGREE[unit]
    above, *below = unit.split("/")
    found: dict[str, float] = {}
    parts = [(above, 1)] + [(part, -1) for part in below]
    for part, sign in parts:
        for name in part.split("."):
            if name != "1":
                _multiply(found, name, sign, unit)
    return {
        key: power for key, power in found.items() if power != (1.0 if key == "factor" else 0.0)
    }


def _multiply(found: dict[str, float], name: str, sign: int, unit: str) -> None:
    token = _TOKEN.fullmatch(name)
    if token is None or (token[1] not in _DERIVED and token[1] not in _BASE):
        raise HubsimError(
            f"unit {unit!r}: {name!r} is no unit of model descriptions, accepted: "
            f"{', '.join([*_BASE, *_DERIVED, *_DEGREE])}"
        )
    power = sign * int(token[2] or "1")
    for key, value in _DERIVED.get(token[1], {token[1]: 1.0}).items():
        if key == "factor":
            found["factor"] = found.get("factor", 1.0) * value**power
        else:
            found[key] = found.get(key, 0.0) + power * value
