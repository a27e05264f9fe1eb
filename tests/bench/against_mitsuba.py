#!/usr/bin/env python3
"""Samples per second of twintree and of Mitsuba 3 on the same scenes, in turn, as a Markdown table.

Both trace plain paths of depth 12 with roulette from 5, 320 pixels wide, box filter, independent
samples, the same number of threads. Mitsuba's time does not include compiling its kernels or loading.

    pip install mitsuba==3.9.1        # and LLVM: apt-get install libllvm19
    python3 tests/bench/against_mitsuba.py [--runs 3] [--spp 256] [--threads 2] SCENE.xml...
"""
import argparse, glob, json, os, statistics, subprocess, sys, tempfile, time

llvm = sorted(glob.glob("/usr/lib/*/libLLVM-19.so") + glob.glob("/usr/lib/*/libLLVM.so.19*"))
if llvm:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", llvm[0])


def defines(scene):
    """Scenes that leave the integrator open get the path tracer."""
    with open(scene, encoding="utf-8") as f:
        return ["integrator=path"] if "$integrator" in f.read() else []


def ours(program, scene, args):
    """Samples per second of one run of twintree, in millions."""
    with tempfile.TemporaryDirectory() as folder:
        stats, image = os.path.join(folder, "stats.json"), os.path.join(folder, "image.exr")
        command = [program, "render", scene, "-o", image, "--stats", stats, "--quiet", "--width", "320",
                   "--max-depth", "12", "--rr-depth", "5", "--rfilter", "box", "--sampler", "independent",
                   "--guide", "none", "--spp", str(args.spp), "-j", str(args.threads)]
        for define in defines(scene):
            command += ["-D", define]
        subprocess.run(command, check=True)
        with open(stats) as f:
            return json.load(f)["samples_per_second"] / 1e6


class Theirs:
    """A scene in Mitsuba 3's LLVM mode, kernels compiled."""

    def __init__(self, path, args):
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        import drjit as dr
        dr.set_thread_count(args.threads)
        self.mi, self.spp = mi, args.spp
        self.scene = mi.load_file(path, **dict(d.split("=", 1) for d in defines(path)))
        old = self.scene.sensors()[0]
        params = mi.traverse(old)
        size = old.film().size()
        self.width, self.height = 320, round(320 * size[1] / size[0])
        fov = params["x_fov"]
        matrix = params["to_world"].matrix
        import numpy as np
        to_world = np.array(matrix, dtype=np.float64).reshape(4, 4, -1)[..., 0]
        self.sensor = mi.load_dict({
            "type": "perspective", "fov_axis": "x", "fov": float(fov[0] if hasattr(fov, "__len__") else fov),
            "near_clip": old.near_clip(), "far_clip": old.far_clip(), "to_world": mi.ScalarTransform4f(to_world),
            "film": {"type": "hdrfilm", "width": self.width, "height": self.height, "pixel_format": "rgb",
                     "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"}})
        self.integrator = mi.load_dict({"type": "path", "max_depth": 12, "rr_depth": 5})
        self.render(4, 0)

    def render(self, spp, seed):
        import numpy as np
        return np.array(self.mi.render(self.scene, integrator=self.integrator, sensor=self.sensor, spp=spp, seed=seed))

    def rate(self, seed):
        start = time.time()
        self.render(self.spp, seed)
        return self.width * self.height * self.spp / (time.time() - start) / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    print("| scene | twintree, M samples/s | Mitsuba 3, M samples/s | ratio |\n|---|---|---|---|")
    for scene in args.scenes:
        peer = Theirs(scene, args)
        pairs = [(ours(args.program, scene, args), peer.rate(run + 1)) for run in range(args.runs)]
        a, b = (statistics.median(p[i] for p in pairs) for i in (0, 1))
        ratio = statistics.median(p[0] / p[1] for p in pairs)
        name = os.path.basename(os.path.dirname(os.path.abspath(scene)))
        print(f"| {name} | {a:.2f} | {b:.2f} | {ratio:.2f} |")
        sys.stdout.flush()


main()
