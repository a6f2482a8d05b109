"""Reads problems (a name and numbers) from standard input and writes the answers to standard
output."""

import sys

import numpy as np

words = iter(sys.stdin.read().split())


def integer():
    return int(next(words))


def numbers(count):
    return np.array([float(next(words)) for _ in range(count)])


def answer(*functions):
    """Answer each problem with the function of its name."""
    by_name = {function.__name__.rstrip("_"): function for function in functions}
    for name in words:
        for value in by_name[name]():
            print(repr(float(value)))
