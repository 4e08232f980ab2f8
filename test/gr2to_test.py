#!/usr/bin/env python3
"""Maps into the nodelet Gr2To, places out: good maps, bad maps, many maps, OctoMaps, names and files."""
import copy
import functools
import math
import os
import struct
import tempfile
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PointStamped
from hyselam_msgs.msg import AugmentedTopologicalMap, Place
from hyselam_msgs.srv import PlaceAt, TopologicalMapPath
from nav_msgs.msg import OccupancyGrid
from nodelet.srv import NodeletList, NodeletUnload
from octomap_msgs.msg import Octomap
from visualization_msgs.msg import Marker, MarkerArray

from localization_rig import Listener, load_nodelet, make_map, newest_status, values_of, wait_until, WAIT

RESOLUTION = 0.05
LEFT, RIGHT, DOOR = (2.0, 2.0), (6.5, 2.0), (4.05, 2.0)  # middles of the two rooms and of their door


def two_rooms(door=True, **geometry):
    """4 m x 4 m and 5 m x 4 m with a wall of 0.1 m between them and a door of 0.9 m in it."""
    width, height = int(9.5 / RESOLUTION), int(4.5 / RESOLUTION)

    def value(x, y):
        inside = 0 <= y < 4 and (0 <= x < 4 or 4.1 <= x < 9.1)
        through = door and 4 <= x < 4.1 and 1.55 <= y < 2.45
        near = -0.1 <= y < 4.1 and -0.1 <= x < 9.2
        return 0 if inside or through else 100 if near else -1
    cells = [value((c + 0.5) * RESOLUTION - 0.2, (r + 0.5) * RESOLUTION - 0.2)
             for r in range(height) for c in range(width)]
    geometry.setdefault("x", -0.2)
    geometry.setdefault("y", -0.2)
    return make_map(cells, width, height, RESOLUTION, **geometry)


def octree(cells, resolution):
    """The bits of an OctoMap; `cells` maps (x, y, z) to occupied or not."""
    def node(members, depth):
        half = 1 << (15 - depth)
        children = [{} for _ in range(8)]
        for (x, y, z), occupied in members.items():
            i = (x >= half) + 2 * (y >= half) + 4 * (z >= half)
            children[i][x % half, y % half, z % half] = occupied
        bits, deeper = 0, b""
        for i, child in enumerate(children):
            if not child:
                continue
            if depth == 15:
                bits |= (2 if child[0, 0, 0] else 1) << (2 * i)
            else:
                bits |= 3 << (2 * i)
                deeper += node(child, depth + 1)
        return struct.pack("<H", bits) + deeper
    msg = Octomap()
    msg.header.frame_id = "map"
    msg.binary, msg.id, msg.resolution = True, "OcTree", resolution
    data = node({(x + 32768, y + 32768, z + 32768): o for (x, y, z), o in cells.items()}, 0)
    msg.data = list(struct.unpack(f"{len(data)}b", data))
    return msg


def storey(floor, resolution=0.1):
    """The two rooms as a storey with floor and ceiling, and a table in the left one."""
    cells = {}
    for cx in range(-2, 94):
        for cy in range(-2, 43):
            x, y = (cx + 0.5) * resolution, (cy + 0.5) * resolution
            room = 0 <= y < 4 and (0 <= x < 4 or 4.1 <= x < 9.1)
            door = 4 <= x < 4.1 and 1.5 <= y < 2.4
            table = 1 <= x < 2 and 1 <= y < 2
            for cz in range(-1, 25):
                z = (cz + 0.5) * resolution
                solid = z < 0 or z > 2.3 or not (room or (door and z < 2.0)) or (table and 0.7 < z < 0.8)
                cells[cx, cy, cz + int(round(floor / resolution))] = solid
    return cells


@functools.lru_cache(None)
def building(*floors):
    """The OctoMap of storeys at these heights."""
    cells = {}
    for floor in floors:
        cells.update(storey(floor))
    return octree(cells, 0.1)


