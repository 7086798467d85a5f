# SPDX-License-Identifier: Apache-2.0
"""hubfoc.dbc by itself: contents that a tool with only this file needs."""

import re
from itertools import combinations
from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database, Message, Signal
from protocol import DBC, FOUR_WHEELS_DBC, MODULE, WHEELS, enumerators, listed_in, reasons

# Suffix of a name and its unit.
UNITS = {
    **{"_nm": "Nm", "_rad_s": "rad/s", "_v": "V", "_a": "A", "_wh": "Wh"},
    **{"_c": "degC", "_percent": "%"},
}

# Sections that every tool reads (no VAL_TABLE_, SIG_GROUP_, EV_ and so on).
SECTIONS = {"VERSION", "NS_", "BS_", "BU_", "BO_", "CM_", "BA_DEF_", "BA_DEF_DEF_", "BA_", "VAL_"}
VECTOR_NAME = re.compile(r"[A-Za-z_]\w{0,31}")


def signals(database: Database) -> list[tuple[Message, Signal]]:
    return [(message, signal) for message in database.messages for signal in message.signals]


def test_the_messages_are_those_of_the_protocol(database: Database) -> None:
    assert [message.name for message in database.messages] == [
        "Demand",
        "HydraulicFeedback",
        "BatteryLimits",
        "BatteryPeak",
        "WheelState",
        "WheelBrake",
        "WheelDrive",
        "WheelPower",
        "WheelHealth",
        "WheelAhead",
        "WheelAvailable",
        "WheelEnergy",
    ]


def test_the_version_is_that_of_the_protection(database: Database) -> None:
    text = (MODULE / "generated/protection.h").read_text(encoding="utf-8")
    found = re.search(r"P5_DATA_ID = (0x[0-9a-f]+)", text)
    assert found is not None
    assert int(database.version or "") << 11 == int(found.group(1), 16)


def test_every_signal_required_by_a_brake_system_exists(database: Database) -> None:
    names = {signal.name for _, signal in signals(database)}
    assert names >= {
        *("drive_torque_nm", "brake_torque_nm", "abs_active", "enable", "fault_reset"),
        *("charge_current_a", "discharge_current_a", "contactor"),
        *(
            "motor_torque_command_nm",
            "motor_torque_estimate_nm",
            "motor_torque_uncertainty_nm",
            "electric_brake_available_nm",
            "hydraulic_torque_nm",
        ),
        *(
            "speed_rad_s",
            "bus_voltage_v",
            "bus_current_a",
            "winding_temperature_c",
            "switch_temperature_c",
        ),
        *(
            "mode",
            "torque_reason",
            "electric_brake_available_reason",
            "hydraulic_reason",
            "fault_reason",
            "stop_lamp",
        ),
    }


def test_every_message_has_eight_bytes_a_comment_a_cycle_and_a_sender(
    database: Database,
) -> None:
    for message in database.messages:
        assert message.length == 8, message.name
        assert not message.is_extended_frame and not message.is_fd, message.name
        assert message.comment, message.name
        assert message.cycle_time in (10, 20, 50, 100, 200, 500), message.name
        assert len(message.senders) == 1, message.name


def test_identifiers_are_unique_also_when_every_wheel_has_its_own(database: Database) -> None:
    per_wheel = [message for message in database.messages if message.senders != ["battery"]]
    assert all(message.frame_id % len(WHEELS) == 0 for message in database.messages)
    taken = [message.frame_id + wheel for message in per_wheel for wheel in WHEELS.values()]
    taken += [message.frame_id for message in database.messages if message not in per_wheel]
    assert len(set(taken)) == len(taken)
    assert max(taken) < 0x800
    # The low byte alone makes the data id (e2e.h).
    assert len({identifier & 0xFF for identifier in taken}) == len(taken)


def test_every_signal_has_a_comment_a_range_and_a_receiver(database: Database) -> None:
    for message, signal in signals(database):
        where = f"{message.name}.{signal.name}"
        assert signal.comment, where
        assert signal.receivers, where
        assert signal.minimum is not None and signal.maximum is not None, where
        assert signal.minimum < signal.maximum, where


def test_every_physical_signal_has_the_unit_of_its_suffix_and_numbers_have_none(
    database: Database,
) -> None:
    for message, signal in signals(database):
        promised = [unit for suffix, unit in UNITS.items() if signal.name.endswith(suffix)]
        assert (signal.unit or "") == (promised[0] if promised else ""), (
            f"{message.name}.{signal.name}"
        )


