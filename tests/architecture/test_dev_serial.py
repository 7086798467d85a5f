# SPDX-License-Identifier: Apache-2.0
"""tools/dev flash over a serial line, against a pseudo terminal that gives the answers of the
firmware's shell.
"""

import os
import pty
import shutil
import subprocess
import threading
import unittest

from dev_fixture import ROOT, DevFixture


class DevSerialTest(DevFixture):
    """The other end of the line is a thread."""

    def send_over_serial(self, *answers: bytes) -> tuple[subprocess.CompletedProcess[str], bytes]:
        """Flash a configuration over a line whose other end answers the shell's command, and then
        the image, with the given texts.
        """
        path, environment = self.pretend_everything_is_installed()
        (self.home / "firmware/config/generated").mkdir(parents=True)
        (self.home / "firmware/config/generated/lu2013.c").touch()
        (self.home / "build/stm32f405").mkdir(parents=True)
        for name in ("hubfoc_stm32f405.bin", "hubfoc_stm32f405.hex"):
            (self.home / "build/stm32f405" / name).touch()
        (self.home / "build/stm32f405/hubfoc_stm32f405_config.hex").write_text(
            ":0100000011EE\n:00000001FF\n"
        )
        board, line = pty.openpty()
        self.addCleanup(os.close, board)
        self.addCleanup(os.close, line)
        received = b""

        def answer() -> None:
            nonlocal received
            for waits_for, words in zip((b"install\r", b":00000001FF"), answers, strict=False):
                while waits_for not in received:
                    received += os.read(board, 4096)
                os.write(board, words)

        listener = threading.Thread(target=answer, daemon=True)
        listener.start()
        result = self.run_dev(
            *("flash", "--only-config", "--with", "serial", "--line", os.ttyname(line)),
            path=path,
            environment=environment,
        )
        listener.join(timeout=10)
        return result, received

    def test_a_dry_run_prints_the_command_and_runs_none(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        (self.home / "firmware/config/generated").mkdir(parents=True)
        for name in ("lu2013", "wheel24v"):
            (self.home / f"firmware/config/generated/{name}.c").touch()
        for port in ("stm32f405", "stm32g431"):
            (self.home / f"build/{port}").mkdir(parents=True)
            for name in (f"hubfoc_{port}.bin", f"hubfoc_{port}.hex"):
                (self.home / f"build/{port}" / name).touch()
        for arguments, words in (
            ((), ("openocd", "hubfoc_stm32f405.elf", "brown_out_level_3", "stlink")),
            (("--only-config",), ("openocd", "hubfoc_stm32f405_config_probe.hex")),
            (("--with", "pyocd"), ("pyocd", "hubfoc_stm32f405.hex")),
            (("--board", "b_g431b_esc1"), ("target/stm32g4x.cfg", "hubfoc_stm32g431.elf")),
        ):
            result = self.run_dev(
                "flash", "--dry-run", *arguments, path=path, environment=environment
            )
            self.assertEqual(result.returncode, 0, result.stderr)
            output = result.stdout + result.stderr
            self.assertIn("Would flash", output)
            for word in words:
                self.assertIn(word, output)
            self.assertNotIn("Flashed", output)

    PROMPT = b"> install\r\nsend the configuration as Intel HEX; ^C gives up\r\n> "

    def test_a_configuration_is_sent_over_the_serial_line_unchanged(self) -> None:
        result, received = self.send_over_serial(
            self.PROMPT, b"accepted: configuration x\r\nwritten, restarting\r\n"
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(":0100000011EE\n:00000001FF", received.decode().replace("\r", ""))
        self.assertEqual(result.stderr.splitlines()[-1], "Written; the board restarts with it")

    def test_refusal_by_the_board_is_reported(self) -> None:
        result, _ = self.send_over_serial(
            self.PROMPT, b"refused: record 1: wrong checksum; the configuration is as it was\r\n"
        )
        self.assertEqual(result.returncode, 1)
        self.assertIn(
            "tools/dev: flash: refused: record 1: wrong checksum", result.stderr.splitlines()[-1]
        )

    def test_moving_wheel_is_reported(self) -> None:
        result, _ = self.send_over_serial(
            self.PROMPT, b"accepted: configuration x\r\nrefused: only with the wheel at rest\r\n"
        )
        self.assertEqual(result.returncode, 1)
        self.assertIn("refused: only with the wheel at rest", result.stderr.splitlines()[-1])


@unittest.skipUnless(shutil.which("tclsh"), "no Tcl: OpenOCD brings its own")
class BrownOutTest(unittest.TestCase):
    """tools/setup/brown_out.tcl on two registers of a chip."""

    def written(self, options: int) -> tuple[list[str], str]:
        """Return the writes to registers, and what was printed."""
        script = (
            f"set optcr {options}; set log {{}}\n"
            "proc read_memory {address width count} { global optcr; return $optcr }\n"
            "proc sleep {ms} {}\nproc echo {text} { puts $text }\n"
            "proc mww {address value} { global optcr\n"
            " puts [format {%08X %08X} $address $value]\n"
            " if {$address == 0x40023C14 && ($value & 2)} { set optcr $value } }\n"
            f"source {ROOT}/tools/setup/brown_out.tcl\nbrown_out_level_3\n"
        )
        lines = subprocess.run(
            ["tclsh"], input=script, capture_output=True, text=True, check=True
        ).stdout.splitlines()
        return lines[:-1], lines[-1]

    def test_only_the_level_changes(self) -> None:
        writes, text = self.written(0x0FFFAAED)
        self.assertEqual(
            writes,
            # keys of FLASH_OPTKEYR, then the new value, started, and locked
            [
                *("40023C08 08192A3B", "40023C08 4C5D6E7F"),
                *("40023C14 0FFFAAE0", "40023C14 0FFFAAE2", "40023C14 0FFFAAE1"),
            ],
        )
        self.assertIn("set to 3", text)

    def test_a_chip_that_is_set_or_protected_or_unread_is_left_alone(self) -> None:
        for options in (0x0FFFAAE1, 0x0FFF55ED, 0x0FFCAAED, 0, 0xFFFFFFFF):
            writes, _ = self.written(options)
            self.assertEqual(writes, [])


if __name__ == "__main__":
    unittest.main()
