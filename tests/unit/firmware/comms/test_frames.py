# SPDX-License-Identifier: Apache-2.0
"""Frames packed by the firmware and decoded by cantools with the DBC, and vice versa.

cantools computes AUTOSAR's profiles 2 and 5 by itself, so checksum and layout have two independent
implementations.
"""

import random
from collections.abc import Iterator

import cantools
import pytest
from cantools.autosar.end_to_end import (
    apply_profile2_crc,
    apply_profile5_crc,
    compute_profile2_crc,
    compute_profile5_crc,
)
from cantools.database.can import Database, Message, Signal
from protocol import DBC, FOUR_WHEELS_DBC, MODULE, WHEELS, Comms, CValue, attribute

# The list of e2e.c, derived from four entries as in its comment.
VERSION = 2  # of the protocol
BASIS = {1: 0x90, 2: 0xAA, 4: 0xC0, 8: 0x60}

SENT = [
    *("WheelState", "WheelBrake", "WheelDrive", "WheelPower", "WheelHealth"),
    *("WheelAhead", "WheelAvailable"),
]
KINDS = {
    "Demand": "MESSAGES_DEMAND",
    "HydraulicFeedback": "MESSAGES_HYDRAULIC_FEEDBACK",
    "BatteryLimits": "MESSAGES_BATTERY_LIMITS",
    "BatteryPeak": "MESSAGES_BATTERY_PEAK",
    "WheelState": "MESSAGES_WHEEL_STATE",
    "WheelBrake": "MESSAGES_WHEEL_BRAKE",
    "WheelDrive": "MESSAGES_WHEEL_DRIVE",
    "WheelPower": "MESSAGES_WHEEL_POWER",
    "WheelHealth": "MESSAGES_WHEEL_HEALTH",
    "WheelAhead": "MESSAGES_WHEEL_AHEAD",
    "WheelAvailable": "MESSAGES_WHEEL_AVAILABLE",
    "WheelEnergy": "MESSAGES_WHEEL_ENERGY",
}

# Member of slow_output_t or, with a dot, of messages_values_t; and the signal it becomes: message,
# name, milli-units (or hundredths)
# of one unit.
PHYSICAL = {
    "motor_torque_command_mNm": ("WheelDrive", "motor_torque_command_nm", 1000),
    "motor_torque_estimate_mNm": ("WheelState", "motor_torque_estimate_nm", 1000),
    "hydraulic_torque_mNm": ("WheelBrake", "hydraulic_torque_nm", 1000),
    "electric_brake_available_mNm": ("WheelBrake", "electric_brake_available_nm", 1000),
    "electric_brake_ahead_mNm": ("WheelAhead", "electric_brake_ahead_nm", 1000),
    "drive_ahead_mNm": ("WheelAhead", "drive_ahead_nm", 1000),
    "drive_available_mNm": ("WheelAvailable", "drive_available_nm", 1000),
    "speed_mrad_s": ("WheelState", "speed_rad_s", 1000),
    "i_q_mA": ("WheelDrive", "current_q_a", 1000),
    "bus_voltage_mV": ("WheelPower", "bus_voltage_v", 1000),
    "bus_current_mA": ("WheelPower", "bus_current_a", 1000),
    "motor_torque_uncertainty_mNm": ("WheelPower", "motor_torque_uncertainty_nm", 1000),
    "temperature.winding_cC": ("WheelHealth", "winding_temperature_c", 100),
    "temperature.switch_cC": ("WheelHealth", "switch_temperature_c", 100),
}
ROUNDED_DOWN = {
    *("electric_brake_available_mNm", "electric_brake_ahead_mNm"),
    *("drive_available_mNm", "drive_ahead_mNm"),
}
NUMBERS = {
    "torque_reason": ("WheelDrive", "torque_reason"),
    "available_reason": ("WheelAvailable", "electric_brake_available_reason"),
    "hydraulic_reason": ("WheelDrive", "hydraulic_reason"),
    "ahead_reason": ("WheelAhead", "ahead_reason"),
    "drive_ahead_reason": ("WheelAhead", "drive_ahead_reason"),
    "drive_available_reason": ("WheelAvailable", "drive_available_reason"),
    "waits_for": ("WheelAvailable", "waits_for"),
    "fault_reason": ("WheelState", "fault_reason"),
    "warning_reason": ("WheelHealth", "warning_reason"),
    "hydraulic_valid": ("WheelBrake", "hydraulic_valid"),
    "direction": ("WheelDrive", "direction"),
    "mode": ("WheelState", "mode"),
    "stop_lamp": ("WheelState", "stop_lamp"),
    "links.demand": ("WheelHealth", "demand_link"),
    "links.battery": ("WheelHealth", "battery_link"),
    "links.hydraulic": ("WheelHealth", "hydraulic_link"),
    "links.peak": ("WheelHealth", "peak_link"),
    "links.demand_errors": ("WheelHealth", "demand_errors"),
    "links.battery_errors": ("WheelHealth", "battery_errors"),
    "links.demand_counter": ("WheelBrake", "demand_counter"),
}


