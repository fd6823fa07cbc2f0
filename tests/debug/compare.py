# SPDX-License-Identifier: Apache-2.0
"""gdb runs this script with the program of values.cpp: gdb --batch -x compare.py PROGRAM.

It prints each expression of values.cpp that gdb prints differently, and then how many are as expected. Exit status 0: all are;
1: not all are; 2: the program does not stop as often as values.cpp states.
"""
import re
from pathlib import Path

import gdb


def matches(expected, printed):
    return re.fullmatch(".*".join(re.escape(part) for part in expected.split("…")), printed, re.DOTALL)


def compare(source):
    """Returns the numbers of all expectations and of those that hold."""
    total = equal = 0
    waiting = []
    for number, line in enumerate(source.read_text(encoding="utf-8").splitlines(), 1):
        if comment := re.match(r" *// print (\S+) = (.*)", line):
            waiting.append((number, *comment.groups()))
        elif line.strip() == "stop();":
            gdb.execute("continue" if total else "run", to_string=True)
            gdb.execute("up-silently")
            for where, expression, expected in waiting:
                try:
                    printed = gdb.execute(f"print {expression}", to_string=True).split(" = ", 1)[1].rstrip("\n")
                except gdb.error as error:
                    printed = f"error: {error}"
                total += 1
                if matches(expected, printed):
                    equal += 1
                else:
                    print(f"{source.name}:{where}: {expression}\n  expected {expected}\n  printed  {printed[:500]}")
            waiting = []
    return total, equal


try:
    for setting in ("width 0", "height 0", "print elements 0", "print pretty off"):
        gdb.execute(f"set {setting}")
    gdb.Breakpoint("stop").silent = True
    total, equal = compare(Path(__file__).with_name("values.cpp"))
    print(f"{equal} of {total} values are printed as expected")
    status = 0 if equal == total else 1
except gdb.error as error:
    print(f"gdb: {error}")
    status = 2
if gdb.selected_inferior().pid:
    gdb.execute("kill", to_string=True)
gdb.execute(f"quit {status}")
