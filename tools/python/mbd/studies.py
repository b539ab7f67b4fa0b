"""What accuracy costs, what effects are worth, modes, Campbell diagrams: as data."""

import json
import os

from . import _mbd
from .errors import Interrupted
from .model import Model
from .values import names_of, optional_text, text_of, whole


def _model_of(model, set):
    if isinstance(model, Model):
        if set:
            raise TypeError("set: give it to the Model, or give the file in place of the Model")
        return model._model
    return Model(model, set=set)._model


def _study(text, raised):
    study = None if text is None else json.loads(text)
    if raised is not None:
        raise Interrupted(study) if isinstance(raised, KeyboardInterrupt) else raised
    return study


def _vary(vary):
    if vary is None:
        return []
    if isinstance(vary, dict):
        return [f"{knob}={values if isinstance(values, str) else ','.join(text_of(v) for v in names_or(values))}"
                for knob, values in vary.items()]
    return names_of(vary)


def names_or(values):
    return values if isinstance(values, (list, tuple, range)) else [values]


def accuracy(model, *, set=None, quantities=(), vary=None, reference=None, budget=120.0, refinements=None) -> "Dict[str, Any]":
    """Error against CPU time of many settings, and the cheapest for each accuracy: dict, as `mbd accuracy` writes
    accuracy.json.

    model: file, Scene or Model; set: values of parameters
    quantities: whose error, names of columns, quantities or records; none: what the model expects, plots or records
    vary: {"order": [2, 3], "tolerance": "1e-2:1e-8"}: values of knobs; none: those that suit the model
    reference: CSV file in place of a reference made here
    budget: seconds for it all; refinements: of the reference, at most

    Raises ModelError, UseError, and Interrupted with the study so far.
    """
    return _study(*_mbd.accuracy(_model_of(model, set), names_of(quantities), _vary(vary),
                                 None if reference is None else os.fspath(reference), float(budget), refinements))


def effects(model, *, set=None, quantities=(), tolerance=0.01, budget=120.0) -> "Dict[str, Any]":
    """What each effect of a model costs and is worth, and the cheapest model within a tolerance: dict, as `mbd effects`
    writes effects.json.

    tolerance: rms change of each quantity over its largest value; budget: CPU seconds

    Raises ModelError, UseError, and Interrupted with the study so far.
    """
    return _study(*_mbd.effects(_model_of(model, set), names_of(quantities), float(tolerance), float(budget)))


def modes(model, *, set=None, count=None, near=None, rate=None, at=None, axis=None, through=None, at_rest=(),
          without=(), mac=False, compare=None) -> "Dict[str, Any]":
    """Small motions about equilibrium, about steady rotation of the whole at a rate, or about the state of a run.

    What is not given is as <modes> of the model says, or without one:
    count: how many (10); near: those nearest to this frequency [Hz] (0)
    rate: of the rotation [rad/s] about the axis (1, 0, 0) through a point (0, 0, 0) [m]; at_rest: bodies and beams that do
    not turn; at: time of a run [s]
    without: effects to leave out, as `mbd effects` names them
    mac: how alike they are among themselves; compare: or to other modes, of a Model, a model file, or a modes.json

    Returns a dict. With n modes and k nodes (the ground left out):
      eigenvalues l (n,) complex [1/s]; frequencies (n,) [Hz], |l|/2 pi, undamped (with damping it swings at Im l/2 pi);
      damping_ratios (n,); names, list of n
      shapes (n, k, 6) complex: displacements [m] and rotations [rad], inertial axes; positions (k, 3) [m]; nodes, names
      parts: list of n dicts, shares of kinetic energy; orbits, inertial_frequencies (n,) [Hz]: nan without whirl
      residuals (n,); conditions (n,), of the eigenvalues: |dl|/|l| is at most half of it times a change of the forces
      over |l|^2 times the mass; axes: "turning", "resting" or None; notes
      mac, None or a dict: mac (n, others), weighted by mass, nan where a shape moves none: 1 the same shape, 0 nothing in
      common; groups, other_groups: lists of modes of one eigenvalue, of whose shapes any mixture is one too;
      mac_of_groups: of their spans; pairs, list of dicts with modes, others, alike (by half or more);
      other_names, other_frequencies [Hz]; notes
    Raises ModelError and UseError.
    """
    return _mbd.modes(_model_of(model, set), None if count is None else whole(count, "count"), optional_text(near, "near"),
                      optional_text(rate, "rate"), optional_text(at, "at"), _three(axis, "axis"),
                      _three(through, "through"), names_of(at_rest), names_of(without), bool(mac), _compared(compare))


