#!/usr/bin/env python3
"""The parts of the server that know no ROS: what pages are told, tiles of maps, transforms, roles, limits, requests, recordings."""
import asyncio
import base64
import json
import math
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import types
import unittest
import unittest.mock
import zlib

import numpy as np

sys.dont_write_bytecode = True
import fake_robot  # noqa: E402, F401 (finds the package)
from hyselam_web import access, app, inbox, limits, recording, reports, requests, sentences, sights, tiles, transforms, world  # noqa: E402


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
    assert (width, height, depth, color) == (tiles.SIDE, tiles.SIDE, 2, 3)
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


class AccessTest(unittest.TestCase):
    def setUp(self):
        self.access = access.Access(access.parse_tokens("look=lookatme talk=talktome1 drive=driveme22"), ["robot.local"])

    def test_tokens_give_their_roles_and_others_none(self):
        self.assertEqual([self.access.role_of_token(t) for t in ("lookatme", "talktome1", "driveme22", "driveme2", "", "look=lookatme")],
                         ["look", "talk", "drive", "", "", ""])

    def test_each_role_may_what_those_before_it_may(self):
        self.assertEqual([[access.may(role, needed) for needed in ("", "look", "talk", "drive")] for role in ("", "look", "talk", "drive")],
                         [[True, False, False, False], [True, True, False, False], [True, True, True, False], [True] * 4])

    def test_tokens_that_say_too_little_are_refused(self):
        for text in ("look=short", "boss=longenough", "look=longenough look=longenough2", "look=longenough talk=longenough"):
            with self.assertRaises(ValueError):
                access.parse_tokens(text)
        self.assertEqual(access.parse_tokens("justoneword"), {"drive": "justoneword"})

    def test_cookies_outlive_a_restart_and_end_with_their_time_and_token(self):
        cookie = self.access.cookie("talk", 1000.0)
        again = access.Access(access.parse_tokens("look=lookatme talk=talktome1 drive=driveme22"))
        self.assertEqual(again.role_of_cookie(cookie, 2000.0), "talk")
        self.assertEqual(again.role_of_cookie(cookie, 1000.0 + access.LIFETIME + 1), "")
        changed = access.Access(access.parse_tokens("look=lookatme talk=talktome2 drive=driveme22"))
        self.assertEqual(changed.role_of_cookie(cookie, 2000.0), "")

    def test_forged_cookies_give_no_role(self):
        cookie = self.access.cookie("look", 1000.0)
        parts = cookie.split(".")
        for forged in ("", None, "drive", cookie[:-1], cookie + "0", cookie.replace("look", "drive"), ".".join(["drive"] + parts[1:]), "....", "é" * 50, "\udcff.1.2.\udcff"):
            self.assertEqual(self.access.role_of_cookie(forged, 1001.0), "", forged)

    def test_who_has_a_cookie_cannot_guess_tokens_quickly(self):
        calls = []

        def slow(known, **how):
            calls.append((known, how["n"] * how["r"]))
            return b"k" * how["dklen"]
        with unittest.mock.patch.object(access.hashlib, "scrypt", slow):
            made = access.Access(access.parse_tokens("drive=driveme22"))
        self.assertEqual(made._key, b"k" * 32)
        self.assertIn(b"driveme22", calls[0][0])
        self.assertGreaterEqual(calls[0][1], 2 ** 17)  # 16 MB for each guess

    def test_only_names_of_this_machine_and_addresses_are_hosts(self):
        known = [h for h in ("localhost:8090", "robot.local", "ROBOT.LOCAL:80", "192.168.1.7:8090", "[::1]:8090", "evil.example", "localhost.evil.example", "", None, "a b", "[", "[::1", "]", "[v1.x]")
                 if self.access.knows_host(h)]
        self.assertEqual(known, ["localhost:8090", "robot.local", "ROBOT.LOCAL:80", "192.168.1.7:8090", "[::1]:8090"])

    def test_only_a_page_from_here_is_an_origin(self):
        known = [o for o in ("http://localhost:8090", "https://localhost:8090", "http://localhost:8091", "http://evil.example", "null", "", None, "file://")
                 if self.access.knows_origin(o, "localhost:8090")]
        self.assertEqual(known, ["http://localhost:8090", "https://localhost:8090"])


