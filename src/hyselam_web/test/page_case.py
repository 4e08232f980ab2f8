"""What tests of the page in a real browser share: a robot that is none behind the server, a browser, fingers and eyes. No test; others import it."""
import os
import sys
import unittest

sys.dont_write_bytecode = True
from devtools import Browser, DESKTOP, STILL, program
from fake_robot import FakeRobot, ServedRobot, wait_until

# Notices go by themselves: the page keeps what each of them said.
NOTICES = """globalThis.notices = []; addEventListener('DOMContentLoaded', () => { const box = document.querySelector('#toast');
    new MutationObserver(() => { if (!box.hidden && box.textContent) notices.push(box.textContent); }).observe(box, {childList: true, attributes: true, attributeFilter: ['hidden']}); });"""
SHOTS = os.environ.get("HYSELAM_SHOTS", "")  # a folder for pictures of what is seen


@unittest.skipUnless(program(), "Chromium is not installed (scripts/deps)")
class PageCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def serve(self, **more):
        self.robot = FakeRobot()
        self.served = ServedRobot(self.robot, **more)
        self.addCleanup(lambda: self.served.close())

    def open(self, size=DESKTOP, path="/", script="", **more):
        tab = self.browser.tab(size, **more)
        self.addCleanup(tab.close)
        tab.send("Page.addScriptToEvaluateOnNewDocument", source=NOTICES + script)
        tab.goto(self.served.address + path)
        return tab

    def open_map(self, size=DESKTOP, **more):
        tab = self.open(size, **more)
        tab.wait("window.hyselam && hyselam.map.drawnTiles > 0 && hyselam.map.labels > 3", "the map")
        return tab

    def at(self, tab, x, y):
        """Where a point of the map is on the screen, once the map lies still."""
        return tab.wait(STILL % f"() => {{ const p = hyselam.map.toScreen({x}, {y}), b = hyselam.map.canvas.getBoundingClientRect(); return [p[0] + b.x, p[1] + b.y]; }}", "that the map lies still")

    def drawn(self, tab):
        """Until what the map was told last is drawn."""
        tab.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def tap_place(self, tab, place):
        tab.press(*self.at(tab, *tab.eval(f"hyselam.model.place({place}).c")))

    def notice(self, tab, text):
        """A notice that says it, since the last one that was waited for; it may have gone meanwhile."""
        tab.wait(f"""(() => {{ const at = notices.findIndex((each) => each.includes({text!r})); return at < 0 ? false : notices.splice(0, at + 1).length > 0; }})()""",
                 lambda: f"the notice '{text}' (there were {tab.eval('notices')})")

    def say(self, tab, text):
        tab.click("#say")
        tab.type(text)
        tab.key("Enter")

    def asked(self, what):
        """But for the language of the page, which comes with all but a way."""
        return [{key: value for key, value in fields.items() if key != "language" or what == "go"} for name, fields, _ in self.robot.asked if name == what]

    def stop(self, tab):
        """A page that gets no answer at once says it a second time: that is no mistake."""
        before = self.robot.stops
        tab.click("#stop")
        wait_until(lambda: self.robot.stops > before, "stop")

    def shot(self, tab, name):
        if SHOTS:
            tab.picture(os.path.join(SHOTS, name + ".png"))
