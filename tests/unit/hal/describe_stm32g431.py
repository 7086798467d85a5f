# SPDX-License-Identifier: Apache-2.0
"""Description of the STM32G431's registers as one text, from the crate stm32g4.

    describe_stm32g431.py CRATE OUTPUT

CRATE is the unpacked crate (MIT or Apache-2.0, made by the project stm32-rs from ST's own System
View Description). `cargo fetch` in a project that depends on
``stm32g4 = "=0.15.1"`` puts it into cargo's registry. Only the peripherals that the port uses are
written: a line each with name and base address, below it a line a register with its offset, its
value after a reset, "r", "w" or "rw", and the masks of its fields, continued with more indentation.
"""

from __future__ import annotations

import re
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

PERIPHERALS = (
    *("ADC1", "ADC2", "ADC12_COMMON", "COMP", "DAC3", "DBGMCU", "DMA1", "DMAMUX", "EXTI", "FDCAN1"),
    *("FLASH", "GPIOA", "GPIOB", "GPIOC", "GPIOF", "IWDG", "OPAMP", "PWR", "RCC", "SYSCFG", "TIM1"),
    *("TIM4", "TIM8", "USART2"),
)
FIELD = re.compile(
    r'#\[doc = "Bits? (\d+)(?::(\d+))?[^"]*"\]\s*#\[inline\(always\)\]\s*'
    r"pub (?:unsafe )?fn (\w+)\(&(?:mut )?self\)"
)
REGISTER = re.compile(
    r'#\[doc = "0x([0-9a-f]+)[^"]*"\]\s*pub (\w+): crate::Reg<([\w:]+)_SPEC>', re.DOTALL
)
RESET = re.compile(r"fn reset_value\(\) -> Self::Ux \{\s*(\w+)\s*\}")
# A register with two views, as of input capture and output compare.
VIEW = re.compile(
    r'#\[doc = "0x([0-9a-f]+)[^"]*"\]\s*#\[inline\(always\)\]\s*pub (?:const )?fn (\w+)\(&self\)'
    r" -> &crate::Reg<(\w+)::"
)


def base_and_block(chip: str, name: str) -> tuple[int, str]:
    """Base address of a peripheral, and the module that has its registers."""
    found = re.search(
        rf"\bimpl {name} \{{.*?PTR: \*const (\w+)::RegisterBlock = (0x[0-9a-f_]+)", chip, re.DOTALL
    )
    if found is None:
        raise SystemExit(f"{sys.argv[0]}: the crate has no peripheral {name}")
    return int(found[2].replace("_", ""), 16), found[1]


def fields(text: str) -> dict[str, int]:
    """Mask of every field of a register."""
    masks: dict[str, int] = {}
    for low, high, name in FIELD.findall(text):
        width = int(high or low) - int(low) + 1
        masks[name.strip("_").upper()] = ((1 << width) - 1) << int(low)
    return masks


@dataclass(frozen=True)
class Register:
    """A register: offset, value after a reset, r, w or rw, masks of the fields."""

    offset: int
    reset: int
    access: str
    masks: dict[str, int]


def described(offset: int, text: str) -> Register:
    """Return what its module says about a register."""
    reset = RESET.search(text)
    access = "".join(
        letter
        for letter, trait in (("r", "Readable"), ("w", "Writable"))
        if f"::{trait} for" in text
    )
    value = int(reset[1].replace("_", ""), 0) if reset else 0
    return Register(offset, value, access, fields(text))


def registers(folder: Path, block: str) -> dict[str, Register]:
    """Every register of a peripheral, in the order of their offsets."""
    found: dict[str, Register] = {}
    text = (folder / f"{block}.rs").read_text(encoding="utf-8")
    body = text.split("pub struct RegisterBlock {", 1)[1]
    for offset, name, module in REGISTER.findall(body) + VIEW.findall(body):
        file = folder / block / f"{module.split('::')[0]}.rs"
        found[name.upper()] = described(int(offset, 16), file.read_text(encoding="utf-8"))
    return dict(sorted(found.items(), key=lambda item: item[1].offset))


def main(crate: str, output: str) -> None:
    """Write the description."""
    folder = Path(crate) / "src" / "stm32g431"
    chip = (folder / "mod.rs").read_text(encoding="utf-8")
    lines = [f"# {Path(crate).name} of the Rust registry; made by describe_stm32g431.py"]
    for name in PERIPHERALS:
        base, block = base_and_block(chip, name)
        lines.append(f"{name} 0x{base:08X}")
        for name_of, register in registers(folder, block).items():
            listed = [f"{field}:{mask:X}" for field, mask in register.masks.items()]
            about = f"{name_of} {register.offset:X} {register.reset:X} {register.access}"
            line = " ".join([about, *listed])
            lines += textwrap.wrap(line, 98, initial_indent="  ", subsequent_indent="    ")
    lines.append("INTERRUPTS")
    lines += [
        f"  {name} {number}"
        for number, name in re.findall(r'#\[doc = "(\d+) - [^"]*"\]\s*(\w+) = \d+,', chip)
    ]
    Path(output).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