def data_id(identifier: int, counter: int) -> int:
    """Return the data id of e2e.h with profile 2."""
    entry = VERSION << 5
    for bit, value in BASIS.items():
        entry ^= value if counter & bit else 0
    return entry ^ (identifier & 0xFF)


PROFILE_5 = {"Demand", "HydraulicFeedback", "BatteryLimits", "BatteryPeak", "WheelBrake"}


def expected_bytes(name: str, data: bytes, identifier: int) -> bytes:
    """Return the frame as the independent implementation protects this content."""
    if name in PROFILE_5:
        protected = apply_profile5_crc(data, VERSION << 11 | identifier)
    else:
        protected = apply_profile2_crc(data, data_id(identifier, data[1] & 0x0F))
    assert protected is not None
    return bytes(protected)


def content(frame: CValue) -> bytes:
    assert frame.length == 8
    return bytes(frame.data)


def output_frame(comms: Comms, message: str, wheel: int, counter: int, **values: int) -> CValue:
    """Return a frame with these values, the others zero."""
    output, temperature = comms.struct("slow_output_t"), comms.struct("wheel_temperatures_t")
    sent = comms.struct("messages_values_t", output=output, temperature=temperature)
    parts = {"": output, "temperature": temperature, "links": sent.links}
    for name, value in values.items():
        part, _, member = name.rpartition(".")
        setattr(parts[part], member, value)
    kind = comms.number(KINDS[message])
    return comms.lib.messages_output(kind, sent, comms.address(wheel), counter)


def values_in(database: Database, frame: CValue) -> dict[str, float]:
    """Return what cantools reads in a frame."""
    message = database.get_message_by_frame_id(frame.identifier)
    found = message.decode(content(frame), decode_choices=False)
    assert isinstance(found, dict)
    numbers = {name: value for name, value in found.items() if isinstance(value, int | float)}
    account = [found["account"]] if "account" in found else None
    carried = [s for s in message.signals if s.multiplexer_ids in (None, account)]
    assert set(numbers) == {signal.name for signal in carried}
    return numbers


def energy_frame(comms: Comms, wheel: int, counter: int, *accounts: tuple[int, int, int]) -> CValue:
    """Return WheelEnergy: drawn and returned in units of 10 J, friction's share of each account."""
    made = [
        comms.struct(
            "messages_energy_t", drawn_10J=drawn, returned_10J=back, friction_percent=share
        )
        for drawn, back, share in accounts
    ]
    return comms.lib.messages_energy(*made, comms.address(wheel), counter)


def decoded(comms: Comms, database: Database, message: str, **values: int) -> dict[str, float]:
    frame = output_frame(comms, message, 0, 0, **values)
    return values_in(database, frame)


def signal_of(database: Database, message: str, signal: str) -> Signal:
    return database.get_message_by_name(message).get_signal_by_name(signal)


