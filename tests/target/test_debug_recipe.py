# SPDX-License-Identifier: Apache-2.0
"""The README's commands that debug the firmware on the emulator stop at their breakpoint.

In the place of gdb, which is no package of the tests, its protocol is spoken here.
"""

import re
import shlex
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ELF = "build/qemu/hubfoc_qemu.elf"
LONGEST_S = 60.0


def recipe() -> tuple[list[str], str]:
    """Return the emulator's command and the function of the breakpoint."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## Debug\n")[2]
    emulator = re.search(r"^    (qemu-system-arm (?:.*\\\n)*.*)$", text, re.MULTILINE)
    breakpoint_at = re.search(rf"gdb-multiarch {ELF} .*-ex 'break (\w+)' -ex 'continue'", text)
    assert emulator is not None
    assert breakpoint_at is not None
    return shlex.split(emulator[1].replace("\\\n", " ")), breakpoint_at[1]


def address_of(function: str) -> int:
    """Return where a function of the firmware begins."""
    listed = subprocess.run(
        ["arm-none-eabi-nm", str(ROOT / ELF)], capture_output=True, text=True, check=True
    ).stdout
    found = re.search(rf"^([0-9a-f]{{8}}) [tT] {function}$", listed, re.MULTILINE)
    assert found is not None, function
    return int(found[1], 16)


class Debugger:
    """A connection to the emulator, as gdb has one."""

    def __init__(self, port: int) -> None:
        end = time.monotonic() + LONGEST_S
        while True:
            try:
                self._link = socket.create_connection(("127.0.0.1", port), LONGEST_S)
                return
            except OSError:
                assert time.monotonic() < end
                time.sleep(0.05)

    def ask(self, what: str) -> str:
        """Send a packet and return the answer."""
        self._link.sendall(f"+${what}#{sum(what.encode()) % 256:02x}".encode())
        answer = b""
        while (found := re.search(rb"\$([^#]*)#..", answer)) is None:
            answer += self._link.recv(4096)
        self._link.sendall(b"+")
        return found[1].decode()


@pytest.fixture
def emulator() -> Iterator[tuple[Debugger, str]]:
    """Start the README's emulator on a free port; return a debugger on it and the breakpoint."""
    command, function = recipe()
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    assert "tcp::3333" in command
    command = [word.replace("tcp::3333", f"tcp::{port}") for word in command]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL) as running:
        try:
            yield Debugger(port), function
        finally:
            running.kill()


def test_the_readme_s_breakpoint_is_reached_before_the_watchdog_ends_it(
    emulator: tuple[Debugger, str],
) -> None:
    debugger, function = emulator
    address = address_of(function)
    assert debugger.ask("?").startswith("T05")
    assert debugger.ask(f"Z0,{address:x},2") == "OK"
    assert debugger.ask("c").startswith("T05")  # W01: the firmware has ended
    program_counter = int.from_bytes(bytes.fromhex(debugger.ask("g"))[60:64], "little")
    assert program_counter == address


if __name__ == "__main__":
    sys.exit(pytest.main([__file__]))
