"""Exceptions of mbd. All but Interrupted (a KeyboardInterrupt, as any Ctrl-C) are mbd.Error; wrong types of
arguments raise TypeError, as everywhere in Python."""


class Error(Exception):
    """What mbd raises. str() is the message: what is wrong, where, and what to do about it."""

    def __str__(self):
        return str(self.args[0]) if self.args else ""


class ModelError(Error):
    """A model, a setting of it or a directory that cannot be used, or a run that does not come to its first state.

    file: str, where the model says so, or None if the message names no place
    line: int, its line, or None
    """

    def __init__(self, message, file=None, line=None):
        super().__init__(message)
        self.file = file
        self.line = line


class RunError(Error):
    """A run or a step in time that ended before its end, or a sweep whose tasks did.

    t: float, the time reached [s] (without a transient 0)
    results: mbd.Results up to there, of a sweep on Slurm the mbd.Sweep; None of a step
    """

    def __init__(self, message, t=0.0, results=None):
        super().__init__(message)
        self.t = t
        self.results = results


class UseError(Error, ValueError):
    """A call that makes no sense: a wrong shape, a number that is not finite, a state of another model."""


class UnknownName(Error, KeyError):
    """A node, joint, column or record that is not there; the message says which are."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run or a study.

    results: mbd.Results up to there, or the study as far as it came; None if there is nothing yet
    """

    def __init__(self, results=None):
        super().__init__("interrupted" + ("" if results is None else "; .results has what was done"))
        self.results = results
