#!/usr/bin/env python3
"""What an answer leaves to be done: what is taken back is told before, a way goes on, a place is shown, a guess is asked about; the newest line is in
sight; names on the map stay within their places."""
import sys

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import wait_until
from page_case import PageCase

UNDO = "document.querySelector('.undo')?.textContent"
SETTLED = "((e) => e && !e.classList.contains('settling'))(document.querySelector('%s'))"
# All of an element lies within the talk, above what stands below that.
IN_SIGHT = """((e, log) => { if (!e) return false; const [a, b] = [e.getBoundingClientRect(), log.getBoundingClientRect()];
    return a.top >= b.top - 1 && a.bottom <= b.bottom + 1; })(document.querySelector('%s'), document.querySelector('#talk-log'))"""
# Names that reach out of their places, onto a door or onto another name.
ASTRAY = """(() => { const {map, model} = hyselam, found = [], all = [...map.names.shown].filter(([, s]) => s.kind === 'name');
    const meets = (a, b) => a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1];
    for (const [id, {box: [l, t, r, b], lines}] of all) {
        const [x0, x1, y0, y1] = [l + 2, r - 2, t + 2, b - 2];
        for (let i = 0; i <= 8; ++i) for (let j = 0; j <= 4; ++j) if (model.placeAt(...map.toMap(x0 + (x1 - x0) * i / 8, y0 + (y1 - y0) * j / 4)) !== id) found.push(`${id} ${lines}`);
        for (const d of Object.values(model.tables.doors)) { const [x, y] = map.toScreen(d.x, d.y); if (d.r && meets([l, t, r, b], [x - 2, y - 2, x + 2, y + 2])) found.push(`${id} on a door`); }
        for (const [other, s] of all) if (other > id && meets([l, t, r, b], s.box)) found.push(`${id} on ${other}`);
    }
    return [...new Set(found)]; })()"""
NAMES = ["staff room", "broom closet", "classroom 2B", "first aid room", "library", "canteen", "meeting room of the board"]


