"""The server: pages, their WebSockets, logins. What the robot is and does comes from an object `robot` with
    world, tiles                  what pages are shown
    collect()                     takes over what the robot said since the last time
    now()                         its clock [s]
    stop(say, language)           at once; says it to the dialogue, too, if say; returns how many hear it
    async act(name, fields, role) does what a page asks for; returns what to show it, or raises requests.Refused
All runs in one event loop."""
import asyncio
import logging
import os
import secrets
import time

from aiohttp import WSCloseCode, WSMsgType, web

from . import access as accesses
from . import limits, reports as report_files, requests, tiles as map_tiles, world as worlds

PERIOD = 0.2  # [s] between two looks at the robot
ALIVE = 5.0  # [s] after which a page that nothing was sent to hears that the server lives
TILES_AT_ONCE = 16
HEAD_START = 0.1  # [s] for a page to show the coarse picture before the tiles keep it busy
STOP_PERIOD = 0.5  # [s] between two stops that are said to the dialogue
COOKIE = "hyselam_web"
UNUSED = 15.0  # [s] that a connection may be open without asking for anything
MAX_CONNECTIONS = 400
SLOW, SLOW_STRANGER = 600.0, 60.0  # [s] that a request may take, but a WebSocket; of who has no role
CLOSING = 2.0  # [s] that a page has to say goodbye
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".json": "application/manifest+json"}
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cross-Origin-Opener-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=(self)", "Cache-Control": "no-cache"}
log = logging.getLogger("hyselam_web")


def static_files(folder):
    """{address: (bytes, type)} of the page, read once."""
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            ending = os.path.splitext(name)[1]
            if ending in TYPES:
                path = os.path.join(root, name)
                with open(path, "rb") as file:
                    found["/" + os.path.relpath(path, folder).replace(os.sep, "/")] = (file.read(), TYPES[ending])
    # All modules are asked for at once, not each when another one turns out to need it.
    modules = "".join(f'<link rel="modulepreload" href="{address[1:]}">\n' for address in sorted(found) if address.endswith(".js"))
    page, kind = found["/index.html"]
    found["/"] = found["/index.html"] = (page.replace(b"</head>", modules.encode() + b"</head>"), kind)
    return found


class Page:
    """One open page."""

    def __init__(self, socket, role, address, since, cookie=None):
        self.socket, self.role, self.address, self.since = socket, role, address, since
        self.number = secrets.token_hex(6)
        self.person = cookie if role and cookie else address  # whose limits count: more pages say no more
        self.tiles_from, self.tiles_sent = since, {}
        self.saw_all = since > 0  # coarsely
        self.hidden = False
        self.news = asyncio.Event()
        self.sending, self.last_sent = None, 0.0  # since when; when
        self.task = None

    def abort(self):
        transport = self.socket._req.transport if self.socket._req is not None else None
        if transport is not None:
            transport.abort()


