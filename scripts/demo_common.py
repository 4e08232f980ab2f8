"""What the acts of the demo and its page share: files of the output folder, and what is true in the simulated building."""
import json
import pathlib
import re
import subprocess
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "src/hyselam_common/scripts"))

import rospy_threads  # noqa: E402, F401
from html_page import write_page  # noqa: E402, F401 (for the reports)

PLAN = ROOT / "src/hyselam_sim/plans/office.yaml"
ROUTE = ROOT / "src/hyselam_sim/routes/office.yaml"
THINGS = ROOT / "scripts/demo_things.yaml"
STORY = ROOT / "scripts/demo_story.txt"
CORRIDORS = {"west corridor", "middle of the corridor"}  # two points of the corridor have a name in the plan


class Silence(RuntimeError):
    """What was waited for did not come."""


def read(out, name):
    return json.loads((out / "log" / f"{name}.json").read_text())


def write(out, name, value):
    (out / "log" / f"{name}.json").write_text(json.dumps(value, indent=1) + "\n")


def tool(*command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(str(c) for c in command[:3])}: {done.stdout.strip()}")
    return done.stdout


def report_command(usage, checks, page):
    """The command line of a report: `check ACT OUT`, with {act: check of the folder}, or `page OUT`."""
    command, rest = (sys.argv + [""])[1], sys.argv[2:]
    if command == "check" and len(rest) == 2 and rest[0] in checks:
        passed, said = checks[rest[0]](pathlib.Path(rest[1]))
        print(("ok      " if passed else "FAILED  ") + said)
        return 0 if passed else 1
    if command == "page" and len(rest) == 1:
        page(pathlib.Path(rest[0]))
        return 0
    print(usage.split("\n\n")[1].strip(), file=sys.stderr)
    return 2


def common_name(name):
    """The name of a place of the plan, as people say it."""
    return "corridor" if name in CORRIDORS else name


def means(said, name):
    """Whether what somebody calls a room is its name on the plan: "Anna" or "Anna's" of Anna's office, "the lab" of the laboratory."""
    def words(text):
        short = {"lab": "laboratory", "loo": "toilet", "toilets": "toilet"}
        of = re.sub("['\u2019]s?(?![a-z])", "", text.lower()).split()
        return {short.get(word, word) for word in of} - {"the", "office", "room"}
    return bool(words(name)) and words(said) == words(name)


def start():
    """Where the first robot begins in the plan: the origin of the map. Heading 0."""
    at = yaml.safe_load(ROUTE.read_text())["start"]["at"]
    return next(p["at"] for p in yaml.safe_load(PLAN.read_text())["places"] if p["name"] == at)


class PlaceGrid:
    """Which place of the topological map a point of the map is on."""

    def __init__(self, out):
        import numpy as np
        from PIL import Image
        self.labels = np.array(Image.open(out / "places/labels.png")).astype(int)
        self.info = yaml.safe_load((out / "building/map.yaml").read_text())

    def cell(self, x, y):
        """Row (downwards) and column of a point of the map [m]."""
        ox, oy = self.info["origin"][:2]
        resolution = self.info["resolution"]
        return self.labels.shape[0] - 1 - int((y - oy) / resolution), int((x - ox) / resolution)

    def place(self, x, y, margin=6):
        """Id of the place of a point, or of most cells around it; 0: none."""
        import numpy as np
        row, column = self.cell(x, y)
        height, width = self.labels.shape
        if 0 <= row < height and 0 <= column < width and self.labels[row, column]:
            return int(self.labels[row, column])
        around = self.labels[max(0, row - margin):row + margin + 1, max(0, column - margin):column + margin + 1]
        found = around[around > 0]
        return int(np.bincount(found.ravel()).argmax()) if found.size else 0


def truth(out):
    """What people call each place of the map: {place id: name}, by the points that the plan names."""
    grid, (x0, y0), names = PlaceGrid(out), start(), {}
    for place in yaml.safe_load(PLAN.read_text())["places"]:
        found = grid.place(place["at"][0] - x0, place["at"][1] - y0)
        if found:
            names[found] = common_name(place["name"])
    return names


def true_poses(bag):
    """Of a simulated run, in the frame of the map: lists of times [s], x, y [m]."""
    import rosbag
    x0, y0 = start()
    with rosbag.Bag(str(bag)) as recorded:
        rows = [(m.header.stamp.to_sec(), m.pose.pose.position.x - x0, m.pose.pose.position.y - y0)
                for _, m, _ in recorded.read_messages(["/ground_truth"])]
    return [list(column) for column in zip(*rows)]


def trajectory(path):
    """Of a TUM file: rows of time [s], x, y [m]."""
    lines = pathlib.Path(path).read_text().splitlines()
    return [tuple(float(v) for v in line.split()[:3]) for line in lines if line and not line.startswith("#")]


def interpolated(true, times):
    """True x and y at these times [m]."""
    import numpy as np
    return np.interp(times, true[0], true[1]), np.interp(times, true[0], true[2])


def inside(polygon, x, y):
    """Whether a polygon, a list of corners, holds a point."""
    odd = False
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1]):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            odd = not odd
    return odd


class Pictures:
    """One rviz for all pictures; without them nothing happens."""

    def __init__(self, out, wanted, size="1600x760"):
        self.out, self.wanted, self.server = out / "live", wanted, None
        self.out.mkdir(exist_ok=True)
        if wanted and size:
            self.server = subprocess.Popen(
                [ROOT / "scripts/rviz_shot", ROOT / "rviz/hyselam.rviz", self.out, "--serve", "--size", size, "--fit-map",
                 "map_metadata", "--settle", "2", "--frame-rate", "3", "--hide", "Camera image"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def take(self, name):
        if self.server:
            self.server.stdin.write(name + "\n")
            self.server.stdin.flush()
            if not self.server.stdout.readline():
                raise Silence(f"rviz gave no picture {name}")

    def take_near(self, name, x, y, z, distance):
        if self.server:
            tool(ROOT / "scripts/rviz_shot", ROOT / "rviz/hyselam.rviz", self.out / f"{name}.png", "--size", "1200x760",
                 "--look-at", x, y, z, distance, "--settle", "2", "--frame-rate", "3", "--hide", "Camera image", "--hide", "Visual places",
                 # Names of rooms are made for the whole map: so near they would be larger than the things.
                 "--hide", "Places with names/names")

    def take_fresh(self, name, size):
        """By an rviz of its own: the map has grown meanwhile."""
        if self.wanted:
            tool(ROOT / "scripts/rviz_shot", ROOT / "rviz/hyselam.rviz", self.out / f"{name}.png", "--size", size, "--fit-map", "map_metadata",
                 "--settle", "3", "--frame-rate", "3", "--hide", "Camera image", "--hide", "SLAM and words")

    def close(self):
        if self.server:
            self.server.stdin.close()
            self.server.wait(30)
