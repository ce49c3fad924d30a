"""Runs the tools that are packed with this module."""

import json
import os
import subprocess
import sys
import tempfile
from typing import Any, Dict, List, NoReturn, Optional, Tuple, Union

from ._error import Error

_BIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin")
_BUDGET_HIT = 7  # a usable partial result was written


def run(command: str, *inputs: Union[str, "os.PathLike[str]"], **options: Any) -> Optional[Dict[str, Any]]:
    """Runs a command of ngs ("cut", "joint", "scene import") and returns its JSON report; None if it writes none.

    A keyword is an option: fit_steps=100 is --fit-steps 100; a list repeats the option; True is the flag itself, False is
    --no-FLAG, None is left out; a keyword of one letter is a short option (o="out.ply"). Raises Error if the tool fails or
    a requested check fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "report.json")
        words = [os.path.join(_BIN, "ngs"), *command.split(), *map(os.fspath, inputs), *_flags(options)]
        if "report" in options:
            report = os.fspath(options["report"])
        else:
            words += ["--report", report]
        done = subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                              text=True, errors="replace", check=False)
        if done.returncode not in (0, _BUDGET_HIT):
            raise Error(done.returncode, *_failure(done.stderr))
        if not os.path.exists(report):
            return None
        with open(report, encoding="utf-8") as file:
            return json.load(file)


def _flags(options: Dict[str, Any]) -> List[str]:
    words: List[str] = []
    for name, value in options.items():
        flag = ("-" if len(name) == 1 else "--") + name.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                words.append(flag)
            elif one is False:
                words.append("--no-" + flag.lstrip("-"))
            elif one is not None:
                words += [flag, os.fspath(one) if isinstance(one, os.PathLike) else str(one)]
    return words


def _failure(text: str) -> Tuple[str, str]:
    """Message and hint of the last error in what a tool printed: "TOOL: error: ...", "TOOL: hint: ..."."""
    message, remedy = text.strip(), ""
    for line in text.splitlines():
        if ": error: " in line:
            message, remedy = line.split(": error: ", 1)[1], ""
        elif ": hint: " in line:
            remedy = line.split(": hint: ", 1)[1]
    return message, remedy


def main() -> NoReturn:
    """Replaces this process by the tool whose name it was called by."""
    program = os.path.join(_BIN, os.path.basename(sys.argv[0]))
    os.execv(program, [program, *sys.argv[1:]])