class LimitsTest(unittest.TestCase):
    def test_a_bucket_gives_at_once_what_it_holds_and_then_at_its_rate(self):
        bucket = limits.Bucket(3, 2.0)
        self.assertEqual([bucket.take(0.0) for _ in range(5)], [True] * 3 + [False] * 2)
        self.assertEqual([bucket.take(1.0) for _ in range(3)], [True, True, False])
        self.assertFalse(bucket.take(0.5))  # a clock that goes back fills nothing

    def test_buckets_of_many_addresses_take_no_memory_without_end(self):
        buckets = limits.Buckets(most=10)
        for n in range(1000):
            buckets.take(n, "login", 0.0)
        self.assertLessEqual(len(buckets._known), 10)


    def test_to_look_into_a_bucket_takes_nothing_out(self):
        buckets = limits.Buckets({"login": (2, 0.0)})
        self.assertEqual([buckets.has("a", "login", 0.0) for _ in range(5)], [True] * 5)
        self.assertEqual([buckets.take("a", "login", 0.0) for _ in range(3)], [True, True, False])
        self.assertEqual((buckets.has("a", "login", 0.0), buckets.has("b", "login", 0.0)), (False, True))


class InboxTest(unittest.TestCase):
    def test_no_message_is_lost_or_empty_between_two_threads(self):
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(1e-6)
        newest, last = inbox.Newest(), 30000
        newest.put(-1)
        newest.put(0)
        self.assertEqual((newest.take(), newest.take()), (0, None))
        putter = threading.Thread(target=lambda: [newest.put(n) for n in range(1, last + 1)])
        putter.start()
        taken = []
        while putter.is_alive() or newest.is_new():
            if newest.is_new():
                taken.append(newest.take())
        self.assertEqual(taken, sorted(set(taken)))
        self.assertEqual(taken[-1], last)
        self.assertIsNone(newest.take())

    def test_parts_of_one_process_are_shown_beside_each_other_and_dead_ones_as_such(self):
        statuses = inbox.Statuses()
        statuses.put("robot/gr2to: map", 0, "OK", 10.0)
        statuses.put("robot/topo_engine: dialogue", 1, "no pose", 10.0)
        statuses.put("other/gr2to: map", 2, "elsewhere", 10.0)
        self.assertEqual(statuses.layers("/robot/", 11.0), {"gr2to": {"level": "ok", "what": "map", "text": "OK"},
                                                            "topo_engine": {"level": "warn", "what": "dialogue", "text": "no pose"}})
        statuses.put("robot/gr2to: map", 0, "OK", 16.0)
        self.assertEqual({k: v["level"] for k, v in statuses.layers("/robot/", 17.0).items()}, {"gr2to": "ok", "topo_engine": "stale"})

    def test_of_several_statuses_of_a_part_the_worst_is_shown(self):
        for order in ((0, 2), (2, 0)):
            statuses = inbox.Statuses()
            for level in order:
                statuses.put(f"/gr2to: {level}", level, "", 1.0)
            self.assertEqual(statuses.layers("/", 1.0)["gr2to"]["level"], "error")

    def test_names_without_end_take_no_memory_without_end(self):
        statuses = inbox.Statuses()
        for n in range(5 * inbox.MAX_STATUSES):
            statuses.put(f"node{n}", 0, "", 1.0)
        self.assertLessEqual(len(statuses._known), inbox.MAX_STATUSES)
        self.assertLessEqual(len(statuses.layers("/", 1.0)), 100)


class RequestsTest(unittest.TestCase):
    def test_control_characters_and_overrides_of_direction_are_left_out(self):
        self.assertEqual(requests.clean("a\0b\x1b[31mc\u202e\ud800d\r\n\te"), "a b [31mcd e")
        self.assertIsNone(requests.clean("\u200b \n"))
        self.assertEqual(requests.clean("João 🙂 日本"), "João 🙂 日本")

    def test_good_requests_come_through(self):
        self.assertEqual(requests.parse('{"do":"say","n":4,"text":" Hi  there "}'), ("say", {"text": "Hi there"}, 4))
        self.assertEqual(requests.parse('{"do":"name","place":4,"names":[]}'), ("name", {"place": 4, "names": []}, None))
        self.assertEqual(requests.parse('{"do":"pose","x":1,"y":-2.5,"yaw":0}'), ("pose", {"x": 1.0, "y": -2.5, "yaw": 0.0}, None))

    def test_a_refusal_carries_the_number_of_its_request(self):
        for text, number in (('{"do":"say","n":4}', 4), ('{"do":"dance","n":5}', 5), ('{"n":6}', 6), ('{"do":"say","n":7,"text":"hi","path":"/"}', 7),
                             ('{"do":"dance","n":"8"}', None), ('{"do":"dance","n":true}', None), ('{"do":"dance","n":%d}' % 2 ** 60, None), ("[9]", None)):
            with self.assertRaises(requests.Refused) as caught:
                requests.parse(text)
            self.assertEqual(caught.exception.number, number, text)

    def test_random_bytes_are_refused_and_nothing_else_happens(self):
        rng = random.Random(5)
        good = ['{"do":"say","text":"hello"}', '{"do":"wall","ax":1,"ay":2,"bx":3,"by":4}', '{"do":"name","place":4,"names":["a"]}']
        for _ in range(20000):
            text = list(rng.choice(good))
            for _ in range(rng.randrange(1, 6)):
                text[rng.randrange(len(text))] = rng.choice(['"', "{", "}", "[", "0", "-", "e", "\\", "\0", "é", "u", "null", "9" * 400])
            try:
                name, _, _ = requests.parse("".join(text))
            except requests.Refused:
                continue
            self.assertIn(name, requests.REQUESTS)


