"""Stepping from Python: the same bits as a run, views that are no copies, lookups by name, states."""

import copy
import threading

import numpy
import pytest

import mbd
from conftest import PENDULUM, same_bits

# Those with fixed steps, a row each.
FIXED = [("pendulum", {}), ("heavy_top", {}), ("damped_oscillator", {}), ("chain", {"N": 3}), ("rigid_frame", {}),
         ("four_bar", {}), ("shaft", {"step": 1e-2})]


@pytest.mark.parametrize("name, set", FIXED)
def test_same_bits_as_a_run(name, set, models):
    m = mbd.Model(models / f"{name}.xml", set=set)
    try:
        r = m.run(output="steps", estimate_error=False)
    except mbd.RunError as error:
        r = error.results
    rows = min(len(r), 300)
    s = m.stepper()
    columns = r.columns
    for row in range(rows):
        if row > 0:
            s.step()
        assert s.t == pytest.approx(r.time[row], abs=1e-12)
        record = s.record()
        assert same_bits([record[c] for c in columns[1:]], r.values[row, 1:]), (name, row)
    assert s.counters["steps"] == rows - 1


def test_adaptive_steps_end_at_the_duration(pendulum):
    s = pendulum.stepper(method="radau", tolerance=1e-8, duration=0.2)
    times = []
    while s.t < 0.2:
        s.step()
        times.append(s.t)
    assert times[-1] == 0.2 and len(times) > 3 and s.method == "radau"
    r = pendulum.run(method="radau", tolerance=1e-12)
    row = numpy.argmin(abs(r.time - 0.2))
    assert numpy.abs(s["tip.displacement"] - r["tip.displacement"][row]).max() < 1e-6
    with pytest.raises(mbd.RunError, match="the end is reached"):
        s.step()


@pytest.mark.parametrize("given", [{}, {"method": "radau", "tolerance": 1e-6}, {"method": "ida", "tolerance": 1e-6},
                                   {"method": "radau", "step": 1e-3}])
@pytest.mark.parametrize("name", ["double_pendulum", "slider_crank"])
def test_views_are_no_copies(name, given, models):
    s = mbd.Model(models / f"{name}.xml").stepper(**given)
    views = [s.positions, s.quaternions, s.velocities, s.accelerations]
    address = [view.__array_interface__["data"][0] for view in views]
    before = [view.copy() for view in views]
    n = len(s.nodes)
    assert [view.shape for view in views] == [(n, 3), (n, 4), (n, 6), (n, 6)]
    for _ in range(20):
        s.step()
    again = [s.positions, s.quaternions, s.velocities, s.accelerations]
    assert address == [view.__array_interface__["data"][0] for view in again]
    for view, fresh, old in zip(views, again, before):
        assert same_bits(view, fresh)  # the old view shows the new state
        assert not same_bits(view, old)
        with pytest.raises(ValueError):
            view[0, 0] = 1.0
    positions = s.positions
    del s, again
    assert numpy.isfinite(positions).all()  # and keeps it alive


def test_names(pendulum, models):
    s = pendulum.stepper()
    s.step(100)
    arm = s.node("arm")
    assert s.nodes[arm].find("arm") >= 0 and s.joints == ["hinge"]
    assert same_bits(s.position("arm"), s.positions[arm])
    assert numpy.abs(s.position("arm") - [1, 0, 0] - s["tip.displacement"]).max() < 1e-15
    assert numpy.abs(s.velocity("arm") - s["tip.velocity"]).max() < 1e-14
    assert s.angle("hinge") == s["hinge.angle"] and s["hinge.angle"].shape == ()
    assert numpy.abs(s.reaction("hinge")[:3] - s["hinge.reaction_force"]).max() < 1e-12
    R = s.orientation("arm")
    x, y, z, w = s.quaternions[arm]
    assert R[2, 0] == pytest.approx(2 * (x * z - w * y), abs=1e-15)
    assert numpy.abs(R @ R.T - numpy.eye(3)).max() < 1e-14
    # A pendulum in the plane turns about its axis: angular velocity from its speed.
    assert abs(s.angular_velocity("arm")[1]) == pytest.approx(numpy.linalg.norm(s.velocity("arm")), rel=1e-12)
    energies = s.energies
    assert energies["total"] == pytest.approx(energies["kinetic"] + energies["strain"] + energies["potential"])

    b = mbd.Model(models / "four_bar.xml").stepper()
    b.step(10)
    start = b.position("bar2.end") - b["C.displacement"]  # where it was drawn
    assert numpy.abs(start - mbd.Model(models / "four_bar.xml").stepper().position("bar2.end")).max() < 1e-12
    assert numpy.abs(b.velocity("bar2.end") - b["C.velocity"]).max() < 1e-13
    for name in ("bar2.start", "bar2.end", "ground"):
        assert 0 <= b.node(name) < len(b.nodes)
    # A place beside its node: on a rigid frame that turns about the origin and the y axis, with the rate of its hinge.
    f = mbd.Model(models / "rigid_frame.xml").stepper()
    f.step(30)
    position, velocity, rate = f.position("stem.end"), f.velocity("stem.end"), f["A.rate"]
    assert numpy.linalg.norm(f.positions[f.node("stem.end")] - position) == pytest.approx(0.6) and abs(rate) > 0.1
    assert numpy.linalg.norm(position) == pytest.approx(0.6, abs=1e-12)
    assert numpy.abs(velocity - rate * numpy.cross([0, 1, 0], position)).max() < 1e-10
    assert numpy.abs(f.angular_velocity("stem.end") - [0, rate, 0]).max() < 1e-10
    for call in (b.node, b.position, b.angle, b.reaction, b.__getitem__):
        with pytest.raises(mbd.UnknownName, match="nothing"):
            call("nothing")


