"""`twintree sweep` from Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

Name = Union[str, "os.PathLike[str]"]


def _words(settings: Mapping[str, Any]) -> list[str]:
    words = []
    for name, value in settings.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)):
            words.append(f"{option}={','.join(map(str, value))}")
        else:
            words.append(f"{option}={value}")
    return words


def sweep(
    scene: Name,
    reference: Name,
    *,
    output: Name = "report",
    render: Optional[Mapping[str, Any]] = None,
    defines: Optional[Mapping[str, Any]] = None,
    threads: Optional[int] = None,
    **settings: Any,
) -> list[dict[str, Any]]:
    """Tries settings on a scene against a reference, as `twintree sweep` does, in processes of their own.

    Keywords are its options: `budget="10m"`, `rounds=3`, `time="30s"`, `clock="wall"`, `plan="plan.json"`;
    `render` are those of every render, such as `{"max_depth": 8}`, and `defines` values of the scene's
    `$names`. The report is in the directory `output`, and the same call goes on where it ended.

    Returns a table of records, one a run: "configuration", "round", "command", "failure", "wall_seconds",
    and what it measured: "spp", "rays", "render_seconds", "train_seconds", "peak_memory_bytes", the last
    errors "rmse", "relmse", "relmse_trimmed", and "curve", these over time. `pandas.DataFrame` takes it.

    Raises `ValueError` or `RuntimeError` with the program's message, `KeyboardInterrupt` where Ctrl-C ended
    it: what there is then is in the report.
    """
    command = [sys.executable, "-m", "twintree", "sweep", os.fspath(scene)]
    command += ["--reference", os.fspath(reference), "--output", os.fspath(output)]
    for name, value in (defines or {}).items():
        command += ["-D", f"{name}={value}"]
    if threads is not None:
        command.append(f"--threads={threads}")
    command += _words(settings)
    if render:
        command += ["--", *_words(render)]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode == 130:
        raise KeyboardInterrupt
    if done.returncode != 0:
        raised = ValueError if done.returncode == 2 else RuntimeError
        raise raised(_said(done.stderr))
    report = json.loads((Path(output) / "report.json").read_text(encoding="utf-8"))
    return [_record(run) for run in report["runs"]]


def _said(messages: str) -> str:
    """The message that ended the program, as the exceptions of the other functions have it."""
    _, _, text = messages.rpartition("error: ")
    return text.strip() or "the sweep has ended without a word"


def _record(run: Mapping[str, Any]) -> dict[str, Any]:
    names = ("configuration", "round", "command", "failure", "wall_seconds")
    record = {name: run[name] for name in names}
    stats = run["stats"]
    if stats is None:
        return record
    curve = stats.get("errors") or []
    flat = {k: v for k, v in stats.items() if not isinstance(v, (dict, list))}
    last = {k: v for k, v in curve[-1].items() if k not in flat} if curve else {}
    return {**record, **flat, **last, "curve": curve}
