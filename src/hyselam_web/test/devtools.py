"""A real browser for tests: headless Chromium, driven by its own protocol (Chrome DevTools) over aiohttp. Waits for conditions, never for
time. No test; others import it."""
import asyncio
import base64
import glob
import json
import os
import shutil
import subprocess
import tempfile
import threading
import time

import aiohttp

WAIT = float(os.environ.get("HYSELAM_SLOWNESS", "1")) * 90.0  # [s] never reached when all is well
REACHES = WAIT / 15  # [s] that a press may take until the page has it
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
         "--disable-sync", "--disable-quic", "--disable-extensions", "--disable-default-apps", "--disable-dev-shm-usage", "--hide-scrollbars",
         "--mute-audio", "--remote-debugging-port=0", "--remote-allow-origins=*"]
FOLDERS = "hyselam_browser_"
TWICE = (44, 0.8)  # [pixels, s] within which a second tap is one by mistake
PHONE, DESKTOP = (360, 740, True), (1280, 800, False)
# What a function finds, once it is the same in three pictures that follow each other; null: not yet. A page that draws nothing goes on, too.
STILL = """(async (found) => { const next = () => new Promise((done) => { requestAnimationFrame(done); setTimeout(done, 1000); });
    const first = found(); if (first === null) return null;
    for (const _ of [1, 2]) { await next(); if (JSON.stringify(found()) !== JSON.stringify(first)) return null; }
    return first; })(%s)"""


def program():
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def clear_dead():
    """Removes the profiles of tests that were killed: each is named by the process that made it."""
    for path in glob.glob(os.path.join(tempfile.gettempdir(), FOLDERS + "*_*")):
        maker = os.path.basename(path)[len(FOLDERS):].split("_")[0]
        if maker.isdigit() and not os.path.exists(f"/proc/{maker}"):
            shutil.rmtree(path, ignore_errors=True)


class Browser:
    def __init__(self):
        clear_dead()
        self.folder = tempfile.mkdtemp(prefix=f"{FOLDERS}{os.getpid()}_")
        # What Chromium leaves in the folder of temporary files goes with its profile.
        self.process = subprocess.Popen([program(), *FLAGS, f"--user-data-dir={self.folder}", "about:blank"], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=dict(os.environ, TMPDIR=self.folder))
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.number, self.waiting, self.tabs = 0, {}, {}
        try:
            port = self._port()
            self.run(self._connect(port))
        except BaseException:
            self.close()
            raise

    def _port(self):
        path, deadline = os.path.join(self.folder, "DevToolsActivePort"), time.monotonic() + 2 * WAIT
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                with open(path) as file:
                    lines = file.read().splitlines()
                if len(lines) >= 2:
                    return f"ws://127.0.0.1:{lines[0]}{lines[1]}"
            except OSError:
                pass
            time.sleep(0.05)
        raise AssertionError(f"the browser did not start (status {self.process.poll()})")

    def run(self, coroutine, wait=WAIT):
        return asyncio.run_coroutine_threadsafe(coroutine, self.loop).result(wait)

    async def _connect(self, address):
        self.session = aiohttp.ClientSession()
        self.socket = await self.session.ws_connect(address, max_msg_size=0)
        asyncio.ensure_future(self._receive())

    async def _receive(self):
        async for message in self.socket:
            value = json.loads(message.data)
            if "id" in value:
                future = self.waiting.pop(value["id"], None)
                if future is not None and not future.done():
                    future.set_result(value)
            elif value.get("sessionId") in self.tabs:
                self.tabs[value["sessionId"]].on_event(value["method"], value.get("params", {}))

    async def _send(self, method, params, session):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        self.waiting[self.number] = future = self.loop.create_future()
        await self.socket.send_str(json.dumps(message))
        answer = await future
        if "error" in answer:
            raise AssertionError(f"{method}: {answer['error']}")
        return answer["result"]

    def send(self, method, session=None, **params):
        return self.run(self._send(method, params, session))

    def send_all(self, session, *messages):
        """One after the other, without waiting for the answers in between."""
        async def together():
            await asyncio.gather(*(self._send(method, params, session) for method, params in messages))
        self.run(together())

    def tab(self, size=DESKTOP, dark=False, language="en-US", ratio=1):
        """A page with cookies of its own."""
        return Tab(self, size, dark, language, ratio)

    async def _disconnect(self):
        await self.socket.close()
        await self.session.close()

    def close(self):
        if hasattr(self, "socket"):
            self.run(self._disconnect())
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.loop.call_soon_threadsafe(self.loop.stop)
        shutil.rmtree(self.folder, ignore_errors=True)


