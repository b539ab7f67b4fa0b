"""Reads what `mbd export --vtk` has made of a run, by VTK's own readers, and compares it with motion.bin and history.csv
(path.csv). Usage: read_vtk.py FILE.pvd DIR_OF_RESULTS. Prints frames, numbers compared with the history, and kinds of files;
says what differs, and ends with status 1. Errors are over the size of the scene; surfaces are of single precision."""
import csv
import json
import pathlib
import sys
import xml.etree.ElementTree

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from reading import expect, finish

collection, results = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def data(grid, name):
    array = grid.GetPointData().GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def points(grid):
    return vtk_to_numpy(grid.GetPoints().GetData()).astype(float)


class Errors(vtk.vtkObject):
    pass


def read(file):
    reader = vtk.vtkXMLUnstructuredGridReader() if file.suffix == ".vtu" else vtk.vtkXMLPolyDataReader()
    reader.AddObserver("ErrorEvent", lambda *_: expect("VTK can read " + file.name, False))
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def rotation(q):
    x, y, z, w = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def placed(poses, place):  # [node, r, q] -> position
    node, r = int(place[0]), numpy.array(place[1:4])
    return r if node == 0 and not poses[0].any() else poses[node][:3] + rotation(poses[node][3:]) @ r


with open(results / "motion.bin", "rb") as file:
    head = json.loads(file.readline())
    table = numpy.fromfile(file, "<f8")
