#!/usr/bin/env python3
"""The conversation of section 7.3.1 (dos Santos) with the nodelets in a simulated building with walls of
glass; names, services, files, bad input."""
import math
import os
import subprocess
import tempfile
import unittest

import rospkg
import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PointStamped, PoseArray, PoseWithCovarianceStamped, TransformStamped
from hyselam_msgs.msg import AugmentedTopologicalMap, PlaceState, Wall, WallArray
from hyselam_msgs.srv import (AddGlassWall, AddVirtualPlace, NamePlace, StatePath, TellRobot, UseLanguage, WhereAmI, WordToPose)
from nav_msgs.msg import OccupancyGrid, Path
from nodelet.srv import NodeletList, NodeletUnload
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from localization_rig import Listener, load_nodelet, newest_status, read_map, values_of, wait_until, WAIT

# Glass in the south (y = -0.1) and north (y = 2.5) wall of the corridor: x of its ends; where the robot is told.
GLASS = [("right", (5.0, 6.35), -0.1, 5.6), ("right", (8.0, 9.35), -0.1, 8.6), ("left", (8.5, 12.08), 2.5, 10.3),
         ("right", (16.0, 17.47), -0.1, 16.7)]
MIDDLE = {"corridor": (1.0, 1.2), "i-109": (3.0, 6.0), "i-110": (9.0, 6.0), "i-111": (16.0, 6.0), "i-108": (11.0, -3.0),
          "stairs": (-2.0, 1.0), "hall": (24.0, 1.0)}
QUIET = 12  # diagnoses, 20 a second where the machine has time
DESCRIPTION = (
    "Robot, you are in the corridor. On your left you have room i-109, then i-110 and i-111. You are in the corridor. "
    "On your right you have room i-108. You are in the corridor. Behind you are the stairs. You are in the corridor. "
    "In front of you is the Hall. Room i-108 is also known as robosoccer room. Room i-110 is also known as industrial "
    "robotics room. Room i-109 is also known as mobile robotics room. Finally, room i-108 has 15 by 6 meters.")


def building(folder, plan=None):
    """The grid map of a building, by default that with glass, as a laser would make it, which looks through the glass."""
    plan = plan or os.path.join(rospkg.RosPack().get_path("hyselam_topo"), "test", "data", "glass_building.yaml")
    yaml = os.path.join(folder, "map.yaml")
    subprocess.run(["rosrun", "hyselam_sim", "plan_to_map", plan, yaml, "--resolution", "0.05"],
                   check=True, stdout=subprocess.DEVNULL)
    return read_map(yaml)


