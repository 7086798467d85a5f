# SPDX-License-Identifier: Apache-2.0
"""The urban cycle without temperature sensors: errors of the controllers' thermal model."""

import json
from pathlib import Path

from hubsim import cli

SCENARIO = """\
description = "urban cycle, the lines of both temperature sensors break at its beginning"
cycle = "udds"
speed_scale = 0.6575342
[plant.thermal]
active = 1.0
[events.winding]
at_s = 1.0
inject = "winding_sensor_open"
[events.switches]
at_s = 1.0
inject = "switch_sensor_open"
[criteria.named]
reasons = "wheels.warning_reason"
must_appear = ["WINDING_SENSOR"]
[criteria.winding]
text = "the winding temperature in use is the true one"
unit = "K"
value = "max(abs(wheels.winding_used_c - wheels.winding_temperature_c))"
at_most = 15.0
[criteria.warming]
text = "the winding has warmed"
unit = "K"
value = "max(wheels.winding_temperature_c) - 25"
at_least = 8.0
"""


def error_k(directory: Path, drive: str, plant: dict[str, float]) -> float:
    """Return the largest error of the winding temperature in use, with another true plant.

    Parameters
    ----------
    plant:
        values of plant.thermal, in its units
    """
    path = directory / "cycle.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    settings = [f"plant.thermal.{key}={value}" for key, value in plant.items()]
    arguments = [part for one in settings for part in ("--set", one)]
    result = directory / "cycle.json"
    # The whole torque also in LIMP: the wheels follow the cycle.
    fixed = ["--config", drive, "--set", "control.limp_drive_share=1", "--json", str(result)]
    cli.main(["run", str(path), *fixed, *arguments])
    criteria = {one["name"]: one for one in json.loads(result.read_text())["criteria"]}
    for name in ("named", "warming"):
        assert criteria[name]["passed"], criteria[name]
    return float(criteria["winding"]["value"])
