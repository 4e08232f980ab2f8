"""What tests of the page in a real browser share: a robot that is none behind the server, a browser, fingers and eyes. No test; others import it."""
import os
import sys
import unittest

sys.dont_write_bytecode = True
from devtools import Browser, DESKTOP, program
from fake_robot import FakeRobot, ServedRobot

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

    def open(self, size=DESKTOP, path="/", **more):
        tab = self.browser.tab(size, **more)
        self.addCleanup(tab.close)
        tab.goto(self.served.address + path)
        return tab

    def open_map(self, size=DESKTOP, **more):
        tab = self.open(size, **more)
        tab.wait("window.hyselam && hyselam.map.drawnTiles > 0 && hyselam.map.labels > 3", "the map")
        return tab

    def at(self, tab, x, y):
        """Where a point of the map is on the screen."""
        return tab.eval(f"(() => {{ const p = hyselam.map.toScreen({x}, {y}), b = hyselam.map.canvas.getBoundingClientRect(); return [p[0] + b.x, p[1] + b.y]; }})()")

    def say(self, tab, text):
        tab.click("#say")
        tab.type(text)
        tab.key("Enter")

    def asked(self, what):
        """But for the language of the page, which comes with all but a way."""
        return [{key: value for key, value in fields.items() if key != "language" or what == "go"} for name, fields, _ in self.robot.asked if name == what]

    def shot(self, tab, name):
        if SHOTS:
            tab.picture(os.path.join(SHOTS, name + ".png"))
