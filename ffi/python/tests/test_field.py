"""Fields and trainers: densities, samples, files."""

from __future__ import annotations

import time

import numpy as np
import pytest
import twintree


def places(field, count, seed=0):
    low, high = map(np.array, field.bounds)
    numbers = np.random.default_rng(seed)
    normals = numbers.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return low + (high - low) * numbers.random((count, 3)), normals


def sphere(count, seed=1):
    w = np.random.default_rng(seed).normal(size=(count, 3))
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


def test_samples_have_the_density_that_is_told(field):
    positions, normals = places(field, 200)
    directions, pdfs = field.sample(positions, normals, 16, seed=3)
    assert directions.shape == (200, 16, 3) and pdfs.shape == (200, 16)
    assert directions.dtype == pdfs.dtype == np.float32
    assert np.allclose(np.linalg.norm(directions, axis=-1), 1, atol=1e-5)
    assert np.allclose(field.pdf(positions, normals, directions), pdfs, rtol=1e-3)
    again, _ = field.sample(positions, normals, 16, seed=3, threads=1)
    assert np.array_equal(again, directions)
    assert not np.array_equal(field.sample(positions, normals, 16, seed=4)[0], directions)


def test_densities_integrate_to_one(field):
    positions, normals = places(field, 8)
    for position, normal in zip(positions, normals):
        # With the samples themselves and as many uniform directions, by the balance heuristic:
        # the mean of 1 / (pdf / 2 + 1 / 8 pi) is the measure of the sphere.
        n = 200_000
        drawn, p = field.sample(position, normal, n)
        w = sphere(n)
        q = field.pdf(position, normal, w)
        uniform = 1 / (4 * np.pi)
        weights = [p / (p + uniform), q / (q + uniform)]
        # The expectation of pdf / (pdf + u) over both is the integral of the density: 1.
        total = weights[0].mean() + weights[1].mean() * 1.0
        sphere_part = (uniform / (p + uniform)).mean() + (uniform / (q + uniform)).mean()
        assert total + sphere_part == pytest.approx(2, abs=1e-5)
        assert sphere_part == pytest.approx(1, abs=0.01)


def test_ten_million_densities_take_two_seconds_on_two_cores(field):
    n = 2_000_000
    positions, normals = places(field, n)
    w = sphere(n)
    args = [a.astype(np.float32) for a in (positions, normals, w)]
    field.pdf(*args)
    start = time.perf_counter()
    field.pdf(*args)
    rate = n / (time.perf_counter() - start)
    print(f"{rate / 1e6:.1f} million densities a second")
    # Machines that are busy with other things have less: this finds what is slower by a factor.
    assert rate > 1e6


def test_a_file_keeps_a_field(field, tmp_path, program):
    path = tmp_path / "a.field"
    field.save(path)
    read = twintree.Field.load(path)
    positions, normals = places(field, 50)
    assert np.array_equal(field.sample(positions, normals)[0], read.sample(positions, normals)[0])
    ours, theirs = (dict(f.stats) for f in (field, read))
    assert ours.pop("field") != theirs.pop("field") and ours == theirs
    assert program("field", path, "--json").returncode == 0
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(ValueError, match="a.field.*damaged"):
        twintree.Field.load(path)


def test_training_is_that_of_the_command_line(cornell, program, tmp_path):
    from conftest import CORNELL

    theirs, ours = tmp_path / "theirs.field", tmp_path / "ours.field"
    done = program("train", CORNELL, "--photons", 5000, "--paths", 3000, "--width", 32, "-o", theirs)
    assert done.returncode == 0, done.stderr
    cornell.train(photons=5000, paths=3000, width=32).save(ours)
    assert ours.read_bytes() == theirs.read_bytes()


def test_a_field_guides_with_the_same_mean_and_less_noise(cornell, field, tmp_path):
    settings = dict(spp=64, width=64, reuse=1, adaptive="never")
    guided = cornell.render(field=field, **settings)
    reference = cornell.render(spp=1024, width=64, guide="none", seed=1, aovs="variance")
    assert twintree.compare(guided, reference)["mean_ratio"] == pytest.approx(1, abs=0.02)
    path = tmp_path / "a.field"
    field.save(path)
    assert np.array_equal(cornell.render(field=path, **settings)["image"], guided["image"])


def test_learning_goes_on(cornell, field):
    more = cornell.train(field=field, photons=10_000, paths=0, width=64)
    before, after = (f.stats["sample_ranges"]["photons"]["taken"][-1]["end"] for f in (field, more))
    assert after == before + 10_000