def test_every_range_fits_its_field_and_ends_on_a_whole_step(database: Database) -> None:
    for message, signal in signals(database):
        where = f"{message.name}.{signal.name}"
        lowest = -(2 ** (signal.length - 1)) if signal.is_signed else 0
        highest = 2 ** (signal.length - (1 if signal.is_signed else 0)) - 1
        for end in (signal.minimum, signal.maximum):
            assert end is not None
            steps = (end - signal.conversion.offset) / signal.conversion.scale
            assert abs(steps - round(steps)) < 1e-6, where
            assert lowest <= round(steps) <= highest, where


def bits_of(signal: Signal) -> set[int]:
    assert signal.byte_order == "little_endian"
    return set(range(signal.start, signal.start + signal.length))


def test_signals_do_not_overlap_and_lie_inside_the_frame(database: Database) -> None:
    for message in database.messages:
        for one, other in combinations(message.signals, 2):
            if (one.multiplexer_ids or other.multiplexer_ids) != (
                other.multiplexer_ids or one.multiplexer_ids
            ):
                continue  # never in one frame
            assert not bits_of(one) & bits_of(other), f"{message.name}: {one.name}, {other.name}"
        assert max(max(bits_of(signal)) for signal in message.signals) < 8 * message.length


# AUTOSAR's profile 5: what commands a torque, or limits one. The rest only reports.
PROFILE_5 = {"Demand", "HydraulicFeedback", "BatteryLimits", "BatteryPeak", "WheelBrake"}


def test_checksum_and_counter_are_at_the_positions_of_their_profile(database: Database) -> None:
    for message in database.messages:
        crc, counter = message.get_signal_by_name("crc"), message.get_signal_by_name("counter")
        where = (crc.start, crc.length, counter.start, counter.length)
        assert where == ((0, 16, 16, 8) if message.name in PROFILE_5 else (0, 8, 8, 4)), (
            message.name
        )


def test_the_demand_fills_its_forty_bits(database: Database) -> None:
    signals = database.get_message_by_name("Demand").signals
    assert sum(s.length for s in signals if s.name not in ("crc", "counter")) == 40
    assert max(bit for s in signals for bit in bits_of(s)) == 63


def test_ranges_of_limits_and_demands_are_those_of_the_readme(database: Database) -> None:
    """1638 and 3276 N m a wheel are for cars; 5000 rad/s is the end of config.h's range.

    16 wheels of 2000 A share a pack.
    """
    demand = database.get_message_by_name("Demand")
    for name, needed in (("drive_torque_nm", 1638), ("brake_torque_nm", 3276)):
        assert (demand.get_signal_by_name(name).maximum or 0) >= needed
        assert demand.get_signal_by_name(name).conversion.scale == 0.2
    brake = database.get_message_by_name("WheelBrake")
    for name in ("hydraulic_torque_nm", "electric_brake_available_nm"):
        assert (brake.get_signal_by_name(name).maximum or 0) >= 3276.6
        assert brake.get_signal_by_name(name).conversion.scale == 0.1
    state = database.get_message_by_name("WheelState")
    assert (state.get_signal_by_name("speed_rad_s").maximum or 0) >= 5000
    limits = database.get_message_by_name("BatteryLimits")
    assert (limits.get_signal_by_name("charge_current_a").maximum or 0) >= 16 * 2000


def choices(message: str, signal: str, database: Database) -> dict[int, str]:
    table = database.get_message_by_name(message).get_signal_by_name(signal).choices
    assert table is not None, f"{message}.{signal} has no value table"
    return {int(number): str(name) for number, name in table.items()}


@pytest.mark.parametrize(
    ("message", "signal"),
    [
        ("WheelState", "fault_reason"),
        ("WheelHealth", "warning_reason"),
        ("WheelDrive", "hydraulic_reason"),
        ("WheelAvailable", "electric_brake_available_reason"),
        ("WheelDrive", "torque_reason"),
        ("WheelAhead", "ahead_reason"),
        ("WheelAhead", "drive_ahead_reason"),
        ("WheelAvailable", "drive_available_reason"),
    ],
)
def test_reasons_have_the_firmware_s_numbers_and_names(
    message: str, signal: str, database: Database
) -> None:
    assert choices(message, signal, database) == reasons()


def test_every_reason_signal_has_a_value_table(database: Database) -> None:
    for message, signal in signals(database):
        assert signal.name.endswith("_reason") == (
            signal.choices is not None and 64 in signal.choices
        ), f"{message.name}.{signal.name}"


def test_modes_have_the_firmware_s_numbers_and_names(database: Database) -> None:
    modes = enumerators("core/include/core/operating_mode.h", "MODE")
    assert len(modes) >= 7
    assert choices("WheelState", "mode", database) == modes


@pytest.mark.parametrize("message", ["Demand", "WheelDrive"])
def test_directions_have_the_firmware_s_numbers_and_names(message: str, database: Database) -> None:
    directions = enumerators("core/include/core/drive_direction.h", "DRIVE_DIRECTION")
    assert len(directions) == 3
    assert choices(message, "direction", database) == directions


