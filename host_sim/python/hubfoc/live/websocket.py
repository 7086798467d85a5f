# SPDX-License-Identifier: Apache-2.0
"""The server's end of a WebSocket (RFC 6455): text in, text and binary out, no extensions."""

import base64
import hashlib
import struct
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from threading import Lock

MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
VERSION = "13"
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
FINAL, MASKED = 0x80, 0x80
LENGTH_2, LENGTH_8 = 126, 127
MOST_BYTES = 65536  # of a message from the page


class WebSocket:
    """One connection; several threads may send while one receives."""

    def __init__(self, handler: BaseHTTPRequestHandler) -> None:
        self._in, self._out = handler.rfile, handler.wfile
        self._lock = Lock()

    def send_text(self, text: str) -> None:
        """Send a text; an OSError where nobody is there any more."""
        self._send(TEXT, text.encode())

    def send_binary(self, *parts: bytes) -> None:
        """Send bytes in one message."""
        self._send(BINARY, b"".join(parts))

    def receive(self) -> str | None:
        """Return the next text; None: closed, or not according to the protocol."""
        while True:
            head = self._in.read(2)
            if len(head) < 2 or not head[1] & MASKED:
                return None
            length = head[1] & ~MASKED
            if length == LENGTH_8:
                return None
            if length == LENGTH_2:
                (length,) = struct.unpack(">H", self._in.read(2))
            mask = self._in.read(4)
            data = self._in.read(length)
            if len(data) < length:
                return None
            data = bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
            kind = head[0] & ~FINAL
            if kind == PING:
                self._send(PONG, data)
            elif kind == TEXT and head[0] & FINAL:
                return data.decode("utf-8", "replace")
            elif kind != PONG:
                return None

    def close(self) -> None:
        """Say that this end closes."""
        self._send(CLOSE, b"")

    def _send(self, kind: int, data: bytes) -> None:
        length = len(data)
        if length < LENGTH_2:
            head = struct.pack(">BB", FINAL | kind, length)
        elif length < MOST_BYTES:
            head = struct.pack(">BBH", FINAL | kind, LENGTH_2, length)
        else:
            head = struct.pack(">BBQ", FINAL | kind, LENGTH_8, length)
        with self._lock:
            self._out.write(head + data)
            self._out.flush()


def opened(handler: BaseHTTPRequestHandler) -> WebSocket | None:
    """Answer the request to open one; None: it was none, and is refused."""
    key = handler.headers.get("Sec-WebSocket-Key")
    upgrade = (handler.headers.get("Upgrade") or "").lower()
    if (
        key is None
        or upgrade != "websocket"
        or (handler.headers.get("Sec-WebSocket-Version") != VERSION)
    ):
        handler.send_error(HTTPStatus.BAD_REQUEST, "accepted: a WebSocket")
        return None
    digest = hashlib.sha1((key + MAGIC).encode(), usedforsecurity=False).digest()
    handler.send_response(HTTPStatus.SWITCHING_PROTOCOLS)
    handler.send_header("Upgrade", "websocket")
    handler.send_header("Connection", "Upgrade")
    handler.send_header("Sec-WebSocket-Accept", base64.b64encode(digest).decode())
    handler.end_headers()
    handler.wfile.flush()
    return WebSocket(handler)
