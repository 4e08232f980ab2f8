"""A saved map as a picture for a page, and where poses and trajectories lie in it."""
import base64
import io
import math
import pathlib

import yaml
from PIL import Image, ImageFilter

MAX_MAP_PIXELS = 1600  # a larger map is drawn smaller
MOST_POINTS = 2000  # of a trajectory that is drawn
COLORS = ["#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf"]
GOLDEN_ANGLE = 137.508  # [degrees] between the hues of more


def colors_of(names):
    """A color for each name."""
    return {name: COLORS[i] if i < len(COLORS) else f"hsl({i * GOLDEN_ANGLE % 360:.0f},75%,45%)" for i, name in enumerate(names)}


def points_of(trajectory):
    """Points of a TUM file, few enough to be drawn."""
    with pathlib.Path(trajectory).open() as lines:
        points = [tuple(float(word) for word in line.split()[1:3]) for line in lines if line.strip() and not line.startswith("#")]
    return points[::max(1, len(points) // MOST_POINTS)]


class MapPicture:
    def __init__(self, map_yaml, max_pixels=MAX_MAP_PIXELS):
        map_yaml = pathlib.Path(map_yaml)
        self._info = yaml.safe_load(map_yaml.read_text())
        image = Image.open(map_yaml.parent / self._info["image"])
        self._cells, self._scale = image.height, min(1.0, max_pixels / max(image.size))
        if self._scale < 1.0:
            # Walls of one cell must not vanish: the darkest of the cells that a pixel covers.
            reach = math.ceil(0.5 / self._scale)
            image = image.filter(ImageFilter.MinFilter(2 * reach - 1))
            image = image.resize((round(image.width * self._scale), round(image.height * self._scale)), Image.NEAREST)
        self.width, self.height = image.size
        png = io.BytesIO()
        image.save(png, "PNG")
        self.png = base64.b64encode(png.getvalue()).decode()

    def pixel(self, x, y):
        """Where a point of the map [m] is drawn: "x,y"."""
        left, bottom = self._info["origin"][:2]
        across, up = (x - left) / self._info["resolution"], (y - bottom) / self._info["resolution"]
        return f"{across * self._scale:.1f},{(self._cells - up) * self._scale:.1f}"

    def path(self, points):
        """Points [m] as the path of an SVG."""
        return "M" + "L".join(self.pixel(x, y) for x, y in points) if points else ""

    def figure(self, trajectories, colors):
        """What pages draw: the map and (name, TUM file) over it."""
        return {"width": self.width, "height": self.height, "png": self.png,
                "paths": [{"d": self.path(points_of(file)), "color": colors[name], "name": name} for name, file in trajectories]}
