"""Arrays of every wrong kind: an exception with the argument's name, and never a crash."""

from __future__ import annotations

import numpy as np
import pytest
import twintree

GOOD = np.array([[0.1, 0.2, 0.3], [0.2, 0.1, 0.0]], dtype=np.float32)
UNIT = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], dtype=np.float32)


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def unaligned(array):
    raw = np.zeros(array.nbytes + 1, dtype=np.uint8)
    view = raw[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


SAME = {
    "a list": lambda a: a.tolist(),
    "64 bits": lambda a: a.astype(np.float64),
    "16 bits": lambda a: a.astype(np.float16).astype(np.float32),
    "columns first": lambda a: np.asfortranarray(a),
    "every second": lambda a: np.repeat(a, 2, axis=0)[::2],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "read-only": read_only,
    "unaligned": unaligned,
    "big-endian": lambda a: a.astype(">f4"),
    "a matrix view": lambda a: np.array(a).view(),
    "a broadcast": lambda a: np.broadcast_to(a[None], (1, *a.shape))[0],
    "masked": lambda a: np.ma.masked_array(a),
}

WRONG = [
    (np.zeros(4), ValueError, "shape"),
    (np.zeros((2, 2)), ValueError, "shape"),
    (np.zeros((2, 2, 2, 3)), ValueError, "shape"),
    (np.float32(3), ValueError, "shape"),
    (3, ValueError, "shape"),
    (np.full((2, 3), np.nan), ValueError, r"\[0\] is not finite"),
    (np.array([[0, 0, 1], [0, np.inf, 0]]), ValueError, r"\[1\] is not finite"),
    (np.full((2, 3), 1e300), ValueError, "not finite"),
    (np.zeros((2, 3), dtype=complex), TypeError, "complex"),
    (np.zeros((2, 3), dtype=bool), TypeError, "bool"),
    (np.zeros((2, 3), dtype=object), TypeError, "object"),
    (np.array([["a"] * 3]), TypeError, "expected real numbers"),
    (np.zeros((2, 3), dtype="M8[s]"), TypeError, "real numbers"),
    (np.zeros(2, dtype=[("x", "f4")]), TypeError, "real numbers"),
    (None, TypeError, None),
    ("text", TypeError, None),
    ([[1, 2, 3], [1, 2]], TypeError, None),
    (object(), TypeError, None),
    ({}, TypeError, None),
]


@pytest.mark.parametrize("kind", SAME)
def test_the_same_numbers_in_another_array_are_the_same(kind, field):
    make = SAME[kind]
    expected = field.pdf(GOOD, UNIT, UNIT)
    positions = GOOD.astype(np.float16).astype(np.float32) if kind == "16 bits" else GOOD
    expected = field.pdf(positions, UNIT, UNIT)
    assert np.array_equal(field.pdf(make(GOOD), make(UNIT), make(UNIT)), expected)
    assert np.array_equal(field.sample(make(GOOD), make(UNIT), 2)[0], field.sample(positions, UNIT, 2)[0])


@pytest.mark.parametrize("value, raised, said", WRONG)
def test_a_field_refuses_wrong_arrays(value, raised, said, field):
    with pytest.raises(raised, match=said):
        field.pdf(value, UNIT, UNIT)
    with pytest.raises(raised, match=said):
        field.sample(value)
    with pytest.raises(raised, match=said):
        field.irradiance(value)
    with pytest.raises((ValueError, TypeError), match="directions"):
        field.pdf(GOOD, UNIT, value)
    if value is not None:
        with pytest.raises(raised, match=said):
            field.pdf(GOOD, value, UNIT)


def test_lengths_of_a_field_must_fit(field):
    with pytest.raises(ValueError, match="normals: expected 2 rows, not 3"):
        field.pdf(GOOD, np.repeat(UNIT[:1], 3, axis=0), UNIT)
    with pytest.raises(ValueError, match="directions: expected 2 rows"):
        field.pdf(GOOD, None, np.repeat(UNIT[:1], 3, axis=0))
    with pytest.raises(ValueError, match=r"directions\[1\] is no unit vector"):
        field.pdf(GOOD, None, UNIT * [[1], [2]])
    with pytest.raises(ValueError, match="do not fit into memory"):
        field.sample(GOOD, UNIT, 1 << 60)
    with pytest.raises(OverflowError):
        field.sample(GOOD, UNIT, -1)
    # Numbers far beyond the field, and none at all.
    assert np.isfinite(field.pdf(GOOD * 1e30, UNIT, UNIT)).all()
    empty = np.zeros((0, 3))
    assert field.pdf(empty, empty, empty).shape == (0,)
    assert field.sample(empty, empty, 5)[0].shape == (0, 5, 3)
    assert field.sample(GOOD, UNIT, 0)[1].shape == (2, 0)
    assert field.pdf(GOOD, UNIT, np.zeros((2, 0, 3))).shape == (2, 0)
    assert field.pdf(GOOD, UNIT, np.repeat(UNIT[:, None], 7, axis=1)).shape == (2, 7)
    assert field.pdf(GOOD[0], UNIT[0], UNIT).shape == (2,)


@pytest.mark.parametrize("value, raised, said", WRONG)
def test_a_trainer_refuses_wrong_arrays(value, raised, said):
    trainer = twintree.Trainer((0, 0, 0), (1, 1, 1))
    good = [GOOD, UNIT, np.ones((2, 3))]
    for at in range(3):
        given = [*good]
        given[at] = value
        with pytest.raises(raised, match=said):
            trainer.train(*given, 10)
        with pytest.raises(raised, match=said):
            trainer.train_paths(*given, np.ones(2))
    with pytest.raises(raised, match=said):
        trainer.set_surface(value, 1.0)
    with pytest.raises((ValueError, TypeError)):
        twintree.Trainer(value, (1, 1, 1))


def test_records_of_a_trainer_must_fit():
    trainer = twintree.Trainer((0, 0, 0), (1, 1, 1))
    light = np.ones((2, 3))
    for emitted in (0, -1, 1 << 70):
        with pytest.raises((ValueError, OverflowError)):
            trainer.train(GOOD, UNIT, light, emitted)
    with pytest.raises(ValueError, match="powers.*below 0"):
        trainer.train(GOOD, UNIT, -light, 10)
    with pytest.raises(ValueError, match=r"distances\[0\]"):
        trainer.train(GOOD, UNIT, light, 10, distances=[-1, 1])
    with pytest.raises(ValueError, match=r"pdfs\[1\] is not above 0"):
        trainer.train_paths(GOOD, UNIT, light, [1, 0])
    with pytest.raises(ValueError, match="pdfs: expected the shape"):
        trainer.train_paths(GOOD, UNIT, light, np.ones((2, 1)))
    for area in (0, -1, np.nan, np.inf):
        with pytest.raises(ValueError, match="area"):
            trainer.set_surface(GOOD, area)
    # Nothing, and numbers as large as they get: sums stay finite.
    trainer.train(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), 10)
    trainer.train(GOOD * 1e38, UNIT, light * 3e38, 10)
    trainer.refine(1000)
    assert np.isfinite(trainer.field().pdf(GOOD, UNIT, UNIT)).all()


