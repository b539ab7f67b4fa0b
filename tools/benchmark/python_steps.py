#!/usr/bin/env python3
"""What Python costs in a loop over s.step(): CPU time of a step of models/four_bar.xml from Python and in C++, in turns.

Usage: PYTHONPATH=build/release/python tools/benchmark/python_steps.py [--benchmark build/release/mbd_benchmark] [--turns 7]
All 4000 steps of the model from making the stepper on, each step by a call of its own; C++ is Run/four_bar of mbd_benchmark, of the
same build. The step alone, and with what a controller does: reading a record and an element of a view of the state.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import time

import mbd

root = pathlib.Path(__file__).resolve().parents[2]
STEPS = 4000


def in_cpp(benchmark):
    """Microseconds a step."""
    out = subprocess.run([benchmark, "--benchmark_filter=^Run/four_bar$", "--benchmark_format=json"], check=True, capture_output=True,
                         text=True).stdout
    one = json.loads(out)["benchmarks"][0]
    assert one["time_unit"] == "ms" and one["steps"] == STEPS
    return 1e3 * one["cpu_time"] / STEPS


def in_python(model, reads):
    begin = time.process_time()
    s = model.stepper()
    velocities = s.velocities
    for _ in range(STEPS):
        s.step()
        if reads:
            s["C.displacement"][2]  # pylint: disable=expression-not-assigned
            velocities[1, 0]  # pylint: disable=pointless-statement
    return 1e6 * (time.process_time() - begin) / STEPS


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--benchmark", type=pathlib.Path, default=root / "build" / "release" / "mbd_benchmark")
    parser.add_argument("--turns", type=int, default=7)
    given = parser.parse_args()
    model = mbd.Model(root / "models" / "four_bar.xml")
    alone, reading = [], []
    for _ in range(given.turns):
        cpp, python, reads = in_cpp(given.benchmark), in_python(model, False), in_python(model, True)
        alone.append(python / cpp)
        reading.append(reads / cpp)
        print(f"C++ {cpp:.1f} us a step, Python {python:.1f}: {alone[-1]:.2f} times; with reading {reads:.1f}: {reading[-1]:.2f}",
              flush=True)
    print(f"medians {statistics.median(alone):.2f} and {statistics.median(reading):.2f} times; load {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    main()
