# SPDX-License-Identifier: Apache-2.0
"""The local HTTP service of a virtual vehicle, on 127.0.0.1 alone."""

import json
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Self

from hubfoc.errors import HubfocError

HOST = "127.0.0.1"


class Service:
    """``GET /health`` answers with a JSON object; everything else is not found."""

    def __init__(self, port: int, health: Callable[[], Mapping[str, float]]) -> None:
        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                found = self.path == "/health"
                body = json.dumps(health() if found else {"error": "accepted: GET /health"})
                self.send_response(HTTPStatus.OK if found else HTTPStatus.NOT_FOUND)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body.encode())

            def log_message(self, *_: object) -> None:
                """Say nothing."""

        try:
            self._server = ThreadingHTTPServer((HOST, port), Handler)
        except OSError as error:
            raise HubfocError(f"--port {port}: {error.strerror}, accepted: a free port, or 0 for "
                              "any") from error  # fmt: skip
        self._server.daemon_threads = True
        self._thread = Thread(target=self._server.serve_forever, args=(0.1,), daemon=True)
        self.url = f"http://{HOST}:{self._server.server_address[1]}/"

    def __enter__(self) -> Self:
        """Begin to answer."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self._server.shutdown()
        self._server.server_close()
