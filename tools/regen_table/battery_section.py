# SPDX-License-Identifier: Apache-2.0
"""The pack, and what it gives and takes."""

from typing import Annotated

from pydantic import Field

from regen_table import defaults
from regen_table.assumed import Assumed
from regen_table.section import Section, number

Volts = Annotated[float, number(1.0, 2000.0, "V", "a battery voltage")]
SocPoint = Annotated[
    tuple[Annotated[float, number(0.0, 1.0, "1", "state of charge")], Volts], Field(strict=False)
]
SocCurve = Annotated[tuple[SocPoint, ...], Field(strict=False)]


class Battery(Section):
    """A battery as open-circuit voltage, series resistance and one RC branch.

    Limits are those of the whole pack.
    """

    cells: Annotated[
        int | None,
        number(
            1, 400, "1", "lithium-ion cells in series: what voltages are assumed from; absent: none"
        ),
    ] = None
    open_circuit_voltage_v: Annotated[
        Volts | SocCurve,
        Field(description="V, or [[soc, V], ...] with rising soc"),
        Assumed(
            defaults.open_circuit_voltage,
            "other cells, such as LiFePO4: fold-back at another charge",
        ),
    ]
    series_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "R_s"),
        Assumed(
            defaults.series_resistance, "simulated packs alone: twice, 2.7 % of the power at 1 C"
        ),
    ]
    polarisation_resistance_ohm: Annotated[
        float,
        number(0.0, 10.0, "ohm", "R_t"),
        Assumed(
            defaults.polarisation_resistance,
            "simulated packs alone: twice, 1.4 % of the power at 1 C",
        ),
    ]
    polarisation_capacitance_f: Annotated[
        float,
        number(1e-3, 1e7, "F", "C_t"),
        Assumed(defaults.polarisation_capacitance, "simulated packs alone"),
    ]
    capacity_ah: Annotated[
        float,
        number(0.01, 1e5, "A h", ""),
        Assumed(defaults.capacity, "both current limits in proportion: give it"),
    ]
    initial_soc: Annotated[
        float, number(0.0, 1.0, "1", "state of charge where work begins; absent: 0.7")
    ] = 0.7
    max_charge_current_a: Annotated[
        float,
        number(0.0, 2e4, "A", "0: no regeneration into the battery"),
        Assumed(
            defaults.max_charge_current, "too low: hard stops by friction; too high: aged cells"
        ),
    ]
    max_discharge_current_a: Annotated[
        float,
        number(0.1, 2e4, "A", ""),
        Assumed(defaults.max_discharge_current, "driving power alone"),
    ]
    max_voltage_v: Annotated[
        float,
        number(1.0, 1900.0, "V", "end of charge"),
        Assumed(defaults.max_voltage, "an over-charged pack of other cells: LiFePO4 has 3.65 V"),
    ]
    min_voltage_v: Annotated[
        float,
        number(1.0, 1900.0, "V", "end of discharge"),
        Assumed(defaults.min_voltage, "an exhausted pack of other cells: LiFePO4 has 2.5 V"),
    ]
    charge_foldback_voltage_v: Annotated[
        float | None,
        number(
            1.0, 1900.0, "V", "charge current starts to fold back; absent: 98 % of max_voltage_v"
        ),
    ] = None
    discharge_foldback_voltage_v: Annotated[
        float | None,
        number(
            1.0,
            1900.0,
            "V",
            "discharge current starts to fold back; absent: as far above min_voltage_v as charge's"
            " lies below max_voltage_v",
        ),
    ] = None
    current_filter_s: Annotated[
        float,
        number(
            0.0,
            10.0,
            "s",
            "longest time constant of the current that the battery management reports: the motor's"
            " current sensors are compared with it over eight times this",
        ),
    ] = 2.0
