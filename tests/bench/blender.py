#!/usr/bin/env python3
"""Renders a Mitsuba scene with Blender Cycles, with or without its path guiding (OpenPGL); for tests/bench/media.py.

Set up once, with Python 3.11 (about 1 GB):  python3.11 -m venv VENV && VENV/bin/pip install bpy==5.0.1 mitsuba==3.9.1
Use:  VENV/bin/python tests/bench/blender.py SCENE.xml --spp 64 --width 120 [--guided] -o OUT.exr

The last line that it prints is the processor seconds of Blender's render: its own scene and trees, learning, samples, the
file. Mitsuba reads the scene; what has no counterpart here is an error. Media are Cycles' "Volume Coefficients", of the
world where the sensor stands in one. Guided is guiding of surfaces and of volumes that learns during all samples
(guiding_training_samples is 0, or what --training says). Clamping is off, all caustics are on, and as many bounces are
allowed as the scene's max_depth.
"""
# (A file named cycles.py would hide Blender's own module.)
import argparse
import os
import resource
import warnings

import bpy
import numpy as np

warnings.simplefilter("ignore", DeprecationWarning)


def prepare(scene, size, spp, bounces, threads):
    """Cycles' plainest settings: a box filter, nothing clamped, blurred, adaptive or denoised; an EXR of floats."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = spp, False, False
    cycles.pixel_filter_type, cycles.blur_glossy = "BOX", 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", bounces)
    render.threads_mode, render.threads = "FIXED", threads
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    scene.view_settings.view_transform = "Raw"
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"


class Nodes:
    """The node tree of a material or a world."""

    def __init__(self, owner):
        owner.use_nodes = True
        self.tree = owner.node_tree
        self.tree.nodes.clear()

    def new(self, kind, inputs={}, **properties):
        """A node; inputs are numbers, colours, or outputs of other nodes."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in inputs.items():
            socket = node.inputs[name]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif socket.type == "RGBA":
                socket.default_value = (*rgb(value), 1.0)
            elif socket.type == "VECTOR":
                socket.default_value = rgb(value)
            else:
                socket.default_value = float(np.asarray(value).ravel()[0])
        return node.outputs[0] if node.outputs else node


def rgb(value):
    return tuple(float(x) for x in np.broadcast_to(np.asarray(value).ravel(), 3))


def texture(nodes, params, name):
    """A colour, or a checkerboard's socket."""
    if f"{name}.value" in params:
        return rgb(params[f"{name}.value"])
    scale = np.asarray(params[f"{name}.to_uv"].matrix).reshape(-1)[[0, 4]]
    place = nodes.new("UVMap")
    place = nodes.new("VectorMath", {0: place, 1: (2 * scale[0], 2 * scale[1], 0)}, operation="MULTIPLY")
    colours = [rgb(params[f"{name}.color{k}.value"]) for k in (0, 1)]
    return nodes.new("TexChecker", {"Vector": place, "Color1": colours[1], "Color2": colours[0], "Scale": 1})


def base_reflectance(mi, bsdf, params, pairs=4000):
    """Of a plastic in even light: what its base sends through the coat, over what the coat lets pass on the way out."""
    rng = np.random.default_rng(1)
    sine, turn = np.sqrt(rng.random((2, pairs))), 2 * np.pi * rng.random((2, pairs))
    ways = np.stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1 - sine**2)], -1)
    sent, at = [], mi.SurfaceInteraction3f()
    for color in (mi.Color3f(0), mi.Color3f(params["diffuse_reflectance.value"])):
        params["diffuse_reflectance.value"] = color
        params.update()
        found = 0
        for wi, wo in zip(*ways):
            at.wi = wi.tolist()
            found = found + np.asarray(bsdf.eval(mi.BSDFContext(), at, wo.tolist())) / wo[2] * np.pi
        sent.append(found / pairs)
    passed = [1 - mi.fresnel(float(wi[2]), params["eta"])[0] for wi in ways[0]]
    return (sent[1] - sent[0]) / np.mean(passed)


