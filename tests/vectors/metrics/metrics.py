"""Numbers of other programs for the error metrics of src/image/metrics.

    pip install numpy scikit-image flip-evaluator OpenEXR
    python3 metrics.py

writes the pictures beside this file (a made-up room in high dynamic range, and three attempts at it) and
`metrics.json`: plain sums by numpy, SSIM and PSNR by scikit-image, FLIP by its authors' program.
"""

import json
import os

import flip_evaluator
import numpy as np
import OpenEXR
import skimage
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

HERE = os.path.dirname(os.path.abspath(__file__))
WIDTH, HEIGHT = 56, 40
rng = np.random.default_rng(2017)


def room():
    """A wall in a gradient, tiles, a lamp of 60, a dim corner, a saturated ball."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float64)
    image = np.stack([0.7 - 0.008 * x, 0.5 + 0 * x, 0.2 + 0.006 * x], -1) * (0.15 + 0.02 * y)[..., None]
    tiles = ((x // 5 + y // 5) % 2 == 0) & (y > 25)
    image[tiles] *= 0.2
    image[(x > 40) & (y < 12)] *= 0.01
    ball = (x - 17) ** 2 + (y - 22) ** 2 < 60
    image[ball] = np.stack([1.5 - 0.02 * x, 0.02 + 0 * x, 0.1 + 0 * x], -1)[ball]
    lamp = (x - 30) ** 2 + (y - 7) ** 2 < 14
    image[lamp] = [60.0, 48.0, 30.0]
    return image


def noisy(image):
    """The noise of few samples, with three fireflies."""
    shape = 6.0
    result = image * rng.gamma(shape, 1 / shape, (HEIGHT, WIDTH, 1))
    for x, y in [(5, 5), (50, 3), (22, 33)]:
        result[y, x] += [90.0, 70.0, 80.0]
    return result


def biased(image):
    """Too bright by a twentieth, and blurred along the rows."""
    return 1.05 * (0.5 * image + 0.25 * np.roll(image, 1, 1) + 0.25 * np.roll(image, -1, 1))


def tinted(image):
    """Noise of its own in every channel, and a tint."""
    return image * rng.normal(1.0, 0.06, image.shape).clip(0.5, 1.5) * [1.02, 1.0, 0.93]


def save(name, image):
    image = image.astype(np.float16)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    channels = {c: np.ascontiguousarray(image[..., i]) for i, c in enumerate("RGB")}
    OpenEXR.File(header, channels).write(os.path.join(HERE, name + ".exr"))
    return image.astype(np.float64)


def display(image):
    image = image.clip(0, 1)
    return np.where(image <= 0.0031308, 12.92 * image, 1.055 * image ** (1 / 2.4) - 0.055)


def flip(reference, image, kind):
    pair = [np.ascontiguousarray(i, dtype=np.float32) for i in (reference, image)]
    error, mean, used = flip_evaluator.evaluate(*pair, kind, inputsRGB=True, applyMagma=False)
    return error[..., 0] if error.ndim == 3 else error, mean, used


def blocks(image, side):
    """Means over whole blocks."""
    height, width = (n // side * side for n in image.shape[:2])
    return image[:height, :width].reshape(height // side, side, width // side, side, 3).mean((1, 3))


def relmse(reference, image):
    return ((image - reference) ** 2 / (reference**2 + 0.01)).mean()


def numbers(reference, image):
    difference = image - reference
    relative = difference**2 / (reference**2 + 0.01)
    pixels = np.sort(relative.mean(-1).ravel())
    kept = pixels[: len(pixels) - len(pixels) // 1000]
    shown = display(reference), display(image)
    similar = dict(channel_axis=2)
    hdr_map, hdr, used = flip(reference, image, "HDR")
    ldr_map, ldr, _ = flip(*shown, "LDR")
    corner = lambda m: [[float(v) for v in m[y, ::11]] for y in (0, 7, 20, HEIGHT - 1)]
    return {
        "l1": np.abs(difference).mean(),
        "mse": (difference**2).mean(),
        "rmse": (difference**2).mean() ** 0.5,
        "relmse": relative.mean(),
        "relmse_trimmed": kept.mean(),
        "relmse_4x4": relmse(blocks(reference, 4), blocks(image, 4)),
        "relmse_16x16": relmse(blocks(reference, 16), blocks(image, 16)),
        "mean_ratio": image.mean() / reference.mean(),
        "ssim": structural_similarity(*shown, data_range=1.0, **similar),
        "ssim_linear_60": structural_similarity(reference, image, data_range=60.0, **similar),
        "ssim_linear_2": structural_similarity(reference, image, data_range=2.0, **similar),
        "psnr": peak_signal_noise_ratio(*shown, data_range=1.0),
        "psnr_linear_60": peak_signal_noise_ratio(reference, image, data_range=60.0),
        "flip_hdr": float(hdr),
        "flip_ldr": float(ldr),
        "flip_hdr_map": corner(hdr_map),
        "flip_ldr_map": corner(ldr_map),
        "start_exposure": used["startExposure"],
        "stop_exposure": used["stopExposure"],
        "exposures": used["numExposures"],
    }


def main():
    reference = save("reference", room())
    images = {f.__name__: save(f.__name__, f(room())) for f in (noisy, biased, tinted)}
    table = {"made_with": f"numpy {np.__version__}, scikit-image {skimage.__version__}, flip-evaluator 1.7"}
    table |= {name: numbers(reference, image) for name, image in images.items()}
    with open(os.path.join(HERE, "metrics.json"), "w") as out:
        json.dump(table, out, indent=1)
        out.write("\n")


main()
