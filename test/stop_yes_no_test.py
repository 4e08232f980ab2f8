#!/usr/bin/env python3
"""200 ways to say stop, cancel, yes and no (stop_yes_no.yaml): with nothing asked, with a question open, and stop and
cancel while the robot drives. All are obeyed, none becomes a name, none reaches the node that handles objects."""
import math
import os
import tempfile
import threading
import unittest

import rospy
import rostest
import yaml
from hyselam_msgs.msg import ObjectRequest
from hyselam_msgs.srv import StatePath, TellRobot
from nav_msgs.msg import Path

from conversation_test import MIDDLE, Robot, building
from localization_rig import Listener, WAIT, wait_until

WAYS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "stop_yes_no.yaml")
SPEED = 2.0  # m/s
STEP = 0.02  # s


class StopYesNoTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(WAYS, encoding="utf-8") as file:
            cls.ways = yaml.safe_load(file)
        cls.folder = tempfile.TemporaryDirectory()
        cls.robot = Robot("ways", building(cls.folder.name), ask="never")
        assert cls.robot.loaded
        # Somebody listens for sentences about objects.
        cls.requests = Listener("/ways/object_request", ObjectRequest)
        wait_until(lambda: cls.robot.maps.messages, "no map")
        wait_until(lambda: cls.requests.subscriber.get_num_connections() > 0, "nothing is passed on")
        cls.tell = cls.robot.service("tell_robot", TellRobot)
        cls.load = cls.robot.service("load_dialogue", StatePath)
        cls.robot.stand(*MIDDLE["corridor"])
        cls.say("You are in the corridor. On your left you have room 109.")
        cls.way, cls.driven, cls.lock = [], 0, threading.Lock()
        cls.drive_timer = rospy.Timer(rospy.Duration(STEP), lambda _: cls.drive())
        cls.goals = rospy.Subscriber("/ways/goal_path", Path, cls.take_way)
        # Where room 109 was guessed, the robot asks about it when it is asked where it is.
        guessed = next(p for p in cls.robot.maps.messages[-1].places if any("109" in w.text for w in p.words))
        cls.there = next(name for name in MIDDLE if cls.robot.place_at(name).id == guessed.id)
        cls.saved = os.path.join(cls.folder.name, "saved")
        assert cls.robot.service("save_dialogue", StatePath)(cls.saved).success

    @classmethod
    def tearDownClass(cls):
        cls.drive_timer.shutdown()
        cls.goals.unregister()
        cls.requests.close()
        cls.robot.close()

    # ---- A robot that drives ----

    @classmethod
    def take_way(cls, msg):
        with cls.lock:
            cls.way = [(p.pose.position.x, p.pose.position.y) for p in msg.poses]

    @classmethod
    def drive(cls):
        """Along the way, as long as there is one."""
        with cls.lock:
            if not cls.way:
                return
            x, y, _ = cls.robot.pose
            (gx, gy), left = cls.way[0], SPEED * STEP
            distance = math.hypot(gx - x, gy - y)
            if distance <= left:
                cls.robot.pose = (gx, gy, 0.0)
                cls.way = cls.way[1:]
            else:
                cls.robot.pose = (x + left * (gx - x) / distance, y + left * (gy - y) / distance, 0.0)
            cls.driven += 1

    # ---- What is said ----

    @classmethod
    def say(cls, text):
        return " ".join(cls.tell(text).answers)

    def again(self, place):
        """As it was in the beginning; nothing is asked."""
        with self.lock:
            type(self).way = []
        self.assertTrue(self.load(self.saved).success)
        self.robot.stand(*MIDDLE[place])

    def names(self):
        return {p.id: [(w.text, w.confirmed) for w in p.words] for p in self.robot.maps.messages[-1].places}

    def asked_about_name(self):
        self.again(self.there)
        self.assertIn("room 109", self.say("Where are you?"))
        self.assertTrue(self.is_asking())

    def is_asking(self):
        """Pardon? shows an open question again."""
        return self.say("Pardon?").endswith("?")

    def expect_no_request(self, text):
        self.assertEqual([m.text for m in self.requests.messages if not m.end_question], [], text)

    def each(self, *kinds):
        for kind in kinds:
            for text in self.ways[kind]:
                yield kind, text
                self.expect_no_request(text)

    # ---- Tests ----

    def test_there_are_200_ways(self):
        self.assertEqual(sum(len(ways) for ways in self.ways.values()), 200)

    def test_stop_and_cancel_while_it_drives(self):
        self.again("corridor")
        before = self.names()
        for kind, text in self.each("stop", "cancel"):
            self.robot.pose = (*MIDDLE["corridor"], 0.0)
            self.say("Go to room 109.")
            if not self.way:
                self.say("Yes.")  # it was not sure
            driven = self.driven
            wait_until(lambda: self.driven > driven and self.way, f"it does not drive before '{text}'")
            said = self.say(text)
            wait_until(lambda: not self.way, f"'{text}' does not stop it: {said}")
            with self.lock:
                driven = self.driven
            self.assertRegex(said, r"^(I have stopped|All right|Parei|Está bem)", text)
            self.assertFalse(said.endswith("?"), (text, said))
            rospy.sleep(2 * STEP)
            self.assertEqual(self.driven, driven, text)
            self.assertEqual(kind == "stop", "top" in said or "Parei" in said, (text, said))
        self.assertEqual(self.names(), before)

    def test_stop_and_cancel_end_a_question(self):
        self.asked_about_name()
        before = self.names()
        for _, text in self.each("stop", "cancel"):
            self.say("Robot, where are you?")
            said = self.say(text)
            self.assertRegex(said, r"^(I have stopped|All right|Parei|Está bem)", text)
            self.assertEqual(self.say("Yes."), "All right.", text)  # nothing is asked any more
        self.assertEqual(self.names(), before)

    def test_with_nothing_asked_nothing_is_named(self):
        self.again("corridor")
        before = self.names()
        for _, text in self.each("stop", "cancel", "yes", "no"):
            said = self.say(text)
            self.assertRegex(said, r"^(I have stopped\.|All right\.|Parei\.|Está bem\.)( I have not taken '.*'\.)?$", text)
        self.assertEqual(self.names(), before)

    def test_yes_confirms_and_no_rejects_what_was_asked(self):
        for kind, text in self.each("yes", "no"):
            self.again(self.there)
            self.assertIn("room 109", self.say("Robot, where are you?"))
            said = self.say(text)
            words = self.robot.place_at(self.there).words
            if kind == "yes":
                wait_until(lambda: any(w.confirmed for w in self.robot.place_at(self.there).words),
                           lambda: f"'{text}' confirms nothing: {said}")
                words = self.robot.place_at(self.there).words
                self.assertEqual([w.text for w in words], ["room 109"], text)
            else:
                self.assertRegex(said, r"\?$", (text, said))  # what it is called instead
                self.assertFalse(any(w.confirmed for w in words), text)

    def test_a_name_is_asked_for_and_none_of_them_is_one(self):
        for _, text in self.each("stop", "cancel", "no"):
            self.again(self.there)
            self.say("Robot, where are you?")
            self.say("No.")
            self.say(text)
            words = [w.text for w in self.robot.place_at(self.there).words if w.confirmed]
            self.assertEqual(words, [], text)


if __name__ == "__main__":
    rospy.init_node("stop_yes_no_test")
    rospy.wait_for_service("/manager/load_nodelet", WAIT)
    rostest.rosrun("hyselam_bringup", "stop_yes_no", StopYesNoTest)
