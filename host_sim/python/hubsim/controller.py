# SPDX-License-Identifier: Apache-2.0
"""One controller alone, for a plant of one's own: the two steps of the firmware, by name.

    controller = hubsim.Controller("tools/motors/lu2013.toml")
    for n in range(...):
        if n % periods_of_a_millisecond == 0:
            slow = controller.slow_step(brake_torque_nm=20.0, enable=True)
        fast = controller.fast_step(phase_a_a=..., phase_b_a=..., phase_c_a=..., bus_voltage_v=...,
        rotor_angle_turn=...) # the bridge does fast.duty_a, fast.duty_b, fast.duty_c from the next
        period on

The code is the microcontroller's, so timing is the caller's: ``fast_step`` once per ``period_s``
with what was sampled at its beginning, ``slow_step`` once per millisecond and before the fast step
of the same instant.
"""

from pathlib import Path
from typing import Any

from hubsim import configuration, variables
from hubsim.configuration import Configuration
from hubsim.engine import library, text_of
from hubsim.errors import HubsimError
from hubsim.variables import Values, Variable

SLOW_RATE_HZ = 1000


class Controller:
    """The whole controller of one wheel. Not for two threads at the same time.

    Inputs that a step does not name keep the value they had; before that they have the start values
    of the list: zero, except that the self-test has passed, the configuration is accepted, the
    drive direction is forward, temperatures are 25 degC and the battery's limits are the
    configuration's own. Currents and voltages go through the converter codes of the firmware: what
    lies beyond the full scale saturates.

    Parameters
    ----------
    config : Configuration, str or Path
        Or the name of a ``.toml`` or ``.bin`` file.
    """

    def __init__(self, config: Configuration | str | Path) -> None:
        self.configuration = (
            config if isinstance(config, Configuration) else configuration.load(config)
        )
        self._ffi, self._lib = library()
        handle = self._lib.hubsim_controller_new()
        if handle == self._ffi.NULL:
            raise HubsimError("no memory for a controller")
        self._handle = self._ffi.gc(handle, self._lib.hubsim_controller_delete)
        self._fast = _Step(self, variables.FAST_INPUT, variables.FAST_OUTPUT, "fast")
        self._slow = _Step(self, variables.SLOW_INPUT, variables.SLOW_OUTPUT, "slow")
        self.reset()

    @property
    def period_s(self) -> float:
        """Distance of the fast steps."""
        return 1.0 / float(self._lib.hubsim_controller_fast_rate_hz(self._handle))

    def reset(self) -> None:
        """Begin as after power-up, with the same configuration.

        Inputs go back to their start values.
        """
        image = self.configuration.image
        self._check(
            self._lib.hubsim_controller_load_config(
                self._handle, self._ffi.from_buffer(image), len(image)
            )
        )
        self._fast.reset()
        self._slow.reset()

    def fast_step(self, **inputs: float) -> Values:
        """Step the current loop once, in engineering units.

        ``variables()`` lists inputs and outputs.
        """
        return self._fast.engineering(inputs)

    def slow_step(self, **inputs: float) -> Values:
        """Step torque, modes and monitor once, inputs and outputs in engineering units."""
        return self._slow.engineering(inputs)

    def fast_step_raw(self, **inputs: int) -> Values:
        """Step the current loop once, in the firmware's own integers.

        Inputs and outputs by their raw names.
        """
        return self._fast.raw(inputs)

    def slow_step_raw(self, **inputs: int) -> Values:
        """Step the slow loop once, in the firmware's own integers.

        Inputs and outputs by their raw names.
        """
        return self._slow.raw(inputs)

    @staticmethod
    def variables() -> dict[str, tuple[Variable, ...]]:
        """Return all inputs and outputs with units and meanings, by step and direction."""
        return {
            "fast_input": variables.of_port(variables.FAST_INPUT),
            "fast_output": variables.of_port(variables.FAST_OUTPUT),
            "slow_input": variables.of_port(variables.SLOW_INPUT),
            "slow_output": variables.of_port(variables.SLOW_OUTPUT),
        }

    def scale(self, port: int, index: int) -> tuple[float, float]:
        """Return how raw and engineering values of a variable belong together.

        Raw = zero + engineering * per_unit.
        """
        zero, per_unit = self._ffi.new("double *"), self._ffi.new("double *")
        if self._lib.hubsim_controller_scale(self._handle, port, index, zero, per_unit) != 0:
            raise HubsimError(f"variable {index} of port {port}: there is none")
        return float(zero[0]), float(per_unit[0])

    def start(self, port: int, index: int) -> float:
        """Return the start value of an input, in engineering units."""
        zero, per_unit = self.scale(port, index)
        return (variables.of_port(port)[index].start_raw - zero) / per_unit

    def save(self) -> bytes:
        """Return the complete state of the controller.

        For ``restore`` under the same build of the library.
        """
        state = self._ffi.new("char[]", self._lib.hubsim_controller_state_bytes())
        self._check(self._lib.hubsim_controller_save(self._handle, state))
        return bytes(self._ffi.buffer(state))

    def restore(self, state: bytes) -> None:
        """Go back to what ``save`` returned."""
        expected = self._lib.hubsim_controller_state_bytes()
        if len(state) != expected:
            raise HubsimError(f"a controller's state has {expected} bytes, got {len(state)}")
        self._check(self._lib.hubsim_controller_restore(self._handle, self._ffi.from_buffer(state)))

    def mode_text(self, mode: float) -> str:
        """Return the name of a mode."""
        return text_of(self._lib.hubsim_mode_text(int(mode)))

    def reason_text(self, reason: float) -> str:
        """Return what a reason code means."""
        return text_of(self._lib.hubsim_reason_text(int(reason)))

    def _check(self, status: int) -> None:
        if status != 0:
            raise HubsimError(
                f"{self.configuration.name}: "
                f"{text_of(self._lib.hubsim_controller_error(self._handle))}"
            )


