"""Writes tests/vectors/pbrt_spectra.txt: what pbrt-v4's named spectra come to, to compare ours with.

Run:  python tests/vectors/pbrt_spectra.py spectrum.cpp > tests/vectors/pbrt_spectra.txt
(src/pbrt/util/spectrum.cpp of pbrt-v4, github.com/mmp/pbrt-v4 at commit 5f7a6068)

    metal NAME      reflectance at normal incidence and its mean over a hemisphere under the cosine,
                    each in linear sRGB under D65 (the exact equations of Fresnel at every nanometre)
    glass NAME      index of refraction at 587.6 nm
    illuminant NAME chromaticity (x, y)
"""

import math
import re
import sys

SOURCE = open(sys.argv[1]).read()
TO_SRGB = [
    [3.240479, -1.537150, -0.498535],
    [-0.969256, 1.875991, 0.041556],
    [0.055648, -0.204043, 1.057311],
]


def table(name):
    body = re.search(r"const Float %s\[\w*\] = \{(.*?)\};" % name, SOURCE, re.S).group(1)
    body = re.sub(r"//[^\n]*", "", body)
    return [float(x) for x in re.findall(r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?", body)]


def curve(name):
    """As pbrt reads it: linear between samples, the outermost values beyond them."""
    flat = table(name)
    samples = sorted(zip(flat[::2], flat[1::2]))

    def at(nm):
        if nm <= samples[0][0]:
            return samples[0][1]
        for (w0, v0), (w1, v1) in zip(samples, samples[1:]):
            if nm <= w1:
                return v0 + (v1 - v0) * (nm - w0) / (w1 - w0)
        return samples[-1][1]

    return at


NM = [int(w) for w in table("CIE_lambda")]
OBSERVER = list(zip(*(table("CIE_" + axis) for axis in "XYZ")))
D65 = curve("CIE_Illum_D6500")


def xyz(spectrum):
    values = [spectrum(nm) for nm in NM]
    return [sum(v * o[i] for v, o in zip(values, OBSERVER)) for i in range(3)]


WHITE = xyz(D65)[1]


def seen(reflectance):
    color = [c / WHITE for c in xyz(lambda nm: reflectance(nm) * D65(nm))]
    return [sum(m * c for m, c in zip(row, color)) for row in TO_SRGB]


def fresnel(cos, eta, k):
    sin2 = 1 - cos * cos
    t0 = eta * eta - k * k - sin2
    a2b2 = math.sqrt(t0 * t0 + 4 * eta * eta * k * k)
    t1, a = a2b2 + cos * cos, math.sqrt(max(0, 0.5 * (a2b2 + t0)))
    t2 = 2 * cos * a
    rs = (t1 - t2) / (t1 + t2)
    t3, t4 = cos * cos * a2b2 + sin2 * sin2, t2 * sin2
    return 0.5 * rs * (1 + (t3 - t4) / (t3 + t4))


def mean(eta, k, n=64):
    # The squares of cosines are uniform under the cosine.
    return sum(fresnel(math.sqrt((i + 0.5) / n), eta, k) for i in range(n)) / n


def line(kind, name, numbers):
    print(kind, name, *("%.6g" % x for x in numbers))


for metal in ["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"]:
    eta, k = curve(metal + "_eta"), curve(metal + "_k")
    normal = seen(lambda nm: fresnel(1, eta(nm), k(nm)))
    whole = seen(lambda nm: mean(eta(nm), k(nm)))
    line("metal", metal, normal + whole)

# The names pbrt gives them: what it calls F5, F10 and F11 are the curves of SF5, SF10 and SF11.
NAMED = dict(re.findall(r'\{"glass-(\w+)", glass(\w+)eta\}', SOURCE))
CURVES = {name.lower(): name for name in re.findall(r"Glass(\w+)_eta\[", SOURCE)}
for name, variable in NAMED.items():
    line("glass", name, [curve("Glass%s_eta" % CURVES[variable])(587.6)])

ILLUMINANTS = {"stdillum-A": "CIE_Illum_A", "stdillum-D50": "CIE_Illum_D5000"}
ILLUMINANTS |= {"stdillum-D65": "CIE_Illum_D6500", "illum-acesD60": "ACES_Illum_D60"}
ILLUMINANTS |= {"stdillum-F%d" % i: "CIE_Illum_F%d" % i for i in range(1, 13)}
for name, variable in ILLUMINANTS.items():
    x, y, z = xyz(curve(variable))
    line("illuminant", name, [x / (x + y + z), y / (x + y + z)])
