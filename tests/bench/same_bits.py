#!/usr/bin/env python3
"""Do two builds of the program make the same bits?

Renders the scenes of the project (and others, if they are named) with both programs, unguided, guided in several ways, and
trains fields; compares pixels and fields. For changes that move code and must not move a bit.

    pip install numpy OpenImageIO
    python3 tests/bench/same_bits.py BEFORE AFTER [--width 96] [--spp 24] [SCENE.xml...]

Exit code 1 if any file differs.
"""
import argparse
import hashlib
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN = [ROOT / "scenes" / name / f"{name}.xml"
       for name in ["caustic", "cornell", "door", "exact", "furnace", "materials", "pool"]]
AOVS = ["--aov", "albedo,normal,depth,variance,noise"]
WAYS = {
    "plain": ["render", "--guide", "none", *AOVS],
    "independent": ["render", "--guide", "none", "--sampler", "independent"],
    "guided": ["render", "--guide", "double", *AOVS],
    "always": ["render", "--guide", "double", "--trial", "never"],
    "constants": ["render", "--guide", "double", "--guide-model", "constant", "--trial", "never"],
    "unshared": ["render", "--guide", "double", "--trial", "never", "--reuse", "1", "--adaptive", "never"],
    "gmm": ["render", "--guide", "gmm", "--photons", "50000"],
    "ppg": ["render", "--guide", "ppg", "--trial", "never"],
    "field": ["train", "--photons", "30000", "--paths", "60000"],
}


def make(program, scene, way, args, folder):
    """The hash of what a program makes."""
    out = pathlib.Path(folder, "a.field" if way == "field" else "a.exr")
    command, *options = WAYS[way]
    size = [] if way == "field" else ["--width", str(args.width), "--spp", str(args.spp), "--format", "float"]
    subprocess.run([program, command, scene, "-o", out, "--quiet", "--seed", "7", *size, *options], check=True)
    if way == "field":
        return hashlib.sha256(out.read_bytes()).hexdigest()
    pixels = np.asarray(oiio.ImageBuf(str(out)).get_pixels(oiio.FLOAT))
    return hashlib.sha256(pixels.tobytes()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("scenes", nargs="*", default=OWN, type=pathlib.Path)
    parser.add_argument("--width", type=int, default=96)
    parser.add_argument("--spp", type=int, default=24)
    args = parser.parse_args()
    differ = 0
    with tempfile.TemporaryDirectory() as folder:
        for scene in args.scenes:
            for way in WAYS:
                before, after = (make(program, scene, way, args, folder) for program in [args.before, args.after])
                differ += before != after
                print(f"{scene.parent.name} {way}: {'same' if before == after else 'DIFFERENT'}", flush=True)
    raise SystemExit(f"{differ} differ" if differ else 0)


if __name__ == "__main__":
    main()
