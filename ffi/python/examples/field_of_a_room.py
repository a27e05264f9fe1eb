# %% [markdown]
# # Look into the field of a room
#
# A room is lit through a door that is ajar. What has the program learned about where its light comes from?
# For a point that a pixel sees, the learned density of directions stands beside the light that arrives there,
# traced by brute force.

# %%
import sys
from pathlib import Path

import matplotlib
import numpy as np
import twintree

matplotlib.use("Agg" if "ipykernel" not in sys.modules else matplotlib.get_backend())
import matplotlib.pyplot as plt

SCENES = Path(__file__).resolve().parents[3] / "scenes" if "__file__" in globals() else Path("scenes")
OUTPUT = Path(sys.argv[1] if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir() else ".")

# %%
scene = twintree.load(SCENES / "door" / "door.xml")
field = scene.train(photons=200_000, paths=200_000)
links, cells = field.stats["stats"]["links"], field.stats["stats"]["space_cells"]
print(f"{links} links in {cells} cells, bounds {field.bounds}")

# %% [markdown]
# The picture, guided by that very field, with the places that are looked into.

# %%
WIDTH, HEIGHT = 160, 90
pixels = [(40, 70), (80, 30), (120, 60)]
picture = scene.render(spp=16, width=WIDTH, height=HEIGHT, field=field)
figure, axes = plt.subplots(1 + len(pixels), 2, figsize=(10, 3 * (1 + len(pixels))))
axes[0, 0].imshow(np.clip(picture["image"], 0, 1) ** (1 / 2.2))
axes[0, 0].plot(*zip(*pixels), "r+")
axes[0, 0].set_title(f"{picture.stats['spp']} samples a pixel")

# %% [markdown]
# Where the field sends paths (left) and where light comes from (right), as latitude by longitude with +z up.
# `share` is what of the light lies where the field's density is above the uniform one. Few records fall on the small
# things at the third pixel: there it is between 0.2 and 0.9, by the seed.

# %%
shares = []
for (x, y), (left, right) in zip(pixels, axes[1:]):
    here = scene.incident(x, y, rows=32, spp=64, width=WIDTH, height=HEIGHT)
    ways = here["directions"].reshape(-1, 3)
    density = field.pdf(here["position"], here["normal"], ways).reshape(32, 64)
    light = here["radiance"].mean(axis=2)
    weight = light * here["solid_angle"]
    share = weight[density > 1 / (4 * np.pi)].sum() / weight.sum()
    shares.append(share)
    print(f"pixel {x}, {y}: integral {(density * here['solid_angle']).sum():.3f}, share {share:.2f}")
    left.imshow(np.log10(density * 4 * np.pi), cmap="magma")
    left.set_title(f"learned at {x}, {y}")
    right.imshow(np.log10(light / light.mean() + 1e-3), cmap="magma")
    right.set_title("brute force")

# %%
axes[0, 1].axis("off")
figure.tight_layout()
figure.savefig(OUTPUT / "field_of_a_room.png", dpi=80)
assert np.mean(shares) > 0.5, "the field looks where no light is"
