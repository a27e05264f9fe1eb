"""Writes sun_radiance.txt: the mean radiance of the sun's disk after Hosek and Wilkie,
"Adding a Solar-Radiance Function to the Hosek-Wilkie Skylight Model" (2013), as Mitsuba 3's
`sunsky` evaluates it (made with 3.9.1). Run: python sun_radiance.py > sun_radiance.txt

A row for each elevation 2, 5, .. 89 degrees (between which it interpolates linearly), ten columns of
red/green/blue for turbidity 1 to 10.
"""

import math

import mitsuba as mi

mi.set_variant("scalar_rgb")
print("# Radiance of the sun, linear sRGB, W / (m^2 sr nm); made by sun_radiance.py with Mitsuba", mi.__version__)
for degrees in range(2, 90, 3):
    elevation = math.radians(degrees)
    to_sun = [math.cos(elevation), 0, math.sin(elevation)]
    row = []
    for turbidity in range(1, 11):
        sky = mi.load_dict({"type": "sunsky", "sun_direction": to_sun, "turbidity": float(turbidity), "sky_scale": 0.0})
        si = mi.SurfaceInteraction3f()
        si.wi = [-x for x in to_sun]
        row += ["/".join(f"{max(c, 0.0):.6g}" for c in sky.eval(si))]
    print(*row)
