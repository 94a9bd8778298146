"""The entry point: what goes wrong is said in one line, with the exit code that means it.

0 is done; 2 is refused: the input cannot be served, and another try will not help; 1 is a fault of ours, or
frames that are missing; 130 is interrupted by a person, 143 terminated by what started it, as farms do.
"""

import os
import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

from aureole.refuse import Refusal

DONE, FAULT, REFUSED, INTERRUPTED, TERMINATED = 0, 1, 2, 130, 143


class Terminated(BaseException):
    """The system asked the process to end: what is half-written is removed on the way out."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after `aureole`; those of the process otherwise.
    """
    signal.signal(signal.SIGTERM, _terminate)
    sys.exit(run(sys.argv[1:] if arguments is None else arguments))


def run(arguments: Sequence[str]) -> int:
    """Run the command line and return the exit code.

    Parameters
    ----------
    arguments : sequence of str
        Words after `aureole`.

    Returns
    -------
    int
        0 done, 2 refused, 1 a fault of ours or frames that are missing, 130 interrupted, 143 terminated.
    """
    import typer
    from typer.main import get_command

    from aureole.cli.app import app

    command = get_command(app)
    words = list(arguments) or ["--help"]
    try:
        code = command.main(args=words, prog_name="aureole", standalone_mode=False)
    except Refusal as refusal:
        return _say(str(refusal), REFUSED)
    except typer.Abort:
        return _say("interrupted; nothing half-written is left.", INTERRUPTED)
    except KeyboardInterrupt:
        return _say("interrupted; nothing half-written is left.", INTERRUPTED)
    except Terminated:
        return _say("terminated; nothing half-written is left.", TERMINATED)
    except Exception as error:
        return _unexpected(error)
    if code == INTERRUPTED:  # some versions of the command line's library return it instead of raising
        return _say("interrupted; nothing half-written is left.", INTERRUPTED)
    return code if isinstance(code, int) else DONE


def _terminate(number: int, frame: object) -> NoReturn:
    """Leave by the way that an interrupt takes; a second signal ends the process at once."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    raise Terminated


def _unexpected(error: Exception) -> int:
    """Say a usage error as a refusal, anything else as a fault of ours."""
    message = getattr(error, "format_message", None)
    if message is not None:
        return _say(" ".join(str(message()).split()), REFUSED)
    if isinstance(error, MemoryError):
        return _say("not enough memory for this size; make the picture or the kernel smaller.", REFUSED)
    if isinstance(error, OSError):
        return _say(f"{error.strerror or error}: {error.filename or ''}".rstrip(": ") + ".", FAULT)
    if os.environ.get("AUREOLE_TRACEBACK"):
        raise error
    what = f"{type(error).__name__}: {error}"
    return _say(f"a fault of ours: {what} (AUREOLE_TRACEBACK=1 shows where).", FAULT)


def _say(message: str, code: int) -> int:
    sys.stdout.flush()
    print(f"aureole: {message}", file=sys.stderr)
    return code
