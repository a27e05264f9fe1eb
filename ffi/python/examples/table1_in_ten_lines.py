# %% [markdown]
# # Table 1 in ten lines
#
# The table of the method's paper: errors, memory and times of guided rendering, each method at the same samples
# a pixel. `twintree table1` does the same with more care (repeats, turns, clean references).

# %%
from pathlib import Path
from typing import Literal

import twintree

METHODS: "tuple[Literal['none', 'gmm', 'double', 'ppg'], ...]" = ("none", "gmm", "double", "ppg")

SCENES = Path(__file__).resolve().parents[3] / "scenes" if "__file__" in globals() else Path("scenes")

# %%
scene = twintree.load(SCENES / "pool" / "pool.xml")
rows: "list[tuple[str, list[float]]]" = []
reference = scene.render(spp=256, width=96, seed=0, guide="double", reuse=1)
for guide in METHODS:
    photons = None if guide in ("none", "ppg") else 200_000
    picture = scene.render(spp=32, width=96, seed=1, guide=guide, photons=photons)
    error, stats = twintree.compare(picture, reference), picture.stats
    seconds = (stats["train_seconds"], stats["render_seconds"] - stats["train_seconds"], stats["render_seconds"])
    numbers = [error["l1"], error["rmse"], error["ssim"], stats["field_memory_bytes"] / 1e6, *seconds]
    rows.append((guide, numbers))

# %%
print(f"{'guide':8}" + "".join(f"{head:>10}" for head in "L1 RMSE SSIM MB pre render total".split()))
for name, numbers in rows:
    print(f"{name:8}" + "".join(f"{number:10.4f}" for number in numbers))

# %%
best = min(rows, key=lambda row: row[1][1])
assert best[0] != "none", "guiding did not help in a pool under a small sun"
