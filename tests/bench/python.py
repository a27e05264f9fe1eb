#!/usr/bin/env python3
"""What the package for Python costs beside the work that it asks for: densities and samples of a field a second,
and the time of a render of almost no samples. By the package that is installed: build it with optimisation.

    python tests/bench/python.py
"""
import pathlib
import time

import numpy as np
import twintree

CORNELL = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "cornell" / "cornell.xml"
COUNT = 10_000_000


def fastest(times, work):
    """Seconds of the fastest of so many runs."""
    took = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        took.append(time.perf_counter() - start)
    return min(took)


def unit_vectors(numbers, count):
    vectors = numbers.normal(size=(count, 3))
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)


scene = twintree.load(CORNELL)
field = scene.train(photons=500_000, paths=200_000)
numbers = np.random.default_rng(0)
low, high = map(np.array, field.bounds)
positions = (low + (high - low) * numbers.random((COUNT, 3))).astype(np.float32)
normals, directions = (unit_vectors(numbers, COUNT) for _ in range(2))
print(field)
seconds = fastest(3, lambda: field.pdf(positions, normals, directions))
print(f"densities, each at a place of its own: {COUNT / seconds / 1e6:.1f} million a second")
seconds = fastest(3, lambda: field.pdf(positions[:1000], normals[:1000], directions.reshape(1000, -1, 3)))
print(f"densities, {COUNT // 1000} at each place: {COUNT / seconds / 1e6:.1f} million a second")
seconds = fastest(3, lambda: field.sample(positions, normals))
print(f"samples: {COUNT / seconds / 1e6:.1f} million a second")
seconds = fastest(20, lambda: scene.render(spp=1, width=2, guide="none"))
print(f"a render of two pixels: {1000 * seconds:.1f} ms")