class AnswersTest(PageCase):
    def hears(self, *lines, **values):
        def play():
            for name, value in values.items():
                self.robot.world.set(name, value)
            for who, text in lines:
                self.robot.say(who, text)
        self.robot.later(play)

    def name_all(self, sure=True):
        for i, place in enumerate(self.robot.building.places):
            self.robot.names[place.id] = [(NAMES[i % len(NAMES)], sure)]
        self.robot.show_places()

    # ---- Undo ----

    def test_undo_tells_what_it_takes_back(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.hears(("human", "Hello."), ("robot", "Thank you. SS08 is the copy room."), undo="copy room")
        tab.wait(UNDO + " === 'Undo: copy room'", "what is taken back")
        # Of another turn, and of what is long ago: no.
        self.hears(("human", "Where are you?"), ("robot", "I am at SS03."))
        tab.wait("!document.querySelector('.undo')", "no undo behind a question")
        # Things are nothing that it takes back.
        self.hears(("human", "There is a mop in the lab."), ("robot", "Noted: a mop is in the lab."), undo="")
        tab.wait("[...document.querySelectorAll('.said.robot')].pop().textContent.includes('mop')", "the answer")
        self.assertIsNone(tab.eval(UNDO))
        # What is next may change while the answer stands.
        self.hears(undo="SS04 is next to the lab")
        tab.wait(UNDO + " === 'Undo: Place 4 is next to the lab'", "what is next now")
        self.shot(tab, "phone_undo")
        self.assertEqual(tab.errors, [])

    def test_behind_an_undo_only_the_rest_of_the_same_sentence_can_be_taken_back(self):
        self.serve()
        tab = self.open_map(PHONE)
        told = "You are in the corridor. On your left you have the kitchen."
        self.hears(("human", told), ("robot", "Noted: it is in the corridor; the kitchen is on its left."), undo="On your left you have the kitchen")
        tab.wait(UNDO + " === 'Undo: On your left you have the kitchen'", "the last of it")
        self.hears(("human", "Undo that."), ("robot", "I have taken back: 'On your left you have the kitchen'."), undo="You are in the corridor")
        tab.wait(UNDO + " === 'Undo: You are in the corridor'", "the rest of it")
        # A name that was told minutes before is not behind the same button.
        self.hears(("human", "Undo that."), ("robot", "I have taken back: 'You are in the corridor'."), ("robot", "So SS04 is the music room again."), undo="library")
        tab.wait("!document.querySelector('.undo')", "no undo of what was said long ago")
        self.assertEqual(tab.errors, [])

    # ---- Stop and go on ----

    def test_a_way_that_was_stopped_goes_on_by_a_button(self):
        for language, label, said in (("en-US", "Carry on to the staff room", "Carry on."), ("pt-PT", "Continuar: the staff room", "Continue.")):
            self.serve()
            tab = self.open_map(PHONE, language=language)
            self.hears(("human", "Stop."), ("robot", "I have stopped."))
            tab.wait("document.querySelectorAll('.said.robot').length === 1", "the answer")
            self.assertFalse(tab.eval("Boolean(document.querySelector('.carry-on'))"), "it was not on its way")
            self.hears(halted="the staff room")
            tab.wait(f"document.querySelector('.carry-on')?.textContent === {label!r}", label)
            # Sent there by its number, it is called by its name.
            self.hears(halted="SS04")
            tab.wait("document.querySelector('.carry-on')?.textContent.endsWith(' %s')" % ("place 4" if language == "en-US" else "lugar 4"), "its number")
            self.robot.names[4] = [("kitchen", True)]
            self.robot.later(self.robot.show_places)
            tab.wait("hyselam.model.nameOf(4).text === 'kitchen'", "the name")
            self.hears(halted="")
            self.hears(halted="SS04")
            tab.wait("document.querySelector('.carry-on')?.textContent.endsWith(' %s')" % ("the kitchen" if language == "en-US" else "kitchen"), "its name")
            self.hears(halted="the staff room")
            tab.wait(f"document.querySelector('.carry-on')?.textContent === {label!r}", label)
            tab.wait(SETTLED % ".carry-on", "that it is meant when it is pressed")
            self.shot(tab, f"phone_carry_on_{language}")
            tab.click(".carry-on")
            tab.wait("[...document.querySelectorAll('.said.human')].pop().textContent === %r" % said, "what is said")
            wait_until(lambda: self.asked("say"), "that it is said")  # the page shows it before the server has it
            self.assertEqual(self.asked("say"), [{"text": said}])
            self.hears(halted="")
            tab.wait("!document.querySelector('.carry-on')", "that it is on its way")
            self.assertEqual(tab.errors, [])

    # ---- The newest line ----

    def test_the_newest_answer_and_its_undo_are_in_sight_above_the_card(self):
        self.serve()
        tab = self.open_map(PHONE)
        for line in range(20):
            self.robot.say("robot", f"I have said {line} things.")
        tab.wait("document.querySelectorAll('.said.robot').length >= 20", "the talk")
        # The card comes with the answer.
        self.hears(("human", "There is a copy room and a library."), ("robot", "Noted: there is a copy room and a library."),
                   ("robot", "I am not sure where the first aid room and the library may be."), undo="there is a library", candidates={"library": [3, 5, 7, 9]})
        tab.wait("!document.querySelector('#next').hidden && document.querySelector('.undo')", "the card and undo")
        tab.wait(IN_SIGHT % ".undo", "undo in sight")
        self.assertTrue(tab.eval(IN_SIGHT % ".said.robot:nth-last-child(2)"), "the answer")
        self.assertLess(tab.eval("document.querySelector('#next').offsetHeight / document.querySelector('#panel-talk').offsetHeight"), 0.42)
        self.shot(tab, "phone_newest")
        # Also behind what was tapped, when somebody had read further up.
        tab.eval("document.querySelector('#talk-log').scrollTop = 0")
        tab.wait("!hyselam.talk.atEnd", "that somebody reads")
        self.hears(("robot", "I have said more."))
        tab.wait("[...document.querySelectorAll('.said.robot')].pop().textContent === 'I have said more.'", "what another person's talk says")
        self.assertEqual(tab.eval("document.querySelector('#talk-log').scrollTop"), 0, "who reads is left alone")
        tab.click("#next [data-place]")
        self.hears(("robot", "Thank you. SS08 is the library."), undo="library", candidates={})
        tab.wait("document.querySelector('#next').hidden", "no card")
        tab.wait(IN_SIGHT % ".undo", "undo in sight")
        self.assertEqual(tab.errors, [])

    # ---- Where it is ----

    def test_a_place_that_was_asked_for_is_shown_on_the_map(self):
        self.serve()
        self.name_all()
        tab = self.open_map(PHONE)
        self.hears(("human", "Where is the first aid room?"), ("robot", "The first aid room is SS10, 12.3 meters from here."))
        tab.wait("hyselam.model.lit === 10", "the place")
        tab.wait("document.querySelector('.show')?.textContent === 'Show place 10'", "the button")
        tab.eval("hyselam.map.pan(-5000, 0)")
        self.drawn(tab)
        tab.click(".show")
        self.drawn(tab)
        seen = tab.eval("(() => { const [x, y] = hyselam.map.toScreen(...hyselam.model.place(10).c); return x > 0 && y > 0 && x < hyselam.map.canvas.clientWidth && y < hyselam.map.canvas.clientHeight; })()")
        self.assertTrue(seen)
        self.assertEqual(tab.eval("hyselam.map.names.shown.get('10').kind"), "name")
        self.shot(tab, "phone_lit")
        tab.wait("hyselam.model.lit === null", "that it is over")
        self.hears(("human", "Where are the toilets?"), ("robot", "That may be SS02 and SS03. Say which one."))
        tab.wait("!document.querySelector('.show')", "no button for several")
        self.assertEqual(tab.errors, [])

    # ---- Guesses ----

    def test_a_guess_that_is_left_is_asked_about(self):
        self.serve()
        self.robot.names[3], self.robot.names[4] = [("science lab", False)], [("music room", True)]
        self.robot.show_places()
        tab = self.open_map(PHONE)
        self.assertTrue(tab.eval("document.querySelector('#next').hidden"))
        self.hears(("human", "Hello."), ("robot", "Thank you. SS04 is the music room."))
        tab.wait("document.querySelector('#next p')?.textContent === 'Is place 3 the science lab?'", "the question")
        self.shot(tab, "phone_guess")
        self.assertEqual(tab.eval("[...document.querySelectorAll('#next .row button')].map((b) => b.textContent)"), ["Yes, place 3", "Another place…"])
        self.assertEqual(tab.eval("hyselam.model.marked.ids"), [3])
        tab.click("#next .close")
        self.hears(("human", "Hello."), ("robot", "Thank you. SS05 is the gym."))
        tab.wait("document.querySelectorAll('.said.robot').length === 2", "the answer")
        self.assertTrue(tab.eval("document.querySelector('#next').hidden"), "nobody wants to be asked")
        self.robot.names[6] = [("toilets", False)]
        self.robot.later(self.robot.show_places)
        tab.wait("document.querySelector('#next p')?.textContent === 'Is place 6 the toilets?'", "the next")
        tab.click("#next [data-place='6']")
        tab.wait("hyselam.model.nameOf(6).sure && document.querySelector('#next').hidden", "the name")
        wait_until(lambda: self.asked("name"), "that it is named")
        self.assertEqual(self.asked("name"), [{"place": 6, "names": ["toilets"]}])
        self.assertEqual(tab.errors, [])

    def test_what_is_typed_to_a_guess_is_an_answer(self):
        self.serve()
        self.robot.names[3] = [("science lab", False)]
        self.robot.show_places()
        tab = self.open_map(PHONE)
        lab = 'SS03 is "science lab".'
        for typed, heard in [("yes", lab), ("Yeah, that's right.", lab), ("sim, é isso", 'SS03 é "science lab".'), ("isso mesmo", 'SS03 é "science lab".'),
                             ("it is place 5, besides the door is open", "it is SS05, besides the door is open"), ("place 5", 'SS05 is "science lab".'),
                             ("it is place 5, between the gym and the library", 'SS05 is "science lab". SS05 is between the gym and the library.'),
                             ("é o lugar 5, em frente à escada", 'SS05 é "science lab". SS05 fica em frente à escada.'), ("yes, the toilet is number 2", 'SS02 is "toilet".'),
                             ("yes, but the gym is shut", "yes, but the gym is shut"), ("right?", "right?"), ("no", "no")]:
            self.hears(("human", "Hello."), ("robot", "Thank you. SS04 is the music room."))
            tab.wait("document.querySelector('#next p')?.textContent === 'Is place 3 the science lab?'", "the question")
            self.say(tab, typed)
            wait_until(lambda h=heard: {"text": h} in self.asked("say"), lambda: (typed, self.asked("say")))
        self.assertEqual(tab.errors, [])

    # ---- Words ----

    def test_several_are_asked_for_as_several(self):
        self.serve()
        self.robot.world.set("candidates", {"toilets": [3, 5]})
        self.robot.world.set("names", ["toilets"])
        for language, question in (("en-US", "Where are the toilets?"), ("pt-PT", "Onde ficam toilets?")):
            tab = self.open_map(PHONE, language=language)
            self.hears(("human", "There are toilets."), ("robot", "I am not sure where the toilets may be."))
            tab.wait(f"document.querySelector('#next p')?.textContent === {question!r}", question)
        self.robot.names[4] = [("library", False)]
        self.robot.later(self.robot.show_places)
        tab.wait("hyselam.model.labelOf(4) === 'library?'", "the guess")
        for place in range(1, 22):
            self.assertNotRegex(tab.eval(f"hyselam.model.place({place}) ? hyselam.places.describe({place}) : ''"), r"[?…]\.")

    def test_that_it_has_arrived_is_told_for_a_while(self):
        self.serve()
        tab = self.open_map(PHONE, script="{ const own = performance.now.bind(performance); globalThis.later = 0; performance.now = () => own() + later; }")
        self.hears(arrived=[10.0, 8.0])
        tab.wait("document.querySelector('#where').textContent.includes('it has arrived')", "that it has arrived")
        tab.eval("later = 21000")
        self.robot.later(lambda: self.robot.world.set("pose", {"x": 10.1, "y": 8.0, "a": 0.0}))
        tab.wait("!document.querySelector('#where').textContent.includes('it has arrived')", "that it is no news any more")
        self.assertEqual(tab.errors, [])

    # ---- Names on the map ----

    def test_names_stay_within_their_places(self):
        self.serve()
        self.name_all()
        for size in (PHONE, DESKTOP):
            tab = self.open_map(size)
            for closer in (1.0, 1.6, 3.0):
                tab.eval(f"(hyselam.map.fit(), hyselam.map.zoom({closer}))")
                self.drawn(tab)
                self.assertEqual(tab.eval(ASTRAY), [], (size, closer))
                self.shot(tab, f"names_{size[0]}_{closer}")
            tab.eval("hyselam.map.fit()")
            self.drawn(tab)
            # Cut before not told at all.
            self.assertEqual(tab.eval("[...hyselam.map.names.shown.values()].filter((s) => s.kind === 'dot').length"), 0, size)
            self.assertEqual(tab.errors, [])

    def test_a_name_is_back_at_its_spot_when_the_robot_has_left(self):
        self.serve()
        self.name_all()
        tab = self.open_map(DESKTOP)
        spot = "hyselam.map.names.shown.get('5').box.map(Math.round)"
        self.drawn(tab)
        before, middle = tab.eval(spot), tab.eval("hyselam.model.place(5).c")
        there = lambda x, y: self.robot.later(lambda: self.robot.world.set("pose", {"x": x, "y": y, "a": 0.0}))
        there(*middle)
        tab.wait(f"JSON.stringify({spot}) !== JSON.stringify({before})", "that it makes room")
        self.assertEqual(tab.eval(ASTRAY), [])
        there(10.0, 8.0)
        tab.wait(f"JSON.stringify({spot}) === JSON.stringify({before})", "that it is back")
        self.assertEqual(tab.errors, [])

    def test_no_name_becomes_a_dot_while_a_question_is_open(self):
        self.serve()
        self.name_all()
        self.robot.names[12] = [("meeting room of the board", False)]
        self.robot.show_places()
        tab = self.open_map(PHONE)
        self.hears(("robot", "Is SS12 meeting room of the board?"))
        tab.wait("hyselam.model.values.asked?.place === 12", "the question")
        self.hears(candidates={"attic": [3, 5]})
        self.drawn(tab)
        self.assertEqual(tab.eval("[...hyselam.map.names.shown.values()].filter((s) => s.kind === 'dot').length"), 0)
        self.shot(tab, "names_asked")
        self.assertEqual(tab.errors, [])


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_answers_test", AnswersTest)
