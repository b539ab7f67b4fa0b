"""Reads run.h5 in a directory of results as the manual says, and compares it with history.csv (path.csv), motion.bin,
report.json and the model. Usage: read_run.py DIR [MODEL]; with a run that goes on, or was killed: read_run.py --killed DIR.
Prints rows and frames; says what differs, and ends with status 1."""
import io
import json
import pathlib
import re
import sys

import h5py
import numpy
import pandas

from reading import expect, finish

killed = sys.argv[1] == "--killed"
directory = pathlib.Path(sys.argv[2 if killed else 1])

# The lines that the manual and the guide have for it: `run`, `n` and `history`.
repository = pathlib.Path(__file__).parents[2]
said = [re.search(r"```python\n(run = h5py[^`]*)```", (repository / page).read_text()).group(1).replace(where, str(directory))
        for page, where in (("models/MANUAL.md", "results/tip_deflection"), ("models/GUIDE.md", "results/four_bar"))]
expect("two lines of Python, the same in the manual and the guide", said[0] == said[1] and said[0].count("\n") == 2)
exec(said[0])

name = "path.csv" if (directory / "path.csv").exists() else "history.csv"
text = (directory / name).read_text()
text = text[: text.rfind("\n") + 1]  # a kill may leave a part of a row
csv = pandas.read_csv(io.StringIO(text), comment="#", float_precision="round_trip")
lines = text.splitlines()
units = next(line for line in lines if line.startswith("# units: "))[9:].split(", ")
expect("columns", list(history.columns) == list(csv.columns))
if killed:  # two files, each behind the run by its own half second
    rows = min(len(csv), len(history))
    csv, history = csv[:rows], history[:rows]
different = numpy.argwhere(history.to_numpy() != csv.to_numpy(dtype=float))
expect("history from row, column %s on, of %d" % (different[:1].tolist(), len(csv)), len(different) == 0)
expect("units", [run["history"][c].attrs["unit"] for c in csv.columns] == units)
for column in csv.columns[1:]:
    if not killed and "." in column:
        attributes = run["history"][column].attrs
        expect(column + " has a label", attributes["label"].startswith(column.split(".")[1]))
        is_vector = column[-1] in "123" and column[-2] == "."
        expect(column + " has its frame", ("frame" in attributes) == is_vector)

frames = 0
if "motion" in run:
    motion = run["motion"]
    with open(directory / "motion.bin", "rb") as file:
        head = json.loads(file.readline())
        table = numpy.fromfile(file, "<f8")
    size = head["row"]
    table = table[: len(table) // size * size].reshape(-1, size)
    time = motion[head["drawing"]["key"]]
    frames = min(len(d) for d in motion.values() if d.maxshape[0] is None)
    expect("frames", killed or frames == len(time) == len(table))
    if killed:
        frames = min(frames, len(table))
        table = table[:frames]
    blocks = {}
    at = 0
    for block, width in head["blocks"].items():
        blocks[block] = table[:, at : at + width]
        at += width

    def same(path, of, stride, first, last):
        block = blocks[of]
        if block.shape[1] == 0:
            expect(path + " is left out", path not in motion)
            return
        items = block.reshape(len(block), block.shape[1] // stride, stride)[:, :, first:last]
        if last - first == 1:
            items = items[:, :, 0]
        expect("motion/" + path, motion[path].shape[1:] == items.shape[1:])
        expect("motion/" + path, motion[path][:frames].tobytes() == items.tobytes())
        expect(path + " has a unit", len(motion[path].attrs["unit"]) > 0)

    expect("motion/time", time[:frames].tobytes() == blocks["key"].tobytes())
    same("position", "pose", 7, 0, 3)
    same("quaternion", "pose", 7, 3, 7)
    same("velocity", "twist", 6, 0, 3)
    same("angular_velocity", "twist", 6, 3, 6)
    same("force", "resultant", 6, 0, 3)
    same("moment", "resultant", 6, 3, 6)
    same("joint_angle", "joint", 7, 0, 1)
    same("joint_force", "joint", 7, 1, 4)
    same("joint_moment", "joint", 7, 4, 7)
    if "joints" in motion:
        expect("joints", list(motion["joints"].asstr()[:]) == head["drawing"]["joints"])
    if "points" in motion:
        beams = [p for p in head["drawing"]["parts"] if p["kind"] == "beam" and "stations" in p]
        expect("points", list(motion["points"].asstr()[:]) == [p["name"] for p in beams for _ in p["stations"]])
        expect("points_s", list(motion["points_s"][:]) == [s for p in beams for s in p["stations"]])
    expect("drawing", json.loads(run["drawing"].asstr()[()]) == head["drawing"])

report = run["report"][:].tobytes()
if killed:
    expect("a report there cannot be", report == b"")
else:
    expect("report", report == (directory / "report.json").read_bytes())
    said = json.loads(report)
    expect("run", run.attrs["run"] == said["run"])
    expect("parameters", dict(run["parameters"].attrs) == {k: float(v) for k, v in said["settings"]["parameters"].items()})
    expect("version", run.attrs["mbd"] in json.dumps(said) and len(run.attrs["commit"]) > 6)
if len(sys.argv) > 2 and not killed:
    expect("model", run["model/text"][()] == pathlib.Path(sys.argv[2]).read_bytes())

finish(n, "rows,", frames, "frames")
