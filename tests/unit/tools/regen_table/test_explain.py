# SPDX-License-Identifier: Apache-2.0
"""What a key means is answered from its declaration and its readers."""

import pytest
from regen_table import cli, explain, filling
from regen_table.errors import ConfigurationError


def test_explain_names_unit_range_default_and_users_of_every_key() -> None:
    for key in filling.declared():
        text = explain.text(key)
        assert text.startswith(key)
        for word in ("meaning", "accepted", "absent", "used in"):
            assert f"  {word}  " in text, key
        assert "nothing yet" not in text, f"nobody reads {key}"


def test_explain_finds_a_key_by_its_own_name_and_a_section_whole() -> None:
    assert explain.matching("dead_time_s") == ["inverter.dead_time_s"]
    assert explain.matching("thermal.winding_heat_capacity_j_per_k") == [
        "thermal.winding_heat_capacity_j_per_k"
    ]
    assert set(explain.matching("mass_kg")) == {"motor.mass_kg", "vehicle.mass_kg"}
    assert len(explain.matching("table")) == 3
    with pytest.raises(ConfigurationError, match=r"did you mean dead_time_s\?"):
        explain.matching("deadtime_s")
    assert "the firmware's drive.dead_time_ns" in explain.text("inverter.dead_time_s")
    assert "regen_table.loops" in explain.text("inverter.dead_time_s")


def test_the_command_answers_several_words_and_refuses_an_unknown_one(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert cli.main(["explain", "dead_time_s", "table"]) == 0
    headings = [line for line in capsys.readouterr().out.splitlines() if line[0] != " "]
    assert headings[0] == "inverter.dead_time_s"
    assert len(headings) == 4
    assert cli.main(["explain", "dedtime_s"]) == 2
    assert "did you mean dead_time_s?" in capsys.readouterr().err
