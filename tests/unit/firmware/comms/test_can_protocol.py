# SPDX-License-Identifier: Apache-2.0
"""hubsim.can_protocol against the firmware's C: frames, what is refused, and the receiver."""

import math
import random

import pytest
from cantools.database.can import Database
from hubsim import can_protocol
from protocol import WHEELS, Comms

KINDS = {
    "Demand": "MESSAGES_DEMAND",
    "BatteryLimits": "MESSAGES_BATTERY_LIMITS",
    "WheelState": "MESSAGES_WHEEL_STATE",
    "WheelBrake": "MESSAGES_WHEEL_BRAKE",
}
# Of e2e_status_t.
STATUS = {
    "E2E_OK": "used",
    "E2E_SOME_LOST": "used",
    "E2E_NOT_QUALIFIED": "not_qualified",
    "E2E_REPEATED": "repeated",
    "E2E_WRONG_SEQUENCE": "wrong_sequence",
    "E2E_IMPLAUSIBLE": "implausible",
    "E2E_DAMAGED": "damaged",
}


def random_values(name: str, dice: random.Random) -> dict[str, float]:
    """Return whole steps of every signal, within its range."""
    values: dict[str, float] = {}
    for key, signal in can_protocol.MESSAGES[name].signals.items():
        carried = signal.only is None or values[signal.only[0]] == signal.only[1]
        if key not in ("crc", "counter") and carried:
            least, most = round(signal.least / signal.step), round(signal.most / signal.step)
            values[key] = dice.randint(least, most) * signal.step
    return values


def test_every_message_is_encoded_as_cantools_and_protected_as_the_firmware_does(
    comms: Comms, database: Database
) -> None:
    dice = random.Random(1)
    for message in database.messages:
        profile = can_protocol.MESSAGES[message.name].profile
        kind = comms.number(f"E2E_PROFILE_{profile}")
        for _ in range(50):
            wheel, counter = dice.choice(list(WHEELS.values())), dice.randrange(256)
            values = random_values(message.name, dice)
            identifier, data = can_protocol.encode(
                message.name, values, wheel=wheel, counter=counter
            )
            plain = message.encode({"crc": 0, "counter": 0, **values}, strict=False)
            expected = comms.ffi.new("uint8_t[8]", plain)
            comms.lib.e2e_protect(kind, expected, identifier, counter)
            assert data == bytes(expected), message.name
            assert can_protocol.message_of(identifier) == message.name
            assert comms.lib.e2e_intact(kind, expected, identifier)
            decoded = can_protocol.decode(message.name, data)
            assert decoded is not None
            assert {key: decoded[key] for key in values} == pytest.approx(values)


def test_another_base_moves_identifiers_and_data_ids() -> None:
    for name, message in can_protocol.MESSAGES.items():
        identifier, data = can_protocol.encode(name, {}, wheel=2, base=0x640)
        default = can_protocol.identifier_of(name, 2)
        assert identifier - 0x640 == default - can_protocol.BASE
        assert can_protocol.intact(message.profile, data, identifier)
        assert can_protocol.message_of(identifier, 0x640) == name
        assert can_protocol.message_of(identifier) is None
        if message.profile == 5:
            assert not can_protocol.intact(message.profile, data, default)


def test_a_demand_of_the_module_is_read_by_the_firmware(comms: Comms) -> None:
    dice = random.Random(2)
    for _ in range(300):
        values = random_values("Demand", dice)
        identifier, data = can_protocol.encode("Demand", values, wheel=3, counter=7)
        frame = comms.struct("messages_frame_t", identifier=identifier, length=8)
        frame.data[0:8] = list(data)
        demand = comms.struct("wheel_demand_t")
        assert comms.lib.messages_read_demand(frame, demand)
        assert demand.drive_torque_mNm == round(1000 * values["drive_torque_nm"])
        assert demand.brake_torque_mNm == round(1000 * values["brake_torque_nm"])
        assert demand.abs_motor_share_percent == values["abs_motor_share_percent"]


def test_values_beyond_their_range_are_refused_in_both_directions() -> None:
    with pytest.raises(ValueError, match=r"Demand\.brake_torque_nm: 3300 is not in 0"):
        can_protocol.encode("Demand", {"brake_torque_nm": 3300.0})
    assert can_protocol.decode("Demand", bytes([0, 0, 0, 0xE0, 0x0F, 0, 0, 0])) is None
    assert can_protocol.decode("Demand", bytes(7)) is None
    assert not can_protocol.intact(5, bytes(7), 0x100)
    assert can_protocol.message_of(0x7FF) is None


