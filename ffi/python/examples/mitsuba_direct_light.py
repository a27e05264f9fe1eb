# %% [markdown]
# # A field that drives Mitsuba 3
#
# The double hierarchy for another renderer: a field learns from Mitsuba's own records where direct light comes
# from, and Mitsuba's own loop draws directions from that. Rays, materials and lamps are Mitsuba's. The
# mean is that of Mitsuba's integrator, whatever the field says.

# %%
from pathlib import Path
from typing import Any

import mitsuba as mi  # type: ignore[import-not-found, unused-ignore]
import numpy as np
import twintree

mi.set_variant("scalar_rgb")
SCENES = Path(__file__).resolve().parents[3] / "scenes" if "__file__" in globals() else Path("scenes")
FILE = SCENES / "cornell" / "cornell.xml"
WIDTH, HEIGHT, SPP = 64, 36, 32

# %%
scene: Any = mi.load_file(str(FILE), resx=WIDTH, resy=HEIGHT)
sensor, context = scene.sensors()[0], mi.BSDFContext()
numbers = np.random.default_rng(1)


def seen(spp: int) -> "list[tuple[int, Any, Any, Any]]":
    """What the camera sees: number of the sample, Mitsuba's interaction, position, normal."""
    hits = []
    for i in range(spp * HEIGHT * WIDTH):
        x, y = i % WIDTH, i // WIDTH % HEIGHT
        at = [(x + numbers.random()) / WIDTH, (y + numbers.random()) / HEIGHT]
        met = scene.ray_intersect(sensor.sample_ray(0.0, 0.5, at, [0.5, 0.5])[0])
        if met.is_valid():
            side = np.array(met.n) * (1 if met.wi.z > 0 else -1)
            hits.append((i, met, np.array(met.p), side))
    return hits


# %% [markdown]
# The field learns from light samples that Mitsuba draws at what the camera sees, in batches that double.

# %%
box = scene.bbox()
trainer = twintree.Trainer(list(box.min), list(box.max), source="paths", normal_split=True)
for spp in (1, 2, 4, 8):
    hits = seen(spp)
    lit = [scene.sample_emitter_direction(met, list(numbers.random(2))) for _, met, _, _ in hits]
    positions, normals = (np.array([hit[k] for hit in hits]) for k in (2, 3))
    ways, pdfs = np.array([d.d for d, _ in lit]), np.array([d.pdf for d, _ in lit])
    usable = pdfs > 0
    radiance = np.array([weight for _, weight in lit]) * pdfs[:, None]
    far = np.array([d.dist for d, _ in lit])
    chosen = [array[usable] for array in (positions, ways, radiance, pdfs)]
    trainer.train_paths(*chosen, distances=far[usable], normals=normals[usable])
    trainer.refine()
field = trainer.field()
print(field)

# %% [markdown]
# Then a direction for each point from the field, all at once.

# %%
hits, light = seen(SPP), np.zeros((SPP * HEIGHT * WIDTH, 3))
positions, normals = (np.array([hit[k] for hit in hits]) for k in (2, 3))
from_field, of_field = (a[:, 0] for a in field.sample(positions, normals, 1, seed=7))

# %% [markdown]
# Another direction comes from the material, as in any path tracer; the balance heuristic weighs the two.

# %%
drawn = [met.bsdf().sample(context, met, numbers.random(), list(numbers.random(2)))[0] for _, met, _, _ in hits]
from_bsdf = np.array([met.to_world(sample.wo) for (_, met, _, _), sample in zip(hits, drawn)])
of_bsdf = field.pdf(positions, normals, from_bsdf / np.linalg.norm(from_bsdf, axis=1, keepdims=True))
for directions, densities in ((from_field, of_field), (from_bsdf, of_bsdf)):
    for (i, met, _, _), way, density in zip(hits, directions, densities):
        ray = met.spawn_ray(mi.Vector3f(*map(float, way)))
        there = scene.ray_intersect(ray)
        if there.is_valid() and there.emitter(scene) is not None:
            value, other = met.bsdf().eval_pdf(context, met, met.to_local(ray.d))
            light[i] += np.array(value) * np.array(there.emitter(scene).eval(there)) / (density + other)

# %%
estimate = light.reshape(SPP, -1, 3).mean(axis=(1, 2))
mean, error = estimate.mean(), estimate.std(ddof=1) / SPP**0.5
theirs = 0.0
for depth, sign in ((2, 1), (1, -1)):
    # Without what is seen of the lamps themselves.
    integrator: Any = mi.load_dict({"type": "path", "max_depth": depth})
    theirs += sign * np.array(mi.render(scene, integrator=integrator, spp=1024, seed=3))[..., :3].mean()
print(f"guided {mean:.4f} +- {error:.4f}, Mitsuba {theirs:.4f}")
assert error < 0.01 * theirs, "there are too few samples"
assert abs(mean - theirs) < 4 * error, "the means differ"
