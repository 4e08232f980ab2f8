#!/usr/bin/env python3
"""What a page, or who pretends to be one, may send: it is refused with a reason, nothing of it reaches the robot, all others go on. The table
is in test/bad_input/web.md."""
import json
import os
import sys
import tempfile
import types

import numpy as np

sys.dont_write_bytecode = True
from fake_robot import FakeRobot, RESOLUTION, ServedRobot, WAIT, wait_until
from hyselam_web import app, limits, tiles
from pages import Case, HANDSHAKE, Pages

REFUSED = {
    # name: (message, code)
    "no_json": ("hello", "malformed"), "nothing": ("", "malformed"), "a_number": ("7", "malformed"), "a_list": ('["say"]', "malformed"), "null": ("null", "malformed"),
    "a_deep_nest": ("[" * 5000, "malformed"), "no_name": ('{"text":"hi"}', "malformed"), "a_name_that_is_a_number": ('{"do":3}', "malformed"),
    "an_unknown_name": ('{"do":"shutdown"}', "unknown"), "the_name_of_a_method": ('{"do":"_call"}', "unknown"), "a_dunder_name": ('{"do":"__class__"}', "unknown"),
    "a_sentence_without_text": ('{"do":"say"}', "invalid"), "a_sentence_that_is_a_number": ('{"do":"say","text":1}', "invalid"),
    "an_empty_sentence": ('{"do":"say","text":""}', "invalid"), "a_sentence_of_control_characters": ('{"do":"say","text":"\\u0000\\u202e\\n"}', "invalid"),
    "a_sentence_that_is_too_long": (json.dumps({"do": "say", "text": "x" * (limits.MAX_TEXT + 1)}), "invalid"),
    "a_sentence_to_try_that_is_too_long": (json.dumps({"do": "try", "text": "x" * (limits.MAX_QUESTION + 1)}), "invalid"),
    "a_field_too_many": ('{"do":"say","text":"hi","path":"/etc/passwd"}', "invalid"), "a_path_to_save_to": ('{"do":"save","path":"/tmp/x"}', "invalid"),
    "a_place_below_zero": ('{"do":"go","place":-1,"language":"en"}', "invalid"), "a_place_that_is_a_fraction": ('{"do":"go","place":1.5,"language":"en"}', "invalid"),
    "a_place_that_is_true": ('{"do":"go","place":true,"language":"en"}', "invalid"), "a_place_that_is_text": ('{"do":"go","place":"1","language":"en"}', "invalid"),
    "a_place_beyond_32_bits": ('{"do":"go","place":4294967296,"language":"en"}', "invalid"), "a_language_that_is_none": ('{"do":"go","place":1,"language":"../pt"}', "invalid"),
    "names_that_are_no_list": ('{"do":"name","place":1,"names":"kitchen"}', "invalid"),
    "too_many_names": (json.dumps({"do": "name", "place": 1, "names": ["a"] * (limits.MAX_NAMES + 1)}), "invalid"),
    "a_name_that_is_too_long": (json.dumps({"do": "name", "place": 1, "names": ["a" * (limits.MAX_NAME + 1)]}), "invalid"),
    "a_name_that_is_empty": ('{"do":"name","place":1,"names":["  "]}', "invalid"), "a_name_that_is_null": ('{"do":"name","place":1,"names":[null]}', "invalid"),
    "a_pose_that_is_not_a_number": ('{"do":"pose","x":NaN,"y":0,"yaw":0}', "malformed"), "a_pose_at_infinity": ('{"do":"pose","x":Infinity,"y":0,"yaw":0}', "malformed"),
    "a_pose_of_1e999": ('{"do":"pose","x":1e999,"y":0,"yaw":0}', "invalid"), "a_pose_beyond_the_world": ('{"do":"pose","x":1e300,"y":0,"yaw":0}', "invalid"),
    "a_pose_without_heading": ('{"do":"pose","x":0,"y":0}', "invalid"), "a_wall_of_texts": ('{"do":"wall","ax":"0","ay":0,"bx":1,"by":1}', "invalid"),
    "a_flag_that_is_a_number": ('{"do":"hide","on":1}', "invalid"), "a_huge_number": ('{"do":"go","place":%s,"language":"en"}' % ("9" * 5000), "malformed"),
    "a_number_of_too_many_digits": ('{"do":"go","place":%s,"language":"en"}' % ("9" * (limits.MAX_DIGITS + 1)), "malformed"),
    "a_number_of_many_digits": ('{"do":"go","place":%s,"language":"en"}' % ("9" * limits.MAX_DIGITS), "invalid"),
}


