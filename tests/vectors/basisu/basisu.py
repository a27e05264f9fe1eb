"""Writes the vectors of this directory with Basis Universal's own encoder: pip install alktx2==0.1.7 numpy pillow

NAME.ktx2 is compressed, NAME.png what its own decoder makes of it.
"""

import alktx2
import numpy as np

y, x = np.mgrid[0:24, 0:40]
texels = np.stack([x * 6, y * 10, (x // 8 + y // 8) % 2 * 200 + 20, 255 - 5 * x], -1).astype(np.uint8)
opaque = texels.copy()
opaque[..., 3] = 255
for name, image, options in [
    ("etc1s", texels, dict(codec="etc1s", quality=80)),
    ("uastc", texels, dict(codec="uastc", zstd_supercompression_level=9)),
    ("opaque", opaque, dict(codec="uastc", mipmaps=True)),
]:
    packed = alktx2.encode_raw_rgba_to_ktx2(image.tobytes(), 40, 24, True, **options)
    open(name + ".ktx2", "wb").write(packed)
    decoded, _ = alktx2.decode_ktx2_to_bytes(packed)
    open(name + ".png", "wb").write(decoded)
