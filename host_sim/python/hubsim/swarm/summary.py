# SPDX-License-Identifier: Apache-2.0
"""What many records come to: the object that ``--json`` writes, and lines for people."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from hubsim.swarm import judge, work
from hubsim.swarm.work import Record

SCHEMA = 1
UNCOMMITTED = "+"
SHOWN = 20  # violations on the terminal


def summed(records: Sequence[Record], commit: str, scenarios: Mapping[int, str]) -> dict[str, Any]:
    """Return the whole as JSON has it. ``scenarios``: files of seeds that failed."""
    several = sorted(records, key=lambda record: int(record["seed"]))
    healthy = [record for record in several if not record["kind"]]
    gaps = [r["worst"][judge.STORED_SHARE]["value"] for r in healthy
            if judge.STORED_SHARE in r["worst"]]  # fmt: skip
    pairs = {pair for record in several for pair in record["coverage"]}
    return {
        "schema": SCHEMA,
        "commit": commit.removesuffix(UNCOMMITTED),
        "dirty": commit.endswith(UNCOMMITTED),
        "runs": len(several),
        "healthy": {
            "runs": len(healthy),
            "warnings": sum(_has(record, "warning") for record in healthy),
            "worst_share_gap": None if None in gaps else max(gaps, default=0.0),
        },
        "violations": [
            {
                "seed": record["seed"],
                **{key: violation[key] for key in ("invariant", "wheel", "time_s", "value",
                                                   "limit", "unit")},
                "image_crc32": record["image_crc32"],
                "kind": record["kind"] or violation["text"],
                "scenario": scenarios.get(record["seed"]),
            }
            for record in several
            for violation in record["violations"]
        ],
        "worst": _worst(several),
        "coverage": {"seen": len(pairs), "possible": work.possible()},
        "cpu_s": sum(record["cpu_s"] for record in several),
    }  # fmt: skip


def _has(record: Record, invariant: str) -> bool:
    return any(violation["invariant"] == invariant for violation in record["violations"])


def _worst(records: Sequence[Record]) -> dict[str, Any]:
    """Return, for each invariant, the value with the largest share of its limit."""
    found: dict[str, Any] = {}
    for name in judge.NAMES:
        here = [(r["worst"][name], r["seed"]) for r in records if name in r["worst"]]
        if here:
            worst, seed = max(here, key=lambda pair: _share(pair[0]))
            keys = ("value", "limit", "unit")
            found[name] = {key: worst[key] for key in keys} | {"seed": seed}
    return found


def _share(finding: Mapping[str, Any]) -> float:
    return float("inf") if finding["share"] is None else float(finding["share"])


def described(violation: Mapping[str, Any]) -> str:
    """Return a violation of ``summed`` in a line."""
    wheel = "" if violation["wheel"] is None else f", wheel {violation['wheel']}"
    return (
        f"seed {violation['seed']}{wheel}, {violation['time_s']:.3f} s: {violation['invariant']} "
        f"{number(violation['value'])} of {number(violation['limit'])} {violation['unit']} "
        f"({violation['kind']})"
    )


def number(value: float | None) -> str:
    """Return a number for people."""
    return "infinite" if value is None else f"{value:.4g}"


def lines(whole: Mapping[str, Any]) -> list[str]:
    """Return what there is to say."""
    healthy, violations = whole["healthy"], whole["violations"]
    out = [described(violation) for violation in violations[:SHOWN]]
    if len(violations) > SHOWN:
        out.append(f"and {len(violations) - SHOWN} more")
    by_name = Counter(violation["invariant"] for violation in violations)
    failed = len({violation["seed"] for violation in violations})
    out.append(
        f"{whole['runs']} runs, {failed} with a violation"
        + "".join(f"; {name} {number}" for name, number in by_name.most_common())
    )
    gap = healthy["worst_share_gap"]
    out.append(
        f"healthy: {healthy['runs']} runs, {healthy['warnings']} with a warning, stored share "
        f"at most {'unknown' if gap is None else f'{100.0 * gap:.2f} %'} beside the ideal"
    )
    seen, possible = whole["coverage"]["seen"], whole["coverage"]["possible"]
    out.append(f"pairs of fault, mode, limit and rotor sensor: {seen} of {possible}; "
               f"{whole['cpu_s']:.0f} s of processor time")  # fmt: skip
    return out
