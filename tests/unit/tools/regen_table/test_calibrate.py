# SPDX-License-Identifier: Apache-2.0
"""Hall edges and index angle from a recording of a wheel turned by hand."""

import itertools
import math
import tomllib
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from regen_table import calibrate, cli, halls, rotor_section
from regen_table.errors import ConfigurationError

Array = npt.NDArray[np.float64]
EDGES_DEG = (11.0, 64.5, 133.0, 186.0, 255.0, 304.0)
POLE_PAIRS = 5
INDEX_DEG = 201.0
SAMPLE_S = 1e-4


def spun(speed_turn_per_s: Array, hysteresis_deg: float = 0.0) -> dict[str, Array]:
    """Return the channels of a wheel for electrical speeds in turns per second, one per sample.

    Its sensors switch half the hysteresis late, whichever way it turns.
    """
    turns = 0.13 + np.cumsum(speed_turn_per_s) * SAMPLE_S
    theta, emf = 2.0 * math.pi * turns, 0.02 * 2.0 * math.pi * speed_turn_per_s
    a, b, c = (-emf * np.sin(theta - k * 2.0 * math.pi / 3.0) for k in range(3))
    noise = np.random.default_rng(3).normal(0.0, 0.01, (2, len(turns)))
    late_turn = 0.5 * hysteresis_deg / 360.0 * np.sign(speed_turn_per_s)
    sector = np.searchsorted(EDGES_DEG, (turns - late_turn) % 1.0 * 360.0, side="right") - 1
    state = np.array([5, 1, 3, 2, 6, 4])[sector]
    shaft = (turns - INDEX_DEG / 360.0) / POLE_PAIRS
    return {
        "v_ab_v": a - b + noise[0],
        "v_bc_v": b - c + noise[1],
        "hall_a": (state & 1).astype(float),
        "hall_b": (state >> 1 & 1).astype(float),
        "hall_c": (state >> 2 & 1).astype(float),
        "index": (shaft % 1.0 < 0.02).astype(float),
    }


def slowing_down(seconds: float = 2.0) -> Array:
    falling: Array = 40.0 * np.exp(-np.arange(round(seconds / SAMPLE_S)) * SAMPLE_S / 1.5)
    return falling


def both_ways() -> Array:
    """From 40 turns a second forward to 40 backward and forward again."""
    speed: Array = 40.0 * np.cos(np.arange(40_000) * SAMPLE_S * 2.0)
    return speed


def recording(folder: Path, table: dict[str, Array]) -> Path:
    path = folder / "spun.csv"
    rows = [
        ",".join(table),
        *(",".join(f"{value:.4f}" for value in row) for row in zip(*table.values(), strict=True)),
    ]
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