def frames(comms: Comms) -> Iterator[tuple[str, int, int, CValue]]:
    """Yield one frame of every message, wheel and counter: name, wheel, counter, frame."""
    demand = comms.struct(
        "wheel_demand_t", drive_torque_mNm=-12300, brake_torque_mNm=456700, enable=True
    )
    battery = comms.struct(
        "battery_limits_t",
        charge_current_mA=123400,
        discharge_current_mA=567800,
        contactor=comms.lib.CONTACTOR_OPEN,
    )
    hydraulic = comms.struct("hydraulic_feedback_t", torque_mNm=34500, valid=True)
    front_left = comms.address(0)
    for counter in range(16):
        yield "BatteryLimits", 0, counter, comms.lib.messages_battery(battery, front_left, counter)
        yield "BatteryPeak", 0, counter, comms.lib.messages_peak(battery, front_left, counter)
        for wheel in WHEELS.values():
            place = comms.address(wheel)
            yield "Demand", wheel, counter, comms.lib.messages_demand(demand, place, counter)
            measured = comms.lib.messages_hydraulic(hydraulic, place, counter)
            yield "HydraulicFeedback", wheel, counter, measured
            for name in SENT:
                values = {
                    "speed_mrad_s": 123450,
                    "bus_current_mA": -4300,
                    "mode": 4,
                    "i_q_mA": -77700,
                    "hydraulic_torque_mNm": 900,
                }
                yield name, wheel, counter, output_frame(comms, name, wheel, counter, **values)
            accounts = (4711, 815, 42), (123_456_789, 98_765, 7)
            yield "WheelEnergy", wheel, counter, energy_frame(comms, wheel, counter, *accounts)


# ---- end-to-end protection ----


def test_every_message_of_every_wheel_is_as_an_independent_implementation_protects_it(
    comms: Comms,
) -> None:
    count = 0
    for name, _, counter, frame in frames(comms):
        data = content(frame)
        assert (data[2] if name in PROFILE_5 else data[1] & 0x0F) == counter, name
        assert data == expected_bytes(name, data, frame.identifier), (name, counter)
        profile = comms.lib.messages_profile(comms.number(KINDS[name]))
        assert profile == comms.number(f"E2E_PROFILE_{5 if name in PROFILE_5 else 2}"), name
        count += 1
    assert count == 16 * (2 + 4 * 10)


@pytest.mark.parametrize("profile", [2, 5])
def test_checksums_of_random_content_equal_an_independent_implementation(
    profile: int, comms: Comms
) -> None:
    dice = random.Random(profile)
    kind = comms.number(f"E2E_PROFILE_{profile}")
    for _ in range(2000):
        identifier, counter = dice.randrange(0x800), dice.randrange(16 if profile == 2 else 256)
        data = comms.ffi.new("uint8_t[8]", dice.randbytes(8))
        comms.lib.e2e_protect(kind, data, identifier, counter)
        made = bytes(data)
        if profile == 5:
            assert made[2] == counter
            assert int.from_bytes(made[:2], "little") == compute_profile5_crc(
                made, VERSION << 11 | identifier
            )
        else:
            assert made[1] & 0x0F == counter
            assert made[0] == compute_profile2_crc(made, data_id(identifier, counter))
        assert comms.lib.e2e_intact(kind, data, identifier)
        data[0] ^= dice.randrange(1, 256)
        assert not comms.lib.e2e_intact(kind, data, identifier)


def test_a_client_that_knows_the_four_wheels_dbc_alone_is_understood(comms: Comms) -> None:
    """Profile, data ids and identifier come from its attributes, checksums from cantools."""
    four = cantools.database.load_file(str(FOUR_WHEELS_DBC), strict=True)
    assert isinstance(four, Database)
    for message in four.messages:
        for counter in range(16):
            carried = [s for s in message.signals if s.multiplexer_ids in (None, [0])]
            start = {signal.name: signal.initial or 0 for signal in carried}
            data = bytes(message.encode(start | {"counter": counter}))
            if attribute(message, "E2EProfile") == 5:
                sent = apply_profile5_crc(data, int(attribute(message, "E2EDataID")))
                profile = comms.lib.E2E_PROFILE_5
            else:
                ids = str(attribute(message, "E2EDataIDList")).split()
                sent = apply_profile2_crc(data, int(ids[counter]))
                profile = comms.lib.E2E_PROFILE_2
            assert sent is not None
            frame = comms.ffi.new("uint8_t[8]", bytes(sent))
            assert comms.lib.e2e_intact(profile, frame, message.frame_id), message.name
        assert attribute(message, "E2EMaxDeltaCounter") == comms.lib.E2E_STEP_MAX


