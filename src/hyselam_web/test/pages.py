"""Pages without a browser, for tests of what may be sent to the server. No test; others import it."""
import asyncio
import json
import socket
import sys
import threading
import time
import unittest

import aiohttp

sys.dont_write_bytecode = True
from fake_robot import FakeRobot, ServedRobot, WAIT, wait_until
from hyselam_web import app, tiles

TOKENS = "look=lookatme1 talk=talktome1 drive=driveme11"
HANDSHAKE = ("GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n")


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
        self.order, self.overview = [], None
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
                self.order.append(message.data[:8])
                if message.data[:8] == tiles.OVERVIEW:
                    self.overview = message.data[12:]
                else:
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

    def stand_still(self):
        """No bucket fills and no second stop is said but when the test says so."""
        at = [self.served.server.clock()]
        self.served.server.clock = lambda: at[0]
        return at

    def raw(self, data, wait=WAIT):
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
