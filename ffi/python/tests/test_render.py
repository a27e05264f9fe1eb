"""Renders: the bits of the command line, in arrays."""

from __future__ import annotations

import logging
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import twintree
from conftest import CORNELL, SCENES


@pytest.mark.parametrize("guide", ["none", "double", "ppg"])
def test_the_bits_are_those_of_the_command_line(guide, cornell, program, tmp_path):
    theirs, ours = tmp_path / "theirs.exr", tmp_path / "ours.exr"
    words = ["--spp", 32, "--width", 64, "--seed", 3, "--max-depth", 5, "--guide", guide]
    aovs = ["albedo", "normal", "depth", "variance", "samples", "cryptomatte"]
    words += ["--aov", ",".join(aovs), "--format", "float", "-o", theirs, "-q"]
    done = program("render", CORNELL, *words)
    assert done.returncode == 0, done.stderr
    render = cornell.render(spp=32, width=64, seed=3, max_depth=5, guide=guide, aovs=aovs)
    render.save(ours, format="float")
    # The rest of the files says when and how they were made.
    a, b = twintree.compare(ours, theirs), twintree.compare(render, theirs)
    for numbers in (a, b):
        assert numbers["mse"] == 0 and numbers["z"] is not None
    other = cornell.render(spp=32, width=64, seed=4, max_depth=5, guide=guide)
    assert twintree.compare(other, theirs)["mse"] > 0


def test_any_number_of_threads_gives_the_same_bits(cornell):
    one, three = (cornell.render(spp=16, width=48, threads=n, guide="double") for n in (1, 3))
    assert one.stats["threads"] == 1 and three.stats["threads"] == 3
    assert np.array_equal(one["image"], three["image"])


def test_layers_are_arrays_of_their_size(cornell):
    names = ["albedo", "normal.first", "depth", "position", "uv", "samples"]
    render = cornell.render(spp=2, width=40, height=30, guide="none", aovs=names, crop=[4, 2, 24, 12])
    assert set(render.arrays) == {"image", *names}
    for name, array in render.arrays.items():
        channels = {"depth": 1, "uv": 2, "samples": 1}.get(name, 3)
        assert array.shape == (10, 20, channels) and array.dtype == np.float32, name
    assert np.median(np.linalg.norm(render["normal.first"], axis=2)) == pytest.approx(1, abs=1e-3)
    assert np.all(render["samples"] == 2)
    with pytest.raises(KeyError, match="no layer \"albed\".*image.*aovs="):
        render["albed"]


def test_statistics_are_those_of_the_stats_file(cornell):
    stats = cornell.render(spp=8, width=32, seed=5, guide="none").stats
    assert (stats["spp"], stats["width"], stats["height"], stats["seed"]) == (8, 32, 18, 5)
    assert stats["stopped_by"] == "samples" and stats["triangles"] == 24
    assert stats["samples"] == 8 * 32 * 18 and stats["settings"]["--guide"] == "None"


def test_errors_against_a_reference_are_measured_along_the_way(cornell, tmp_path):
    reference = tmp_path / "reference.exr"
    cornell.render(spp=64, width=32, seed=9, guide="none", aovs="variance").save(reference)
    errors = cornell.render(spp=16, width=32, guide="none", reference=reference).stats["errors"]
    assert [e["spp"] for e in errors] == [1, 2, 4, 8, 16]
    assert errors[-1]["relmse"] < errors[0]["relmse"]


def test_a_render_costs_little_beside_its_samples(cornell):
    cornell.render(spp=1, width=2, guide="none")
    took = []
    for _ in range(5):
        start = time.perf_counter()
        cornell.render(spp=1, width=2, guide="none")
        took.append(time.perf_counter() - start)
    assert min(took) < 0.05


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.exr", "a.tif", "a.hdr"])
def test_pictures_are_written_in_every_format(name, cornell, tmp_path):
    render = cornell.render(spp=4, width=32, guide="none")
    path = tmp_path / name
    render.save(path)
    light = render["image"]
    shown = np.clip(light, 0, 1) if name.endswith(("png", "jpg")) else light
    assert twintree.compare(path, shown)["rmse"] < 0.1
    assert path.stat().st_size > 100


