# SPDX-License-Identifier: Apache-2.0
"""The C table that a unit is compiled with (fmu/model.h)."""

from hubsim.fmu.description import Description


def c_table(unit: Description) -> str:
    """Return the text of the C file: variables, settings, configuration and voltage curve."""
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0 */",
        f"/* {unit.identifier} of {unit.config.name}: written by hubsim.fmu. */",
        '#include "fmu/model.h"',
        "",
    ]
    lines += [f'const char MODEL_TOKEN[] = "{unit.token}";', ""]
    rows = [
        f'    {{"{v.name}", MODEL_{v.kind}, MODEL_{v.role}, {v.start!r}}},' for v in unit.variables
    ]
    lines += [
        f"const int MODEL_VARIABLE_COUNT = {len(rows)};",
        "const model_variable_t MODEL_VARIABLES[] = {",
        *rows,
        "};",
        "",
    ]
    settings = [f'    {{"{name}", {value!r}}},' for name, value in unit.settings.items()]
    lines += [f"const int MODEL_SETTING_COUNT = {len(settings)};"]
    lines += [
        "const model_setting_t MODEL_SETTINGS[] = {",
        *(settings or ['    {"", 0.0},']),
        "};",
        "",
    ]
    soc, voltage_v = unit.curve
    lines += [f"const int MODEL_CURVE_POINTS = {len(soc)};"]
    lines += [
        f"const double MODEL_CURVE_SOC[] = {{{_listed(soc)}}};",
        f"const double MODEL_CURVE_V[] = {{{_listed(voltage_v)}}};",
        "",
    ]
    image = unit.config.image
    lines += [
        f"const uint32_t MODEL_CONFIG_BYTES = {len(image)};",
        "const unsigned char MODEL_CONFIG[] = {",
    ]
    lines += [
        "    " + ", ".join(map(str, image[at : at + 24])) + "," for at in range(0, len(image), 24)
    ]
    return "\n".join([*lines, "};", ""])


def _listed(values: object) -> str:
    numbers = [float(value) for value in values] if isinstance(values, list | tuple) else []
    return ", ".join(map(repr, numbers)) if numbers else "0.0"