def lamp_records(count, seed):
    """Photons of a small square lamp above the unit square, which it lights from straight above."""
    numbers = np.random.default_rng(seed)
    source = np.array([0.3, 0.7, 0.8]) + 0.05 * np.append(numbers.random((count, 2)) - 0.5, np.zeros((count, 1)), 1)
    u, v = numbers.random((2, count))
    down = np.stack([np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(u) * np.sin(2 * np.pi * v), -np.sqrt(1 - u)], 1)
    distance = source[:, 2] / -down[:, 2]
    at = source + down * distance[:, None]
    at[:, 2] = 0
    landed = np.all((at[:, :2] >= 0) & (at[:, :2] <= 1), axis=1)
    power = np.full((count, 3), np.pi * 0.05**2)
    return at[landed], -down[landed], power[landed], distance[landed]


def test_a_trainer_learns_from_records_of_ones_own():
    trainer = twintree.Trainer((0, 0, 0), (1, 1, 1))
    numbers = np.random.default_rng(0)
    floor = np.append(numbers.random((100_000, 2)), np.zeros((100_000, 1)), axis=1)
    trainer.set_surface(floor, area=1.0)
    for batch in range(7):
        count = 4000 << batch
        at, ways, power, distance = lamp_records(count, batch)
        trainer.train(at, ways, power, count, distances=distance, normals=np.array([[0, 0, 1.0]]))
        trainer.refine()
    field = trainer.field()
    x = np.array([0.6, 0.4, 0.0])
    d = np.array([0.3, 0.7, 0.8]) - x
    truth = 0.05**2 * d[2] ** 2 / (d @ d) ** 2
    assert field.irradiance(x)[0] == pytest.approx([truth] * 3, rel=0.1)
    directions, pdfs = field.sample(x, (0, 0, 1), 20_000)
    directions, pdfs = directions[0].astype(float), pdfs[0]
    t = 0.8 / np.where(directions[:, 2] > 0, directions[:, 2], np.nan)
    hit = np.abs(x[:2] + directions[:, :2] * t[:, None] - [0.3, 0.7]) < 0.025
    estimates = np.where(hit.all(axis=1), np.clip(directions[:, 2], 0, 1) / pdfs, 0)
    error = estimates.std() / np.sqrt(len(estimates))
    assert abs(estimates.mean() - truth) < 5 * error
    # Uniform directions would have a relative deviation of about 40 a sample.
    assert error * np.sqrt(len(estimates)) / truth < 6
    assert trainer.stats["intakes"]["photons"] > 0 and trainer.settings["memory"] == 256 << 20


def test_a_trainer_learns_from_paths():
    trainer = twintree.Trainer((0, 0, 0), (1, 1, 1), source="paths", model="vmf")
    numbers = np.random.default_rng(0)
    for _ in range(4):
        at = numbers.random((20_000, 3)) * [1, 1, 0]
        w = sphere(20_000, seed=numbers.integers(1 << 30))
        light = np.where((w @ [0, 0.6, 0.8] > 0.95)[:, None], 1.0, 0.0) * np.ones(3)
        trainer.train_paths(at, w, light, np.full(20_000, 1 / (4 * np.pi)))
        trainer.refine()
    towards, away = trainer.field().pdf((0.5, 0.5, 0), None, [[0, 0.6, 0.8], [0, -0.6, -0.8]])
    assert towards > 20 * away


@pytest.mark.parametrize(
    "settings, raised, said",
    [
        ({"memry": 3}, TypeError, "no setting \"memry\", only .*memory"),
        ({"memory": "lots"}, ValueError, "memory"),
        ({"memory": -1}, ValueError, "memory"),
        ({"model": "gaus"}, ValueError, "model.*gauss"),
        ({"defensive": 2.0}, ValueError, "defensive"),
        ({"max_space_level": 99}, ValueError, "max_space_level"),
        ({"clamp": float("nan")}, ValueError, None),
        ({"scene_hash": 1}, TypeError, "scene_hash"),
    ],
)
def test_wrong_settings_of_a_trainer_are_refused(settings, raised, said):
    with pytest.raises(raised, match=said):
        twintree.Trainer((0, 0, 0), (1, 1, 1), **settings)
    with pytest.raises(ValueError, match="bounds"):
        twintree.Trainer((1, 0, 0), (0, 1, 1))
