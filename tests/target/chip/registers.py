# SPDX-License-Identifier: Apache-2.0
"""Registers of a chip as C, from the vendor's description of it.

    registers.py SVD_WHEEL OUTPUT_C OUTPUT_H           of the STM32F405
    registers.py stm32g431.txt OUTPUT_C OUTPUT_H       of the STM32G431 (describe_stm32g431.py)

The header has an address for each register, CHIP_<PERIPHERAL>_<REGISTER>, and a mask for each
field, CHIP_<PERIPHERAL>_<REGISTER>_<FIELD>; the source a table of all registers with reset value,
the bits that exist and access. Nothing in it comes from the driver.
"""

from __future__ import annotations

import io
import sys
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import dataclass
from pathlib import Path

PERIPHERALS = (
    *("RCC", "FLASH", "PWR", "EXTI", "SYSCFG", "GPIOA", "GPIOB", "GPIOC", "GPIOD"),
    *("TIM1", "TIM3", "TIM8"),
    *("ADC1", "ADC2", "ADC3", "C_ADC", "CAN1", "USART3", "DMA1", "DMA2", "IWDG", "DBG", "RNG"),
)
ACCESS = {"read-write": 3, "read-only": 1, "write-only": 2, None: 3, "rw": 3, "r": 1, "w": 2}
MESSAGE_MEMORY = 0x4000A400, 0x350
"""Of FDCAN 1 (RM0440 section 46.3.6): no registers, so no description has it."""


@dataclass
class Register:
    """One register: address, value after reset, bits that exist, 1 readable + 2 writable."""

    name: str
    address: int
    reset: int
    bits: int
    access: int
    fields: dict[str, int]


def _number(element: ET.Element, tag: str) -> int:
    text = element.findtext(tag)
    if text is None:
        raise SystemExit(f"{sys.argv[0]}: <{tag}> missing in the description")
    return int(text, 0)


def _fields(register: ET.Element) -> dict[str, int]:
    return {
        field.findtext("name") or "": ((1 << _number(field, "bitWidth")) - 1)
        << _number(field, "bitOffset")
        for field in register.iterfind("fields/field")
    }


def of_text(lines: list[str]) -> list[Register]:
    """Return the registers of the STM32G431, and its message memory."""
    begin, size = MESSAGE_MEMORY
    found = [
        Register(f"FDCAN1_RAM_{at // 4:03d}", begin + at, 0, 0xFFFFFFFF, 3, {})
        for at in range(0, size, 4)
    ]
    peripheral, base = "", 0
    for line in lines[1 : lines.index("INTERRUPTS")]:
        words = line.split()
        if not line.startswith(" "):
            peripheral, base = words[0], int(words[1], 16)
            continue
        if not line.startswith("    "):
            name, offset, reset, access = words[:4]
            del words[:4]
            found.append(
                Register(
                    f"{peripheral}_{name}",
                    base + int(offset, 16),
                    int(reset, 16),
                    0,
                    ACCESS[access],
                    {},
                )
            )
        for word in words:
            field, mask = word.split(":")
            found[-1].fields[field] = int(mask, 16)
            found[-1].bits |= int(mask, 16)
    return sorted(found, key=lambda each: each.address)


def of_wheel(wheel: str) -> list[Register]:
    """Return the registers of the STM32F405."""
    with zipfile.ZipFile(wheel) as archive:
        inner = archive.read("pyocd/debug/svd/svd_data.zip")
    with zipfile.ZipFile(io.BytesIO(inner)) as archive:
        return of_svd(archive.read("STM32F41x.svd"))


def of_svd(description: bytes) -> list[Register]:
    """Return the registers of PERIPHERALS, in the order of their addresses."""
    root = ET.fromstring(description)
    by_name = {each.findtext("name") or "": each for each in root.iter("peripheral")}
    found = []
    for name in PERIPHERALS:
        peripheral = by_name[name]
        base = _number(peripheral, "baseAddress")
        described_by = peripheral.get("derivedFrom")
        source = by_name[described_by] if described_by else peripheral
        for register in source.iterfind("registers/register"):
            fields = _fields(register)
            bits = 0
            for mask in fields.values():
                bits |= mask
            found.append(
                Register(
                    f"{name}_{register.findtext('name')}".upper(),
                    base + _number(register, "addressOffset"),
                    _number(register, "resetValue"),
                    bits,
                    ACCESS[register.findtext("access")],
                    fields,
                )
            )
    return sorted(found, key=lambda each: each.address)


def _merged(all_registers: list[Register]) -> dict[int, Register]:
    """One register an address: capture and compare are two views of the same."""
    by_address: dict[int, Register] = {}
    for each in all_registers:
        first = by_address.setdefault(each.address, each)
        first.bits |= each.bits
    return by_address


def main(description: str, source: str, header: str) -> None:
    """Write both files."""
    if description.endswith(".txt"):
        found = of_text(Path(description).read_text(encoding="utf-8").splitlines())
    else:
        found = of_wheel(description)
    lines = ["#ifndef CHIP_REGISTERS_H", "#define CHIP_REGISTERS_H"]
    for each in found:
        lines.append(f"#define CHIP_{each.name} 0x{each.address:08X}U")
        lines.extend(
            f"#define CHIP_{each.name}_{field} 0x{mask:08X}U" for field, mask in each.fields.items()
        )
    Path(header).write_text("\n".join([*lines, "#endif", ""]))
    rows = [
        f'{{"{each.name}", 0x{each.address:08X}U, 0x{each.reset:08X}U, '
        f"0x{each.bits:08X}U, {each.access}U}},"
        for each in _merged(found).values()
    ]
    Path(source).write_text(
        "\n".join(
            [
                '#include "chip.h"',
                "const chip_register_t CHIP_REGISTERS[] = {",
                *rows,
                "};",
                "const unsigned CHIP_REGISTER_COUNT =",
                "    sizeof CHIP_REGISTERS / sizeof CHIP_REGISTERS[0];",
                "",
            ]
        )
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