def test_what_is_waited_for_has_the_firmware_s_numbers_and_names(database: Database) -> None:
    listed = listed_in("core/include/core/waits_for.h")
    assert len(listed) >= 14
    assert choices("WheelAvailable", "waits_for", database) == listed


@pytest.mark.parametrize("signal", ["demand_link", "battery_link", "hydraulic_link", "peak_link"])
def test_link_states_have_the_firmware_s_numbers_and_names(signal: str, database: Database) -> None:
    links = enumerators("comms/include/comms/e2e.h", "E2E")
    expected = {
        number: name
        for number, name in links.items()
        if name in ("NO_DATA", "QUALIFYING", "VALID", "TIMED_OUT")
    }
    assert len(expected) == 4
    assert choices("WheelHealth", signal, database) == expected


def test_the_dbc_of_four_wheels_has_every_message_of_each_wheel(database: Database) -> None:
    four = cantools.database.load_file(str(FOUR_WHEELS_DBC), strict=True)
    assert isinstance(four, Database)
    assert four.version == database.version
    expected = {}
    for message in database.messages:
        for wheel, number in WHEELS.items():
            each = message.senders != ["battery"]
            suffix = wheel.title().replace("_", "") if each else ""
            own = {"wheel": f"wheel_{wheel.lower()}"}
            expected[message.name + suffix] = (
                message.frame_id + (number if each else 0),
                [own.get(sender, sender) for sender in message.senders],
                message.cycle_time,
                message.comment,
                [
                    (s.name, s.start, s.length, s.conversion, s.minimum, s.maximum, s.raw_initial)
                    for s in message.signals
                ],
                [(s.unit, s.comment, s.choices) for s in message.signals],
            )
    assert {message.name for message in four.messages} == set(expected)
    for message in four.messages:
        number, senders, cycle, comment, layout, meaning = expected[message.name]
        assert (message.frame_id, message.senders) == (number, senders)
        assert (message.cycle_time, message.comment) == (cycle, comment)
        assert repr(layout) == repr(
            [
                (s.name, s.start, s.length, s.conversion, s.minimum, s.maximum, s.raw_initial)
                for s in message.signals
            ]
        )
        assert repr(meaning) == repr([(s.unit, s.comment, s.choices) for s in message.signals])
        receivers = {receiver for s in message.signals for receiver in s.receivers}
        wheels = {f"wheel_{wheel.lower()}" for wheel in WHEELS}
        if message.name.startswith("Battery"):
            assert receivers == wheels
        else:
            assert len(receivers | set(message.senders)) == 2
            assert len(wheels & (receivers | set(message.senders))) == 1
    assert all(VECTOR_NAME.fullmatch(message.name) for message in four.messages)


def test_start_values_are_in_range_and_zero_but_for_what_is_not_given(database: Database) -> None:
    """A receiver shows them before the first frame, a sender sends them before it knows better."""
    odd = {}
    for message, signal in signals(database):
        raw = signal.raw_initial or 0
        assert isinstance(raw, int)
        physical = raw * signal.conversion.scale
        assert (signal.minimum or 0) <= physical <= (signal.maximum or 0), signal.name
        if raw != 0:
            odd[f"{message.name}.{signal.name}"] = round(physical, 6)
    assert odd == {
        "BatteryPeak.pack_current_a": -1638.4,
        "WheelHealth.winding_temperature_c": 300.0,
        "WheelHealth.switch_temperature_c": 300.0,
    }


@pytest.mark.parametrize("path", [DBC, FOUR_WHEELS_DBC])
def test_the_file_uses_only_constructs_that_every_tool_reads(path: Path) -> None:
    text = path.read_bytes().decode("ascii")
    assert "\r" not in text
    after_names = text.partition("BS_:")[2]
    keywords = {
        line.split(" ")[0].rstrip(":")
        for line in after_names.splitlines()
        if line and not line.startswith(" SG_")
    }
    assert keywords <= SECTIONS
    attributes = re.findall(r'^BA_DEF_ \w+ "(\w+)"', text, re.MULTILINE)
    assert attributes == [
        *("GenMsgCycleTime", "GenSigStartValue"),
        *("E2EProfile", "E2EMaxDeltaCounter", "E2EDataID", "E2EDataIDList"),
    ]


def test_names_are_short_enough_for_every_tool(database: Database) -> None:
    for message, signal in signals(database):
        assert VECTOR_NAME.fullmatch(message.name), message.name
        assert VECTOR_NAME.fullmatch(signal.name), signal.name


def test_every_node_has_a_comment(database: Database) -> None:
    assert {node.name for node in database.nodes} == {"vehicle", "battery", "wheel"}
    assert all(node.comment for node in database.nodes)