def test_what_cannot_be_written_is_said(cornell, tmp_path):
    render = cornell.render(spp=1, width=8, guide="none")
    with pytest.raises(ValueError, match="a.xyz"):
        render.save(tmp_path / "a.xyz")
    with pytest.raises((RuntimeError, ValueError), match="none"):
        render.save(tmp_path / "none" / "a.exr")
    with pytest.raises(TypeError, match="no spp, only format"):
        render.save(tmp_path / "a.exr", spp=3)


@pytest.mark.parametrize(
    "settings, raised, said",
    [
        ({"spp": 0}, ValueError, "spp"),
        ({"spp": "many"}, ValueError, "'many' for 'spp'"),
        ({"spp": 1.5}, ValueError, "1.5"),
        ({"spp": -4}, ValueError, "-4"),
        ({"spp": float("nan")}, ValueError, "nan"),
        ({"sppp": 4}, TypeError, "'sppp'(.|\n)*'spp'"),
        ({"spp": object()}, TypeError, "spp: a object is no setting"),
        ({"spp": "1\0"}, TypeError, "zero byte"),
        ({"guide": "doubel"}, ValueError, "double"),
        ({"time": -1}, ValueError, "a time above 0"),
        ({"width": 1 << 40}, ValueError, "width"),
        ({"crop": [0, 0, 9999, 9999]}, ValueError, "crop 0,0,9999,9999 reaches beyond"),
        ({"output": "a.exr"}, TypeError, r"output is no setting here(.|\n)*save"),
        ({"camera": "orbit:1,2"}, TypeError, r"camera is no setting here(.|\n)*set\(\)"),
        ({"threads": 0}, ValueError, "threads: 0"),
        ({"field": "/none.field"}, ValueError, "/none.field"),
        ({"field": 3}, TypeError, None),
        ({"guide": "ppg", "field": "a.field"}, ValueError, "guide ppg does not go with field"),
        ({"aovs": ["nothing"]}, ValueError, "nothing"),
        ({"reference": "/none.exr"}, ValueError, "/none.exr"),
        ({"progress": 3}, TypeError, "no class of bars"),
    ],
)
def test_wrong_settings_are_refused_in_the_programs_words(settings, raised, said, cornell):
    with pytest.raises(raised, match=said):
        cornell.render(**settings)


def test_a_scene_that_is_wrong_is_refused_with_its_place(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text('<scene version="3.0.0">\n  <shape type="spere"/>\n</scene>')
    with pytest.raises(ValueError, match="a.xml:2:"):
        twintree.load(path)
    with pytest.raises(ValueError, match="none.xml"):
        twintree.load(tmp_path / "none.xml")
    with pytest.raises(TypeError):
        twintree.load(3)


def test_keywords_of_a_scene_file_are_its_names(tmp_path, caplog):
    path = tmp_path / "a.xml"
    path.write_text(
        """<scene version="3.0.0"><default name="depth" value="2"/><default name="spp" value="4"/>
        <integrator type="path"><integer name="max_depth" value="$depth"/></integrator>
        <sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="$spp"/>
        </sampler></sensor><shape type="sphere"/><emitter type="constant"/></scene>"""
    )
    told = [twintree.load(path, **d).info() for d in ({}, {"depth": 7}, {"define": {"spp": 9}})]
    assert [(i["max_depth"], i["spp"]) for i in told] == [(2, 4), (7, 4), (2, 9)]
    scene = twintree.load(path, depth=7, spp=3)
    scene.set(depth=3)
    assert (scene.info()["max_depth"], scene.info()["spp"]) == (3, 3)
    twintree.load(path, depht=3)
    assert "the scene has no $depht" in caplog.text


def test_other_threads_of_python_run_meanwhile(cornell):
    counted = 0

    def count():
        nonlocal counted
        while thread.is_alive():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=lambda: cornell.render(time=0.5, width=64, guide="none"))
    thread.start()
    count()
    assert counted > 100