def test_states(pendulum):
    s = pendulum.stepper()
    s.step(100)
    state = s.state()
    assert state.t == s.t and not numpy.shares_memory(state.positions, s.positions)
    s.step(50)
    later = s["tip.displacement"].copy()
    # From the copy again: the same motion to the method's error, not to the bit, as its history is not kept.
    t = pendulum.stepper()
    t.start(state)
    assert t.t == state.t
    t.step(50)
    assert numpy.abs(t["tip.displacement"] - later).max() < 1e-5
    # A state that is changed: at the bottom, thrown at w about the hinge, so v = w L.
    state = pendulum.stepper().state()
    w = 3.0
    state.velocities = numpy.array([[0, 0, 0, 0, 0, 0], [0, 0, -w, 0, w, 0]])
    t.start(state)
    assert t.t == 0.0 and numpy.abs(t.velocity("arm") - [0, 0, -w]).max() < 1e-14
    again = copy.deepcopy(state)
    again.velocities[1, 4] = 0.0
    assert state.velocities[1, 4] == w


def test_checkpoints_know_the_linear_solver():
    step = 'step="'
    assert step in PENDULUM
    block = mbd.Model(text=PENDULUM, file="rod.xml").stepper()
    block.step(5)
    klu = mbd.Model(text=PENDULUM.replace(step, 'linear_solver="klu" ' + step), file="rod.xml").stepper()
    with pytest.raises(mbd.UseError, match="block LU, and this is .*KLU"):
        klu.restore(block.save())


def test_wrong_states(pendulum, models):
    s = pendulum.stepper()
    other = mbd.Model(text=PENDULUM, file="rod.xml").stepper().state()
    with pytest.raises(mbd.UseError, match="another model"):
        s.start(other)
    for change, message in [(lambda x: x.velocities.__setitem__((1, 0), numpy.nan), "not finite"),
                            (lambda x: x.positions.__setitem__((1, 2), numpy.inf), "not finite"),
                            (lambda x: x.quaternions.__setitem__((1, 3), 2.0), "has length 2"),
                            (lambda x: x.positions.__setitem__((1, 2), 0.5), "constraints"),
                            (lambda x: x.velocities.__setitem__((1, 0), 5.0), "constraints"),
                            (lambda x: x.positions.__setitem__((0, 0), 5.0), "ground"),
                            (lambda x: setattr(x, "t", 7.0), "from 0 to 0.5"),
                            (lambda x: setattr(x, "t", numpy.nan), "not finite"),
                            (lambda x: setattr(x, "velocities", numpy.zeros((2, 5))), "shape"),
                            (lambda x: setattr(x, "velocities", numpy.zeros(12)), "shape"),
                            (lambda x: setattr(x, "positions", "abc"), "numbers")]:
        state = s.state()
        with pytest.raises(mbd.UseError, match=message):
            change(state)
            s.start(state)
    s.step()  # and the stepper is as it was
    assert s.t == pytest.approx(1e-3)


def test_two_threads_do_not_share_a_stepper(models):
    s = mbd.Model(models / "four_bar.xml").stepper()
    told = []

    def step():
        try:
            for _ in range(30):
                s.step(5)
        except mbd.UseError as error:
            told.append(str(error))

    threads = [threading.Thread(target=step) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("another thread" in one for one in told)
    assert s.counters["steps"] > 0 and numpy.isfinite(s.positions).all()


def test_a_step_that_fails():
    text = PENDULUM.replace('<gravity', '<load at="arm" force="0 0 1/(t-0.25)"/> <gravity')
    s = mbd.Model(text=text).stepper()
    with pytest.raises(mbd.RunError) as caught:
        s.step(400)
    assert 0.2 < caught.value.t <= 0.25 and s.t == caught.value.t


def test_what_cannot_be_stepped(models):
    with pytest.raises(mbd.ModelError, match="transient"):
        mbd.Model(models / "bend45.xml").stepper()
    m = mbd.Model(text=PENDULUM)
    for given in ({"method": "euler"}, {"step": -1}, {"step": 0}, {"tolerance": 7}, {"step": 1e-3, "tolerance": 1e-6},
                  {"duration": 0}, {"method": "ida"}):
        with pytest.raises(mbd.Error):
            m.stepper(**given)
    with pytest.raises(mbd.UseError):
        m.stepper(step=float("nan"))
    with pytest.raises(mbd.UseError):
        m.stepper().step(0)