class Tab:
    def __init__(self, browser, size, dark, language, ratio):
        self.browser, self.errors, self.size = browser, [], size
        context = browser.send("Target.createBrowserContext")["browserContextId"]
        target = browser.send("Target.createTarget", url="about:blank", browserContextId=context)["targetId"]
        self.session = browser.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        browser.tabs[self.session] = self
        self.target = target
        for domain in ("Page", "Runtime", "Log"):
            self.send(domain + ".enable")
        width, height, touch = size
        self.touch = touch
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=touch)
        self.send("Emulation.setTouchEmulationEnabled", enabled=touch)
        self.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        agent = browser.send("Browser.getVersion")["userAgent"]
        self.send("Emulation.setUserAgentOverride", userAgent=agent, acceptLanguage=language)

    def send(self, method, **params):
        return self.browser.send(method, self.session, **params)

    def on_event(self, method, params):
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(f"{params['entry']['text']} {params['entry'].get('url', '')}")

    def goto(self, address):
        self.send("Page.navigate", url=address)
        self.wait("document.readyState === 'complete'", "the page")

    def eval(self, expression):
        answer = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise AssertionError(f"{expression}: {answer['exceptionDetails'].get('exception', {}).get('description')}")
        return answer["result"].get("value")

    def wait(self, condition, what, seconds=WAIT):
        """Until an expression is true; its value."""
        deadline = time.monotonic() + seconds
        while True:
            try:
                value = self.eval(f"((v) => v instanceof Node || v)({condition})")
            except AssertionError as error:  # while a page is left there is nobody to ask
                value, last = None, str(error)
            else:
                last = value
            if value:
                return value
            if time.monotonic() > deadline:
                raise AssertionError(f"not within {seconds:.0f} s: {what() if callable(what) else what} ({condition}: {last}; errors: {self.errors[-3:]})")
            time.sleep(0.05)

    def middle(self, selector):
        """Where an element is, scrolled into view; it must be there, seen, not covered, and lie still."""
        found = json.dumps(selector)
        at = self.wait(STILL % f"""() => {{ const e = document.querySelector({found}); if (!e || e.disabled) return null;
            e.scrollIntoView({{block: 'nearest', inline: 'nearest'}}); const b = e.getBoundingClientRect(); if (!b.width || !b.height) return null;
            if (e.closest('.settling')) return null;
            const x = b.x + b.width / 2, y = b.y + b.height / 2, top = document.elementFromPoint(x, y);
            return top && e.contains(top) ? [x, y] : null; }}""", f"{selector} to be seen and to lie still")
        return at

    def press(self, x, y, double=False):
        """Both ends at once: nothing moves away in between because this machine is slow. Not twice on a spot at once, which people do by mistake."""
        last, self.last_press = getattr(self, "last_press", None), (x, y)
        if last and not double and abs(last[0] - x) < TWICE[0] and abs(last[1] - y) < TWICE[0]:
            time.sleep(max(0.0, self.pressed_at + TWICE[1] - time.monotonic()))
        self.pressed_at = time.monotonic()
        if self.touch:
            self.browser.send_all(self.session, *(("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
                                                  for kind, points in (("touchStart", [{"x": x, "y": y}]), ("touchEnd", []))))
        else:
            self.browser.send_all(self.session, *(("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1})
                                                  for kind in ("mousePressed", "mouseReleased")))

    def click(self, selector):
        """Until the element has it: what has moved away under the finger is pressed again, as by a person."""
        found, beside = json.dumps(selector), []
        for _ in range(5):
            at = self.middle(selector)
            is_there = self.eval(f"""(() => {{ const e = document.querySelector({found}); globalThis.pressed = '';
                if (e) globalThis.addEventListener('click', ({{target}}) => {{
                    pressed = e.contains(target) || (!e.isConnected && target.closest({found})) ? 'it' : target.outerHTML.slice(0, 100); }}, {{capture: true, once: true}});
                return Boolean(e); }})()""")
            if not is_there:
                continue  # it has gone, and may come back
            self.press(*at)
            deadline = time.monotonic() + REACHES
            while True:
                hit = self.pressed()
                if hit == "it":
                    return
                if hit or time.monotonic() > deadline:
                    break
                time.sleep(0.02)
            beside.append(hit)
            print(f"a press of {selector} at {at} has reached {hit or 'nothing'}", flush=True)
        raise AssertionError(f"no press of {selector} has reached it: {beside}")

    def pressed(self):
        """What the press has reached; where the page was left since, that what leads away."""
        try:
            return self.eval("globalThis.pressed ?? 'it'")
        except AssertionError:
            return ""  # it is being left

    def drag(self, a, b):
        way = [(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])) for share in (0.3, 0.7, 1.0)]
        if self.touch:
            steps = [("touchStart", [a]), *(("touchMove", [point]) for point in way), ("touchEnd", [])]
            self.browser.send_all(self.session, *(("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y} for x, y in points]}) for kind, points in steps))
        else:
            steps = [("mousePressed", a), *(("mouseMoved", point) for point in way), ("mouseReleased", b)]
            self.browser.send_all(self.session, *(("Input.dispatchMouseEvent", dict({"type": kind, "x": x, "y": y, "button": "left"}, **({"buttons": 1} if kind == "mouseMoved" else {"clickCount": 1})))
                                                  for kind, (x, y) in steps))

    def type(self, text):
        self.send("Input.insertText", text=text)

    def key(self, name, code=None, shift=False):
        codes = {"Enter": 13, "Tab": 9, "Escape": 27, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}
        more = {"text": "\r"} if name == "Enter" else {"text": name} if len(name) == 1 else {}
        more["modifiers"] = 8 if shift else 0
        self.send("Input.dispatchKeyEvent", type="keyDown", key=name, code=code or name, windowsVirtualKeyCode=codes.get(name, ord(name[0])), **more)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=name, code=code or name, windowsVirtualKeyCode=codes.get(name, ord(name[0])))

    def picture(self, path):
        data = base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"])
        with open(path, "wb") as file:
            file.write(data)
        return path

    def close(self):
        self.browser.send("Target.closeTarget", targetId=self.target)
        self.browser.tabs.pop(self.session, None)
