#!/usr/bin/env python3
"""What the precautions against rounding cost: renders with and without each of them, as a Markdown table.

The precautions have no switches. A program without one is built from a copy of the checkout in which the
lines below are replaced; all programs then render the same scene in turn, and the processor times of each
round are divided. Copies and programs are kept in target/precautions and made anew when asked for.

    python3 tests/bench/precautions.py [--runs 7] [--spp 64] [--rebuild] SCENE.xml...
"""
import argparse, os, pathlib, shutil, statistics, subprocess, sys, tempfile

root = pathlib.Path(__file__).resolve().parents[2]
kept = root / "target" / "precautions"

# Name: what replaces what in which file.
WITHOUT = {
    "watertight edges (Embree's robust mode)": [
        ("src/cli/load.rs", "robust: rays.robust || watertight_edges(&self.description).on,",
         "robust: rays.robust && watertight_edges(&self.description).on,"),
    ],
    "error-bound offsets (a fixed distance instead)": [
        ("src/math/offset.rs", "let distance = ng.abs().dot(error).max(SMALLEST_OFFSET);",
         "let _ = (error, SMALLEST_OFFSET);\n    let distance = 1e-4;"),
        ("src/scene/surface.rs", "+ Vec3::splat(plane_error(e1, e2, cross_length));",
         "* 0.0;\n    let error = if false { error + plane_error(e1, e2, cross_length) } else { Vec3::ZERO };"),
        ("src/scene/surface.rs", "    terms * (ERROR_SAFETY * gamma(7))\n", "    let _ = terms;\n    Vec3::ZERO\n"),
    ],
    "the part of long, thin triangles in them": [
        ("src/scene/surface.rs", "+ Vec3::splat(plane_error(e1, e2, cross_length));",
         ";\n    let error = if false { error + plane_error(e1, e2, cross_length) } else { error };"),
    ],
    "a film in f64 (no film at all instead)": [
        ("src/film/tile.rs", "        for c in 0..3 {\n            // In f64", "        for c in 0..0 {\n            // In f64"),
    ],
}


def check(name, changes):
    """Nothing is built before all lines are found."""
    for file, old, _ in changes:
        if (root / file).read_text().count(old) != 1:
            sys.exit(f"{name}: {file} has changed: bring the lines in {__file__} up to date")


def program(name, changes, rebuild):
    """The program with the changes; built if it is not there."""
    short = "".join(c if c.isalnum() else "-" for c in name)
    binary = kept / short
    if binary.exists() and not rebuild:
        return binary
    copy = kept / "source"
    shutil.rmtree(copy, ignore_errors=True)
    files = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
                           cwd=root, check=True, capture_output=True).stdout
    for file in filter(None, files.decode().split("\0")):
        if (root / file).exists():
            (copy / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / file, copy / file)
    for file, old, new in changes:
        text = (copy / file).read_text()
        (copy / file).write_text(text.replace(old, new))
    subprocess.run(["cargo", "build", "--release", "--locked"], cwd=copy, check=True,
                   env=os.environ | {"CARGO_TARGET_DIR": str(kept / "build"), "RUSTFLAGS": "-Awarnings"})
    shutil.copy2(kept / "build" / "release" / "twintree", binary)
    return binary


def processor_seconds(binary, scene, args):
    """User time of one render."""
    with tempfile.TemporaryDirectory() as folder:
        command = [binary, "render", scene, "-o", f"{folder}/out.exr", "--quiet", "--width", "320",
                   "--guide", "none", "--spp", str(args.spp), "-j", "2"]
        child = subprocess.Popen(command)
        _, status, usage = os.wait4(child.pid, 0)
        if status != 0:
            sys.exit(f"{command} ended with {status}")
        return usage.ru_utime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--rebuild", action="store_true")
    args = parser.parse_args()
    kept.mkdir(parents=True, exist_ok=True)
    for name, changes in WITHOUT.items():
        check(name, changes)
    with_all = program("all", [], args.rebuild)
    others = {name: program(name, changes, args.rebuild) for name, changes in WITHOUT.items()}
    print("| precaution | scene | time with it over time without | quartiles |\n|---|---|---|---|")
    for scene in args.scenes:
        rounds = {name: [] for name in others}
        for _ in range(args.runs):
            base = processor_seconds(with_all, scene, args)
            for name, binary in others.items():
                rounds[name].append(base / processor_seconds(binary, scene, args))
        for name, ratios in rounds.items():
            low, middle, high = statistics.quantiles(ratios, n=4)
            title = pathlib.Path(scene).resolve().parent.name
            print(f"| {name} | {title} | {middle:.3f} | {low:.3f} to {high:.3f} |")


main()
