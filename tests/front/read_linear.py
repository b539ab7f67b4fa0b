"""Reads linear.h5 in a directory and compares it with linear.json, the Matrix Market files and the model.
Usage: read_linear.py DIR MODEL. Says what differs, and ends with status 1."""
import json
import pathlib
import sys

import h5py
import numpy

from reading import expect, finish

directory, model = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def market(name):
    """A dense matrix from a file of Matrix Market."""
    lines = (directory / name).read_text().splitlines()
    rows, columns, count = (int(word) for word in lines[1].split())
    matrix = numpy.zeros((rows, columns))
    for line in lines[2:]:
        row, column, value = line.split()
        matrix[int(row) - 1, int(column) - 1] = float(value)
    expect(f"entries of {name}", len(lines) - 2 == count)
    return matrix


file, said = h5py.File(directory / "linear.h5"), json.loads((directory / "linear.json").read_text())
expect("of the file", file.attrs["format"] == "mbd linear 1")
expect("text of the model", file["model/text"].asstr()[()] == model.read_text())
for ports in ("inputs", "outputs", "states"):
    wanted = said.get(ports, [])
    expect(f"{ports} are there", (ports in file) == bool(wanted))
    for key, column in (("name", "names"), ("unit", "units")):
        if wanted:
            expect(f"{column} of {ports}", list(file[ports][column].asstr()[:]) == [port[key] for port in wanted])
for name in "EABCD":
    wanted = numpy.array(said.get(name, []), float)
    expect(f"{name} is there", (name in file) == bool(wanted.size))
    if wanted.size:
        expect(f"{name} differs", numpy.array_equal(file[name][:], wanted))
for name in "MCKGF":
    group, wanted = file["all_nodes"][name], market(f"{name}.mtx")
    matrix = numpy.zeros((int(group.attrs["rows"]), int(group.attrs["columns"])))
    if "value" in group:
        matrix[group["row"][:].astype(int), group["column"][:].astype(int)] = group["value"][:]
    expect(f"{name} of all nodes", matrix.shape == wanted.shape and numpy.array_equal(matrix, wanted))
for name in ("rate", "time"):
    expect(f"{name} is there", (name in file) == (name in said))
    if name in said:
        expect(f"{name} differs", file[name][0] == said[name]["value"])

finish(len(said.get("states", [])), "states,", file["all_nodes/K"].attrs["rows"], "motions")
