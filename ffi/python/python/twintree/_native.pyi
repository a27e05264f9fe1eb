"""The compiled part of twintree. Made by stub.py: change that."""

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
        format: Optional[Literal['half', 'float']] = None,
        compression: Optional[Literal['none', 'zip', 'piz', 'dwaa']] = None,
        exposure: Optional[float] = None,
        view: Optional[str] = None,
    ) -> None:
        """Writes the picture; the name's end says how: .exr .hdr .tif .png .jpg.

            format: Numbers of an EXR: 16 or 32 bits [default: half]
            compression: Compression of an EXR; dwaa is lossy [default: zip]
            exposure: Brightness of .png and .jpg, as a power of two [default: the scene's]
            view: How .png and .jpg show light, which has no upper limit as they have [default: srgb]
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
        camera: Optional[Union[Sequence[float], str]] = None,
        look_at: Optional[Union[Sequence[float], str]] = None,
        projection: Optional[Literal['perspective', 'orthographic', 'spherical', 'fisheye']] = None,
        fov: Optional[float] = None,
        aperture: Optional[float] = None,
        focus: Optional[float] = None,
        sky: Optional[str] = None,
        envmap: Optional[Path] = None,
        ground: Optional[Union[bool, str]] = None,
        material: Optional[str] = None,
        variant: Optional[str] = None,
        at: Optional[str] = None,
        up: Optional[Literal['y', 'z']] = None,
        lenient: Optional[bool] = None,
        texture_memory: Optional[Union[int, str]] = None,
        limit_decoded: Optional[Union[int, str]] = None,
    ) -> Scene:
        """An empty scene, and what is around the meshes that it will have.

            camera: Camera: orbit:AZIMUTH,ELEVATION in degrees, from:X,Y,Z, or the name or number of a glTF
                camera [default: the models' first camera, or orbit:30,20]
            look_at: Point that the camera looks at [default: the middle of the models]
            projection: How the camera projects [default: as the models' camera does, or perspective]
            fov: Field of view along the picture's shorter side, degrees [default: the camera's, or 35; of a
                fisheye 180]
            aperture: Radius of the camera's lens, in the models' units: what is not in focus is blurred
                [default: a pinhole]
            focus: Distance to what is in focus, along the camera's axis [default: that of what the camera
                looks at]
            sky: Light: studio, white, white:R,G,B, sun, sun:AZIMUTH,ELEVATION or none [default: studio, if
                the models bring no light]
            envmap: Image around the scene, latitude by longitude
            ground: Ground under the models [material if none is named: matte:0.4]
            material: Material of all models: clay, matte, plastic, metal, mirror, glass, frosted, water,
                gold, silver, copper, aluminium, chrome, tungsten; with a colour as in plastic:0.8,0.1,0.1 or
                clay:#cc3311 [default: the models' own; clay, with the colours of their vertices]
            variant: The variant of glTF files whose materials are shown [default: their default materials]
            at: A moment of an animation of glTF files, with its name or number before a colon where it is
                not the first, as in Walk:1.5 [default: the files' own pose]
            up: Axis of the models that is up; glTF files are turned accordingly [default: y]
            lenient: Put something plain in the place of what is wrong or missing, with a warning, instead
                of giving up
            texture_memory: Memory for texels, such as 512M or 2G: what does not fit is read again when
                needed. With :half behind it, as in 2G:half, textures of 32 bits are kept in 16: half the
                memory, three digits [default: 2G]
            limit_decoded: Most memory for an image or mesh file once it is decoded; one that is itself a
                hundredth of that passes [default: 1G]
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
        denoise: Optional[bool] = None,
        oidn: Optional[Path] = None,
        reference: Optional[Path] = None,
        quality: Optional[Literal['draft', 'normal', 'final']] = None,
        spp: Optional[Union[int, str]] = None,
        time: Optional[Union[float, str]] = None,
        noise: Optional[float] = None,
        width: Optional[int] = None,
        height: Optional[int] = None,
        crop: Optional[Union[Sequence[int], str]] = None,
        alpha: Optional[bool] = None,
        rfilter: Optional[Literal['box', 'tent', 'gaussian', 'mitchell', 'catmullrom', 'lanczos']] = None,
        max_depth: Optional[Union[int, str]] = None,
        rr_depth: Optional[Union[int, str]] = None,
        sampler: Optional[Literal['independent', 'sobol']] = None,
        seed: Optional[Union[int, str]] = None,
        hide_emitters: Optional[bool] = None,
        strict_normals: Optional[bool] = None,
        light_groups: Optional[Union[Sequence[str], str]] = None,
        light_bounces: Optional[Union[int, str]] = None,
        strict: Optional[bool] = None,
        guide: Optional[Literal['auto', 'none', 'double', 'gmm', 'ppg']] = None,
        photons: Optional[Union[int, str]] = None,
        paths: Optional[Union[int, str]] = None,
        train: Optional[Literal['photons', 'paths', 'both']] = None,
        batches: Optional[Union[int, str]] = None,
        guide_memory: Optional[Union[int, str]] = None,
        guide_model: Optional[Literal['constant', 'vmf', 'gauss']] = None,
        mixture: Optional[Union[float, str]] = None,
        roulette: Optional[Literal['field', 'throughput']] = None,
        reuse: Optional[Union[int, str]] = None,
        manifold: Optional[Literal['auto', 'never']] = None,
        adaptive: Optional[Literal['auto', 'never']] = None,
        trial: Optional[Literal['auto', 'never']] = None,
        accel: Optional[Literal['embree', 'embree:robust', 'obvhs']] = None,
        accel_build: Optional[Literal['fast', 'balanced', 'compact', 'high']] = None,
    ) -> Render:
        """Renders, with the bits of the command line for the same settings.

            aovs: further layers, such as ["albedo", "normal", "depth"]
            field: guide by this field, or that of a file, instead of learning one
            threads: how many work [default: all that the machine has]
            progress: True, False, a class like tqdm; None shows a bar where somebody looks on
            denoise: Denoise the picture with Intel Open Image Denoise. An EXR then has the denoised picture
                as its R, G and B, the noisy one as layer "noisy", and the layers albedo and normal
            oidn: Where Open Image Denoise 2 is: its library, or a folder of a release or of Python's pyoidn
                [default: TWINTREE_OIDN, what the system has, Python's environment]
            reference: Measure the error against this image while rendering, for stats and the message at
                the end
            quality: Settings for a purpose: when to stop, and how long to learn; options that are given
                besides win
            spp: Stop after N samples a pixel [default: the scene's number, or none with time or noise]
            time: Stop after this time of rendering: 90, 120s, 2m, 1h30m
            noise: Stop at this noise: the expected root of the relative mean squared error
            width: Width in pixels; alone it keeps the scene's proportions
            height: Height in pixels; alone it keeps the scene's proportions
            crop: Render this part only, upper bounds not included
            alpha: An alpha channel: the background is transparent, and the camera itself does not see what
                shines there. A scene asks for it by the film's pixel_format rgba and hide_emitters
            rfilter: Reconstruction filter [default: the scene's]
            max_depth: Longest path, in edges: 1 is emitters alone, 2 adds direct light; or "unlimited"
                [default: the scene's]
            rr_depth: Depth at which Russian roulette begins [default: the scene's]
            sampler: Where the samples go, whatever the scene names [default: sobol]
            seed: Seed of all random numbers: the same seed gives the same bits, whatever the number of
                threads [default: 0]
            hide_emitters: Emitters are not seen by the camera itself
            strict_normals: Drop light that crosses a surface only by its interpolated normal
            light_groups: A layer for the light of each group of emitters, and one for the rest: NAME or
                NAME=A+B, by the ids of emitters, their shapes or lights in the scene; "each" is a group for
                every name
            light_bounces: A layer for light that was scattered 0, 1 .. N times, and one for the rest
            strict: End with exit code 3 if a sample or a photon was not finite and had to be left out; the
                image is written all the same
            guide: How directions are guided towards light [default: auto; with field double, with shard
                none]
            photons: Photon paths that teach the field [default: as many as the image is worth, while they
                teach anything; with "twintree train" 500 000; with guide gmm 9 million]
            paths: Camera paths that teach the field; the first samples of a render do [default: 2000000]
            train: Which of the two do [default: both]
            batches: Batches that photons come in, each twice as large as the one before; with guide gmm 30
                of one size [default: 8]
            guide_memory: Memory for learning, such as 64M: the field's trees while they are trained, and
                the records that they learn from [default: 256M]
            guide_model: What describes the directions of a cell [default: gauss]
            mixture: Share of the directions that come from the field, 0.1 to 0.9, the others from the
                material; or "learned", place by place [default: learned]
            roulette: What guided paths are ended or split by [default: field]
            reuse: How many pixels' paths share what they find behind their first rough vertices, where a
                field guides; 1: each is for itself, and the noise of neighbours independent [default: 32]
            manifold: Manifold next-event estimation: guided paths sample suns and lamps behind glass and in
                mirrors, where there are any, as often as a short trial finds worth its time [default: auto]
            adaptive: Whether pixels that are noisier take more of the samples, where camera paths teach a
                field: their noise tells which need more; spp then is what they take on average [default: auto]
            trial: Whether a short trial tells if a field that is learned pays, and ends guiding where it
                does not [default: auto]
            accel: Ray tracer [default: embree, where it was compiled in]
            accel_build: How its trees are built [default: balanced, or compact where memory is short]
        """
    def train(
        self,
        *,
        field: Union[None, Field, Path] = None,
        threads: Optional[int] = None,
        progress: Any = None,
        shard: Optional[str] = None,
        photons: Optional[Union[int, str]] = None,
        paths: Optional[Union[int, str]] = None,
        train: Optional[Literal['photons', 'paths', 'both']] = None,
        batches: Optional[Union[int, str]] = None,
        guide_memory: Optional[Union[int, str]] = None,
        guide_model: Optional[Literal['constant', 'vmf', 'gauss']] = None,
        width: Optional[int] = None,
        height: Optional[int] = None,
        max_depth: Optional[Union[int, str]] = None,
        rr_depth: Optional[Union[int, str]] = None,
        sampler: Optional[Literal['independent', 'sobol']] = None,
        seed: Optional[Union[int, str]] = None,
        hide_emitters: Optional[bool] = None,
        strict_normals: Optional[bool] = None,
        accel: Optional[Literal['embree', 'embree:robust', 'obvhs']] = None,
        accel_build: Optional[Literal['fast', 'balanced', 'compact', 'high']] = None,
    ) -> Field:
        """Learns where light comes from. Ctrl-C ends it with what has been learned.

            field: learn further over the structure of this one
            shard: Learn from a share of these records, 0/4 to 3/4, into a field for "twintree merge-fields"
            photons: Photon paths that teach the field [default: as many as the image is worth, while they
                teach anything; with "twintree train" 500 000; with guide gmm 9 million]
            paths: Camera paths that teach the field; the first samples of a render do [default: 2000000]
            train: Which of the two do [default: both]
            batches: Batches that photons come in, each twice as large as the one before; with guide gmm 30
                of one size [default: 8]
            guide_memory: Memory for learning, such as 64M: the field's trees while they are trained, and
                the records that they learn from [default: 256M]
            guide_model: What describes the directions of a cell [default: gauss]
            width: Width in pixels; alone it keeps the scene's proportions
            height: Height in pixels; alone it keeps the scene's proportions
            max_depth: Longest path, in edges: 1 is emitters alone, 2 adds direct light; or "unlimited"
                [default: the scene's]
            rr_depth: Depth at which Russian roulette begins [default: the scene's]
            sampler: Where the samples go, whatever the scene names [default: sobol]
            seed: Seed of all random numbers: the same seed gives the same bits, whatever the number of
                threads [default: 0]
            hide_emitters: Emitters are not seen by the camera itself
            strict_normals: Drop light that crosses a surface only by its interpolated normal
            accel: Ray tracer [default: embree, where it was compiled in]
            accel_build: How its trees are built [default: balanced, or compact where memory is short]
        """
    def incident(
        self,
        x: int,
        y: int,
        *,
        threads: Optional[int] = None,
        width: Optional[int] = None,
        height: Optional[int] = None,
        max_depth: Optional[Union[int, str]] = None,
        seed: Optional[Union[int, str]] = None,
        rows: Optional[Union[int, str]] = None,
        spp: Optional[Union[int, str]] = None,
        direct: Optional[bool] = None,
    ) -> Incident:
        """The light that arrives at what the pixel sees, by brute force: "radiance" (rows, 2 rows, 3), times the
        cosine, for "directions" (rows, 2 rows, 3).

            width: Width in pixels; alone it keeps the scene's proportions
            height: Height in pixels; alone it keeps the scene's proportions
            max_depth: Longest path, in edges, or "unlimited" [default: the scene's]
            seed: Seed of the paths [default: 0]
            rows: Rows of the picture of directions [default: 96]
            spp: Paths a pixel of that picture [default: 64]
            direct: Include light straight from emitters, which next-event estimation finds without a field
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
        exposure: Optional[float] = None,
        data_range: Optional[float] = None,
) -> dict[str, Any]:
    """How far an image is from a reference: the numbers of `twintree compare`, and "maps".

            exposure: Brightness of the pictures as shown, as a power of two [default: 0]
            data_range: Compute SSIM and PSNR of the linear numbers, taken to span RANGE, instead of the
                pictures as shown
    """

def options(command: str) -> list[Option]:
    """The options of a command."""

def main(words: Sequence[str], program: Sequence[str]) -> int:
    """Runs the command line in this process, whose signals it takes over; returns the exit code."""
