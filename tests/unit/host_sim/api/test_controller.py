# SPDX-License-Identifier: Apache-2.0
"""The controller alone.

The list has every member of the messages, and the steps are those of the firmware.
"""

import math
import re

import hubsim
import pytest
from hubsim import variables
from hubsim.engine import ROOT

PORTS = {
    "foc_input_t": ("firmware/foc/include/foc/input.h", variables.FAST_INPUT),
    "fast_output_t": (
        "firmware/controller/include/controller/controller.h", variables.FAST_OUTPUT,
    ),
    "fast_view_t": ("firmware/core/include/core/fast_view.h", variables.FAST_VIEW),
    "slow_input_t": ("firmware/core/include/core/slow_messages.h", variables.SLOW_INPUT),
    "slow_output_t": ("firmware/core/include/core/slow_messages.h", variables.SLOW_OUTPUT),
}  # fmt: skip


def bodies() -> dict[str, str]:
    """Return the structures of the messages by name."""
    headers = {header for header, _ in PORTS.values()}
    text = "".join((ROOT / header).read_text(encoding="utf-8") for header in headers)
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    return {name: body for body, name in re.findall(r"typedef struct \{([^}]*)\} (\w+);", text)}


def members(struct: str) -> list[str]:
    """Return the members of a C structure, those of a structure inside it with a dot.

    An array of three phases gives one member per element.
    """
    known, found = bodies(), []
    for line in known[struct].split(";"):
        inner = line.split()[0] if line.split() else ""
        if inner in known:
            found += [f"{line.split()[1]}.{name}" for name in members(inner)]
            continue
        for name, size in re.findall(r"(\w+)(\[\w+\])?\s*(?=,|$)", line.strip()):
            found += [f"{name}[{k}]" for k in range(3)] if size else [name]
    return found


@pytest.mark.parametrize("struct", PORTS)
def test_the_list_contains_every_member_of_the_messages_once(struct: str) -> None:
    _, port = PORTS[struct]
    listed = [v.member for v in variables.of_port(port)]
    assert sorted(listed) == sorted(members(struct))


def test_a_raw_name_has_the_suffix_of_its_member() -> None:
    """Raw names are those of the firmware: same quantity, same unit."""
    for _, port in PORTS.values():
        for v in variables.of_port(port):
            last = re.sub(
                r"\[([012])\]$", lambda k: "_" + "abc"[int(k[1])], v.member.split(".")[-1]
            )
            assert v.raw_name.endswith(last.rpartition("_")[2]), v


def test_initial_inputs_are_those_of_a_healthy_board_at_standstill(
    angle_config: hubsim.Configuration,
) -> None:
    controller = hubsim.Controller(angle_config)
    expected = {
        "selftest_passed": 1.0,
        "config_accepted": 1.0,
        "direction": 1.0,
        "winding_temperature_c": 25.0,
        "switch_temperature_c": 25.0,
        "bms_charge_current_a": 2e6,
        "bms_discharge_current_a": 2e6,
    }
    for port in (variables.FAST_INPUT, variables.SLOW_INPUT):
        for k, v in enumerate(variables.of_port(port)):
            assert controller.start(port, k) == expected.pop(v.name, 0.0), v.name
    assert expected == {}


def test_names_end_in_their_units() -> None:
    endings = {
        "A": "_a",
        "V": "_v",
        "N.m": "_nm",
        "s": "_s",
        "degC": "_c",
        "turn": "_turn",
        "rad/s": "_rad_per_s",
    }
    for port in hubsim.Controller.variables().values():
        for variable in port:
            if variable.unit in endings:
                assert variable.name.endswith(endings[variable.unit])
            else:
                assert variable.unit in {"", "1"}


def boot(controller: hubsim.Controller, until_s: float = 0.4) -> hubsim.Values:
    """Calibrate and enable a controller at standstill."""
    per_ms = round(1e-3 / controller.period_s)
    slow = controller.slow_step()
    for n in range(round(until_s / controller.period_s)):
        if n % per_ms == 0:
            slow = controller.slow_step(enable=n > 5000)
        controller.fast_step(bus_voltage_v=53.0)
    return slow


def test_a_controller_boots_calibrates_and_reaches_run(angle_config: hubsim.Configuration) -> None:
    controller = hubsim.Controller(angle_config)
    slow = boot(controller)
    assert controller.mode_text(slow.mode) == "RUN"
    assert controller.reason_text(slow.fault_reason) == "no limit"
    assert slow["bus_voltage_v"] == pytest.approx(53.0, abs=61.8 / 4096)


def behaviour(controller: hubsim.Controller) -> list[hubsim.Values]:
    """Return the next outputs of a controller.

    Its complete state affects the outputs for a moving rotor and a demand.
    """
    found = []
    for n in range(400):
        if n % 20 == 0:
            found.append(controller.slow_step(drive_torque_nm=1.0, enable=True))
        found.append(
            controller.fast_step(
                rotor_angle_turn=n / 300.0,
                phase_a_a=0.1 * (n % 5),
                phase_b_a=0.0,
                phase_c_a=0.0,
                bus_voltage_v=52.0,
            )
        )
    return found


