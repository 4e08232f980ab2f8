#!/usr/bin/env python3
"""Logins, cookies, roles, hosts and origins: who may not sees and does nothing."""
import sys

import aiohttp

sys.dont_write_bytecode = True
from fake_robot import ServedRobot, free_port, wait_until
from hyselam_web import app, limits
from pages import Case, TOKENS


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
        self.stand_still()
        statuses = [self.login('{"token":"guess%d"}' % n)[0] for n in range(12)]
        self.assertEqual(statuses[:5], [403] * 5)
        self.assertEqual(statuses[-1], 429)
        self.assertEqual(self.login('{"token":"driveme11"}')[0], 429)  # not by this address, now

    def test_strangers_do_not_keep_out_who_knows_the_token(self):
        self.stand_still()

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
        self.served.close()
        port = free_port()
        self.served = ServedRobot(self.robot, TOKENS, port)
        cookie = self.cookie("drive")
        page = self.open(cookie=cookie)
        wait_until(lambda: page.state, "the map")
        self.served.close()
        wait_until(lambda: page.code, "the end")
        self.served = ServedRobot(self.robot, TOKENS, port)
        again = self.open(cookie=cookie, query="?run=older&since=5")
        wait_until(lambda: "map" in again.state and again.tiles, "the map")
        self.assertEqual(again.ask("say", text="Hello again.")["done"], "say")


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_login_test", "web_login_test")
