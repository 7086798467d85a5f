# SPDX-License-Identifier: Apache-2.0
"""Build several configured presets at the same time, so that no core waits for another's linker.

``python -m run_tests.build LOGS PRESET:TARGET...``: the first preset is built beside the
others, which follow one another. Each has its log in the folder LOGS, ``build-PRESET.log``; the
names of those that failed are written to ``build-failed`` there, the ends of their logs to stdout,
and how long each took is added to ``times``.
"""

import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

from run_tests.suite import ROOT, jobs

SHOWN_LINES = 20


def build(logs: Path, preset: str, targets: Sequence[str]) -> bool:
    """Build targets of a preset; show the progress; return False on failure."""
    command = ["cmake", "--build", "--preset", preset, "--parallel", str(jobs())]
    command += ["--target", *targets]
    begin = time.monotonic()
    with (logs / f"build-{preset}.log").open("w", encoding="utf-8") as log:
        process = subprocess.Popen(
            command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            errors="replace",
        )  # fmt: skip
        assert process.stdout is not None
        for line in process.stdout:
            log.write(line)
            print(f"{preset}: {line}", end="", flush=True)
        status = process.wait()
    with (logs / "times").open("a", encoding="utf-8") as times:
        times.write(f"{preset} build {time.monotonic() - begin:.1f}\n")
    return status == 0


def main(arguments: list[str]) -> int:
    """Build in two lanes and return 1 if a preset failed."""
    logs = Path(arguments[0])
    wanted = [(preset, targets.split()) for preset, _, targets in
              (argument.partition(":") for argument in arguments[1:])]  # fmt: skip
    failed: list[str] = []

    def lane(share: list[tuple[str, list[str]]]) -> None:
        failed.extend(preset for preset, targets in share if not build(logs, preset, targets))

    other = threading.Thread(target=lane, args=(wanted[1:],))
    other.start()
    lane(wanted[:1])
    other.join()
    (logs / "build-failed").write_text("".join(f"{name}\n" for name in failed), encoding="utf-8")
    for name in failed:
        lines = (logs / f"build-{name}.log").read_text(encoding="utf-8").splitlines()
        print("\n".join([f"{name}:", *lines[-SHOWN_LINES:]]))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
