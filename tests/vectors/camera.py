"""Writes camera.txt: rays of Mitsuba 3 cameras, the reference for src/camera.

Run with a Python that has Mitsuba 3 (made with 3.9.1): python camera.py > camera.txt
Each `camera` line: kind, 16 entries of to_world (row-major), fov, axis, principal x, y, aperture,
focus, near, far, width, height. Each `ray` line below it: film x, y (0 to 1), lens u, v, origin,
direction, length of the ray.
"""

import mitsuba as mi

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f


def camera(kind, to_world, width, height, fov=40.0, axis="x", pp=(0.0, 0.0), aperture=0.0, focus=1.0, near=0.01, far=1e4):
    d = {
        "type": kind,
        "to_world": to_world,
        "near_clip": near,
        "far_clip": far,
        "film": {"type": "hdrfilm", "width": width, "height": height},
    }
    if kind != "orthographic":
        d |= {"fov": fov, "fov_axis": axis}
    if kind == "perspective":
        d |= {"principal_point_offset_x": pp[0], "principal_point_offset_y": pp[1]}
    if kind == "thinlens":
        d |= {"aperture_radius": aperture, "focus_distance": focus}
    sensor = mi.load_dict(d)
    m = [to_world.matrix[i, j] for i in range(4) for j in range(4)]
    numbers = m + [fov]
    rest = [*pp, aperture, focus, near, far]
    print("camera", kind, *map(repr, map(float, numbers)), axis, *map(repr, map(float, rest)), width, height)
    for x, y in [(0, 0), (1, 0), (0, 1), (0.5, 0.5), (0.3, 0.8), (0.9, 0.15)]:
        for u, v in [(0.5, 0.5), (0.2, 0.9)]:
            ray, _ = sensor.sample_ray(0.0, 0.5, [x, y], [u, v])
            print("ray", x, y, u, v, *[repr(float(c)) for c in (*ray.o, *ray.d, ray.maxt)])


look = T().look_at(origin=[1, 2, 3], target=[-2, 0.5, 4], up=[0, 1, 0])
tilted = T().look_at(origin=[-278, 273, -800], target=[-200, 250, 0], up=[0.3, 1, 0.1])
mirrored = tilted @ T().scale([-1, 1, 1])
print("# Rays of Mitsuba", mi.__version__, "cameras; made by camera.py")
for axis in ["x", "y", "diagonal", "smaller", "larger"]:
    camera("perspective", look, 640, 480, 50.0, axis)
    camera("perspective", tilted, 300, 700, 35.0, axis)
camera("perspective", mirrored, 200, 100, 60.0)
camera("perspective", look @ T().scale([-1, -1, 1]), 200, 100, 60.0)
camera("perspective", look, 200, 130, 60.0, "x", (0.1, -0.2), near=0.5, far=20.0)
camera("perspective", T(), 1, 7, 120.0, "y")
camera("thinlens", look, 320, 200, 45.0, "x", aperture=0.3, focus=4.0)
camera("thinlens", tilted, 100, 300, 30.0, "diagonal", aperture=12.0, focus=700.0, near=1.0)
camera("orthographic", look @ T().scale([3, 3, 1]), 320, 200)
camera("orthographic", tilted @ T().scale([-50, 80, 1]), 120, 200, near=2.0, far=900.0)
