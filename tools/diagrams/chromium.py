# SPDX-License-Identifier: Apache-2.0
"""A Chromium without a window, driven through its debugging pipe."""

import base64
import itertools
import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

PROGRAMS = ("chromium-headless-shell", "chromium", "google-chrome")
PROGRAM = next(filter(None, map(shutil.which, PROGRAMS)), None)
MISSING = (
    "no Chromium here; tools/dev setup browser installs it where the system has a package of it"
)
QUIET = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-quic", "--hide-scrollbars",
)  # fmt: skip
ANSWER_S = 60.0  # of a busy machine
END = b"\0"  # of a message


class Browser:
    """One page of one browser.

    Attributes
    ----------
    console : list of str
        Everything that came to the console, and every error that nobody caught.
    """

    def __init__(self, profile: Path) -> None:
        if PROGRAM is None:
            raise AssertionError(MISSING)
        theirs_in, self._to = os.pipe()
        self._from, theirs_out = os.pipe()
        # The program reads from 3 and writes to 4, whichever numbers are free here.
        begin = f'exec 3<&{theirs_in} 4>&{theirs_out}; exec "$0" "$@"'
        self._process = subprocess.Popen(
            ["bash", "-c", begin, PROGRAM, *QUIET, f"--user-data-dir={profile}",
             "--remote-debugging-pipe", "about:blank"],
            pass_fds=(theirs_in, theirs_out), stderr=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(theirs_in)
        os.close(theirs_out)
        self._numbers = itertools.count(1)
        self._read = b""
        self._session: str | None = None
        self.console: list[str] = []
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=page, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def __enter__(self) -> Self:
        """Return the browser itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self._process.terminate()
        self._process.wait()
        os.close(self._to)
        os.close(self._from)

    @property
    def pid(self) -> int:
        """Return the number of its first process."""
        return self._process.pid

    def call(self, method: str, **parameters: object) -> dict[str, Any]:
        """Return the result of a command of the debugging protocol."""
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + END)
        end_s = time.monotonic() + ANSWER_S
        while time.monotonic() < end_s:
            answer = self._message()
            if answer.get("id") == number:
                assert "error" not in answer, answer["error"]
                return dict(answer["result"])
            self._notice(answer)
        raise AssertionError(f"{method}: no answer")

    def size(self, width: int, height: int, *, dark: bool = False) -> None:
        """Make the window so large, light or dark."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)  # fmt: skip
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def open(self, url: str) -> None:
        """Go to an address."""
        self.call("Page.navigate", url=url)

    def evaluate(self, expression: str) -> Any:  # noqa: ANN401, JSON
        """Return the value of an expression in the page."""
        message = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                         awaitPromise=True)  # fmt: skip
        assert "exceptionDetails" not in message, message["exceptionDetails"]
        return message["result"].get("value")

    def text(self, selector: str) -> str:
        """Return what an element shows."""
        return str(self.evaluate(f"document.querySelector({json.dumps(selector)}).innerText"))

    def click(self, selector: str) -> None:
        """Click an element."""
        self.evaluate(f"document.querySelector({json.dumps(selector)}).click()")

    def slide(self, selector: str, value: float | str) -> None:
        """Move a slider, or choose in a list, as a person does."""
        chosen = json.dumps(selector)
        self.evaluate(
            f"(() => {{ const element = document.querySelector({chosen});"
            f" element.value = {json.dumps(value)};"
            " for (const name of ['input', 'change'])"
            " element.dispatchEvent(new Event(name, { bubbles: true })); })()"
        )

    def press(self, key: str) -> None:
        """Press a key and let it go."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key,
                      text=key if kind == "keyDown" else "")  # fmt: skip

    def until(self, expression: str) -> None:
        """Wait until an expression is true in the page."""
        end_s = time.monotonic() + ANSWER_S
        while not self.evaluate(expression):
            assert time.monotonic() < end_s, expression
            time.sleep(0.05)

    def until_true(self, condition: Callable[[], bool], what: str) -> None:
        """Wait until something is so."""
        end_s = time.monotonic() + ANSWER_S
        while not condition():
            assert time.monotonic() < end_s, what
            time.sleep(0.05)

    def picture(self, path: Path) -> None:
        """Write what the window shows."""
        message = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=False)
        path.write_bytes(base64.b64decode(message["data"]))

    def _message(self) -> dict[str, Any]:
        while END not in self._read:
            received = os.read(self._from, 1 << 16)
            assert received, "the browser has ended"
            self._read += received
        text, _, self._read = self._read.partition(END)
        return dict(json.loads(text))

    def _notice(self, message: dict[str, Any]) -> None:
        kinds = ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded")
        if message.get("method") in kinds:
            self.console.append(json.dumps(message["params"]))