def surface(nodes, mi, bsdf):
    """The shader of a BSDF; nothing of an index-matched boundary."""
    params, kind = mi.traverse(bsdf), bsdf.class_name()
    inner = ""
    if kind == "TwoSidedBRDF":
        inner, kind = "brdf_0.", "SmoothDiffuse"
    if kind == "Null":
        return None
    if kind == "SmoothDiffuse":
        return nodes.new("BsdfDiffuse", {"Color": texture(nodes, params, f"{inner}reflectance"), "Roughness": 0})
    if kind == "SmoothDielectric":
        return nodes.new("BsdfGlass", {"Color": 1, "Roughness": 0, "IOR": params["eta"]})
    roughness = np.sqrt(params["alpha"]) if "alpha" in params else np.sqrt(params.get("alpha.value", 0))
    if kind == "RoughConductor":
        inputs = {"IOR": params["eta.value"], "Extinction": params["k.value"], "Roughness": roughness}
        return nodes.new("BsdfMetallic", inputs, fresnel_type="PHYSICAL_CONDUCTOR", distribution="GGX")
    if kind in ("SmoothPlastic", "RoughPlastic"):
        # Principled and Mitsuba's plastics reflect different shares below a rough coat: this has Mitsuba's mean.
        base = nodes.new("BsdfDiffuse", {"Color": base_reflectance(mi, bsdf, params), "Roughness": 0})
        coat = nodes.new("BsdfAnisotropic", {"Color": 1, "Roughness": roughness}, distribution="GGX")
        return nodes.new("MixShader", {0: nodes.new("Fresnel", {"IOR": params["eta"]}), 1: base, 2: coat})
    raise SystemExit(f"no counterpart of {kind}")


def volume(nodes, mi, medium):
    """The shader of a homogeneous medium."""
    params = mi.traverse(medium)
    if medium.class_name() != "HomogeneousMedium" or "phase_function.g" not in params:
        raise SystemExit("media are homogeneous and scatter by Henyey and Greenstein")
    extinction = params["scale"] * np.asarray(rgb(params["sigma_t.value.value"]))
    albedo = np.asarray(rgb(params["albedo.value.value"]))
    return nodes.new("VolumeCoefficients", {
        "Absorption Coefficients": extinction * (1 - albedo), "Scatter Coefficients": extinction * albedo,
        "Anisotropy": params["phase_function.g"]})


def material(mi, shape):
    """Cycles' material of a shape: its BSDF, what it emits to its front, the medium inside."""
    made = bpy.data.materials.new(shape.id())
    nodes = Nodes(made)
    parts = {}
    if shape.emitter():
        color = np.asarray(rgb(mi.traverse(shape.emitter())["radiance.value"]))
        front = nodes.new("Math", {0: 1, 1: nodes.new("NewGeometry").node.outputs["Backfacing"]}, operation="SUBTRACT")
        strength = nodes.new("Math", {0: front, 1: color.max()}, operation="MULTIPLY")
        parts["Surface"] = nodes.new("Emission", {"Color": color / color.max(), "Strength": strength})
        made.cycles.emission_sampling = "FRONT"
    else:
        parts["Surface"] = surface(nodes, mi, shape.bsdf())
    if shape.interior_medium():
        parts["Volume"] = volume(nodes, mi, shape.interior_medium())
    nodes.new("OutputMaterial", {name: shader for name, shader in parts.items() if shader is not None})
    return made


