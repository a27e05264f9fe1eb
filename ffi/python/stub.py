"""Writes the types of the compiled module, `python/twintree/_native.pyi`: what has keyword arguments of the
command line gets them from the command line's own definition.

    python ffi/python/stub.py > ffi/python/python/twintree/_native.pyi
"""

from __future__ import annotations

import textwrap
from typing import Any

import twintree

#: What stands for a value in the command line's help, as a type.
TYPES = {
    "TIME": "Union[float, str]",
    "BYTES": "Union[int, str]",
    "BYTES[:half]": "Union[int, str]",
    "FILE": "Path",
    "PATH": "Path",
    "PIXELS": "int",
    "N": "Union[int, str]",
    "NOISE": "float",
    "STOPS": "float",
    "DEGREES": "float",
    "RADIUS": "float",
    "DISTANCE": "float",
    "RANGE": "float",
    "SHARE": "Union[float, str]",
    "X,Y,Z": "Union[Sequence[float], str]",
    "VIEW": "Union[Sequence[float], str]",
    "X0,Y0,X1,Y1": "Union[Sequence[int], str]",
    "GROUPS": "Union[Sequence[str], str]",
}

#: Options of files and of the terminal; those of scenes are given where scenes are made.
FILES = "output stats checkpoint resume shard frames pixel preview format compression exposure view aov field".split()
STUDIO = "camera look_at projection fov aperture focus sky envmap ground material variant at up".split()
READING = "define lenient texture_memory limit_decoded".split()


def type_of(option: dict[str, Any]) -> str:
    if option["flag"]:
        return "bool"
    if option["name"] == "ground":
        return "Union[bool, str]"
    if option["values"] and not option["name"] == "view":
        return f"Literal[{', '.join(repr(v) for v in option['values'])}]"
    return TYPES.get(option["value"], "str")


def keywords(command: str, names: list[str] | None = None, without: list[str] = []) -> tuple[str, str]:
    """The keyword arguments of a command, and what is said about them."""
    chosen = [o for o in twintree.options(command) if o["name"] not in without]
    if names is not None:
        chosen = [o for o in chosen if o["name"] in names]
    arguments, said = [], []
    for option in chosen:
        arguments.append(f"        {option['name']}: Optional[{type_of(option)}] = None,")
        text = option["help"].replace("\\", "\\\\")
        if option["default"] not in (None, "none"):
            text += f" [default: {option['default']}]"
        lines = textwrap.wrap(f"{option['name']}: {text}", 96)
        said += ["            " + lines[0], *("                " + line for line in lines[1:])]
    return "\n".join(arguments), "\n".join(said)


def filled(template: str) -> str:
    studio_args, studio_said = keywords("render", STUDIO + READING[1:])
    render_args, render_said = keywords("render", without=FILES + STUDIO + READING)
    train_args, train_said = keywords("train", without=["output", "field", *STUDIO, *READING])
    probe_args, probe_said = keywords("field", ["max_depth", "seed", "rows", "spp", "direct", "width", "height"])
    compare_args, compare_said = keywords("compare", ["exposure", "data_range"])
    save_args, save_said = keywords("render", ["format", "compression", "exposure", "view"])
    values = locals()
    for name in ("studio", "render", "train", "probe", "compare", "save"):
        template = template.replace(f"        # {name}: arguments", values[f"{name}_args"])
        template = template.replace(f"            # {name}: said", values[f"{name}_said"])
    return template


