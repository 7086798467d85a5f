# SPDX-License-Identifier: Apache-2.0
"""The controller's inputs and outputs by name, read from the library's own lists."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

from hubsim.engine import library, text_of
from hubsim.errors import HubsimError

FAST_INPUT, FAST_OUTPUT, SLOW_INPUT, SLOW_OUTPUT, FAST_VIEW = range(5)
REAL, FLAG, CODE = range(3)


@dataclass(frozen=True)
class Variable:
    """One input or output of a step.

    ``unit`` is spelt as the FMI standard spells units, "1" for a share, "" for a flag or a code.
    ``kind`` is REAL, FLAG (0 or 1) or CODE. The raw value is the firmware's own integer, from
    ``lowest_raw`` to ``highest_raw``; an input begins with ``start_raw``. ``member`` is where it is
    in the firmware's message, ``demand.enable`` for instance.
    """

    name: str
    raw_name: str
    unit: str
    text: str
    kind: int
    lowest_raw: int
    highest_raw: int
    start_raw: int
    member: str


@cache
def of_port(port: int) -> tuple[Variable, ...]:
    """Return the variables of a port (FAST_INPUT, ...) in the order of its arrays."""
    _, lib = library()
    return tuple(
        Variable(
            text_of(lib.hubsim_variable_name(port, k)),
            text_of(lib.hubsim_variable_raw_name(port, k)),
            text_of(lib.hubsim_variable_unit(port, k)),
            text_of(lib.hubsim_variable_text(port, k)),
            int(lib.hubsim_variable_type(port, k)),
            int(lib.hubsim_variable_lowest_raw(port, k)),
            int(lib.hubsim_variable_highest_raw(port, k)),
            int(lib.hubsim_variable_start_raw(port, k)),
            text_of(lib.hubsim_variable_member(port, k)),
        )
        for k in range(lib.hubsim_variable_count(port))
    )


class Values(Mapping[str, float]):
    """What a step returned: ``values.duty_a`` or ``values["duty_a"]``, in the order of the port."""

    __slots__ = ("_names", "_numbers")

    def __init__(self, names: dict[str, int], numbers: list[float]) -> None:
        self._names, self._numbers = names, numbers

    def __getitem__(self, name: str) -> float:
        """Return one value."""
        return self._numbers[self._names[name]]

    def __getattr__(self, name: str) -> float:
        """Return one value."""
        try:
            return self._numbers[self._names[name]]
        except KeyError:
            raise AttributeError(
                f"{name}: no such output, there are: {', '.join(self._names)}"
            ) from None

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._names)

    def __repr__(self) -> str:
        """Show names and values."""
        return f"Values({', '.join(f'{name}={number:g}' for name, number in self.items())})"


def place(names: dict[str, int], name: str) -> int:
    """Return the position of an input, or raise an error that lists all inputs."""
    try:
        return names[name]
    except KeyError:
        raise HubsimError(f"{name}: no such input, accepted: {', '.join(names)}") from None
