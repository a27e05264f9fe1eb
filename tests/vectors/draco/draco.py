"""Writes the files of this directory: a torus by trimesh, and the same compressed by Draco's own programs
(Debian's package draco): pip install trimesh numpy
"""

import subprocess

import numpy as np
import trimesh

u, v = np.meshgrid(np.linspace(0, 1, 25), np.linspace(0, 1, 13), indexing="ij")
a, b = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
ring = np.stack([np.cos(a), 0 * a, np.sin(a)], -1)
normal = ring * np.cos(b)[:, None] + np.array([0, 1, 0]) * np.sin(b)[:, None]
corner = np.arange(25 * 13).reshape(25, 13)
quads = [corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]]
p, q, r, s = [c.ravel() for c in quads]
faces = np.concatenate([np.stack([p, q, r], -1), np.stack([p, r, s], -1)])
mesh = trimesh.Trimesh(ring + 0.4 * normal, faces, vertex_normals=normal, process=False)
uv = np.stack([u.ravel(), v.ravel()], -1)
material = trimesh.visual.material.PBRMaterial(baseColorFactor=[200, 100, 50, 255])
mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
mesh.export("torus.glb", include_normals=True)
subprocess.run(["draco_transcoder", "-i", "torus.glb", "-o", "edgebreaker.glb", "-qp", "14"], check=True)