def test_a_sender_of_the_version_before_is_refused_whatever_it_sends(comms: Comms) -> None:
    """Its data ids were the identifier, and with profile 2 the list without a version."""
    dice = random.Random(7)
    for name, _, counter, frame in frames(comms):
        data = bytes([0, 0, *dice.randbytes(6)])
        if name in PROFILE_5:
            old = apply_profile5_crc(data, frame.identifier)
        else:
            data = bytes([0, data[2] & 0xF0 | counter, *data[2:]])
            old = apply_profile2_crc(data, data_id(frame.identifier, counter) ^ VERSION << 5)
        assert old is not None
        profile = comms.number(f"E2E_PROFILE_{5 if name in PROFILE_5 else 2}")
        sent = comms.ffi.new("uint8_t[8]", bytes(old))
        for wheel in WHEELS.values():  # nor under the identifier of another wheel
            received = frame.identifier & ~3 | wheel
            assert not comms.lib.e2e_intact(profile, sent, received), name


def test_the_sixteen_data_ids_of_a_message_differ(comms: Comms) -> None:
    """From frames only: one content with sixteen counter values.

    Without the contribution of the counter the ids remain.
    """
    for name, wheel in (("WheelState", 0), ("WheelHealth", 3)):
        found = set()
        for counter in range(16):
            frame = output_frame(comms, name, wheel, counter)
            data = content(frame)
            matching = [
                candidate
                for candidate in range(256)
                if compute_profile2_crc(data, candidate) == data[0]
            ]
            assert len(matching) == 1
            found.update(matching)
        assert len(found) == 16


def test_the_readme_contains_the_list_of_data_ids() -> None:
    printed = " ".join(f"{data_id(0, counter):02X}" for counter in range(16))
    assert f"\n    {printed}\n" in (MODULE / "README.md").read_text(encoding="utf-8")


# ---- layout ----


@pytest.mark.parametrize("name", KINDS)
def test_identifiers_and_cycles_equal_those_of_the_dbc(
    name: str, comms: Comms, database: Database
) -> None:
    message: Message = database.get_message_by_name(name)
    for wheel in WHEELS.values():
        offset = 0 if name.startswith("Battery") else wheel
        assert (
            comms.lib.messages_identifier(comms.number(KINDS[name]), comms.address(wheel))
            == message.frame_id + offset
        )
    assert comms.lib.messages_cycle_ms(comms.number(KINDS[name])) == message.cycle_time


def test_wheels_have_the_numbers_of_the_dbc(comms: Comms) -> None:
    text = DBC.read_text(encoding="utf-8")
    for name, number in WHEELS.items():
        assert comms.number(f"MESSAGES_{name}") == number
        assert f"{name.lower().replace('_', ' ')} {number}" in text


@pytest.mark.parametrize("name", KINDS)
def test_one_dbc_decodes_every_wheel(name: str, comms: Comms, all_wheels: Database) -> None:
    seen = 0
    for made, _, counter, frame in frames(comms):
        if made == name:
            assert all_wheels.get_message_by_frame_id(frame.identifier).name == name
            assert values_in(all_wheels, frame)["counter"] == counter
            seen += 1
    assert seen >= 16