def test_a_scene_renders_on_many_threads_at_once(cornell):
    images = {}

    def render(number):
        images[number] = cornell.render(spp=8, width=32, guide="none", threads=1)["image"]

    threads = [threading.Thread(target=render, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(images) == 4 and all(np.array_equal(images[0], i) for i in images.values())


def test_bars_have_the_protocol_of_tqdm(cornell):
    bars = []

    class Bar:
        def __init__(self, total=None, unit="", desc=""):
            self.total, self.desc, self.n, self.open = total, desc, 0, True
            bars.append(self)

        def update(self, n):
            self.n += n

        def set_postfix_str(self, s, refresh=True):
            self.postfix = s

        def close(self):
            self.open = False

    cornell.render(spp=64, width=64, guide="none", progress=Bar)
    drawn = bars[-1]
    assert (drawn.total, drawn.desc, drawn.open) == (64, "rendering", False)
    assert drawn.n == 64

    class Broken(Bar):
        def update(self, n):
            raise RuntimeError("the bar is broken")

    with pytest.raises(RuntimeError, match="the bar is broken"):
        cornell.render(spp=64, width=64, guide="none", progress=Broken)


def test_messages_go_to_logging(cornell, caplog):
    with caplog.at_level(logging.INFO, logger="twintree"):
        cornell.render(spp=4, width=16, guide="none", photons=3)
    assert "photons has no effect" in caplog.text


def test_models_and_arrays_are_rendered_like_the_files_that_hold_them(program, tmp_path):
    vertices = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 1.5, 0]], dtype=float)
    faces = [[2, 1, 0], [3, 2, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    path = tmp_path / "a.obj"
    path.write_text("\n".join(lines))
    theirs = tmp_path / "a.exr"
    words = ["--camera", "orbit:40,30", "--material", "gold", "--width", 48, "--height", 32]
    done = program("render", path, *words, "--spp", 8, "--guide", "none", "--format", "float", "-o", theirs)
    assert done.returncode == 0, done.stderr
    model = twintree.load(path, camera="orbit:40,30", material="gold")
    settings = dict(width=48, height=32, spp=8, guide="none")
    assert twintree.compare(model.render(**settings), theirs)["mse"] == 0
    scene = twintree.Scene(camera="orbit:40,30")
    assert scene.add_mesh(vertices, faces, material="gold", smooth=True) == []
    assert twintree.compare(scene.render(**settings), theirs)["rmse"] < 1e-3


def test_lamps_of_arrays_light_what_they_should():
    # A floor under a small lamp of radiance 10, 2 above: E = L A / d^2 straight below.
    floor = np.array([[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]])
    lamp = np.array([[-0.1, 2, -0.1], [0.1, 2, -0.1], [0.1, 2, 0.1], [-0.1, 2, 0.1]])
    scene = twintree.Scene(camera=(0, 1.5, 0.01), look_at=(0, 0, 0), fov=2, sky="none")
    scene.add_mesh(floor, [[2, 1, 0], [3, 2, 0]], material="matte:0.5")
    scene.add_mesh(lamp, [[0, 1, 2], [0, 2, 3]], emission=10)
    seen = scene.render(spp=256, width=16, height=16, guide="none")["image"]
    expected = 0.5 / np.pi * 10 * 0.2**2 / 2**2
    assert seen.mean() == pytest.approx(expected, rel=0.01)
    point = twintree.Scene(camera=(0, 1.5, 0.01), look_at=(0, 0, 0), fov=2, sky="none")
    point.add_mesh(floor, [[2, 1, 0], [3, 2, 0]], material="matte:0.5")
    point.add_light("point", position=(0, 2, 0), intensity=(10 * 0.2**2, 0, 0))
    seen = point.render(spp=64, width=16, height=16, guide="none")["image"]
    assert seen[..., 0].mean() == pytest.approx(expected, rel=0.01) and seen[..., 1].max() == 0


def quadrants(path):
    """A linear image of 4 x 4 texels: four squares of one colour each. Returns their colours, rows from the top."""
    colors = np.array([[[0.5, 0.25, 0.125], [0.25, 0.25, 0.5]], [[0.125, 0.5, 0.25], [0.5, 0.5, 0.5]]])
    texels = colors.repeat(2, axis=0).repeat(2, axis=1)
    # Radiance HDR: 256 times the value, and an exponent of 0.
    rows = np.concatenate([texels * 256, np.full((4, 4, 1), 128)], axis=2).astype(np.uint8)
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n" + rows.tobytes())
    return colors


def seen_from_the_front(texture, uvs, normals=None, **options):
    """A square that fills the picture, under light straight from the camera that makes its colour its radiance."""
    scene = twintree.Scene(camera=(0, 0, 5), look_at=(0, 0, 0), fov=2 * np.degrees(np.arctan(1 / 5)), sky="none")
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    arrays = dict(uvs=uvs, normals=normals, texture=texture, material="matte")
    assert scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], **arrays) == []
    scene.add_light("directional", direction=(0, 0, -1), irradiance=np.pi)
    return scene.render(spp=16, width=32, height=32, guide="none", **options)


