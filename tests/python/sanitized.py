"""The module under address, leak and undefined-behaviour sanitizers: 10,000 random calls (those of test_errors.py), and each thing
made, used and dropped many times. A leak counts where the module or the library has a part in it: Python has its own.

Usage: sanitized.py RUNTIME     the sanitizers' shared library; PYTHONPATH has the module with instruments

Tried in it, and killed, in the module: memory that is never freed; a read beyond the end of an array; an overflow of an int.
"""

import ctypes.util
import importlib.util
import os
import re
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

USE = r"""
import gc, sys, numpy, mbd
text = sys.argv[3]
kept = []
for k in range(30):
    m = mbd.Model(text=text, set={"W": 1 + k})
    m.columns, m.parameters, m.check(), m.explain()
    r = m.run(estimate_error=False)
    kept = [r["tip"], r.values]         # views outlive what they are of
    s = m.stepper(method=["generalized_alpha", "radau"][k % 2])
    s.step(5)
    state, bytes_ = s.state(), s.save()
    s.restore(bytes_)
    s.start(state)
    at = s.remember(); s.step(); s.go_back(at)
    s.linearize()
    views = [s.positions, s.quaternions, s.velocities, s.accelerations]
    for wrong in (lambda: s["nothing"], lambda: r["nothing"], lambda: mbd.Model(text=text[:-9]), lambda: s.restore(b"x")):
        try:
            wrong()
        except mbd.Error:
            pass
    scene = mbd.Scene("s")
    scene.body(name="b", mass=1, inertia=(1, 1, 1)); scene.transient(duration=0.01, step=1e-3)
    scene.record(name="b", at="b", quantities="position"); scene.run(estimate_error=False)
    del m, s, r
    gc.collect()
    assert all(numpy.isfinite(v).all() for v in views + kept)
t = mbd.sweep(mbd.Model(text=text), {"W": [1, 2, -1]}, jobs=2)
assert t.status == ["done", "done", "refused"]
print("used")
"""


def main():
    runtime = sys.argv[1]
    for name in ("pytest", "numpy", "mbd"):
        if importlib.util.find_spec(name) is None:
            print(f"skipped: Python has no {name}")
            return 77
    if not os.path.exists(runtime):
        print(f"skipped: there is no {runtime}")
        return 77
    # What throws has to be there when the sanitizers look for it.
    standard = ctypes.util.find_library("stdc++")
    os.environ.setdefault("MBD_PROGRAM", "none")
    from conftest import PENDULUM

    with open(os.path.join(os.path.dirname(__file__), "test_errors.py"), encoding="utf-8") as stream:
        fuzz = re.search(r'FUZZ = r"""(.*?)"""', stream.read(), re.S)[1]
    short = PENDULUM.replace('duration="0.5"', 'duration="0.02"')
    environment = dict(os.environ, LD_PRELOAD=f"{runtime} {standard}", PYTHONMALLOC="malloc",
                       ASAN_OPTIONS="detect_leaks=1:fast_unwind_on_malloc=0:allocator_may_return_null=1:detect_odr_violation=0"
                                    ":detect_container_overflow=0",  # the library makes containers without instruments
                       UBSAN_OPTIONS="print_stacktrace=1", LSAN_OPTIONS="exitcode=0:print_suppressions=0")
    failed = False
    said = re.compile("ERROR: AddressSanitizer|CHECK failed|runtime error:")  # the status of leaks, 0, is that of all
    for what, code, arguments in [("use", USE, ["0", "0"]), ("random calls", fuzz, ["0", "10000"])]:
        done = subprocess.run([sys.executable, "-X", "faulthandler", "-c", code, *arguments, short], env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, errors="replace", check=False)
        leaks = [leak for leak in re.split(r"\n\s*\n", done.stderr) if re.search(r"leak of \d+ byte", leak)]
        ours = [leak for leak in leaks if re.search(r"/_mbd\.|mbd::", leak)]
        print(f"{what}: status {done.returncode}, {len(leaks)} leaks, {len(ours)} of the module; {done.stdout.strip()[-200:]}")
        wrong = done.returncode != 0 or not done.stdout or bool(said.search(done.stderr))
        if wrong:
            print(done.stderr[-6000:])
        for leak in ours[:5]:
            print(leak)
        if "LeakSanitizer has encountered a fatal error" in done.stderr:
            print("no leaks were looked for: " + done.stderr[-500:])
        failed |= wrong or bool(ours)
    return int(failed)


sys.exit(main())
