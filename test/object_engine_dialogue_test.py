#!/usr/bin/env python3
"""One conversation about places and objects: TopoEngine passes on to ObjectEngine what is not about places."""
import math
import tempfile
import unittest

import rospy
import rostest
from hyselam_msgs.msg import ObjectAnswer, ObjectMap, ObjectRequest
from hyselam_msgs.srv import TellRobot
from nodelet.srv import NodeletLoad, NodeletUnload
from std_msgs.msg import String

from conversation_test import MIDDLE, Robot, building
from localization_rig import Listener, WAIT, wait_until


class ObjectDialogueTest(unittest.TestCase):
    cases = 0

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.grid = building(cls.folder.name)

    def setUp(self):
        ObjectDialogueTest.cases += 1
        self.name = f"objects_{self.cases}"

    def robot(self, with_objects=True, **params):
        robot = Robot(self.name, self.grid, ask="never", **params)
        self.addCleanup(robot.close)
        self.assertTrue(robot.loaded)
        self.talk = Listener(f"/{self.name}/conversation", String)
        self.addCleanup(self.talk.close)
        if with_objects:
            load = rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)
            engine = f"/{self.name}/object_engine"
            # The names of the rooms come with the dialogue's map.
            self.assertTrue(load(engine, "hyselam_objects/ObjectEngine", [f"/{self.name}/topological_map", "/diagnostics"],
                                 [f"/{self.name}/named_map", f"/{self.name}/object_diagnostics"], [], "").success)
            self.addCleanup(lambda: rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)(engine))
            objects = Listener(f"/{self.name}/object_map", ObjectMap)
            self.addCleanup(objects.close)
            wait_until(lambda: objects.messages, "no objects")
        wait_until(lambda: self.talk.subscriber.get_num_connections() > 0, "nobody talks")
        wait_until(lambda: robot.maps.messages, "no map")
        return robot

    def test_rooms_and_objects_in_one_conversation(self):
        robot = self.robot()
        robot.stand(*MIDDLE["i-109"])
        self.assertIn("John's office", robot.say("This is John's office."))
        robot.stand(*MIDDLE["corridor"])
        robot.say("This is the corridor.")
        said = robot.say("Robot, in John's office there is a PC and one pen over the table. "
                         "On the left of the table there is a chair.")
        self.assertIn("Noted: a PC and a pen are over the table in John's office.", said)
        self.assertIn("a chair is left of the table in John's office", said)
        self.assertIn("The pen is over the table in John's office.", robot.say("Where is the pen?"))
        said = robot.say("What is on the table?")
        self.assertIn("PC", said)
        self.assertIn("pen", said)
        self.assertNotIn("chair", said)
        self.assertEqual(robot.say("Which rooms have a chair?"), "John's office.")
        self.assertIn("corridor", robot.say("Where are you?"))
        self.assertIn("robot: John's office.", [m.data for m in self.talk.messages])

        # The robot asks about the contradiction; the answer is for the part that asked.
        self.assertIn("Is it now so", robot.say("The chair is in the corridor."))
        self.assertIn("the chair is in the corridor", robot.say("Yes."))
        self.assertEqual(robot.say("Yes."), "All right.")

        # A way to what is fetched: it ends in the room where the pen is.
        before = len(robot.poses.messages)
        said = robot.say("Fetch the pen.")
        self.assertIn("The pen is over the table in John's office.", said)
        self.assertIn("I am going to", said)
        wait_until(lambda: len(robot.poses.messages) > before, "no way")
        goal = robot.poses.messages[-1].poses[-1].position
        self.assertLess(math.hypot(goal.x - MIDDLE["i-109"][0], goal.y - MIDDLE["i-109"][1]), 3.0)
        self.assertIn("I am going to", robot.say("Go to the chair."))
        self.assertIn("I know of no spoon", robot.say("Go to the spoon."))

    def test_what_nobody_understands_is_refused_with_the_reason_of_who_knows(self):
        robot = self.robot()
        said = robot.say("The weather is nice today.")
        self.assertIn("I did not understand", said)
        self.assertEqual(said.count("I did not understand"), 1, said)
        self.assertIn("'man' is no object", robot.say("There is a man in the kitchen."))
        self.assertIn("I know of no plate", robot.say("Where is the plate?"))
        # What names of rooms and objects have in common: of which was spoken last.
        robot.say("There is a pitcher in the garage.")
        self.assertIn("Is it now so", robot.say("It is in the cellar."))
        self.assertIn("Then I leave it", robot.say("No."))

    def test_the_service_passes_on_as_well(self):
        robot = self.robot()
        before = len(robot.answers.messages)
        reply = robot.service("tell_robot", TellRobot)("There is a cup in the kitchen.")
        self.assertEqual(reply.answers, [])
        wait_until(lambda: any("a cup is in the kitchen" in m.data for m in robot.answers.messages[before:]), "no answer")

    def test_without_what_knows_objects(self):
        robot = self.robot(with_objects=False)
        said = robot.say("Where is the pen?")
        self.assertIn("I did not understand", said)
        self.assertNotIn("does not answer", said)

    def test_one_that_does_not_answer_is_told_of(self):
        robot = self.robot(with_objects=False, object_answer_timeout=0.5)
        requests = Listener(f"/{self.name}/object_request", ObjectRequest)
        self.addCleanup(requests.close)
        answers = rospy.Publisher(f"/{self.name}/object_answer", ObjectAnswer, queue_size=5)
        wait_until(lambda: requests.subscriber.get_num_connections() and answers.get_num_connections(), "no connection")
        said = robot.say("Where is the pen?")
        self.assertIn("I did not understand", said)
        self.assertIn("does not answer", said)
        # Too late, or never asked: nothing is said.
        before = len(robot.answers.messages)
        answers.publish(ObjectAnswer(id=requests.messages[-1].id, understood=True, reply="late"))
        answers.publish(ObjectAnswer(id=12345, understood=True, reply="nonsense", go_to_place=True, places=["x"]))
        self.assertIn("Hello", robot.say("Hello."))
        self.assertEqual(len(robot.answers.messages), before + 1)


if __name__ == "__main__":
    rospy.init_node("object_engine_dialogue_test")
    rospy.wait_for_service("/manager/load_nodelet", WAIT)
    rostest.rosrun("hyselam_bringup", "object_engine_dialogue", ObjectDialogueTest)