def test_a_driving_demand_gives_voltage_of_the_correct_sign(
    angle_config: hubsim.Configuration,
) -> None:
    """At angle 0 the q axis is at right angles to phase a.

    B has to be above c for current that drives forward.
    """
    controller = hubsim.Controller(angle_config)
    boot(controller)
    for n in range(400):
        if n % 20 == 0:
            slow = controller.slow_step(drive_torque_nm=2.0)
        # A little of the current that is wanted: none at all is taken for dead sensors.
        fast = controller.fast_step(phase_b_a=0.5, phase_c_a=-0.5)
    assert slow.motor_torque_command_nm > 0.0
    assert fast.duty_b > fast.duty_a > fast.duty_c


def test_inputs_keep_their_value_until_they_are_set_again(
    angle_config: hubsim.Configuration,
) -> None:
    one, other = hubsim.Controller(angle_config), hubsim.Controller(angle_config)
    for _ in range(50):
        a = one.fast_step(bus_voltage_v=50.0, phase_a_a=1.0, phase_b_a=-1.0)
    other.fast_step(bus_voltage_v=50.0, phase_a_a=1.0, phase_b_a=-1.0)
    for _ in range(49):
        b = other.fast_step()
    assert a == b
    assert behaviour(one) == behaviour(other)


def test_raw_and_engineering_steps_give_the_same_outputs(
    angle_config: hubsim.Configuration,
) -> None:
    one, other = hubsim.Controller(angle_config), hubsim.Controller(angle_config)
    scales = {
        v.name: (v, *one.scale(variables.FAST_INPUT, k))
        for k, v in enumerate(one.variables()["fast_input"])
    }
    for n in range(200):
        raw = {
            "phase_current_code_a": 2048 + n,
            "phase_current_code_b": 2048 - n,
            "phase_current_code_c": 2048,
            "bus_voltage_code": 3400,
            "rotor_angle_turn": 17 * n,
        }
        done = one.fast_step_raw(**raw)
        named = {
            v.name: (raw[v.raw_name] - zero) / per_unit
            for v, zero, per_unit in scales.values()
            if v.raw_name in raw
        }
        same = other.fast_step(**named)
        assert same.bridge == done.bridge
        assert same.duty_a * other.scale(variables.FAST_OUTPUT, 0)[1] == done.compare_counts_a
    assert behaviour(one) == behaviour(other)


def test_a_restored_controller_continues_from_the_saved_state(
    angle_config: hubsim.Configuration,
) -> None:
    controller = hubsim.Controller(angle_config)
    boot(controller, 0.2)
    state = controller.save()

    def go_on() -> list[hubsim.Values]:
        return [controller.fast_step(rotor_angle_turn=n / 500.0) for n in range(100)]

    first = go_on()
    controller.restore(state)
    assert go_on() == first
    with pytest.raises(hubsim.HubsimError, match="bytes"):
        controller.restore(state[1:])
    with pytest.raises(hubsim.HubsimError, match="no controller's state"):
        controller.restore(bytes(len(state)))


def test_reset_gives_the_state_after_power_up(angle_config: hubsim.Configuration) -> None:
    controller = hubsim.Controller(angle_config)
    fresh = behaviour(controller)
    boot(controller, 0.2)
    assert behaviour(controller) != fresh
    controller.reset()
    assert behaviour(controller) == fresh


@pytest.mark.parametrize(
    ("step", "inputs", "message"),
    [
        ("fast_step", {"phase_a": 1.0}, "phase_a: no such input, accepted: phase_a_a"),
        ("fast_step", {"phase_a_a": math.nan}, "phase_a_a: not a finite number"),
        ("slow_step", {"brake_torque_nm": math.inf}, "brake_torque_nm: not a finite number"),
        (
            "fast_step_raw",
            {"bus_voltage_code": 4096},
            "bus_voltage_code: 4096, accepted: 0 to 4095",
        ),
        ("slow_step_raw", {"drive_torque_mNm": 1 << 40}, "32 bits"),
        ("slow_step_raw", {"enable": 2}, "enable: 2, accepted: 0 to 1"),
    ],
)
def test_an_invalid_input_is_refused_with_its_name(
    angle_config: hubsim.Configuration, step: str, inputs: dict[str, float], message: str
) -> None:
    controller = hubsim.Controller(angle_config)
    before = controller.save()
    with pytest.raises(hubsim.HubsimError) as caught:
        getattr(controller, step)(**inputs)
    assert message in str(caught.value)
    assert controller.save() == before


def test_the_error_for_an_unknown_output_lists_the_known_ones(
    angle_config: hubsim.Configuration,
) -> None:
    values = hubsim.Controller(angle_config).fast_step()
    assert list(values) == ["duty_a", "duty_b", "duty_c", "bridge"]
    with pytest.raises(AttributeError, match="duty_a"):
        _ = values.duty
