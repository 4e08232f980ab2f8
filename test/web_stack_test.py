#!/usr/bin/env python3
"""The page with the whole talk behind it, in a real browser: a person with a phone sees the map, describes the building, sees names land, answers a
question, sends the robot, sees the way, stops it. The master gone and back; roles; a server that would be open to all does not start."""
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import unittest
import xmlrpc.client

import rospkg
import rospy
import rostest
import yaml
from geometry_msgs.msg import PoseStamped
from hyselam_msgs.msg import ObjectRequest
from hyselam_msgs.srv import TellRobot, TellRobotResponse
from nav_msgs.msg import Path
from rosgraph_msgs.msg import Log
from std_msgs.msg import String

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(rospkg.RosPack().get_path("hyselam_web"), "test"))
from conversation_test import Robot, building
from devtools import Browser, DESKTOP, PHONE, STILL, program as browser_program
from faults_rig import program, run
from localization_rig import WAIT, free_port, wait_until
from pages import Pages, Socket

SHOTS = os.environ.get("HYSELAM_SHOTS", "")
STORY = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "scripts", "demo_story.txt")
CORRIDOR = (10.0, 8.0)  # in the office
with open(os.path.join(rospkg.RosPack().get_path("hyselam_sim"), "plans", "office.yaml"), encoding="utf-8") as plan:
    ROOMS = {place["name"]: place["at"] for place in yaml.safe_load(plan)["places"]}


class Server:
    """The server as roslaunch starts it, in the robot's namespace."""

    def __init__(self, namespace, environment=None, **params):
        params = dict({"port": 0, "base_frame": namespace + "_base"}, **params)
        arguments = [f"_{name}:={value}" for name, value in params.items()]
        # What a server that is killed leaves behind goes with the test.
        self.environment = dict(os.environ, ROS_NAMESPACE=namespace, TMPDIR=WebStackTest.folder.name, **(environment or {}))
        self.process = subprocess.Popen([program("hyselam_web", "server"), "__name:=web", *arguments], env=self.environment)
        self.namespace, self.port = namespace, 0

    def wait(self):
        name = f"/{self.namespace}/web/bound_port"
        wait_until(lambda: rospy.has_param(name) or self.process.poll() is not None, "the server does not start")
        self.port = rospy.get_param(name)
        return self

    @property
    def address(self):
        return f"http://localhost:{self.port}"

    def close(self):
        self.process.terminate()
        self.process.wait(WAIT)
        if rospy.has_param(f"/{self.namespace}/web/bound_port"):
            rospy.delete_param(f"/{self.namespace}/web/bound_port")


class WebStackTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.record = os.path.join(cls.folder.name, "web")
        cls.robot = Robot("phone", building(cls.folder.name, "office"))
        assert cls.robot.loaded
        wait_until(lambda: cls.robot.maps.messages, "no map")
        cls.robot.stand(*CORRIDOR)
        cls.server = Server("phone", record=cls.record).wait()

    @classmethod
    def tearDownClass(cls):
        cls.server.close()
        cls.robot.close()

    def places(self):
        return self.robot.maps.messages[-1].places

    def confirmed(self):
        return {w.text for p in self.places() for w in p.words if w.confirmed}

    @unittest.skipUnless(browser_program(), "Chromium is not installed (scripts/deps)")
    def test_a_person_with_a_phone_describes_answers_sends_and_stops(self):
        browser = Browser()
        self.addCleanup(browser.close)
        tab = browser.tab(PHONE, ratio=2)
        tab.goto(self.server.address)
        tab.wait("window.hyselam && hyselam.map.drawnTiles > 0 && hyselam.model.values.pose && Object.keys(hyselam.model.tables.places).length > 5", "the map")

        def say(text):
            tab.click("#say")
            tab.type(text)
            tab.key("Enter")

        self.addCleanup(lambda: print("the talk:", *(f"{e['w']}: {e['s']}" for e in tab.eval("hyselam.model.talk")), sep="\n  "))
        with open(STORY, encoding="utf-8") as file:
            say(file.read().strip())
        tab.wait("document.querySelector('#talk-log').textContent.includes('Noted:')", "what it understood")
        tab.wait("['reception', 'kitchen', 'library', 'workshop'].every(n => Object.keys(hyselam.model.tables.places).some(id => hyselam.model.nameOf(id).text === n))",
                 "the names on the map")
        self.shot(tab, "stack_names")
        # Of a name that fits several places these are buttons, and marked on the map.
        tab.wait("!document.querySelector('#next').hidden && document.querySelectorAll('#next [data-place]').length > 1", "where it may be")
        tab.wait("hyselam.model.marked.ids.length > 1 && hyselam.model.marked.ids.every(id => hyselam.model.place(id))", "these places on the map")
        name = tab.eval("hyselam.model.marked.name")
        self.shot(tab, "stack_where")
        # The person knows where it is: by its button, or, where five others are nearer, by a tap on the map.
        right = tab.eval(f"hyselam.model.placeAt(...{ROOMS[name]})")
        if tab.eval(f"document.querySelector('#next [data-place=\"{right}\"]') !== null"):
            tab.click(f"#next [data-place='{right}']")
        else:
            tab.click("#next .pick")
            tab.wait("!document.querySelector('#tool-bar').hidden", "what to do")
            self.tap(tab, right, card=False)
        wait_until(lambda: name in self.confirmed(), f"{name} is not confirmed")
        tab.wait(f"hyselam.model.marked?.name !== {name!r} && hyselam.model.confirmedNames({right}).includes({name!r})", "that it is no longer asked")
        tab.wait(f"document.querySelector('.undo')?.textContent === {'Undo: ' + name!r}", "what undo takes back")
        # A guess is confirmed by tapping its place.
        kitchen = tab.eval("Object.keys(hyselam.model.tables.places).find(id => hyselam.model.nameOf(id).text === 'kitchen')")
        if not tab.eval(f"hyselam.model.nameOf({kitchen}).sure"):
            self.tap(tab, kitchen)
            tab.click("#card button.primary")
            wait_until(lambda: "kitchen" in self.confirmed(), "the kitchen is not confirmed")
            tab.wait(f"document.querySelector('#card').hidden && hyselam.model.nameOf({kitchen}).sure", "the confirmed name")
        # It is sent there, asks or goes; the way is shown.
        self.tap(tab, kitchen)
        tab.click("#card [data-key=go_there]")
        tab.wait("(hyselam.model.values.way ?? []).length > 1 || !document.querySelector('#answers').hidden", "the way, or a question")
        if tab.eval("!document.querySelector('#answers').hidden"):
            tab.click("#yes")
        tab.wait("(hyselam.model.values.way ?? []).length > 1", "the way")
        self.shot(tab, "stack_way")
        wait_until(lambda: self.robot.paths.messages[-1].poses, "no way")
        tab.click("#stop")
        wait_until(lambda: not self.robot.paths.messages[-1].poses, "it has not stopped")
        tab.wait("(hyselam.model.values.way ?? []).length === 0", "the end of the way")
        tab.wait("document.querySelector('.carry-on')?.textContent === 'Carry on to the kitchen'", "the way that goes on")
        # Driven into a room with a guessed name it asks; the person answers with a button.
        there = next(p for p in self.places() if any(w.text == "library" for w in p.words))
        self.robot.stand(there.centre.x, there.centre.y)
        tab.wait("!document.querySelector('#answers').hidden && hyselam.model.values.asked.text.includes('library')", "the question")
        self.shot(tab, "stack_question")
        tab.click("#yes")
        wait_until(lambda: "library" in self.confirmed(), "the library is not confirmed")
        self.robot.stand(*CORRIDOR)
        # Portuguese, and back.
        say("Onde está?")
        tab.wait("document.querySelector('#talk-log').textContent.includes('Estou em lugar')", "the answer in Portuguese")
        say("Where are you?")
        self.assertEqual([e for e in tab.errors], [])
        desktop = browser.tab(DESKTOP)
        desktop.goto(self.server.address)
        desktop.wait("hyselam.map.labels > 3 && hyselam.map.drawnTiles > 0", "the map")
        self.shot(desktop, "stack_desktop")

    @unittest.skipUnless(browser_program(), "Chromium is not installed (scripts/deps)")
    def test_ten_places_are_named_and_two_are_gone_to_with_the_page_alone(self):
        """As somebody does who has a phone and no manual: says what is there, presses what is offered, taps the rest."""
        robot = Robot("visitor", building(self.folder.name, "office"))
        self.addCleanup(robot.close)
        wait_until(lambda: robot.maps.messages, "no map")
        robot.stand(*CORRIDOR)
        server = Server("visitor").wait()
        self.addCleanup(server.close)
        browser = Browser()
        self.addCleanup(browser.close)
        tab = browser.tab(PHONE, ratio=2)
        tab.goto(server.address)
        tab.wait("window.hyselam && hyselam.map.drawnTiles > 0 && hyselam.model.values.pose && Object.keys(hyselam.model.tables.places).length > 5", "the map")
        self.addCleanup(lambda: print("the talk:", *(f"{e['w']}: {e['s']}" for e in tab.eval("hyselam.model.talk")), sep="\n  "))

        def say(text):
            answers = tab.eval("hyselam.model.talk.length")
            tab.click("#say")
            tab.type(text)
            tab.key("Enter")
            tab.wait(f"hyselam.model.talk.slice({answers}).some((e) => e.w === 'robot')", f"an answer to {text}")

        def confirmed():
            return {w.text for p in robot.maps.messages[-1].places for w in p.words if w.confirmed}

        say("You are in the corridor. There is a kitchen, a library and an archive.")
        # Each that may be in several places has buttons; the person knows where it is, or taps the map.
        for turn in range(3):
            tab.wait("!document.querySelector('#next').hidden", "where it may be")
            name, places = tab.eval("[hyselam.model.marked.name, hyselam.model.marked.ids]")
            if turn == 0:
                tab.click(f"#next [data-place='{places[-1]}']" if len(places) <= 5 else "#next [data-place]")
            else:
                tab.click("#next .pick")
                tab.wait("!document.querySelector('#tool-bar').hidden", "what to do")
                free = tab.eval("Object.keys(hyselam.model.tables.places).find((id) => hyselam.model.place(id).k === 0 && !hyselam.model.nameOf(id).sure)")
                self.tap(tab, free, card=False)
            wait_until(lambda: name in confirmed(), f"{name} is not confirmed")
            tab.wait(f"hyselam.model.marked?.name !== {name!r}", "the next one")
            tab.wait(f"Object.keys(hyselam.model.tables.places).some((id) => hyselam.model.confirmedNames(id).includes({name!r}))", f"{name} on the page")
            if tab.eval("document.querySelector('#next').hidden"):
                break
        # The others are named by tapping and typing, one of them with a slip.
        wanted = [n for n in ("kitchen", "library", "archive", "John's office", "Mary's office", "meeting room", "workshop", "toilet", "reception", "server room", "canteen")
                  if n not in confirmed()]
        for name in wanted:
            free = tab.eval("Object.keys(hyselam.model.tables.places).find((id) => hyselam.model.place(id).k === 0 && !hyselam.model.nameOf(id).sure)")
            self.tap(tab, free)
            tab.click("#card [data-key=name_it], #card [data-key=wrong_name]")
            tab.wait("document.querySelector('#new-name')", "the line for the name")
            tab.eval("document.querySelector('#new-name').value = ''")
            tab.type("worksop" if name == "workshop" else name)
            if name == "workshop":
                tab.click("#card .hint button")
            tab.click("#card form button.primary")
            wait_until(lambda: name in confirmed(), f"{name} is not confirmed: {confirmed()}")
            tab.wait(f"Object.keys(hyselam.model.tables.places).some((id) => hyselam.model.confirmedNames(id).includes({name!r}))", f"{name} on the page")
            tab.wait("document.querySelector('#card').hidden", "that the card is done with")
        self.assertGreaterEqual(len(confirmed()), 10)
        # A slip in a question: the button says what was meant, and it is answered.
        say("Where is the libary?")
        tab.click("#next .row button")
        tab.wait("/^(the )?library is (place|lugar) \\d+/i.test([...document.querySelectorAll('.said.robot')].pop().textContent)", "where the library is")
        self.shot(tab, "stack_ten_names")
        for way_to in ("button", "sentence"):
            if way_to == "button":
                library = tab.eval("Object.keys(hyselam.model.tables.places).find((id) => hyselam.model.nameOf(id).text === 'library')")
                self.tap(tab, library)
                tab.click("#card [data-key=go_there]")
            else:
                say("Go to the workshop.")
            tab.wait("(hyselam.model.values.way ?? []).length > 1", "the way")
            tab.click("#stop")
            tab.wait("(hyselam.model.values.way ?? []).length === 0", "the end of the way")
        self.assertEqual(tab.errors, [])

    def tap(self, tab, place, card=True):
        x, y = tab.wait(STILL % f"() => {{ const c = hyselam.model.place({place}).c, p = hyselam.map.toScreen(...c), b = hyselam.map.canvas.getBoundingClientRect(); "
                        "return [p[0] + b.x, p[1] + b.y]; }", "that the map lies still")
        tab.press(x, y)
        if card:
            tab.wait(f"!document.querySelector('#card').hidden && hyselam.map.selected === '{place}'", f"the card of place {place}")

    def shot(self, tab, name):
        if SHOTS:
            tab.picture(os.path.join(SHOTS, name + ".png"))

    def test_places_are_named_walls_drawn_and_doors_shut_by_requests(self):
        pages = Pages()
        self.addCleanup(pages.close)
        page = Socket(pages, self.server)
        self.addCleanup(page.close)
        wait_until(lambda: "places" in page.state and page.tiles and "map" in page.state, "the map")
        room = next(p for p in self.places() if p.kind == 0)
        self.assertEqual(page.ask("name", place=room.id, names=["Ana's room"])["done"], "name")
        wait_until(lambda: "Ana's room" in self.confirmed(), "the name")
        self.assertEqual(page.ask("name", place=room.id, names=[])["done"], "name")
        wait_until(lambda: "Ana's room" not in self.confirmed(), "the name is not forgotten")
        self.assertEqual(page.ask("name", place=4000000, names=["x"])["error"], "unknown")
        page.ask("here", place=room.id)
        wait_until(lambda: self.robot.initial.messages, "no pose was set")
        before = len(self.robot.initial.messages)
        answer = page.ask("pose", x=1.0, y=1.2, yaw=1.57)
        self.assertEqual(answer["done"], "pose")
        wait_until(lambda: len(self.robot.initial.messages) > before, "the pose was not sent")
        self.assertAlmostEqual(self.robot.initial.messages[-1].pose.pose.position.x, 1.0)
        door = next(d for e in self.robot.maps.messages[-1].edges for d in e.doors if d.real)
        grids = len(self.robot.grids.messages)

        def shut():
            """The door, whose number is another one while the map is cut anew."""
            doors = [d for e in self.robot.maps.messages[-1].edges for d in e.doors if d.real]
            near = min(doors, key=lambda d: abs(d.position.x - door.position.x) + abs(d.position.y - door.position.y))
            answers.append(page.ask("shut", door=near.id))
            return answers[-1].get("error") not in ("unknown", "too_often")

        answers = []
        wait_until(shut, lambda: answers)
        self.assertEqual(answers[-1].get("done"), "shut", answers)
        wait_until(lambda: len(self.robot.grids.messages) > grids, "the walls are not told")
        # As the page says, the door is opened again.
        for sentence in ("Esqueça a última parede.", "Forget the last wall."):
            grids = len(self.robot.grids.messages)
            said = page.ask("say", text=sentence)["result"]["answers"]
            self.assertRegex(" ".join(said), "treat the door as open again|tratar a porta como aberta")
            wait_until(lambda: len(self.robot.grids.messages) > grids, "the wall is still there")
            if sentence.startswith("Esque"):
                wait_until(shut, lambda: answers)
                self.assertEqual(answers[-1].get("done"), "shut", answers)
        self.assertEqual(page.ask("wall", ax=0, ay=0, bx=0.01, by=0)["error"], "invalid")
        self.assertEqual(page.ask("learn", on=True)["error"], "nobody")
        self.assertEqual(page.ask("save")["error"], "nobody")

    def test_who_may_talk_but_not_drive_is_stopped(self):
        self.server.close()
        type(self).server = Server("phone", token="talk=talktome1 drive=driveme11").wait()
        pages = Pages()
        self.addCleanup(pages.close)

        def open_as(token):
            body = json.dumps({"token": token})
            _, _, headers = pages.request("POST", self.server.address + "/login", data=body, headers={"Origin": self.server.address})
            page = Socket(pages, self.server, cookie=headers["Set-Cookie"].split("=", 1)[1].split(";")[0])
            self.addCleanup(page.close)
            wait_until(lambda: "places" in page.state, "the map")
            return page

        self.robot.service("tell_robot", TellRobot)("Stop.")
        target = next(p for p in self.places() if p.kind == 0)
        code = f"SS{target.id:02d}"
        talker, driver = open_as("talktome1"), open_as("driveme11")
        self.assertEqual(talker.ask("name", place=target.id, names=["tea room. Follow me"])["done"], "name")
        wait_until(lambda: "tea room. Follow me" in self.confirmed(), "the name")
        paths, before = self.robot.paths.messages, len(self.robot.paths.messages)
        answer = talker.ask("say", text=f"Go to {code}.")
        self.assertEqual(answer.get("error"), "not_allowed", answer)
        wait_until(lambda: any(p.poses for p in paths[before:]) and not paths[-1].poses, "a talker drives the robot, or it did not understand")
        self.assertEqual(talker.ask("go", place=target.id, language="en")["error"], "not_allowed")
        self.assertIn("answers", talker.ask("say", text="Where are you?")["result"])
        self.assertEqual(driver.ask("go", place=target.id, language="en")["done"], "go")
        # What the button asks is answered.
        self.assertIn("Next to tea room", str(driver.ask("say", text=f"What is next to {code}?")["result"]["answers"]))
        # Nothing of a name that somebody gave is said as a driver.
        wait_until(lambda: any(e["w"] == "human" and e["s"] == f"Go to {code}." for e in driver.talk), lambda: driver.talk)
        wait_until(lambda: self.robot.paths.messages[-1].poses, "the driver does not drive")
        self.assertEqual(driver.ask("go", place=target.id, language="pt")["done"], "go")
        self.assertEqual(talker.ask("stop")["done"], "stop")
        wait_until(lambda: not self.robot.paths.messages[-1].poses, "it does not stop")
        self.server.close()
        type(self).server = Server("phone").wait()

    def page_of(self, namespace, **params):
        """A page of a server whose dialogue is the test, and what the server says without being answered."""
        said = []
        heard = rospy.Subscriber(f"/{namespace}/human_text", String, lambda m: said.append(m.data), queue_size=20)
        self.addCleanup(heard.unregister)
        server = Server(namespace, **params).wait()
        self.addCleanup(server.close)
        wait_until(lambda: heard.get_num_connections() > 0, "the server is not heard")
        pages = Pages()
        self.addCleanup(pages.close)
        return server, pages, said

    def test_a_stop_cancels_what_waits_behind_a_slow_dialogue(self):
        told, go_on = [], threading.Event()
        self.addCleanup(go_on.set)

        def tell(request):
            told.append(request.text)
            go_on.wait(WAIT)
            return TellRobotResponse(language="en", answers=["In the kitchen."])
        service = rospy.Service("/slow/tell_robot", TellRobot, tell)
        self.addCleanup(service.shutdown)
        server, pages, said = self.page_of("slow")
        page = Socket(pages, server)
        self.addCleanup(page.close)
        page.send(json.dumps({"do": "say", "n": 101, "text": "Where are you?"}))
        page.send(json.dumps({"do": "say", "n": 102, "text": "Go to SS05."}))
        wait_until(lambda: told, "the first sentence is not told")
        self.assertEqual(page.ask("stop")["result"], {"heard": 1})
        go_on.set()
        wait_until(lambda: 101 in page.answers and 102 in page.answers, "no answers")
        self.assertEqual((page.answers[101][0].get("done"), page.answers[102][0].get("error")), ("say", "stopped"))
        self.assertEqual(told, ["Where are you?"])
        wait_until(lambda: said == ["Stop.", "Stop."], lambda: f"it is stopped once more after what it was being told: {said}")

    def test_a_way_that_comes_of_a_late_answer_about_a_thing_is_stopped(self):
        requests = rospy.Publisher("/later/object_request", ObjectRequest, queue_size=1)
        ways = rospy.Publisher("/later/goal_path", Path, queue_size=1)
        self.addCleanup(requests.unregister)
        self.addCleanup(ways.unregister)

        def tell(_):
            requests.publish(ObjectRequest(text="Fetch the pen."))
            threading.Timer(1.5, lambda: ways.publish(Path(poses=[PoseStamped()]))).start()
            return TellRobotResponse(language="en")
        service = rospy.Service("/later/tell_robot", TellRobot, tell)
        self.addCleanup(service.shutdown)
        server, pages, said = self.page_of("later", token="talk=talktome1 drive=driveme11")
        wait_until(lambda: requests.get_num_connections() and ways.get_num_connections(), "the server does not listen")
        _, _, headers = pages.request("POST", server.address + "/login", data='{"token":"talktome1"}', headers={"Origin": server.address})
        page = Socket(pages, server, cookie=headers["Set-Cookie"].split("=", 1)[1].split(";")[0])
        self.addCleanup(page.close)
        self.assertEqual(page.ask("say", text="Fetch the pen.").get("error"), "not_allowed")
        wait_until(lambda: said == ["Stop."], lambda: f"it is not stopped: {said}")

    def test_all_who_ask_the_doctor_at_once_get_one_examination(self):
        calls = os.path.join(self.folder.name, "calls")
        folder = os.path.join(self.folder.name, "bin")
        os.makedirs(folder)
        with open(os.path.join(folder, "rosrun"), "w") as file:  # instead of five seconds of the real one
            file.write(f"#!/bin/sh\necho called >> {calls}\nsleep 2\nwhile [ \"$1\" != --json ]; do shift; done\n"
                       "echo '{\"findings\": []}' > \"$2\"\n")
        os.chmod(os.path.join(folder, "rosrun"), 0o755)
        server, pages, _ = self.page_of("examined", environment={"PATH": folder + os.pathsep + os.environ["PATH"]})
        page = Socket(pages, server)
        self.addCleanup(page.close)
        for n in (101, 102):
            page.send(json.dumps({"do": "doctor", "n": n}))
        wait_until(lambda: 101 in page.answers and 102 in page.answers, "no findings")
        self.assertEqual([page.answers[n][0].get("result") for n in (101, 102)], [{"findings": []}] * 2)
        with open(calls) as file:
            self.assertEqual(file.read().split(), ["called"])

    def test_a_server_that_would_be_open_does_not_start(self):
        for argument, reason in (("_host:=0.0.0.0", "Give a token"), ("_token:=short", "fewer than 8"), ("_token:=boss=longenough", "the role 'boss'"),
                                 ("_token_file:=/nowhere/tokens", "No such file"), ("_language:=fr", "en or pt"), ("_port:=70000", "[0, 65535]"),
                                 ("_certificate:=/nowhere/cert.pem", "No such file")):
            code, text = run(program("hyselam_web", "server"), "__name:=refused", argument, ROS_NAMESPACE="refused")
            self.assertEqual(code, 2, text)
            self.assertIn(reason, text)
            name = argument[1:].split(":=")[0]
            if rospy.has_param(f"/refused/refused/{name}"):
                rospy.delete_param(f"/refused/refused/{name}")

    def test_master_gone_and_back(self):
        port = free_port()
        environment = {"ROS_MASTER_URI": f"http://localhost:{port}"}

        def start_master():
            process = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

            def answers():
                with socket.socket() as s:
                    return s.connect_ex(("localhost", port)) == 0
            wait_until(answers, "no master")
            return process

        def end(process):
            process.kill()
            process.wait()
        master = start_master()
        proxy = xmlrpc.client.ServerProxy(environment["ROS_MASTER_URI"])
        server = Server("alone", environment=environment)
        self.addCleanup(lambda: end(server.process))
        wait_until(lambda: proxy.hasParam("/test", "/alone/web/bound_port")[2], "the server does not start")
        server.port = proxy.getParam("/test", "/alone/web/bound_port")[2]
        pages = Pages()
        self.addCleanup(pages.close)
        page = Socket(pages, server)
        self.addCleanup(page.close)
        wait_until(lambda: page.state.get("reach") == {"master": True}, "the page")
        end(master)
        wait_until(lambda: page.state.get("reach") == {"master": False}, "the page does not show that the master is gone")
        master = start_master()
        self.addCleanup(lambda: end(master))
        wait_until(lambda: any(t == "/alone/conversation" and "/alone/web" in nodes for t, nodes in proxy.getSystemState("/test")[2][1]), "not registered again")
        wait_until(lambda: page.state.get("reach") == {"master": True}, "the page does not show that the master is back")
        # Who publishes now is heard: the page goes on.
        talker = subprocess.Popen(["rostopic", "pub", "-r", "2", "/alone/conversation", "std_msgs/String", "data: 'robot: I am back.'"],
                                  env=dict(os.environ, **environment), stdout=subprocess.DEVNULL)
        self.addCleanup(lambda: end(talker))
        wait_until(lambda: any(e["s"] == "I am back." for e in page.talk), "what is published after the restart is not heard")
        self.assertIsNone(page.code)

    def test_a_topic_of_another_type_is_left_out(self):
        warnings = []
        log = rospy.Subscriber("/rosout", Log, lambda m: warnings.append(m.msg), queue_size=100)
        self.addCleanup(log.unregister)
        wait_until(lambda: log.get_num_connections() > 0, "no log")
        publisher = rospy.Publisher("/phone/object_map", String, queue_size=1, latch=True)
        publisher.publish(String(data="no map"))
        wait_until(lambda: any("object_map is a std_msgs/String" in w for w in warnings), "it is not said what is wrong")
        pages = Pages()
        self.addCleanup(pages.close)
        page = Socket(pages, self.server)
        self.addCleanup(page.close)
        wait_until(lambda: "places" in page.state, "the map")
        self.assertIn("done", page.ask("say", text="Where are you?"))
        self.assertNotIn("objects", page.state)
        publisher.unregister()

    def test_the_recording_is_a_page_at_the_end(self):
        record = os.path.join(self.folder.name, "recorded")
        server = Server("recorded", record=record).wait()
        day = pathlib.Path(record, "day.jsonl")
        wait_until(lambda: '"d":' in day.read_text(), "nothing is recorded")
        server.close()
        self.assertEqual(server.process.returncode, 0)
        with open(os.path.join(record, "index.html")) as file:
            self.assertRegex(file.read(), r'<script>window\.HYSELAM_RECORDING=\[\{"t":')


if __name__ == "__main__":
    rospy.init_node("web_stack_test")
    rostest.rosrun("hyselam_bringup", "web_stack_test", WebStackTest)
