"""The examples run as programs, and become notebooks."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def run(name: str, where: Path) -> str:
    command = [sys.executable, EXAMPLES / f"{name}.py", where]
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, cwd=where, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_manuals_ten_lines_do_what_they_say(tmp_path):
    page = EXAMPLES.parents[2] / "src" / "manual" / "python.md"
    lines = page.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    (tmp_path / "scenes").symlink_to(EXAMPLES.parents[2] / "scenes")
    command = [sys.executable, "-c", lines]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("(90, 160, 3)")
    assert float(done.stdout.split()[-1]) == pytest.approx(1, abs=0.1)
    assert (tmp_path / "picture.png").stat().st_size > 5_000


def test_the_field_of_a_room_is_looked_into(tmp_path):
    pytest.importorskip("matplotlib")
    assert "share" in run("field_of_a_room", tmp_path)
    assert (tmp_path / "field_of_a_room.png").stat().st_size > 20_000


def test_table_1_takes_ten_lines(tmp_path):
    table = run("table1_in_ten_lines", tmp_path).splitlines()
    assert [line.split()[0] for line in table] == ["guide", "none", "gmm", "double", "ppg"]


def test_a_field_drives_mitsuba(tmp_path):
    pytest.importorskip("mitsuba")
    assert "Mitsuba" in run("mitsuba_direct_light", tmp_path)


def test_examples_become_notebooks(tmp_path):
    source = EXAMPLES / "field_of_a_room.py"
    copy = tmp_path / "a.py"
    copy.write_bytes(source.read_bytes())
    subprocess.run([sys.executable, EXAMPLES / "to_notebook.py", copy], check=True)
    cells = json.loads((tmp_path / "a.ipynb").read_text())["cells"]
    assert cells[0]["cell_type"] == "markdown" and cells[0]["source"][0].startswith("# Look into")
    code = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")
    compile(code, "a.ipynb", "exec")
