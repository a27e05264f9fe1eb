#!/usr/bin/env python3
"""Efficiency of guided renders of scenes with media, over unguided ones and over Mitsuba 3, as a Markdown table.

Efficiency is 1 / (relMSE x seconds of all processors), of pixels without the worst thousandth and of the means of 4 x 4 and
16 x 16 pixels; all ways take --spp samples. Seconds here are those of the whole process, loading and learning included;
Mitsuba's (the integrator that the file names, LLVM mode) those of the render, kernels compiled. Files have the parameters
resx and resy. Errors are taken against two guided references of other seeds, as in default.py.

    pip install mitsuba==3.9.1 numpy OpenImageIO      # and LLVM: apt-get install libllvm19
    python3 tests/bench/media.py [--width 120] [--spp 64] [--seeds 2] SCENE.xml...
"""
import argparse
import glob
import os
import pathlib
import resource
import tempfile

import numpy as np

from default import ROOT, pixels, processor_seconds, relmse
from variance import blocks

llvm = sorted(glob.glob("/usr/lib/*/libLLVM-19.so") + glob.glob("/usr/lib/*/libLLVM.so.19*"))
if llvm:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", llvm[0])
GUIDED = ["--guide", "double", "--trial", "never"]


def ours(args, scene, out, spp, seed, how):
    """Renders here; processor seconds."""
    return processor_seconds([args.program, "render", scene, "-o", out, "--quiet", "--format", "float", "-j", args.threads,
                              "--width", args.width, "--spp", spp, "--seed", seed, *how])


class Theirs:
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
    """Of trimmed pixels and of blocks."""
    found = [relmse(blocks(image, n), *(blocks(r, n) for r in references))[0] for n in (4, 16)]
    return np.array([relmse(image, *references)[1], *found])


def row(args, scene, folder):
    """A row of the table."""
    out, references = folder / "a.exr", []
    for seed in (977, 978):
        ours(args, scene, out, args.reference_spp, seed, GUIDED)
        references.append(pixels(out))
    theirs = Theirs(args, scene, references[0].shape)
    costs = {"guided": [], "none": [], "theirs": []}
    for seed in range(1, args.seeds + 1):
        for way, how in {"guided": GUIDED, "none": ["--guide", "none"]}.items():
            seconds = ours(args, scene, out, args.spp, seed, how)
            costs[way].append(seconds * errors(pixels(out), references))
        image, seconds = theirs.render(args.spp, seed)
        costs["theirs"].append(seconds * errors(image, references))
    mean = {way: np.mean(cost, axis=0) for way, cost in costs.items()}
    cells = [f"{mean[way][k] / mean['guided'][k]:.2g}" for way in ("theirs", "none") for k in range(3)]
    return f"| {scene.parent.name}/{scene.stem}, {args.width} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--width", type=int, default=120)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--program", default=ROOT / "target/release/twintree")
    args = parser.parse_args()
    print("| scene, pixels wide | over Mitsuba: pixels | 4 x 4 | 16 x 16 | over `--guide none`: pixels | 4 x 4 | 16 x 16 |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in args.scenes:
            print(row(args, scene, pathlib.Path(folder)), flush=True)


if __name__ == "__main__":
    main()