@pytest.mark.parametrize("value, raised, said", WRONG)
def test_meshes_refuse_wrong_arrays(value, raised, said):
    scene = twintree.Scene()
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    with pytest.raises((ValueError, TypeError)):
        scene.add_mesh(value, [[0, 1, 2]])
    with pytest.raises((ValueError, TypeError)):
        scene.add_mesh(vertices, value)
    if value is not None:
        with pytest.raises((ValueError, TypeError)):
            scene.add_mesh(vertices, [[0, 1, 2]], normals=value)
        with pytest.raises((ValueError, TypeError), match="uvs"):
            scene.add_mesh(vertices, [[0, 1, 2]], uvs=value)


def test_meshes_must_hang_together():
    scene = twintree.Scene()
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    for faces, said in [
        ([[0, 1, 3]], r"faces\[0\] names vertex 3, and there are 3"),
        ([[0, 1, -1]], "names vertex -1"),
        ([[0, 1, 1 << 40]], "names vertex"),
        (np.zeros((0, 3), dtype=int), "no triangle"),
        ([[0, 0, 0]], "area"),
        ([[0, 1, 2, 0]], "shape"),
    ]:
        with pytest.raises(ValueError, match=said):
            scene.add_mesh(vertices, faces)
    with pytest.raises(TypeError, match="whole numbers"):
        scene.add_mesh(vertices, [[0.0, 1.0, 2.0]])
    with pytest.raises(ValueError, match=r"uvs: expected the shape \(N, 2\), not \(3, 3\)"):
        scene.add_mesh(vertices, [[0, 1, 2]], uvs=vertices)
    with pytest.raises(ValueError, match="uvs: expected 3 rows, one a vertex, not 4"):
        scene.add_mesh(vertices, [[0, 1, 2]], uvs=np.zeros((4, 2)))
    with pytest.raises(ValueError, match=r"uvs\[2\] is not finite: NaN"):
        scene.add_mesh(vertices, [[0, 1, 2]], uvs=[[0, 0], [0, 1], [0, np.nan]])
    with pytest.raises(ValueError, match="material: there is no material \"gould\""):
        scene.add_mesh(vertices, [[0, 1, 2]], material="gould")
    uvs = np.zeros((3, 2))
    for settings, said in [
        ({"texture": __file__}, "uvs= must say where"),
        ({"texture": "/none.png", "uvs": uvs}, "/none.png"),
        ({"texture": __file__, "uvs": uvs}, "test_hostile.py"),
        ({"texture": __file__, "uvs": uvs, "material": "gold"}, "the colour of gold, only of clay"),
        ({"texture": __file__, "uvs": uvs, "material": "clay:1,0,0"}, "only of clay"),
    ]:
        with pytest.raises(ValueError, match=said):
            scene.add_mesh(vertices, [[0, 1, 2]], **settings)
    for emission in ([1, 2], [-1, 0, 0], np.nan):
        with pytest.raises(ValueError, match="emission"):
            scene.add_mesh(vertices, [[0, 1, 2]], emission=emission)
    with pytest.raises(ValueError, match="nothing to see"):
        scene.render(spp=1)
    for kind, settings, raised, said in [
        ("lamp", {}, ValueError, "no light \"lamp\""),
        ("point", {}, TypeError, "needs position="),
        ("point", {"position": (0, 0, 0), "intensity": 1, "size": 2}, TypeError, "has no size"),
        ("spot", {"position": (0, 0, 0), "target": (0, 0, 0), "intensity": 1}, ValueError, "no direction"),
        ("directional", {"direction": (0, 0), "irradiance": 1}, ValueError, "shape"),
        ("constant", {"radiance": -1}, ValueError, "below 0"),
    ]:
        with pytest.raises(raised, match=said):
            scene.add_light(kind, **settings)


