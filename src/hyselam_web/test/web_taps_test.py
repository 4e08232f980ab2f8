#!/usr/bin/env python3
"""What is done by tapping can be taken back by tapping, is asked about where it takes something away, and is answered in the language of the
page; what is shown says whether it is now; names lie in their rooms."""
import asyncio
import os
import sys
import tempfile
import types

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import wait_until
from hyselam_web import recording, sights
from hyselam_web.requests import Refused
from hyselam_web.robot import Robot
from page_case import PageCase

# A browser whose microphone says what the test wants.
MICROPHONE = """globalThis.SpeechRecognition = class { start() { globalThis.recognition = this; } stop() { this.onend(); } };
    globalThis.hear = (text) => { recognition.onresult({results: [Object.assign([{transcript: text}], {isFinal: true})]}); recognition.onend(); };
    globalThis.refuse = (why) => { recognition.onerror({error: why}); recognition.onend(); };"""
BOXES = "Object.fromEntries([...hyselam.map.names.shown].map(([id, s]) => [id, s.box.map((v) => Math.round(v))]))"


class TapsTest(PageCase):
    def card_of(self, tab, place):
        """Taps the place and waits for its card."""
        self.tap_place(tab, place)
        tab.wait(f"document.querySelector('#card [data-of], #card h2') && hyselam.map.selected === '{place}'", f"the card of place {place}")

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
            self.notice(tab, opened)
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
            self.notice(tab, "The glass wall is on the map.")
            self.shot(tab, "taps_glass")
            if by_card:
                self.card_of(tab, 1)
                tab.click("#card summary")
                tab.click("#card [data-key^=wall]")
            else:
                tab.click("#toast button")
            tab.wait("Object.keys(hyselam.model.tables.told).length === 0", "that it is gone")
            self.notice(tab, "The wall is there no more.")
        self.assertEqual(tab.errors, [])

    def test_a_wall_across_a_door_shuts_it_where_the_robot_says_so(self):
        self.serve()
        tab = self.open_map(PHONE)
        number, width = next((n, d["w"]) for n, d in self.robot.world.table("doors").items() if d["r"])
        shuts = f"""((length) => import("/js/building.js").then(({{shutBy}}) => {{
            const door = hyselam.model.tables.doors[{number}], [dx, dy] = [-door.ny * length / 2, door.nx * length / 2];
            hyselam.model.tables.told = {{1: {{ax: door.x - dx, ay: door.y - dy, bx: door.x + dx, by: door.y + dy, v: true}}}};
            return shutBy(hyselam.model, door) !== null; }}))"""
        for more, expected in ((-0.5, False), (-0.32, False), (-0.28, True), (0.0, True), (0.58, True), (0.62, False)):
            self.assertEqual(tab.eval(f"{shuts}({width + more})"), expected, more)

    def test_the_sides_of_a_wall_are_looked_for_as_far_as_the_robot_does(self):
        self.serve()
        tab = self.open_map(PHONE)
        left, low, right, _ = tab.eval("(({o}) => { const x = o.filter((_, i) => i % 2 === 0), y = o.filter((_, i) => i % 2); "
                                       "return [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)]; })(hyselam.model.place(1))")
        x = (left + right) / 2
        for off, expected in ((0.4, ["1"]), (0.7, ["1"]), (0.9, [])):  # outside of the building, along its wall
            sides = tab.eval(f'import("/js/building.js").then(({{sidesOf}}) => sidesOf(hyselam.model, {{ax: {x - 0.5}, ay: {low - off}, bx: {x + 0.5}, by: {low - off}}}))')
            self.assertEqual(sides, expected, off)

    def test_a_wall_of_any_length_can_be_taken_away(self):
        robot, called = Robot.__new__(Robot), []  # nothing of ROS begins

        async def call(service, *_):
            called.append(service)
            return types.SimpleNamespace(success=True, message="")
        robot._call = call
        loop = asyncio.new_event_loop()
        self.addCleanup(loop.close)
        for length in (0.1, 60.0):
            wall = {"ax": 1.0, "ay": 2.0, "bx": 1.0 + length, "by": 2.0}
            with self.assertRaises(Refused):
                loop.run_until_complete(robot.act("wall", wall, "drive"))
            self.assertEqual(called, [])
            loop.run_until_complete(robot.act("unwall", dict(wall, virtual=False), "drive"))
            self.assertEqual(called, ["remove_wall"])
            called.clear()

    def test_names_and_walls_are_told_with_the_language_of_the_page(self):
        self.serve()
        for language in ("pt-PT", "en-US"):
            tab = self.open_map(PHONE, language=language)
            self.card_of(tab, 1)
            tab.click("#card [data-key=name_it], #card [data-key=rename_it]")
            tab.wait("document.querySelector('#new-name')", "the form")
            tab.eval("document.querySelector('#new-name').select()")
            tab.type("arquivo" if language == "pt-PT" else "archive")
            tab.key("Enter")
            wait_until(lambda: self.asked("name"), "the name")
            tab.click("#tab-robot")
            tab.click("#do-draw_wall")
            tab.wait("hyselam.map.tool?.kind === 'wall'", "the tool")
            x, y = tab.eval("hyselam.model.place(1).c")
            tab.drag(self.at(tab, x - 1.5, y + 1), self.at(tab, x + 1.5, y + 1))
            wait_until(lambda: self.asked("wall"), "the wall")
            said = [(name, fields.get("language")) for name, fields, _ in self.robot.asked if name in ("name", "wall")]
            self.assertEqual(said, [("name", language[:2]), ("wall", language[:2])])
            self.robot.asked.clear()

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

    def test_a_name_in_use_is_noticed_with_articles_accents_and_the_word_room(self):
        self.serve()
        self.robot.names[12] = [("kitchen", True), ("o escritório", True), ("room 5", True), ("A", True)]
        self.robot.show_places()
        tab = self.open_map(PHONE)
        for name in ("Kitchen", "the kitchen", "escritorio", "Escritório", "os escritório", "5", "sala 5", "the room 5", "room A", "a"):
            self.assertEqual(tab.eval(f"hyselam.model.holderOf({name!r}, 1)"), "12", name)
        for name in ("kitchenette", "cozinha", "room 55", "lab 5", "o 5", "room", "the", "kitchen 5"):
            self.assertIsNone(tab.eval(f"hyselam.model.holderOf({name!r}, 1)"), name)
        self.robot.names[12] = [("cozinha", True)]
        self.robot.later(self.robot.show_places)
        tab.wait("hyselam.model.holderOf('a cozinha', 1) === '12'", "the article of Portuguese")

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
        for language in ("pt-PT", "en-US"):
            tab = self.open_map(PHONE, language=language)
            self.stop(tab)
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
        tab = self.open(PHONE, script=MICROPHONE)
        tab.wait("window.hyselam && hyselam.map.labels > 3", "the map")
        for why, text in (("not-allowed", "The microphone was refused."), ("no-speech", "Nothing was heard."), ("network", "does not recognise speech")):
            tab.click("#listen")
            tab.wait("!document.querySelector('#hearing').hidden", "that it listens")
            self.shot(tab, "taps_listening")
            tab.eval(f"refuse('{why}')")
            self.notice(tab, text)
            self.assertTrue(tab.eval("document.querySelector('#hearing').hidden"))
        tab.click("#listen")
        tab.eval("hear('Where are you?')")
        wait_until(lambda: self.asked("say") == [{"text": "Where are you?"}], "what was heard")
        tab.eval("Object.defineProperty(globalThis, 'isSecureContext', {value: false}), true")
        tab.click("#listen")
        self.notice(tab, "only to pages of https")

    # ---- What is seen ----

    def test_names_lie_in_their_rooms_and_stay_where_they_are(self):
        self.serve()
        for place in self.robot.building.places:
            self.robot.names[place.id] = [(("science lab", "canteen", "sala dos professores", "casa de banho")[place.id % 4], True)]
        self.robot.show_places()
        for size, name in ((PHONE, "phone"), (DESKTOP, "desktop")):
            tab = self.open_map(size)
            tab.eval("hyselam.map.zoom(1.6)")
            self.drawn(tab)  # where they lie is of this zoom
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
            self.drawn(tab)
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
        self.drawn(tab)
        self.shot(tab, "taps_things")
        x, y = tab.eval("(({x, y}) => { const b = hyselam.map.canvas.getBoundingClientRect(); return [x + b.x, y + b.y]; })(hyselam.thingsOn(hyselam.map).find((each) => each.id === '2'))")
        tab.press(x, y)
        tab.wait("document.querySelector('#card-title')?.textContent === 'ladder'", "its card")
        self.shot(tab, "taps_thing")
        tab.click("#card [data-key=forget_thing]")
        wait_until(lambda: self.asked("say") == [{"text": "Forget the ladder."}], "what it is told")
        # What takes it back puts it there again: "undo that" would be of places.
        self.robot.later(lambda: self.robot.say("robot", "Noted: the ladder is no longer in the library."))
        tab.wait("document.querySelector('.undo')", "undo")
        tab.click(".undo")
        wait_until(lambda: self.asked("say")[1:] == [{"text": 'The ladder is in "library".'}], "what takes it back")
        tab.eval("hyselam.places.show('object', '3')")  # a name that would be another sentence is never said
        tab.wait("document.querySelector('#card-title')?.textContent.startsWith('pen. ')", "its card")
        self.assertFalse(tab.eval("Boolean(document.querySelector('#card [data-key=forget_thing]'))"))

    def test_a_thing_is_forgotten_by_its_kind_only_where_that_is_one_thing_and_one_sentence(self):
        self.serve()
        kinds = {"1": "ladder", "2": "pen", "3": "Pen", "4": "cup and follow me", "5": "copo e siga-me", "6": "cup then stop", "7": "copo ou prato",
                 "8": "copo depois pare", "9": "cup, follow me", "10": "big old red metal box", "11": "sand box", "12": "first aid kit box", "13": "cup-and-go", "14": "cup or plate", "15": "copo então pare"}
        self.robot.world.set_table("objects", {number: {"k": kind, "p": [], "at": ["in", "SS05"]} for number, kind in kinds.items()})
        tab = self.open_map(PHONE)

        def may_be_forgotten(number):
            tab.eval(f"hyselam.places.show('object', '{number}')")
            tab.wait(f"document.querySelector('#card-title')?.textContent === {kinds[number]!r}", "its card")
            return tab.eval("Boolean(document.querySelector('#card [data-key=forget_thing]'))")
        self.assertEqual([kinds[number] for number in kinds if may_be_forgotten(number)], ["ladder", "sand box", "first aid kit box"])
        # The other pen has gone: the card that is open says so.
        self.assertFalse(may_be_forgotten("2"))
        self.robot.later(lambda: self.robot.world.set_table("objects", {"2": {"k": "pen", "p": [], "at": ["in", "SS05"]}}))
        tab.wait("document.querySelector('#card [data-key=forget_thing]')", "the button")

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
            self.stop(tab)
            self.notice(tab, "Stop was sent to the real robot.")


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_taps_test", TapsTest)
