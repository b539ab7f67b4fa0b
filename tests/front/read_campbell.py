"""Reads campbell.h5 in a directory as the guide says, and compares it with campbell.csv, unbalance.csv and the model.
Usage: read_campbell.py DIR MODEL. Says what differs, and ends with status 1."""
import pathlib
import re
import sys

import h5py
import numpy
import pandas

from reading import expect, finish

directory, model = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def same(a, b):
    return numpy.array_equal(numpy.asarray(a, float), numpy.asarray(b, float), equal_nan=True)


# The lines of the guide: `diagram`, `modes` and `frequencies`.
guide = (pathlib.Path(__file__).parents[2] / "models/GUIDE.md").read_text()
said = re.search(r"```python\n(diagram = h5py[^`]*)```", guide).group(1)
expect("two lines of Python in the guide", said.count("\n") == 2)
exec(said.replace("results/shaft/campbell", str(directory)))

table = pandas.read_csv(directory / "campbell.csv", comment="#", float_precision="round_trip")
rates, branches = diagram["rates"][:], sorted(set(table["mode"]))
expect("modes", list(frequencies.columns) == [table[table["mode"] == b]["name"].iloc[0] for b in branches])
expect("rates rise", (numpy.diff(rates) > 0).all())
units = {"re_eigenvalue": "1/s", "im_eigenvalue": "1/s", "inertial_frequency": "rad/s", "orbit": "1", "overlap": "1", "round_off": "1"}
for name, unit in units.items():
    expect(f"unit of {name}", modes[name].attrs["unit"] == unit)
    expect(f"shape of {name}", modes[name].shape == (len(rates), len(branches)))
    for column, branch in enumerate(branches):
        rows = table[table["mode"] == branch]
        expect(f"rates of mode {branch}", same(rows["rate"], rates))
        # The table has few digits of these.
        few = {"orbit": 1e-6, "overlap": 1e-6, "round_off": numpy.inf}.get(name)
        got = modes[name][:, column]
        if few is None:
            expect(f"{name} of mode {branch}", same(rows[name], got))
        else:
            expect(f"{name} of mode {branch}", not (numpy.abs(rows[name] - got) > few).any())
expect("frequencies", same(frequencies.values, modes["inertial_frequency"][:]))
expect("displacement", diagram["displacement"].shape == rates.shape and diagram["displacement"].attrs["unit"] == "m")
expect("axis", same(diagram["axis"][:], [1, 0, 0]) and diagram["through"].attrs["unit"] == "m")
expect("special speeds", set(diagram["special/kind"].asstr()[:]) <= {"critical", "unstable_above", "stable_above"})
expect("their places", (diagram["special/branch"][:] < len(branches)).all())
expect("of the file", diagram.attrs["format"] == "mbd campbell 1" and diagram.attrs["axes"] in ("turning", "resting"))
expect("text of the model", diagram["model/text"].asstr()[()] == model.read_text())
expect("parameters", all(isinstance(x, float) for x in diagram["parameters"].attrs.values()))

responses = directory / "unbalance.csv"
expect("unbalance", responses.exists() == ("unbalance" in diagram))
if responses.exists():
    table, group = pandas.read_csv(responses, comment="#", float_precision="round_trip"), diagram["unbalance"]
    for column, place in enumerate(group["places"].asstr()[:]):
        rows = table[table["place"] == place].set_index("rate").reindex(group["rates"][:])
        for name in ("major", "minor", "lag", "re_forward", "im_forward", "re_backward", "im_backward", "besides"):
            expect(f"{name} of {place}", same(rows[name], group[name][:, column]))

finish(len(rates), "rates,", len(branches), "modes", *diagram["special/rate"][:])