def beside_deg(one: float, other: float) -> float:
    return abs((one - other + 180.0) % 360.0 - 180.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_edges_of_a_decelerating_wheel_are_found_within_half_a_degree_in_either_direction(
    direction: float,
) -> None:
    """At 40 turns a second a sample is 1.4 deg, of which the middle is taken, and there are dozens
    of edges.
    """
    found = calibrate.calibrate(spun(direction * slowing_down()))
    for place, truth in zip(found.hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) < 0.5
        assert place.edges > 20


def test_the_index_angle_is_found() -> None:
    found = calibrate.calibrate(spun(slowing_down()))
    assert found.index is not None
    assert beside_deg(found.index.angle_deg, INDEX_DEG) < 1.0


def test_reversal_of_the_direction_does_not_change_the_calibration() -> None:
    found = calibrate.calibrate(spun(both_ways()))
    for place, truth in zip(found.hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) < 0.5
    assert found.index is not None
    assert beside_deg(found.index.angle_deg, INDEX_DEG) < 0.5
    assert found.both_directions


@pytest.mark.parametrize("hysteresis_deg", [2.0, 8.0, 20.0])
def test_hysteresis_is_not_counted_as_an_offset(
    hysteresis_deg: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The edges of both directions lie half the hysteresis either side of the sensor's place."""
    found = calibrate.calibrate(spun(both_ways(), hysteresis_deg))
    for place, truth in zip(found.hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) < 0.5
        assert place.hysteresis_deg == pytest.approx(hysteresis_deg, abs=0.6)
        assert place.spread_deg < 2.0  # a sample at 40 turns a second is 1.4 deg
    one_way = calibrate.calibrate(spun(slowing_down(), hysteresis_deg))
    assert not one_way.both_directions
    for place, truth in zip(one_way.hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) == pytest.approx(hysteresis_deg / 2.0, abs=0.5)
    assert "and half the hysteresis, as turned in one direction only" in calibrate.as_toml(one_way)
    path = recording(tmp_path, spun(slowing_down(), hysteresis_deg))
    assert cli.main(["calibrate", str(path)]) == 0
    assert "warning: turned in one direction only" in capsys.readouterr().err


@pytest.mark.parametrize("speed", ["one way", "both ways"])
def test_offsets_of_an_oscilloscope_s_channels_do_not_count(speed: str) -> None:
    """A tenth of the largest voltage, where a tenth unnoticed is 5.8 deg."""
    table = spun(slowing_down() if speed == "one way" else both_ways())
    peak_v = float(np.max(np.abs(table["v_ab_v"])))
    table["v_ab_v"] += 0.1 * peak_v
    table["v_bc_v"] -= 0.06 * peak_v
    for place, truth in zip(calibrate.calibrate(table).hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) < 0.7
        assert place.spread_deg < 2.5


def test_logic_channels_switch_at_the_middle_of_their_own_levels() -> None:
    """Sensors of 5 V on an offset, through a filter that makes their edges three samples long."""
    table = spun(both_ways(), 4.0)
    rise = np.ones(4) / 4.0
    for name in calibrate.HALLS:
        padded = np.concatenate([[table[name][0]] * 2, table[name], [table[name][-1]]])
        table[name] = 5.0 * np.convolve(padded, rise, mode="valid") + 0.7
    for place, truth in zip(calibrate.calibrate(table).hall_edges, EDGES_DEG, strict=True):
        assert beside_deg(place.angle_deg, truth) < 0.8


@pytest.mark.parametrize("inverted", ["", "a", "b", "ac"])
@pytest.mark.parametrize("inputs", list(itertools.permutations("abc")))
def test_inverted_lines_in_any_order_give_keys_with_which_every_edge_is_where_it_is(
    inputs: tuple[str, ...], inverted: str
) -> None:
    """Of the controller's sectors with those keys, whatever sectors they are."""
    right = spun(both_ways(), 4.0)
    table = dict(right)
    for at, sensor in zip("abc", inputs, strict=True):
        level = right[f"hall_{sensor}"]
        table[f"hall_{at}"] = 1.0 - level if sensor in inverted else level
    found = calibrate.calibrate(table)
    keys = tomllib.loads(calibrate.as_toml(found))["rotor"]
    own = halls.wiring(rotor_section.Rotor(**keys))
    assert {round(edge) for edge in own.edges_deg} == {round(edge) for edge in EDGES_DEG}
    for turn in np.linspace(0.0, 1.0, 200, endpoint=False):
        sector = int(np.searchsorted(EDGES_DEG, turn * 360.0, side="right")) - 1
        levels = dict(
            zip("abc", [(5, 1, 3, 2, 6, 4)[sector] >> k & 1 for k in range(3)], strict=True)
        )
        shown = [levels[sensor] ^ (sensor in inverted) for sensor in inputs]
        line = [bit ^ (own.lines >> k & 1) for k, bit in enumerate(shown)]
        a, b, c = (line[0], line[2], line[1]) if own.lines & 8 else line
        begins = own.edges_deg[(5, 1, 3, 2, 6, 4).index(a | b << 1 | c << 2)]
        assert beside_deg(begins, EDGES_DEG[sector]) < 1.0


def test_a_sensor_that_never_switches_is_refused() -> None:
    table = spun(slowing_down())
    table["hall_b"] = np.zeros_like(table["hall_b"])
    with pytest.raises(ConfigurationError, match="one sensor changing at a time"):
        calibrate.calibrate(table)


def test_a_short_recording_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="accepted: at least"):
        calibrate.calibrate(spun(slowing_down()[:400]))


def test_the_command_prints_lines_for_the_drive_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recording(tmp_path, spun(both_ways()))
    assert cli.main(["calibrate", str(path)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("[rotor]\n")
    assert "hall_edges_deg = [" in out
    assert "encoder_index_deg = " in out


def test_a_file_without_the_required_channels_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "other.csv"
    path.write_text("time_s,x\n0,1\n", encoding="utf-8")
    assert cli.main(["calibrate", str(path)]) != 0
    assert "accepted: a table with the columns v_ab_v" in capsys.readouterr().err
