# SPDX-License-Identifier: Apache-2.0
"""The hand-written register headers against the vendor's description of the chip.

Every base address, register offset and field mask of ``hal/stm32f405/registers`` is evaluated by a
C compiler and compared with the System View Description (SVD) of the STM32F4x1/F4x5 family. The two
have different authors, so an address that is wrong in both is not to be expected.
"""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

SOURCE = Path(os.environ["HUBFOC_SOURCE_DIR"])
REGISTERS = SOURCE / "hal" / "stm32f405" / "registers"
CACHE = SOURCE / ".dev" / "svd"
REQUIREMENTS = Path(__file__).with_name("requirements-svd.txt")

# Name in our headers -> name in the SVD, where they differ.
PERIPHERALS = {"ADC_COMMON": "C_ADC", "DBGMCU": "DBG"}
# Prefix of our field macros -> an SVD peripheral that has these registers.
PREFIXES = {
    "ADC_COMMON": "C_ADC",
    "ADC": "ADC1",
    "TIM": "TIM1",
    "USART": "USART3",
    "CAN": "CAN1",
    "DBGMCU": "DBG",
}
# Our register name -> the SVD's, where they differ (arrays become the first element,
# capture/compare has two views).
REGISTERS_RENAMED = {
    ("CAN1", "TIR"): ["TI0R"],
    ("CAN1", "TDTR"): ["TDT0R"],
    ("CAN1", "RIR"): ["RI0R"],
    ("CAN1", "RDTR"): ["RDT0R"],
    ("TIM1", "CCMR1"): ["CCMR1_Output", "CCMR1_Input"],
    ("TIM1", "CCMR2"): ["CCMR2_Output", "CCMR2_Input"],
    ("DBG", "APB1_FZ"): ["DBGMCU_APB1_FZ"],
    ("DBG", "APB2_FZ"): ["DBGMCU_APB2_FZ"],
    ("DBG", "CR"): ["DBGMCU_CR"],
    ("DBG", "IDCODE"): ["DBGMCU_IDCODE"],
}
# Our field name -> the SVD's, where the SVD has another spelling.
FIELDS_RENAMED = {
    ("C_ADC", "CCR", "MULTI"): "MULT",
    ("DBG", "APB1_FZ", "IWDG_STOP"): "DBG_IWDEG_STOP",
    ("DBG", "APB2_FZ", "TIM1_STOP"): "DBG_TIM1_STOP",
}
# Members that are structures of registers, with the SVD's name of every register in them.
NESTED = {
    "transmit": (3, {"TIR": "TI{}R", "TDTR": "TDT{}R", "TDLR": "TDL{}R", "TDHR": "TDH{}R"}),
    "receive": (2, {"RIR": "RI{}R", "RDTR": "RDT{}R", "RDLR": "RDL{}R", "RDHR": "RDH{}R"}),
    "filter": (28, {"FR1": "F{}R1", "FR2": "F{}R2"}),
}
# Not in any SVD: keys that are written to a register, and the core's own registers (core.h).
NOT_FIELDS = re.compile(r"^(FLASH_UNLOCK_|IWDG_KR_KEY_)")


@dataclass(frozen=True)
class Peripheral:
    """What the SVD says: base address, offsets of registers, masks of their fields."""

    base: int
    offsets: dict[str, int]
    masks: dict[str, dict[str, int]]