def grid(mi, shape, across=96, along=48):
    """Triangles of a shape that Mitsuba keeps exact: vertices, faces, normals, texture coordinates."""
    kind = shape.class_name()
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, across + 1), np.linspace(0, 1, along + 1)))
    x, y, z = np.cos(2 * np.pi * u), np.sin(2 * np.pi * u), v
    if kind == "Sphere":
        x, y, z = x * np.sin(np.pi * v), y * np.sin(np.pi * v), -np.cos(np.pi * v)
        normals = np.stack([x, y, z], 1)
    elif kind == "Disk":
        x, y, z = x * (1 - v), y * (1 - v), 0 * v
        normals = np.tile((0.0, 0.0, 1.0), (len(u), 1))
    elif kind == "Rectangle":
        x, y, z = 2 * u - 1, 2 * v - 1, 0 * v
        normals = np.tile((0.0, 0.0, 1.0), (len(u), 1))
    elif kind == "Cylinder":
        normals = np.stack([x, y, 0 * v], 1)
    else:
        raise SystemExit(f"no counterpart of {kind}")
    at = np.arange(along)[:, None] * (across + 1) + np.arange(across)
    a, b, c, d = (at + k for k in (0, 1, across + 2, across + 1))
    faces = np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)
    place = np.array(mi.traverse(shape)["to_world"].matrix, float).reshape(4, 4)
    normals = normals @ np.linalg.inv(place[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = np.stack([x, y, z], 1) @ place[:3, :3].T + place[:3, 3]
    whole = np.linalg.norm(np.cross(points[faces[:, 1]] - points[faces[:, 0]],
                                    points[faces[:, 2]] - points[faces[:, 0]]), axis=1) > 0
    return points, faces[whole], normals, np.stack([u, v], 1)


def triangles(mi, shape):
    """Vertices, faces, normals (or none), texture coordinates (or none)."""
    params = mi.traverse(shape)
    if "vertex_positions" not in params:
        return grid(mi, shape)
    array = lambda name, width: np.asarray(params[name]).reshape(-1, width)
    return (array("vertex_positions", 3), array("faces", 3),
            array("vertex_normals", 3) if shape.has_vertex_normals() else None,
            array("vertex_texcoords", 2) if shape.has_vertex_texcoords() else None)


def add_shape(mi, shape):
    """Cycles' mesh of a shape."""
    points, faces, normals, uv = triangles(mi, shape)
    mesh = bpy.data.meshes.new(shape.id())
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    if uv is not None:
        mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv[faces.ravel()].astype(np.float32).ravel())
    if normals is None:
        mesh.shade_flat()
    else:
        mesh.shade_smooth()
        custom = mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT")
        custom.data.foreach_set("vector", np.ascontiguousarray(normals, np.float32).ravel())
    mesh.materials.append(material(mi, shape))
    made = bpy.data.objects.new(shape.id(), mesh)
    made.shadow_terminator_geometry_offset = 0
    bpy.context.scene.collection.objects.link(made)


def add_emitter(mi, emitter, world):
    """What shines from afar."""
    from mathutils import Vector
    params, kind = mi.traverse(emitter), emitter.class_name()
    if kind == "ConstantBackgroundEmitter":
        return {"Surface": world.new("Background", {"Color": rgb(params["radiance.value"]), "Strength": 1})}
    if kind != "DirectionalEmitter":
        raise SystemExit(f"no counterpart of {kind}")
    irradiance = np.asarray(rgb(params["irradiance.value"]))
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle, light.color = float(irradiance.max()), 0.0, tuple(irradiance / irradiance.max())
    made = bpy.data.objects.new("sun", light)
    along = np.array(params["to_world"].matrix, float).reshape(4, 4)[:3, 2]
    made.rotation_mode = "QUATERNION"
    made.rotation_quaternion = Vector((0, 0, -1)).rotation_difference(Vector(along.tolist()))
    bpy.context.scene.collection.objects.link(made)
    return {}


def add_camera(sensor):
    """The sensor's camera. Blender looks along -z, Mitsuba along z."""
    from mathutils import Matrix
    camera = bpy.data.cameras.new("camera")
    made = bpy.data.objects.new("camera", camera)
    bpy.context.scene.collection.objects.link(made)
    bpy.context.scene.camera = made
    place = np.array(sensor["to_world"].matrix, float).reshape(4, 4) @ np.diag([-1.0, 1, -1, 1])
    made.matrix_world = Matrix(place.tolist())
    camera.sensor_fit, camera.lens_unit = "HORIZONTAL", "FOV"
    camera.angle = np.radians(float(np.asarray(sensor["x_fov"]).ravel()[0]))
    camera.clip_start, camera.clip_end = float(sensor["near_clip"]), float(sensor["far_clip"])


def build(path, width):
    """Makes Blender's scene of a file; the picture's size and the most bounces."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    theirs = mi.load_file(str(path))
    scene.world = bpy.data.worlds.new("world")
    world = Nodes(scene.world)
    outputs = {}
    for shape in theirs.shapes():
        add_shape(mi, shape)
    for emitter in theirs.emitters():
        if emitter.class_name() != "AreaLight":
            outputs |= add_emitter(mi, emitter, world)
    sensor = theirs.sensors()[0]
    if sensor.get_medium() and not any(shape.interior_medium() for shape in theirs.shapes()):
        outputs["Volume"] = volume(world, mi, sensor.get_medium())
    world.new("OutputWorld", outputs)
    add_camera(mi.traverse(sensor))
    size = sensor.film().size()
    depth = int(str(theirs.integrator()).split("max_depth = ")[1].split(",")[0])
    return (width, round(width * size[1] / size[0])), max(0, depth - 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--width", type=int, default=120)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--guided", action="store_true")
    parser.add_argument("--training", type=int, default=0)
    parser.add_argument("-o", "--out", required=True)
    args = parser.parse_args()
    size, bounces = build(args.scene, args.width)
    scene = bpy.context.scene
    cycles = scene.cycles
    prepare(scene, size, args.spp, bounces, args.threads)
    cycles.seed = args.seed
    # For guided paths Cycles 5.0.1 has room for as many segments as these and bounces together: passing a boundary of a
    # volume takes one, too, and where there is no room it crashes.
    cycles.transparent_max_bounces = 256
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_guiding = cycles.use_surface_guiding = cycles.use_volume_guiding = args.guided
    cycles.guiding_training_samples = args.training
    scene.render.filepath = os.path.abspath(args.out)
    scene.render.image_settings.color_mode = "RGB"
    before = resource.getrusage(resource.RUSAGE_SELF)
    bpy.ops.render.render(write_still=True)
    after = resource.getrusage(resource.RUSAGE_SELF)
    print(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, flush=True)
    # What Blender does at its end is not asked for.
    os._exit(0)


if __name__ == "__main__":
    main()
