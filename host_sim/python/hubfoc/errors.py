# SPDX-License-Identifier: Apache-2.0
"""The error that a person may cause: one line, with what is accepted."""


class HubfocError(Exception):
    """A mistake of the caller, or a bus, port or vehicle that is not there."""
