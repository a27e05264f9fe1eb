#!/usr/bin/env python3
"""Turns a USD stage (.usd .usda .usdc .usdz) into glTF, which twintree renders: pip install usd-core numpy

    python3 tests/usd/usd_to_gltf.py STAGE OUT.glb [--time CODE]

Read are meshes (with their subsets of materials), transforms, instances, visibility and purposes,
UsdPreviewSurface with images, vertex colours (displayColor), perspective and orthographic cameras,
distant and sphere lights. Everything else is named on standard error. Surfaces of subdivision are
taken as the polygons of their cage. The stage's upAxis and metersPerUnit are applied.
"""

import argparse
import json
import math
import os
import struct
import sys

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade

FLOAT, UINT = 5126, 5125
MIME = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".webp": "image/webp"}


def tell(prim, message):
    print(f"usd_to_gltf: {prim.GetPath()}: {message}", file=sys.stderr)


class Gltf:
    """A glTF file under construction: the JSON and the bytes of its buffer."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "usd_to_gltf.py"}, "scene": 0}
        self.images = {}

    def add(self, kind, value):
        items = self.json.setdefault(kind, [])
        items.append(value)
        return len(items) - 1

    def view(self, data):
        self.bytes.extend(b"\0" * (-len(self.bytes) % 4))
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)}
        self.bytes.extend(data)
        return self.add("bufferViews", view)

    def accessor(self, array, component):
        array = np.ascontiguousarray(array, np.float32 if component == FLOAT else np.uint32)
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        accessor = {"bufferView": self.view(array.tobytes()), "componentType": component,
                    "count": len(array), "type": kind}
        if kind == "VEC3":
            accessor["min"] = array.min(0).tolist()
            accessor["max"] = array.max(0).tolist()
        return self.add("accessors", accessor)

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def image(self, path, data):
        if path not in self.images:
            ending = os.path.splitext(path)[1].lower()
            source = {"bufferView": self.view(data), "name": os.path.basename(path)}
            if ending in MIME:
                source["mimeType"] = MIME[ending]
            self.images[path] = self.add("images", source)
        return self.images[path]

    def save(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.bytes) + b"\0" * (-len(self.bytes) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(body), b"BIN\0") + body)


def rows(matrix):
    """glTF's column-major matrix of column vectors is USD's row-major one of row vectors."""
    return [matrix[i][j] for i in range(4) for j in range(4)]


class Converter:
    def __init__(self, stage, time):
        self.stage, self.time = stage, time
        self.gltf = Gltf()
        self.materials = {}
        self.meshes = {}

    def get(self, attribute, default=None):
        value = attribute.Get(self.time) if attribute else None
        return default if value is None else value

    # --- materials ----------------------------------------------------------------------------------

    def texture(self, shader, prim):
        """The glTF texture of a UsdUVTexture, and the name of its texture coordinates."""
        file = self.get(shader.GetInput("file"), Sdf.AssetPath())
        path = file.resolvedPath or file.path
        try:
            from pxr import Ar

            asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
            data = bytes(asset.GetBuffer())
        except Exception as error:
            tell(prim, f"the image {file.path} cannot be read and is left out ({error})")
            return None
        wraps = {"repeat": 10497, "mirror": 33648, "clamp": 33071}
        wrap = [self.get(shader.GetInput(w), "repeat") for w in ("wrapS", "wrapT")]
        sampler = self.gltf.add("samplers", {k: wraps.get(str(w), 10497) for k, w in zip(("wrapS", "wrapT"), wrap)})
        source = self.gltf.image(path.split("[")[-1].rstrip("]"), data)
        return self.gltf.add("textures", {"source": source, "sampler": sampler})

    def input(self, shader, name, default, prim):
        """The value of an input, and the texture that it is connected to with the channel."""
        given = shader.GetInput(name)
        if not given:
            return default, None, None
        source = given.GetConnectedSource() if given.HasConnectedSource() else None
        if source is None:
            return self.get(given, default), None, None
        other = UsdShade.Shader(source[0].GetPrim())
        kind = self.get(other.GetPrim().GetAttribute("info:id"), "")
        if kind == "UsdUVTexture":
            return default, self.texture(other, prim), source[1]
        if kind.startswith("UsdPrimvarReader") and name == "diffuseColor":
            return default, None, None
        tell(prim, f"{name} comes from {kind or 'an unknown shader'}, which is left out")
        return default, None, None

    def material(self, material, prim):
        key = str(material.GetPath())
        if key in self.materials:
            return self.materials[key]
        source = material.ComputeSurfaceSource("")
        shader = source[0] if isinstance(source, tuple) else source
        kind = self.get(shader.GetPrim().GetAttribute("info:id"), "") if shader else ""
        made = {"name": material.GetPrim().GetName(), "doubleSided": True}
        if kind != "UsdPreviewSurface":
            tell(material.GetPrim(), f"its surface is {kind or 'none'}, not UsdPreviewSurface: grey instead")
            made["pbrMetallicRoughness"] = {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}
            self.materials[key] = self.gltf.add("materials", made)
            return self.materials[key]
        of = lambda name, default: self.input(shader, name, default, material.GetPrim())
        color, color_map, _ = of("diffuseColor", Gf.Vec3f(0.18))
        opacity, opacity_map, _ = of("opacity", 1.0)
        metallic, metallic_map, metallic_channel = of("metallic", 0.0)
        roughness, roughness_map, roughness_channel = of("roughness", 0.5)
        pbr = {"baseColorFactor": [*(color if color_map is None else (1, 1, 1)), opacity],
               "metallicFactor": metallic, "roughnessFactor": roughness}
        if color_map is not None:
            pbr["baseColorTexture"] = {"index": color_map}
        # glTF reads roughness in green and metalness in blue of one image.
        grey = roughness_channel == "r" and metallic == 0 and metallic_map is None
        if grey:
            tell(material.GetPrim(), "the image of roughness is taken as grey")
        if roughness_map is not None and (grey or roughness_channel in ("g", "rgb")):
            pbr["metallicRoughnessTexture"] = {"index": roughness_map}
            pbr["roughnessFactor"] = 1
            if metallic_map is not None:
                pbr["metallicFactor"] = 1
        elif roughness_map is not None:
            tell(material.GetPrim(), f"roughness is in channel {roughness_channel} of its image: 0.5 instead")
        if metallic_map is not None and (metallic_map != roughness_map or metallic_channel != "b"):
            tell(material.GetPrim(), "metallic has an image of its own, which is left out")
        made["pbrMetallicRoughness"] = pbr
        _, normal_map, _ = of("normal", None)
        if normal_map is not None:
            made["normalTexture"] = {"index": normal_map}
        glow, glow_map, _ = of("emissiveColor", Gf.Vec3f(0))
        if glow_map is not None:
            made["emissiveTexture"], made["emissiveFactor"] = {"index": glow_map}, [1, 1, 1]
        elif max(glow) > 0:
            made["emissiveFactor"] = list(glow)
        cutoff = of("opacityThreshold", 0.0)[0]
        if cutoff > 0:
            made["alphaMode"], made["alphaCutoff"] = "MASK", cutoff
        elif opacity < 1 or opacity_map is not None:
            made["alphaMode"] = "BLEND"
        extensions = {"KHR_materials_ior": {"ior": of("ior", 1.5)[0]}}
        coat = of("clearcoat", 0.0)[0]
        if coat > 0:
            roughness = of("clearcoatRoughness", 0.01)[0]
            extensions["KHR_materials_clearcoat"] = {"clearcoatFactor": coat, "clearcoatRoughnessFactor": roughness}
        if of("useSpecularWorkflow", 0)[0]:
            tell(material.GetPrim(), "the specular workflow is taken as the metallic one")
        for name in extensions:
            self.gltf.use(name)
        made["extensions"] = extensions
        self.materials[key] = self.gltf.add("materials", made)
        return self.materials[key]

    # --- meshes -------------------------------------------------------------------------------------

    def primvar(self, mesh, names, counts, indices):
        """A primvar's value at each corner of each face."""
        api = UsdGeom.PrimvarsAPI(mesh)
        for name in names:
            primvar = api.GetPrimvar(name)
            if not primvar or not primvar.HasValue():
                continue
            values = np.array(primvar.ComputeFlattened(self.time))
            how = primvar.GetInterpolation()
            if how == UsdGeom.Tokens.constant:
                return np.repeat(values[:1], len(indices), 0)
            if how == UsdGeom.Tokens.uniform:
                return np.repeat(values, counts, 0)
            return values[indices] if how in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying) else values
        return None

    def mesh(self, prim):
        mesh = UsdGeom.Mesh(prim)
        points = np.array(self.get(mesh.GetPointsAttr(), []), np.float32).reshape(-1, 3)
        counts = np.array(self.get(mesh.GetFaceVertexCountsAttr(), []), np.int64)
        indices = np.array(self.get(mesh.GetFaceVertexIndicesAttr(), []), np.int64)
        if len(points) == 0 or counts.sum() != len(indices) or len(indices) == 0 or indices.max() >= len(points):
            tell(prim, "it has no faces that make sense and is left out")
            return None
        if self.get(mesh.GetSubdivisionSchemeAttr(), "catmullClark") != "none":
            normals = None
        else:
            normals = self.primvar(mesh, ["normals"], counts, indices)
            if normals is None and mesh.GetNormalsAttr().HasAuthoredValue():
                values = np.array(self.get(mesh.GetNormalsAttr()))
                normals = values[indices] if len(values) == len(points) else values
                normals = normals if len(normals) == len(indices) else None
        corners = {"POSITION": points[indices]}
        if normals is not None and len(normals) == len(indices):
            corners["NORMAL"] = normals
        uv = self.primvar(mesh, ["st", "st0", "UVMap", "uv", "map1"], counts, indices)
        if uv is not None and len(uv) == len(indices):
            corners["TEXCOORD_0"] = np.stack([uv[:, 0], 1 - uv[:, 1]], -1)
        color = self.primvar(mesh, ["displayColor"], counts, indices)
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        if color is not None and len(color) == len(indices) and not bound:
            corners["COLOR_0"] = color
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        left_handed = self.get(mesh.GetOrientationAttr(), "rightHanded") == "leftHanded"
        taken = np.zeros(len(counts), bool)
        parts = []
        for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
            faces = np.array(self.get(subset.GetIndicesAttr(), []), np.int64)
            faces = faces[faces < len(counts)]
            taken[faces] = True
            parts.append((faces, UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]))
        parts.append((np.flatnonzero(~taken), bound))
        primitives = []
        for faces, material in parts:
            triangles = [(starts[f], starts[f] + i, starts[f] + i + 1)
                         for f in faces for i in range(1, counts[f] - 1)]
            if not triangles:
                continue
            triangles = np.array(triangles)
            if left_handed:
                triangles = triangles[:, [0, 2, 1]]
            used, renumbered = np.unique(triangles, return_inverse=True)
            primitive = {"attributes": {k: self.gltf.accessor(v[used], FLOAT) for k, v in corners.items()},
                         "indices": self.gltf.accessor(renumbered.ravel(), UINT)}
            if material:
                primitive["material"] = self.material(material, prim)
            primitives.append(primitive)
        return self.gltf.add("meshes", {"name": prim.GetName(), "primitives": primitives}) if primitives else None

    # --- cameras and lights -------------------------------------------------------------------------

    def camera(self, prim):
        frustum = UsdGeom.Camera(prim).GetCamera(self.time)
        near, far = frustum.clippingRange.min, frustum.clippingRange.max
        aperture = frustum.horizontalAperture, frustum.verticalAperture
        if frustum.projection == Gf.Camera.Orthographic:
            # Apertures are in tenths of a unit.
            made = {"type": "orthographic", "orthographic": {"xmag": aperture[0] / 20, "ymag": aperture[1] / 20,
                    "znear": near, "zfar": far}}
        else:
            made = {"type": "perspective", "perspective": {"aspectRatio": aperture[0] / aperture[1],
                    "yfov": 2 * math.atan(0.5 * aperture[1] / frustum.focalLength), "znear": near, "zfar": far}}
        if frustum.horizontalApertureOffset or frustum.verticalApertureOffset:
            tell(prim, "the offset of the aperture is left out: glTF has none")
        return self.gltf.add("cameras", made | {"name": prim.GetName()})

    def light(self, prim):
        light = UsdLux.LightAPI(prim)
        power = self.get(light.GetIntensityAttr(), 1.0) * 2 ** self.get(light.GetExposureAttr(), 0.0)
        made = {"name": prim.GetName(), "color": list(self.get(light.GetColorAttr(), Gf.Vec3f(1)))}
        if prim.IsA(UsdLux.DistantLight):
            # The intensity is the radiance of a disk of that angle; unless normalised.
            half = math.radians(self.get(UsdLux.DistantLight(prim).GetAngleAttr(), 0.53)) / 2
            normalized = self.get(light.GetNormalizeAttr(), False)
            made |= {"type": "directional", "intensity": power * (1 if normalized else math.pi * math.sin(half) ** 2)}
        elif prim.IsA(UsdLux.SphereLight):
            # A sphere of radiance L looks from afar like a point of intensity L pi r^2.
            # Normalised, L is divided by the surface 4 pi r^2.
            radius = self.get(UsdLux.SphereLight(prim).GetRadiusAttr(), 0.5)
            normalized = self.get(light.GetNormalizeAttr(), False)
            made |= {"type": "point", "intensity": power * (0.25 if normalized else math.pi * radius**2)}
        else:
            tell(prim, f"a light of type {prim.GetTypeName()} is left out")
            return None
        self.gltf.use("KHR_lights_punctual")
        lights = self.gltf.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})
        lights["lights"].append(made)
        return len(lights["lights"]) - 1

    # --- the tree -----------------------------------------------------------------------------------

    def node(self, prim):
        image = UsdGeom.Imageable(prim)
        if image and image.GetVisibilityAttr().Get(self.time) == UsdGeom.Tokens.invisible:
            return None
        if image and image.ComputePurpose() in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide):
            return None
        node = {"name": prim.GetName()}
        if prim.IsA(UsdGeom.Xformable):
            matrix = UsdGeom.Xformable(prim).GetLocalTransformation(self.time)
            if matrix != Gf.Matrix4d(1):
                node["matrix"] = rows(matrix)
        if prim.IsA(UsdGeom.Mesh):
            key = prim.GetPrimInPrototype().GetPath() if prim.IsInstanceProxy() else prim.GetPath()
            if key not in self.meshes:
                self.meshes[key] = self.mesh(prim)
            if self.meshes[key] is not None:
                node["mesh"] = self.meshes[key]
        elif prim.IsA(UsdGeom.Camera):
            node["camera"] = self.camera(prim)
        elif prim.HasAPI(UsdLux.LightAPI):
            light = self.light(prim)
            if light is not None:
                node["extensions"] = {"KHR_lights_punctual": {"light": light}}
        elif prim.IsA(UsdGeom.Gprim):
            tell(prim, f"a {prim.GetTypeName()} is left out: only meshes are read")
        elif prim.IsA(UsdGeom.PointInstancer):
            tell(prim, "a PointInstancer is left out")
            return None
        children = prim.GetFilteredChildren(Usd.TraverseInstanceProxies())
        children = [self.node(child) for child in children if not child.IsA(UsdShade.Material)]
        children = [child for child in children if child is not None]
        if children:
            node["children"] = children
        return self.gltf.add("nodes", node)

    def convert(self):
        roots = self.stage.GetPseudoRoot().GetFilteredChildren(Usd.TraverseInstanceProxies())
        roots = [self.node(prim) for prim in roots if not prim.IsA(UsdShade.Material)]
        top = {"name": "stage", "children": [r for r in roots if r is not None]}
        scale = UsdGeom.GetStageMetersPerUnit(self.stage)
        top["scale"] = [scale] * 3
        if UsdGeom.GetStageUpAxis(self.stage) == UsdGeom.Tokens.z:
            top["rotation"] = [-math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
        self.gltf.json["scenes"] = [{"nodes": [self.gltf.add("nodes", top)]}]
        return self.gltf


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage")
    parser.add_argument("out")
    parser.add_argument("--time", type=float, help="time code of what is animated")
    args = parser.parse_args()
    stage = Usd.Stage.Open(args.stage)
    time = Usd.TimeCode.Default() if args.time is None else Usd.TimeCode(args.time)
    Converter(stage, time).convert().save(args.out)


if __name__ == "__main__":
    main()
