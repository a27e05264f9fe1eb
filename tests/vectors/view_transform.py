#!/usr/bin/env python3
"""What Blender shows of linear light on an sRGB screen, by its configuration of OpenColorIO.

    pip install opencolorio==2.6.0 bpy==5.0.1
    python3 tests/vectors/view_transform.py CONFIG.ocio > tests/vectors/view_transform.json

CONFIG.ocio is Blender's, in bpy's datafiles/colormanagement; Blender 5.0.1 made the values that are kept.
"""
import json
import sys

import PyOpenColorIO as ocio

VIEWS = ["Standard", "Raw", "Khronos PBR Neutral", "AgX"]
GREYS = [0, 0.001, 0.01, 0.05, 0.18, 0.5, 0.8, 1, 2, 4, 8, 16]
COLOURS = [[0.8, 0.1, 0.05], [0.05, 0.3, 0.9], [0.1, 0.6, 0.2], [5, 0.2, 0.1], [0.1, 6, 0.3], [0.2, 0.4, 7],
           [0.02, 0.01, 0.005], [20, 10, 2], [1, 0.9, 0.7]]


def main():
    config = ocio.Config.CreateFromFile(sys.argv[1])
    found = {}
    for view in VIEWS:
        transform = ocio.DisplayViewTransform(src="Linear Rec.709", display="sRGB", view=view)
        shown = config.getProcessor(transform).getDefaultCPUProcessor()
        lights = [[x] * 3 for x in GREYS] + COLOURS
        found[view] = [[light, [round(x, 5) for x in shown.applyRGB(light)]] for light in lights]
    print(json.dumps(found, indent=1))


main()
