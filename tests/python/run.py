"""Runs test files by pytest; 77 where that, NumPy or the module is not there (ctest says: skipped)."""

import importlib.util
import sys

for name in ("pytest", "numpy", "mbd"):
    if importlib.util.find_spec(name) is None:
        print(f"skipped: Python has no {name}")
        sys.exit(77)

import pytest  # noqa: E402

sys.dont_write_bytecode = True
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", *sys.argv[1:]]))
