#!/usr/bin/env python3
"""What is open is shown where it is answered, and no longer than it is open: questions, ways, tools; places are named by their numbers."""
import sys

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import wait_until
from hyselam_web import open_ends, sights
from page_case import PageCase

ABOVE = "((a, b) => a.getBoundingClientRect().bottom <= b.getBoundingClientRect().top + 1)(document.querySelector('%s'), document.querySelector('%s'))"
VISIBLE = "(document.querySelector('#answers').hidden ? '' : document.querySelector('#question').textContent)"
SHARED = """((a, b) => { const [p, q] = [a, b].map((e) => document.querySelector(e).getBoundingClientRect());
    return Math.max(0, Math.min(p.right, q.right) - Math.max(p.left, q.left)) * Math.max(0, Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top)); })('%s', '%s')"""


class OpenEndsTest(PageCase):
    def hears(self, *lines):
        """Lines of the talk, and the question that is open then."""
        def play():
            for who, text in lines:
                self.robot.say(who, text)
        self.robot.later(play)

    def leaves_open(self, text):
        self.robot.later(lambda: self.robot.world.set("asked", text and sights.question(text, 11, True)))

    # ---- Questions ----

    def test_what_is_open_is_what_the_dialogue_tells(self):
        question = open_ends.OpenQuestion()
        self.assertIsNone(question.shown(7))
        question.heard("robot", "Is SS12 John's office?")
        self.assertEqual(question.shown(7)["place"], 12)
        question.told("Is SS12 John's office?")
        question.heard("robot", "Noted: it rains.")
        self.assertEqual(question.shown(7)["place"], 12)  # open whatever else is said
        question.heard("human", "What?")
        self.assertIsNone(question.shown(7))  # until the robot has answered
        question.heard("robot", "Is SS12 John's office?")
        self.assertEqual(question.shown(7)["place"], 12)
        question.told("")
        self.assertIsNone(question.shown(7))
        question.heard("robot", "Is the pen red?")  # of who knows things
        self.assertTrue(question.shown(7)["yes"])
        question.heard("human", "Yes.")
        self.assertIsNone(question.shown(7))
        also = "Until now this place is kitchen. Is it also known as canteen? If its name is wrong, say: rename this place to canteen."
        question.told(also)
        self.assertEqual(question.shown(7), {"text": also, "place": 7, "yes": True})
        question.told("I do not know your name yet. Tell me: 'I am ...'")
        self.assertFalse(question.shown(7)["yes"])

    def test_yes_and_no_stand_under_their_question(self):
        self.serve()
        asked = "Shall I call this place 'coridor'?"
        tab = self.open_map(PHONE)
        self.hears(("human", "You are in the coridor."), ("robot", asked))
        tab.wait(VISIBLE + f" === {asked!r}", "the question")
        tab.wait("document.querySelector('#question').offsetHeight <= 1", "that it is said once: it is the last line")
        # "Did you mean" has its own button, below; it comes when the robot has told that it would understand that, and moves nothing.
        tab.wait("document.querySelectorAll('#chips .offered').length === 1", "the sentence that was meant")
        self.assertTrue(tab.eval(ABOVE % ("#answers", "#chips .offered")))
        self.shot(tab, "phone_asked")
        # Something else is said: the question is put once more above its buttons.
        self.hears(("human", "There is a kitchen."), ("robot", "I am not sure where kitchen may be."))
        self.robot.later(lambda: self.robot.world.set("candidates", {"kitchen": [3, 7]}))
        self.leaves_open(asked)
        tab.wait(VISIBLE + f" === {asked!r} && document.querySelector('#question').offsetHeight > 10", "the question again")
        self.assertTrue(tab.eval(ABOVE % ("#question", "#yes")))
        self.assertTrue(tab.eval("document.querySelector('#next').hidden"), "one question at a time")
        self.shot(tab, "phone_asked_again")
        self.leaves_open(None)
        tab.wait("document.querySelector('#answers').hidden && document.querySelector('#next p')?.textContent === 'Where is the kitchen?'", "the next")
        self.assertEqual(tab.errors, [])

    def test_only_what_is_understood_is_offered(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.hears(("human", "Where is the kichen xyzzy?"), ("robot", "I know of no kichen."))
        wait_until(lambda: self.asked("try"), "that it is tried")
        self.assertEqual(self.asked("try"), [{"text": "Where is the kitchen xyzzy?"}])
        self.hears(("human", "Where is the kichen?"), ("robot", "I know of no kichen."))
        tab.wait("document.querySelector('#next .row button')?.textContent === 'Where is the kitchen?'", "what is understood")
        self.assertEqual(tab.errors, [])

    def test_the_nearest_place_is_the_first_button(self):
        self.serve()
        self.robot.world.set("candidates", {"kitchen": [3, 5, 7, 9, 12]})
        tab = self.open_map(PHONE)
        self.hears(("human", "There is a kitchen."), ("robot", "Many places fit: I am not sure where kitchen may be."))
        tab.wait("!document.querySelector('#next').hidden", "the buttons")
        order = tab.eval("[...document.querySelectorAll('#next [data-place]')].map((b) => Number(b.dataset.place))")
        centre = {place.id: (place.centre.x, place.centre.y) for place in self.robot.building.places}
        far = [(centre[i][0] - 10.0) ** 2 + (centre[i][1] - 8.0) ** 2 for i in order]
        self.assertEqual((far, sorted(order)), (sorted(far), [3, 5, 7, 9, 12]))

    # ---- Places by number ----

    def test_places_are_named_by_their_numbers(self):
        self.serve()
        self.robot.world.set("names", ["room 9"])
        tab = self.open_map(PHONE)
        for said, told in (("place 5 is the library", "SS05 is the library"), ("Number 5 is the library.", "SS05 is the library."), ("1 is the kitchen", "SS01 is the kitchen"),
                           ("room 5 is the library", "SS05 is the library"), ("room 9 is the library", "room 9 is the library"),
                           ("O lugar 5 é a biblioteca.", "SS05 é a biblioteca."), ("o 5 é a biblioteca", "SS05 é a biblioteca"),
                           ("number 1 is the kitchen and number 5 the library", "SS01 is the kitchen. SS05 is the library"),
                           ("number 1 is the kitchen and number 5 is Ana's office", "SS01 is the kitchen. SS05 is Ana's office"),
                           ("room 5 is the second door on the left", "room 5 is the second door on the left"), ("place 999 is the lab", "place 999 is the lab"),
                           ("The kitchen is place 7", 'SS07 is "kitchen".'), ("the staff room is in number 7.", 'SS07 is "staff room".'), ("A cozinha é o lugar 7", 'SS07 é "cozinha".'),
                           ("a cozinha é o lugar sete", 'SS07 é "cozinha".'), ("The kitchen is place seven.", 'SS07 is "kitchen".'), ("A cozinha fica no número 7.", 'SS07 é "cozinha".'),
                           ("The kitchen is not place 7", "The kitchen is not SS07"), ("The kitchen is room 9", "The kitchen is room 9"), ("Where is place 7", "Where is SS07"), ("It is place 7", "It is SS07"),
                           ("Go to place seven.", "Go to SS07."), ("I have seven rooms", "I have seven rooms"),
                           ("There are 3 rooms and 2 the corridor", "There are 3 rooms and 2 the corridor"), ("Go to place 5.", "Go to SS05.")):
            self.assertEqual(tab.eval(f"hyselam.told({said!r})"), told)

    # ---- Ways ----

    def test_a_way_is_over_at_its_end(self):
        arrival, way = open_ends.Arrival(), [[0.0, 0.0], [5.0, 0.0]]
        arrival.sets_out()
        self.assertEqual([arrival.is_at_end(way, (x, 0.0)) for x in (0.0, 2.0, 4.4, 4.6)], [False, False, False, True])
        arrival.sets_out()
        back = [[0.0, 0.0], [5.0, 0.0], [0.0, 0.0]]  # there and back
        self.assertEqual([arrival.is_at_end(back, (x, 0.0)) for x in (0.0, 5.0, 0.6, 0.3)], [False, False, False, True])
        arrival.sets_out()
        self.assertTrue(arrival.is_at_end([[4.8, 0.0], [5.0, 0.0]], (4.8, 0.0)))  # found anew at its end

    def test_arriving_is_said_and_shown(self):
        self.serve()
        for language, going, arrived, said in (("en-US", "on its way", "it has arrived", "It has arrived: Place 5."), ("pt-PT", "a caminho", "chegou", "Chegou: Lugar 5.")):
            self.robot.world.set("arrived", None)
            self.robot.world.set("way", [[10, 8], [17.9, 3.4]])
            tab = self.open_map(PHONE, language=language)
            tab.wait(f"document.querySelector('#where').textContent.includes({going!r})", "that it goes")
            self.robot.later(lambda: (self.robot.world.set("way", []), self.robot.world.set("arrived", [17.9, 3.4])))
            tab.wait(f"document.querySelector('#where').textContent.includes({arrived!r})", "that it is there")
            tab.wait(f"document.querySelector('#toast').textContent === {said!r}", "where")
            self.assertTrue(tab.eval("document.querySelector('#where').scrollWidth <= document.querySelector('#where').clientWidth + 1"))
            self.assertEqual(tab.errors, [])

    # ---- Stop, tools, layers ----

    def test_a_notice_lies_on_nothing_that_is_pressed(self):
        self.serve()
        for size, language in ((PHONE, "en-US"), (PHONE, "pt-PT"), (DESKTOP, "en-US")):
            tab = self.open_map(size, language=language)
            tab.click("#stop")
            tab.wait("!document.querySelector('#toast').hidden", "the notice")
            for below in ("#say-form", "#tabs", "#stop"):
                self.assertEqual(tab.eval(SHARED % ("#toast", below)), 0, below)
            self.shot(tab, f"toast_{language}")
            before = len(self.asked("say"))
            self.say(tab, "Where are you?")
            wait_until(lambda n=before: len(self.asked("say")) > n, "what was said beside it")

    def test_stop_is_shown_in_the_language_of_the_page(self):
        self.serve()
        for language, word in (("pt-PT", "Parar."), ("en-US", "Stop.")):
            tab = self.open_map(PHONE, language=language)
            self.hears(("human", "Stop."))
            tab.wait(f"[...document.querySelectorAll('.said.human')].pop()?.textContent === {word!r}", word)

    def test_another_tab_ends_what_was_to_be_drawn(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.click("#tab-robot")
        self.assertEqual(tab.eval("document.querySelector('#do-set_pose').textContent"), "Tell the robot where it is")
        tab.click("#do-set_pose")
        tab.wait("hyselam.map.tool?.kind === 'pose' && !document.querySelector('#tool-bar').hidden", "the tool")
        tab.click("#tab-talk")
        tab.wait("!hyselam.map.tool && document.querySelector('#tool-bar').hidden", "the end of it")

    def test_a_part_with_something_to_say_says_it(self):
        self.serve()
        self.robot.world.set_table("layers", {"localization": {"level": "warn", "text": "the scan is 0.7 s old"}, "slam": {"level": "ok", "text": "fine"}})
        tab = self.open_map(PHONE)
        tab.click("#tab-robot")
        tab.wait("document.querySelector('[data-layer=localization]')", "the part")
        tab.click("[data-layer=localization] summary")
        tab.wait("document.querySelector('[data-layer=localization]').open", "what it says")
        self.assertIn("0.7 s old", tab.eval("document.querySelector('[data-layer=localization] p').textContent"))
        self.assertFalse(tab.eval("Boolean(document.querySelector('[data-layer=slam]'))"))
        self.assertEqual(tab.errors, [])


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_open_ends_test", OpenEndsTest)