class Robot:
    """The nodelets in a namespace of their own, the map, a pose."""

    def __init__(self, name, grid=None, **params):
        self.name, self.node = name, f"/{name}/topo_engine"
        params.setdefault("diagnostic_period", 0.05)
        params.setdefault("pose_rate", 50.0)
        params.setdefault("base_frame", name + "_base")
        for key, value in params.items():
            rospy.set_param(f"{self.node}/{key}", value)
        self.base = params["base_frame"]
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.pose, self.timer, self.closed = None, None, False
        self.map_publisher = rospy.Publisher(f"/{name}/map", OccupancyGrid, queue_size=1, latch=True)
        self.human = rospy.Publisher(f"/{name}/human_text", String, queue_size=10)
        self.answers = Listener(f"/{name}/robot_text", String)
        self.places = Listener(f"/{name}/place", PlaceState)
        self.maps = Listener(f"/{name}/named_map", AugmentedTopologicalMap)
        self.markers = Listener(f"/{name}/named_markers", MarkerArray)
        self.grids = Listener(f"/{name}/map_with_glass", OccupancyGrid)
        self.paths = Listener(f"/{name}/goal_path", Path)
        self.poses = Listener(f"/{name}/goal_poses", PoseArray)
        self.initial = Listener(f"/{name}/initialpose", PoseWithCovarianceStamped)
        self.diagnostics = Listener(f"/{name}/diagnostics", DiagnosticArray)
        self.loaded = load_nodelet("hyselam_topo/TopoEngine", self.node, {"/diagnostics": f"/{name}/diagnostics"})
        self.with_gr2to = self.loaded and grid is not None
        if self.with_gr2to:
            rospy.set_param(f"/{name}/gr2to/partial_updates", 0)
            assert load_nodelet("hyselam_topo/Gr2To", f"/{name}/gr2to",
                                {f"/{name}/map": f"/{name}/map_with_glass", "/diagnostics": f"/{name}/gr2to_diagnostics"})
        if self.loaded:
            wait_until(lambda: self.human.get_num_connections() > 0 and
                       all(s.subscriber.get_num_connections() > 0 for s in (self.answers, self.places, self.diagnostics)),
                       "no connections")
        if grid is not None:
            self.map_publisher.publish(grid)

    def close(self):
        if self.closed:
            return
        self.closed = True
        if self.timer:
            self.timer.shutdown()
        unload = rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)
        if self.with_gr2to:
            unload(f"/{self.name}/gr2to")
        if self.loaded:
            unload(self.node)
        for listener in (self.answers, self.places, self.maps, self.markers, self.grids, self.paths, self.poses,
                         self.initial, self.diagnostics):
            listener.close()

    def stand(self, x, y, yaw=0.0):
        """The robot is there from now on, and the engine knows it."""
        self.pose = (x, y, yaw)
        if self.timer is None:
            self.timer = rospy.Timer(rospy.Duration(0.02), lambda _: self.broadcast())
        self.broadcast()
        wait_until(lambda: self.near(self.service("where_am_i", WhereAmI)().state.pose, x, y), f"not at {x}, {y}")

    @staticmethod
    def near(pose, x, y):
        return math.hypot(pose.x - x, pose.y - y) < 0.01

    def broadcast(self):
        x, y, yaw = self.pose
        t = TransformStamped()
        t.header.stamp, t.header.frame_id, t.child_frame_id = rospy.Time.now(), "map", self.base
        t.transform.translation.x, t.transform.translation.y = x, y
        t.transform.rotation.z, t.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self.broadcaster.sendTransform(t)

    def service(self, name, kind):
        rospy.wait_for_service(f"/{self.name}/{name}", WAIT)
        return rospy.ServiceProxy(f"/{self.name}/{name}", kind)

    def say(self, text):
        """By the topics, as a messenger would: the sentences that answer."""
        before = len(self.answers.messages)
        self.human.publish(String(data=text))
        expected = self.status_value("texts")
        wait_until(lambda: len(self.answers.messages) > before, lambda: f"no answer to '{text}' ({expected})")
        # The sentences of one answer follow each other: no more comes while the engine tells of itself so often.
        count, told = len(self.answers.messages), len(self.diagnostics.messages)

        def is_all():
            nonlocal count, told
            if len(self.answers.messages) > count:
                count, told = len(self.answers.messages), len(self.diagnostics.messages)
            return len(self.diagnostics.messages) >= told + QUIET
        wait_until(is_all, "no diagnostics")
        return " ".join(m.data for m in self.answers.messages[before:])

    def status(self):
        return newest_status(self.diagnostics, lambda name: name == self.node[1:] + ": dialogue") or DiagnosticStatus()

    def status_value(self, key):
        return values_of(self.status()).get(key, "")

    def place_at(self, name):
        """The place of the newest map at the middle of a room."""
        msg = self.maps.messages[-1]
        x, y = MIDDLE[name]
        column = int((x - msg.grid.origin.x) / msg.grid.resolution)
        row = int((y - msg.grid.origin.y) / msg.grid.resolution)
        label = msg.grid.labels[row * msg.grid.width + column]
        wanted = msg.grid.places[label - 1]
        return next(p for p in msg.places if p.id == wanted)