class Server:
    def __init__(self, robot, access, static, reports=None, recorder=None, language="en", clock=time.monotonic, wall=time.time):
        self.robot, self.access, self.static, self.recorder = robot, access, static, recorder
        self.reports = reports or report_files.Reports()
        self.language, self.clock, self.wall = language, clock, wall
        self.run = secrets.token_hex(6)
        self.pages = set()
        self.buckets = limits.Buckets()
        self._stopped, self._stop_again, self._stop_language = -1e9, False, ""
        self._texts = {}  # {since: text} of the newest version
        self._texts_of = -1
        self._seen = {}  # connection: since when it has asked for nothing
        self._begun = {}  # connection: what it asks for, since when

    # ---- Application ----

    def application(self):
        app = web.Application(client_max_size=4096, middlewares=[self._guard])
        app.router.add_get("/ws", self.on_socket)
        app.router.add_get("/session", self.on_session)
        app.router.add_post("/login", self.on_login)
        app.router.add_post("/logout", self.on_logout)
        app.router.add_post("/stop", self.on_stop)
        app.router.add_get("/reports", self.on_reports)
        app.router.add_get("/report/{name:.+}", self.on_report)
        app.router.add_get("/recording", self.on_recording)
        app.router.add_get("/{name:.*}", self.on_static)
        app.on_shutdown.append(self._close_pages)
        return app

    async def _close_pages(self, _):
        """All at once, and those that do not answer without their leave."""
        pages = list(self.pages)
        await asyncio.gather(*(asyncio.wait_for(page.socket.close(code=WSCloseCode.GOING_AWAY), CLOSING) for page in pages), return_exceptions=True)
        for page in pages:
            page.abort()

    @web.middleware
    async def _guard(self, request, handler):
        if not self.access.knows_host(request.headers.get("Host")):
            response = web.Response(status=421, text="This server is not known by that name; see the parameter hosts.\n")
        elif request.method == "POST" and not self.access.knows_origin(request.headers.get("Origin"), request.headers.get("Host")):
            response = web.Response(status=403, text="The request comes from another page.\n")
        else:
            try:
                response = await handler(request)
            except web.HTTPException as error:
                response = web.Response(status=error.status, text=f"{error.status} {error.reason}\n")
        if not response.prepared:
            for name, value in HEADERS.items():
                response.headers.setdefault(name, value)
        return response

    def _role(self, request):
        return self.access.role_of_cookie(request.cookies.get(COOKIE), self.wall())

    # ---- Pages ----

    async def on_static(self, request):
        found = self.static.get("/" + request.match_info["name"])
        if found is None:
            raise web.HTTPNotFound()
        return web.Response(body=found[0], content_type=found[1], charset="utf-8")

    async def on_session(self, request):
        return web.json_response({"role": self._role(request), "login": self.access.needs_login, "language": self.language, "run": self.run,
                                  "recording": self.recorder is not None})

    async def on_login(self, request):
        try:
            given = await request.json()
            token = given["token"] if isinstance(given, dict) else None
        except (ValueError, KeyError, LookupError, RecursionError):  # LookupError: of a charset that does not exist
            token = None
        # From here on nothing waits: many logins at once are as many as one after the other.
        now = self.clock()
        if not (self.buckets.has(request.remote, "login", now) and self.buckets.has("everybody", "logins", now)):
            return web.json_response({"error": "too often"}, status=429)
        role = self.access.role_of_token(token) if isinstance(token, str) and len(token) <= 500 else accesses.NOBODY
        if role == accesses.NOBODY:  # only these count: no stranger keeps out who knows a token
            self.buckets.take(request.remote, "login", now)
            self.buckets.take("everybody", "logins", now)
            return web.json_response({"error": "wrong"}, status=403)
        response = web.json_response({"role": role})
        response.set_cookie(COOKIE, self.access.cookie(role, self.wall()), max_age=accesses.LIFETIME, httponly=True, samesite="Strict",
                            secure=request.secure)
        return response

    async def on_logout(self, _):
        response = web.json_response({})
        response.del_cookie(COOKIE)
        return response

    async def on_stop(self, request):
        """For everybody who reaches the server, logged in or not."""
        return web.json_response({"done": True, "heard": self.stop(requests.checked("language", request.query.get("language")) or "")})

    def _only_for(self, request, role):
        if not accesses.may(self._role(request), role):
            raise web.HTTPForbidden()

    async def on_reports(self, request):
        self._only_for(request, "look")
        return web.json_response(await asyncio.get_event_loop().run_in_executor(None, self.reports.scan))

    async def on_report(self, request):
        self._only_for(request, "look")
        found = self.reports.find(request.match_info["name"])
        if found is None:
            raise web.HTTPNotFound()
        return web.FileResponse(found[0], headers=dict(HEADERS, **{"Content-Type": found[1], "Content-Security-Policy": report_files.POLICY}))

    async def on_recording(self, request):
        self._only_for(request, "look")
        if self.recorder is None:
            raise web.HTTPNotFound()
        return web.FileResponse(self.recorder.path, headers=dict(HEADERS, **{"Content-Type": "text/plain; charset=utf-8"}))

    # ---- WebSockets ----

    async def on_socket(self, request):
        if not self.access.knows_origin(request.headers.get("Origin"), request.headers.get("Host")):
            raise web.HTTPForbidden()
        if len(self.pages) >= limits.MAX_PAGES or sum(p.address == request.remote for p in self.pages) >= limits.MAX_PAGES_OF_ADDRESS:
            raise web.HTTPServiceUnavailable()
        role = self._role(request)
        if role == accesses.NOBODY and sum(p.role == accesses.NOBODY for p in self.pages) >= limits.MAX_STRANGERS:
            raise web.HTTPServiceUnavailable()
        socket = web.WebSocketResponse(heartbeat=20.0, max_msg_size=limits.MAX_MESSAGE_BYTES, compress=False)
        await socket.prepare(request)
        since = 0
        if request.query.get("run") == self.run and request.query.get("since", "").isdecimal():
            since = min(int(request.query["since"][:15]), self.robot.world.version)
        page = Page(socket, role, request.remote, since, request.cookies.get(COOKIE))
        self.pages.add(page)
        page.task = asyncio.ensure_future(self._send_news(page))
        page.news.set()
        try:
            async for message in socket:
                if message.type == WSMsgType.TEXT:
                    await self._on_message(page, message.data)
                elif message.type == WSMsgType.BINARY:
                    await self._refuse(page, None, requests.Refused("malformed", "only text is read"))
                if not self.buckets.has(page.number, "refused", self.clock()):
                    await socket.close(code=WSCloseCode.POLICY_VIOLATION, message=b"too much")
        finally:
            self.pages.discard(page)
            page.task.cancel()
        return socket

    async def _refuse(self, page, number, error):
        now = self.clock()
        self.buckets.take(page.number, "refused", now)
        if self.buckets.take(page.number, "reason", now):  # a flood is not answered by one
            await self._tell(page, {"n": number, "error": error.code, "reason": str(error)})

    async def _tell(self, page, value):
        try:
            await page.socket.send_str(worlds.to_text(value))
        except (ConnectionError, RuntimeError):
            pass  # it has gone

    async def _on_message(self, page, text):
        number = None
        try:
            name, fields, number = requests.parse(text)
            role, bucket, _ = requests.REQUESTS[name]
            if name == "stop":
                await self._tell(page, {"n": number, "done": "stop", "result": {"heard": self.stop(fields.get("language", ""))}})
                return
            if not accesses.may(page.role, role):
                raise requests.Refused("not_allowed", f"this needs the role {role}")
            now = self.clock()
            if not self.buckets.take(page.number, "message", now) or (bucket != "message" and not self.buckets.take(page.person, bucket, now)):
                raise requests.Refused("too_often", "too much at once: wait a moment")
            if name == "hide":
                page.hidden = fields["on"]
                page.news.set()
                return
            # The page may say stop meanwhile.
            asyncio.ensure_future(self._act(page, number, name, fields))
        except requests.Refused as error:
            await self._refuse(page, number if error.number is None else error.number, error)

    async def _act(self, page, number, name, fields):
        try:
            await self._tell(page, {"n": number, "done": name, "result": await self.robot.act(name, fields, page.role)})
        except requests.Refused as error:
            await self._tell(page, {"n": number, "error": error.code, "reason": str(error)})
        except Exception as error:  # one request must not end the server
            log.exception("%s failed", name)
            await self._tell(page, {"n": number, "error": "failed", "reason": f"{type(error).__name__}"})

    def _news_of(self, since):
        """(text, number) of what changed; the same for all who know as much."""
        if self._texts_of != self.robot.world.version:
            self._texts, self._texts_of = {}, self.robot.world.version
        if since not in self._texts:
            delta = self.robot.world.delta(since)
            if delta is not None:
                delta["run"] = self.run
            self._texts[since] = None if delta is None else worlds.to_text(delta)
        return self._texts[since], self._texts_of

    def _tiles_for(self, page):
        """Keys of tiles that the page does not have, the nearest to the robot first."""
        tiles = self.robot.tiles.tiles
        wanted = [key for key, (number, picture) in tiles.items()
                  if number > page.tiles_sent.get(key, page.tiles_from) and (picture or key in page.tiles_sent or page.tiles_from)]
        pose, info = self.robot.world.get("pose"), self.robot.tiles.info
        if pose and info:
            side = info["side"] * info["resolution"]
            x, y = pose["x"] / side - 0.5, pose["y"] / side - 0.5
            wanted.sort(key=lambda key: (key[0] - x) ** 2 + (key[1] - y) ** 2)
        return wanted[:TILES_AT_ONCE]

    async def _send_news(self, page):
        try:
            while not page.socket.closed:
                await page.news.wait()
                page.news.clear()
                if page.hidden or not accesses.may(page.role, "look"):
                    continue
                page.sending = self.clock()
                text, version = self._news_of(page.since)
                if text is not None:
                    await page.socket.send_str(text)
                    page.since, page.last_sent = version, self.clock()
                keys = self._tiles_for(page)
                overview = self.robot.tiles.overview() if len(keys) == TILES_AT_ONCE and not page.saw_all else None
                if overview is not None:  # a large map: all of it at once, then what is near
                    await page.socket.send_bytes(map_tiles.overview_frame(overview))
                    await asyncio.sleep(HEAD_START)
                page.saw_all = page.saw_all or bool(keys)
                for key in keys:
                    tile = self.robot.tiles.tiles[key]
                    await page.socket.send_bytes(map_tiles.frame(key, tile))
                    page.tiles_sent[key] = tile[0]
                    page.last_sent = self.clock()
                if keys:
                    page.news.set()
                elif self.clock() - page.last_sent > ALIVE:
                    await page.socket.send_str('{"alive":1}')
                    page.last_sent = self.clock()
                page.sending = None
        except (ConnectionError, RuntimeError, asyncio.CancelledError):
            pass  # it has gone; on_socket ends, too

    def stop(self, language=""):
        """At once, and answered in that language; of a flood of them a few in a second are said, the last one for certain: something may have begun in between. Returns
        how many hear it."""
        self._stop_again, self._stop_language = self.clock() - self._stopped < STOP_PERIOD, language
        if not self._stop_again:
            self._stopped = self.clock()
        return self.robot.stop(not self._stop_again, language)

    # ---- Time ----

    def _record(self):
        if self.recorder is not None:
            self.recorder.take(self.robot.now(), self.robot.world, self.robot.tiles)

    def tick(self):
        if self._stop_again and self.clock() - self._stopped >= STOP_PERIOD:
            self.stop(self._stop_language)
        # Neither keeps pages from what the other has.
        for part in (self.robot.collect, self._record):
            try:
                part()
            except Exception:  # a message that nobody thought of must not end the server
                log.exception("a look at the robot failed")
        now = self.clock()
        for page in list(self.pages):
            if page.sending is not None and now - page.sending > limits.STALLED:
                log.warning("a page at %s takes nothing: it is disconnected", page.address)
                page.abort()
            elif page.since != self.robot.world.version or now - page.last_sent > ALIVE:
                page.news.set()

    def close_unused(self, connections):
        """Connections that ask for nothing, those that are too many, and requests that do not end."""
        now, connections = self.clock(), list(connections)
        self._seen = {c: self._seen.get(c, now) for c in connections if getattr(c, "_current_request", None) is None}
        idle = sorted(((since, c) for c, since in self._seen.items()), key=lambda each: each[0])
        spare = len(connections) - MAX_CONNECTIONS
        for begin, connection in idle:
            if now - begin > UNUSED or spare > 0:
                spare -= 1
                self._abort(connection)
        sockets = {id(page.socket._req) for page in self.pages}
        begun = {}
        for connection in connections:
            request = getattr(connection, "_current_request", None)
            if request is None or id(request) in sockets:
                continue
            begun[connection] = self._begun.get(connection, (None, 0))
            if begun[connection][0] is not request:
                begun[connection] = (request, now)
            if now - begun[connection][1] > (SLOW_STRANGER if self._role(request) == accesses.NOBODY else SLOW):
                self._abort(connection)
        self._begun = begun

    @staticmethod
    def _abort(connection):
        transport = getattr(connection, "transport", None)
        if transport is not None:
            transport.abort()

    async def run_forever(self, host, port, ssl_context=None, ready=None):
        runner = web.AppRunner(self.application(), access_log=None, handle_signals=False)
        await runner.setup()
        site = web.TCPSite(runner, host, port, ssl_context=ssl_context, shutdown_timeout=2.0)
        await site.start()
        if ready is not None:
            ready(runner.addresses[0][1])
        count = 0
        try:
            while True:
                await asyncio.sleep(PERIOD)
                try:
                    self.tick()
                    count += 1
                    if count % 10 == 0:
                        self.close_unused(runner.server.connections)
                except Exception:  # a message that nobody thought of must not end the server
                    log.exception("a look at the robot failed")
        finally:
            await runner.cleanup()
