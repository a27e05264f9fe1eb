#!/usr/bin/env python3
"""Efficiency of the default on scenes with media, over other ways and other programs, as a Markdown table.

Efficiency is 1 / (relMSE x seconds of all processors): of all pixels, of those without the worst thousandth, of the means of
4 x 4 and of 16 x 16 pixels. The default takes --spp samples, every other way as many as its seconds buy (what a way takes
is asked of a render with --spp). Seconds here are those of the whole process, loading and learning included; those of
Mitsuba (the integrator that the file names, LLVM mode) and of Blender Cycles those of the render, kernels compiled. Files
have the parameters resx and resy.

Errors are taken against two references of other seeds, as in default.py: guided ones, and for Cycles, whose materials are
not quite the same, two of its own, guided as well. `mean` is that of a program's first reference over ours.

    pip install mitsuba==3.9.1 numpy OpenImageIO      # and LLVM: apt-get install libllvm19
    python3 tests/bench/media.py [--width 120] [--spp 64] [--seeds 2] [--cycles PYTHON] SCENE.xml...

PYTHON is one that has bpy: see tests/bench/blender.py.
"""
import argparse
import glob
import os
import pathlib
import resource
import subprocess
import tempfile

import numpy as np

from default import ROOT, pixels, processor_seconds, relmse
from variance import blocks

llvm = sorted(glob.glob("/usr/lib/*/libLLVM-19.so") + glob.glob("/usr/lib/*/libLLVM.so.19*"))
if llvm:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", llvm[0])
GUIDED = ["--guide", "double", "--trial", "never"]


def ours(args, scene, out, spp, seed, how):
    """The picture, and processor seconds."""
    seconds = processor_seconds([args.program, "render", scene, "-o", out, "--quiet", "--format", "float", "-j", args.threads,
                                 "--width", args.width, "--spp", spp, "--seed", seed, *how])
    return pixels(out), seconds


def cycles(args, scene, out, spp, seed, how):
    """The same by Cycles."""
    command = [args.cycles, pathlib.Path(__file__).with_name("blender.py"), scene, "-o", out, "--threads", args.threads,
               "--width", args.width, "--spp", spp, "--seed", seed, *how]
    said = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    return pixels(out), float(said.split()[-1])


class Mitsuba:
    """A scene in Mitsuba."""

    def __init__(self, args, scene, shape):
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        import drjit as dr
        dr.set_thread_count(args.threads)
        self.mi = mi
        self.scene = mi.load_file(str(scene), resx=str(shape[1]), resy=str(shape[0]))
        self.render(args.spp, 0)

    def render(self, spp, seed):
        """The picture, and processor seconds."""
        def spent():
            usage = resource.getrusage(resource.RUSAGE_SELF)
            return usage.ru_utime + usage.ru_stime

        start = spent()
        image = np.array(self.mi.render(self.scene, spp=spp, seed=seed))[..., :3]
        return image.astype(np.float32), spent() - start


def errors(image, references):
    """Of pixels, trimmed pixels and blocks."""
    found = [relmse(blocks(image, n), *(blocks(r, n) for r in references))[0] for n in (4, 16)]
    return np.array([*relmse(image, *references), *found])


def ways(args, scene, out):
    """What is compared: a render by samples and seed, and references. The first is the default."""
    own = [ours(args, scene, out, args.reference_spp, seed, GUIDED)[0] for seed in (977, 978)]
    yield "default", lambda spp, seed: ours(args, scene, out, spp, seed, []), own
    yield "`--guide none`", lambda spp, seed: ours(args, scene, out, spp, seed, ["--guide", "none"]), own
    yield "Mitsuba", Mitsuba(args, scene, own[0].shape).render, own
    if args.cycles:
        theirs = [cycles(args, scene, out, args.cycles_spp, seed, ["--guided"])[0] for seed in (977, 978)]
        yield "Cycles", lambda spp, seed: cycles(args, scene, out, spp, seed, []), theirs
        yield "Cycles, guided", lambda spp, seed: cycles(args, scene, out, spp, seed, ["--guided"]), theirs


def rows(args, scene, folder):
    """The rows of a scene."""
    first = None
    for name, render, references in ways(args, scene, folder / "a.exr"):
        spp = args.spp
        if first:
            spp = max(1, round(spp * first[1] / render(spp, 0)[1]))
        found = []
        for seed in range(1, args.seeds + 1):
            image, seconds = render(spp, seed)
            found.append([seconds, *(seconds * errors(image, references))])
        mean = np.mean(found, axis=0)
        first = first or (mean[1:], mean[0], references[0].mean())
        cells = " | ".join(f"{gain:.2g}" for gain in mean[1:] / first[0])
        yield (f"| {scene.parent.name}/{scene.stem} | {name} | {spp} | {mean[0]:.1f} "
               f"| {references[0].mean() / first[2]:.3f} | {cells} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--width", type=int, default=120)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--program", default=ROOT / "target/release/twintree")
    parser.add_argument("--cycles", help="a Python that has bpy")
    parser.add_argument("--cycles-spp", type=int, default=2048, help="samples of Cycles' references")
    args = parser.parse_args()
    print("| scene | way | samples | seconds | mean | default's gain: pixels | trimmed | 4 x 4 | 16 x 16 |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in args.scenes:
            for row in rows(args, scene, pathlib.Path(folder)):
                print(row, flush=True)


if __name__ == "__main__":
    main()
