# SPDX-License-Identifier: Apache-2.0
"""How far a drive may be from what its file says.

Each key is a limit, as data sheets print it: the true value lies anywhere within +- this share. The
standard uncertainty of such a quantity is 1/sqrt(3) of its limit (rectangular distribution, GUM
4.3.7). No map, limit or gain depends on these keys.
"""

from typing import Annotated

from regen_table.section import Section, number


class Tolerance(Section):
    """Limits that make the uncertainty of the torque estimate; information on CAN, no demand."""

    magnet_flux: Annotated[
        float,
        number(
            0.0, 0.5, "1",
            "limit +- of motor.flux_linkage_wb: remanence of a magnet's grade 2 to 3 %, air gap,"
            " and 20 K of magnet temperature 2 %; standard uncertainty: limit / sqrt(3)",
        ),
    ] = 0.05  # fmt: skip
    inductance: Annotated[
        float,
        number(
            0.0, 1.0, "1",
            "limit +- of each inductance, independently, or of the map's flux less the magnets':"
            " data sheets give 20 %; moves the reluctance torque alone; standard uncertainty:"
            " limit / sqrt(3)",
        ),
    ] = 0.2  # fmt: skip
    drag: Annotated[
        float,
        number(
            0.0, 1.0, "1",
            "limit +- of the torque that iron loss and friction take: IEC 60034-1 permits 15 % of"
            " all losses; standard uncertainty: limit / sqrt(3)",
        ),
    ] = 0.2  # fmt: skip
    current_gain: Annotated[
        float,
        number(
            0.0, 0.5, "1",
            "limit +- of the gain that all current sensors have in common: shunt 1 % and amplifier"
            " 1 %, Hall sensors 2 %; standard uncertainty: limit / sqrt(3)",
        ),
    ] = 0.02  # fmt: skip
    rotor_angle_deg: Annotated[
        float,
        number(
            0.0, 25.0, "deg",
            "limit +- of the electrical angle, alignment included: hall edges 3 degrees, a resolver"
            " half a mechanical degree times the pole pairs; counts in field weakening; standard"
            " uncertainty: limit / sqrt(3)",
        ),
    ] = 3.0  # fmt: skip
