# SPDX-License-Identifier: Apache-2.0
"""tools/dev flash over a serial line, against a pseudo terminal that gives the answers of the
firmware's shell.
"""

import os
import pty
import subprocess
import threading
import unittest

from dev_fixture import DevFixture


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


if __name__ == "__main__":
    unittest.main()
