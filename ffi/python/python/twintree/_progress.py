"""Progress bars: of tqdm, or of any class with its protocol."""

from __future__ import annotations

import importlib
import sys
from typing import Any, Optional


class Line:
    """A line on a terminal, where tqdm is not installed."""

    def __init__(self, total: Optional[float] = None, unit: str = "", desc: str = "") -> None:
        self.total, self.unit, self.desc, self.n, self.postfix = total, unit, desc, 0.0, ""
        self.width = 0

    def update(self, n: float = 1) -> None:
        """Goes on by `n` and shows it."""
        self.n += n
        of = "" if self.total is None else f"/{self.total:g}"
        text = f"{self.desc}: {self.n:.1f}{of} {self.unit}  {self.postfix}".rstrip()
        self._write(text)

    def set_postfix_str(self, s: str = "", refresh: bool = True) -> None:
        """Sets what is shown behind."""
        self.postfix = s

    def close(self) -> None:
        """Takes the line away."""
        self._write("")

    def _write(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self.width) + ("" if text else "\r"))
        sys.stderr.flush()
        self.width = len(text)


def _watched() -> bool:
    """Whether somebody looks on: a terminal, or a notebook."""
    try:
        if sys.stderr.isatty():
            return True
    except (AttributeError, ValueError):
        return False
    kernel = sys.modules.get("ipykernel")
    return kernel is not None


def _bars() -> Any:
    try:
        return importlib.import_module("tqdm.auto").tqdm
    except ImportError:
        return Line


class Shown:
    """Shows how far a render is by bars of a class, one for learning and one for rendering."""

    def __init__(self, bars: Any) -> None:
        self.bars = bars
        self.bar: Any = None
        self.doing = ""
        self.done = 0.0

    def show(self, how: dict[str, Any], last: bool) -> None:
        """Shows what the program says of itself."""
        total, unit, at = self._measure(how)
        if how["doing"] != self.doing:
            self.close()
            self.doing, self.done = how["doing"], 0.0
            self.bar = self.bars(total=total, unit=unit, desc=self.doing)
        if how["noise"] is not None:
            of = "" if how["least_noise"] is None else f" of {how['least_noise']:g}"
            self.bar.set_postfix_str(f"noise {how['noise']:.4f}{of}", False)
        at = at if total is None else min(at, total)
        if at > self.done or last:
            self.bar.update(at - self.done)
            self.done = max(at, self.done)

    def _measure(self, how: dict[str, Any]) -> tuple[Optional[float], str, float]:
        if how["doing"] == "learning":
            return how["most_records"], " paths", how["records"]
        if how["most_seconds"] is not None:
            return how["most_seconds"], "s", round(how["seconds"], 1)
        return how["most_spp"], "spp", int(how["spp"])

    def close(self) -> None:
        """Ends the bar."""
        if self.bar is not None:
            self.bar.close()
            self.bar = None


def begin(progress: Any) -> Optional[Shown]:
    """What shows progress: nothing for False, a bar for True, for None one where somebody looks on; a
    class with tqdm's protocol (`total`, `unit`, `desc`; `update`, `set_postfix_str`, `close`) is used."""
    if progress is None:
        progress = _watched()
    if progress is False:
        return None
    if progress is True:
        return Shown(_bars())
    if not callable(progress):
        raise TypeError(f"progress: a {type(progress).__name__} is no class of bars\n  help: give True, False or tqdm")
    return Shown(progress)