class TalkedTo:
    """A dialogue that answers when the test says so, with a clock that the test turns."""

    def __init__(self):
        self.told, self.stops, self.ways, self.forwarded, self.time, self.asked = [], 0, 0, 0, 0.0, []
        self.sentences = sentences.Sentences(self.tell, self.stop, lambda: self.ways, lambda: self.forwarded, clock=lambda: self.time)

    async def tell(self, text, check):
        answered = asyncio.get_event_loop().create_future()
        self.asked.append((text, answered))
        check()
        self.told.append(text)
        return await answered

    def stop(self):
        self.stops += 1

    def say(self, text, may_drive=True):
        return asyncio.ensure_future(self.sentences.say(text, may_drive))

    async def answer(self, text, value=("All right.",)):
        while not any(t == text for t, _ in self.asked):
            await asyncio.sleep(0.001)
        future = next(f for t, f in self.asked if t == text)
        future.set_exception(value) if isinstance(value, Exception) else future.set_result(list(value))

    async def turn(self, seconds):
        """The clock goes on, and all that waits for it with it."""
        for _ in range(20):
            self.time += seconds / 20
            await asyncio.sleep(sentences.STEP / 10)


class SentencesTest(unittest.TestCase):
    def setUp(self):
        self.addCleanup(setattr, sentences, "STEP", sentences.STEP)
        sentences.STEP = 0.002

    @staticmethod
    def run_it(story):
        async def within():
            return await asyncio.wait_for(story(TalkedTo()), 20)
        return asyncio.run(within())

    def refused(self, code, future):
        self.assertEqual(getattr(future.exception(), "code", None), code, future)

    def test_a_stop_cancels_what_waits_to_be_said(self):
        async def story(robot):
            first, second = robot.say("Where are you?"), robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.sentences.stopped()
            await robot.answer("Where are you?")
            await asyncio.wait([first, second])
            self.assertEqual(first.result(), ["All right."])
            self.refused("stopped", second)
            self.assertEqual(robot.told, ["Where are you?"])
            after = robot.say("Go to SS05.")
            await robot.answer("Go to SS05.")
            self.assertEqual(await after, ["All right."])  # what is said after it is
        self.run_it(story)

    def test_a_stop_while_the_service_is_looked_for_cancels_the_sentence(self):
        async def story(robot):
            async def tell(text, check):
                robot.sentences.stopped()
                check()
                robot.told.append(text)
            robot.sentences._tell = tell
            said = robot.say("Go to SS05.")
            await asyncio.wait([said])
            self.refused("stopped", said)
            self.assertEqual(robot.told, [])
        self.run_it(story)

    def test_a_stop_while_the_robot_is_told_is_said_once_more_afterwards(self):
        async def story(robot):
            said = robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.sentences.stopped()
            self.assertEqual(robot.stops, 0)
            await robot.answer("Go to SS05.")
            await said
            await asyncio.sleep(0.01)
            self.assertEqual(robot.stops, 1)
        self.run_it(story)

    def test_a_sentence_that_has_waited_long_is_not_said(self):
        async def story(robot):
            first, second = robot.say("Where are you?"), robot.say("Go to SS05.")
            await asyncio.sleep(0.01)
            robot.time += sentences.OLDEST + 1
            await robot.answer("Where are you?")
            await asyncio.wait([first, second])
            self.refused("busy", second)
            self.assertEqual(robot.told, ["Where are you?"])
        self.run_it(story)

    def test_who_may_not_send_the_robot_is_stopped_whatever_it_answers(self):
        for answer in (["On my way."], requests.Refused("failed", "lost")):
            async def story(robot):
                said = robot.say("Go to SS05.", may_drive=False)
                await asyncio.sleep(0.01)
                robot.ways += 1
                await robot.answer("Go to SS05.", answer)
                await asyncio.wait([said])
                self.refused("not_allowed", said)
                self.assertEqual(robot.stops, 1)
            self.run_it(story)

    def test_a_way_that_comes_of_a_late_answer_about_a_thing_is_stopped(self):
        async def story(robot):
            said = robot.say("Fetch the pen.", may_drive=False)
            await robot.answer("Fetch the pen.", [])
            robot.forwarded += 1
            await robot.turn(2.0)
            self.assertFalse(said.done())
            robot.ways += 1
            await robot.turn(0.5)
            self.refused("not_allowed", said)
            self.assertEqual(robot.stops, 1)
        self.run_it(story)

    def test_who_drives_meanwhile_does_not_open_a_door_for_who_may_not(self):
        async def story(robot):
            talker, driver = robot.say("Go to SS05.", may_drive=False), robot.say("Where are you?")
            await asyncio.sleep(0.01)
            self.assertEqual(robot.told, ["Go to SS05."])
            await robot.answer("Go to SS05.")
            robot.ways += 1
            await robot.answer("Where are you?")
            await asyncio.wait([talker, driver])
            self.refused("not_allowed", talker)
            self.assertEqual((driver.result(), robot.stops), (["All right."], 1))
        self.run_it(story)

    def test_a_robot_that_answers_after_its_time_is_watched_all_the_same(self):
        self.addCleanup(setattr, sentences, "ANSWER_WAIT", sentences.ANSWER_WAIT)
        sentences.ANSWER_WAIT = 0.05

        async def story(robot):
            said = robot.say("Go to SS05.", may_drive=False)
            await asyncio.wait([said])
            self.refused("no_answer", said)
            second = robot.say("Go to SS06.")
            await asyncio.wait([second])
            self.refused("busy", second)
            await robot.answer("Go to SS05.")
            robot.ways += 1
            await robot.turn(0.2)
            self.assertEqual((robot.stops, robot.told), (1, ["Go to SS05."]))
        self.run_it(story)

    def test_talk_that_sends_nobody_is_answered(self):
        async def story(robot):
            said = robot.say("Where are you?", may_drive=False)
            await robot.answer("Where are you?")
            await robot.turn(1.0)
            self.assertEqual((said.result(), robot.stops), (["All right."], 0))
        self.run_it(story)

    def test_a_name_that_holds_another_sentence_sends_the_robot_nowhere_else(self):
        place = {"e": "SS05", "n": [["kitchen. Follow me", 1]]}
        self.assertEqual([sentences.go_to(place, language) for language in ("en", "pt")], ["Go to SS05.", "Vai para SS05."])


