# SPDX-License-Identifier: Apache-2.0
"""A crash record: from the shell's text to the fault in words and its place in the program."""

import struct
from pathlib import Path

import pytest
from hubsim import cli
from hubsim.errors import HubsimError
from hubsim.report import crash

# As the shell prints it: a load from 0x60000010 (BFARVALID and PRECISERR, bits 15 and 9) in a hard
# fault that was raised from a bus fault (FORCED, bit 30).
REGISTERS = (1, 2, 3, 4, 5, 0x08020205, 0x08020142, 0x21000000, 0x20000F00, 0x8200, 1 << 30)
HEAD = "crash 2 since the supply came: bus fault at 0x08020142\r\n"
LOG = (
    "> crash\r\n"
    + HEAD
    + "r0 .. r3 r12 lr pc psr sp cfsr hfsr address: "
    + " ".join(f"0x{value:08X}" for value in (*REGISTERS, 0x60000010))
    + "\r\n> \r\n"
)


def elf(functions: dict[str, tuple[int, int]]) -> bytes:
    """Return an ELF of 32 bits with nothing but symbols: section 0, their names, their table."""
    names, table = b"\0", bytes(16)
    for name, (address, size) in functions.items():
        table += struct.pack("<3I2BH", len(names), address | 1, size, 2, 0, 1)
        names += name.encode() + b"\0"
    table += struct.pack("<3I2BH", 1, 0x20000000, 4, 1, 0, 2)  # an object, with a used name
    head = b"\x7fELF\x01\x01\x01".ljust(16, b"\0") + struct.pack(
        "<2H5I6H", 2, 40, 1, 0, 0, 52, 0, 52, 0, 0, 40, 3, 1
    )
    begin = 52 + 3 * 40
    sections = bytes(40)
    sections += struct.pack("<10I", 0, 3, 0, 0, begin, len(names), 0, 0, 1, 0)
    sections += struct.pack("<10I", 0, 2, 0, 0, begin + len(names), len(table), 1, 0, 4, 16)
    return head + sections + names + table


def test_the_shells_text_becomes_words_and_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, image = tmp_path / "log.txt", tmp_path / "firmware.elf"
    log.write_text("an older one: " + HEAD.replace("crash 2", "crash 1") + LOG, encoding="utf-8")
    image.write_bytes(elf({"slow_step": (0x08020200, 64), "fast_step": (0x08020100, 128)}))
    assert cli.main(["crash", str(log), "--elf", str(image)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "crash 2 since the supply came: bus fault"
    assert lines[1:3] == ["pc       0x08020142 fast_step+0x42", "lr       0x08020205 slow_step+0x4"]
    assert lines[3:5] == [
        "why      no memory at the accessed data",
        "why      raised to a hard fault",
    ]
    assert lines[5] == "address  0x60000010"
    assert "sp 0x20000F00 cfsr 0x00008200" in lines[6]


def test_the_greeting_alone_names_the_place() -> None:
    lines = crash.described(crash.read(HEAD, "log"))
    assert lines[1:] == ["pc       0x08020142", "lr       unknown"]


def test_a_failed_check_names_module_and_number() -> None:
    text = "crash 1 since the supply came: failed check at 0x00080003\n"
    assert crash.described(crash.read(text, "log"))[1] == "check 3 of app"


def test_registers_that_the_core_could_not_store_are_unknown() -> None:
    stack = "crash 1 since the supply came: stack overflow at 0xFFFFFFFF\n"
    assert crash.described(crash.read(stack, "log"))[1:] == ["pc       unknown", "lr       unknown"]


def test_addresses_outside_of_functions_have_no_name() -> None:
    known = crash.functions(elf({"only": (0x100, 16)}), "elf")
    assert [crash.place_of(at, known) for at in (0xFF, 0x101, 0x10E, 0x110)] == [
        *("", "only+0x0", "only+0xE", ""),
    ]


def test_other_files_are_refused_with_one_line(tmp_path: Path) -> None:
    with pytest.raises(HubsimError, match="no record"):
        crash.read("no crash since the supply came", "log")
    with pytest.raises(HubsimError, match="ELF of 32 bits"):
        crash.functions(b"\x7fELF\x02\x01", "elf")
    with pytest.raises(HubsimError, match="ELF of 32 bits"):
        crash.functions(elf({"one": (0x100, 16)})[:-20], "elf")
    with pytest.raises(HubsimError, match="ELF of 32 bits"):
        crash.functions(elf({"one": (0x100, 16)})[:50], "elf")
    log = tmp_path / "log.txt"
    log.write_text(LOG, encoding="utf-8")
    assert cli.main(["crash", str(log), "--elf", str(tmp_path / "none.elf")]) != 0