def svd_text() -> bytes:
    """Read the SVD of the family from the cache or from the pinned and hashed wheel that carries
    it.
    """
    wheels = sorted(CACHE.glob("pyocd-*.whl"))
    if not wheels:
        CACHE.mkdir(parents=True, exist_ok=True)
        command = [
            sys.executable,
            "-m",
            "pip",
            "download",
            "--disable-pip-version-check",
            "--no-input",
            "--quiet",
        ]
        command += ["--no-deps", "--require-hashes", "-r", str(REQUIREMENTS), "-d", str(CACHE)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, (
            f"the SVD could not be fetched: {done.stderr.strip().splitlines()[-1:]}"
        )
        wheels = sorted(CACHE.glob("pyocd-*.whl"))
    with zipfile.ZipFile(wheels[-1]) as wheel:
        inner = wheel.read("pyocd/debug/svd/svd_data.zip")
    with zipfile.ZipFile(io.BytesIO(inner)) as archive:
        return archive.read("STM32F41x.svd")


def number(element: ET.Element, tag: str) -> int:
    text = element.findtext(tag)
    assert text is not None
    return int(text, 0)


def parse(element: ET.Element, registers_of: ET.Element) -> Peripheral:
    offsets: dict[str, int] = {}
    masks: dict[str, dict[str, int]] = {}
    for register in registers_of.iterfind("registers/register"):
        name = register.findtext("name") or ""
        offsets[name] = number(register, "addressOffset")
        masks[name] = {}
        for field in register.iterfind("fields/field"):
            mask = ((1 << number(field, "bitWidth")) - 1) << number(field, "bitOffset")
            masks[name][field.findtext("name") or ""] = mask
    return Peripheral(number(element, "baseAddress"), offsets, masks)


@pytest.fixture(scope="module")
def device() -> ET.Element:
    return ET.fromstring(svd_text())


@pytest.fixture(scope="module")
def svd(device: ET.Element) -> dict[str, Peripheral]:
    elements = {e.findtext("name") or "": e for e in device.iterfind("peripherals/peripheral")}
    return {name: parse(e, elements[e.get("derivedFrom", name)]) for name, e in elements.items()}


def field_mask(register: dict[str, int], name: str) -> int | None:
    """Mask of a field; the SVD splits some fields into bits, NAME0, NAME1 and so on, which are put
    together.
    """
    if name in register:
        return register[name]
    bits = [
        mask for other, mask in register.items() if re.fullmatch(re.escape(name) + r"\d+", other)
    ]
    return sum(bits) if bits else None


def headers() -> list[Path]:
    found = [p for p in sorted(REGISTERS.glob("*.h")) if p.name != "core.h"]
    assert len(found) >= 7
    return found


def evaluate(expressions: dict[str, str], tmp_path: Path) -> dict[str, int]:
    """Values of C expressions in the context of all register headers, found by the compiler.

    On a 64-bit host the peripheral pointers are wider than on the chip; nothing here dereferences
    them.
    """
    lines = [f'#include "{path}"' for path in headers()]
    lines += ["#include <stddef.h>", "#include <stdio.h>", "int main(void) {"]
    lines += [
        f'printf("{key} %llu\\n", (unsigned long long)({text}));'
        for key, text in expressions.items()
    ]
    lines += ["return 0; }"]
    source = tmp_path / "values.c"
    source.write_text("\n".join(lines))
    program = tmp_path / "values"
    subprocess.run(
        ["cc", "-std=c11", "-Wno-int-to-pointer-cast", "-o", program, source], check=True
    )
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return {key: int(value) for key, value in (line.split() for line in output.splitlines())}


def macros() -> list[str]:
    names = []
    for path in headers():
        names += re.findall(r"^#define ([A-Z]\w+) \(?[\dx(]", path.read_text(), re.MULTILINE)
    return names


def instances() -> dict[str, str]:
    """Peripheral macro -> structure type."""
    found: dict[str, str] = {}
    for path in headers():
        found.update(
            re.findall(
                r"^#define (\w+) \(\((\w+_registers_t) \*\)0x", path.read_text(), re.MULTILINE
            )
        )
    return found


def members(structure: str) -> list[str]:
    text = "\n".join(path.read_text() for path in headers())
    match = re.search(r"typedef struct \{([^}]*)\} " + structure + ";", text)
    assert match, structure
    body = re.sub(r"/\*.*?\*/", "", match.group(1))
    return [
        name
        for name in re.findall(r"\b(\w+)(?:\[\d+\])?;", body)
        if not name.startswith("reserved")
    ]


def test_every_peripheral_has_the_base_address_of_the_chip(
    svd: dict[str, Peripheral], tmp_path: Path
) -> None:
    found = evaluate({name: f"(size_t){name}" for name in instances()}, tmp_path)
    assert len(found) >= 14
    assert {n: hex(v) for n, v in found.items()} == {
        n: hex(svd[PERIPHERALS.get(n, n)].base) for n in found
    }


def test_every_register_has_its_offset(svd: dict[str, Peripheral], tmp_path: Path) -> None:
    expressions: dict[str, str] = {}
    expected: dict[str, int] = {}
    for instance, structure in instances().items():
        peripheral = PERIPHERALS.get(instance, instance)
        for member in members(structure):
            if member in NESTED:
                count, names = NESTED[member]
                for index in range(count):
                    for ours, theirs in names.items():
                        key = f"{instance}.{member}[{index}].{ours}"
                        expressions[key] = f"offsetof({structure}, {member}[{index}].{ours})"
                        expected[key] = svd[peripheral].offsets[theirs.format(index)]
                continue
            if peripheral == "TIM3" and member in ("RCR", "BDTR"):
                continue  # the advanced timer's layout, of which the simple one lacks these two
            theirs = REGISTERS_RENAMED.get((peripheral.replace("TIM3", "TIM1"), member), [member])[
                0
            ]
            expressions[f"{instance}.{member}"] = f"offsetof({structure}, {member})"
            expected[f"{instance}.{member}"] = svd[peripheral].offsets[theirs]
    found = evaluate(expressions, tmp_path)
    assert len(found) >= 150
    assert found == expected


def split(name: str) -> tuple[str, str, str]:
    """TIM_CR1_CEN -> (TIM1, CR1, CEN)."""
    prefix = next((p for p in PREFIXES if name.startswith(p + "_")), name.split("_", maxsplit=1)[0])
    rest = name[len(prefix) + 1 :]
    peripheral = PREFIXES.get(prefix, prefix)
    if peripheral == "DBG":
        register, _, field = rest.partition("_FZ_")
        return peripheral, register + "_FZ", field
    register, _, field = rest.partition("_")
    return peripheral, register, field


def test_every_field_has_its_mask_and_its_position(
    svd: dict[str, Peripheral], tmp_path: Path
) -> None:
    names = [n for n in macros() if not NOT_FIELDS.match(n) and n not in instances()]
    found = evaluate({name: name for name in names}, tmp_path)
    assert len(found) >= 120
    wrong = []
    for name, value in found.items():
        peripheral, register, field = split(name.removesuffix("_Pos"))
        field = FIELDS_RENAMED.get((peripheral, register, field), field)
        views = REGISTERS_RENAMED.get((peripheral, register), [register])
        masks = [
            m
            for m in (field_mask(svd[peripheral].masks[view], field) for view in views)
            if m is not None
        ]
        if not masks:
            wrong.append(f"{name}: no field {field} in {peripheral}.{register}")
        elif name.endswith("_Pos"):
            if any((mask & -mask).bit_length() - 1 != value for mask in masks):
                wrong.append(f"{name} is {value}, the chip's mask is {[hex(m) for m in masks]}")
        elif any(mask != value for mask in masks):
            wrong.append(f"{name} is {value:#x}, the chip's is {[hex(m) for m in masks]}")
    assert not wrong, "\n".join(wrong)


def test_the_interrupts_have_the_chips_numbers(device: ET.Element) -> None:
    numbers = {i.findtext("name"): number(i, "value") for i in device.iter("interrupt")}
    text = (REGISTERS.parent / "interrupts.h").read_text()
    ours = {
        name: int(value)
        for name, value in re.findall(r"INTERRUPT_(ADC|USART3|SUPPLY) = (\d+)", text)
    }
    assert ours == {
        "ADC": numbers["ADC_IRQ"],
        "USART3": numbers["USART3_IRQ"],
        "SUPPLY": numbers["PVD_IRQ"],
    }
