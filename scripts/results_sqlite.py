#!/usr/bin/python3
"""Writes results.csv of a study as the table `results` of a new SQLite file.

    scripts/results_sqlite.py RESULTS.csv RESULTS.sqlite

A number is a number there, but for hashes. Metrics are REAL. `breakwater sweep --sqlite` calls it.
"""

import contextlib
import csv
import re
import sqlite3
import sys

NUMBER = re.compile(r"-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")


def value(column, cell):
    if column in ("point", "state_hash") or not NUMBER.fullmatch(cell):
        return cell or None
    return int(cell) if column == "seed" else float(cell)


with open(sys.argv[1], newline="", encoding="utf-8") as file, \
        contextlib.closing(sqlite3.connect(sys.argv[2], isolation_level=None)) as database:
    rows = csv.reader(file)
    header = next(rows)
    first = header.index("state_hash") + 1
    names = ['"' + name.replace('"', '""') + '"' + " REAL" * (i >= first) for i, name in enumerate(header)]
    # The file gets its name when it is complete, so it needs no journal.
    database.executescript("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN")
    database.execute(f"CREATE TABLE results ({', '.join(names)})")
    database.executemany(f"INSERT INTO results VALUES ({', '.join('?' * len(header))})",
                         ([value(*cell) for cell in zip(header, row)] for row in rows))
    database.execute("COMMIT")
