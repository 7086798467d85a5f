# SPDX-License-Identifier: Apache-2.0
"""Calls of other threads, made by the one that steps the vehicle."""

from collections.abc import Callable
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

Result = TypeVar("Result")
WAIT_S = 10.0


class Orders:
    """A queue of calls: ``call`` waits in any thread until ``serve`` has made it in its own."""

    def __init__(self) -> None:
        self._waiting: SimpleQueue[tuple[Callable[[], Any], Future[Any]]] = SimpleQueue()

    def call(self, function: Callable[[], Result]) -> Result:
        """Return what the function returns, or raise what it raises."""
        answer: Future[Result] = Future()
        self._waiting.put((function, answer))
        return answer.result(WAIT_S)

    def serve(self, wait_s: float = 0.0) -> None:
        """Make all calls that wait, after waiting for the first at most this long."""
        while True:
            try:
                function, answer = self._waiting.get(wait_s > 0.0, wait_s)
            except Empty:
                return
            wait_s = 0.0
            try:
                answer.set_result(function())
            except Exception as error:
                answer.set_exception(error)
