"""Values of Python as the text that models have."""

import math
import numbers

from .errors import UseError


def text_of(value, name="value"):
    """A number, a word, or several of them, as an attribute has it; UseError for what is not finite or not of these."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        number = float(value)
        if not math.isfinite(number):
            raise UseError(f"{name} is {number}; give a finite number")
        return repr(number)
    if hasattr(value, "tolist"):  # numpy, of any shape, row by row
        flat = value.ravel().tolist() if getattr(value, "ndim", 0) else [value.tolist()]
        return " ".join(text_of(part, name) for part in flat)
    if isinstance(value, (list, tuple)):
        return " ".join(text_of(part, name) for part in value)
    raise TypeError(f"{name}: {type(value).__name__} is neither a number nor a text, nor several of them")


def whole(value, name):
    """A whole number as an int: of Python, of numpy, or a float without fraction; UseError for any other number."""
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return int(value)
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        if float(value).is_integer():
            return int(value)
        raise UseError(f"{name} is {value}; give a whole number")
    raise TypeError(f"{name}: {type(value).__name__} is no whole number")


def optional_text(value, name):
    return "" if value is None else text_of(value, name)


def overrides_of(set):
    """{"rpm": "30 rpm", "N": 3} as pairs of texts."""
    if set is None:
        return []
    return [(str(name), text_of(value, f"set[{str(name)!r}]")) for name, value in dict(set).items()]


def names_of(value):
    """A name, or several: a list."""
    if value is None:
        return []
    return [value] if isinstance(value, str) else [str(one) for one in value]
