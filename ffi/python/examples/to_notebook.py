"""Makes a notebook of one of the examples: `python to_notebook.py field_of_a_room.py`.

The examples are programs whose cells begin with `# %%`; editors that know these run them as they are.
"""

import json
import re
import sys
from pathlib import Path


def notebook(text: str) -> str:
    """The cells of a program, as a Jupyter notebook."""
    cells: list[dict[str, object]] = []
    for cell in re.split(r"^# %%", text, flags=re.M)[1:]:
        kind, _, body = cell.partition("\n")
        is_text = "[markdown]" in kind
        lines = body.strip().splitlines(keepends=True)
        if is_text:
            lines = [re.sub(r"^# ?", "", line) for line in lines]
        made: dict[str, object] = {"cell_type": "markdown" if is_text else "code", "metadata": {}, "source": lines}
        cells.append(made if is_text else {**made, "execution_count": None, "outputs": []})
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 4}, indent=1)


if __name__ == "__main__":
    for name in map(Path, sys.argv[1:]):
        name.with_suffix(".ipynb").write_text(notebook(name.read_text(encoding="utf-8")), encoding="utf-8")
