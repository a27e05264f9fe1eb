"""Writes environment.exr and emitters.txt: what Mitsuba 3's emitters send, the reference for src/light.

Run with a Python that has Mitsuba 3 (made with 3.9.1): python emitters.py > emitters.txt
Lines: `map` direction, radiance, density of the environment map; `spot` / `slide` (a projector) and
`check` (a spot with a checkerboard): a point and the irradiance there.
"""

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
rng = np.random.default_rng(5)
pixels = rng.uniform(0, 1, (9, 16, 3)).astype(np.float32)
pixels[2, 15] = [5000, 4000, 2500]  # a sun beside the seam
pixels[6, 3:7] = 0
mi.Bitmap(pixels).write("environment.exr")


def numbers(*values):
    return " ".join(f"{float(x):.9g}" for v in values for x in np.ravel(v))


turn = mi.ScalarTransform4f().rotate([2 / 7, 6 / 7, -3 / 7], 50)
print("# Made by emitters.py with Mitsuba", mi.__version__)
env = mi.load_dict({"type": "envmap", "filename": "environment.exr", "scale": 2.0, "to_world": turn})
print("turn", numbers(np.array(turn.matrix)[:3, :3].T))
for i in range(300):
    d = rng.normal(size=3)
    d /= np.linalg.norm(d)
    if i % 3 == 0:  # close to the sun
        theta, phi = np.pi * (2 + rng.uniform(-1, 1)) / 8, 2 * np.pi * (15.5 + rng.uniform(-1, 1)) / 16
        local = [np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)]
        d = np.array(turn @ mi.ScalarVector3f(local))
    si = mi.SurfaceInteraction3f()
    si.wi = -d
    ds = mi.DirectionSample3f()
    ds.d = d
    print("map", numbers(d, env.eval(si), env.pdf_direction(si, ds)))

place = mi.ScalarTransform4f().look_at(origin=[1, 2, 3], target=[0, 0, 0.5], up=[0, 1, 0])
print("place", numbers(np.array(place.matrix)[:3, :].T))
white = {"type": "bitmap", "bitmap": mi.Bitmap(np.full((6, 8, 3), 0.7, np.float32)), "raw": True}
lights = {
    "spot": {"type": "spot", "intensity": {"type": "rgb", "value": [3, 2, 1]}, "cutoff_angle": 30.0, "beam_width": 18.0},
    "check": {"type": "spot", "intensity": 3.0, "cutoff_angle": 30.0, "texture": {"type": "checkerboard", "color0": 0.1, "color1": 0.9}},
    "slide": {"type": "projector", "irradiance": white, "scale": 2.0, "fov": 40.0},
}
for name, light in lights.items():
    light = mi.load_dict(light | {"to_world": place})
    for _ in range(60):
        at = np.array(place @ mi.ScalarPoint3f(*(rng.uniform(-1.2, 1.2, 2)), 2.5)) + rng.uniform(-0.5, 0.5, 3)
        it = mi.SurfaceInteraction3f()
        it.p = at
        ds, value = light.sample_direction(it, [0.5, 0.5])
        print(name, numbers(at, value))
