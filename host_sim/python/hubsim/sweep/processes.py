# SPDX-License-Identifier: Apache-2.0
"""Processes of this machine that share the work of a command, and Ctrl-C.

A terminal sends it to all of them. Only the process that was called says something.
"""

import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C until the end, where it comes then; what is started in here never gets it."""
    resource_tracker.ensure_running()  # its start would let Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def pool(count: int) -> Iterator[Executor]:
    """Provide processes that Ctrl-C ends without a word, and with them what waits for one."""
    executor = ProcessPoolExecutor(
        count, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_DFL)
    )
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)