def test_a_frame_carries_the_energies_of_one_account() -> None:
    own = {"account": 1.0, "life_drawn_wh": 35.0}
    values = can_protocol.decode("WheelEnergy", can_protocol.encode("WheelEnergy", own)[1])
    assert values is not None
    assert {name for name in values if name.endswith("_wh")} == {
        "life_drawn_wh", "life_returned_wh"
    }  # fmt: skip
    assert values["life_drawn_wh"] == 35.0
    with pytest.raises(ValueError, match=r"WheelEnergy\.drawn_wh: only with account 0"):
        can_protocol.encode("WheelEnergy", {"account": 1.0, "drawn_wh": 1.0})


def test_a_quantity_that_is_not_available_is_not_a_number_in_both_directions(comms: Comms) -> None:
    output = comms.struct("slow_output_t", speed_mrad_s=2**31 - 1, fault_reason=73)
    sent = comms.struct("messages_values_t", output=output)
    kind = comms.number("MESSAGES_WHEEL_STATE")
    frame = comms.lib.messages_output(kind, sent, comms.address(0), 3)
    values = can_protocol.decode("WheelState", bytes(frame.data))
    assert values is not None
    assert math.isnan(values["speed_rad_s"])
    assert (values["motor_torque_estimate_nm"], values["fault_reason"]) == (0.0, 73.0)
    encoded = can_protocol.encode(
        "WheelState", {"speed_rad_s": math.nan, "fault_reason": 73}, counter=3
    )
    assert encoded == (frame.identifier, bytes(frame.data))
    with pytest.raises(ValueError, match="NaN"):
        can_protocol.encode("Demand", {"brake_torque_nm": math.nan})


@pytest.mark.parametrize("name", ["Demand", "WheelState"])
def test_the_receiver_answers_as_the_firmware_to_any_sequence(name: str, comms: Comms) -> None:
    """Frames lost, repeated, damaged, late, out of order, of another wheel, implausible."""
    dice = random.Random(name)
    message = can_protocol.MESSAGES[name]
    texts = {comms.number(key): value for key, value in STATUS.items()}
    seen: dict[str, int] = {}
    for _ in range(60):
        receiver = comms.struct("e2e_receiver_t")
        profile = comms.number(f"E2E_PROFILE_{message.profile}")
        cycles = comms.number("E2E_QUALIFYING_FRAMES")
        assert cycles == can_protocol.QUALIFYING_FRAMES
        timeout_ms = can_protocol.TIMEOUT_CYCLES * message.cycle_ms
        comms.lib.e2e_receiver_init(receiver, profile, timeout_ms)
        own = can_protocol.Receiver(name)
        counter, now_ms = dice.randrange(256), 0
        for _ in range(100):
            counter += dice.choice([1] * 12 + [0, 2, 3, 4, 250])
            now_ms += dice.choice([10] * 12 + [0, 30, 49, 50])
            wheel = dice.choice([0] * 15 + [1])
            _, data = can_protocol.encode(
                name, random_values(name, dice), wheel=wheel, counter=counter
            )
            if dice.random() < 0.08:
                at = dice.randrange(64)
                data = bytes(
                    byte ^ (1 << at % 8 if i == at // 8 else 0) for i, byte in enumerate(data)
                )
            if name == "Demand" and dice.random() < 0.05:
                broken = bytes([*data[:3], data[3] | 0xE0, data[4] | 0x0F, *data[5:]])
                data = can_protocol.protect(5, broken, message.identifier, counter)
            sent = comms.ffi.new("uint8_t[8]", data)
            plausible = can_protocol.decode(name, data) is not None
            expected = comms.lib.e2e_receive(receiver, sent, message.identifier, plausible, now_ms)
            got = own.receive(message.identifier, data, now_ms)
            assert got == texts[expected]
            assert receiver.link == comms.number(f"E2E_{own.link}")
            seen[got] = seen.get(got, 0) + 1
        assert own.counts.get("timeouts", 0) == receiver.counts.timeouts
        assert own.counts.get("lost", 0) == receiver.counts.lost
    expected_kinds = set(STATUS.values()) - ({"implausible"} if name != "Demand" else set())
    assert set(seen) == expected_kinds
