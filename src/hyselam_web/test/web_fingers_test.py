#!/usr/bin/env python3
"""What the robot would be set going by is never under a finger that meant something else: a second tap at once, a button that comes or moves."""
import sys
import time

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import wait_until
from hyselam_web import sights
from page_case import PageCase

BOX = "((e) => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })"
# What can be pressed on the card, but for what sets the robot going; and that.
# (what has been scrolled under the lowest rows is covered by them)
OTHERS = f"""(() => {{ const foot = document.querySelector('#card .foot'), low = foot ? foot.getBoundingClientRect().top : Infinity;
    return [...document.querySelectorAll('#card button:not([data-key=go_there]), #card summary, #card input')].map((e) => {{
        const b = {BOX}(e); if (foot && !foot.contains(e)) b[3] = Math.min(b[3], low); return [e.dataset.key ?? e.textContent, b]; }}).filter(([, b]) => b[1] < b[3]); }})()"""
DRIVES = f"[...document.querySelectorAll('#card [data-key=go_there]')].map({BOX})"


def meet(a, b):
    return a[0] < b[2] and a[2] > b[0] and a[1] < b[3] and a[3] > b[1]


class FingersTest(PageCase):
    def card(self, tab, place):
        self.tap_place(tab, place)
        tab.wait(f"!document.querySelector('#card').hidden && hyselam.map.selected === '{place}'", f"the card of place {place}")

    def press_twice(self, tab, x, y, pause=0.0):
        tab.press(x, y)
        time.sleep(pause)
        tab.press(x, y, double=True)

    def test_a_second_tap_at_once_never_drives(self):
        for size in (PHONE, DESKTOP):
            for pause in (0.0, 0.15, 0.4):
                self.serve()
                self.robot.names[1] = [("kitchen", False)]
                self.robot.show_places()
                tab = self.open_map(size)
                self.card(tab, 1)
                self.press_twice(tab, *tab.middle("#card [data-key=right_name]"), pause)
                wait_until(lambda: self.asked("name"), "the name")
                tab.wait("document.querySelector('#card').hidden", "that the card is done with")
                self.drawn(tab)
                self.assertEqual((self.asked("name"), self.asked("go"), self.asked("say")), ([{"place": 1, "names": ["kitchen"]}], [], []))
                # Two taps on the map, the second of them on the card that the first has opened.
                self.robot.asked.clear()
                lowest = tab.eval("Object.keys(hyselam.model.tables.places).reduce((a, b) => hyselam.model.place(a).c[1] < hyselam.model.place(b).c[1] ? a : b)")
                x, y = self.at(tab, *tab.eval(f"hyselam.model.place({lowest}).c"))
                self.press_twice(tab, x, y, pause)
                tab.wait("!document.querySelector('#card').hidden", "the card")
                self.drawn(tab)
                self.assertEqual([name for name, *_ in self.robot.asked if name not in ("try",)], [])
                self.assertEqual(tab.errors, [])

    def test_what_sets_it_going_shares_no_spot_with_anything_else_on_a_card(self):
        for size in (PHONE, (390, 844, True), DESKTOP):
            for language in ("en-US", "pt-PT"):
                self.serve()
                self.robot.names.update({1: [("kitchen", False)], 2: [("Maria Albertina's office of the second floor", True)], 3: [("library", True)]})
                self.robot.show_places()
                tab = self.open_map(size, language=language)
                drives, others = [], []

                def collect(state):
                    self.drawn(tab)
                    drives.extend(tab.eval(DRIVES))
                    others.extend((state, key, box) for key, box in tab.eval(OTHERS))
                for place in (1, 2, 3, 4, 11):
                    self.card(tab, place)
                    collect(f"card of {place}")
                    if tab.eval("document.querySelector('#card summary') !== null"):
                        tab.click("#card summary")
                        tab.wait("document.querySelector('#card details').open", "the doors")
                        collect(f"doors of {place}")
                    tab.click("#card [data-key=here_you_are]")
                    tab.wait("document.querySelector('#card [data-key=sure]')", "the question")
                    collect(f"sure of {place}")
                    tab.click("#card [data-key=unsure]")
                    tab.click("#card [data-key=name_it], #card [data-key=rename_it], #card [data-key=wrong_name]")
                    tab.wait("document.querySelector('#new-name')", "the form")
                    collect(f"naming of {place}")
                    tab.click("#card .close")
                self.assertEqual(tab.errors, [])
                self.assertGreaterEqual(len(drives), 5)
                shared = [(state, key) for state, key, box in others for drive in drives if meet(box, drive)]
                self.assertEqual(shared, [], (size, language))
                # It is always at the same spot.
                self.assertLessEqual(max(abs(a - b) for drive in drives for a, b in zip(drive[:2], drives[0][:2])), 1.0)

    def test_what_sets_it_going_is_dead_for_a_moment_after_it_appears(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.eval("(hyselam.places.show('place', 1), document.querySelector('#card [data-key=go_there]').click())")
        tab.wait("document.querySelector('#card [data-key=go_there]:not(.settling)')", "that it can be pressed")
        self.assertEqual(self.asked("go"), [])
        # It stays so where the card is made again, as when something is told of the place.
        tab.eval("new Promise((done) => setTimeout(done, 800))")
        self.robot.names[1] = [("kitchen", False)]
        self.robot.show_places()
        tab.wait("document.querySelector('#card-title').textContent === 'kitchen?'", "the name")
        tab.eval("document.querySelector('#card [data-key=go_there]').click()")
        wait_until(lambda: self.asked("go"), "the way")
        self.assertEqual(self.asked("go"), [{"place": 1, "language": "en"}])

    def test_a_yes_is_dead_for_a_moment_and_is_moved_by_nothing_that_comes_later(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.robot.later(lambda: self.robot.world.set("asked", sights.question("Shall I go to SS12, perhaps the library?", 11, True)))
        tab.wait("!document.querySelector('#answers').hidden", "yes and no")
        tab.eval("document.querySelector('#yes').click()")
        tab.wait("document.querySelector('#yes:not(.settling)')", "that it can be pressed")
        self.assertEqual(self.asked("say"), [])
        before = tab.eval(f"{BOX}(document.querySelector('#yes'))")

        def slip():
            self.robot.say("human", "Where is the kichen?")
            self.robot.say("robot", "I know of no kichen.")
            self.robot.world.set("asked", sights.question("Shall I go to SS12, perhaps the library?", 11, True))
        self.robot.later(slip)
        tab.wait("document.querySelector('#chips .offered')?.textContent === 'Did you mean: Where is the kitchen?'", "what was meant")
        self.drawn(tab)
        self.assertEqual(tab.eval(f"{BOX}(document.querySelector('#yes'))"), before)
        self.shot(tab, "fingers_offered")
        # Another question: its yes is another one.
        self.robot.later(lambda: self.robot.world.set("asked", sights.question("Shall I go to SS05, perhaps the archive?", 5, True)))
        tab.wait("document.querySelector('#question').textContent.includes('archive')", "the other question")
        tab.eval("document.querySelector('#yes').click()")
        tab.wait("document.querySelector('#yes:not(.settling)')", "that it can be pressed")
        self.assertEqual(self.asked("say"), [])
        tab.click("#chips .offered")
        wait_until(lambda: self.asked("say"), "what was meant")
        self.assertEqual(self.asked("say"), [{"text": "Where is the kitchen?"}])
        self.assertEqual(tab.errors, [])

    def test_stop_is_pressed_as_often_as_somebody_likes(self):
        self.serve()
        tab = self.open_map(PHONE)
        at = tab.middle("#stop")
        self.press_twice(tab, *at)
        wait_until(lambda: self.robot.stops >= 2, "both")
        tab.press(at[0], at[1] - 60)  # near it, and at once it
        tab.press(*at, double=True)
        wait_until(lambda: self.robot.stops >= 3, "the third")


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_fingers_test", FingersTest)
