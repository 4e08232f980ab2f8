#!/usr/bin/env python3
"""What helps a person who has only the page: each place is seen and can be tapped, what is open has a button, slips of the pen are understood,
places have numbers instead of codes, one Portuguese."""
import re
import sys

sys.dont_write_bytecode = True
from devtools import DESKTOP, PHONE
from fake_robot import PACKAGE, wait_until
from page_case import PageCase

CODE = re.compile(r"\b(SS|CC|VV)\d\d")
LONG = ["robotics laboratory", "secretary of the department", "meeting room of the board", "storage room for spare parts", "coffee kitchen", "network operations centre"]
OPEN_LABELS = """(() => { const open = [...document.querySelectorAll('body *')].filter((e) => e.offsetParent && [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()));
    return open.map((e) => e.textContent).join(' | ') + [...document.querySelectorAll('[aria-label], [title], [placeholder]')].map((e) =>
    ['aria-label', 'title', 'placeholder'].map((n) => e.getAttribute(n) ?? '').join(' ')).join(' | '); })()"""


class HelpTest(PageCase):
    def answers(self, *sentences):
        """What the robot will answer to the next sentence, instead of what it does."""
        def act(name, fields, role, own=self.robot.act):
            if name != "say":
                return own(name, fields, role)
            self.robot.asked.append((name, fields, role))
            self.robot.say("human", fields["text"])
            for sentence in sentences:
                self.robot.say("robot", sentence)

            async def result():
                return {"answers": list(sentences)}
            return result()
        self.robot.act = act

    def next(self, tab, text):
        tab.wait(f"document.querySelector('#next p')?.textContent === {text!r}", text)
        return tab.eval("[...document.querySelectorAll('#next .row button')].map((b) => b.textContent)")

    def guess_all(self, names=LONG, sure=False):
        for i, place in enumerate(self.robot.building.places):
            self.robot.names[place.id] = [(names[i % len(names)], sure)]
        self.robot.show_places()

    # ---- No place stays unseen ----

    def test_each_place_is_seen_and_tapped_where_names_have_no_room(self):
        self.serve()
        self.guess_all()
        tab = self.open_map(PHONE)
        count = len(self.robot.building.places)
        for closer in (1.0, 0.6, 2.0):
            if closer != 1.0:
                tab.eval(f"(hyselam.map.fit(), hyselam.map.zoom({closer}))")
            self.drawn(tab)
            if closer <= 1.0:
                tab.wait(f"hyselam.map.names.shown.size === {count}", "all places")
            # No name lies on the middle of a place that has only a dot.
            hidden = tab.eval("""(() => { const shown = [...hyselam.map.names.shown.values()]; return shown.filter((d) => d.kind === 'dot' && shown.some((n) =>
                n.kind === 'name' && d.x > n.box[0] && d.x < n.box[2] && d.y > n.box[1] && d.y < n.box[3])).length; })()""")
            self.assertEqual(hidden, 0, closer)
            self.shot(tab, f"phone_tight_{closer}")
        tab.eval("(hyselam.map.fit(), hyselam.map.zoom(0.5))")
        self.drawn(tab)
        tab.wait("[...hyselam.map.names.shown.values()].some((s) => s.kind === 'dot') && hyselam.map.names.shown.size === %d" % count, "dots")
        for place in tab.eval("[...hyselam.map.names.shown].filter(([, s]) => s.kind === 'dot').map(([id]) => id)"):
            self.tap_place(tab, place)
            title = self.robot.names[int(place)][0][0] + "?"
            tab.wait(f"document.querySelector('#card-title')?.textContent === {title!r} && hyselam.map.selected === '{place}'", f"the card of place {place}")
            tab.wait(f"hyselam.map.names.shown.get('{place}').kind === 'name'", f"its name on the map: {title}")
            tab.click("#card .close")
            tab.wait("document.querySelector('#card').hidden", "no card")
        self.assertEqual(tab.errors, [])

    def test_the_mouse_over_a_place_names_it(self):
        self.serve()
        self.guess_all()
        tab = self.open_map(DESKTOP)
        tab.eval("hyselam.map.zoom(0.12)")
        self.drawn(tab)
        tab.wait("[...hyselam.map.names.shown.values()].some((s) => s.kind === 'dot')", "dots")
        place, x, y = tab.eval("""(() => { const [id, s] = [...hyselam.map.names.shown].find(([, s]) => s.kind === 'dot'), b = hyselam.map.canvas.getBoundingClientRect();
            return [id, s.x + b.x, s.y + b.y]; })()""")
        tab.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        tab.wait(f"hyselam.map.canvas.title === {self.robot.names[int(place)][0][0] + '?'!r} && hyselam.map.names.shown.get('{place}').kind === 'name'", "the name")
        self.shot(tab, "desktop_hover")

    def test_places_without_names_have_numbers_on_the_map(self):
        self.serve()
        tab = self.open_map(PHONE)
        kinds = tab.eval("[...new Set([...hyselam.map.names.shown.values()].map((s) => s.kind))]")
        self.assertEqual(kinds, ["number"])
        self.shot(tab, "phone_numbers")

    # ---- What is open has a button ----

    def test_places_that_fit_are_buttons_and_marked_on_the_map(self):
        self.serve()
        self.answers("Noted: There is a place called kitchen.", "3 answers fit equally well: I am not sure where kitchen may be.")
        tab = self.open_map(PHONE)
        self.robot.later(lambda: self.robot.world.set("candidates", {"kitchen": [3, 5, 7]}))
        tab.wait("hyselam.model.values.candidates", "where it may be")
        self.assertTrue(tab.eval("document.querySelector('#next').hidden"))  # nobody has asked
        self.say(tab, "There is a kitchen.")
        self.assertEqual(self.next(tab, "Where is the kitchen?"), ["Place 3", "Place 5", "Place 7", "Another place…"])
        self.assertEqual(tab.eval("hyselam.model.marked.ids"), [3, 5, 7])
        self.shot(tab, "phone_where")
        tab.click("#next [data-place='5']")
        wait_until(lambda: self.asked("name"), "the name")
        self.assertEqual(self.asked("name"), [{"place": 5, "names": ["kitchen"]}])
        self.robot.later(lambda: self.robot.world.set("candidates", {}))
        tab.wait("document.querySelector('#next').hidden && !hyselam.model.marked", "that nothing is open")
        self.assertEqual(tab.errors, [])

    def test_a_place_that_is_typed_answers_where_it_is(self):
        self.serve()
        self.robot.world.set("candidates", {"kitchen": [3, 5]})
        tab = self.open_map(PHONE)
        self.answers("I am not sure where kitchen may be.")
        self.say(tab, "There is a kitchen.")
        self.next(tab, "Where is the kitchen?")
        # An answer that is not understood leaves the question.
        self.answers("I did not understand 'Over yonder.': 'yonder' is no place.")
        self.say(tab, "Over yonder.")
        tab.wait("[...document.querySelectorAll('.said.robot')].pop().textContent.startsWith('I did not')", "the answer")
        self.next(tab, "Where is the kitchen?")
        for typed, told in (("It's place 5.", 'SS05 is "kitchen".'), ("It's number 5", 'SS05 is "kitchen".'), ("the first one, place 5", 'SS05 is "kitchen".'),
                            ("SS05", 'SS05 is "kitchen".'), ("No lugar 5.", 'SS05 é "kitchen".'), ("Acho que é o lugar 5", 'SS05 é "kitchen".'), ("Go to place 5", "Go to place 5"),
                            ("place 77", "place 77"), ("place 5 or 6", "place 5 or 6")):
            self.assertEqual(tab.eval(f'hyselam.next.answer("{typed}")'), told)
        self.answers("Thank you. SS05 is kitchen.")
        self.say(tab, "É a primeira, o lugar 5.")
        wait_until(lambda: self.asked("say")[-1] == {"text": 'SS05 é "kitchen".'}, lambda: self.asked("say")[-1])
        tab.wait("[...document.querySelectorAll('.said.human')].pop().textContent === 'É a primeira, o lugar 5.'", "what was typed")
        tab.wait("document.querySelector('#next').hidden", "that nothing is open")
        self.assertEqual(tab.eval("hyselam.next.answer('It is place 5')"), "It is place 5")  # nothing is asked
        self.assertEqual(tab.errors, [])

    def test_a_name_that_was_not_found_is_asked_about(self):
        self.serve()
        self.robot.world.set("candidates", {"lab": [4]})
        tab = self.open_map(PHONE)
        for language, answer in (("en", "I have not found the lab."), ("en", "I was told of the lab, but I have not found it on my map."), ("pt", "Não encontrei o lab.")):
            self.answers(answer)
            self.say(tab, "Where is the lab?")
            self.next(tab, "Where is the lab?")
            tab.click("#next .close")
            tab.wait("document.querySelector('#next').hidden", f"that it is put aside ({language})")

    def test_a_place_that_fits_can_be_tapped_on_the_map(self):
        self.serve()
        self.answers("I am not sure where kitchen may be.")
        self.robot.names[5] = [("library", True)]
        self.robot.world.set("candidates", {"kitchen": [3, 7]})
        tab = self.open_map(PHONE)
        self.say(tab, "There is a kitchen.")
        self.next(tab, "Where is the kitchen?")
        self.tap_place(tab, 7)
        tab.click("#card [data-key=this_is]")
        wait_until(lambda: self.asked("name") == [{"place": 7, "names": ["kitchen"]}], "the name")
        tab.wait("document.querySelector('#card').hidden", "no card")
        # What somebody has placed is not asked about, though the robot thinks that there may be another.
        self.robot.later(lambda: self.robot.world.set("candidates", {"kitchen": [3, 9], "archive": [3, 9]}))
        self.answers("I am not sure where kitchen and archive may be.")
        self.say(tab, "There is an archive.")
        self.next(tab, "Where is the archive?")
        # Another one than those: a name that somebody has confirmed there stays.
        tab.click("#next .pick")
        tab.wait("document.querySelector('#tool-bar').textContent.includes('Tap the place of archive')", "what to do")
        self.shot(tab, "phone_pick")
        self.tap_place(tab, 5)
        wait_until(lambda: len(self.asked("name")) == 2, "the name")
        self.assertEqual(self.asked("name")[1], {"place": 5, "names": ["library", "archive"]})
        tab.wait("document.querySelector('#tool-bar').hidden && document.querySelector('#card').hidden", "the end of it")

    def test_a_step_that_nobody_wants_is_put_aside(self):
        self.serve()
        self.answers("I am not sure where kitchen may be.")
        self.robot.world.set("candidates", {"kitchen": [3, 7]})
        tab = self.open_map(PHONE)
        self.say(tab, "There is a kitchen.")
        self.next(tab, "Where is the kitchen?")
        tab.click("#next .close")
        tab.wait("document.querySelector('#next').hidden", "that it is put aside")
        self.answers("I am at SS03.")
        self.say(tab, "Where are you?")
        tab.wait("document.querySelectorAll('.said.robot').length === 2", "the answer")
        self.assertTrue(tab.eval("document.querySelector('#next').hidden"))

    def test_no_is_followed_by_where_it_is_then(self):
        self.serve()
        for language, question, name, no, row in (("en-US", "Is SS12 John's office?", "John's office", "No.", "Where is John's office then?"),
                                                  ("pt-PT", "SS12 é gabinete do João?", "gabinete do João", "Não.", "Então onde fica gabinete do João?")):
            self.robot.names[12] = [(name, False)]
            self.robot.later(self.robot.show_places)
            self.answers("All right.")
            tab = self.open_map(PHONE, language=language)
            self.robot.later(lambda q=question, n=name: (self.robot.say("robot", q), self.robot.world.set("candidates", {n: [12, 14]})))
            tab.wait("!document.querySelector('#answers').hidden", "yes and no")
            tab.click("#no")
            tab.wait("document.querySelector('#answers').hidden", "that it is answered")
            wait_until(lambda n=no: {"text": n} in self.asked("say"), "no")
            self.assertEqual(len(self.next(tab, row)), 2)  # place 14, and any other
            self.shot(tab, f"phone_no_{language}")
            tab.click("#next .pick")
            tab.wait("!document.querySelector('#tool-bar').hidden", "what to do")
            self.tap_place(tab, 8)
            wait_until(lambda n=name: {"place": 8, "names": [n]} == (self.asked("name") or [None])[-1], "the name")
            tab.wait("document.querySelector('#next').hidden", "that nothing is open")
            self.robot.names.pop(8)
            self.assertEqual(tab.errors, [])

    def test_a_card_that_stays_the_same_is_not_made_anew_under_the_finger(self):
        self.serve()
        tab = self.open_map(PHONE)
        self.tap_place(tab, 5)
        tab.wait("!document.querySelector('#card').hidden", "the card")
        tab.eval("window.pressed = document.querySelector('#card [data-key=name_it]')")
        self.robot.names[9] = [("library", True)]
        self.robot.later(self.robot.show_places)
        tab.wait("hyselam.model.labelOf(9) === 'library'", "what has changed elsewhere")
        self.assertTrue(tab.eval("document.querySelector('#card [data-key=name_it]') === pressed"))
        self.robot.names[5] = [("kitchen", False)]
        self.robot.later(self.robot.show_places)
        tab.wait("document.querySelector('#card-title').textContent === 'kitchen?' && !document.contains(pressed)", "what has changed here")
        self.assertEqual(tab.errors, [])

    # ---- Slips of the pen ----

    def test_a_slip_of_the_pen_is_asked_about_in_both_languages(self):
        for language, wrong, answer, right, row in (
                ("en-US", "Where is the kichen?", "I know of no kichen.", "Where is the kitchen?", "Did you mean:"),
                ("en-US", "Go to the robotcis lab.", "I do not know the place robotcis lab.", "Go to the robotics lab.", "Did you mean:"),
                ("en-US", "This is the libary.", "Shall I call this place 'libary'?", "This is the library.", "Did you mean:"),
                ("pt-PT", "Onde está a cozinhha?", "Não sei nada de 'cozinhha'.", "Onde está a cozinha?", "Queria dizer:"),
                ("pt-PT", "Esta é a bibloteca.", "Devo chamar 'bibloteca' a este lugar?", "Esta é a biblioteca.", "Queria dizer:")):
            self.serve()  # anew: a person may not say much at once
            self.robot.world.set("names", ["robotics lab", "Maria's office"])
            self.answers(answer)
            tab = self.open_map(PHONE, language=language)
            self.say(tab, wrong)
            button = "#chips .offered" if answer.startswith(("Shall", "Devo")) else "#next .row button"  # below a yes and a no
            if button == "#next .row button":
                self.assertEqual(self.next(tab, row), [right])
            else:
                tab.wait(f"document.querySelector('#chips .offered')?.textContent === {row + ' ' + right!r}", "the sentence that was meant")
            self.answers("All right.")
            self.shot(tab, "phone_slip")
            tab.click(button)
            wait_until(lambda r=right: {"text": r} in self.asked("say"), right)
            tab.wait("document.querySelector('#next').hidden", "that nothing is open")
            self.served.close()

    def test_what_is_no_slip_is_not_asked_about(self):
        self.serve()
        self.robot.world.set("names", ["robotics lab"])
        tab = self.open_map(PHONE)
        for sentence, answer in (("Where is the kitchen?", "I know of no kitchen."), ("There is a wall.", "I did not understand 'There is a wall': why?"),
                                 ("On your left you have a libary.", "Noted: The libary is on the left."), ("Where is the aquarium?", "I know of no aquarium."),
                                 ("Where is the robot lab?", "I know of no robot lab.")):
            self.answers(answer)
            before = tab.eval("document.querySelectorAll('.said.robot').length")
            self.say(tab, sentence)
            tab.wait(f"document.querySelectorAll('.said.robot').length > {before}", answer)
            self.assertTrue(tab.eval("document.querySelector('#next').hidden"), sentence)

    def test_a_slip_is_seen_before_it_is_said(self):
        self.serve()
        tab = self.open_map(PHONE)
        tab.click("#say")
        tab.type("Where is the kichen")
        tab.wait("[...document.querySelectorAll('#chips button')].some((b) => b.textContent === 'kitchen')", "the word that was meant")
        tab.click("#chips button")
        self.assertEqual(tab.eval("document.querySelector('#say').value"), "Where is the kitchen")
        self.tap_place(tab, 7)
        tab.click("#card [data-key=name_it]")
        tab.type("libary")
        tab.click("#card .hint button")
        tab.wait("document.querySelector('#new-name').value === 'library'", "the word that was meant")
        tab.key("Enter")
        wait_until(lambda: self.asked("name") == [{"place": 7, "names": ["library"]}], "the name")

    # ---- Numbers instead of codes ----

    def test_no_code_of_the_map_is_shown_to_people(self):
        self.serve()
        self.robot.names[3] = [("library", False)]
        self.robot.show_places()
        self.robot.world.set_table("objects", {"1": {"k": "pen", "p": [], "c": [2.0, 2.0], "at": ["in", "SS01"]}})
        for language in ("en-US", "pt-PT"):
            tab = self.open_map(PHONE, language=language)
            for sentence in ("I am at SS05.", "Shall I go to perhaps library (SS03)?", "Next to SS05: corridor (CC11), SS04 and SS06.", "Estou em SS05.", "SS05 é biblioteca?"):
                self.robot.later(lambda s=sentence: self.robot.say("robot", s))
            self.tap_place(tab, 5)
            tab.wait("!document.querySelector('#card').hidden", "the card")
            self.assertIsNone(CODE.search(tab.eval(OPEN_LABELS)))
            tab.click("#card [data-key=ask_about]")
            tab.wait("document.querySelector('#card').hidden", "the question")
            for name in ("places", "robot", "talk"):
                tab.click(f"#tab-{name}")
                tab.wait(f"!document.querySelector('#panel-{name}').hidden", name)
                self.assertIsNone(CODE.search(tab.eval(OPEN_LABELS)), name)
            for expected in ("I am at place 5.", "Shall I go to perhaps library (place 3)?", "Next to place 5: corridor (place 11), place 4 and place 6.",
                             "Estou em lugar 5.", "Lugar 5 é biblioteca?"):
                tab.wait(f"[...document.querySelectorAll('.said.robot')].some((e) => e.textContent === {expected!r})", expected)
            self.assertEqual(tab.errors, [])

    def test_the_robot_is_told_of_places_by_their_numbers(self):
        self.serve()
        self.robot.world.set("names", ["place 7"])
        tab = self.open_map(PHONE)
        # One that the map does not have, or that people call so, is told as it was typed.
        self.assertEqual(tab.eval("hyselam.told('Go to place 999.')"), "Go to place 999.")
        for typed, told in (("Go to place 5.", "Go to SS05."), ("What is next to the place 11?", "What is next to CC11?"), ("Vá para o lugar 5.", "Vá para SS05."),
                            ("O que há ao lado do lugar 12?", "O que há ao lado de SS12?"), ("Go to place 7.", "Go to place 7.")):
            self.say(tab, typed)
            wait_until(lambda t=told: {"text": t} in self.asked("say"), told)

    def test_the_robot_tab_speaks_in_plain_words_and_folds_the_rest(self):
        self.serve()
        world = self.robot.world
        world.set("status", {"phase": "lost", "text": "match 0.21, 400 particles", "q": None})
        world.set("refused", "map: 3 cells are not 4 x 5")
        world.set_table("layers", {"topo_engine": {"level": "ok", "what": "dialogue", "text": "21 places"}, "slam": {"level": "error", "what": "", "text": "no scans on /scan"},
                                   "someones_driver": {"level": "stale", "what": "", "text": "/dev/ttyUSB0"}})
        self.robot.answer = lambda name, *_: {"findings": [{"level": "WRONG", "name": "tf", "text": "/tf has no frame base_link", "hint": "start /robot_state_publisher"},
                                                           {"level": "ok", "name": "clock", "text": "/clock", "hint": ""}]} if name == "doctor" else {}
        for language, layer, finding, fold in (("en-US", "Talks and keeps the names", "How its parts stand to each other: something is wrong.", "Details for technicians"),
                                               ("pt-PT", "Conversa e guarda os nomes", "Posição das partes entre si: há algo errado.", "Pormenores para técnicos")):
            tab = self.open_map(PHONE, language=language)
            tab.click("#tab-robot")
            tab.click("#do-check")
            tab.wait(f"document.querySelector('#panel-robot').innerText.includes({finding!r})", "what was found")
            seen = tab.eval("document.querySelector('#panel-robot').innerText")
            self.assertIn(layer, seen)
            self.assertIn("someones driver", seen)
            for technical in ("topo_engine", "/scan", "base_link", "/tf", "particles", "cells", "node", "topic"):
                self.assertNotIn(technical, seen)
            self.assertEqual(tab.eval("[...document.querySelectorAll('#panel-robot details:not([data-layer]) > summary')].map((s) => s.textContent)"), [fold] * 2)
            self.shot(tab, f"phone_robot_{language}")
            tab.click("#panel-robot details:not([data-layer]):last-of-type summary")
            for summary in range(2):
                tab.eval(f"document.querySelectorAll('#panel-robot details:not([data-layer])')[{summary}].open = true")
            opened = tab.eval("document.querySelector('#panel-robot').innerText")
            for technical in ("topo_engine: 21 places", "no scans on /scan", "start /robot_state_publisher", "3 cells are not 4 x 5", "400 particles"):
                self.assertIn(technical, opened)
            # What is opened stays so while it changes.
            self.robot.later(lambda n=language: world.set("status", {"phase": "lost", "text": f"match 0.3 {n}", "q": None}))
            tab.wait(f"document.querySelector('#panel-robot').innerText.includes('match 0.3 {language}')", "what has changed")
            world.set("status", {"phase": "lost", "text": "match 0.21, 400 particles", "q": None})
            self.assertEqual(tab.errors, [])

    # ---- The line that is typed into ----

    def test_the_line_grows_with_what_is_typed(self):
        self.serve()
        tab = self.open_map(PHONE)
        low = tab.eval("document.querySelector('#say').offsetHeight")
        tab.click("#say")
        tab.type("You are in the corridor. On your left you have John's office, then Mary's office, and at the end there is the kitchen.")
        tab.wait(f"document.querySelector('#say').offsetHeight > 2 * {low} - 10", "that it grows")
        self.assertTrue(tab.eval("(({scrollHeight, clientHeight}) => scrollHeight <= clientHeight + 1)(document.querySelector('#say'))"))
        self.shot(tab, "phone_long")
        tab.key("Enter", shift=True)
        self.assertEqual(self.asked("say"), [])
        tab.type("And a library.")
        tab.key("Enter")
        wait_until(lambda: self.asked("say"), "the sentence")
        self.assertIn("the kitchen. And a library.", self.asked("say")[0]["text"])
        tab.wait(f"document.querySelector('#say').value === '' && document.querySelector('#say').offsetHeight === {low}", "one line again")
        # Up goes through what was said.
        tab.key("ArrowUp")
        self.assertIn("And a library.", tab.eval("document.querySelector('#say').value"))
        tab.key("ArrowDown")
        self.assertEqual(tab.eval("document.querySelector('#say').value"), "")
        self.assertEqual(tab.errors, [])

    def test_portuguese_keeps_to_one_form(self):
        text = (PACKAGE / "www/js/i18n.js").read_text(encoding="utf-8")
        portuguese = text[text.index("  pt: {"):text.index("let language")]
        self.assertIn("Diga algo", portuguese)
        familiar = re.compile(r"\b(estás|tens|tua|teu|contigo|te|ti|vai|diz-me|esquece|desfaz|toca|arrasta|tenta|és|podes|queres|dizes)\b", re.IGNORECASE)
        self.assertEqual(familiar.findall(portuguese), [])


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_help_test", HelpTest)
