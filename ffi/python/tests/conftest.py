"""What the tests share: a small scene, its field, and the command line."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Callable

import pytest
import twintree

SCENES = Path(__file__).resolve().parents[3] / "scenes"
CORNELL = SCENES / "cornell" / "cornell.xml"


@pytest.fixture(scope="session")
def cornell() -> twintree.Scene:
    return twintree.load(CORNELL)


@pytest.fixture(scope="session")
def field(cornell: twintree.Scene) -> twintree.Field:
    return cornell.train(photons=20_000, paths=20_000, width=64)


@pytest.fixture(scope="session")
def program() -> Callable[..., subprocess.CompletedProcess[str]]:
    def run(*words: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "twintree", *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, timeout=300)

    return run
