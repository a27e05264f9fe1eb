"""twintree: a physically based renderer that learns where light comes from before it renders.

    import twintree

    scene = twintree.load("scene.xml")
    picture = scene.render(spp=64)          # twintree render scene.xml --spp 64
    picture["image"]                        # an array (H, W, 3), float32, linear sRGB
    picture.save("picture.png")
    twintree.compare(picture, "reference.exr")["relmse"]

Settings are keyword arguments with the names of the command line's options; `options("render")` lists
them. What goes wrong is a `ValueError`, `TypeError` or `RuntimeError` with the program's message; its
warnings go to the logger "twintree" of Python's `logging`.
"""

from ._native import Field, Render, Scene, Trainer, __version__, compare, load, options
from ._sweep import sweep

__all__ = [
    "Field",
    "Render",
    "Scene",
    "Trainer",
    "__version__",
    "compare",
    "load",
    "options",
    "sweep",
]
