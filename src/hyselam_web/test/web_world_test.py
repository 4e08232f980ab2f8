#!/usr/bin/env python3
"""What pages are told, tiles of maps, what is made of messages, transforms: without ROS."""
import base64
import math
import random
import struct
import sys
import types
import unittest
import zlib

import numpy as np

sys.dont_write_bytecode = True
import fake_robot  # noqa: E402, F401 (finds the package)
from hyselam_web import sights, tiles, transforms, world  # noqa: E402


def apply(state, message):
    """What a page does with a message, in a few lines."""
    if message is None:
        return
    if message.get("full"):
        state.clear()
    for name, change in message["d"].items():
        if name.startswith("table"):
            table = state.setdefault(name, {})
            for key in change.get("-", []):
                table.pop(key, None)
            table.update(change.get("+", {}))
        elif name.startswith("log"):
            state.setdefault(name, []).extend(change)
        else:
            state[name] = change
    state["v"] = message["v"]


class WorldTest(unittest.TestCase):
    def test_pages_that_listen_at_their_own_pace_know_the_same_in_the_end(self):
        for seed in range(30):
            rng, w = random.Random(seed), world.World()
            pages = [{"v": 0} for _ in range(5)]
            for step in range(200):
                kind = rng.randrange(3)
                if kind == 0:
                    w.set(f"value{rng.randrange(3)}", rng.randrange(4))
                elif kind == 1:
                    w.set_table(f"table{rng.randrange(2)}", {str(rng.randrange(6)): rng.randrange(3) for _ in range(rng.randrange(6))})
                else:
                    w.append("log", step)
                for page in pages:
                    if rng.random() < 0.2:
                        apply(page, w.delta(page["v"]))
            fresh = {"v": 0}
            for page in pages + [fresh]:
                apply(page, w.delta(page["v"]))
            for page in pages:
                tables = {k: v for k, v in page.items() if not (k.startswith("table") and not v)}
                self.assertEqual(tables, {k: v for k, v in fresh.items() if not (k.startswith("table") and not v)}, f"seed {seed}")

    def test_what_did_not_change_is_not_sent(self):
        w = world.World()
        self.assertTrue(w.set("pose", {"x": 1.0}))
        before = w.version
        self.assertFalse(w.set("pose", {"x": 1.0}))
        self.assertFalse(w.set_table("places", {}))
        self.assertEqual(w.version, before)
        self.assertIsNone(w.delta(before))

    def test_a_page_that_missed_too_many_removals_gets_all_anew(self):
        w = world.World()
        w.set("pose", 1)
        since = w.version
        for n in range(world.MAX_REMOVED + 10):
            w.set_table("places", {str(n): 0})
        self.assertTrue(w.delta(since)["full"])
        self.assertNotIn("full", w.delta(w.version - 1))

    def test_a_day_of_talk_takes_no_more_memory_than_an_hour(self):
        w = world.World()
        for n in range(10 * world.MAX_LOG):
            w.append("talk", n)
        self.assertEqual(w.log("talk"), list(range(9 * world.MAX_LOG, 10 * world.MAX_LOG)))

    def test_numbers_that_are_none_are_not_sent(self):
        with self.assertRaises(ValueError):
            world.to_text({"x": math.nan})


