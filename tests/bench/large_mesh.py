#!/usr/bin/env python3
"""One large mesh in twintree, Mitsuba 3 and Blender Cycles: seconds from start to image and the most memory held.

Each renders the mesh alone, grey under a constant sky, 768 x 576 pixels, 16 samples, depth 8, in a process of
its own. The programs take turns; medians count. Mitsuba runs in scalar and in LLVM mode: its own tree, and Embree.

    pip install mitsuba==3.9.1 numpy  # in one environment
    pip install bpy==5.0.1            # in another, with Python 3.11
    python3 tests/bench/large_mesh.py [--runs 3] [--mitsuba PYTHON] [--blender PYTHON] MESH.ply
"""
import argparse, glob, os, statistics, subprocess, sys, tempfile, time

WIDTH, HEIGHT, SPP, DEPTH, THREADS = 768, 576, 16, 8, 2


def mitsuba(variant, mesh, out):
    """Renders with Mitsuba 3."""
    llvm = sorted(glob.glob("/usr/lib/*/libLLVM-19.so*") + glob.glob("/usr/lib/*/libLLVM.so.19*"))
    if llvm:
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", llvm[0])
    import mitsuba as mi
    import drjit as dr
    mi.set_variant(variant)
    dr.set_thread_count(THREADS)
    scene = {
        "type": "scene", "integrator": {"type": "path", "max_depth": DEPTH}, "light": {"type": "constant"},
        "mesh": {"type": "ply", "filename": mesh, "bsdf": {"type": "twosided", "inner": {"type": "diffuse"}}},
    }
    low, high = bounds(mesh)
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    radius = sum((b - a) ** 2 for a, b in zip(low, high)) ** 0.5 / 2
    eye = [middle[0] + radius, middle[1] - 1.6 * radius, middle[2] + radius]
    scene["camera"] = {
        "type": "perspective", "fov": 45, "to_world": mi.ScalarTransform4f().look_at(eye, middle, [0, 0, 1]),
        "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "pixel_format": "rgb"},
        "sampler": {"type": "independent", "sample_count": SPP},
    }
    mi.Bitmap(mi.render(mi.load_dict(scene))).write(out)


def bounds(mesh):
    """Of the vertices of a binary PLY file whose vertices begin with x, y, z as floats."""
    import numpy as np
    with open(mesh, "rb") as f:
        head = b""
        while not head.endswith(b"end_header\n"):
            head += f.readline()
        offset = f.tell()
    lines = head.decode().split("\n")
    count = next(int(l.split()[2]) for l in lines if l.startswith("element vertex"))
    floats = sum(l.startswith("property float") for l in lines)
    vertices = np.memmap(mesh, "<f4", "r", offset, (count, floats))[:: max(count // 100_000, 1), :3]
    return vertices.min(0).tolist(), vertices.max(0).tolist()


def blender(mesh, out):
    """Renders with Blender Cycles."""
    import bpy, mathutils
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.ply_import(filepath=mesh)
    thing = next(o for o in bpy.context.scene.objects if o.type == "MESH")
    corners = [mathutils.Vector(c) for c in thing.bound_box]
    low, high = (mathutils.Vector([f(c[i] for c in corners) for i in range(3)]) for f in (min, max))
    middle, radius = (low + high) / 2, (high - low).length / 2
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = middle + mathutils.Vector((radius, -1.6 * radius, radius))
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.clip_end = 10 * radius
    scene.collection.objects.link(camera)
    scene.camera = camera
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world = world
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = SPP, False, False
    cycles.max_bounces = cycles.diffuse_bounces = DEPTH - 1
    render.threads_mode, render.threads = "FIXED", THREADS
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format = "PNG"
    render.filepath = out
    bpy.ops.render.render(write_still=True)


def measure(command):
    """Wall seconds and peak memory in GB of a process."""
    start = time.time()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        return None
    return time.time() - start, usage.ru_maxrss * 1024 / 1e9


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--program", default="target/release/twintree")
    parser.add_argument("--mitsuba", default=sys.executable, help="Python that has mitsuba")
    parser.add_argument("--blender", default=sys.executable, help="Python that has bpy")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "image")
        ours = [args.program, "render", args.mesh, "--quiet", "--sky", "white", "--width", str(WIDTH), "--height",
                str(HEIGHT), "--guide", "none", "--spp", str(SPP), "--max-depth", str(DEPTH), "-j", str(THREADS)]
        commands = {
            "twintree": [*ours, "-o", out + ".png"],
            "twintree, compact": [*ours, "--accel-build", "compact", "-o", out + ".png"],
            "Mitsuba 3, scalar": [args.mitsuba, __file__, "--role", "scalar_rgb", args.mesh, out + ".exr"],
            "Mitsuba 3, LLVM": [args.mitsuba, __file__, "--role", "llvm_ad_rgb", args.mesh, out + ".exr"],
            "Blender Cycles": [args.blender, __file__, "--role", "blender", args.mesh, out + ".png"],
        }
        rounds = {name: [] for name in commands}
        for _ in range(args.runs):
            for name, command in commands.items():
                rounds[name].append(measure(command))
    print("| program | seconds | memory, GB |\n|---|---|---|")
    for name, results in rounds.items():
        results = [r for r in results if r]
        middle = [statistics.median(r) for r in zip(*results)]
        print(f"| {name} | {middle[0]:.1f} | {middle[1]:.2f} |" if results else f"| {name} | failed | |")


if len(sys.argv) == 5 and sys.argv[1] == "--role":
    blender(*sys.argv[3:]) if sys.argv[2] == "blender" else mitsuba(*sys.argv[2:])
else:
    main()