class Rig:
    """One nodelet in the manager, in a namespace of its own."""

    def __init__(self, name, **params):
        self.name, self.node, self.given = name, f"/{name}/gr2to", 0
        params.setdefault("diagnostic_period", 0.05)
        for key, value in params.items():
            rospy.set_param(f"{self.node}/{key}", value)
        kind, topic = (Octomap, "octomap") if params.get("use_octomap") else (OccupancyGrid, "map")
        self.input = rospy.Publisher(f"/{name}/{topic}", kind, queue_size=100)
        self.maps = Listener(f"/{name}/topological_map", AugmentedTopologicalMap)
        self.markers = Listener(f"/{name}/topological_markers", MarkerArray)
        self.projected = Listener(f"/{name}/projected_map", OccupancyGrid)
        self.diagnostics = Listener(f"/{name}/diagnostics", DiagnosticArray)
        self.loaded = load_nodelet("hyselam_topo/Gr2To", self.node, {"/diagnostics": f"/{name}/diagnostics"})
        if self.loaded:
            outputs = (self.maps, self.markers, self.diagnostics)
            wait_until(lambda: self.input.get_num_connections() > 0
                       and all(o.subscriber.get_num_connections() > 0 for o in outputs), "no connections")

    def close(self):
        if self.loaded:
            rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)(self.node)
        for listener in (self.maps, self.markers, self.projected, self.diagnostics):
            listener.close()
        self.input.unregister()

    def give(self, msg):
        """Publishes and waits until it has been used or refused, and what came of it is here."""
        self.given += 1
        outputs = {listener: len(listener.messages) for listener in (self.maps, self.markers)}
        segmented = int(self.value("maps segmented") or 0)
        self.input.publish(msg)
        wait_until(lambda: self.value("maps received") == str(self.given) and self.value("segmenting") == "False"
                   and self.done() == self.given, lambda: str(self.values()))
        for listener, before in outputs.items():  # other connections than that of the diagnosis
            expected = before + int(self.value("maps segmented")) - segmented
            wait_until(lambda: len(listener.messages) >= expected, lambda: f"{expected} messages: {self.values()}")

    def done(self):
        return sum(int(self.value(f"maps {what}") or 0) for what in ("segmented", "unchanged", "refused"))

    def status(self):
        return newest_status(self.diagnostics, lambda name: name == self.node[1:] + ": places") or DiagnosticStatus()

    def values(self):
        return values_of(self.status())

    def value(self, key):
        value = self.values().get(key)
        return value.capitalize() if value in ("true", "false") else value

    def newest(self):
        """The map that belongs to what was given last."""
        stamp = self.maps.wait().header.stamp
        self.markers.wait()
        return max(self.maps.messages, key=lambda m: m.header.seq) if stamp.is_zero() else self.maps.messages[-1]

    def service(self, name, kind):
        rospy.wait_for_service(f"/{self.name}/{name}", WAIT)
        return rospy.ServiceProxy(f"/{self.name}/{name}", kind)

    def place_at(self, x, y, reach=0.0, frame=""):
        point = PointStamped()
        point.header.frame_id = frame
        point.point.x, point.point.y = x, y
        return self.service("place_at", PlaceAt)(point, reach)


