# SPDX-License-Identifier: Apache-2.0
"""A case becomes a file and is the same case again."""

import tomllib
from pathlib import Path

import pytest
from hubsim import configuration
from hubsim.scenario import Scenario, overrides
from hubsim.swarm import draw, text, work
from hubsim.swarm.draw import Case


def plain(data: object) -> object:
    """Return nested data with lists for tuples."""
    if isinstance(data, dict):
        return {key: plain(value) for key, value in data.items()}
    return [plain(each) for each in data] if isinstance(data, list | tuple) else data


@pytest.mark.parametrize("seed", range(0, 40, 5))
def test_a_file_holds_everything(seed: int, tmp_path: Path) -> None:
    case, path = draw.case(seed, 6), tmp_path / "s.toml"
    path.write_text(text.toml_of(case, 'a "quoted" word'), encoding="utf-8")
    assert tomllib.loads(path.read_text(encoding="utf-8"))["description"] == 'a "quoted" word'
    assert max(len(line) for line in path.read_text(encoding="utf-8").splitlines()[4:]) < 200
    again = text.read(path, case.config)
    del again.data["description"]
    assert again.faults == case.faults
    one, two = Scenario.model_validate(again.data), Scenario.model_validate(case.data)
    for each in (one, two):
        object.__setattr__(each, "drive", plain(each.drive))
    assert one == two
    assert configuration.image_of(again.drive) == configuration.image_of(case.drive)


def test_the_drive_of_a_file_is_the_one_that_hubsim_run_reads(tmp_path: Path) -> None:
    case, path = draw.case(5, 6), tmp_path / "s.toml"
    path.write_text(text.toml_of(case), encoding="utf-8")
    from hubsim import scenario  # noqa: PLC0415, the module that the command uses

    _, found, _ = scenario.load(str(path), {})
    base = Path(draw.__file__).parents[4] / "tools" / "motors" / f"{case.config}.toml"
    drive = overrides.load_drive(base, overrides.Overrides(), found)
    assert configuration.image_of(drive) == configuration.image_of(case.drive)


def test_a_run_of_a_file_is_that_of_its_seed(tmp_path: Path) -> None:
    case, path = draw.case(8, 4), tmp_path / "s.toml"
    short = Case(case.seed, case.config, {**case.data, "max_duration_s": 3.0})
    path.write_text(text.toml_of(short), encoding="utf-8")
    again = text.read(path, case.config, case.seed)
    first, second = (
        work.done({"seed": each.seed, "config": each.config, "data": each.data})
        for each in (short, again)
    )
    for record in (first, second):
        del record["cpu_s"]
    assert first == second