def cells_of(picture):
    """Classes of a tile's PNG, row 0 the lowest; read by hand, as the specification of PNG says."""
    assert picture[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, {}
    while at < len(picture):
        length, kind = struct.unpack_from(">I4s", picture, at)
        data = picture[at + 8:at + 8 + length]
        assert struct.unpack_from(">I", picture, at + 8 + length)[0] == zlib.crc32(kind + data)
        chunks[kind] = chunks.get(kind, b"") + data
        at += 12 + length
    width, height, depth, color = struct.unpack_from(">IIBB", chunks[b"IHDR"])
    assert (depth, color) == (2, 3) and width % 4 == 0
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, width // 4 + 1)
    assert not rows[:, 0].any()
    return np.stack([rows[:, 1:] >> shift & 3 for shift in (6, 4, 2, 0)], axis=2).reshape(height, width)[::-1]


def whole(map_tiles):
    """{(column, row) of a known cell: class}, from the tiles."""
    found = {}
    for (tx, ty), (_, picture) in map_tiles.tiles.items():
        if picture:
            cells = cells_of(picture)
            for y, x in np.argwhere(cells):
                found[(tx * tiles.SIDE + int(x), ty * tiles.SIDE + int(y))] = int(cells[y, x])
    return found


class TilesTest(unittest.TestCase):
    def setUp(self):
        self.version, self.tiles = 0, tiles.MapTiles()

    def number(self):
        self.version += 1
        return self.version

    def show(self, grid, origin=(0.0, 0.0, 0.0), resolution=0.1):
        grid = np.asarray(grid, np.int8)
        return self.tiles.commit(self.tiles.prepare(grid.shape[1], grid.shape[0], resolution, origin, grid.tobytes()), self.number)

    def test_tiles_hold_the_cells_of_the_map_wherever_it_lies(self):
        rng = np.random.default_rng(1)
        for origin in ((0.0, 0.0, 0.0), (-3.27, 12.81, 0.0), (-40.0, -0.1, 0.0)):
            grid = rng.choice([-1, 0, 10, 30, 64, 65, 100], (70, 300)).astype(np.int8)
            self.tiles = tiles.MapTiles()
            self.show(grid, origin)
            x0, y0 = round(origin[0] / 0.1), round(origin[1] / 0.1)
            kinds = {0: tiles.FREE, 10: tiles.FREE, 30: tiles.UNSURE, 64: tiles.UNSURE, 65: tiles.OCCUPIED, 100: tiles.OCCUPIED}
            expected = {(x0 + x, y0 + y): kinds[grid[y, x]] for y in range(70) for x in range(300) if grid[y, x] >= 0}
            self.assertEqual(whole(self.tiles), expected, origin)

    def test_a_map_that_grows_sends_only_what_changed(self):
        grid = np.zeros((600, 600), np.int8)
        self.assertEqual(self.show(grid), 9)
        self.assertEqual(self.show(grid), 0)
        larger = np.zeros((600, 900), np.int8)  # 300 cells more on the left
        larger[:, :300] = -1
        self.assertEqual(self.show(larger, (-30.0, 0.0, 0.0)), 0)
        larger[10, 310] = 100
        before = self.version
        self.assertEqual(self.show(larger, (-30.0, 0.0, 0.0)), 1)
        self.assertEqual(self.tiles.changed_since(before), [(0, 0)])

    def test_another_map_replaces_all_of_the_old_one(self):
        self.show(np.zeros((300, 300), np.int8))
        self.show(np.zeros((10, 10), np.int8), (0.05, 0.0, 0.0))  # half a cell aside
        self.assertEqual(len(whole(self.tiles)), 100)
        self.show(np.full((10, 10), -1, np.int8), (0.05, 0.0, 0.0))
        self.assertEqual(whole(self.tiles), {})

    def test_the_coarse_picture_shows_walls_and_what_is_known(self):
        rng, k = np.random.default_rng(2), tiles.COARSE
        grid = rng.choice([-1, 0, 30], (300, 600), p=[0.2, 0.7, 0.1]).astype(np.int8)
        grid[40, :] = 100  # a wall of one cell
        grid[100:110, 100:130] = -1
        origin = (-25.6, -51.2, 0.0)
        self.show(grid, origin)
        column, row, picture = self.tiles.overview()
        shown, x0, y0 = cells_of(picture), round(origin[0] / 0.1), round(origin[1] / 0.1)
        self.assertEqual((column, row), (x0 // tiles.SIDE, y0 // tiles.SIDE))
        fine = np.zeros((shown.shape[0] * k, shown.shape[1] * k), np.uint8)
        for (x, y), kind in whole(self.tiles).items():
            fine[y - row * tiles.SIDE, x - column * tiles.SIDE] = kind
        for y, x in np.ndindex(shown.shape):
            block = fine[y * k:y * k + k, x * k:x * k + k]
            walls, free, unsure = ((block == kind).sum() for kind in (tiles.OCCUPIED, tiles.FREE, tiles.UNSURE))
            expected = tiles.OCCUPIED if walls >= k else tiles.UNKNOWN if free + unsure == 0 else tiles.FREE if free >= unsure else tiles.UNSURE
            self.assertEqual(shown[y, x], expected, (x, y))
        self.assertGreater((shown == tiles.OCCUPIED).sum(), 600 // k - 2)
        # What has changed is in the next one, what is gone is not.
        grid[:, :] = -1
        grid[0:64, 0:64] = 0
        self.show(grid, origin)
        self.assertEqual(int((cells_of(self.tiles.overview()[2]) > 0).sum()), 64)
        self.show(np.full((10, 10), -1, np.int8), origin)
        self.assertIsNone(self.tiles.overview())

    def test_maps_that_are_none_are_refused(self):
        grid = np.zeros((4, 4), np.int8).tobytes()
        for width, height, resolution, origin in ((4, 5, 0.1, (0, 0, 0)), (0, 0, 0.1, (0, 0, 0)), (4, 4, 0.0, (0, 0, 0)), (4, 4, math.nan, (0, 0, 0)),
                                                  (4, 4, 0.1, (math.inf, 0, 0)), (4, 4, -1.0, (0, 0, 0)), (4, 4, 0.1, (1e12, 0, 0))):
            with self.assertRaises(ValueError):
                self.tiles.prepare(width, height, resolution, origin, grid)
        self.assertEqual(self.tiles.tiles, {})


class TransformsTest(unittest.TestCase):
    @staticmethod
    def message(entries):
        from geometry_msgs.msg import TransformStamped
        from tf2_msgs.msg import TFMessage
        import genpy
        import io
        out = TFMessage()
        for stamp, parent, child, t in entries:
            m = TransformStamped()
            m.header.stamp, m.header.frame_id, m.child_frame_id = genpy.Time.from_sec(stamp), parent, child
            m.transform.translation.x, m.transform.translation.y, m.transform.translation.z = t[:3]
            m.transform.rotation.x, m.transform.rotation.y, m.transform.rotation.z, m.transform.rotation.w = t[3:]
            out.transforms.append(m)
        buffer = io.BytesIO()
        out.serialize(buffer)
        return out, buffer.getvalue()

    def test_the_same_as_tf2_on_random_trees(self):
        import rospy
        import tf2_ros
        for seed in range(20):
            rng = random.Random(seed)
            buffer, tree = tf2_ros.Buffer(rospy.Duration(1000), debug=False), transforms.TransformTree()
            names = [f"frame{i}" for i in range(6)]
            for step in range(20):
                entries = []
                for i in range(1, len(names)):
                    q = np.array([rng.gauss(0, 0.1), rng.gauss(0, 0.1), math.sin(i + 0.01 * step), math.cos(i + 0.01 * step)])
                    q /= np.linalg.norm(q)
                    entries.append((10.0 + step, names[(i - 1) // 2], names[i], (rng.random() + step, rng.random(), 0.1 * i, *q)))
                message, data = self.message(entries)
                for each in message.transforms:
                    buffer.set_transform(each, "test")
                self.assertEqual(tree.add_message(data), 5)
            # Between stamps tf2 turns at an even pace, which this does nearly.
            for stamp, near in ((12.0, 1e-9), (29.0, 1e-9), (17.25, 0.02)):
                for a in names:
                    for b in names:
                        t = buffer.lookup_transform(a, b, rospy.Time.from_sec(stamp)).transform
                        mine = tree.lookup(a, b, stamp)
                        np.testing.assert_allclose(mine[:3], (t.translation.x, t.translation.y, t.translation.z), atol=near)
                        dot = abs(sum(p * q for p, q in zip(mine[3:], (t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w))))
                        self.assertAlmostEqual(dot, 1.0, places=4)

    def test_frames_that_are_not_connected_have_no_transform(self):
        tree = transforms.TransformTree()
        tree.add(1.0, "map", "odom", transforms.IDENTITY)
        self.assertIsNone(tree.lookup("map", "base_link"))
        self.assertIsNotNone(tree.lookup("/map", "odom"))

    def test_circles_and_impossible_transforms_do_no_harm(self):
        tree = transforms.TransformTree()
        tree.add(1.0, "a", "b", transforms.IDENTITY)
        tree.add(1.0, "b", "a", transforms.IDENTITY)
        tree.lookup("a", "nobody")
        self.assertFalse(tree.add(1.0, "a", "c", (math.nan, 0, 0, 0, 0, 0, 1)))
        self.assertFalse(tree.add(1.0, "a", "c", (0, 0, 0, 0, 0, 0, 0)))
        self.assertFalse(tree.add(1.0, "c", "c", transforms.IDENTITY))

    def test_cut_messages_are_refused(self):
        _, data = self.message([(1.0, "map", "odom", (1, 2, 3, 0, 0, 0, 1))])
        for length in range(len(data)):
            if length in (0, 1, 2, 3) or length > 4:
                with self.assertRaises(ValueError):
                    transforms.parse(data[:length])

    def test_time_that_goes_back_begins_anew(self):
        tree = transforms.TransformTree()
        tree.add(100.0, "map", "odom", (1, 0, 0, 0, 0, 0, 1))
        tree.add(5.0, "map", "odom", (2, 0, 0, 0, 0, 0, 1))
        self.assertEqual(tree.lookup("map", "odom")[0], 2)


class SightsTest(unittest.TestCase):
    def test_walls_that_people_told_of_go_from_one_end_to_the_other(self):
        def wall(number, kind, length):
            return types.SimpleNamespace(id=number, kind=kind, length=length, position=types.SimpleNamespace(x=2.0, y=3.0), normal=types.SimpleNamespace(x=0.0, y=1.0))
        shown = sights.told_walls(types.SimpleNamespace(walls=[wall(1, sights.VIRTUAL, 1.0), wall(2, sights.GLASS, 2.0), wall(3, sights.GLASS, math.nan)]))
        self.assertEqual(sorted(shown), ["1", "2"])
        self.assertEqual(sorted([(shown["1"]["ax"], shown["1"]["ay"]), (shown["1"]["bx"], shown["1"]["by"])]), [(1.5, 3.0), (2.5, 3.0)])
        self.assertEqual((shown["1"]["v"], shown["2"]["v"]), (True, False))

    def test_what_the_robot_asks(self):
        def asked(text):
            q = sights.question(text, 7)
            return q and (q["place"], q["yes"])
        self.assertEqual(asked("Is SS12 John's office?"), (12, True))
        self.assertEqual(asked("Can you please confirm the name library, as the name of this place?"), (7, True))
        self.assertEqual(asked("What is the name of this place?"), (7, False))
        self.assertEqual(asked("Qual é o nome de CC11?"), (11, False))
        self.assertEqual(asked("SS05 é biblioteca?"), (5, True))
        self.assertEqual(asked("I am not sure where room A may be. Shall I go to perhaps room A (SS14)?"), (14, True))
        self.assertIsNone(asked("I have stopped."))

    def test_where_names_may_be_is_read_from_lines(self):
        self.assertEqual(sights.candidates("kitchen\tSS03\tCC11\nroom A\tSS104\n"), {"kitchen": [3, 11], "room A": [104]})
        for text in ("", "\n\n", "kitchen", "kitchen\t", "\tSS03", "kitchen\tXX03\t-1\tSS", "\t\t\t"):
            self.assertEqual(sights.candidates(text), {}, text)
        many = sights.candidates("a" * 10000 + "".join(f"\tSS{n:02d}" for n in range(1, 5000)))
        self.assertEqual([(len(name), len(places)) for name, places in many.items()], [(sights.MAX_LABEL, sights.MAX_CANDIDATES)])

    def test_a_scan_is_shown_in_the_frame_of_the_robot(self):
        msg = types.SimpleNamespace(ranges=[1.0, math.inf, 2.0, math.nan, 0.01], range_min=0.1, range_max=10.0, angle_min=0.0, angle_increment=math.pi / 2)
        shown = sights.scan(msg, (0.5, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0), (3.0, 4.0, 1.0))
        points = np.frombuffer(base64.b64decode(shown["p"]), "<i2").reshape(-1, 2)
        np.testing.assert_allclose(points, [[150, 0], [-150, 0]], atol=1)
        self.assertIsNone(sights.scan(msg, None, (0, 0, 0)))

    def test_a_laser_upside_down_is_shown_turned(self):
        msg = types.SimpleNamespace(ranges=[1.0], range_min=0.1, range_max=10.0, angle_min=math.pi / 2, angle_increment=0.1)
        shown = sights.scan(msg, (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        np.testing.assert_allclose(np.frombuffer(base64.b64decode(shown["p"]), "<i2"), [0, -100], atol=1)

    def test_the_ellipse_of_a_pose(self):
        c = [0.0] * 36
        c[0], c[7] = 0.04, 0.25
        msg = types.SimpleNamespace(pose=types.SimpleNamespace(covariance=c))
        shown = sights.spread(msg)
        self.assertEqual((shown["l"], shown["s"]), (0.5, 0.2))
        self.assertAlmostEqual(abs(shown["a"]), 1.57, places=2)
        c[0] = math.nan
        self.assertIsNone(sights.spread(msg))


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_world_test", "web_world_test")
