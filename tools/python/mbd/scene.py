"""Scenes built in Python. Elements, attributes, units, defaults and what is said of them come from the table that model
files, manual and grammar have (libmbd/scene: the lists of fields)."""

import keyword
import os
import sys
from xml.sax.saxutils import escape, quoteattr

from . import _mbd
from .errors import UseError
from .values import text_of

_HERE = os.path.dirname(os.path.abspath(__file__))
_ELEMENTS = {element["name"]: element for element in _mbd.elements()}
_CLASSES = {}


def _caller():
    """File and line of the first frame outside of this package."""
    frame = sys._getframe(1)
    while frame is not None and os.path.abspath(frame.f_code.co_filename).startswith(_HERE + os.sep):
        frame = frame.f_back
    return ("", 0) if frame is None else (frame.f_code.co_filename, frame.f_lineno)


def python_name(attribute):
    """Of an attribute: from and yield are words of Python, so they are from_ and yield_."""
    return attribute + "_" if keyword.iskeyword(attribute) else attribute


class Element:
    """One element of a Scene. Its methods add what may stand in it; `help(mbd.Scene.beam)` says what an element has."""

    _element = ""

    def __init__(self, scene, line, attributes, content):
        self._scene = scene
        self._line = line
        self._attributes = attributes
        self._text = content
        self._children = []

    def _tree(self):
        return (self._element, self._line, list(self._attributes), [child._tree() for child in self._children],
                self._text)

    def _xml(self, indent):
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in self._attributes)
        start = f"{indent}<{self._element}{attributes}"
        if not self._children and not self._text:
            return start + "/>\n"
        inside = "".join(child._xml(indent + "  ") for child in self._children)
        if not inside:
            return f"{start}>{escape(self._text)}</{self._element}>\n"
        return f"{start}>{escape(self._text)}\n{inside}{indent}</{self._element}>\n"

    def _add(self, name, content, given):
        file, line = _caller()
        if file != self._scene._file:
            line = 0
        element = _ELEMENTS[name]
        known = {python_name(a["name"]): a["name"] for a in element["attributes"]}
        attributes = [(known.get(key, key), text_of(value, f"{name}: {key}"))
                      for key, value in given.items() if value is not None]
        if content is not None and not element["content"]:
            raise UseError(f"{name}: has no content of its own; give attributes by name")
        child = _CLASSES[name](self._scene, line, attributes, "" if content is None else text_of(content, name))
        self._children.append(child)
        return child

    def __repr__(self):
        return f"<mbd.{type(self).__name__} {self._element}>"


class Scene(Element):
    """A model built in Python, with the names of model files: scene.beam(name="b", from_=(0, 0, 0), …). Values are
    numbers, sequences or arrays of them, or texts as in files (expressions, numbers with units). Attributes `from`
    and `yield` are written from_ and yield_. What has parts returns an Element to which they are added:

        section = scene.section(name="strip")
        section.stiffness(EA=1e6, GA2=4e5, GA3=4e5, GJ=80, EI2=100, EI3=100)

    mbd.Model(scene, set={…}) checks it: a ModelError has the Python file and line that stated the item.
    """

    _element = "mbd"

    def __init__(self, name, **attributes):
        file, line = _caller()
        self._file = file
        super().__init__(self, line, [("name", text_of(name, "name"))] +
                         [(key, text_of(value, key)) for key, value in attributes.items()], "")

    def xml(self) -> str:
        """The same as a model file, str."""
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + self._xml("")

    def run(self, set=None, **options) -> "Results":
        """mbd.Model(self, set=set).run(…)."""
        from .model import Model

        return Model(self, set=set).run(**options)


def _adder(element):
    name = element["name"]

    def add(self, content=None, /, **attributes):
        return self._add(name, content, attributes)

    add.__name__ = name
    add.__qualname__ = f"Scene.{name}"
    add.__doc__ = element["page"]
    return add


def _set_up():
    for name in _ELEMENTS:
        _CLASSES[name] = Scene if name == "mbd" else type(
            "".join(word.capitalize() for word in name.split("_")), (Element,),
            {"_element": name, "__doc__": _ELEMENTS[name]["page"], "__module__": "mbd.scene"})
    for name, element in _ELEMENTS.items():
        for parent in element["parents"].split():
            setattr(_CLASSES[parent], name, _adder(element))


_set_up()
