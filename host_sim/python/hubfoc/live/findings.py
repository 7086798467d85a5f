# SPDX-License-Identifier: Apache-2.0
"""What the controllers have found, with its times, and after which injected fault."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from hubsim import engine, reasons
from hubsim.engine import Rows

from hubfoc.live.faults import Active
from hubfoc.live.history import History

KINDS = ("fault", "warning")
MOST = 100  # the oldest are forgotten first


@dataclass
class Finding:
    """One line; ``after``: the latest injected fault of this wheel that was there."""

    wheel: int
    kind: str
    reason: str
    text: str
    from_s: float
    until_s: float | None = None
    acknowledged_s: float | None = None
    after: str | None = None
    delay_s: float | None = None


class Findings:
    """The reasons of faults and warnings of all wheels, as they come and go."""

    def __init__(self, history: History, wheels: int) -> None:
        self._sources = [(wheel, kind) for wheel in range(wheels) for kind in KINDS]
        self._places = history.places([f"wheel{w}.{kind}_reason" for w, kind in self._sources])
        self._codes = [0] * len(self._sources)
        self._open: dict[int, Finding] = {}
        self.lines: list[Finding] = []

    def look(self, time_s: float, row: Rows, faults: Mapping[str, Active]) -> None:
        """Compare with the millisecond before."""
        codes = np.nan_to_num(row[self._places]).astype(int).tolist()
        if codes == self._codes:
            return
        for k, (code, before) in enumerate(zip(codes, self._codes, strict=True)):
            if code != before:
                self._change(k, code, time_s, faults)
        self._codes = codes

    def acknowledge(self, time_s: float) -> None:
        """Mark all that has been found until now as acknowledged."""
        for line in self.lines:
            if line.acknowledged_s is None:
                line.acknowledged_s = time_s

    def shown(self) -> list[dict[str, Any]]:
        """Return all lines, the newest first."""
        return [asdict(line) for line in reversed(self.lines)]

    def _change(self, k: int, code: int, time_s: float, faults: Mapping[str, Active]) -> None:
        if k in self._open:
            self._open.pop(k).until_s = time_s
        if code == 0:
            return
        wheel, kind = self._sources[k]
        line = Finding(
            wheel, kind, reasons.identifier(code), engine.reason_text(code), from_s=time_s
        )
        concerned = {n: a for n, a in faults.items() if a.wheel in (None, wheel)}
        if concerned:
            line.after = max(concerned, key=lambda name: concerned[name].since_s)
            line.delay_s = time_s - concerned[line.after].since_s
        self._open[k] = line
        self.lines = [*self.lines, line][-MOST:]