size = head["row"]
table = table[: len(table) // size * size].reshape(-1, size)
drawing, blocks = head["drawing"], head["blocks"]
scale = drawing["size"]
parts = drawing["parts"]
with open(collection.with_suffix("") / "parts.csv") as file:
    listed = list(csv.DictReader(file))
expect("parts.csv", [(p["kind"], p["name"]) for p in listed] == [(p["kind"], p["name"]) for p in parts])

history = results / ("path.csv" if (results / "path.csv").exists() else "history.csv")
rows = list(csv.reader(line for line in open(history) if not line.startswith("#")))
columns = {name: i for i, name in enumerate(rows[0])}
# A path may pass a load factor again: by row where there are as many.
by_row = len(rows) - 1 == len(table)
row_of = {float(row[0]): row for row in rows[1:]}
reference = numpy.array(drawing["nodes"])

frames = {}
for entry in xml.etree.ElementTree.parse(collection).iter("DataSet"):
    frames.setdefault(int(entry.get("file").split("_")[-1].split(".")[0]), {})[entry.get("name")] = (
        float(entry.get("timestep")), collection.parent / entry.get("file"))
chosen = [k * (len(table) - 1) // max(len(frames) - 1, 1) for k in range(len(frames))]
expect("the first frame", frames[0]["nodes"][0] == table[0, 0])
expect("the last frame", frames[len(frames) - 1]["nodes"][0] == table[-1, 0])

compared, kinds, row = 0, set(), 0
for number in sorted(frames):
    files = frames[number]
    kinds |= set(files)
    times = {time for time, _ in files.values()}
    expect("one time a frame", len(times) == 1)
    time = times.pop()
    while row < len(table) and table[row, 0] != time:
        row += 1
    if row == len(table):
        sys.exit("no frame of motion.bin has the time %r" % time)
    numbers = table[row]
    at = 1
    block = {}
    for name in ("pose", "twist", "resultant", "joint"):
        block[name] = numbers[at : at + blocks[name]]
        at += blocks[name]
    poses = numpy.vstack([reference[0] * 0 + [0, 0, 0, 0, 0, 0, 1], block["pose"].reshape(-1, 7)])
    opened = {kind: read(file) for kind, (_, file) in files.items()}
    for kind, grid in opened.items():
        expect(kind + " has points", grid.GetNumberOfPoints() > 0)
        expect(kind + ": TimeValue", grid.GetFieldData().GetArray("TimeValue").GetValue(0) == time)
        expect(kind + ": finite points", numpy.isfinite(points(grid)).all())
        expect(kind + ": displacement is there", data(grid, "displacement").shape == points(grid).shape)

    nodes = opened["nodes"]
    expect("nodes", (points(nodes) == poses[1:, :3]).all())
    expect("nodes: displacement", (data(nodes, "displacement") == poses[1:, :3] - reference[1:, :3]).all())
    for k in range(3):
        axes = numpy.array([rotation(q)[:, k] for q in poses[1:, 3:]])
        expect("nodes: axes", abs(data(nodes, "axis_%d" % (k + 1)) - axes).max() < 1e-12)
    if blocks["twist"]:
        twists = block["twist"].reshape(-1, 6)
        V = numpy.array([rotation(q) @ v for q, v in zip(poses[1:, 3:], twists[:, :3])])
        omega = numpy.array([rotation(q) @ v for q, v in zip(poses[1:, 3:], twists[:, 3:])])
        expect("nodes: velocity", abs(data(nodes, "velocity") - V).max() <= 1e-13 * (1 + abs(V).max()))
        expect("nodes: angular velocity",
               abs(data(nodes, "angular_velocity") - omega).max() <= 1e-13 * (1 + abs(omega).max()))

    if "lines" in opened:
        lines = opened["lines"]
        part_of = vtk_to_numpy(lines.GetCellData().GetArray("part"))
        element = vtk_to_numpy(lines.GetCellData().GetArray("element"))
        resultants = {}
        first = 0
        for i, part in enumerate(parts):
            if part["kind"] == "beam" and "stations" in part:
                count = len(part["stations"])
                resultants[i] = block["resultant"].reshape(-1, 6)[first : first + count]
                first += count
        for c in range(lines.GetNumberOfCells()):
            part = parts[part_of[c]]
            cell = lines.GetCell(c)
            if "stations" not in part:
                expect("rigid lines", cell.GetCellType() == vtk.VTK_POLY_LINE)
                true = [placed(poses, p) for p in part["points"]]
                got = [cell.GetPoints().GetPoint(i) for i in range(cell.GetNumberOfPoints())]
                expect("rigid lines", abs(numpy.array(true) - numpy.array(got)).max() <= 1e-12 * scale)
                continue
            order = part["order"]
            expect("Lagrange curves", cell.GetCellType() == vtk.VTK_LAGRANGE_CURVE)
            expect("their order", cell.GetNumberOfPoints() == order + 1)
            s = part["s"][element[c] * order : element[c] * order + order + 1]
            for k in range(order + 1):  # VTK's own interpolation passes through the nodes
                x, weights = [0.0] * 3, [0.0] * (order + 1)
                xi = (s[k] - s[0]) / (s[-1] - s[0])
                cell.EvaluateLocation(vtk.reference(0), [xi, 0.0, 0.0], x, weights)
                true = placed(poses, part["points"][element[c] * order + k])
                expect("lines pass through nodes", abs(numpy.array(x) - true).max() <= 1e-11 * scale)
            # and its interpolation of forces through those at the quadrature points.
            rule = len(part["stations"]) // ((len(part["s"]) - 1) // order)
            S = resultants[part_of[c]][element[c] * rule : (element[c] + 1) * rule]
            ids = [cell.GetPointId(i) for i in range(order + 1)]
            if rule <= order + 1:
                for q in range(rule):
                    x, weights = [0.0] * 3, [0.0] * (order + 1)
                    xi = (part["stations"][element[c] * rule + q] - s[0]) / (s[-1] - s[0])
                    cell.EvaluateLocation(vtk.reference(0), [xi, 0.0, 0.0], x, weights)
                    for name, of in (("force", S[q][:3]), ("moment", S[q][3:])):
                        got = numpy.array(weights) @ data(lines, name)[ids]
                        expect("lines: " + name, abs(got - of).max() <= 1e-9 * (abs(S).max() + 1e-300))
    if "stations" in opened:
        S = block["resultant"].reshape(-1, 6)
        expect("stations: force", (data(opened["stations"], "force") == S[:, :3]).all())
        expect("stations: moment", (data(opened["stations"], "moment") == S[:, 3:]).all())
    if "outlines" in opened:
        outlines = opened["outlines"]
        expect("outlines have surfaces", outlines.GetNumberOfPolys() > 0)
        of, where, s = data(outlines, "part"), points(outlines), data(outlines, "s")
        for i in numpy.unique(of):
            part = parts[i]
            shape = drawing["outlines"][part["outline"]] if "outline" in part else None
            for k, place in enumerate(part["points"]):
                corners = len(shape["next"]) if shape else len(where[of == i]) // len(part["points"])
                ring = where[of == i][k * corners : (k + 1) * corners]
                true = placed(poses, place)
                far = max(scale, abs(true).max())
                middle = ring.mean(axis=0)
                if shape:
                    sides = part["sides"][min(k, len(part["sides"]) - 1)]
                    rim = numpy.array(shape["rim"]).reshape(-1, 2) * 0.5 * numpy.array(sides[:2])
                    reach = numpy.linalg.norm(rim, axis=1)
                    expect("outlines reach as far", abs(numpy.linalg.norm(ring - true, axis=1) - reach).max() <= 1e-6 * far)
                    continue
                expect("outlines are about nodes", abs(middle - true).max() <= 1e-6 * far)
    if "bodies" in opened:
        expect("bodies have surfaces", opened["bodies"].GetNumberOfPolys() > 0)
    if "joints" in opened:
        joints = opened["joints"]
        names = [parts[i]["name"] for i in data(joints, "part")]
        for k, name in enumerate(names):
            if name not in drawing["joints"]:
                continue
            said = block["joint"].reshape(-1, 7)[drawing["joints"].index(name)]
            expect("joints: angle", data(joints, "angle")[k] == said[0])
            axes = numpy.array([data(joints, "axis_%d" % (i + 1))[k] for i in range(3)])
            size_of = abs(said[1:]).max() + 1e-300
            expect("joints: force", abs(axes @ data(joints, "force")[k] - said[1:4]).max() <= 1e-12 * size_of)
            expect("joints: moment", abs(axes @ data(joints, "moment")[k] - said[4:]).max() <= 1e-12 * size_of)
    # the history
    csv_row = rows[1 + row] if by_row else row_of.get(time)
    if "places" in opened and csv_row is not None:
        places = opened["places"]
        for k, i in enumerate(data(places, "part")):
            for quantity, of in (("position", points(places)), ("displacement", data(places, "displacement"))):
                for c in range(3):
                    name = "%s.%s.%d" % (parts[i]["name"], quantity, c + 1)
                    if name in columns:
                        value = float(csv_row[columns[name]])
                        far = max(scale, abs(value), abs(points(places)[k]).max())
                        expect(name, abs(of[k][c] - value) <= 1e-12 * far)
                        compared += 1
    row += 1

finish(len(frames), "frames,", compared, "numbers of the history;", *sorted(kinds))
