# SPDX-License-Identifier: Apache-2.0
"""A sweep from beginning to end.

Batches handed to Dask's workers, kept as they come back, joined when all are there.

Without an address the workers are processes of this machine, one for each core; a single one is
this process itself, without Dask. With an address they are whatever the scheduler has, which must
be able to import hubsim and to find the built engine (HUBFOC_BUILD_DIR).
"""

import math
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa
from dask import config as dask_config
from distributed import Client, LocalCluster, as_completed

from hubsim.errors import HubsimError
from hubsim.sweep import processes as local
from hubsim.sweep import work
from hubsim.sweep.plan import Plan
from hubsim.sweep.store import Store
from hubsim.sweep.work import Job
from hubsim.words import counted

BATCHES_MAX = 1000
BATCH_RUNS = 4  # about a second: an interruption loses little, distribution costs little
CONNECT_S = 5
LOOPBACK = "127.0.0.1"

Progress = Callable[[int, int], None]  # runs done, runs planned


@contextmanager
def workers(address: str | None, processes: int | None) -> Iterator[Client]:
    """Connect to a scheduler, or start workers here for as long as they are needed."""
    if address is not None:
        try:
            client = Client(address, timeout=CONNECT_S)
        except (OSError, ValueError, TimeoutError) as error:
            raise HubsimError(
                f"--scheduler {address}: no Dask scheduler answers there ({type(error).__name__})"
            ) from error
        with client:
            yield client
        return
    _check_loopback()
    with dask_config.set({"distributed.worker.daemon": True}), ExitStack() as stack:
        # The workers listen to this machine alone; Dask's own page takes any free port, so that a
        # second sweep gives no warning.
        with local.interrupts_blocked():
            cluster = stack.enter_context(
                LocalCluster(
                    n_workers=processes or os.cpu_count() or 1,
                    threads_per_worker=1,
                    host=LOOPBACK,
                    dashboard_address=f"{LOOPBACK}:0",
                    silence_logs=50,
                )
            )
        yield stack.enter_context(Client(cluster))


def _check_loopback() -> None:
    """Refuse a machine whose processes cannot reach each other, which Dask tries for a minute."""
    try:
        with (
            socket.create_server((LOOPBACK, 0)) as server,
            socket.create_connection(server.getsockname(), CONNECT_S),
        ):
            pass
    except OSError as error:
        raise HubsimError(
            f"workers cannot be reached over {LOOPBACK} here ({error.strerror or error}), accepted:"
            " --workers 1"
        ) from error


def batches(plan: Plan) -> list[tuple[list[int], list[dict[str, Any]]]]:
    """Return the runs in batches; the same plan always makes the same ones."""
    points = list(plan.points())
    size = max(BATCH_RUNS, math.ceil(len(points) / BATCHES_MAX))
    return [
        (list(range(k, min(k + size, len(points)))), points[k : k + size])
        for k in range(0, len(points), size)
    ]


def conduct(
    job: Job,
    plan: Plan,
    store: Store,
    address: str | None = None,
    processes: int | None = None,
    progress: Progress | None = None,
) -> pa.Table:
    """Do every run that is not done yet and return the table of all.

    Parameters
    ----------
    address : str, optional
        Of a Dask scheduler; without, workers are started here.
    processes : int, optional
        How many workers to start here; by default one for each core.
    """
    done = store.open()
    parts = batches(plan)
    waiting = [k for k in range(len(parts)) if k not in done]
    finished = sum(len(parts[k][0]) for k in done)
    if progress is not None:
        progress(finished, plan.runs)
    try:
        for batch, rows in _worked_off(job, parts, waiting, (address, processes)):
            store.put(batch, rows)
            finished += len(rows)
            if progress is not None:
                progress(finished, plan.runs)
    except BaseException:
        if not finished:
            store.forget()
        raise
    return store.finish()


def _worked_off(
    job: Job,
    parts: Sequence[tuple[list[int], list[dict[str, Any]]]],
    waiting: Sequence[int],
    where: tuple[str | None, int | None],
) -> Iterator[tuple[int, list[work.Row]]]:
    """Hand the waiting batches out and give them back in the order in which they are done."""
    if not waiting:
        return
    if where == (None, 1):
        for k in waiting:
            yield k, work.do(job, *parts[k])
        return
    with workers(*where) as client:
        futures = {client.submit(work.do, job, *parts[k], pure=False): k for k in waiting}
        for future in as_completed(futures):
            yield futures[future], future.result()
            future.release()


def is_clean(table: pa.Table) -> bool:
    """Return whether every run was done and met its criteria."""
    rows = table.select(
        [name for name in ("error", "passed") if name in table.column_names]
    ).to_pylist()
    return all(row.get("error") is None and row.get("passed") is not False for row in rows)


def summary(table: pa.Table, keys: Sequence[str], output: Path) -> list[str]:
    """Return the message about a finished sweep."""
    errors = table["error"].drop_null() if "error" in table.column_names else pa.array([])
    lines = [f"{counted(table.num_rows, 'run')} over {', '.join(keys)}: {output}"]
    if "passed" in table.column_names:
        passed = sum(value is True for value in table["passed"].to_pylist())
        lines.append(f"{passed} of {table.num_rows} met every criterion")
    if len(errors):
        lines.append(f"{len(errors)} could not be run, the first because: {errors[0].as_py()}")
    return lines
