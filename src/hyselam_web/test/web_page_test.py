#!/usr/bin/env python3
"""The page in a real browser, with a robot that is none: what is seen, said and pressed on a phone and on a desktop, by fingers, mouse and
keys. The whole stack behind it: web_stack.test of hyselam_bringup."""
import json
import os
import pathlib
import sys
import tempfile
import time

import numpy as np

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import PACKAGE, RESOLUTION, ServedRobot, free_port, wait_until
from hyselam_web import recording, sights
from page_case import PageCase

EVIL = ["<img src=x onerror=\"window.evil=1\">", "</script><script>window.evil=1</script>", "\"><svg onload=window.evil=1>", "javascript:window.evil=1",
        "{{constructor.constructor('window.evil=1')()}}", "' onfocus=window.evil=1 autofocus='"]


class PageTest(PageCase):
    def test_a_person_with_a_phone_describes_names_and_sends(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.assertLessEqual(tab.eval("document.documentElement.scrollWidth"), 360)
        self.say(tab, "On your left you have the kitchen.")
        tab.wait("document.querySelectorAll('.said.robot').length === 1", "the answer")
        self.assertIn("Noted:", tab.eval("document.querySelector('.said.robot').textContent"))
        # A name lands, as a guess; the person confirms it on the map.
        self.robot.names[1] = [("kitchen", False)]
        self.robot.later(self.robot.show_places)
        tab.wait("hyselam.model.labelOf(1) === 'kitchen?'", "the name")
        tab.press(*self.at(tab, 2.4, 3.3))
        tab.wait("document.querySelector('#card-title')?.textContent === 'kitchen?'", "the card")
        self.assertEqual(len(self.asked("say")), 1)  # the tap pressed nothing below the card
        tab.click("#card button.primary")
        wait_until(lambda: self.asked("name"), "the name")
        self.assertEqual(self.asked("name"), [{"place": 1, "names": ["kitchen"]}])
        tab.wait("document.querySelector('#card').hidden && hyselam.model.labelOf(1) === 'kitchen'", "the confirmed name")
        self.tap_place(tab, 1)
        tab.wait("document.querySelector('#card-title')?.textContent === 'kitchen'", "the card")
        self.shot(tab, "phone_card")
        tab.click("#card [data-key=go_there]")
        wait_until(lambda: self.asked("go"), "the way")
        self.assertEqual(self.asked("go"), [{"place": 1, "language": "en"}])
        self.robot.later(lambda: self.robot.world.set("way", [[10, 8], [4, 8], [4, 4]]))
        tab.wait("document.querySelector('#where').textContent.includes('on its way')", "the way")
        # Undo takes back what was said.
        tab.click("#talk-log .undo")
        wait_until(lambda: {"text": "Undo that."} in self.asked("say"), "undo")
        self.stop(tab)
        tab.wait("document.querySelector('#toast').textContent === 'Stop was sent.'", "that it was sent")
        self.robot.hearers = 0
        tab.click("#stop")
        tab.wait("document.querySelector('#toast').textContent.includes('NOBODY HEARS IT')", "that nobody hears it")
        self.assertEqual(tab.errors, [])

    def test_a_folded_panel_covers_neither_the_tabs_nor_stop(self):
        self.serve()
        tab = self.open_map(PHONE)
        for line in range(12):
            self.robot.say("robot", f"I have said {line} things.")
        for name in ("talk", "places", "robot", "back"):
            tab.click(f"#tab-{name}")
            if not tab.eval("document.body.classList.contains('folded')"):
                tab.click(f"#tab-{name}")
            tab.wait("document.body.classList.contains('folded')", f"the folded panel of {name}")
            on_top = """((wanted) => { const box = wanted.getBoundingClientRect(); return [0.1, 0.5, 0.9].every((share) =>
                wanted.contains(document.elementFromPoint(box.x + box.width / 2, box.y + share * box.height))); })(document.querySelector('%s'))"""
            for button in ("#stop", "#tab-talk", "#tab-places", "#tab-robot", "#tab-back"):
                self.assertTrue(tab.eval(on_top % button), f"{button} under the folded panel of {name}")
            self.stop(tab)
        self.assertEqual(tab.errors, [])

    def test_the_newest_line_stays_in_sight_while_places_are_tapped(self):
        self.serve()
        tab = self.open_map(PHONE)
        for line in range(30):
            self.robot.say("robot", f"I have said {line} things.")
        at_end = "((log) => log.scrollTop > 0 && log.scrollHeight - log.scrollTop - log.clientHeight < 60)(document.querySelector('#talk-log'))"
        tab.wait("document.querySelectorAll('.said.robot').length >= 30", "the talk")
        tab.wait(at_end, "the newest line")
        self.robot.names[1] = [("kitchen", False)]
        self.robot.later(self.robot.show_places)
        tab.wait("hyselam.model.labelOf(1) === 'kitchen?'", "the name")
        tab.press(*self.at(tab, 2.4, 3.3))
        tab.wait("!document.querySelector('#card').hidden", "the card")
        tab.wait(at_end, "the newest line beside the card")
        tab.click("#card button.primary")
        wait_until(lambda: self.asked("name"), "the name")
        self.robot.say("robot", "Thank you. SS01 is kitchen.")
        tab.wait("document.querySelectorAll('.said.robot').length >= 31", "the answer")
        tab.wait(at_end, "the answer in sight")
        self.assertTrue(tab.eval("document.querySelector('#card').hidden"))
        self.assertEqual(tab.errors, [])

    def test_a_question_is_answered_by_a_button_and_marked_on_the_map(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.robot.later(lambda: self.robot.say("robot", "Is SS12 John's office?"))
        tab.wait("!document.querySelector('#answers').hidden", "yes and no")
        self.assertEqual(tab.eval("hyselam.model.values.asked.place"), 12)
        self.shot(tab, "phone_question")
        tab.click("#yes")
        wait_until(lambda: self.asked("say"), "the answer")
        self.assertEqual(self.asked("say"), [{"text": "Yes."}])
        self.robot.later(lambda: self.robot.say("robot", "What is the name of this place?"))
        tab.wait("document.querySelector('#answers').hidden && document.querySelector('#say').placeholder === 'Your answer…'", "a line for the answer")

    def test_a_place_is_named_by_tapping_and_typing(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.press(*self.at(tab, 17.9, 3.4))
        tab.wait("document.querySelector('#card-title')?.textContent === 'Place 5'", "the card")
        tab.click("#card [data-key=name_it]")
        tab.type("libr")
        tab.click("#language")
        tab.wait("document.documentElement.lang === 'pt' && document.querySelector('#new-name').value === 'libr'", "what was typed")
        tab.click("#new-name")
        tab.key("End")
        tab.type("ary")
        tab.key("Enter")
        tab.wait("document.querySelector('#card').hidden && hyselam.model.labelOf(5) === 'library'", "the name")
        wait_until(lambda: self.asked("name"), "that it is named")
        self.assertEqual(self.asked("name"), [{"place": 5, "names": ["library"]}])
        self.assertEqual(tab.eval("document.activeElement.tagName"), "BODY")  # the next Enter opens no card

    def test_what_is_said_is_no_name_until_that_was_asked_about(self):
        self.serve()
        tab = self.open_map(PHONE)
        for said in ("Where are you?", "take me to the kitchen"):
            self.tap_place(tab, 5)
            tab.wait("document.querySelector('#card-title')?.textContent === 'Place 5'", "the card")
            tab.click("#card [data-key=name_it]")
            tab.type(said)
            tab.key("Enter")
            tab.wait(f"document.querySelector('#card p')?.textContent.includes('“{said}” looks like something to say')", "the question")
            self.shot(tab, "phone_name_doubted")
            tab.key("Enter")  # one too many
            tab.wait("document.querySelector('#card [data-key=name_it]')", "the card as it was")
        self.assertEqual(self.asked("name"), [])
        tab.click("#card [data-key=name_it]")
        tab.type("room of Ana and Rui")
        tab.key("Enter")
        tab.wait("document.querySelector('#card [data-key=sure]')", "the question")
        tab.click("#card [data-key=sure]")
        wait_until(lambda: self.asked("name"), "that it is named")
        self.assertEqual(self.asked("name"), [{"place": 5, "names": ["room of Ana and Rui"]}])

    def test_what_was_said_before_is_not_made_anew_for_screen_readers(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.say(tab, "Hello.")
        tab.wait("document.querySelectorAll('.said').length === 2 && !document.querySelector('.said.waits')", "the answer")
        tab.eval("window.before = [...document.querySelectorAll('.said')]")
        self.say(tab, "Hello again.")
        tab.wait("document.querySelectorAll('.said').length === 4 && !document.querySelector('.said.waits')", "the second answer")
        self.assertTrue(tab.eval("before.every((e, i) => document.querySelectorAll('.said')[i] === e)"))
        texts = tab.eval("[...document.querySelectorAll('.said')].map(e => e.textContent)")
        self.assertEqual(texts, ["Hello.", "Noted: Hello.", "Hello again.", "Noted: Hello again."])
        self.assertEqual(tab.errors, [])

    def test_what_one_page_began_to_learn_another_can_end(self):
        self.serve()
        self.robot.world.set_table("layers", {"semantic_localization": {"level": "ok", "what": "", "text": ""}})
        pages = [self.open_map(DESKTOP) for _ in range(2)]
        for tab in pages:
            tab.click("#tab-robot")
            tab.wait("document.querySelector('#do-learn')", "the button")
        pages[0].click("#do-learn")
        for tab in pages:
            tab.wait("document.querySelector('#do-unlearn') && !document.querySelector('#do-learn')", "that it learns")
        pages[1].click("#do-unlearn")
        for tab in pages:
            tab.wait("document.querySelector('#do-learn') && !document.querySelector('#do-unlearn')", "that it does not")
        self.assertEqual(self.asked("learn"), [{"on": True}, {"on": False}])

    def test_keys_alone_are_enough(self):
        self.serve()
        tab = self.open_map(DESKTOP)
        tab.eval("document.querySelector('#map').focus()")
        tab.key("r")
        self.drawn(tab)
        tab.key("Enter")
        tab.wait("document.querySelector('#card-title')?.textContent === 'Place 11'", "the card of the place in the middle")
        self.assertTrue(tab.eval("document.querySelector('#card').contains(document.activeElement)"))
        tab.key("Escape")
        tab.wait("document.querySelector('#card').hidden", "the map again")
        tab.eval("document.querySelector('#tab-talk').focus()")
        tab.key("ArrowRight")
        tab.wait("!document.querySelector('#panel-places').hidden", "the list of places")
        tab.wait("document.querySelectorAll('#panel-places ul.list:first-of-type li button').length === 21", "all places")
        tab.eval("document.querySelector('#panel-places li button').focus()")
        tab.key("Enter")
        tab.wait("!document.querySelector('#card').hidden", "the card")

    def test_everything_has_a_name_for_screen_readers_and_enough_contrast(self):
        self.serve()
        for dark in (False, True):
            tab = self.open_map(PHONE, dark=dark)
            self.robot.later(lambda: self.robot.say("robot", "Is SS12 John's office?"))
            tab.wait("!document.querySelector('#answers').hidden", "yes and no")
            tab.press(*self.at(tab, 2.4, 3.3))
            tab.wait("!document.querySelector('#card').hidden", "the card")
            nameless = tab.eval("[...document.querySelectorAll('button, input, select, [role=tab], canvas')].filter(e => !(e.getAttribute('aria-label') || "
                                "e.textContent.trim() || (e.labels && e.labels.length))).map(e => e.outerHTML)")
            self.assertEqual(nameless, [])
            small = tab.eval("[...document.querySelectorAll('button')].filter(e => e.offsetParent && (e.offsetHeight < 36 || e.offsetWidth < 36)).map(e => e.outerHTML)")
            self.assertEqual(small, [])
            # WCAG 2.1, contrast of texts with what is behind them: at least 4.5.
            poor = tab.eval("""(() => {
              const rgb = (text) => { const v = text.match(/[\\d.]+/g).map(Number); return v.length > 3 && v[3] < 0.99 ? null : v; };
              const light = (c) => { const [r, g, b] = c.map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
              const behind = (e) => { for (; e; e = e.parentElement) { const c = rgb(getComputedStyle(e).backgroundColor); if (c) return c; } return [255, 255, 255]; };
              return [...document.querySelectorAll('body *')].filter((e) => e.offsetParent && [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim())).map((e) => {
                const [a, b] = [light(rgb(getComputedStyle(e).color) ?? [0, 0, 0]), light(behind(e))];
                return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e.textContent.trim().slice(0, 30)]; }).filter(([ratio]) => ratio < 4.5); })()""")
            self.assertEqual(poor, [], f"dark: {dark}")
            self.shot(tab, f"contrast_{'dark' if dark else 'light'}")

    def test_portuguese_and_back(self):
        self.serve()
        tab = self.open_map(PHONE, language="pt-BR")
        self.assertEqual(tab.eval("document.documentElement.lang"), "pt")
        self.assertEqual(tab.eval("document.querySelector('#stop').textContent"), "PARAR")
        self.assertEqual(tab.eval("hyselam.missingTexts()"), [])
        tab.press(*self.at(tab, 2.4, 3.3))
        tab.click("#card [data-key=go_there]")
        wait_until(lambda: self.asked("go"), "the way")
        self.assertEqual(self.asked("go"), [{"place": 1, "language": "pt"}])
        self.shot(tab, "phone_portuguese")
        tab.click("#language")
        tab.wait("document.querySelector('#stop').textContent === 'STOP'", "English")

    def test_scripts_in_names_talk_and_things_stay_text(self):
        self.serve()
        for i, evil in enumerate(EVIL):
            self.robot.names[i + 1] = [(evil, i % 2 == 0)]
        self.robot.show_places()
        world = self.robot.world
        world.set("names", EVIL)
        world.set("here", {"place": 1, "name": EVIL[0], "sure": True, "door": False})
        world.set("status", {"phase": "lost", "text": EVIL[1], "q": None})
        world.set("camera", {"name": EVIL[2], "place": 1, "p": 0.5, "seen": True, "top": [[e, 0.5] for e in EVIL[:3]]})
        world.set("refused", EVIL[0])
        world.set_table("objects", {"1": {"k": EVIL[0], "p": EVIL, "c": [2.0, 2.0], "at": [EVIL[1], EVIL[2]]}})
        world.set_table("layers", {EVIL[0]: {"level": "error", "what": EVIL[1], "text": EVIL[2]}})
        for evil in EVIL:
            self.robot.say("human", evil)
            self.robot.say("robot", evil + "?")
        self.robot.answer = lambda name, *_: {"findings": [{"level": "WRONG", "name": EVIL[0], "text": EVIL[1], "hint": EVIL[2]}]} if name == "doctor" else {"message": EVIL[0]}
        tab = self.open_map(PHONE)
        tab.press(*self.at(tab, 2.4, 3.3))
        tab.wait("!document.querySelector('#card').hidden", "the card")
        tab.click("#card [data-key=ask_about]")
        wait_until(lambda: self.asked("say"), "the question")
        self.assertEqual(self.asked("say"), [{"text": "What is next to SS01?"}])  # names are never put into what is said
        self.say(tab, EVIL[0])
        for name in ("places", "robot", "talk"):
            tab.click(f"#tab-{name}")
            tab.wait(f"!document.querySelector('#panel-{name}').hidden", name)
            if name == "robot":
                tab.click("#do-check")
                tab.wait(f"document.querySelector('#panel-robot').textContent.includes({EVIL[1]!r})", "the findings")
        tab.wait("document.querySelector('#talk-log').textContent.includes('onerror')", "the talk")
        self.assertIsNone(tab.eval("window.evil ?? null"))
        self.assertEqual(tab.eval("document.querySelectorAll('img, script:not([src]), #panel svg[onload]').length"), 0)
        self.assertEqual([e for e in tab.errors if "Content Security Policy" in e], [])

    def test_login_and_stop_before_it(self):
        self.serve(tokens="look=lookatme1 drive=driveme11")
        tab = self.open(PHONE)
        tab.wait("!document.querySelector('#login').hidden", "the login")
        self.assertEqual(tab.eval("document.querySelector('#map-empty').innerText"), "Log in to see the map.")
        tab.click("#language")
        tab.wait("document.querySelector('#map-empty').innerText === 'Introduza a senha para ver o mapa.'", "the other language")
        tab.click("#language")
        self.stop(tab)
        tab.click("#token")
        tab.type("something")
        tab.key("Enter")
        tab.wait("document.querySelector('#login-error').textContent", "the refusal")
        self.shot(tab, "phone_login")
        tab.eval("document.querySelector('#token').value = ''")
        tab.click("#token")
        tab.type("lookatme1")
        tab.key("Enter")
        tab.wait("document.querySelector('#login').hidden && hyselam.map.labels > 3", "the map")
        self.assertTrue(tab.eval("document.querySelector('#say-form').hidden"))
        tab.press(*self.at(tab, 2.4, 3.3))
        tab.wait("!document.querySelector('#card').hidden", "the card")
        self.assertEqual(tab.eval("document.querySelectorAll('#card button').length"), 1)  # nothing to do but close it
        self.assertEqual([e for e in tab.errors if "403" not in e], [])

    def test_a_lost_server_is_shown_and_found_again_and_nothing_is_lost(self):
        port = free_port()
        self.serve(port=port)
        tab = self.open_map(PHONE)
        self.served.close()
        tab.wait("!document.querySelector('#lost').hidden", "that the connection is lost")
        self.shot(tab, "phone_lost")
        self.say(tab, "Is anybody there?")
        tab.wait("document.querySelector('.said.failed')", "that it was not sent")
        self.assertEqual(tab.eval("document.querySelector('#say').value"), "Is anybody there?")
        tab.click("#stop")
        tab.wait("document.querySelector('#toast').textContent.includes('NOT SENT')", "that stop was not sent")
        self.robot.names[1] = [("kitchen", True)]
        self.robot.show_places()
        self.robot.say("human", "Said meanwhile.")
        self.served = ServedRobot(self.robot, port=port)
        tab.wait("document.querySelector('#lost').hidden && hyselam.model.labelOf(1) === 'kitchen'", "the server again")
        tab.wait("document.querySelector('#talk-log').textContent.includes('Said meanwhile.')", "what was said meanwhile")
        tab.click("#send")
        wait_until(lambda: self.asked("say") == [{"text": "Is anybody there?"}], "what was typed before")

    def test_the_map_cannot_be_dragged_out_of_sight(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.eval("hyselam.map.zoom(4)")
        for _ in range(12):
            tab.drag((40, 150), (330, 400))
        x, y = tab.eval("hyselam.map.center")
        left, low, right, high = tab.eval("hyselam.map.bounds()")
        corners = tab.eval("hyselam.map.mapCorners()")
        self.assertGreaterEqual(x, min([left] + [c[0] for c in corners]) - 0.01)
        self.assertLessEqual(y, max([high] + [c[1] for c in corners]) + 0.01)
        self.assertLess(x, right)

    def test_pose_and_glass_wall_are_drawn_by_finger_and_by_keys(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.click("#tab-robot")
        tab.click("#do-set_pose")
        tab.wait("hyselam.map.tool?.kind === 'pose'", "the tool")
        tab.drag(self.at(tab, 10.0, 8.0), self.at(tab, 14.0, 8.0))
        wait_until(lambda: self.asked("pose"), "the pose")
        pose = self.asked("pose")[0]
        self.assertLess(abs(pose["x"] - 10) + abs(pose["y"] - 8) + abs(pose["yaw"]), 0.3)
        tab.wait("document.querySelector('#tool-bar').hidden", "the end of the tool")
        tab = self.open_map(DESKTOP)
        tab.click("#tab-robot")
        tab.click("#do-draw_wall")
        tab.wait("document.activeElement.id === 'map'", "the map")
        tab.key("r")
        tab.key("Enter")
        tab.key("ArrowRight")
        tab.key("Enter")
        wait_until(lambda: self.asked("wall"), "the wall")
        wall = self.asked("wall")[0]
        self.assertGreater(wall["bx"], wall["ax"] + 0.5)

    def test_completion_by_tab_and_by_chips(self):
        self.serve()
        self.robot.world.set("names", ["kitchen", "meeting room"])
        tab = self.open_map(DESKTOP)
        tab.click("#say")
        tab.type("Where is the mee")
        tab.wait("document.querySelector('#chips button')?.textContent === 'meeting room'", "the suggestion")
        tab.key("Tab")
        self.assertEqual(tab.eval("document.querySelector('#say').value"), "Where is the meeting room")
        tab.key("Tab")
        self.assertNotEqual(tab.eval("document.activeElement.id"), "say")  # nothing to complete: on to the next

    def test_a_large_map_is_seen_soon(self):
        self.serve()
        rng = np.random.default_rng(3)
        grid = np.full((4000, 4000), -1, np.int8)
        grid[200:3800, 200:3800] = 0
        for _ in range(3000):
            x, y, w, h = rng.integers(200, 3700, 2).tolist() + rng.integers(1, 90, 2).tolist()
            grid[y:y + h, x:x + w] = 100
        self.robot.show_map(grid, RESOLUTION, (-100.0, -100.0, 0.0))
        tab = self.browser.tab(DESKTOP)
        self.addCleanup(tab.close)
        tab.goto(self.served.address)
        count = len([1 for _, p in self.robot.tiles.tiles.values() if p])
        tab.wait(f"window.hyselam && hyselam.map.drawnTiles === {count}", "all tiles")
        seen, fine = tab.eval("[hyselam.map.seen, hyselam.map.fine]")
        print(f"4000 x 4000 cells after the address was given: all of it coarsely in {seen / 1000:.2f} s, all {count} tiles in {fine / 1000:.2f} s")
        self.assertLess(tab.eval("hyselam.map.tiles.before"), count / 4)  # the coarse picture came first
        self.assertLessEqual(seen, fine)
        self.assertTrue(tab.eval("hyselam.model.complete && hyselam.model.overview === null"))

    def test_a_recorded_day_is_played_from_the_server_and_from_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "day.jsonl")
            recorder = recording.Recorder(path)
            self.serve(recorder=recorder)
            self.addCleanup(recorder.close)
            robot = self.robot
            wait_until(lambda: os.path.getsize(path) > 5000, "the first entry")

            def later(seconds, x):
                robot.time = seconds
                robot.world.set("pose", sights.pose(x, 8.0, 0.0))
            robot.later(lambda: robot.say("human", "Good morning."))
            for n in range(1, 60):
                robot.later(lambda n=n: later(float(n), 10.0 + 0.2 * n))
                if n == 30:
                    robot.names[1] = [("kitchen", True)]
                    robot.later(robot.show_places)
            wait_until(lambda: '"t":59' in pathlib.Path(path).read_text(), "the last entry")
            page = os.path.join(folder, "index.html")
            recording.write_static(path, str(PACKAGE / "www"), page)
            live = self.open(PHONE, "/?replay")
            static = self.browser.tab(DESKTOP)
            self.addCleanup(static.close)
            static.goto("file://" + page)
            for tab in (live, static):
                tab.wait("window.hyselam?.replayer && hyselam.map.drawnTiles > 0", "the recording")
                tab.eval("hyselam.replayer.play(false)")
                for seconds, x, name in ((59, 21.8, "kitchen"), (10, 12.0, "place 1"), (40, 18.0, "kitchen"), (0, 10.0, "place 1")):
                    tab.eval(f"(() => {{ const s = document.querySelector('#time'); s.value = {seconds}; s.dispatchEvent(new Event('input')); }})()")
                    tab.wait(f"Math.abs(hyselam.model.values.pose.x - {x}) < 0.11 && hyselam.model.labelOf(1) === '{name}'", f"second {seconds}")
                    tab.wait("hyselam.map.drawnTiles > 0", "the map")
                self.assertEqual(tab.errors, [])
                self.assertEqual(tab.eval("getComputedStyle(document.querySelector('#say-form')).display"), "none")
                self.expect_a_usable_player(tab)
            self.assertEqual([tab.eval("document.querySelector('#tab-back').checkVisibility()") for tab in (live, static)], [True, False])
            self.assertFalse(static.eval("document.querySelector('#stop').checkVisibility()"))
            self.stop(live)
            live.wait("document.querySelector('#toast').textContent.startsWith('Stop was sent to the real robot.')", "that it was sent")
            self.shot(live, "phone_replay")

    def expect_a_usable_player(self, tab):
        """A slider as wide as its foot, at its end with the recording, and a button that tells what it does."""
        tab.eval("hyselam.replayer.goTo(hyselam.replayer.end)")
        of_foot, edge, value, most, clock, label = tab.eval("""(() => { const slider = document.querySelector('#time'), style = getComputedStyle(slider);
            return [slider.offsetWidth / document.querySelector('footer').clientWidth, parseFloat(style.paddingRight) + parseFloat(style.borderRightWidth),
                slider.value, slider.max, document.querySelector('#clock').textContent, document.querySelector('#play').getAttribute('aria-label')]; })()""")
        self.assertGreater(of_foot, 0.9)
        self.assertEqual((edge, value, clock, label), (0, most, "0:59 / 0:59", "Play"))

    def test_a_recorded_map_that_comes_after_the_robot_is_seen_whole_unless_the_view_was_moved(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "day.jsonl")
            recorder = recording.Recorder(path)
            self.serve(recorder=recorder)
            wait_until(lambda: os.path.getsize(path) > 5000, "the first entry")
            recorder.close()
            (first, *_), page = recording.read(path), os.path.join(folder, "index.html")
            late = dict(first, t=first["t"] + 9)
            early = {"t": first["t"], "d": {"pose": first["d"]["pose"]}}
            pathlib.Path(path).write_text("\n".join(map(json.dumps, (recording.FORMAT, early, late))) + "\n")
            recording.write_static(path, str(PACKAGE / "www"), page)
            for moved in (False, True):
                tab = self.browser.tab(PHONE)
                self.addCleanup(tab.close)
                tab.goto("file://" + page)
                tab.wait("window.hyselam?.replayer && hyselam.map.fitted", "the robot")
                tab.eval("hyselam.replayer.play(false); hyselam.replayer.goTo(hyselam.replayer.begin)")
                near = tab.eval("hyselam.map.scale")
                if moved:
                    tab.click("#zoom-in")
                tab.eval("hyselam.replayer.goTo(hyselam.replayer.end)")
                tab.wait("hyselam.map.drawnTiles > 0", "the map")
                if moved:
                    self.assertGreater(tab.eval("hyselam.map.scale"), near)
                else:
                    self.assertLess(tab.eval("hyselam.map.scale"), near)
                    self.assertTrue(tab.eval("""(() => { const {map} = hyselam, [a, b, c, d] = map.bounds(), [x, y] = map.toScreen(a, d), [u, v] = map.toScreen(c, b);
                        return x >= 0 && y >= 0 && u <= map.canvas.clientWidth && v <= map.canvas.clientHeight; })()"""))


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_page_test", PageTest)
