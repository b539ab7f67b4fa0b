"""Writes mbd/__init__.pyi, the type stubs of the package, from the package itself: signatures of Python and of pybind11, and
the table of elements. PYTHONPATH=build/release/python python3 tools/python/make_stubs.py writes it; a test compares."""

import inspect
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path = [path for path in sys.path if pathlib.Path(path or ".").resolve() != HERE]  # where the package is not built

import mbd  # noqa: E402
from mbd.scene import _CLASSES, _ELEMENTS, python_name  # noqa: E402

HEAD = '''# Written by tools/python/make_stubs.py from the package: change that, not this.
import os
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

import numpy

# What an attribute of an element may be: numbers, words, or a text as in a model file.
Value = Union[str, int, float, Sequence[Any], numpy.ndarray, None]
'''
TYPES = {"numpy.ndarray": "numpy.ndarray", "str": "str", "int": "int", "float": "float", "None": "None", "dict": "Dict[str, Any]",
         "object": "Any"}


def doc_of(text, indent):
    lines = inspect.cleandoc(text or "").replace("\\", "\\\\").replace('"""', "'''").splitlines() or [""]
    if len(lines) == 1:
        return f'{indent}"""{lines[0]}"""\n' if lines[0] else ""
    return f'{indent}"""' + f"\n{indent}".join(lines).rstrip() + f'\n{indent}"""\n'


def without_trailing(text):
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


def cpp_type(text):
    text = text.strip().replace("mbd._mbd.", "").replace("numpy.ndarray[numpy.float64]", "numpy.ndarray")
    text = re.sub(r"\b(List|Dict|Tuple|Optional)\b", r"\1", text)
    text = text.replace("handle", "Any").replace("object", "Any")
    return "Dict[str, Any]" if text == "dict" else text


def cpp_function(function, name, indent):
    """Of pybind11: the first line of the docstring is the signature."""
    first, _, rest = (function.__doc__ or "").partition("\n")
    match = re.match(r"\w+\((.*)\) -> (.*)$", first)
    arguments = []
    for argument in filter(None, re.split(r", (?=\w+:)", match[1])):
        key, _, kind = argument.partition(":")
        kind, equals, default = kind.partition(" = ")
        arguments.append("self" if key == "self" else f"{key}: {cpp_type(kind)}" + (f" = {default}" if equals else ""))
    return f"{indent}def {name}({', '.join(arguments)}) -> {cpp_type(match[2])}:\n" + doc_of(rest, indent + "    ") + \
        f"{indent}    ...\n"


def annotation(value):
    return value if isinstance(value, str) else getattr(value, "__name__", str(value))


def python_function(function, name, indent):
    parts = []
    signature = inspect.signature(function)
    star = False
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not star:
            parts.append("*")
            star = True
        if parameter.kind is parameter.VAR_POSITIONAL:
            parts.append(f"*{parameter.name}: Any")
            star = True
        elif parameter.kind is parameter.VAR_KEYWORD:
            parts.append(f"**{parameter.name}: Any")
        elif parameter.name == "self":
            parts.append("self")
        else:
            kind = "Any" if parameter.annotation is parameter.empty else annotation(parameter.annotation)
            default = "" if parameter.default is parameter.empty else f" = {parameter.default!r}"
            parts.append(f"{parameter.name}: {kind}{default}")
    returns = signature.return_annotation
    kind = "None" if name == "__init__" else "Any" if returns is signature.empty else annotation(returns)
    return f"{indent}def {name}({', '.join(parts)}) -> {kind}:\n" + doc_of(function.__doc__, indent + "    ") + \
        f"{indent}    ...\n"


def property_of(member, name, indent):
    kind = "Any"
    doc = member.__doc__ or (member.fget.__doc__ if member.fget else "")
    if member.fget is not None:
        first = (getattr(member.fget, "__doc__", "") or "").strip().partition("\n")[0]
        match = re.match(r"\(.*\) -> (.*)$", first)
        if match:
            kind = cpp_type(match[1])
            doc = member.__doc__
        else:
            returns = getattr(member.fget, "__annotations__", {}).get("return")
            kind = annotation(returns) if returns is not None else "Any"
    text = f"{indent}@property\n{indent}def {name}(self) -> {kind}:\n" + doc_of(doc, indent + "    ") + f"{indent}    ...\n"
    if member.fset is not None:
        text += f"{indent}@{name}.setter\n{indent}def {name}(self, value: Any) -> None: ...\n"
    return text


def adder(element, indent, whole):
    given = []
    for attribute in element["attributes"]:
        name = python_name(attribute["name"])
        if name.isidentifier():
            given.append(f"{name}: Value = None")
    content = ["content: Value = None, /"] if element["content"] else []
    star = ["*"] if given else []
    name = element["name"]
    return f"{indent}def {name}({', '.join(['self', *content, *star, *given])}) -> {_CLASSES[name].__name__}Element:\n" + \
        doc_of(element["page"] if whole else element["doc"], indent + "    ") + f"{indent}    ...\n"


def class_of(cls, name, documented=True):
    bases = [base.__name__ for base in cls.__bases__ if base is not object and not base.__name__.startswith("pybind11")]
    text = f"\nclass {name}" + (f"({', '.join(bases)})" if bases else "") + ":\n"
    text += doc_of(cls.__doc__, "    ") if documented else ""
    size = len(text)
    for key, member in sorted(vars(cls).items()):
        if key.startswith("_") and key not in ("__init__", "__getitem__", "__len__", "__contains__", "__iter__", "__copy__"):
            continue
        if key in _ELEMENTS and issubclass(cls, mbd.Element):
            continue
        if isinstance(member, property):
            text += property_of(member, key, "    ")
        elif inspect.isfunction(member):
            text += python_function(member, key, "    ")
        elif callable(member) and re.match(r"\w+\(self", (member.__doc__ or "")):
            text += cpp_function(member, key, "    ")
    if issubclass(cls, mbd.Element):
        for key, element in _ELEMENTS.items():
            if cls._element and cls._element in element["parents"].split():
                text += adder(element, "    ", cls is mbd.Scene or "mbd" not in element["parents"].split())
    return text if len(text) > size else text + "    ...\n"


def stubs():
    text = HEAD + "\n__version__: str\nhas_pages: bool\n"
    public = [name for name in mbd.__all__ if inspect.isclass(getattr(mbd, name))]
    for name in sorted(public, key=lambda name: (len(getattr(mbd, name).__mro__), name)):
        text += class_of(getattr(mbd, name), name)
    for name, cls in _CLASSES.items():
        if name != "mbd":
            text += class_of(cls, cls.__name__ + "Element", False)
    for name in sorted(mbd.__all__):
        if inspect.isfunction(getattr(mbd, name)):
            text += "\n" + python_function(getattr(mbd, name), name, "")
    return without_trailing(text)


if __name__ == "__main__":
    file = HERE / "mbd" / "__init__.pyi"
    if "--check" in sys.argv:
        sys.exit(0 if file.read_text(encoding="utf-8") == stubs() else 1)
    file.write_text(stubs(), encoding="utf-8")
    print(f"wrote {file}")