@pytest.mark.parametrize("member", PHYSICAL)
def test_a_quantity_is_transferred_within_half_a_step_and_changes_no_other(
    member: str, comms: Comms, database: Database
) -> None:
    """Random values over the whole range; every other quantity of the message must stay zero."""
    message, name, per_unit = PHYSICAL[member]
    signal = signal_of(database, message, name)
    lowest, highest = signal.minimum, signal.maximum
    assert lowest is not None and highest is not None
    step = float(signal.conversion.scale)
    dice = random.Random(member)
    zero = decoded(comms, database, message)
    values = [dice.randint(int(lowest * per_unit), int(highest * per_unit)) for _ in range(200)]
    for value in [0, int(lowest * per_unit), int(highest * per_unit), *values]:
        got = decoded(comms, database, message, **{member: value})
        error = got[name] - value / per_unit
        if member in ROUNDED_DOWN:
            assert -step - 1e-9 < error <= 1e-9, "a promise may not be larger than what is there"
        else:
            assert abs(error) <= step / 2 + 1e-9
        assert {k: v for k, v in got.items() if k not in (name, "crc")} == {
            k: v for k, v in zero.items() if k not in (name, "crc")
        }


def not_available(signal: Signal) -> float:
    """Return what stands for a quantity beyond the range: the number with this name, or 300."""
    named = [raw for raw, meaning in (signal.choices or {}).items() if meaning == "NOT_AVAILABLE"]
    return float(named[0] * signal.conversion.scale) if named else 300.0


@pytest.mark.parametrize("member", sorted(set(PHYSICAL) - {"hydraulic_torque_mNm"}))
def test_a_quantity_beyond_its_range_is_not_available_instead_of_the_end_of_it(
    member: str, comms: Comms, database: Database
) -> None:
    """Over all 32 bits: within half a step, or not available; no magnitude is below zero."""
    message, name, per_unit = PHYSICAL[member]
    signal = signal_of(database, message, name)
    lowest, highest = signal.minimum, signal.maximum
    assert lowest is not None and highest is not None
    step, absent = float(signal.conversion.scale), not_available(signal)
    ends = [int(end * per_unit) + more for end in (lowest, highest) for more in range(-60, 61)]
    dice = random.Random(member)
    wild = [int(dice.choice([-1, 1]) * 2 ** dice.uniform(0, 31)) for _ in range(2000)]
    seen = 0
    for value in [-(2**31), 2**31 - 1, *ends, *wild]:
        got = decoded(comms, database, message, **{member: value})[name]
        meant = max(value, 0) / per_unit if lowest == 0 else value / per_unit
        seen += got == pytest.approx(absent)
        if got != pytest.approx(absent):
            assert abs(got - meant) < (step if member in ROUNDED_DOWN else step / 2 + 1e-9)
        else:
            assert not lowest <= meant < highest - step / 2
    assert seen > 100


def test_a_hydraulic_command_beyond_its_range_is_not_valid(
    comms: Comms, database: Database
) -> None:
    signal = signal_of(database, "WheelBrake", "hydraulic_torque_nm")
    assert signal.maximum is not None
    most = round(1000 * signal.maximum)
    for value in (0, 100, most, most + 49, most + 50, most + 51, 5_000_000, 2**31 - 1):
        got = decoded(
            comms, database, "WheelBrake", hydraulic_torque_mNm=value, hydraulic_valid=True
        )
        right = abs(round(1000 * got["hydraulic_torque_nm"]) - value) < 50
        assert got["hydraulic_valid"] == int(right)


@pytest.mark.parametrize(
    "member",
    ["motor_torque_command_mNm", "speed_mrad_s", "bus_current_mA", "temperature.winding_cC"],
)
def test_rounding_is_symmetric_in_the_sign(member: str, comms: Comms, database: Database) -> None:
    message, name, per_unit = PHYSICAL[member]
    for value in (*range(1, 120), 4999, 9876):
        plus = decoded(comms, database, message, **{member: value})[name]
        minus = decoded(comms, database, message, **{member: -value})[name]
        assert plus == pytest.approx(-minus), value
        assert plus == pytest.approx(
            value / per_unit, abs=float(signal_of(database, message, name).conversion.scale)
        )


@pytest.mark.parametrize("member", NUMBERS)
def test_an_integer_is_transferred_unchanged_in_the_width_of_its_field(
    member: str, comms: Comms, database: Database
) -> None:
    message, name = NUMBERS[member]
    width = signal_of(database, message, name).length
    zero = decoded(comms, database, message)
    for value in range(2**width):
        got = decoded(comms, database, message, **{member: value})
        assert got[name] == value
        assert {k: v for k, v in got.items() if k not in (name, "crc")} == {
            k: v for k, v in zero.items() if k not in (name, "crc")
        }


