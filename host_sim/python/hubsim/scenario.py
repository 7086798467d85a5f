"""Scenarios: what a simulated vehicle is made to do, from TOML, with every key overridable on the command line."""

import difflib
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from hubsim.errors import HubsimError

DIRECTORY = Path(__file__).resolve().parent / "scenarios"
MAX_FILE_BYTES = 1 << 20


def _number(lowest: float, highest: float, text: str) -> Any:  # noqa: ANN401, pydantic's own type for this
    return Field(ge=lowest, le=highest, description=text)


class Scenario(BaseModel):
    """One scenario; keys as in the TOML file and after ``--set``. Torques are at each driven wheel."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)

    description: Annotated[str, Field(max_length=200, description="one line for people")] = ""
    cycle: Annotated[str | None, Field(description="a built-in cycle or a .csv file: the driver follows it")] = None
    speed_scale: Annotated[float, _number(0.01, 10.0, "the cycle's speeds are multiplied with it")] = 1.0
    repeats: Annotated[int, _number(1, 1000, "how many times the cycle is driven")] = 1
    initial_speed_kmh: Annotated[float, _number(0.0, 300.0, "speed at which the run begins, km/h")] = 0.0
    demand_nm: Annotated[float, _number(0.0, 1e5, "without a cycle: held braking demand, N m")] = 0.0
    drive_nm: Annotated[float, _number(-1e5, 1e5, "without a cycle or braking demand: held drive demand, N m")] = 0.0
    stop_at_standstill: Annotated[bool, Field(description="the run ends when the vehicle stands")] = False
    max_duration_s: Annotated[float, _number(0.001, 1e6, "the run ends at the latest; a cycle ends by itself")] = 1e5
    drag: Annotated[bool, Field(description="false: no air drag and no rolling resistance")] = True
    slope_percent: Annotated[float, _number(-50.0, 50.0, "of the road, positive uphill, %")] = 0.0
    winding_temperature_c: Annotated[float, _number(-40.0, 250.0, "of all windings at the start, degC")] = 25.0
    switch_temperature_c: Annotated[float, _number(-40.0, 250.0, "of all inverters at the start, degC")] = 25.0
    ambient_temperature_c: Annotated[float, _number(-40.0, 60.0, "of the air, degC")] = 25.0
    initial_soc: Annotated[float | None, _number(0.0, 1.0, "state of charge at the start; absent: the drive's own")] = None
    noise: Annotated[bool, Field(description="false: sensors without the noise that the drive's file gives them")] = True
    seed: Annotated[int, _number(0, 1 << 53, "of all noise: same seed, same bytes")] = 1
    record_interval_s: Annotated[float, _number(1e-5, 1e3, "distance of recorded rows, s")] = 0.01
    driver_bandwidth_rad_per_s: Annotated[float, _number(1e-3, 100.0, "of the driver's speed regulator, rad/s")] = 2.0
    driver_preview_s: Annotated[float, _number(1e-3, 10.0, "how far ahead the driver looks, s")] = 0.1

    @model_validator(mode="after")
    def _has_an_end(self) -> "Scenario":
        if self.cycle is None and self.max_duration_s >= 1e5 and not self.stop_at_standstill:
            raise ValueError("cycle: missing, accepted: a cycle, or max_duration_s, or stop_at_standstill = true")
        return self


def builtin_names() -> list[str]:
    """Return the names of the built-in scenarios."""
    return sorted(path.stem for path in DIRECTORY.glob("*.toml"))


def load(name: str, overrides: Mapping[str, Any]) -> tuple[str, Scenario, Path]:
    """Read a scenario and apply what the command line sets.

    Parameters
    ----------
    name : str
        A built-in scenario, or a TOML file.
    overrides : mapping
        Key to value.

    Returns
    -------
    name, scenario, directory
        The name results go under, and where the scenario's own files are looked for.
    """
    path = DIRECTORY / f"{name}.toml" if name in builtin_names() else Path(name)
    if path.suffix != ".toml":
        raise HubsimError(f"no scenario {name!r}, accepted: {', '.join(builtin_names())} or a .toml file")
    data = {**_read(path), **overrides}
    try:
        return path.stem, Scenario.model_validate(data), path.parent
    except ValidationError as error:
        details = min(error.errors(include_url=False), key=lambda d: d["type"] != "extra_forbidden")
        key = str(details["loc"][0]) if details["loc"] else ""
        source = f"--set {key}" if key in overrides else f"{path}"
        raise HubsimError(f"{source}: {_explain(key, details, key in overrides)}") from error


def _read(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise HubsimError(f"{path}: larger than {MAX_FILE_BYTES} bytes, a scenario takes a few hundred")
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise HubsimError(f"{path}: file not found") from None
    except IsADirectoryError:
        raise HubsimError(f"{path}: is a directory, a TOML file is needed") from None
    except OSError as error:
        raise HubsimError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise HubsimError(f"{path}: not UTF-8 text (byte {error.start})") from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise HubsimError(f"{path}: not valid TOML: {' '.join(str(error).split())}") from error


def _explain(key: str, details: ErrorDetails, named: bool) -> str:
    """Say what is wrong with a key and what would be accepted."""
    lead = "" if named else f"{key}: "
    if details["type"] == "extra_forbidden":
        near = difflib.get_close_matches(key, Scenario.model_fields, n=1, cutoff=0.5)
        return f"{lead}unknown key, " + (f"did you mean {near[0]}?" if near else f"known are {', '.join(Scenario.model_fields)}")
    if not key:
        return str(details["msg"]).removeprefix("Value error, ")
    value = repr(details["input"])
    return f"{lead}{value if len(value) <= 40 else value[:37] + '...'} is not accepted, accepted: {accepted(key)}"


def accepted(key: str) -> str:
    """Describe what a key takes."""
    field = Scenario.model_fields[key]
    bounds = {name: getattr(m, name) for m in field.metadata for name in ("ge", "le") if hasattr(m, name)}
    kind = str(field.annotation)
    if "bool" in kind:
        return "true or false"
    if "str" in kind:
        return "text"
    number = "a whole number" if "float" not in kind else "a number"
    return f"{number} from {bounds['ge']:g} to {bounds['le']:g}"
