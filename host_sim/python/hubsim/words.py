# SPDX-License-Identifier: Apache-2.0
"""Words of the messages."""


def counted(number: int, word: str) -> str:
    """Return "1 wheel", "4 wheels"."""
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
