# SPDX-License-Identifier: Apache-2.0
"""The command line: ``hubsim COMMAND ...``."""

from hubsim.cli.arguments import DEFAULT_CONFIG, EXAMPLES, RECORDINGS, STRATEGIES, main, parser

__all__ = ["DEFAULT_CONFIG", "EXAMPLES", "RECORDINGS", "STRATEGIES", "main", "parser"]
