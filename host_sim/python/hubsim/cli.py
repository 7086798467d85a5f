"""The command line: ``python -m hubsim COMMAND ...``.

Mistakes are one line on stderr. Exit status 0: done and every criterion met; 1: refused, failed or a criterion not met;
2: wrong call.
"""

import sys
from collections.abc import Sequence

from regen_table.errors import ConfigurationError

from hubsim import __version__
from hubsim.arguments import DEFAULT_CONFIG, Parser
from hubsim.commands import compare, listing, report, run, sim, sweep
from hubsim.errors import HubsimError

__all__ = ["DEFAULT_CONFIG", "main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the process's exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except (HubsimError, ConfigurationError) as error:
        print(f"hubsim: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        return 130


def _parser() -> Parser:
    parser = Parser(prog="hubsim", description="The simulated vehicle: complete controllers on a physical plant.")
    parser.add_argument("--version", action="version", version=f"hubsim {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND", parser_class=Parser)
    for command in (run, sim, sweep, compare, listing, report):
        command.add(commands)
    return parser