def test_error_counters_wrap(comms: Comms, database: Database) -> None:
    errors = {"links.demand_errors": 256 + 7, "links.battery_errors": 2**32 - 1}
    got = decoded(comms, database, "WheelHealth", **errors)
    assert (got["demand_errors"], got["battery_errors"]) == (7, 15)


def test_a_broken_temperature_sensor_is_300_degrees(comms: Comms, database: Database) -> None:
    """hal/analog.h reports 29 999 hundredths for a broken or missing sensor."""
    broken = {"temperature.winding_cC": 29999, "temperature.switch_cC": 29999}
    got = decoded(comms, database, "WheelHealth", **broken)
    assert (got["winding_temperature_c"], got["switch_temperature_c"]) == (300.0, 300.0)


# ---- the energy accounts ----

JOULE_A_UNIT = 10
JOULE_A_WH = 3600.0


def test_the_accounts_come_in_turn_and_are_read_with_both_dbcs(
    comms: Comms, all_wheels: Database
) -> None:
    """3.6 MJ are 1 kWh; a quarter of it came back, and friction took 12 % of the braking."""
    four = cantools.database.load_file(str(FOUR_WHEELS_DBC), strict=True)
    assert isinstance(four, Database)
    started, life = (360_000, 90_000, 12), (360_000_000, 180_000_000, 100)
    for name, wheel in WHEELS.items():
        for counter in range(16):
            frame = energy_frame(comms, wheel, counter, started, life)
            own = f"WheelEnergy{name.title().replace('_', '')}"
            assert four.get_message_by_frame_id(frame.identifier).name == own
            for database in (all_wheels, four):
                values = values_in(database, frame)
                assert (values.pop("counter"), values.pop("account")) == (counter, counter % 2)
                del values["crc"]
                if counter % 2 == 0:
                    expected = {"drawn_wh": 1000.0, "returned_wh": 250.0, "friction_percent": 12}
                else:
                    expected = {
                        "life_drawn_wh": 1e6, "life_returned_wh": 5e5, "life_friction_percent": 100
                    }  # fmt: skip
                assert values == pytest.approx(expected)


@pytest.mark.parametrize(("prefix", "step_wh"), [("", 0.1), ("life_", 5.0)])
def test_an_energy_is_rounded_down_by_less_than_a_step_and_never_wraps(
    prefix: str, step_wh: float, comms: Comms, database: Database
) -> None:
    """Over all that the account holds, 11.93 MWh; beyond the range it is not available."""
    dice = random.Random(prefix)
    most = 2**32 - 1
    steps = [round(step_wh * JOULE_A_WH / JOULE_A_UNIT) * k for k in (1, 2, 4_194_302, 4_194_303)]
    near = [step + more for step in steps for more in (-1, 0, 1) if step + more <= most]
    counts = [0, 1, most, *near, *(int(2 ** dice.uniform(0, 32)) for _ in range(500))]
    signal = signal_of(database, "WheelEnergy", f"{prefix}drawn_wh")
    absent = 0
    for count in counts:
        for place, name in enumerate(("drawn_wh", "returned_wh")):
            account = [0, 0, 0]
            account[place] = count
            both = (tuple(account), (0, 0, 0)) if not prefix else ((0, 0, 0), tuple(account))
            frame = energy_frame(comms, 0, 0 if not prefix else 1, *both)
            values = values_in(database, frame)
            got, true_wh = values[f"{prefix}{name}"], count * JOULE_A_UNIT / JOULE_A_WH
            assert values[f"{prefix}{'returned_wh' if place == 0 else 'drawn_wh'}"] == 0.0
            if not prefix and got == pytest.approx(not_available(signal), abs=0.01):
                assert true_wh >= (signal.maximum or 0) + step_wh - 1e-6
                absent += 1
            else:
                assert got - 1e-6 <= true_wh < got + step_wh + 1e-6
                assert got <= (signal.maximum or 0) + 1e-6
    assert (absent > 0) == (not prefix)


