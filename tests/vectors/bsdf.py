"""Writes tests/vectors/bsdf.json: values of Mitsuba 3's scattering models to compare ours with.

Run:  python tests/vectors/bsdf.py > tests/vectors/bsdf.json   (pip install mitsuba; made with 3.9.1)

Mitsuba's `si.wi` is our `wo`, its `wo` our `wi`; both are local directions on a flat surface whose
frame is the identity. Radiance mode.
"""

import json
from pathlib import Path

import mitsuba as mi

mi.set_variant("scalar_rgb")


def rgb(*v):
    return {"type": "rgb", "value": list(v)}


GOLD = {"eta": rgb(0.143, 0.375, 1.442), "k": rgb(3.983, 2.386, 1.603)}
BASE = rgb(0.7, 0.4, 0.1)


def rough(kind, **more):
    return {"type": kind, **more}


MODELS = {
    "diffuse": {"type": "diffuse", "reflectance": rgb(0.2, 0.5, 0.8)},
    "rough_conductor_beckmann": rough("roughconductor", distribution="beckmann", alpha=0.2, **GOLD),
    "rough_conductor_ggx": rough("roughconductor", distribution="ggx", alpha=0.3, **GOLD),
    "rough_conductor_anisotropic": rough(
        "roughconductor", distribution="ggx", alpha_u=0.15, alpha_v=0.5, **GOLD
    ),
    "rough_conductor_beckmann_anisotropic": rough(
        "roughconductor", distribution="beckmann", alpha_u=0.4, alpha_v=0.1, **GOLD
    ),
    "rough_dielectric_beckmann": rough(
        "roughdielectric", distribution="beckmann", alpha=0.25, int_ior=1.5, ext_ior=1.0
    ),
    "rough_dielectric_ggx": rough(
        "roughdielectric", distribution="ggx", alpha_u=0.3, alpha_v=0.6, int_ior=1.33, ext_ior=1.0
    ),
    "plastic": rough(
        "plastic", int_ior=1.49, ext_ior=1.0, diffuse_reflectance=BASE, nonlinear=False
    ),
    "plastic_nonlinear": rough(
        "plastic", int_ior=1.49, ext_ior=1.0, diffuse_reflectance=BASE, nonlinear=True
    ),
    "rough_plastic_beckmann": rough(
        "roughplastic", distribution="beckmann", alpha=0.15, int_ior=1.49, ext_ior=1.0,
        diffuse_reflectance=BASE, nonlinear=False,
    ),
    "rough_plastic_ggx": rough(
        "roughplastic", distribution="ggx", alpha=0.4, int_ior=1.7, ext_ior=1.0,
        diffuse_reflectance=BASE, nonlinear=True,
    ),
    "principled_metal": rough(
        "principled", base_color=BASE, roughness=0.4, anisotropic=0.6, metallic=0.7, spec_tint=0.4,
        clearcoat=0.6, clearcoat_gloss=0.3, eta=1.5,
    ),
    "principled_cloth": rough(
        "principled", base_color=BASE, roughness=0.7, sheen=0.8, sheen_tint=0.5, flatness=0.6, eta=1.4,
    ),
    "principled_glass": rough(
        "principled", base_color=BASE, roughness=0.5, spec_trans=0.8, metallic=0.1, spec_tint=0.3, eta=1.5,
    ),
    "principled_thin": rough(
        "principledthin", base_color=BASE, roughness=0.5, anisotropic=0.4, spec_trans=0.6, eta=1.4,
        spec_tint=0.3, sheen=0.5, sheen_tint=0.5, flatness=0.4, diff_trans=0.7,
    ),
    "blend": {
        "type": "blendbsdf",
        "weight": 0.3,
        "first": {"type": "diffuse", "reflectance": rgb(0.2, 0.5, 0.8)},
        "second": rough("roughconductor", distribution="ggx", alpha=0.3, **GOLD),
    },
    "normal_map": {
        "type": "normalmap",
        "normalmap": rgb(0.65, 0.42, 0.9),
        "bsdf": rough("roughconductor", distribution="ggx", alpha_u=0.15, alpha_v=0.5, **GOLD),
    },
    "two_sided": {
        "type": "twosided",
        "bsdf": {"type": "diffuse", "reflectance": rgb(0.2, 0.5, 0.8)},
    },
}

# Tables by measured/measured.py, asked for more directions than the closed forms.
MEASURED = {
    name: {"type": "measured", "filename": str(Path(__file__).parent / "measured" / file)}
    for name, file in (("measured", "isotropic.bsdf"), ("measured_anisotropic", "anisotropic.bsdf"))
}

SMOOTH = {
    "dielectric": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0},
    "thin_dielectric": {"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0},
    "conductor": rough("conductor", **GOLD),
    "plastic": rough("plastic", int_ior=1.49, ext_ior=1.0, diffuse_reflectance=BASE),
}

