"""The types: they are those of the compiled module, and the examples keep to them."""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path

import pytest
import twintree

HERE = Path(__file__).resolve().parents[1]


def test_the_types_are_those_of_the_command_lines_options():
    made = subprocess.run([sys.executable, HERE / "stub.py"], capture_output=True, text=True, check=True)
    there = (HERE / "python" / "twintree" / "_native.pyi").read_text(encoding="utf-8")
    assert made.stdout == there, "stub.py makes others: write them anew"


#: Names of the types that stand for types alone, and one that no compiled module needs to tell.
TYPES_ALONE = ["Floats", "Incident", "Numbers", "Option", "Path", "__all__"]


def test_the_types_are_those_of_the_compiled_module(tmp_path):
    # Names, arguments with their order, kinds and defaults, properties and classes, both ways.
    pytest.importorskip("mypy")
    allowed = tmp_path / "allowed"
    allowed.write_text("\n".join(rf"twintree\._native\.{name}" for name in TYPES_ALONE))
    command = [sys.executable, "-m", "mypy.stubtest", "twintree._native", "--allowlist", allowed]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout


def test_everything_public_is_documented():
    for name in twintree.__all__:
        found = getattr(twintree, name)
        assert name == "__version__" or inspect.getdoc(found), name
        if inspect.isclass(found):
            for method, value in vars(found).items():
                if not method.startswith("_"):
                    assert inspect.getdoc(value), f"{name}.{method}"


def test_the_examples_and_the_package_keep_to_their_types():
    pytest.importorskip("mypy")
    files = [HERE / "examples", HERE / "python" / "twintree"]
    command = [sys.executable, "-m", "mypy", "--strict", *files]
    done = subprocess.run(command, capture_output=True, text=True, cwd=HERE)
    assert done.returncode == 0, done.stdout