class ConversationTest(unittest.TestCase):
    cases = 0

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.grid = building(cls.folder.name)

    def robot(self, grid=None, **params):
        ConversationTest.cases += 1
        robot = Robot(f"case{ConversationTest.cases}", grid, **params)
        self.addCleanup(robot.close)
        return robot

    def test_the_conversation_of_section_731(self):
        state = os.path.join(self.folder.name, "state")
        robot = self.robot(self.grid, state_file=state)
        wait_until(lambda: robot.maps.messages, "no map")
        robot.say("Robot, follow me.")
        for side, _, _, x in GLASS:
            robot.stand(x, 1.2)
            asked = robot.say(f"Stop. Robot, on your {side} there is a glass wall.")
            self.assertIn(f"meters to my {side}", asked)
            self.assertIn("Is this information correct?", asked)
            before = len(robot.grids.messages)
            robot.say("Yes.")
            wait_until(lambda: len(robot.grids.messages) > before, "no map with the glass")
        drawn = robot.grids.messages[-1]
        for _, (low, high), y, _ in GLASS:
            # The wall is drawn from end to end within 0.2 m of its line.
            for x in (low + 0.2, 0.5 * (low + high), high - 0.2):
                column = int((x - drawn.info.origin.position.x) / 0.05)
                rows = range(int((y - 0.2 - drawn.info.origin.position.y) / 0.05),
                             int((y + 0.2 - drawn.info.origin.position.y) / 0.05) + 1)
                self.assertTrue(any(drawn.data[r * drawn.info.width + column] == 100 for r in rows), (x, y))
        # Gr2To has taken the map with all the glass: the room behind it is a place of its own.
        wait_until(lambda: len({robot.place_at(n).id for n in MIDDLE}) == len(MIDDLE),
                   lambda: f"places are not apart: { {n: robot.place_at(n).id for n in MIDDLE} }, {robot.status()}")
        glass = [w for p in robot.maps.messages[-1].places for w in p.walls if w.kind == Wall.GLASS]
        self.assertGreaterEqual(len(glass), 4)

        robot.stand(1.0, 1.2)
        self.assertRegex(robot.say("Robot, where are you?"), r"^I am at [SC][SC]\d\d\.$")
        self.assertIn("Noted: ", robot.say(DESCRIPTION))
        for name in MIDDLE:
            words = [w.text.lower() for w in robot.place_at(name).words]
            self.assertTrue(any(name in w for w in words), (name, words))
        self.assertRegex(robot.say("Robot, where are you?"), r"^I am at [SC][SC]\d\d, the corridor\.$")

        robot.stand(*MIDDLE["i-109"])
        asked = robot.say("Robot, Stop. Robot, where are you?")
        self.assertRegex(asked, r"Can you please confirm the name room i-109 and mobile robotics room, as the name of "
                                r"this place\?")
        self.assertIn("Thank you.", robot.say("Yes."))
        self.assertTrue(all(w.confirmed for w in robot.place_at("i-109").words))

        before = len(robot.paths.messages)
        robot.say("Robot, go to I-110 and then go to the corridor.")
        wait_until(lambda: len(robot.paths.messages) > before, "no path")
        path = [(p.pose.position.x, p.pose.position.y) for p in robot.paths.messages[-1].poses]
        through_109 = min(math.hypot(x - 3.5, y - 2.5) for x, y in path)
        through_110 = min(math.hypot(x - 7.0, y - 2.5) for x, y in path)
        self.assertLess(through_109, 0.25)
        self.assertLess(through_110, 0.25)
        crossings = [(a[0] + b[0]) / 2 for a, b in zip(path, path[1:]) if (a[1] - 2.5) * (b[1] - 2.5) < 0]
        self.assertEqual(len(crossings), 3, crossings)  # out of i-109, into i-110, out again
        for x in crossings:
            self.assertTrue(abs(x - 3.5) < 0.45 or abs(x - 7.0) < 0.45, crossings)
        self.assertEqual(len(robot.poses.messages[-1].poses), 5)

        # Driven along the way the robot passes the places that it said.
        passed = []
        for x, y in path[::10] + [path[-1]]:
            robot.stand(x, y)
            place = robot.service("where_am_i", WhereAmI)().state.place
            if not passed or passed[-1] != place:
                passed.append(place)
        corridor, goal = robot.place_at("corridor").id, robot.place_at("i-110").id
        self.assertEqual(passed, [robot.place_at("i-109").id, corridor, goal, corridor])

        # After a restart all of it is still known.
        robot.close()
        again = self.robot(None, state_file=state)
        wait_until(lambda: again.maps.messages, "no kept map")
        again.stand(*MIDDLE["i-109"])
        self.assertRegex(again.say("Where are you?"), r"^I am at SS\d\d, room i-109 and the mobile robotics room\.$")

    def test_services(self):
        robot = self.robot(self.grid)
        wait_until(lambda: robot.maps.messages, "no map")
        robot.stand(*MIDDLE["hall"])
        here = robot.service("where_am_i", WhereAmI)()
        self.assertEqual(here.state.place, robot.place_at("hall").id)
        self.assertRegex(here.code, r"^[SC][SC]\d\d$")
        name = robot.service("name_place", NamePlace)
        self.assertTrue(name(0, PointStamped(), ["hall", "lobby"]).success)
        point = PointStamped()
        point.header.frame_id = "map"
        point.point.x, point.point.y = MIDDLE["stairs"]
        answer = name(0, point, ["stairs"])
        self.assertTrue(answer.success)
        self.assertEqual(answer.place, robot.place_at("stairs").id)
        self.assertFalse(name(999, PointStamped(), ["x"]).success)
        self.assertFalse(name(0, point, ["\a"]).success)
        point.header.frame_id = "odom"
        self.assertFalse(name(0, point, ["x"]).success)

        pose = robot.service("word_to_pose", WordToPose)("the lobby")
        self.assertTrue(pose.found)
        self.assertEqual(pose.place, here.state.place)
        self.assertAlmostEqual(pose.pose.pose.pose.position.x, 24.1, delta=1.0)
        self.assertGreater(pose.pose.pose.covariance[0], 1.0)
        self.assertFalse(robot.service("word_to_pose", WordToPose)("moon").found)
        self.assertTrue(robot.service("set_initial_place", WordToPose)("stairs").found)
        self.assertAlmostEqual(robot.initial.wait().pose.pose.position.x, -2.1, delta=1.0)

        told = robot.service("tell_robot", TellRobot)("Onde estás?")
        self.assertEqual(told.language, "pt")
        self.assertIn("hall", " ".join(told.answers))

        wall = robot.service("add_glass_wall", AddGlassWall)
        self.assertTrue(wall("map", robot_point(5.0, -0.1), robot_point(6.35, -0.1), False).success)
        self.assertFalse(wall("map", robot_point(5.0, 0.0), robot_point(5.0, 0.0), False).success)
        self.assertFalse(wall("odom", robot_point(5.0, 0.0), robot_point(6.0, 0.0), False).success)
        told = rospy.wait_for_message(f"/{robot.name}/told_walls", WallArray, WAIT)
        self.assertEqual([(w.kind, round(w.length, 2)) for w in told.walls], [(Wall.GLASS, 1.35)])
        remove = robot.service("remove_wall", AddGlassWall)
        self.assertFalse(remove("map", robot_point(5.0, -0.1), robot_point(6.35, -0.1), True).success)
        self.assertTrue(robot.service("use_language", UseLanguage)("en").success)
        self.assertFalse(robot.service("use_language", UseLanguage)("xx").success)
        self.assertEqual(remove("map", robot_point(5.0, -0.1), robot_point(6.35, -0.1), False).message, "I have forgotten the glass wall.")
        self.assertEqual(rospy.wait_for_message(f"/{robot.name}/told_walls", WallArray, WAIT).walls, [])
        place = robot.service("add_virtual_place", AddVirtualPlace)
        self.assertTrue(place(PointStamped(), 1.0, ["charging station"]).success)
        self.assertFalse(place(PointStamped(), -1.0, []).success)

        path = os.path.join(self.folder.name, "saved")
        self.assertTrue(robot.service("save_dialogue", StatePath)(path).success)
        self.assertTrue(name(answer.place, PointStamped(), []).success)
        self.assertTrue(robot.service("load_dialogue", StatePath)(path).success)
        self.assertTrue(robot.service("word_to_pose", WordToPose)("stairs").found)
        with open(path, "r+b") as file:
            file.seek(200)
            file.write(b"?")
        answer = robot.service("load_dialogue", StatePath)(path)
        self.assertFalse(answer.success)
        self.assertIn("the checksum is wrong", answer.message)
        self.assertFalse(robot.service("save_dialogue", StatePath)("/nowhere/state").success)

    def test_waypoints_are_driven_by_move_base(self):
        try:
            import actionlib
            from move_base_msgs.msg import MoveBaseAction
        except ImportError:
            self.skipTest("python3-actionlib or python3-move-base-msgs is not installed")
        robot = self.robot(self.grid)
        wait_until(lambda: robot.maps.messages, "no map")
        goals, refuse = [], []

        def drive(goal):
            position = goal.target_pose.pose.position
            goals.append((goal.target_pose.header.frame_id, position.x, position.y))
            if len(goals) in refuse:
                server.set_aborted()
            else:
                server.set_succeeded()
        server = actionlib.SimpleActionServer(f"/{robot.name}/move_base", MoveBaseAction, drive, False)
        server.start()
        wait_until(lambda: server.action_server.goal_sub.get_num_connections() > 0, "no client")
        rospy.sleep(1.0)  # the client looks for the other topics and the server's status, too
        robot.stand(*MIDDLE["i-109"])
        robot.service("name_place", NamePlace)(robot.place_at("stairs").id, PointStamped(), ["stairs"])
        self.assertIn("I am going to", robot.say("Go to the stairs."))
        wait_until(lambda: robot.status_value("driving") == "arrived", lambda: f"{goals} {robot.status()}")
        self.assertEqual(len(goals), 3)  # the two doors, the stairs
        self.assertEqual(goals[0][0], "map")
        self.assertLess(math.hypot(goals[0][1] - 3.5, goals[0][2] - 2.5), 0.3)
        self.assertLess(math.hypot(goals[1][1] + 0.1, goals[1][2] - 1.2), 0.3)
        del goals[:]
        refuse.append(2)
        robot.say("Go to the stairs.")
        wait_until(lambda: robot.status_value("driving") == "ABORTED at 2 of 3", lambda: str(robot.status()))

    def test_chat_in_a_console(self):
        robot = self.robot()
        said = subprocess.run(["rosrun", "hyselam_topo", "chat", "--wait", "10", f"human_text:=/{robot.name}/human_text",
                               f"robot_text:=/{robot.name}/robot_text", f"known_names:=/{robot.name}/known_names"],
                              input="Where are you?\n\nhello\n", stdout=subprocess.PIPE, check=True, text=True).stdout
        self.assertEqual(said.splitlines(), ["You:   Where are you?", "Robot: I do not know where I am.", "You:   hello",
                                             "Robot: Hello."])

    def test_bad_input_is_refused_aloud(self):
        robot = self.robot()
        publisher = rospy.Publisher(f"/{robot.name}/topological_map", AugmentedTopologicalMap, queue_size=1)
        wait_until(lambda: publisher.get_num_connections() > 0, "no connection")
        msg = AugmentedTopologicalMap()
        msg.grid.labels = [7]
        msg.has_grid = True
        publisher.publish(msg)
        wait_until(lambda: robot.status().level == DiagnosticStatus.ERROR, lambda: str(robot.status()))
        self.assertIn("topological_map", robot.status().message)
        grid = OccupancyGrid()
        grid.info.width = 3
        robot.map_publisher.publish(grid)
        wait_until(lambda: robot.status_value("refused") == "2", lambda: str(robot.status()))
        robot.human.publish(String(data="x" * 100000))
        wait_until(lambda: robot.status_value("refused") == "3", lambda: str(robot.status()))
        self.assertIn("I do not know where I am", robot.say("Where are you?"))

    def test_a_damaged_state_is_put_aside(self):
        state = os.path.join(self.folder.name, "damaged")
        with open(state, "w") as file:
            file.write("hyselam_dialogue 1 0 5\nnever")
        robot = self.robot(state_file=state)
        wait_until(lambda: "the checksum is wrong" in robot.status().message, lambda: str(robot.status()))
        self.assertEqual(robot.status().level, DiagnosticStatus.WARN)
        self.assertTrue(os.path.exists(state + ".damaged"))
        self.assertIn("I do not know where I am", robot.say("Where are you?"))

    def test_parameters_out_of_range_stop_it_from_loading(self):
        for params in ({"pose_rate": 0.0}, {"ask": "often"}, {"language": "tlh"}, {"glass_max_length": 0.2}):
            self.assertFalse(self.robot(**params).loaded, params)
        self.assertNotIn("topo_engine", str(rospy.ServiceProxy("/manager/list", NodeletList)().nodelets))


def robot_point(x, y):
    point = PointStamped().point
    point.x, point.y = x, y
    return point


if __name__ == "__main__":
    rospy.init_node("conversation_test")
    rostest.rosrun("hyselam_bringup", "conversation_test", ConversationTest)
