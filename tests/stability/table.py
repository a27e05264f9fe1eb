#!/usr/bin/env python3
"""The table of README.md from what the suite printed, a file for each ray tracer: Embree 3, Embree 4 and obvhs.

    cargo test --release --test stability -- --nocapture --include-ignored --test-threads 1 | tee embree3.txt
    python3 tests/stability/table.py "Embree 3=embree3.txt" "Embree 4=embree4.txt"

A figure of a file's Embree goes into its column; obvhs and what needs no ray are the same everywhere, and the
worst of all files is shown. Where the suite prints a figure several times, the worst counts.
"""
import re, sys

LINE = re.compile(r"\| (S\d+) \| (.*) \| ([a-z]+)(, guided)? \| (\S+) \| (\S+) \|$")


def read(path):
    """Test, what, ray tracer, limit and figure of each line. Figures share lines with the names of tests."""
    for line in open(path, encoding="utf-8"):
        found = LINE.search(line.rstrip())
        if found:
            test, what, who, guided, limit, reached = found.groups()
            yield test, what + (guided or ""), who, limit, reached


def main():
    columns = [argument.split("=", 1) for argument in sys.argv[1:]]
    if not columns or any(len(c) != 2 for c in columns):
        sys.exit(__doc__)
    names = [name for name, _ in columns] + ["obvhs", "any"]
    rows = {}
    for name, path in columns:
        for test, what, who, limit, reached in read(path):
            column = {"embree": name, "obvhs": "obvhs"}.get(who, "any")
            cells = rows.setdefault((int(test[1:]), what), (limit, {}))[1]
            if column not in cells or float(reached) > float(cells[column]):
                cells[column] = reached
    print(f"| test | what | limit | {' | '.join(names)} |\n|---|---|{'---|' * (len(names) + 1)}")
    for (test, what), (limit, cells) in sorted(rows.items()):
        figures = " | ".join(cells.get(name, "") for name in names)
        print(f"| S{test} | {what.replace('|', chr(92) + '|')} | {limit} | {figures} |")


main()
