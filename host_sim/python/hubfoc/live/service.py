# SPDX-License-Identifier: Apache-2.0
"""The local HTTP service of a virtual vehicle, on 127.0.0.1 alone.

Everything lies below a token that is drawn at the start and part of the address. A request that a
page of another origin makes is refused, as is one under another host name.
"""

import json
import secrets
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any, Self

from hubsim.errors import HubsimError

from hubfoc.errors import HubfocError

HOST = "127.0.0.1"
TOKEN_BYTES = 12
MOST_BYTES = 65536
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: "
    "blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)


@dataclass(frozen=True)
class Answers:
    """Who answers what: GET by path, POST to ``simulation``, a WebSocket to ``stream``.

    ``recording`` is the latest complete one, to be had as a file.
    """

    get: Mapping[str, Callable[[], Any]]
    change: Callable[[Mapping[str, Any]], Any]
    page: Callable[[], str] | None = None
    recording: Callable[[], Path | None] = lambda: None
    stream: Callable[["Handler"], None] | None = None


class Handler(BaseHTTPRequestHandler):
    """One request. ``answers``, ``token`` and ``authority`` are set for the server."""

    protocol_version = "HTTP/1.1"
    answers: Answers
    token: str
    authority: str

    def do_GET(self) -> None:
        """Answer a question, or hand the connection over to the page's stream."""
        path = self._path()
        if path is None:
            return
        if path == "" and self.answers.page is not None:
            self._send(HTTPStatus.OK, "text/html; charset=utf-8", self.answers.page().encode())
        elif path == "stream" and self.answers.stream is not None:
            self.close_connection = True
            self.answers.stream(self)
        elif path == "recording" and (file := self.answers.recording()) is not None:
            self._send_file(file)
        elif path in self.answers.get:
            self._answer(self.answers.get[path])
        else:
            accepted = ", ".join(f"GET {name}" for name in sorted(self.answers.get))
            self._refuse(HTTPStatus.NOT_FOUND, f"accepted: {accepted}")

    def do_POST(self) -> None:
        """Change the simulated world."""
        path = self._path()
        if path is None:
            return
        length = int(self.headers.get("Content-Length") or 0)
        if path != "simulation" or not 0 < length <= MOST_BYTES:
            self.close_connection = True
            self._refuse(HTTPStatus.NOT_FOUND, "accepted: POST simulation, with JSON")
            return
        try:
            wanted = json.loads(self.rfile.read(length))
        except ValueError:
            wanted = None
        if not isinstance(wanted, dict):
            self._refuse(HTTPStatus.BAD_REQUEST, "accepted: a JSON object")
            return
        self._answer(lambda: self.answers.change(wanted))

    def _path(self) -> str | None:
        """Return what comes after the token; None: refused, and answered."""
        origin = self.headers.get("Origin")
        if self.headers.get("Host") != self.authority or origin not in (
            None,
            f"http://{self.authority}",
        ):
            self._refuse(HTTPStatus.FORBIDDEN, f"accepted: from http://{self.authority} only")
            return None
        if self.path == "/health":
            return "health"
        token, slash, rest = self.path.removeprefix("/").partition("/")
        if not slash or not secrets.compare_digest(token.encode(), self.token.encode()):
            self._refuse(HTTPStatus.NOT_FOUND, "accepted: the address that hubfoc live printed")
            return None
        return rest

    def _answer(self, question: Callable[[], Any]) -> None:
        try:
            self._send_json(HTTPStatus.OK, question())
        except (HubfocError, HubsimError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error))

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._send_json(status, {"error": why})

    def _send_json(self, status: HTTPStatus, value: object) -> None:
        self._send(status, "application/json", json.dumps(value).encode())

    def _send(self, status: HTTPStatus, kind: str, body: bytes) -> None:
        self._send_head(status, kind, len(body))
        self.wfile.write(body)

    def _send_file(self, file: Path) -> None:
        with file.open("rb") as content:
            named = ("Content-Disposition", f'attachment; filename="{file.name}"')
            size = file.stat().st_size
            self._send_head(HTTPStatus.OK, "application/octet-stream", size, named)
            shutil.copyfileobj(content, self.wfile)

    def _send_head(self, status: HTTPStatus, kind: str, size: int, *more: tuple[str, str]) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(size)),
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
            ("Content-Security-Policy", POLICY),
            *more,
        ):
            self.send_header(name, value)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


class Service:
    """The server; ``url`` is where it is found, with the token."""

    def __init__(self, port: int, answers: Answers) -> None:
        token = secrets.token_urlsafe(TOKEN_BYTES)
        own = type("OwnHandler", (Handler,), {"answers": answers, "token": token})
        try:
            self._server = ThreadingHTTPServer((HOST, port), own)
        except OSError as error:
            raise HubfocError(f"--port {port}: {error.strerror}, accepted: a free port, or 0 for "
                              "any") from error  # fmt: skip
        own.authority = f"{HOST}:{self._server.server_address[1]}"  # type: ignore[attr-defined]
        self._server.daemon_threads = True
        self._thread = Thread(target=self._server.serve_forever, args=(0.1,), daemon=True)
        self.url = f"http://{HOST}:{self._server.server_address[1]}/{token}/"

    def __enter__(self) -> Self:
        """Begin to answer."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self._server.shutdown()
        self._server.server_close()