@pytest.mark.parametrize("value", [v for v, _, _ in WRONG])
def test_comparing_refuses_what_is_no_image(value):
    good = np.ones((8, 8, 3), dtype=np.float32)
    for pair in ((value, good), (good, value)):
        with pytest.raises((ValueError, TypeError)):
            twintree.compare(*pair)


def test_images_are_compared_whatever_their_numbers():
    good = np.random.default_rng(0).random((16, 20, 3))
    assert twintree.compare(good, good)["l1"] == 0
    assert twintree.compare(good.tolist(), np.asfortranarray(good))["mse"] == 0
    broken = good.copy()
    broken[3, 4] = np.nan
    assert twintree.compare(broken, good)["not_finite"] == 1
    off = twintree.compare(good * 1.01, good)
    assert off["mean_ratio"] == pytest.approx(1.01, rel=1e-5)
    assert off["rmse"] == pytest.approx(0.01 * np.sqrt((good**2).mean()), rel=1e-4)
    assert off["maps"]["flip"].shape == (16, 20) and off["maps"]["difference"].shape == (16, 20, 3)
    for shape in [(16, 20, 2), (16, 21, 3), (0, 0, 3), (16,), (2, 16, 20, 3)]:
        with pytest.raises(ValueError):
            twintree.compare(np.ones(shape), good)
    grey = twintree.compare(good[..., 0], good[..., :1])
    assert grey["mse"] == 0
    bits = (good * 255).astype(np.uint8)
    assert twintree.compare(bits, bits)["flip"] == 0
    with pytest.raises(TypeError, match="json is no setting here"):
        twintree.compare(good, good, json="a.json")
