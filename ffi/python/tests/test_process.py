"""Signals, forks and the command line in processes of their own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest
import twintree
from conftest import CORNELL


def run(code: str, interrupt_after: float = 0) -> subprocess.CompletedProcess[str]:
    """Runs a program of Python; sends Ctrl-C so long after its first line."""
    command = [sys.executable, "-c", f"import twintree, os, sys, signal\nSCENE = {str(CORNELL)!r}\n{code}"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    first = ""
    if interrupt_after:
        first = child.stdout.readline()
        time.sleep(interrupt_after)
        child.send_signal(signal.SIGINT)
    out, err = child.communicate(timeout=120)
    return subprocess.CompletedProcess(command, child.returncode, first + out, err)


def test_ctrl_c_ends_a_render_with_what_there_is():
    done = run(
        """
scene = twintree.load(SCENE)
scene.render(spp=1, width=64, guide="none")
print("begun", flush=True)
picture = scene.render(time=60, width=64, guide="none")
print(picture.interrupted, picture.stats["stopped_by"], picture["image"].mean() > 0.1)
print(scene.render(spp=1, width=64, guide="none").interrupted)
""",
        interrupt_after=1.0,
    )
    assert done.stdout.split() == ["begun", "True", "interrupt", "True", "False"], done.stderr
    assert done.returncode == 0


def test_ctrl_c_ends_training_with_what_there_is():
    done = run(
        """
scene = twintree.load(SCENE)
def photons(field):
    return field.stats["sample_ranges"]["photons"]["taken"][-1]["end"]
print("begun", flush=True)
field = scene.train(photons=1_000_000_000, paths=0, width=64)
more = scene.train(field=field, photons=1000, paths=0, width=64)
print(field.interrupted, 0 < photons(field) < 1_000_000_000, more.interrupted)
print(photons(more) - photons(field), scene.render(spp=1, width=16, guide="double", field=field).interrupted)
""",
        interrupt_after=2.0,
    )
    assert done.stdout.split() == ["begun", "True", "True", "False", "1000", "False"], done.stderr
    assert done.returncode == 0


def test_training_that_has_learned_nothing_is_a_keyboard_interrupt():
    done = run(
        """
scene = twintree.load(SCENE)
class Bar:
    def __init__(self, **_):
        signal.raise_signal(signal.SIGINT)
    def __getattr__(self, _):
        return lambda *_: None
start = scene.train(photons=1000, paths=0, width=64)
for settings in ({"batches": 1}, {"field": start}):
    try:
        scene.train(photons=1_000_000_000, paths=0, width=64, progress=Bar, **settings)
    except KeyboardInterrupt:
        print("interrupted")
"""
    )
    assert done.stdout.split() == ["interrupted"] * 2, done.stderr


def test_an_exception_of_a_signal_handler_is_raised():
    done = run(
        """
def stop(*_):
    raise RuntimeError("enough")
signal.signal(signal.SIGALRM, stop)
signal.setitimer(signal.ITIMER_REAL, 0.5)
try:
    twintree.load(SCENE).render(time=60, width=64, guide="none")
except RuntimeError as e:
    print(e)
"""
    )
    assert done.stdout.strip() == "enough", done.stderr


def test_a_forked_process_refuses_scenes_in_words_and_has_fields():
    done = run(
        """
scene = twintree.load(SCENE)
field = scene.train(photons=3000, paths=0, width=32)
scene.render(spp=1, width=16, guide="none")
field.stats
sys.stdout.flush()
if os.fork() == 0:
    for call in (lambda: scene.render(spp=1), lambda: twintree.load(SCENE), lambda: scene.train(photons=10)):
        try:
            call()
        except RuntimeError as e:
            print("spawn" in str(e))
    twintree.Scene().add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    twintree.Trainer((0, 0, 0), (1, 1, 1)).field().stats
    print(field.sample((0, 1, 0), None, 3)[0].shape, flush=True)
    os._exit(0)
os.wait()
print(scene.render(spp=1, width=16, guide="none")["image"].shape)
"""
    )
    assert done.stdout.split("\n")[:5] == ["True", "True", "True", "(1, 3, 3)", "(9, 16, 3)"], done.stderr
    assert done.returncode == 0


def test_processes_that_are_forked_before_any_scene_have_scenes_of_their_own():
    done = run(
        """
if os.fork() == 0:
    print(twintree.load(SCENE).render(spp=1, width=16, guide="none")["image"].shape, flush=True)
    os._exit(0)
os.wait()
print(twintree.load(SCENE).render(spp=1, width=16, guide="none")["image"].shape)
"""
    )
    assert done.stdout.split("\n")[:2] == ["(9, 16, 3)"] * 2, done.stderr


def test_the_package_has_the_command_line(program):
    assert program("--version").stdout.split() == ["twintree", twintree.__version__]
    assert "render" in program("--help").stdout
    done = program("render", "/none.xml")
    assert done.returncode == 2 and "error: /none.xml" in done.stderr


def test_a_sweep_is_a_table_of_records(cornell, tmp_path):
    reference = tmp_path / "reference.exr"
    cornell.render(spp=64, width=32, seed=7, guide="none", aovs="variance").save(reference)
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps({"base": "--guide none", "knobs": {"max-depth": ["3"]}}))
    settings = dict(output=tmp_path / "report", rounds=1, time=0.2, budget="60s", plan=plan)
    try:
        records = twintree.sweep(CORNELL, reference, **settings)
    except ValueError as e:
        pytest.fail(str(e))
    assert len(records) == 2 and all(r["failure"] is None for r in records)
    assert all(r["relmse"] > 0 and r["spp"] > 0 and r["curve"] for r in records)
    with pytest.raises(ValueError, match="another sweep|rounds"):
        twintree.sweep(CORNELL, reference, **{**settings, "rounds": 2})
    with pytest.raises(ValueError, match="none.exr"):
        twintree.sweep(CORNELL, "/none.exr", output=tmp_path / "other")


@pytest.mark.skipif(not os.path.exists("/proc/self/task"), reason="the system does not tell threads")
def test_no_thread_is_left_behind(cornell):
    # The ray tracer keeps its own.
    cornell.render(spp=1, width=16, guide="none", threads=3)
    before = len(os.listdir("/proc/self/task"))
    for _ in range(5):
        cornell.render(spp=1, width=16, guide="none", threads=3)
    time.sleep(0.2)
    assert len(os.listdir("/proc/self/task")) <= before
