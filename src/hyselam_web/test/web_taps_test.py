#!/usr/bin/env python3
"""What is done by tapping can be taken back by tapping, is asked about where it takes something away, and is answered in the language of the
page; what is shown says whether it is now; names lie in their rooms."""
import os
import sys
import tempfile

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import wait_until
from hyselam_web import recording, sights
from page_case import PageCase

# A browser whose microphone says what the test wants.
MICROPHONE = """globalThis.SpeechRecognition = class { start() { globalThis.recognition = this; } stop() { this.onend(); } };
    globalThis.hear = (text) => { recognition.onresult({results: [Object.assign([{transcript: text}], {isFinal: true})]}); recognition.onend(); };
    globalThis.refuse = (why) => { recognition.onerror({error: why}); recognition.onend(); };"""
BOXES = "Object.fromEntries([...hyselam.map.names.shown].map(([id, s]) => [id, s.box.map((v) => Math.round(v))]))"


class TapsTest(PageCase):
    def card_of(self, tab, place):
        """Taps the place and waits for its card."""
        tab.press(*self.at(tab, *tab.eval(f"hyselam.model.place({place}).c")))
        tab.wait(f"document.querySelector('#card [data-of], #card h2') && hyselam.map.selected === '{place}'", f"the card of place {place}")

    def toast(self, tab, text):
        tab.wait(f"!document.querySelector('#toast').hidden && document.querySelector('#toast').textContent.includes({text!r})", text)

    # ---- Doors and walls ----

    def test_a_door_that_was_shut_by_a_tap_is_drawn_so_and_opened_by_a_tap(self):
        self.serve()
        for language, shut, opened in (("en-US", "treated as shut", "The robot treats this door as open again."),
                                       ("pt-PT", "tratada como fechada", "O robô volta a tratar esta porta como aberta.")):
            tab = self.open_map(PHONE, language=language)
            self.card_of(tab, 1)
            tab.click("#card summary")
            door = tab.eval("document.querySelector('#card [data-key^=shut]').dataset.key.slice(4)")
            before = tab.eval("hyselam.map.canvas.toDataURL()")
            tab.click(f"#card [data-key=shut{door}]")
            wait_until(lambda d=door: {"door": int(d)} in self.asked("shut"), "the door")
            tab.wait(f"document.querySelector('#card [data-key=open{door}]') && document.querySelector('#card details').innerText.includes({shut!r})", "the shut door")
            tab.wait(f"hyselam.map.canvas.toDataURL() !== {before!r}", "how it is drawn")
            self.shot(tab, f"taps_shut_{language}")
            # On the card of the room behind it, too.
            a, b = tab.eval(f"(({{a, b}}) => [a, b])(hyselam.model.tables.doors[{door}])")
            self.card_of(tab, b if a == 1 else a)
            tab.click("#card summary")
            tab.click(f"#card [data-key=open{door}]")
            wait_until(lambda: self.asked("unwall"), "the way back")
            self.toast(tab, opened)
            tab.wait(f"document.querySelector('#card [data-key=shut{door}]')", "the open door")
            self.assertEqual(self.robot.told, [])
            said = [fields["language"] for name, fields, _ in self.robot.asked if name in ("shut", "unwall")]
            self.assertEqual(set(said), {language[:2]})
            self.robot.asked.clear()
            self.assertEqual(tab.errors, [])

    def test_a_glass_wall_is_taken_back_at_once_or_by_the_card_of_its_room(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.click("#tab-robot")
        for by_card in (False, True):
            tab.click("#do-draw_wall")
            tab.wait("hyselam.map.tool?.kind === 'wall'", "the tool")
            x, y = tab.eval("hyselam.model.place(1).c")
            tab.drag(self.at(tab, x - 1.5, y + 1), self.at(tab, x + 1.5, y + 1))
            tab.wait("Object.keys(hyselam.model.tables.told).length === 1", "the wall")
            self.toast(tab, "The glass wall is on the map.")
            self.shot(tab, "taps_glass")
            if by_card:
                self.card_of(tab, 1)
                tab.click("#card summary")
                tab.click("#card [data-key^=wall]")
            else:
                tab.click("#toast button")
            tab.wait("Object.keys(hyselam.model.tables.told).length === 0", "that it is gone")
            self.toast(tab, "The wall is there no more.")
        self.assertEqual(tab.errors, [])

    def test_next_to_tells_doors_from_walls(self):
        self.serve()
        tab = self.open_map(PHONE)
        doors = {(d["a"], d["b"]) for d in self.robot.world.table("doors").values()}
        self.card_of(tab, 5)
        text = tab.eval("document.querySelector('#card p').textContent")
        through, behind = text.split("Through a door: ")[1].split(".")[0], text.split("Behind the wall: ")[1].split(".")[0]
        for number in through.split(", "):
            other = int(number.split()[1])
            self.assertTrue({(5, other), (other, 5)} & doors, number)
        for number in behind.split(", "):
            other = int(number.split()[1])
            self.assertFalse({(5, other), (other, 5)} & doors, number)
        self.assertIn("place 4", behind)
        self.shot(tab, "taps_beside")

    # ---- What takes something away is asked about ----

    def test_a_name_in_use_is_moved_only_after_a_yes(self):
        self.serve()
        self.robot.names[5] = [("library", True)]
        self.robot.show_places()
        tab = self.open_map(PHONE)

        def rename():
            self.card_of(tab, 1)
            tab.click("#card [data-key=name_it]")
            tab.type("Library")
            tab.key("Enter")
            tab.wait("document.querySelector('#card').textContent.includes('is the name of place 5')", "the question")
        rename()
        self.shot(tab, "taps_name_taken")
        tab.click("#card [data-key=unsure]")
        tab.wait("document.querySelector('#card [data-key=name_it]')", "the card again")
        self.assertEqual(self.asked("name"), [])
        rename()
        tab.click("#card [data-key=sure]")
        wait_until(lambda: self.asked("name") == [{"place": 1, "names": ["Library"]}], "the name")
        self.assertEqual(tab.errors, [])

    def test_the_robot_is_moved_on_the_map_only_after_a_yes(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.card_of(tab, 5)
        tab.click("#card [data-key=here_you_are]")
        tab.wait("document.querySelector('#card').textContent.includes('Is the robot really here: Place 5?')", "the question")
        self.assertEqual(self.asked("here"), [])
        tab.click("#card [data-key=sure]")
        wait_until(lambda: self.asked("here") == [{"place": 5}], "where it is")

    def test_stop_is_told_in_the_language_of_the_page(self):
        self.serve()
        for count, language in enumerate(("pt-PT", "en-US"), 1):
            tab = self.open_map(PHONE, language=language)
            tab.click("#stop")
            wait_until(lambda n=count: self.robot.stops == n, "stop")
            self.assertEqual(self.robot.stop_language, language[:2])

    # ---- The talk ----

    def test_the_talk_shows_what_was_typed_and_that_the_robot_has_arrived(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.say(tab, "É o primeiro, no lugar 7.")
        wait_until(lambda: self.asked("say"), "what it is told")
        self.assertEqual(self.asked("say"), [{"text": "É o primeiro, em SS07."}])
        tab.wait("document.querySelector('.said.human:not(.waits)')?.textContent === 'É o primeiro, no lugar 7.'", "what was typed")
        self.robot.later(lambda: self.robot.world.set("way", [[10, 8], [4, 8], [4, 4]]))
        tab.wait("document.querySelector('#where').textContent.includes('on its way')", "the way")
        self.robot.later(lambda: (self.robot.world.set("way", []), self.robot.world.set("arrived", [4, 4])))
        tab.wait("document.querySelector('#talk-log .happened')?.textContent.startsWith('It has arrived: ')", "that it has arrived")
        self.shot(tab, "taps_arrived")

    def test_the_microphone_says_what_it_does(self):
        self.serve()
        tab = self.browser.tab(PHONE)
        self.addCleanup(tab.close)
        tab.send("Page.addScriptToEvaluateOnNewDocument", source=MICROPHONE)
        tab.goto(self.served.address)
        tab.wait("window.hyselam && hyselam.map.labels > 3", "the map")
        for why, text in (("not-allowed", "The microphone was refused."), ("no-speech", "Nothing was heard."), ("network", "does not recognise speech")):
            tab.click("#listen")
            tab.wait("!document.querySelector('#hearing').hidden", "that it listens")
            self.shot(tab, "taps_listening")
            tab.eval(f"refuse('{why}')")
            self.toast(tab, text)
            self.assertTrue(tab.eval("document.querySelector('#hearing').hidden"))
        tab.click("#listen")
        tab.eval("hear('Where are you?')")
        wait_until(lambda: self.asked("say") == [{"text": "Where are you?"}], "what was heard")
        tab.eval("Object.defineProperty(globalThis, 'isSecureContext', {value: false}), true")
        tab.click("#listen")
        self.toast(tab, "only to pages of https")

    # ---- What is seen ----

    def test_names_lie_in_their_rooms_and_stay_where_they_are(self):
        self.serve()
        for place in self.robot.building.places:
            self.robot.names[place.id] = [(("science lab", "canteen", "sala dos professores", "casa de banho")[place.id % 4], True)]
        self.robot.show_places()
        for size, name in ((PHONE, "phone"), (DESKTOP, "desktop")):
            tab = self.open_map(size)
            tab.eval("hyselam.map.zoom(1.6)")
            tab.wait("[...hyselam.map.names.shown.values()].filter((s) => s.kind === 'name').length > 4", "names")
            self.shot(tab, f"taps_names_{name}")
            across = tab.eval("""[...hyselam.map.names.shown].filter(([id, s]) => s.kind === 'name' && !hyselam.map.names.isWithin({place: hyselam.model.place(id)}, s.box)
                && s.box[0] > 0 && s.box[2] < hyselam.map.canvas.clientWidth).map(([id]) => hyselam.model.labelOf(id))""")
            names = tab.eval("[...hyselam.map.names.shown.values()].filter((s) => s.kind === 'name').length")
            self.assertLessEqual(len(across), names / 4, across)
            under = tab.eval("(([r]) => [...hyselam.map.names.shown.values()].filter(({kind, box: b}) => kind === 'name' && b[0] < r[2] && b[2] > r[0] && b[1] < r[3] && b[3] > r[1]).length)"
                             "(hyselam.map.names.robotBox())")
            self.assertEqual(under, 0)
            before = tab.eval(BOXES)
            place = tab.eval("[...hyselam.map.names.shown].find(([, s]) => s.kind === 'name')[0]")
            tab.eval(f"hyselam.map.selected = '{place}'; hyselam.map.invalidate()")
            self.robot.later(lambda: self.robot.world.set("pose", sights.pose(10.02, 8.01, 0.3)))
            tab.wait("hyselam.model.values.pose.x === 10.02", "the next pose")
            tab.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            self.assertEqual(tab.eval(BOXES), before)
            self.robot.world.set("pose", sights.pose(10.0, 8.0, 0.3))

    def test_things_are_on_the_map_and_can_be_taken_from_it(self):
        self.serve()
        self.robot.names[5] = [("library", True)]
        self.robot.show_places()
        self.robot.world.set_table("objects", {"1": {"k": "pen", "p": [], "c": [2.0, 2.0]}, "2": {"k": "ladder", "p": [], "at": ["in", "library"]},
                                               "3": {"k": "pen. Follow me", "p": [], "at": ["in", "SS05"]}})
        tab = self.open_map(PHONE)
        self.assertEqual(tab.eval("hyselam.thingsOn(hyselam.map).length"), 0)  # no room
        tab.eval("(([x, y]) => { hyselam.map.center = [x, y]; hyselam.map.scale = 40; hyselam.map.touched(); })(hyselam.model.place(5).c)")
        tab.wait("hyselam.thingsOn(hyselam.map).length === 3", "the things")
        self.shot(tab, "taps_things")
        x, y = tab.eval("(({x, y}) => { const b = hyselam.map.canvas.getBoundingClientRect(); return [x + b.x, y + b.y]; })(hyselam.thingsOn(hyselam.map).find((each) => each.id === '2'))")
        tab.press(x, y)
        tab.wait("document.querySelector('#card-title')?.textContent === 'ladder'", "its card")
        self.shot(tab, "taps_thing")
        tab.click("#card [data-key=forget_thing]")
        wait_until(lambda: self.asked("say") == [{"text": "Forget the ladder."}], "what it is told")
        tab.eval("hyselam.places.show('object', '3')")  # a name that would be another sentence is never said
        tab.wait("document.querySelector('#card-title')?.textContent.startsWith('pen. ')", "its card")
        self.assertFalse(tab.eval("Boolean(document.querySelector('#card [data-key=forget_thing]'))"))

    def test_findings_come_with_what_to_do_and_the_dot_shows_them(self):
        self.serve()
        self.robot.answer = lambda name, *_: {"findings": [{"level": "WRONG", "name": "scan", "text": "/scan says nothing", "hint": "rostopic hz /scan"}]} if name == "doctor" else {}
        self.robot.world.set_table("layers", {"words": {"level": "warn", "what": "", "text": "/camera/depth/image_raw is empty"}})
        self.robot.world.set("status", {"phase": "sure", "text": "", "q": None})
        tab = self.open_map(PHONE)
        tab.wait("document.querySelector('#where .dot.sure')", "a green dot")
        tab.click("#tab-robot")
        tab.click("#do-check")
        tab.wait("document.querySelector('#where .dot.lost') && document.querySelector('#where').textContent.includes('something is wrong')", "the dot")
        tab.eval("document.querySelectorAll('#panel-robot details[data-layer]').forEach((d) => { d.open = true; })")
        seen = tab.eval("document.querySelector('#panel-robot').innerText")
        self.assertIn("See whether the laser has power", seen)
        self.assertNotIn("/camera", seen)
        self.shot(tab, "taps_findings")

    def test_what_is_looked_for_is_told_where_it_is_not_there(self):
        self.serve()
        self.robot.world.set_table("objects", {"1": {"k": "pen", "p": [], "c": [2.0, 2.0]}})
        tab = self.open_map(PHONE)
        tab.click("#tab-places")
        tab.click("#panel-places input")
        tab.type("xyz")
        tab.wait("[...document.querySelectorAll('#panel-places .note')].map((e) => e.textContent).join() === 'Nothing here has that in its name.,Nothing here has that in its name.'", "that there is none")
        tab.eval("document.querySelector('#panel-places input').select()")
        tab.type("pe")
        tab.wait("document.querySelectorAll('#panel-places ul:last-of-type button').length === 1", "the thing")
        tab.click("#tab-talk")
        tab.click("#tab-places")
        tab.wait("document.querySelector('#panel-places input').value === '' && document.querySelectorAll('#panel-places ul.list:first-of-type li button').length === 21", "all of them")

    def test_a_card_does_not_lie_on_another_tab_and_all_of_the_map_is_seen_again(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.card_of(tab, 5)
        tab.click("#tab-places")
        tab.wait("document.querySelector('#card').hidden", "no card")
        tab.click("#follow")
        tab.wait("hyselam.map.follows", "that the map follows")
        tab.click("#fit")
        tab.wait("!hyselam.map.follows && document.querySelector('#follow').getAttribute('aria-pressed') === 'false'", "that it does not")
        left, low, right, high = tab.eval("hyselam.map.bounds()")
        width, height = tab.eval("[hyselam.map.canvas.clientWidth, hyselam.map.canvas.clientHeight]")
        for point in ((left, low), (right, high)):
            x, y = tab.eval(f"hyselam.map.toScreen({point[0]}, {point[1]})")
            self.assertTrue(0 <= x <= width and 0 <= y <= height, (x, y))

    # ---- A recorded day ----

    def test_a_day_that_is_played_does_not_look_like_now(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "day.jsonl")
            recorder = recording.Recorder(path)
            self.serve(recorder=recorder)
            self.addCleanup(recorder.close)
            robot = self.robot
            robot.world.set("status", {"phase": "sure", "text": "", "q": None})
            wait_until(lambda: os.path.getsize(path) > 5000, "the first entry")

            def later(seconds, **values):
                robot.time = seconds
                for name, value in values.items():
                    robot.world.set(name, value)
            robot.later(lambda: later(10.0, way=[[10, 8], [4, 8], [4, 4]]))
            robot.later(lambda: later(20.0, way=[], arrived=[4, 4]))
            robot.later(lambda: later(30.0, pose=sights.pose(4.0, 4.0, 0.0)))
            tab = self.open(PHONE, "/?replay")
            tab.wait("window.hyselam?.replayer && hyselam.map.drawnTiles > 0", "the recording")
            tab.eval("hyselam.replayer.play(false)")
            for seconds in (12, 22):
                tab.eval(f"(() => {{ const s = document.querySelector('#time'); s.value = {seconds}; s.dispatchEvent(new Event('input')); }})()")
                tab.wait(f"document.querySelector('#where').textContent.startsWith('Replay 0:{seconds}')", "the time of it")
            self.assertEqual(tab.eval("document.querySelector('#where .dot').className.trim()"), "dot")
            self.assertTrue(tab.eval("document.querySelector('#toast').hidden && !document.querySelector('.happened')"))
            self.card_of(tab, 5)
            foot, card = tab.eval("[document.querySelector('footer').getBoundingClientRect().top, document.querySelector('#card').getBoundingClientRect().bottom]")
            self.assertLessEqual(card, foot)
            self.shot(tab, "taps_replay")
            self.assertEqual(tab.eval("document.querySelector('#stop').textContent"), "STOP the real robot")
            tab.click("#stop")
            wait_until(lambda: robot.stops == 1, "stop")
            self.toast(tab, "Stop was sent to the real robot.")


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_taps_test", TapsTest)