TEMPLATE = '''"""The compiled part of twintree. Made by stub.py: change that."""

import os
from typing import Any, Literal, Optional, Sequence, TypedDict, Union, final

import numpy as np
import numpy.typing as npt

Path = Union[str, "os.PathLike[str]"]
Floats = npt.NDArray[np.float32]
Numbers = npt.ArrayLike

__version__: str

class Incident(TypedDict):
    """The light that arrives at a place."""

    position: Floats
    normal: Floats
    directions: Floats
    radiance: Floats
    solid_angle: Floats

class Option(TypedDict):
    """An option of the command line."""

    name: str
    help: str
    flag: bool
    value: Optional[str]
    values: list[str]
    default: Optional[str]

@final
class Render:
    """What came of a render: `render["image"]` is the picture, (H, W, 3) float32, linear sRGB, rows from the top."""

    @property
    def arrays(self) -> dict[str, Floats]:
        """The picture, "image", and the layers by their names: (H, W, C)."""
    @property
    def stats(self) -> dict[str, Any]:
        """Measurements: the keys of the command line's `--stats` file."""
    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C has ended it before its limit."""
    def __getitem__(self, name: str, /) -> Floats: ...
    def __contains__(self, name: str, /) -> bool: ...
    def save(
        self,
        path: Path,
        *,
        # save: arguments
    ) -> None:
        """Writes the picture; the name's end says how: .exr .hdr .tif .png .jpg.

            # save: said
        """

@final
class Field:
    """A learned field of where light comes from."""

    @staticmethod
    def load(path: Path) -> Field:
        """Reads a field. ValueError where it is none, or damaged."""
    def save(self, path: Path) -> None:
        """Writes the field, whole or not at all."""
    @property
    def stats(self) -> dict[str, Any]:
        """What is in it: the keys of `twintree field --json`."""
    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C has ended its training before all records had taught."""
    @property
    def bounds(self) -> tuple[list[float], list[float]]:
        """Lower and upper corner of what it covers, in the scene's units."""
    def sample(
        self,
        positions: Numbers,
        normals: Optional[Numbers] = None,
        n: int = 1,
        seed: int = 0,
        *,
        threads: Optional[int] = None,
    ) -> tuple[Floats, Floats]:
        """`n` directions at each of `positions` (N, 3), with `normals` (N, 3): unit vectors towards light
        (N, n, 3), and their densities per steradian (N, n)."""
    def pdf(
        self,
        positions: Numbers,
        normals: Optional[Numbers],
        directions: Numbers,
        *,
        threads: Optional[int] = None,
    ) -> Floats:
        """The density per steradian of unit `directions` (N, 3) or (N, M, 3) at `positions` (N, 3) or (3,):
        (N,) or (N, M)."""
    def irradiance(
        self,
        positions: Numbers,
        normals: Optional[Numbers] = None,
        *,
        threads: Optional[int] = None,
    ) -> Floats:
        """Light that arrives at `positions` (N, 3), W/m^2: (N, 3)."""

@final
class Scene:
    """A scene: shapes, materials, lights and a camera. Empty until meshes and lights are added."""

    def __new__(
        cls,
        *,
        # studio: arguments
    ) -> Scene:
        """An empty scene, and what is around the meshes that it will have.

            # studio: said
        """
    def set(self, **options: Any) -> None:
        """Changes options: of models and arrays those of Scene(); of a scene file values of its $names."""
    def add_mesh(
        self,
        vertices: Numbers,
        faces: Numbers,
        *,
        material: str = "clay",
        texture: Optional[Path] = None,
        uvs: Optional[Numbers] = None,
        normals: Optional[Numbers] = None,
        emission: Optional[Numbers] = None,
        name: Optional[str] = None,
        smooth: bool = False,
    ) -> list[str]:
        """Adds a mesh of `vertices` (N, 3) and `faces` (M, 3), with `normals` (N, 3) and `uvs` (N, 2), which say
        where the image `texture` lies; returns what was repaired, in words."""
    def add_light(self, kind: Literal["point", "spot", "directional", "constant"], **settings: Numbers) -> None:
        """Adds a lamp without a body: point (position, intensity), spot (position, target, intensity, cutoff,
        beam), directional (direction, irradiance), constant (radiance)."""
    def info(self) -> dict[str, Any]:
        """What it consists of."""
    def render(
        self,
        *,
        aovs: Union[None, str, Sequence[str]] = None,
        field: Union[None, Field, Path] = None,
        threads: Optional[int] = None,
        progress: Any = None,
        # render: arguments
    ) -> Render:
        """Renders, with the bits of the command line for the same settings.

            aovs: further layers, such as ["albedo", "normal", "depth"]
            field: guide by this field, or that of a file, instead of learning one
            threads: how many work [default: all that the machine has]
            progress: True, False, a class like tqdm; None shows a bar where somebody looks on
            # render: said
        """
    def train(
        self,
        *,
        field: Union[None, Field, Path] = None,
        threads: Optional[int] = None,
        progress: Any = None,
        # train: arguments
    ) -> Field:
        """Learns where light comes from. Ctrl-C ends it with what has been learned.

            field: learn further over the structure of this one
            # train: said
        """
    def incident(
        self,
        x: int,
        y: int,
        *,
        threads: Optional[int] = None,
        # probe: arguments
    ) -> Incident:
        """The light that arrives at what the pixel sees, by brute force: "radiance" (rows, 2 rows, 3), times the
        cosine, for "directions" (rows, 2 rows, 3).

            # probe: said
        """

@final
class Trainer:
    """A field that learns from records of your own, over the box from `min` to `max`."""

    def __new__(cls, min: Numbers, max: Numbers, **settings: Any) -> Trainer: ...
    def set_surface(self, positions: Numbers, area: float, normals: Optional[Numbers] = None) -> None:
        """Tells where surfaces are: points (N, 3), uniform over all of the `area`."""
    def train(
        self,
        positions: Numbers,
        directions: Numbers,
        powers: Numbers,
        emitted: int,
        *,
        distances: Optional[Numbers] = None,
        normals: Optional[Numbers] = None,
    ) -> None:
        """Learns from photons that landed: powers (N, 3) in W, not divided by how many were `emitted`."""
    def train_paths(
        self,
        positions: Numbers,
        directions: Numbers,
        radiances: Numbers,
        pdfs: Numbers,
        *,
        distances: Optional[Numbers] = None,
        normals: Optional[Numbers] = None,
    ) -> None:
        """Learns from samples of camera paths: radiances (N, 3) from directions of densities `pdfs` (N,)."""
    def refine(self, rounds: int = 4) -> None:
        """Divides cells where the last batch says that it pays."""
    def field(self) -> Field:
        """The field as it is now; training may go on."""
    @property
    def stats(self) -> dict[str, Any]:
        """Sizes, depths and counts, and what came in."""
    @property
    def settings(self) -> dict[str, Any]:
        """The settings that it was built with."""

def load(path: Path, *more: Path, **options: Any) -> Scene:
    """Reads a scene file, whose $names the keywords are, or models, whose options they are as for Scene()."""

def compare(
        image: Union[Numbers, Render, Path],
        reference: Union[Numbers, Render, Path],
        *,
        # compare: arguments
) -> dict[str, Any]:
    """How far an image is from a reference: the numbers of `twintree compare`, and "maps".

            # compare: said
    """

def options(command: str) -> list[Option]:
    """The options of a command."""

def main(words: Sequence[str], program: Sequence[str]) -> int:
    """Runs the command line in this process, whose signals it takes over; returns the exit code."""
'''

if __name__ == "__main__":
    print(filled(TEMPLATE), end="")