def test_an_image_lies_where_texture_coordinates_say(tmp_path):
    path = tmp_path / "a.hdr"
    colors = quadrants(path)
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])

    def middles(image):
        return np.array([[image[y - 2 : y + 2, x - 2 : x + 2].mean(axis=(0, 1)) for x in (8, 24)] for y in (8, 24)])

    picture = seen_from_the_front(path, uvs, aovs="albedo")
    assert middles(picture["image"]) == pytest.approx(colors, rel=1e-3)
    assert middles(picture["albedo"]) == pytest.approx(colors, rel=1e-3)
    # Beyond its edges it repeats; turned coordinates turn it.
    assert middles(seen_from_the_front(path, uvs + [3, -2])["image"]) == pytest.approx(colors, rel=1e-3)
    turned = seen_from_the_front(path, uvs[[1, 2, 3, 0]])["image"]
    assert middles(turned) == pytest.approx(np.rot90(colors, -1), rel=1e-3)
    # Normals that lean by an angle whose cosine is 0.8 take a fifth of the light.
    leaning = seen_from_the_front(path, uvs, normals=[[0.6, 0, 0.8]] * 4)["image"]
    assert middles(leaning) == pytest.approx(0.8 * colors, rel=1e-3)


def test_a_mesh_with_an_image_stands_in_a_scene_of_a_file(tmp_path):
    path = tmp_path / "a.hdr"
    colors = quadrants(path)
    scene = twintree.load(CORNELL)
    # Right before the camera, which stands at z = 4.3.
    corners = np.array([0, 1, 3.9]) + 0.05 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], material="matte", texture=path, uvs=uvs)
    albedo = scene.render(spp=4, width=160, guide="none", aovs="albedo")["albedo"]
    found = {tuple(np.round(a, 3)) for a in albedo.reshape(-1, 3)}
    assert {tuple(c) for c in colors.reshape(-1, 3)} <= found


def test_glb_models_need_no_scene():
    models = sorted(Path(SCENES).rglob("*.glb")) + sorted(Path(SCENES).rglob("*.ply"))
    if not models:
        pytest.skip("the project has no model")
    image = twintree.load(models[0]).render(spp=2, width=32, guide="none")["image"]
    assert image.max() > 0