class SightsTest(unittest.TestCase):
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


class RecordingTest(unittest.TestCase):
    def test_a_recording_gives_back_what_pages_saw(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w, map_tiles = os.path.join(folder, "day.jsonl"), world.World(), tiles.MapTiles()
            recorder = recording.Recorder(path)
            page = {"v": 0}
            for step in range(50):
                w.set("value", step // 5)
                w.set_table("table", {str(step // 10): step // 3})
                recorder.take(float(step), w, map_tiles)
            recorder.close()
            for entry in recording.read(path):
                apply(page, dict(entry, v=1))
            self.assertEqual((page["value"], page["table"]), (9, {"4": 16}))

    def test_a_recording_ends_at_its_size_and_one_that_is_cut_off_is_read_so_far(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            recorder = recording.Recorder(path, most_bytes=2000)
            for step in range(1000):
                w.set("value", "x" * 20 + str(step))
                recorder.take(float(step), w, tiles.MapTiles())
            recorder.close()
            self.assertTrue(recorder.full)
            self.assertLessEqual(os.path.getsize(path), 2000)
            entries = recording.read(path)
            self.assertGreater(len(entries), 10)
            with open(path, "r+") as file:
                file.truncate(os.path.getsize(path) - 5)
            self.assertEqual(recording.read(path), entries[:-1])

    def test_a_server_that_died_leaves_its_recording_to_the_next(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            for morning in range(3):
                recorder = recording.Recorder(path)  # and never closed
                w.set("value", morning)
                recorder.take(float(morning), w, tiles.MapTiles())
            recording.Recorder(path)
            recording.Recorder(path).close()  # there is nothing in the one before
            names = sorted(set(os.listdir(folder)) - {"day.jsonl"})
            self.assertEqual(len(names), 3, names)
            self.assertEqual(sorted(recording.read(os.path.join(folder, n))[0]["d"]["value"] for n in names), [0, 1, 2])

    def test_the_size_of_a_recording_is_one_of_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            recorder = recording.Recorder(path, most_bytes=2000)
            for step in range(100):
                w.set("value", "日本語" * 10 + str(step))
                recorder.take(float(step), w, tiles.MapTiles())
            recorder.close()
            self.assertTrue(recorder.full)
            self.assertLessEqual(os.path.getsize(path), 2000)

    @unittest.skipUnless(os.path.exists("/dev/full"), "this system has no /dev/full")
    def test_a_full_disc_ends_the_recording_and_nothing_else(self):
        w = world.World()
        recorder = recording.Recorder("/dev/full")
        w.set("value", 1)
        with self.assertLogs("hyselam_web", "ERROR"):
            recorder.take(0.0, w, tiles.MapTiles())
        self.assertTrue(recorder.full)
        recorder.take(5.0, w, tiles.MapTiles())
        recorder.close()

    def test_files_that_are_no_recordings_are_refused_with_their_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "day.jsonl")
            for text, reason in (("{}\n", "line 1"), ("nothing\n", "line 1"), (json.dumps(recording.FORMAT) + '\n{"t":1}\n', "line 2")):
                with open(path, "w") as file:
                    file.write(text)
                with self.assertRaisesRegex(ValueError, reason):
                    recording.read(path)

    def test_names_that_look_like_html_stay_text_in_the_page_of_a_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            recorder = recording.Recorder(path)
            w.set("names", ["</script><script>alert(1)</script>", "<!--"])
            recorder.take(0.0, w, tiles.MapTiles())
            recorder.close()
            page = os.path.join(folder, "index.html")
            recording.write_static(path, str(fake_robot.PACKAGE / "www"), page)
            with open(page) as file:
                text = file.read()
            self.assertNotIn("<script>alert", text)
            self.assertEqual(text.count("</script>"), 2)
            for asset in ("src=", "import ", "href=\"style.css"):
                self.assertNotIn(asset, text.split("window.HYSELAM_RECORDING")[0])


class ReportsTest(unittest.TestCase):
    def test_only_files_below_the_folder_are_found_by_names_from_the_list(self):
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "day/slam"))
            os.makedirs(os.path.join(folder, "day/web"))
            for name in ("day/slam/report.html", "day/map.png", "day/secret.key", "day/.hidden.html", "day/web/day.jsonl", "day/web/index.html"):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(name)
            os.symlink("/etc/passwd", os.path.join(folder, "day/link.txt"))
            os.symlink("/etc", os.path.join(folder, "day/etc"))
            found = reports.Reports(folder)
            self.assertEqual(found.scan(), ["day/slam/report.html"])
            self.assertIsNotNone(found.find("day/map.png"))
            for name in ("day/secret.key", "day/.hidden.html", "day/link.txt", "day/etc/passwd", "../etc/passwd", "/etc/passwd", "day/../day/map.png", ""):
                self.assertIsNone(found.find(name), name)


class PageTest(unittest.TestCase):
    def test_both_languages_say_everything(self):
        www = fake_robot.PACKAGE / "www"
        script = recording.one_script(str(www / "js"), "i18n.js") + "\nconsole.log(JSON.stringify([missingTexts(), Object.keys(TEXTS.en)]));"
        node = subprocess.run(["node", "-e", script], stdout=subprocess.PIPE, text=True) if shutil.which("node") else None
        if node is None:
            self.skipTest("node is not installed; the browser test looks, too")
        missing, keys = json.loads(node.stdout)
        self.assertEqual(missing, [])
        self.assertGreater(len(keys), 100)

    def test_nothing_is_loaded_from_elsewhere(self):
        for address, (data, kind) in app.static_files(str(fake_robot.PACKAGE / "www")).items():
            text = data.decode()
            for foreign in ("https://", "http://", "//cdn"):
                for line in text.splitlines():
                    self.assertFalse(foreign in line and "www.w3.org" not in line, f"{address}: {line[:80]}")
            self.assertNotIn("innerHTML", text, address)


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_core_test", "web_core_test")