# Bump maps by the gradient of their displacement in (u, v).
BUMPS = [(0.0, 0.0), (0.3, -0.2), (-1.5, 0.4)]

OUT = [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-0.3, 0.7, 0.4), (0.55, -0.8, 0.1), (0.2, 0.5, -0.7), (-0.9, 0.1, -0.2)]
IN = [(0.1, -0.05, 1.0), (-0.6, 0.1, 0.8), (0.3, -0.7, 0.5), (0.5, 0.5, 0.1), (-0.3, -0.4, -0.8), (0.6, -0.1, -0.3)]
# Over all quarters, from the normal to grazing.
AROUND = [(0.001, 0.001, 1), (-0.5, 0.2, 1), (-1, -0.6, 1), (0.8, -1.9, 1), (3, 2, 1), (-1, 9, 1), (-0.02, -0.04, 1), (20, -5, 1)]


def normalized(v):
    n = sum(x * x for x in v) ** 0.5
    return mi.Vector3f([x / n for x in v])


def interaction(wo):
    si = mi.SurfaceInteraction3f()
    si.t = 1.0
    si.p = [0, 0, 0]
    si.n = [0, 0, 1]
    si.uv = [0.35, 0.6]
    si.dp_du = [1, 0, 0]
    si.dp_dv = [0, 1, 0]
    si.sh_frame = mi.Frame3f([1, 0, 0], [0, 1, 0], [0, 0, 1])
    si.wi = wo
    return si


def ramp(gu, gv):
    """A displacement with a constant gradient around uv = (0.35, 0.6)."""
    n = 5
    rows = [[[4.0 + gu * (x + 0.5) / n + gv * (y + 0.5) / n] for x in range(n)] for y in range(n)]
    t = mi.TensorXf([c for row in rows for px in row for c in px], (n, n, 1))
    return {"type": "bitmap", "bitmap": mi.Bitmap(t), "raw": True, "filter_type": "bilinear"}


def short(x):
    return float(f"{float(x):.7g}")


def triple(v):
    return [short(x) for x in v]


def evaluations(bsdf, out, into):
    """Rows of [wo, wi, eval, pdf]; pairs that scatter nothing are left out."""
    ctx = mi.BSDFContext()
    rows = []
    for wo in map(normalized, out):
        for wi in map(normalized, into):
            si = interaction(wo)
            value, pdf = bsdf.eval(ctx, si, wi), bsdf.pdf(ctx, si, wi)
            if max(value) > 1e-7:
                rows.append([triple(wo), triple(wi), triple(value), short(pdf)])
    return rows


def bump(gu, gv):
    inner = rough("roughconductor", distribution="ggx", alpha_u=0.15, alpha_v=0.5, **GOLD)
    bsdf = mi.load_dict({"type": "bumpmap", "texture": ramp(gu, gv), "bsdf": inner})
    return {"gradient": [gu, gv], "rows": evaluations(bsdf, OUT[:4], IN[:4])}


def samples(name, bsdf):
    """Rows of [wo, number that chooses the lobe, wi, weight, pdf, eta] of samples with a value."""
    rows = []
    for wo in map(normalized, OUT):
        # Plastic's second lobe is diffuse: that is compared by value.
        for u in (0.01,) if name == "plastic" else (0.01, 0.999):
            s, w = bsdf.sample(mi.BSDFContext(), interaction(wo), u, [0.3, 0.6])
            if max(w) > 0:
                rows.append([triple(wo), u, triple(s.wo), triple(w), short(s.pdf), short(s.eta)])
    return rows


def write(value, depth=0):
    """JSON with one row a line."""
    if isinstance(value, dict):
        inner = (f"{json.dumps(k)}: {write(v, depth + 1)}" for k, v in value.items())
        return "{\n" + ",\n".join(inner) + "\n}"
    if isinstance(value, list) and value and isinstance(value[0], (list, dict)) and depth < 3:
        return "[\n" + ",\n".join(write(v, 3) for v in value) + "\n]"
    return json.dumps(value)


def all_evaluations():
    rows = {n: evaluations(mi.load_dict(d), OUT, IN) for n, d in MODELS.items()}
    # Along x Mitsuba's azimuth is pi where the tables have -pi.
    out = [w for w in OUT + AROUND if w[1] != 0 or w[0] == 0]
    measured = {n: evaluations(mi.load_dict(d), out, IN + AROUND) for n, d in MEASURED.items()}
    return rows | measured


print(
    write(
        {
            "evaluations": all_evaluations(),
            "bumps": [bump(*g) for g in BUMPS],
            "samples": {n: samples(n, mi.load_dict(d)) for n, d in SMOOTH.items()},
        }
    )
)
