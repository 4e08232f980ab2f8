#!/usr/bin/env python3
"""Who may what, how often and in which form; what came and was not looked at yet: without ROS."""
import random
import sys
import threading
import unittest
import unittest.mock

sys.dont_write_bytecode = True
import fake_robot  # noqa: E402, F401 (finds the package)
from hyselam_web import access, inbox, limits, requests  # noqa: E402


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
        self.assertEqual(requests.parse('{"do":"stop","language":"pt","n":1}'), ("stop", {"language": "pt"}, 1))
        self.assertEqual(requests.parse('{"do":"shut","door":4}'), ("shut", {"door": 4}, None))
        for wrong in ('"xx"', "null", "1"):
            with self.assertRaises(requests.Refused):
                requests.parse('{"do":"shut","door":4,"language":%s}' % wrong)
        self.assertEqual(requests.parse('{"do":"name","place":4,"names":[]}'), ("name", {"place": 4, "names": []}, None))
        self.assertEqual(requests.parse('{"do":"pose","x":1,"y":-2.5,"yaw":0}'), ("pose", {"x": 1.0, "y": -2.5, "yaw": 0.0}, None))

    def test_nothing_that_comes_with_a_stop_keeps_it_from_stopping(self):
        for more in ('"language":"xx"', '"language":"fr"', '"language":null', '"language":1', '"language":["pt"]', '"speed":0', '"language":"xx","speed":null'):
            self.assertEqual(requests.parse('{"do":"stop","n":3,%s}' % more), ("stop", {}, 3), more)
        self.assertEqual(requests.parse('{"do":"stop","language":"pt","speed":0}'), ("stop", {"language": "pt"}, None))

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


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_access_test", "web_access_test")
