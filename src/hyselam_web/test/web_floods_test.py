#!/usr/bin/env python3
"""Too much of everything: the server gives each its share, stop goes through, nobody holds up others."""
import json
import socket
import sys
import time

import aiohttp

sys.dont_write_bytecode = True
from fake_robot import WAIT, wait_until
from hyselam_web import app, limits
from pages import Case, HANDSHAKE


class FloodsTest(Case):
    def test_a_flood_of_nonsense_ends_its_page_and_is_not_answered_by_a_flood(self):
        self.stand_still()
        page = self.open()
        try:
            for _ in range(limits.FLOOD + 200):
                page.send("x")
        except ConnectionError:
            pass
        wait_until(lambda: page.code, "the end")
        self.assertLess(sum(len(a) for a in page.answers.values()), 60)
        self.expect_all_is_well()

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
        page.ask("stop", language="pt")
        took, stops = time.monotonic() - begin, self.robot.stops
        self.assertGreaterEqual(stops, 1)
        self.assertGreaterEqual(self.robot.cancels, 301)  # each cancels what moves
        self.assertLessEqual(stops, 2 + took / app.STOP_PERIOD)
        wait_until(lambda: not self.served.server._stop_again, "the last stop")
        self.assertGreater(self.robot.stops, 1)
        self.assertEqual(self.robot.stop_language, "pt")  # also of the one that was said later

    def test_a_stop_that_nobody_hears_is_told(self):
        page = self.open()
        self.assertEqual(page.ask("stop")["result"], {"heard": 1})
        self.robot.hearers = 0
        self.assertEqual(page.ask("stop")["result"], {"heard": 0})
        answer = self.pages.request("POST", self.served.address + "/stop", headers={"Origin": self.served.address})
        self.assertEqual(json.loads(answer[1])["heard"], 0)

    def test_slow_requests_cannot_be_heaped_up(self):
        self.stand_still()
        page = self.open()
        answers = [page.ask("doctor") for _ in range(6)]
        self.assertEqual(sum("done" in a for a in answers), limits.RATES["slow"][0])

    def test_sentences_that_are_only_tried_do_not_hold_up_what_is_done(self):
        self.stand_still()
        page = self.open()
        answers = [page.ask("try", text="Where is the lab?") for _ in range(3 * limits.RATES["try"][0])]
        self.assertIn("too_often", [a.get("error") for a in answers])
        self.assertEqual(page.ask("go", place=1, language="en").get("error"), None)

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
        app.SLOW = 600.0  # a page that comes slowly is no such request
        self.expect_all_is_well()

    def test_pages_that_take_nothing_do_not_hold_up_the_end(self):
        self.addCleanup(setattr, app, "CLOSING", app.CLOSING)
        app.CLOSING = 0.2
        for _ in range(5):
            s = socket.socket()
            self.addCleanup(s.close)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", self.served.port))
            s.sendall(HANDSHAKE.format(port=self.served.port).encode())
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
            try:
                s.sendall(b"GET / HTTP/1.1\r\nHost: ")
            except ConnectionError:
                pass  # it is closed already
        for s in idle:
            s.settimeout(WAIT)
            try:
                self.assertEqual(s.recv(10), b"")
            except ConnectionError:
                pass
            s.close()
        app.UNUSED = 15.0  # a page that comes slowly is none of them
        self.expect_all_is_well()

    def test_a_page_that_takes_nothing_holds_up_nobody_and_is_disconnected(self):
        self.addCleanup(setattr, limits, "STALLED", limits.STALLED)
        limits.STALLED = WAIT / 30  # more than a page that takes all needs on a slow machine
        with socket.socket() as s:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", self.served.port))
            s.sendall(HANDSHAKE.format(port=self.served.port).encode())
            wait_until(lambda: self.served.server.pages, "the page")
            other = self.open()
            wait_until(lambda: len(self.served.server.pages) == 2, "the other page")
            count = [0]
            self.robot.collect = lambda: (self.robot.world.set("names", ["x" * 100000 + str(count[0])]), count.__setitem__(0, count[0] + 1))
            wait_until(lambda: len(self.served.server.pages) == 1, "the end of the page that takes nothing")
            wait_until(lambda: len(str(other.state.get("names"))) > 1000, "what the other page hears")
        del self.robot.collect
        self.expect_all_is_well()


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_floods_test", "web_floods_test")