class Gr2ToTest(unittest.TestCase):
    cases = 0

    def rig(self, **params):
        Gr2ToTest.cases += 1
        rig = Rig(f"case{Gr2ToTest.cases}", **params)
        self.addCleanup(rig.close)
        return rig

    def temporary(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return folder.name

    def assert_two_rooms(self, rig, transform=lambda x, y: (x, y)):
        rig.maps.wait()  # the map may come after the diagnosis that tells of it
        msg = rig.maps.messages[-1]
        self.assertEqual(len(msg.places), 2)
        self.assertEqual([len(e.doors) for e in msg.edges], [1])
        self.assertAlmostEqual(sum(p.area for p in msg.places), 36.0, delta=2.0)
        self.assertEqual(len(msg.grid.labels), msg.grid.width * msg.grid.height)
        door = msg.edges[0].doors[0]
        x, y = transform(*DOOR)
        self.assertLess(math.hypot(door.position.x - x, door.position.y - y), 0.2)
        self.assertAlmostEqual(door.width, 0.9, delta=0.2)
        left, right = rig.place_at(*transform(*LEFT)), rig.place_at(*transform(*RIGHT))
        self.assertTrue(left.found and right.found)
        self.assertNotEqual(left.id, right.id)
        return left.id, right.id

    def test_places_doors_and_walls_come_out(self):
        rig = self.rig()
        grid = two_rooms()
        grid.header.stamp = rospy.Time(1234, 500)
        rig.give(grid)
        msg = rig.maps.wait()
        self.assertEqual((msg.header.frame_id, msg.header.stamp), ("map", grid.header.stamp))
        self.assert_two_rooms(rig)
        for place in msg.places:
            self.assertEqual(place.kind, Place.ROOM)
            self.assertGreaterEqual(len(place.walls), 4)
            self.assertTrue(all(abs(math.hypot(w.normal.x, w.normal.y) - 1) < 1e-6 for w in place.walls))
        self.assertEqual(rig.status().level, DiagnosticStatus.OK)
        # Latched: who comes late gets it too.
        late = Listener(f"/{rig.name}/topological_map", AugmentedTopologicalMap)
        self.assertEqual(len(late.wait().places), 2)
        late.close()

    def test_markers_show_every_part(self):
        rig = self.rig()
        rig.give(two_rooms())
        markers = rig.markers.wait().markers
        self.assertEqual(markers[0].action, Marker.DELETEALL)
        self.assertEqual({m.ns for m in markers[1:]}, {"places", "names", "walls", "doors", "graph"})
        self.assertTrue(all(m.header.frame_id == "map" for m in markers))
        self.assertEqual({m.text for m in markers if m.type == Marker.TEXT_VIEW_FACING}, {"room 1", "room 2"})

    def test_place_at_answers(self):
        rig = self.rig()
        self.assertIn("no topological map yet", rig.place_at(*LEFT).message)
        rig.give(two_rooms())
        left = rig.place_at(*LEFT, frame="map")
        self.assertTrue(left.found)
        self.assertEqual((left.distance, left.word, left.kind), (0.0, "", Place.ROOM))
        self.assertFalse(rig.place_at(-0.1, 2.0).found)
        near = rig.place_at(-0.1, 2.0, reach=0.5)
        self.assertEqual(near.id, left.id)
        self.assertAlmostEqual(near.distance, 0.1, delta=0.06)
        self.assertIn("no place", rig.place_at(100.0, 100.0, reach=1.0).message)
        self.assertIn("frame", rig.place_at(*LEFT, frame="odom").message)
        self.assertIn("max_distance", rig.place_at(*LEFT, reach=-1.0).message)
        self.assertFalse(rig.place_at(math.nan, 0.0, reach=1.0).found)

    def test_turned_and_moved_origin(self):
        rig = self.rig()
        for yaw, x0, y0 in ((0.3, 10.0, -5.0), (-2.0, -3.0, 7.0)):
            def transform(x, y, yaw=yaw, x0=x0, y0=y0):
                x, y = x + 0.2, y + 0.2
                return (x0 + math.cos(yaw) * x - math.sin(yaw) * y, y0 + math.sin(yaw) * x + math.cos(yaw) * y)
            rig.give(two_rooms(x=x0, y=y0, yaw=yaw))
            self.assert_two_rooms(rig, transform)

    def test_bad_maps_are_refused_and_the_good_one_stays(self):
        rig = self.rig()
        rig.give(two_rooms())
        ids = self.assert_two_rooms(rig)
        count = len(rig.maps.messages)

        def change(**fields):
            grid = two_rooms()
            for name, value in fields.items():
                owner = grid
                *path, last = name.split("__")
                for part in path:
                    owner = getattr(owner, part)
                setattr(owner, last, value)
            return grid
        bad = [("empty", change(data=[], info__width=0, info__height=0)),
               ("no data", change(data=[])),
               ("too few cells", change(data=two_rooms().data[:-1])),
               ("resolution 0", change(info__resolution=0.0)),
               ("negative resolution", change(info__resolution=-0.05)),
               ("resolution NaN", change(info__resolution=math.nan)),
               ("origin NaN", change(info__origin__position__x=math.nan)),
               ("origin infinite", change(info__origin__position__y=math.inf)),
               ("turn NaN", change(info__origin__orientation__z=math.nan)),
               ("turn all zero", change(info__origin__orientation__w=0.0)),
               ("huge", change(info__width=100000, info__height=100000)),
               ("overflow", change(info__width=65536, info__height=65536, data=[])),
               ("value 101", change(data=[101] * len(two_rooms().data))),
               ("value -2", change(data=[-2] * len(two_rooms().data)))]
        for number, (what, grid) in enumerate(bad, 1):
            rig.give(grid)
            self.assertEqual(rig.value("maps refused"), str(number), what)
            self.assertEqual(rig.status().level, DiagnosticStatus.ERROR, what)
            self.assertIn("map:", rig.status().message, what)
            self.assertEqual(rig.place_at(*LEFT).id, ids[0], what)
        self.assertEqual(len(rig.maps.messages), count)
        rig.give(two_rooms(x=-0.25))
        self.assertEqual(rig.status().level, DiagnosticStatus.OK)
        self.assertEqual(self.assert_two_rooms(rig), ids)

    def test_maps_without_places(self):
        rig = self.rig()
        for value in (-1, 100):
            grid = two_rooms()
            grid.data = [value] * len(grid.data)
            rig.give(grid)
            self.assertEqual(len(rig.maps.wait().places), 0)
            self.assertFalse(rig.place_at(*LEFT, reach=5.0).found)
        tiny = make_map([0], 1, 1, 0.05)
        rig.give(tiny)
        self.assertEqual(rig.value("maps refused"), "0")

    def test_same_map_is_not_segmented_again(self):
        rig = self.rig()
        rig.give(two_rooms())
        count = len(rig.maps.messages)
        rig.give(two_rooms())
        self.assertEqual((rig.value("maps segmented"), rig.value("maps unchanged")), ("1", "1"))
        self.assertEqual(len(rig.maps.messages), count)

    def test_newest_of_many_maps_wins(self):
        rig = self.rig()
        large = [two_rooms(x=-0.2 - 0.05 * i) for i in range(30)]
        for grid in large:
            rig.input.publish(grid)
        wait_until(lambda: rig.maps.messages and abs(rig.maps.messages[-1].grid.origin.x - (-1.65)) < 1e-6,
                   "the last map")
        wait_until(lambda: rig.value("segmenting") == "False" and rig.value("maps received") is not None, "the end")
        self.assertLessEqual(int(rig.value("maps segmented")), len(large))
        # In order, and never an older one after a newer one.
        origins = [m.grid.origin.x for m in rig.maps.messages]
        self.assertEqual(origins, sorted(origins, reverse=True))

    def test_ids_and_names_stay(self):
        rig = self.rig()
        rig.give(two_rooms())
        left, right = self.assert_two_rooms(rig)
        path = os.path.join(self.temporary(), "map.xml")
        answer = rig.service("save_topological_map", TopologicalMapPath)(path)
        self.assertTrue(answer.success, answer.message)
        with open(path) as file:
            text = file.read()
        place = text.index(f'<place id="{left}"')
        end = text.index(">", place) + 1
        with open(path, "w") as file:
            text = text[:end] + '<word text="kitchen" confirmed="true"/>' + text[end:]
            self.assertIn('frame_id="map"', text)
            file.write(text.replace('frame_id="map"', 'frame_id="/map"'))  # tf2 wants it without the slash
        answer = rig.service("load_topological_map", TopologicalMapPath)(path)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(rig.place_at(*LEFT).word, "kitchen")
        # A chair in the room, and a map that has grown to the left.
        grid = two_rooms(x=-0.2)
        data = list(grid.data)
        for row in range(20, 26):
            for column in range(20, 26):
                data[row * grid.info.width + column] = 100
        grid.data = data
        rig.give(grid)
        self.assertEqual(rig.place_at(*LEFT).word, "kitchen")
        self.assertEqual(self.assert_two_rooms(rig), (left, right))
        # Another node begins with the file.
        other = self.rig(map_file=path)
        self.assertEqual(other.place_at(*LEFT, frame="map").word, "kitchen")
        self.assertEqual(other.maps.wait().header.frame_id, "map")
        other.give(grid)
        self.assertEqual(other.place_at(*LEFT).word, "kitchen")

    def test_files_that_cannot_be_used(self):
        rig = self.rig()
        folder = self.temporary()
        save, load = (rig.service(n + "_topological_map", TopologicalMapPath) for n in ("save", "load"))
        self.assertIn("no topological map yet", save(folder + "/map.xml").message)
        rig.give(two_rooms())
        ids = self.assert_two_rooms(rig)
        self.assertTrue(save(folder + "/map.graphml").success)
        for path in ("/nowhere/map.xml", folder + "/map.png", ""):
            self.assertFalse(save(path).success)
        self.assertEqual(os.listdir(folder), ["map.graphml"])
        with open(folder + "/bad.xml", "w") as file:
            file.write('<!DOCTYPE m [<!ENTITY a "b">]><topological_map/>')
        self.assertIn("entities", load(folder + "/bad.xml").message)
        self.assertIn("topological map", load(folder + "/map.graphml").message)
        self.assertFalse(load("/nowhere/map.xml").success)
        self.assertEqual(self.assert_two_rooms(rig), ids)

    def test_bad_parameters_stop_the_nodelet_only(self):
        for params in ({"mode": "magic"}, {"free_max": 200}, {"z_min": 2.0, "z_max": 1.0}, {"marker_alpha": "red"},
                       {"map_file": "/nowhere/map.xml"}):
            self.assertFalse(self.rig(**params).loaded, params)
        self.assertEqual(list(rospy.ServiceProxy("/manager/list", NodeletList)().nodelets), [])

    def test_mode_of_the_thesis(self):
        rig = self.rig(mode="thesis")
        rig.give(two_rooms())
        self.assertGreaterEqual(len(rig.maps.wait().places), 2)

    def test_octomap_is_pressed(self):
        rig = self.rig(use_octomap=True)
        rig.give(building(0.0))
        self.assert_two_rooms(rig)
        grid = rig.projected.wait()
        at = grid.info.width * int((1.5 - grid.info.origin.position.y) / grid.info.resolution) + int(
            (1.5 - grid.info.origin.position.x) / grid.info.resolution)
        self.assertEqual(grid.data[at], 0, "the table is gone")

    def test_octomaps_that_cannot_be_used(self):
        rig = self.rig(use_octomap=True)
        good = building(0.0)
        for number, (what, change) in enumerate((
                ("cut off", lambda m: setattr(m, "data", m.data[:-1])),
                ("cut off", lambda m: setattr(m, "data", m.data[:1])),
                ("deeper than 16", lambda m: setattr(m, "data", [-1] * 100000)),
                ("resolution", lambda m: setattr(m, "resolution", 0.0)),
                ("resolution", lambda m: setattr(m, "resolution", math.nan)),
                ("not known", lambda m: setattr(m, "id", "Bush")),
                ("no level floor", lambda m: setattr(m, "data", []))), 1):
            msg = copy.deepcopy(good)
            change(msg)
            rig.give(msg)
            self.assertIn(what, rig.status().message)
            self.assertEqual(rig.value("maps refused"), str(number))
        rig.give(building(0.0, 3.0))
        self.assertIn("2 storeys", rig.status().message)
        rig.give(good)
        self.assert_two_rooms(rig)

    def test_storey_can_be_chosen(self):
        rig = self.rig(use_octomap=True, storey=1)
        rig.give(building(0.0, 3.0))
        self.assert_two_rooms(rig)

    def test_parameters_change_while_it_runs(self):
        try:
            from dynamic_reconfigure.client import Client
        except ImportError:
            self.skipTest("dynamic_reconfigure is missing here")
        rig = self.rig()
        rig.give(two_rooms())
        client = Client(rig.node, timeout=WAIT)
        self.assertEqual(client.get_configuration(timeout=WAIT)["mode"], "default")
        client.update_configuration({"marker_alpha": 0.9})
        wait_until(lambda: any(abs(m.color.a - 0.9) < 1e-6 for m in rig.markers.messages[-1].markers
                               if m.ns == "places"), "markers in the new colour")
        self.assert_two_rooms(rig)
        self.assertEqual(client.update_configuration({"mode": "magic"})["mode"], "default")
        client.close()
        # The map of a file has no input to be segmented again, its markers change all the same.
        path = os.path.join(self.temporary(), "map.xml")
        self.assertTrue(rig.service("save_topological_map", TopologicalMapPath)(path).success)
        other = self.rig(map_file=path)
        client = Client(other.node, timeout=WAIT)
        client.update_configuration({"marker_alpha": 0.8})
        wait_until(lambda: other.markers.messages and any(
            abs(m.color.a - 0.8) < 1e-6 for m in other.markers.messages[-1].markers if m.ns == "places"),
            "markers of the file in the new colour")
        client.close()


if __name__ == "__main__":
    rospy.init_node("gr2to_test")
    rostest.rosrun("hyselam_bringup", "gr2to_test", Gr2ToTest)
