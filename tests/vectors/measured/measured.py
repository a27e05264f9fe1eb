"""Writes isotropic.bsdf and anisotropic.bsdf: tables of a metal of GGX facets in the format of the
RGL's material database (Dupuy and Jakob 2018), as its measurements are stored.

Run:  python tests/vectors/measured/measured.py   (pip install numpy)

Facets scatter f cos(o) = F G2(i, o) D(m) / (4 cos(i)) (Walter et al. 2007, Heitz 2014). With the
projected area sigma(i) = cos(i) / G1(i) and the density of visible normals that a file holds, what is
left for its table of colours is F(i, m) G2(i, o) / G1(i), over the square from which normals are drawn.
"""

import struct
from pathlib import Path

import numpy as np

TYPES = {np.dtype(np.uint8): 1, np.dtype(np.float32): 10}
# Reflectance of the facets at normal incidence.
COLOR = np.array([0.95, 0.7, 0.35])


def tensor_file(fields):
    """Header: magic, version, how many fields. Each: its name, dimensions, type, where its values are."""
    head = b"tensor_file\0" + struct.pack("<BBI", 1, 0, len(fields))
    size = len(head) + sum(2 + len(n) + 2 + 1 + 8 + 8 * v.ndim for n, v in fields.items())
    table, data = b"", b""
    for name, values in fields.items():
        # Values are aligned to eight bytes.
        data += bytes(-(size + len(data)) % 8)
        table += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HB", values.ndim, TYPES[values.dtype])
        table += struct.pack("<Q", size + len(data)) + struct.pack(f"<{values.ndim}Q", *values.shape)
        data += values.tobytes()
    return head + table + data


def direction(theta, phi):
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def ggx(m, alpha):
    scaled = (m[..., 0] / alpha[0]) ** 2 + (m[..., 1] / alpha[1]) ** 2 + m[..., 2] ** 2
    return 1 / (np.pi * alpha[0] * alpha[1] * scaled**2)


def smith(w, alpha):
    """Lambda of GGX."""
    cos2 = np.maximum(w[..., 2] ** 2, 1e-9)
    return 0.5 * (np.sqrt(1 + ((w[..., 0] * alpha[0]) ** 2 + (w[..., 1] * alpha[1]) ** 2) / cos2) - 1)


def square(rows, columns):
    """Elevations along a row, azimuths from row to row, and a solid angle over the square's area."""
    u = np.linspace(0, 1, columns)[None, :] * np.ones((rows, 1))
    v = np.linspace(0, 1, rows)[:, None] * np.ones((1, columns))
    theta, phi = u**2 * np.pi / 2, (2 * v - 1) * np.pi
    return theta, phi, 2 * np.pi**2 * u * np.sin(theta)


def inverse_warp(density, n):
    """Where n by n samples land: first the row by its mass, then the column in it, densities linear
    between the points of the table."""
    rows, columns = density.shape
    fine = 64
    y = np.linspace(0, rows - 1, (rows - 1) * fine + 1)
    x = np.linspace(0, columns - 1, (columns - 1) * fine + 1)
    below = np.minimum(y.astype(int), rows - 2)
    tall = density[below] * (1 - (y - below))[:, None] + density[below + 1] * (y - below)[:, None]
    left = np.minimum(x.astype(int), columns - 2)
    full = tall[:, left] * (1 - (x - left)) + tall[:, left + 1] * (x - left)

    def cumulative(values):
        steps = np.concatenate([[0], np.cumsum(0.5 * (values[1:] + values[:-1]))])
        return steps / steps[-1]

    us = np.linspace(0, 1, n)
    marginal = cumulative(full.sum(1))
    out = np.zeros((n, n, 2))
    for j, uy in enumerate(us):
        at = np.interp(uy, marginal, y)
        row = full[min(int(round(at * fine)), len(y) - 1)]
        out[j, :, 0] = np.interp(us, cumulative(row), x) / (columns - 1)
        out[j, :, 1] = at / (rows - 1)
    return out


def measured(alpha, azimuths, elevations, size, text):
    isotropic = len(azimuths) <= 2
    theta, phi, _ = square(*size)
    ndf = ggx(direction(theta, phi), alpha)
    wi = direction(theta, phi)
    sigma = np.maximum(wi[..., 2], 1e-4) * (1 + smith(wi, alpha))
    shape = (len(azimuths), len(elevations))
    vndf, luminance, rgb = np.zeros((*shape, *size)), np.zeros((*shape, *size)), np.zeros((*shape, 3, *size))
    for p, azimuth in enumerate(azimuths):
        for t, elevation in enumerate(elevations):
            i = direction(np.array(elevation), np.array(azimuth))
            theta, phi, jacobian = square(*size)
            m = direction(theta, phi + azimuth if isotropic else phi)
            # A floor, as measurements have one: no direction is impossible.
            vndf[p, t] = (ggx(m, alpha) * np.maximum(m @ i, 0) + 1e-3) * jacobian + 1e-4
            at = inverse_warp(vndf[p, t], size[0])
            turn = azimuth if isotropic else 0
            m = direction(at[..., 0] ** 2 * np.pi / 2, (2 * at[..., 1] - 1) * np.pi + turn)
            o = 2 * (m @ i)[..., None] * m - i
            above = np.clip(o[..., 2] * 8, 0, 1) * (m @ i > 0)
            shadowing = (1 + smith(i, alpha)) / (1 + smith(i, alpha) + smith(o, alpha))
            schlick = COLOR + (1 - COLOR) * (1 - np.clip(m @ i, 0, 1)[..., None]) ** 5
            color = schlick * (above * shadowing)[..., None] * 0.95
            rgb[p, t] = np.moveaxis(color, -1, 0)
            luminance[p, t] = color.mean(-1) + 0.02
    single = lambda v: np.ascontiguousarray(v, np.float32)
    return tensor_file({
        "description": np.frombuffer(text.encode(), np.uint8),
        "theta_i": single(elevations),
        "phi_i": single(azimuths),
        "ndf": single(ndf),
        "sigma": single(sigma),
        "vndf": single(vndf),
        "rgb": single(rgb),
        "luminance": single(luminance),
        "jacobian": np.array([1], np.uint8),
    })


here = Path(__file__).parent
elevations = np.array([0, 0.35, 0.75, 1.15, 1.5])
isotropic = measured((0.35, 0.35), [0.0], elevations, (16, 16), "GGX, isotropic")
(here / "isotropic.bsdf").write_bytes(isotropic)
# A quarter of the azimuths; the others are mirrored.
quarter = np.linspace(-np.pi, -np.pi / 2, 3)
anisotropic = measured((0.25, 0.5), quarter, elevations[::2], (16, 16), "GGX, anisotropic")
(here / "anisotropic.bsdf").write_bytes(anisotropic)
