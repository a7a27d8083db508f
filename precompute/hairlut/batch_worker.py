"""A process that runs commands of hairlut, one after the other, for batch_bake.py.

Each line of its input is the list of a command's arguments, and each line of its output [exit code, what the
command printed], both as JSON.
"""

import json
import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from traceback import print_exc

from .cli import CHECK_FAILED, main


def serve() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints by itself is no answer
    for line in sys.stdin:
        print(json.dumps(run(json.loads(line))), file=answers, flush=True)


def run(command: list[str]) -> tuple[int, str]:
    """(exit code, what was printed)"""
    printed = StringIO()
    with redirect_stdout(printed), redirect_stderr(printed):
        try:
            code = main(command)
        except (Exception, SystemExit):  # whatever a model's code does
            print_exc()
            code = CHECK_FAILED
    return code, printed.getvalue()


if __name__ == "__main__":
    serve()
