#!/usr/bin/env python3
"""What a second process saves in a sweep: 200 runs of models/shaft.xml over its rotation rate, with --jobs 1 and --jobs N in turns.

Usage: tools/benchmark/parallel_sweep.py [--program build/release/mbd] [--jobs 2] [--turns 5]
Wall-clock, so on a machine with nothing else to do: the load average is printed before and after.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import tempfile
import time

root = pathlib.Path(__file__).resolve().parents[2]
# Steps of 0.4 ms: runs above 0.1 s, well above what it takes to begin one.
SWEEP = ["--vary", "omega=44.1:64:0.1", "--set", "step=4e-4", "--quantity", "M.displacement@largest", "--quiet"]
RUNS = 200


def sweep(program, jobs):
    out = pathlib.Path(tempfile.mkdtemp(prefix="mbd_sweep_"))  # rows that are kept are not run again
    try:
        begin = time.monotonic()
        subprocess.run([program, "sweep", root / "models" / "shaft.xml", *SWEEP, "--jobs", str(jobs), "--out", out], check=True)
        seconds = time.monotonic() - begin
        rows = sum(line[:1].isdigit() for line in (out / "sweep.csv").read_text().splitlines())
        assert rows == RUNS, f"{rows} rows"
        return seconds
    finally:
        shutil.rmtree(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=root / "build" / "release" / "mbd")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--turns", type=int, default=5)
    given = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.2f} on {len(os.sched_getaffinity(0))} processors")
    ratios = []
    for _ in range(given.turns):
        one, many = sweep(given.program, 1), sweep(given.program, given.jobs)
        ratios.append(one / many)
        print(f"{RUNS} runs: {one:.2f} s by 1, {many:.2f} s by {given.jobs}: {one / many:.2f} times", flush=True)
    print(f"median {statistics.median(ratios):.2f} times; load {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    main()