class MessagesTest(Case):
    pass


def refused(message, code):
    def test(self):
        page = self.open()
        numbered = message.startswith("{") and code != "malformed"
        page.send(message.replace("{", '{"n":7,', 1) if numbered else message)
        wait_until(lambda: any("error" in a[-1] for a in page.answers.values()), "a refusal")
        self.assertEqual({n: a[-1]["error"] for n, a in page.answers.items()}, {7 if numbered else None: code})
        self.assertEqual(self.robot.asked, [])
        self.assertIsNone(page.code)
        self.expect_all_is_well()
    return test


for case, (the_message, the_code) in REFUSED.items():
    setattr(MessagesTest, f"test_{case}_is_refused", refused(the_message, the_code))


class FramesTest(Case):
    def frames(self, data):
        out, closed = self.raw(HANDSHAKE.format(port=self.served.port).encode() + data, WAIT)
        self.assertIn(b"101 Switching", out)
        self.assertTrue(closed)
        self.assertEqual(self.robot.asked, [])
        self.expect_all_is_well()

    def test_a_binary_message_is_refused(self):
        page = self.open()
        self.pages.run(page.socket.send_bytes(b'{"do":"stop"}'))
        wait_until(lambda: page.answers.get(None), "a refusal")
        self.assertEqual((page.answers[None][0]["error"], self.robot.stops), ("malformed", 0))

    def test_a_stop_with_fields_that_do_not_fit_stops(self):
        self.stand_still()
        page = self.open()
        for count, more in enumerate(({"language": "xx"}, {"language": None}, {"language": 1}, {"path": "/"}), 1):
            self.assertEqual(page.ask("stop", **more)["done"], "stop", more)
            self.assertEqual((self.robot.cancels, self.robot.stop_language), (count, ""), more)

    def test_a_huge_message_ends_its_page_only(self):
        page = self.open()
        page.send(json.dumps({"do": "say", "text": "x" * (limits.MAX_MESSAGE_BYTES + 1000)}))
        wait_until(lambda: page.code, "the end")
        self.assertEqual((page.code, self.robot.asked), (1009, []))
        self.expect_all_is_well()

    def test_a_message_in_pieces_without_end_ends_its_page(self):
        piece = b"\x00\xfe\x0f\xa0" + b"\0" * 4 + b"x" * 4000
        self.frames(b"\x01" + piece[1:] + piece * 6)

    def test_text_that_is_no_utf8_ends_its_page(self):
        self.frames(b"\x81\x82\0\0\0\0\xff\xfe")

    def test_a_reserved_kind_of_frame_ends_its_page(self):
        self.frames(b"\x83\x80\0\0\0\0")

    def test_a_frame_that_claims_exabytes_ends_its_page(self):
        self.frames(b"\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0")

    def test_a_ping_that_is_too_long_ends_its_page(self):
        self.frames(b"\x89\xfe\x00\x80\0\0\0\0" + b"x" * 128)


