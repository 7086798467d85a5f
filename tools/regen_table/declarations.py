# SPDX-License-Identifier: Apache-2.0
"""C declarations as cffi knows them, parsed once and then kept (stored.py)."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from regen_table import stored

if TYPE_CHECKING:
    import cffi

_MODULE = "declarations"


class DeclarationError(Exception):
    """Declarations that cffi does not understand."""


def known(text: str) -> "cffi.FFI":
    """Return an FFI with these declarations.

    What is kept is the Python module that cffi writes for them. It needs cffi's compiled part
    alone, not its parser of C.

    Raises
    ------
    DeclarationError
        As cffi says it.
    """
    import _cffi_backend  # noqa: PLC0415, see regen_table.layout

    content = (_cffi_backend.__version__.encode(), text.encode())
    source = stored.by_content("declarations", content, lambda: _compiled(text))
    namespace: dict[str, Any] = {}
    exec(compile(source, _MODULE, "exec"), namespace)
    found: cffi.FFI = namespace["ffi"]
    return found


def _compiled(text: str) -> bytes:
    import cffi  # noqa: PLC0415, few calls need them
    from cffi import recompiler  # noqa: PLC0415

    ffi = cffi.FFI()
    try:
        ffi.cdef(text)
    except (cffi.CDefError, cffi.FFIError) as error:
        raise DeclarationError(str(error)) from error
    ffi.set_source(_MODULE, None)
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / f"{_MODULE}.py"
        recompiler.make_py_source(ffi, _MODULE, str(path))
        return path.read_bytes()
