"""A robot without ROS for the server's tests: the office of hyselam_conversation, a talk that notes all it hears, a record of what was asked
for; and a server in a thread. No test; others import it."""
import asyncio
import os
import pathlib
import sys
import threading
import time
import types
import xml.etree.ElementTree as ElementTree

import numpy as np

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE.parent
sys.path[:0] = [str(PACKAGE / "scripts"), str(PACKAGE / "../../scripts")]

from free_port import free_port  # noqa: E402, F401 (for the tests)
from hyselam_web import access, app, reports, sights, tiles, world  # noqa: E402
from hyselam_web.requests import Refused  # noqa: E402

OFFICE = PACKAGE.parent / "hyselam_conversation/maps/office.xml"
X = "{urn:hyselam:topological_map:1}"
WAIT = 90.0 * float(os.environ.get("HYSELAM_SLOWNESS", "1"))
RESOLUTION = 0.05


def wait_until(condition, what):
    deadline = time.monotonic() + WAIT
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {WAIT:.0f} s: {what() if callable(what) else what}")
        time.sleep(0.01)


class SharedWorld(world.World):
    """Of the server's thread and of the test's."""

    def __init__(self):
        super().__init__()
        self.lock = threading.RLock()


def locked(name):
    def call(self, *args, **kwargs):
        with self.lock:
            return getattr(world.World, name)(self, *args, **kwargs)
    return call


for each in ("next_version", "set", "get", "set_table", "table", "item", "append", "log", "delta"):
    setattr(SharedWorld, each, locked(each))


def office():
    """Places and doors as in the messages of TopoEngine."""
    root = ElementTree.parse(OFFICE).getroot()
    result = types.SimpleNamespace(places=[], edges=[])

    def point(element):
        return types.SimpleNamespace(x=float(element.get("x")), y=float(element.get("y")), z=0.0)
    for each in root.iter(X + "place"):
        if each.get("kind") is None:
            continue
        numbers = [float(v) for v in each.find(X + "outline").text.split()]
        result.places.append(types.SimpleNamespace(
            id=int(each.get("id")), kind={"room": 0, "corridor": 1}[each.get("kind")], words=[], walls=[], area=float(each.get("area")), has_centre=True,
            centre=point(each.find(X + "centre")), outline_x=numbers[0::2], outline_y=numbers[1::2]))
    for edge in root.iter(X + "edge"):
        doors = [types.SimpleNamespace(id=int(d.get("id")), real=d.get("real", "true") != "false", state=0, position=point(d.find(X + "position")),
                                       normal=point(d.find(X + "normal")), width=float(d.get("width"))) for d in edge.iter(X + "door")]
        result.edges.append(types.SimpleNamespace(a=int(edge.get("a")), b=int(edge.get("b")), doors=doors, words=[]))
    return result


def inside(xs, ys, x, y):
    """Which points of two arrays lie in a polygon."""
    odd = np.zeros(x.shape, bool)
    for i in range(len(xs)):
        ax, ay, bx, by = xs[i], ys[i], xs[i - 1], ys[i - 1]
        if ay != by:
            odd ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return odd


def office_grid(building):
    """Free in places and doors, walls around."""
    width, height = int(42.2 / RESOLUTION), int(17.2 / RESOLUTION)
    x, y = np.meshgrid((np.arange(width) + 0.5) * RESOLUTION - 0.6, (np.arange(height) + 0.5) * RESOLUTION - 0.6)
    free = np.zeros((height, width), bool)
    for place in building.places:
        free |= inside(place.outline_x, place.outline_y, x, y)
    for edge in building.edges:
        for d in edge.doors:
            along = -(x - d.position.x) * d.normal.y + (y - d.position.y) * d.normal.x
            across = (x - d.position.x) * d.normal.x + (y - d.position.y) * d.normal.y
            free |= (abs(along) < d.width / 2) & (abs(across) < 0.2)
    near = free.copy()
    for axis in (0, 1):
        for step in (-3, 3, -1, 1):
            near |= np.roll(near, step, axis)
    grid = np.full((height, width), -1, np.int8)
    grid[near] = 100
    grid[free] = 0
    return grid