class PathsTest(Case):
    def setUp(self):
        self.pages = Pages()
        self.addCleanup(self.pages.close)
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        with open(os.path.join(self.folder.name, "report.html"), "w") as file:
            file.write("<h1>report</h1><script>alert(1)</script>")
        self.robot = FakeRobot()
        self.served = ServedRobot(self.robot, report_folder=self.folder.name)
        self.addCleanup(self.served.close)
        self.assertEqual(json.loads(self.pages.request("GET", self.served.address + "/reports")[1]), ["report.html"])

    def get(self, path):
        return self.raw(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n".encode("latin-1"))[0]

    def test_no_path_leads_out_of_the_page(self):
        for path in ("/../../../etc/passwd", "/js/../../package.xml", "/js/%2e%2e/%2e%2e/package.xml", "/..%2f..%2fetc/passwd", "//etc/passwd", "/js/", "/js",
                     "/index.html%00.png", "/js/main.js/", "/\\..\\..\\etc\\passwd", "/python/hyselam_web/app.py", "/report/../../../etc/passwd",
                     "/report/%2e%2e%2f%2e%2e%2fetc%2fpasswd", "/report//etc/passwd", "/report/.", "/report/report.html/..", "/static/main.js"):
            answer = self.get(path)
            self.assertRegex(answer.split(b"\r\n")[0], rb"HTTP/1.[01] (400|404)", path)
            self.assertNotIn(b"root:", answer)
        self.assertIn(b"200 OK", self.get("/report/report.html").split(b"\r\n")[0])

    def test_scripts_in_reports_do_not_run(self):
        policy = self.pages.request("GET", self.served.address + "/report/report.html")[2]["Content-Security-Policy"]
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("script-src", policy)

    def test_a_report_that_became_a_link_is_not_followed(self):
        path = os.path.join(self.folder.name, "report.html")
        os.remove(path)
        os.symlink("/etc/passwd", path)
        self.assertIn(b"404", self.get("/report/report.html").split(b"\r\n")[0])

    def test_the_page_forbids_what_it_does_not_need(self):
        headers = self.pages.request("GET", self.served.address + "/")[2]
        self.assertIn("default-src 'self'", headers["Content-Security-Policy"])
        self.assertNotIn("unsafe", headers["Content-Security-Policy"])
        self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["X-Content-Type-Options"], "nosniff")

    def test_methods_that_are_not_for_reading_change_nothing(self):
        for method in ("PUT", "DELETE", "PATCH", "OPTIONS"):
            self.assertIn(self.pages.request(method, self.served.address + "/report/report.html")[0], (404, 405))
        self.assertTrue(os.path.exists(os.path.join(self.folder.name, "report.html")))

    def test_bytes_that_are_no_http_end_their_connection(self):
        for data in (b"\0\1\2\3\r\n\r\n", b"GET\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + os.urandom(64), b"GET / HTTP/9.9\r\n\r\n"):
            out, _ = self.raw(data)
            self.assertRegex(out.split(b"\r\n")[0], rb"HTTP/\d.\d (400|421)", data)
        self.expect_all_is_well()

    def test_headers_without_end_are_refused(self):
        out, closed = self.raw(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n" + b"".join(b"X-%d: %s\r\n" % (n, b"y" * 9000) for n in range(60)))
        self.assertIn(b" 400 ", out.split(b"\r\n")[0])
        self.assertTrue(closed)
        self.expect_all_is_well()

    def test_a_body_that_never_ends_is_refused(self):
        out, _ = self.raw(b"POST /login HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://127.0.0.1\r\nContent-Length: 999999999\r\n\r\n" + b"x" * 100000)
        self.assertIn(b" 413 ", out.split(b"\r\n")[0])
        self.expect_all_is_well()


class NewsTest(Case):
    def test_of_a_large_map_all_is_sent_coarsely_before_its_tiles_and_once(self):
        page = self.open()
        wait_until(lambda: "places" in page.state and page.tiles, "the small map")
        self.assertIsNone(page.overview)
        self.robot.later(lambda: self.robot.show_map(np.zeros((1400, 1400), np.int8), RESOLUTION, (-10.0, -10.0, 0.0)))
        count = len([1 for _, picture in self.robot.tiles.tiles.values() if picture])
        self.assertGreater(count, app.TILES_AT_ONCE)
        first = self.open()
        for each in (page, first):
            wait_until(lambda: len([1 for t in each.tiles.values() if t]) == count, "all tiles")
        self.assertEqual((first.order[0], first.order.count(tiles.OVERVIEW)), (tiles.OVERVIEW, 1))
        column, row = tiles.CORNER.unpack(first.overview[:8])
        self.assertEqual((column, row, first.overview[8:]), self.robot.tiles.overview())
        self.assertIsNone(page.overview)  # it has seen a map
        # Who comes back has it, too.
        again = self.open(query=f"?run={self.served.server.run}&since={self.robot.world.version}")
        self.robot.later(lambda: self.robot.say("human", "Hello."))
        wait_until(lambda: again.talk, "the news")
        self.assertEqual(again.order, [])

    def test_a_page_that_comes_back_gets_what_it_missed_and_no_more(self):
        page = self.open()
        wait_until(lambda: page.tiles and "places" in page.state, "the map")
        since, run = self.robot.world.version, self.served.server.run
        page.close()
        self.robot.later(lambda: self.robot.say("human", "What I said meanwhile."))
        again = self.open(query=f"?run={run}&since={since}")
        wait_until(lambda: again.talk, "what was missed")
        self.assertEqual([e["s"] for e in again.talk], ["What I said meanwhile."])
        self.assertEqual((set(again.state) - {"asked"}, again.tiles), (set(), {}))

    def test_numbers_of_another_run_or_of_the_future_get_all_anew(self):
        for query in ("?run=other&since=5", f"?run={self.served.server.run}&since=x", "?since=-3", "?run=&since=99999999999999999999"):
            page = self.open(query=query)
            wait_until(lambda: "places" in page.state and page.tiles, f"the map for {query}")

    def test_two_people_see_the_same(self):
        a, b = self.open(), self.open()
        wait_until(lambda: "places" in a.state and "places" in b.state, "the map")
        a.ask("say", text="This is the kitchen.")
        b.ask("name", place=1, names=["kitchen"])
        wait_until(lambda: a.talk and b.talk and a.state["places"]["+"].get("1", {}).get("n") == [["kitchen", 1]] == b.state["places"]["+"].get("1", {}).get("n"), "the same")
        self.assertEqual(a.talk, b.talk)

    def test_a_hidden_page_is_sent_nothing_until_it_is_seen_again(self):
        page = self.open()
        wait_until(lambda: "places" in page.state, "the map")
        page.send('{"do":"hide","on":true}')
        wait_until(lambda: all(p.hidden for p in self.served.server.pages), "hidden")
        self.robot.later(lambda: self.robot.say("robot", "News."))
        self.robot.later(lambda: None)
        self.assertEqual(page.talk, [])
        page.send('{"do":"hide","on":false}')
        wait_until(lambda: page.talk, "the news")

    def test_a_robot_that_fails_does_not_end_the_server(self):
        def fail(*_):
            raise RuntimeError("nobody thought of this")
        self.robot.answer = fail
        page = self.open()
        self.assertEqual(page.ask("save")["error"], "failed")
        self.robot.todo.append(fail)
        self.robot.answer = lambda *_: {}
        self.expect_all_is_well()

    def test_pages_hear_of_what_is_known_though_collecting_or_recording_fails_each_time(self):
        def fail(*_):
            raise RuntimeError("nobody thought of this")
        for part in ("collect", "recorder"):
            with self.subTest(part):
                page = self.open()
                wait_until(lambda: "places" in page.state, "the map")
                if part == "collect":
                    self.robot.collect = fail
                else:
                    self.served.server.recorder = types.SimpleNamespace(take=fail)
                self.robot.world.set("names", [part])
                wait_until(lambda: page.state.get("names") == [part], "the news")
                self.robot.__dict__.pop("collect", None)


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_bad_input_test", "web_bad_input_test")
