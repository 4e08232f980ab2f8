#!/usr/bin/env python3
"""What a page, or who pretends to be one, may send: it is refused with a reason, nothing of it reaches the robot, all others go on. The table
is in test/bad_input/web.md."""
import asyncio
import json
import os
import socket
import sys
import tempfile
import threading
import time
import types
import unittest

import aiohttp

sys.dont_write_bytecode = True
from fake_robot import FakeRobot, ServedRobot, WAIT, wait_until
from hyselam_web import app, limits

TOKENS = "look=lookatme1 talk=talktome1 drive=driveme11"


class Pages:
    """Pages without a browser: one event loop, blocking calls."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.session = self.run(self._open())

    async def _open(self):
        return aiohttp.ClientSession(cookie_jar=aiohttp.DummyCookieJar())

    def run(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self.loop).result(WAIT)

    def close(self):
        self.run(self.session.close())
        self.loop.call_soon_threadsafe(self.loop.stop)

    async def _request(self, method, address, **more):
        async with self.session.request(method, address, allow_redirects=False, **more) as answer:
            return answer.status, await answer.read(), answer.headers

    def request(self, method, address, **more):
        return self.run(self._request(method, address, **more))


class Socket:
    """One open page."""

    def __init__(self, pages, server, cookie="", origin=True, query=""):
        headers = {"Cookie": f"{app.COOKIE}={cookie}"} if cookie else {}
        if origin:
            headers["Origin"] = server.address if origin is True else origin
        self.pages, self.state, self.talk, self.answers, self.tiles, self.code = pages, {}, [], {}, {}, None
        self.socket = pages.run(pages.session.ws_connect(server.address + "/ws" + query, headers=headers, autoping=True))
        self.heard = asyncio.run_coroutine_threadsafe(self._listen(), pages.loop)
        self.number = 0

    async def _listen(self):
        async for message in self.socket:
            if message.type == aiohttp.WSMsgType.TEXT:
                value = json.loads(message.data)
                if "d" in value:
                    self.state.update({k: v for k, v in value["d"].items() if k != "talk"})
                    self.talk += value["d"].get("talk", [])
                elif "alive" not in value:
                    self.answers.setdefault(value.get("n"), []).append(value)
            elif message.type == aiohttp.WSMsgType.BINARY:
                self.tiles[message.data[:8]] = message.data[12:]
        self.code = self.socket.close_code or "closed"

    def send(self, text):
        self.pages.run(self.socket.send_str(text))

    def ask(self, what, **fields):
        """The answer."""
        self.number += 1
        number = self.number
        self.send(json.dumps(dict({"do": what, "n": number}, **fields)))
        wait_until(lambda: self.answers.get(number), f"an answer to {what} {fields}")
        return self.answers[number][-1]

    def close(self):
        self.heard.cancel()
        self.pages.run(self.socket.close())


class Case(unittest.TestCase):
    tokens = ""

    def setUp(self):
        self.pages = Pages()
        self.addCleanup(self.pages.close)
        self.robot = FakeRobot()
        self.served = ServedRobot(self.robot, self.tokens)
        self.addCleanup(lambda: self.served.close())

    def open(self, **more):
        page = Socket(self.pages, self.served, **more)
        self.addCleanup(page.close)
        return page

    def expect_all_is_well(self):
        """A good page is served, and what it says comes through."""
        page = self.open(cookie=self.cookie("drive") if self.tokens else "")
        wait_until(lambda: "map" in page.state and page.tiles, "the map")
        before = len(self.robot.asked)
        self.assertEqual(page.ask("say", text="Hello.")["done"], "say")
        self.assertEqual(self.robot.asked[before:], [("say", {"text": "Hello."}, "drive")])

    def cookie(self, role):
        return self.served.server.access.cookie(role, time.time())

    def raw(self, data, wait=1.0):
        """Bytes to the server; what comes back until it closes or nothing more comes."""
        with socket.create_connection(("127.0.0.1", self.served.port), timeout=WAIT) as s:
            s.sendall(data)
            s.settimeout(wait)
            out = b""
            try:
                while True:
                    part = s.recv(65536)
                    if not part:
                        return out, True
                    out += part
                    if b"\x88" in out.partition(b"\r\n\r\n")[2] and b"101 Switching" in out:  # the server says that it closes
                        return out, True
            except socket.timeout:
                return out, False
            except ConnectionError:
                return out, True


REFUSED = {
    # name: (message, code)
    "no_json": ("hello", "malformed"), "nothing": ("", "malformed"), "a_number": ("7", "malformed"), "a_list": ('["say"]', "malformed"), "null": ("null", "malformed"),
    "a_deep_nest": ("[" * 5000, "malformed"), "no_name": ('{"text":"hi"}', "malformed"), "a_name_that_is_a_number": ('{"do":3}', "malformed"),
    "an_unknown_name": ('{"do":"shutdown"}', "unknown"), "the_name_of_a_method": ('{"do":"_call"}', "unknown"), "a_dunder_name": ('{"do":"__class__"}', "unknown"),
    "a_sentence_without_text": ('{"do":"say"}', "invalid"), "a_sentence_that_is_a_number": ('{"do":"say","text":1}', "invalid"),
    "an_empty_sentence": ('{"do":"say","text":""}', "invalid"), "a_sentence_of_control_characters": ('{"do":"say","text":"\\u0000\\u202e\\n"}', "invalid"),
    "a_sentence_that_is_too_long": (json.dumps({"do": "say", "text": "x" * (limits.MAX_TEXT + 1)}), "invalid"),
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
    HANDSHAKE = ("GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                 "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n")

    def frames(self, data):
        out, closed = self.raw(self.HANDSHAKE.format(port=self.served.port).encode() + data, WAIT)
        self.assertIn(b"101 Switching", out)
        self.assertTrue(closed)
        self.assertEqual(self.robot.asked, [])
        self.expect_all_is_well()

    def test_a_binary_message_is_refused(self):
        page = self.open()
        self.pages.run(page.socket.send_bytes(b'{"do":"stop"}'))
        wait_until(lambda: page.answers.get(None), "a refusal")
        self.assertEqual((page.answers[None][0]["error"], self.robot.stops), ("malformed", 0))

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


class FloodsTest(Case):
    def test_a_flood_of_nonsense_ends_its_page_and_is_not_answered_by_a_flood(self):
        page = self.open()
        try:
            for _ in range(limits.FLOOD + 200):
                page.send("x")
        except ConnectionError:
            pass
        wait_until(lambda: page.code, "the end")
        self.assertLess(sum(len(a) for a in page.answers.values()), 60)
        self.expect_all_is_well()

    def stand_still(self):
        """No bucket fills but when the test says so."""
        at = [self.served.server.clock()]
        self.served.server.clock = lambda: at[0]
        return at

    def test_a_flood_of_sentences_reaches_the_robot_in_drops(self):
        self.stand_still()
        page, size = self.open(), limits.RATES["say"][0]
        for n in range(100, 120):
            page.send(json.dumps({"do": "say", "n": n, "text": f"sentence {n}"}))
        wait_until(lambda: all(n in page.answers for n in range(100, 120)), "an answer to each")
        self.assertEqual([page.answers[n][0].get("error", "done") for n in range(100, 120)], ["done"] * size + ["too_often"] * (20 - size))
        self.assertEqual(len(self.robot.asked), size)

    def test_a_second_page_says_no_more_than_one(self):
        self.stand_still()
        pages = [self.open(), self.open()]
        answers = [pages[n % 2].ask("say", text="Hello.").get("error", "done") for n in range(8)]
        self.assertEqual(answers, ["done"] * 5 + ["too_often"] * 3)

    def test_refusals_of_a_long_day_end_no_page(self):
        at = self.stand_still()
        page = self.open()
        for _ in range(3):
            for _ in range(limits.FLOOD - 10):
                page.send("x")
            self.assertEqual(page.ask("stop")["done"], "stop")
            at[0] += 3600.0
        self.assertIsNone(page.code)

    def test_stop_goes_through_a_flood(self):
        page = self.open()
        for n in range(100):
            page.send(json.dumps({"do": "say", "text": "go"}))
        self.assertEqual(page.ask("stop")["done"], "stop")
        self.assertEqual(self.robot.stops, 1)

    def test_a_flood_of_stops_stops_and_does_not_fill_the_talk(self):
        page = self.open()
        begin = time.monotonic()
        for _ in range(300):
            page.send('{"do":"stop"}')
        page.ask("stop")
        took, stops = time.monotonic() - begin, self.robot.stops
        self.assertGreaterEqual(stops, 1)
        self.assertGreaterEqual(self.robot.cancels, 301)  # each cancels what moves
        self.assertLessEqual(stops, 2 + took / app.STOP_PERIOD)
        wait_until(lambda: not self.served.server._stop_again, "the last stop")
        self.assertGreater(self.robot.stops, 1)

    def test_a_stop_that_nobody_hears_is_told(self):
        page = self.open()
        self.assertEqual(page.ask("stop")["result"], {"heard": 1})
        self.robot.hearers = 0
        self.assertEqual(page.ask("stop")["result"], {"heard": 0})
        answer = self.pages.request("POST", self.served.address + "/stop", headers={"Origin": self.served.address})
        self.assertEqual(json.loads(answer[1])["heard"], 0)

    def test_slow_requests_cannot_be_heaped_up(self):
        page = self.open()
        answers = [page.ask("doctor") for _ in range(6)]
        self.assertEqual(sum("done" in a for a in answers), limits.RATES["slow"][0])

    def test_too_many_pages_of_one_address_are_refused(self):
        pages = [self.open() for _ in range(limits.MAX_PAGES_OF_ADDRESS)]
        with self.assertRaises(aiohttp.WSServerHandshakeError) as caught:
            self.open()
        self.assertEqual(caught.exception.status, 503)
        pages[0].close()
        wait_until(lambda: len(self.served.server.pages) < limits.MAX_PAGES_OF_ADDRESS, "room")
        self.expect_all_is_well()

    def test_a_request_that_does_not_end_is_ended(self):
        self.addCleanup(setattr, app, "SLOW", app.SLOW)
        app.SLOW = 0.5
        head = f"POST /login HTTP/1.1\r\nHost: 127.0.0.1:{self.served.port}\r\nOrigin: http://127.0.0.1:{self.served.port}\r\nContent-Length: 1000\r\n\r\n"
        page = self.open()
        out, closed = self.raw(head.encode() + b"{", WAIT)
        self.assertEqual((out, closed), (b"", True))
        self.assertEqual(page.ask("say", text="Hello.")["done"], "say")  # a page is open for as long as it likes
        self.expect_all_is_well()

    def test_pages_that_take_nothing_do_not_hold_up_the_end(self):
        self.addCleanup(setattr, app, "CLOSING", app.CLOSING)
        app.CLOSING = 0.2
        for _ in range(5):
            s = socket.socket()
            self.addCleanup(s.close)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", self.served.port))
            s.sendall(FramesTest.HANDSHAKE.format(port=self.served.port).encode())
        pages = self.served.server.pages
        wait_until(lambda: len(pages) == 5, "the pages")
        self.robot.later(lambda: self.robot.world.set("names", ["x" * 10000000]))
        wait_until(lambda: all(page.sending is not None for page in pages), "that they take nothing")
        self.served.close()
        self.assertFalse(self.served._thread.is_alive())

    def test_connections_that_ask_for_nothing_are_closed(self):
        self.addCleanup(setattr, app, "UNUSED", app.UNUSED)
        self.addCleanup(setattr, app, "MAX_CONNECTIONS", app.MAX_CONNECTIONS)
        app.UNUSED, app.MAX_CONNECTIONS = 0.5, 50
        idle = [socket.create_connection(("127.0.0.1", self.served.port)) for _ in range(100)]
        for s in idle[::2]:
            s.sendall(b"GET / HTTP/1.1\r\nHost: ")
        for s in idle:
            s.settimeout(WAIT)
            try:
                self.assertEqual(s.recv(10), b"")
            except ConnectionError:
                pass
            s.close()
        self.expect_all_is_well()

    def test_a_page_that_takes_nothing_holds_up_nobody_and_is_disconnected(self):
        self.addCleanup(setattr, limits, "STALLED", limits.STALLED)
        limits.STALLED = 1.0
        with socket.socket() as s:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", self.served.port))
            s.sendall(FramesTest.HANDSHAKE.format(port=self.served.port).encode())
            wait_until(lambda: self.served.server.pages, "the page")
            other = self.open()
            wait_until(lambda: len(self.served.server.pages) == 2, "the other page")
            count = [0]
            self.robot.collect = lambda: (self.robot.world.set("names", ["x" * 100000 + str(count[0])]), count.__setitem__(0, count[0] + 1))
            wait_until(lambda: len(self.served.server.pages) == 1, "the end of the page that takes nothing")
            heard = len(str(other.state.get("names")))
            self.assertGreater(heard, 1000)
        del self.robot.collect
        self.expect_all_is_well()


class AccessTest(Case):
    tokens = TOKENS

    def login(self, body, **more):
        headers = {"Origin": self.served.address, "Content-Type": "application/json"}
        return self.pages.request("POST", self.served.address + "/login", data=body, headers=headers, **more)

    def test_the_right_token_opens_and_its_cookie_is_not_for_scripts(self):
        status, _, headers = self.login('{"token":"talktome1"}')
        self.assertEqual(status, 200)
        cookie = headers["Set-Cookie"]
        self.assertIn("HttpOnly", cookie)
        self.assertIn("SameSite=Strict", cookie)
        page = self.open(cookie=cookie.split("=", 1)[1].split(";")[0])
        self.assertEqual(page.ask("say", text="Hello.")["done"], "say")
        self.assertEqual(self.robot.asked[-1][2], "talk")

    def test_wrong_tokens_are_refused(self):
        for body in ('{"token":"wrong-token"}', '{"token":""}', '{"token":null}'):
            status, text, headers = self.login(body)
            self.assertEqual(status, 403, body)
            self.assertNotIn("Set-Cookie", headers)

    def test_a_login_that_is_no_json_is_refused(self):
        for body in ("token=driveme11", "[]", '{"token":["driveme11"]}', b"\xff\xfe"):
            self.assertEqual(self.login(body)[0], 403)

    def test_a_huge_login_is_refused(self):
        self.assertEqual(self.login('{"token":"%s"}' % ("x" * 100000))[0], 413)

    def test_guessing_is_slowed_down(self):
        statuses = [self.login('{"token":"guess%d"}' % n)[0] for n in range(12)]
        self.assertEqual(statuses[:5], [403] * 5)
        self.assertEqual(statuses[-1], 429)
        self.assertEqual(self.login('{"token":"driveme11"}')[0], 429)  # not by this address, now

    def test_strangers_do_not_keep_out_who_knows_the_token(self):
        async def guess(address):
            async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(local_addr=(address, 0))) as session:
                for _ in range(8):
                    async with session.post(self.served.address + "/login", json={"token": "guessing"}, headers={"Origin": self.served.address}) as answer:
                        await answer.read()
                return answer.status
        for n in range(2, 12):
            self.assertEqual(self.pages.run(guess(f"127.0.0.{n}")), 429)
        self.assertEqual([self.login('{"token":"driveme11"}')[0] for _ in range(8)], [200] * 8)  # right ones are not counted

    def test_pages_without_a_role_leave_room_for_others(self):
        pages = [self.open() for _ in range(limits.MAX_STRANGERS)]
        with self.assertRaises(aiohttp.WSServerHandshakeError) as caught:
            self.open()
        self.assertEqual((caught.exception.status, len(pages)), (503, limits.MAX_STRANGERS))
        self.expect_all_is_well()

    def test_a_cookie_that_is_no_text_shows_nothing(self):
        out = self.raw(f"GET /session HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\nCookie: {app.COOKIE}=\xff.1.2.\xff\r\n\r\n".encode("latin-1"))[0]
        self.assertIn(b"200 OK", out.split(b"\r\n")[0])
        self.assertIn(b'"role": ""', out)

    def test_a_login_of_a_charset_that_does_not_exist_is_refused(self):
        headers = {"Origin": self.served.address, "Content-Type": "application/json; charset=bogus"}
        self.assertEqual(self.pages.request("POST", self.served.address + "/login", data='{"token":"driveme11"}', headers=headers)[0], 403)

    def test_a_host_with_half_a_bracket_is_refused(self):
        for host in ("[", "[::1", "[v1.x]"):
            out = self.raw(f"GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())[0]
            self.assertRegex(out.split(b"\r\n")[0], rb"HTTP/1.1 (400|421)", host)

    def test_without_login_nothing_is_shown_and_only_stop_is_done(self):
        page = self.open()
        self.assertEqual(page.ask("say", text="Hello.")["error"], "not_allowed")
        self.assertEqual(page.ask("pose", x=0, y=0, yaw=0)["error"], "not_allowed")
        self.assertEqual(page.ask("stop")["done"], "stop")
        self.assertEqual((self.robot.stops, self.robot.asked, page.state, page.tiles), (1, [], {}, {}))
        for address in ("/reports", "/recording", "/report/x.html"):
            self.assertEqual(self.pages.request("GET", self.served.address + address)[0], 403, address)

    def test_stop_by_a_request_needs_no_login_but_a_page_from_here(self):
        self.assertEqual(self.pages.request("POST", self.served.address + "/stop", headers={"Origin": self.served.address})[0], 200)
        self.assertEqual(self.pages.request("POST", self.served.address + "/stop", headers={"Origin": "http://evil.example"})[0], 403)
        self.assertEqual(self.pages.request("POST", self.served.address + "/stop")[0], 403)
        self.assertEqual(self.robot.stops, 1)

    def test_a_forged_cookie_shows_nothing(self):
        good = self.cookie("look")
        page = self.open(cookie=good.replace("look", "drive"))
        self.assertEqual(page.ask("say", text="Hello.")["error"], "not_allowed")
        self.assertEqual(page.state, {})

    def test_who_may_look_may_not_talk(self):
        page = self.open(cookie=self.cookie("look"))
        wait_until(lambda: "map" in page.state, "the map")
        for what, fields in (("say", {"text": "Go."}), ("name", {"place": 1, "names": ["x"]}), ("go", {"place": 1, "language": "en"}), ("save", {})):
            self.assertEqual(page.ask(what, **fields)["error"], "not_allowed", what)
        self.assertEqual(self.robot.asked, [])

    def test_who_may_talk_may_not_drive(self):
        page = self.open(cookie=self.cookie("talk"))
        self.assertEqual(page.ask("name", place=1, names=["kitchen"])["done"], "name")
        for what, fields in (("go", {"place": 1, "language": "en"}), ("pose", {"x": 0, "y": 0, "yaw": 0}), ("wall", {"ax": 0, "ay": 0, "bx": 1, "by": 1}),
                             ("shut", {"door": 1}), ("here", {"place": 1}), ("learn", {"on": True}), ("save", {})):
            self.assertEqual(page.ask(what, **fields)["error"], "not_allowed", what)
        self.assertEqual(len(self.robot.asked), 1)

    def test_pages_of_other_origins_are_refused(self):
        for origin in ("http://evil.example", "null", f"http://127.0.0.1.evil.example:{self.served.port}", "http://127.0.0.1:1"):
            with self.assertRaises(aiohttp.WSServerHandshakeError) as caught:
                self.open(cookie=self.cookie("drive"), origin=origin)
            self.assertEqual(caught.exception.status, 403, origin)

    def test_a_socket_without_an_origin_is_refused(self):
        with self.assertRaises(aiohttp.WSServerHandshakeError):
            self.open(cookie=self.cookie("drive"), origin=False)

    def test_names_that_lead_here_from_elsewhere_are_refused(self):
        for host in ("evil.example", f"evil.example:{self.served.port}", ""):
            self.assertIn(self.pages.request("GET", self.served.address + "/", headers={"Host": host})[0], (400, 421), host)
        self.assertEqual(self.pages.request("GET", self.served.address + "/", headers={"Host": "robot.test"})[0], 200)

    def test_a_restarted_server_knows_its_cookies_and_pages_go_on(self):
        cookie, port = self.cookie("drive"), self.served.port
        page = self.open(cookie=cookie)
        wait_until(lambda: page.state, "the map")
        self.served.close()
        wait_until(lambda: page.code, "the end")
        self.served = ServedRobot(self.robot, TOKENS, port)
        again = self.open(cookie=cookie, query="?run=older&since=5")
        wait_until(lambda: "map" in again.state and again.tiles, "the map")
        self.assertEqual(again.ask("say", text="Hello again.")["done"], "say")


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
