# SPDX-License-Identifier: Apache-2.0
"""How the declaration of a key says what it is taken to be where a file does not give it.

Standard library only.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


class Known(Protocol):
    """The values of a drive that a default may be derived from (assumed.py)."""

    def __call__(self, key: str) -> Any:  # noqa: ANN401, whatever TOML can say
        """Return "section.key" as the file gives it, else by its rule, else its fixed default."""

    def given(self, key: str) -> bool:
        """Return whether the file gives the key."""


@dataclass(frozen=True)
class Assumed:
    """What an absent key is taken to be: part of the key's declaration.

    Attributes
    ----------
    value : callable
        From what else is known; its docstring says how. None: the key stays absent.
    cost : str
        What it costs where the assumption is wrong.
    """

    value: Callable[[Known], Any]
    cost: str

    @property
    def how(self) -> str:
        """Return the first sentence of the rule."""
        sentence = (self.value.__doc__ or "").partition(".\n")[0]
        return " ".join(sentence.split()).rstrip(".").removeprefix("Return ")
