# SPDX-License-Identifier: Apache-2.0
"""The hand-written register headers against the vendor's descriptions of the chips.

Every base address, register offset and field mask of ``hal/<chip>/registers``, and of
``hal/stm32/registers`` in it, is evaluated by a C compiler and compared with the System View
Description (SVD) of the STM32F4x1/F4x5 family, and with what the crate stm32g4 made of that of the
STM32G431 (``describe_stm32g431.py``). They have other authors than the headers, so an address that
is wrong in both is not to be expected.
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
SHARED = SOURCE / "hal" / "stm32"
CACHE = SOURCE / ".dev" / "svd"
REQUIREMENTS = Path(__file__).with_name("requirements-svd.txt")


@dataclass(frozen=True)
class Chip:
    """A chip, and where its description has other names than our headers."""

    name: str
    peripherals: dict[str, str]
    # Prefix of our field macros -> a peripheral of the description that has these registers.
    prefixes: dict[str, str]
    # Our register -> the description's (arrays become the first element, capture/compare has two
    # views).
    registers: dict[tuple[str, str], list[str]]
    # Our field -> the description's.
    fields: dict[tuple[str, str, str], str]
    # A general-purpose timer, which has no RCR and no BDTR.
    plain_timer: str
    interrupts: dict[str, str]
    # Of peripherals, registers, fields: at least so many are compared.
    least: tuple[int, int, int]

    @property
    def folder(self) -> Path:
        return SOURCE / "hal" / self.name


CHIPS = (
    Chip(
        name="stm32f405",
        peripherals={"ADC_COMMON": "C_ADC", "DBGMCU": "DBG"},
        prefixes={
            "ADC_COMMON": "C_ADC",
            "ADC": "ADC1",
            "TIM": "TIM1",
            "USART": "USART3",
            "CAN": "CAN1",
            "DBGMCU": "DBG",
            "DMA": "DMA1",
        },
        registers={
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
        },
        fields={
            ("C_ADC", "CCR", "MULTI"): "MULT",
            ("DBG", "APB1_FZ", "IWDG_STOP"): "DBG_IWDEG_STOP",
            ("DBG", "APB2_FZ", "TIM1_STOP"): "DBG_TIM1_STOP",
        },
        plain_timer="TIM3",
        interrupts={"ADC": "ADC_IRQ", "SUPPLY": "PVD_IRQ"},
        least=(14, 150, 120),
    ),
    Chip(
        name="stm32g431",
        peripherals={"TIM1_FURTHER": "TIM1"},
        prefixes={
            "ADC12_COMMON": "ADC12_COMMON",
            "ADC": "ADC1",
            "DAC": "DAC3",
            "TIM": "TIM1",
            "USART": "USART2",
            "DMA": "DMA1",
        },
        registers={
            ("DMAMUX", "CCR"): ["C0CR"],
            ("TIM1", "CCMR1"): ["CCMR1_OUTPUT", "CCMR1_INPUT"],
            ("TIM1", "CCMR2"): ["CCMR2_OUTPUT", "CCMR2_INPUT"],
            ("DBGMCU", "APB1_FZ"): ["APB1L_FZ"],
            ("DBGMCU", "APB1H_FZ"): ["APB1H_FZ"],
            **{
                ("DAC3", name): [f"DAC_{name}"]
                for name in ("CR", "SWTRGR", "DHR12R1", "DHR12R2", "DOR1", "DOR2", "MCR")
            },
        },
        fields={
            ("DBGMCU", "APB1_FZ", "IWDG_STOP"): "DBG_IWDG_STOP",
            ("DBGMCU", "APB2_FZ", "TIM1_STOP"): "DBG_TIM1_STOP",
            ("RCC", "CSR", "LPWRRSTF"): "LPWRSTF",
            ("RCC", "CSR", "PADRSTF"): "PINRSTF",
            ("RCC", "CSR", "PORRSTF"): "BORRSTF",
            ("RCC", "CSR", "WDGRSTF"): "IWDGRSTF",
        },
        plain_timer="TIM4",
        interrupts={"ADC": "ADC1_2", "SUPPLY": "PVD_PVM"},
        least=(18, 220, 130),
    ),
)
# Errors of a description, with what shows them. R1MODE: bit 0 there, but the register's value after
# reset is 0x100 (RM0440 section 6.4.22, and the crate's own text). TFQM: bit 30 there, as in the
# FDCAN of the STM32H7, whose TXBC also has the sizes that this one lacks (RM0440 section 46.4.25).
WRONG_THERE = {
    ("stm32g431", "PWR_CR5_R1MODE"): 1 << 8,
    ("stm32g431", "FDCAN1_TXBC_TFQM"): 1 << 24,
}

# Members that are structures of registers, with the SVD's name of every register in them.
NESTED = {
    "transmit": (3, {"TIR": "TI{}R", "TDTR": "TDT{}R", "TDLR": "TDL{}R", "TDHR": "TDH{}R"}),
    "receive": (2, {"RIR": "RI{}R", "RDTR": "RDT{}R", "RDLR": "RDL{}R", "RDHR": "RDH{}R"}),
    "filter": (28, {"FR1": "F{}R1", "FR2": "F{}R2"}),
    "stream": (8, {name: f"S{{}}{name}" for name in ("CR", "NDTR", "PAR", "M0AR", "M1AR", "FCR")}),
    "channel": (8, {name: f"{name}{{}}" for name in ("CCR", "CNDTR", "CPAR", "CMAR")}),
}
# Not in any SVD: keys that are written to a register, and the core's own registers (core.h).
NOT_FIELDS = re.compile(r"^(FLASH_UNLOCK_|IWDG_KR_KEY_|FDCAN1_MEMORY$)")


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


@dataclass(frozen=True)
class Description:
    peripherals: dict[str, Peripheral]
    interrupts: dict[str, int]


def of_svd() -> Description:
    device = ET.fromstring(svd_text())
    elements = {e.findtext("name") or "": e for e in device.iterfind("peripherals/peripheral")}
    return Description(
        {name: parse(e, elements[e.get("derivedFrom", name)]) for name, e in elements.items()},
        {i.findtext("name") or "": number(i, "value") for i in device.iter("interrupt")},
    )


def of_crate() -> Description:
    """Read what describe_stm32g431.py wrote."""
    peripherals: dict[str, Peripheral] = {}
    interrupts: dict[str, int] = {}
    lines = Path(__file__).with_name("stm32g431.txt").read_text(encoding="utf-8").splitlines()
    name = register = ""
    for line in lines[1:]:
        words = line.split()
        if not line.startswith(" "):
            name = words[0]
            if len(words) == 2:
                peripherals[name] = Peripheral(int(words[1], 16), {}, {})
        elif name == "INTERRUPTS":
            interrupts[words[0]] = int(words[1])
        else:
            if not line.startswith("    "):
                register = words.pop(0)
                peripherals[name].offsets[register] = int(words.pop(0), 16)
                del words[:2]  # reset value and access: tests/target/chip
                peripherals[name].masks[register] = {}
            masks = (field.split(":") for field in words)
            peripherals[name].masks[register].update({f: int(m, 16) for f, m in masks})
    return Description(peripherals, interrupts)


@pytest.fixture(scope="module", params=CHIPS, ids=lambda chip: str(chip.name))
def chip(request: pytest.FixtureRequest) -> Chip:
    found = request.param
    assert isinstance(found, Chip)
    return found


@pytest.fixture(scope="module")
def described(chip: Chip) -> Description:
    return of_svd() if chip.name == "stm32f405" else of_crate()


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


def headers(chip: Chip) -> list[Path]:
    folders = (SHARED / "registers", chip.folder / "registers")
    found = [p for f in folders for p in sorted(f.glob("*.h")) if p.name != "core.h"]
    assert len(found) >= 10
    return found


def evaluate(chip: Chip, expressions: dict[str, str], tmp_path: Path) -> dict[str, int]:
    """Values of C expressions in the context of all register headers, found by the compiler.

    On a 64-bit host the peripheral pointers are wider than on the chip; nothing here dereferences
    them.
    """
    lines = [f'#include "{path}"' for path in headers(chip)]
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
        ["cc", "-std=c11", "-Wno-int-to-pointer-cast", f"-I{SHARED}", "-o", program, source],
        check=True,
    )
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return {key: int(value) for key, value in (line.split() for line in output.splitlines())}


def macros(chip: Chip) -> list[str]:
    names = []
    for path in headers(chip):
        names += re.findall(r"^#define ([A-Z]\w+) \(?[\dx(]", path.read_text(), re.MULTILINE)
    return names


def instances(chip: Chip) -> dict[str, str]:
    """Peripheral macro -> structure type."""
    found: dict[str, str] = {}
    for path in headers(chip):
        found.update(
            re.findall(
                r"^#define (\w+) \(\((\w+_registers_t) \*\)0x", path.read_text(), re.MULTILINE
            )
        )
    return found


def members(chip: Chip, structure: str) -> list[str]:
    text = "\n".join(path.read_text() for path in headers(chip))
    match = re.search(r"typedef struct \{([^}]*)\} " + structure + ";", text)
    assert match, structure
    body = re.sub(r"/\*.*?\*/", "", match.group(1), flags=re.DOTALL)
    return [
        name
        for name in re.findall(r"\b(\w+)(?:\[\d+\])?;", body)
        if not name.startswith("reserved")
    ]


def test_every_peripheral_has_the_base_address_of_the_chip(
    chip: Chip, described: Description, tmp_path: Path
) -> None:
    found = evaluate(chip, {name: f"(size_t){name}" for name in instances(chip)}, tmp_path)
    assert len(found) >= chip.least[0]
    assert {n: hex(v) for n, v in found.items()} == {
        n: hex(described.peripherals[chip.peripherals.get(n, n)].base) for n in found
    }


def test_every_register_has_its_offset(chip: Chip, described: Description, tmp_path: Path) -> None:
    expressions: dict[str, str] = {}
    expected: dict[str, int] = {}
    for instance, structure in instances(chip).items():
        name = chip.peripherals.get(instance, instance)
        offsets = described.peripherals[name].offsets
        for member in members(chip, structure):
            if member in NESTED:
                count, names = NESTED[member]
                for index in range(count):
                    for ours, theirs in names.items():
                        key = f"{instance}.{member}[{index}].{ours}"
                        expressions[key] = f"offsetof({structure}, {member}[{index}].{ours})"
                        expected[key] = offsets[theirs.format(index + (member == "channel"))]
                continue
            if name == chip.plain_timer and member in ("RCR", "BDTR"):
                continue  # the advanced timer's layout, of which the simple one lacks these two
            of_timer = "TIM1" if name in ("TIM8", chip.plain_timer) else name
            theirs = chip.registers.get((of_timer, member), [member])[0]
            expressions[f"{instance}.{member}"] = f"offsetof({structure}, {member})"
            expected[f"{instance}.{member}"] = offsets[theirs]
    found = evaluate(chip, expressions, tmp_path)
    assert len(found) >= chip.least[1]
    assert found == expected


def split(chip: Chip, name: str) -> tuple[str, str, str]:
    """TIM_CR1_CEN -> (TIM1, CR1, CEN)."""
    prefix = next(
        (p for p in chip.prefixes if name.startswith(p + "_")), name.split("_", maxsplit=1)[0]
    )
    rest = name[len(prefix) + 1 :]
    peripheral = chip.prefixes.get(prefix, prefix)
    if prefix == "DBGMCU":
        register, _, field = rest.partition("_FZ_")
        return peripheral, register + "_FZ", field
    if prefix == "OPAMP":
        rest = rest.replace("_CSR_", "-CSR_")
    register, _, field = rest.partition("_")
    return peripheral, register.replace("-", "_"), field


def test_every_field_has_its_mask_and_its_position(
    chip: Chip, described: Description, tmp_path: Path
) -> None:
    names = [n for n in macros(chip) if not NOT_FIELDS.match(n) and n not in instances(chip)]
    found = evaluate(chip, {name: name for name in names}, tmp_path)
    assert len(found) >= chip.least[2]
    wrong = []
    for name, value in found.items():
        if (chip.name, name) in WRONG_THERE:
            assert value == WRONG_THERE[chip.name, name]
            continue
        peripheral, register, field = split(chip, name.removesuffix("_Pos"))
        field = chip.fields.get((peripheral, register, field), field)
        views = chip.registers.get((peripheral, register), [register])
        registers = described.peripherals[peripheral].masks
        masks = [m for m in (field_mask(registers[view], field) for view in views) if m is not None]
        if not masks:
            wrong.append(f"{name}: no field {field} in {peripheral}.{register}")
        elif name.endswith("_Pos"):
            if any((mask & -mask).bit_length() - 1 != value for mask in masks):
                wrong.append(f"{name} is {value}, the chip's mask is {[hex(m) for m in masks]}")
        elif any(mask != value for mask in masks):
            wrong.append(f"{name} is {value:#x}, the chip's is {[hex(m) for m in masks]}")
    assert not wrong, "\n".join(wrong)


def test_the_interrupts_have_the_chips_numbers(chip: Chip, described: Description) -> None:
    text = (chip.folder / "interrupts.h").read_text()
    ours = dict(re.findall(r"INTERRUPT_(ADC|SUPPLY) = (\d+)", text))
    assert {name: int(value) for name, value in ours.items()} == {
        name: described.interrupts[theirs] for name, theirs in chip.interrupts.items()
    }
    count = re.search(r"INTERRUPT_COUNT = (\d+)", text)
    assert count is not None
    assert int(count[1]) > max(int(value) for value in ours.values())
