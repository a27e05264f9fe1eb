"""Writes the vectors of this directory with meshoptimizer's own encoder: pip install almeshopt numpy

NAME.enc is compressed, NAME.raw what it decodes to. version1.mjs writes those of version 1.
"""

import almeshopt
import numpy as np


def save(name, encoded, raw):
    open(name + ".enc", "wb").write(encoded)
    open(name + ".raw", "wb").write(raw)


def grid(n):
    """Triangles of n by n quads, in an order that caches like, with a few that share nothing."""
    i = (np.arange(n)[:, None] * (n + 1) + np.arange(n)[None]).ravel()
    quads = [np.stack([i, i + n + 1, i + 1], -1), np.stack([i + 1, i + n + 1, i + n + 2], -1)]
    triangles = np.concatenate(quads).astype(np.uint32).ravel()
    triangles = almeshopt.optimize_vertex_cache(triangles, (n + 1) ** 2)
    odd = np.random.default_rng(5).permutation((n + 1) ** 2)[: 3 * n].astype(np.uint32)
    return np.concatenate([np.asarray(triangles, np.uint32).ravel(), odd])


indices = grid(20)
# The encoder turns triangles, so its own decoder says what comes out.
almeshopt.set_index_encoder_version(1)
encoded = almeshopt.encode_index_buffer(indices, 21 * 21)
decoded = np.asarray(almeshopt.decode_index_buffer(encoded, len(indices)), np.uint32)
save("triangles", bytes(encoded), decoded.tobytes())

# 300 vertices of 20 bytes: two blocks, the second with a group that is not full.
t = np.linspace(0, 6, 300, dtype=np.float32)
noise = np.random.default_rng(7).integers(0, 4, (300, 4)).astype(np.float32)
noise[100:160] = 0
vertices = np.stack([np.cos(t), np.sin(t), t, 0 * t, np.round(t)], -1).astype(np.float32)
vertices[:, 3] = noise[:, 0]
encoded = almeshopt.encode_vertex_buffer(vertices, version=0)
save("vertices", bytes(encoded), vertices.tobytes())

normals = np.random.default_rng(9).normal(size=(64, 3)).astype(np.float32)
normals /= np.linalg.norm(normals, axis=1, keepdims=True)
filtered = np.asarray(almeshopt.encode_filter_oct(normals, 8), np.uint8)
save("normals", filtered.tobytes(), normals.tobytes())
