"""Writes sky.txt: radiances of Mitsuba 3's `sunsky`, the reference for src/light/sunsky.rs.

Run with a Python that has Mitsuba 3 (made with 3.9.1): python sky.py > sky.txt
Each line: turbidity, albedo, direction to the sun, direction looked at, radiance; +z is up.
"""

import math

import mitsuba as mi

mi.set_variant("scalar_rgb")


def direction(elevation, azimuth):
    e, a = math.radians(elevation), math.radians(azimuth)
    return [math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)]


print("# Radiances of Mitsuba", mi.__version__, "sunsky; made by sky.py")
for turbidity, albedo in [(1.0, 0.0), (3.0, 0.3), (4.6, 0.8), (10.0, 0.1)]:
    for elevation in [2.0, 11.0, 37.0, 88.0]:
        sun = direction(elevation, 20)
        sky = mi.load_dict({
            "type": "sunsky",
            "sun_direction": sun,
            "turbidity": turbidity,
            "albedo": {"type": "rgb", "value": [albedo, albedo, albedo]},
        })
        looks = [direction(e, a) for e in (0.5, 3, 30, 70) for a in (-100, 10, 170)]
        for d in looks + [sun, direction(elevation + 1, 20), direction(-5, 0)]:
            si = mi.SurfaceInteraction3f()
            si.wi = [-x for x in d]
            print(turbidity, albedo, *map("{:.9g}".format, (*sun, *d, *sky.eval(si))))