def test_the_share_of_friction_is_a_percentage_or_not_available(
    comms: Comms, database: Database
) -> None:
    for share in range(256):
        for counter, name in ((0, "friction_percent"), (1, "life_friction_percent")):
            accounts = ((0, 0, share if counter == 0 else 0), (0, 0, share if counter else 0))
            got = values_in(database, energy_frame(comms, 0, counter, *accounts))[name]
            assert got == (share if share <= 100 else 127)


# ---- frames of vehicle and battery, packed by cantools ----


def received(comms: Comms, database: Database, message: str, values: dict[str, float]) -> CValue:
    """Return the frame cantools makes, as the C sees it."""
    encoded = database.encode_message(message, {"crc": 0, "counter": 0, **values}, strict=False)
    frame = comms.struct(
        "messages_frame_t", identifier=database.get_message_by_name(message).frame_id, length=8
    )
    frame.data[0:8] = list(encoded)
    return frame


def test_a_demand_made_by_another_tool_is_read_exactly(comms: Comms, database: Database) -> None:
    dice = random.Random(3)
    for _ in range(1000):
        drive, brake = dice.randint(-8191, 8191), dice.randint(0, 16383)
        flags = {name: dice.randint(0, 1) for name in ("enable", "abs_active", "fault_reset")}
        flags["direction"] = dice.randint(0, 2)
        flags["abs_motor_share_percent"] = dice.randint(0, 100)
        frame = received(
            comms,
            database,
            "Demand",
            {"drive_torque_nm": drive / 5, "brake_torque_nm": brake / 5, **flags},
        )
        demand = comms.struct("wheel_demand_t")
        assert comms.lib.messages_read_demand(frame, demand)
        assert (demand.drive_torque_mNm, demand.brake_torque_mNm) == (200 * drive, 200 * brake)
        assert {name: int(getattr(demand, name)) for name in flags} == flags


def test_battery_limits_made_by_another_tool_are_read_exactly(
    comms: Comms, database: Database
) -> None:
    dice = random.Random(4)
    for _ in range(1000):
        charge, discharge = dice.randint(0, 320_000), dice.randint(0, 320_000)
        contactor = dice.randint(0, 2)
        frame = received(
            comms,
            database,
            "BatteryLimits",
            {
                "charge_current_a": charge / 10,
                "discharge_current_a": discharge / 10,
                "contactor": contactor,
            },
        )
        battery = comms.struct("battery_limits_t")
        assert comms.lib.messages_read_battery(frame, battery)
        assert (battery.charge_current_mA, battery.discharge_current_mA) == (
            100 * charge,
            100 * discharge,
        )
        assert battery.contactor == contactor


@pytest.mark.parametrize(
    ("message", "signal"),
    [
        ("Demand", "drive_torque_nm"),
        ("Demand", "direction"),
        ("Demand", "abs_motor_share_percent"),
        ("BatteryLimits", "charge_current_a"),
        ("BatteryLimits", "discharge_current_a"),
    ],
)
def test_the_accepted_range_equals_that_of_the_dbc(
    message: str, signal: str, comms: Comms, database: Database
) -> None:
    described = signal_of(database, message, signal)
    others = {
        other.name: 0.0
        for other in database.get_message_by_name(message).signals
        if other.name not in (signal, "crc", "counter")
    }
    read, kind = {
        "Demand": (comms.lib.messages_read_demand, "wheel_demand_t"),
        "BatteryLimits": (comms.lib.messages_read_battery, "battery_limits_t"),
    }[message]
    step = float(described.conversion.scale)
    lowest, highest = described.minimum, described.maximum
    assert lowest is not None and highest is not None
    for value, accepted in (
        (lowest, True),
        (highest, True),
        (highest + step, False),
        (lowest - step, not described.is_signed),
    ):
        if value < 0 and not described.is_signed:
            continue  # cannot be sent at all
        if round(value / step) >= 2 ** (described.length - described.is_signed):
            continue  # the field ends with the range
        frame = received(comms, database, message, {**others, signal: value})
        assert bool(read(frame, comms.struct(kind))) == accepted, value