class _Step:
    """One of the two steps with the arrays it reads and writes."""

    def __init__(self, owner: Controller, port_in: int, port_out: int, name: str) -> None:
        ffi, lib = library()
        self._owner, self._port = owner, port_in
        self._in, self._out = variables.of_port(port_in), variables.of_port(port_out)
        self._names = {v.name: k for k, v in enumerate(self._in)}
        self._raw_names = {v.raw_name: k for k, v in enumerate(self._in)}
        self._out_names = {v.name: k for k, v in enumerate(self._out)}
        self._out_raw_names = {v.raw_name: k for k, v in enumerate(self._out)}
        self._values: Any = ffi.new("double[]", len(self._in))
        self._results: Any = ffi.new("double[]", len(self._out))
        self._raw_values: Any = ffi.new("int32_t[]", len(self._in))
        self._raw_results: Any = ffi.new("int32_t[]", len(self._out))
        self._call = getattr(lib, f"hubsim_controller_{name}_step")
        self._call_raw = getattr(lib, f"hubsim_controller_{name}_step_raw")

    def reset(self) -> None:
        """Give every input its start value."""
        for k, variable in enumerate(self._in):
            self._values[k] = self._owner.start(self._port, k)
            self._raw_values[k] = variable.start_raw

    def engineering(self, inputs: dict[str, float]) -> Values:
        for name, value in inputs.items():
            self._values[variables.place(self._names, name)] = float(value)
        self._owner._check(self._call(self._owner._handle, self._values, self._results))
        return Values(self._out_names, list(self._results))

    def raw(self, inputs: dict[str, int]) -> Values:
        for name, value in inputs.items():
            try:
                self._raw_values[variables.place(self._raw_names, name)] = value
            except (OverflowError, TypeError):
                raise HubsimError(
                    f"{name}: {value!r} is not accepted, accepted: a whole number of 32 bits"
                ) from None
        self._owner._check(self._call_raw(self._owner._handle, self._raw_values, self._raw_results))
        return Values(self._out_raw_names, list(self._raw_results))