class FakeRobot:
    def __init__(self, with_map=True):
        self.world, self.tiles = SharedWorld(), tiles.MapTiles()
        self.asked, self.stops, self.cancels, self.hearers, self.time = [], 0, 0, 1, 0.0
        self.answer = lambda name, fields, role: {}
        self.todo = []  # called within the server's loop
        self.building = office()
        self.names, self.told, self.stop_language = {}, [], ""
        self.world.set("reach", {"master": True})
        self.world.set("can", {"save": True})
        if with_map:
            self.show_map(office_grid(self.building), RESOLUTION, (-0.6, -0.6, 0.0))
            self.show_places()
            self.world.set("pose", sights.pose(10.0, 8.0, 0.3))
            self.world.set("here", {"place": 11, "name": "", "sure": False, "door": False})
            self.world.set("names", [])

    def show_map(self, grid, resolution, origin):
        prepared = self.tiles.prepare(grid.shape[1], grid.shape[0], resolution, origin, grid.tobytes())
        self.tiles.commit(prepared, self.world.next_version)
        self.world.set("map", dict(self.tiles.info, sum=sum(v for v, p in self.tiles.tiles.values() if p) % 2 ** 32))

    def show_places(self):
        for place in self.building.places:
            place.words = [types.SimpleNamespace(text=n, confirmed=sure) for n, sure in self.names.get(place.id, [])]
        self.world.set_table("places", sights.places(self.building))
        self.world.set_table("doors", sights.doors(self.building))

    def tell_wall(self, name, fields):
        if name == "wall":
            wall = {end: round(fields[end], 2) for end in ("ax", "ay", "bx", "by")}
        else:
            door = self.world.item("doors", fields["door"])
            dx, dy = -door["ny"] * (door["w"] / 2 + 0.1), door["nx"] * (door["w"] / 2 + 0.1)
            wall = {"ax": sights.cm(door["x"] - dx), "ay": sights.cm(door["y"] - dy), "bx": sights.cm(door["x"] + dx), "by": sights.cm(door["y"] + dy)}
        self.told.append(dict(wall, v=name == "shut"))
        self.show_walls()

    def show_walls(self):
        self.world.set_table("told", {str(i + 1): wall for i, wall in enumerate(self.told)})

    def say(self, who, text):
        self.world.append("talk", {"i": self.world.version + 1, "w": who, "s": text, "t": int(time.time())})
        self.world.set("asked", sights.question(text, 11) if who == "robot" else None)

    def collect(self):
        while self.todo:
            self.todo.pop(0)()

    def later(self, call):
        """In the server's loop, and waits for it."""
        done = threading.Event()
        self.todo.append(lambda: (call(), done.set()))
        wait_until(done.is_set, "the server's loop")

    def now(self):
        return self.time

    def stop(self, say=True, language=""):
        self.stops += say
        self.stop_language = language
        self.cancels += 1
        return self.hearers

    async def act(self, name, fields, role):
        self.asked.append((name, fields, role))
        if name == "say":
            self.say("human", fields["text"])
            self.world.set("undo", "" if fields["text"] == "Undo that." else fields["text"])
            self.say("robot", "Noted: " + fields["text"])
            return {"answers": ["Noted: " + fields["text"]]}
        if name == "name":
            if self.world.item("places", fields["place"]) is None:
                raise Refused("unknown", "there is no such place")
            self.names[fields["place"]] = [(n, True) for n in fields["names"]]
            self.show_places()
        if name == "try":
            return {"understood": "xyzzy" not in fields["text"]}
        if name in ("wall", "shut"):
            self.tell_wall(name, fields)
        if name == "unwall":
            self.told = [wall for wall in self.told if wall["v"] != fields["virtual"] or any(abs(wall[end] - fields[end]) > 0.3 for end in ("ax", "ay", "bx", "by"))]
            self.show_walls()
        if name == "learn":
            self.world.set("learning", fields["on"])
        return self.answer(name, fields, role)


class ServedRobot:
    """The server of a robot, in a thread of its own."""

    def __init__(self, robot=None, tokens="", port=0, recorder=None, report_folder="", language="en"):
        self.robot = robot or FakeRobot()
        self.server = app.Server(self.robot, access.Access(access.parse_tokens(tokens), ["robot.test"]), app.static_files(str(PACKAGE / "www")),
                                 reports.Reports(report_folder), recorder, language)
        self.port, self._loop, self._ready = port, None, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        wait_until(self._ready.is_set, "the server")

    def _run(self):
        self._loop = asyncio.new_event_loop()
        asyncio.set_event_loop(self._loop)

        def ready(port):
            self.port = port
            self._ready.set()
        self._task = self._loop.create_task(self.server.run_forever("127.0.0.1", self.port, ready=ready))
        try:
            self._loop.run_until_complete(self._task)
        except asyncio.CancelledError:
            pass
        self._loop.run_until_complete(self._loop.shutdown_asyncgens())

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}"

    def close(self):
        self._loop.call_soon_threadsafe(self._task.cancel)
        self._thread.join(WAIT)
