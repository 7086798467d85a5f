# SPDX-License-Identifier: Apache-2.0
"""What a misspelt word was probably meant to be, in the words of every refusal.

Standard library only.
"""

import difflib
from collections.abc import Iterable

NEAR = 0.5  # share of letters that two words must have in common


def suggestion(word: str, known: Iterable[str], otherwise: str | None = None) -> str:
    """Return "did you mean X?" with the nearest known word.

    Where none is near: ``otherwise``, or else all of them.
    """
    names = list(known)
    near = difflib.get_close_matches(word, names, n=1, cutoff=NEAR)
    if near:
        return f"did you mean {near[0]}?"
    return f"accepted: {', '.join(names)}" if otherwise is None else otherwise