def linearize(model, *, set=None, at=None, rate=None, axis=None, through=None, at_rest=(),
              without=()) -> "Dict[str, Any]":
    """Equations of motion as matrices, from the model's inputs to all that it records: E x' = A x + B u, y = C x + D u,
    about equilibrium, or steady rotation of the whole at a rate (as of modes()), or the state of a run.

    at: time of a run [s]: then there are the matrices of all motions only
    rate, axis, through, at_rest, without as of modes()

    Returns a dict. With n states, i inputs, o outputs:
      E, A (n, n), B (n, i), C (o, n), D (o, i); states, inputs, outputs: lists of (name, unit); y (o,): outputs there
      N (k, n/2): motions of all nodes, six each, by states
      motion: M u'' + C u' + K u + G^T l = F w, G u = 0 of all nodes: M, C, K, G as ((values, (rows, columns)), shape), which
      is what scipy.sparse.coo_array takes: coo_array(*motion["K"]); F (k, i)
      notes
    Raises ModelError and UseError.
    """
    return _mbd.linearize(_model_of(model, set), optional_text(at, "at"), optional_text(rate, "rate"), _three(axis, "axis"),
                          _three(through, "through"), names_of(at_rest), names_of(without))


def campbell(model, rates, *, set=None, points=61, count=8, axis=None, through=None, at_rest=(),
             without=(), unbalance=None, forces=None, order=1, probes=()) -> "Dict[str, Any]":
    """Modes followed over the rate of a steady rotation, and responses at the same rates.

    rates: (first, last) [rad/s], or texts with units ("0 rpm", "600 rpm"); points: how many at least
    count: modes; axis, through, at_rest, without as of modes()
    unbalance: {place: mass times distance from the axis [kg.m]} of what turns
    forces: {place: amplitude, or (along e2, along e3) [N]}, of fixed direction, as cos(order W t)
    probes: where the responses to both are wanted besides

    Returns a dict: rates (r,) [rad/s]; displacements (r,) [m] of the steady rotation; branches, list of dicts with
    name, rates, eigenvalues (complex [1/s], in `axes`), inertial_frequencies ([rad/s], nan where orbits are not round),
    overlaps; unbalance_responses, force_responses, lists of dicts with place, rates, and amplitudes [m] of
    y + i z = forward exp(i w t) + backward exp(-i w t) (complex), besides (at other frequencies, of unround shafts);
    special, list of dicts with kind ("critical", "unstable_above", "stable_above"), rate [rad/s], branch;
    axes; notes. Raises ModelError, UseError, and Interrupted with the diagram so far.
    """
    first, last = rates
    study, raised = _mbd.campbell(_model_of(model, set), text_of(first), text_of(last), whole(points, "points"), whole(count, "count"),
                                  _three(axis, "axis"), _three(through, "through"), names_of(at_rest),
                                  names_of(without), _driven(unbalance, forces, order, probes))
    if raised is not None:
        raise Interrupted(study) if isinstance(raised, KeyboardInterrupt) else raised
    return study


def rotations(model, rates, *, set=None, axis=None, through=None, at_rest=(), without=(), probes=(), search=9,
              points=500, far=1.0, count=8) -> "Dict[str, Any]":
    """Steady rotations over their rate, through folds, and others at the same rates.

    rates: (first, last) [rad/s], or texts with units; axis, through, at_rest, without as of modes()
    probes: places whose displacement is wanted
    search: at how many rates others are sought; far: how far from one they are (mean motion of the nodes, of the
    scene's size and in rad); points: of a path at most, in each sense; count: modes that must not grow

    Returns a dict: paths, list of dicts with rates (n,) [rad/s], displacements (n,) [m] of the node that moves most,
    probes (n, places, 3) [m], growth (n,) [1/s] (nan where it is not known), unstable (n,) how many modes grow (-1: not
    known), folds (indices of points), ends; searched: rates at which others were sought; notes.
    Raises ModelError, UseError, and Interrupted with the paths so far.
    """
    first, last = rates
    study, raised = _mbd.rotations(_model_of(model, set), text_of(first), text_of(last), _three(axis, "axis"),
                                   _three(through, "through"), names_of(at_rest), names_of(without), names_of(probes),
                                   (whole(search, "search"), whole(points, "points"), float(far), whole(count, "count")))
    if raised is not None:
        raise Interrupted(study) if isinstance(raised, KeyboardInterrupt) else raised
    return study


def _driven(unbalance, forces, order, probes):
    from .errors import UseError

    along = {}
    for place, force in dict(forces or {}).items():
        both = (force, 0) if isinstance(force, (int, float, str)) else tuple(force)
        if len(both) != 2:
            raise UseError(f"forces: {place!r} has {len(both)} numbers, must have 1 or 2")
        along[str(place)] = [text_of(value) for value in both]
    moments = {str(place): text_of(value) for place, value in dict(unbalance or {}).items()}
    if not 0 < float(order) < float("inf"):
        raise UseError(f"order: {order} is not positive")
    return moments, along, float(order), names_of(probes)


def _compared(other):
    if other is None or isinstance(other, Model):
        return other and other._model
    return os.fspath(other) if isinstance(other, (str, os.PathLike)) else _model_of(other, None)


def _three(values, name):
    from .errors import UseError

    if values is None:
        return None
    numbers = [float(value) for value in values]
    if len(numbers) != 3:
        raise UseError(f"{name} has {len(numbers)} numbers, must have 3")
    return numbers
