#!/usr/bin/env python3
"""Two robots under one master, of which nobody knows how they lie to each other: in one building they get one map, also after
one of them was killed, told nonsense and began anew; in two buildings they keep two."""
import copy
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from hyselam_msgs.msg import SharedMapStatus, SlamKeyframe
from hyselam_msgs.srv import SlamGraph, SlamGraphResponse, StatePath
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.dont_write_bytecode = True
from localization_rig import SLOWNESS, WAIT, Listener, Recording, compose, inverse, newest_status, values_of, wait_until

PATIENCE = 180.0 * SLOWNESS  # [s] for a merging


def planar_transform(t):
    return t.translation.x, t.translation.y, 2 * math.atan2(t.rotation.z, t.rotation.w)


def await_long(condition, what):
    wait_until(condition, what, PATIENCE, 0.1)


class Robot:
    """A part of a recording, in the robot's namespace and frames; its odometry begins at `begin`."""

    def __init__(self, name, recording, part, begin, now=1.0):
        self.name, self.recording = name, recording
        n = len(recording.scans)
        scans = recording.scans[int(part[0] * n):int(part[1] * n)]
        self.shift = scans[0].header.stamp - rospy.Time.from_sec(now)  # a duration
        start = scans[0].header.stamp
        odometry = [t for t in recording.transforms if t.header.frame_id == "odom"]
        first = max((t for t in odometry if t.header.stamp <= start), key=lambda t: t.header.stamp)
        # Where the recorded odometry frame lies in the robot's.
        self.moved = compose(begin, inverse(planar_transform(first.transform)))
        self.events = []  # (seconds, message)
        for t in odometry:
            if first.header.stamp <= t.header.stamp <= scans[-1].header.stamp:
                self.events.append((t.header.stamp - self.shift, self.in_frames(t, self.moved)))
        for scan in scans:
            scan = copy.copy(scan)
            scan.header = copy.copy(scan.header)
            scan.header.stamp = scan.header.stamp - self.shift
            scan.header.frame_id = f"{name}/{scan.header.frame_id}"
            self.events.append((scan.header.stamp, scan))
        self.events.sort(key=lambda e: (e[0], hasattr(e[1], "ranges")))
        self.static = [self.in_frames(t) for t in recording.static]
        self.scan = rospy.Publisher(f"/{name}/scan", LaserScan, queue_size=1000)
        self.sent, self.odometry, self.last = 0, None, None

    def in_frames(self, transform, moved=None):
        t = copy.deepcopy(transform)
        t.header.frame_id, t.child_frame_id = f"{self.name}/{t.header.frame_id}", f"{self.name}/{t.child_frame_id}"
        if moved:
            t.header.stamp = t.header.stamp - self.shift
            x, y, theta = compose(moved, planar_transform(t.transform))
            t.transform.translation.x, t.transform.translation.y = x, y
            t.transform.rotation.z, t.transform.rotation.w = math.sin(theta / 2), math.cos(theta / 2)
        return t

    def truth(self):
        """Of its last scan, in the plan's frame."""
        return self.recording.truth_at((self.last + self.shift).to_sec())


class TwoRobotsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        second = rospy.get_param("/second_route")
        cls.one_building = second == "office"
        office = Recording(route="office")
        other = Recording(route=second, seed=2)
        cls.robots = [Robot("a", office, (0.0, 0.6), (0.0, 0.0, 0.0)),
                      Robot("b", other, (0.35, 1.0) if cls.one_building else (0.0, 0.5), (30.0, -7.0, 2.5))]
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=10000)
        tf_static = rospy.Publisher("/tf_static", TFMessage, queue_size=10, latch=True)
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=1000)
        kinds = {"shared_map_status": SharedMapStatus, "map": OccupancyGrid, "shared_map_markers": MarkerArray, "tf": TFMessage,
                 "diagnostics": DiagnosticArray, "a/map": OccupancyGrid, "b/map": OccupancyGrid}
        cls.heard = {topic: Listener("/" + topic, kind) for topic, kind in kinds.items()}
        for service in ("/a/slam_graph", "/b/slam_graph", "/shared_map/save"):
            rospy.wait_for_service(service, WAIT)
        wait_until(lambda: all(r.scan.get_num_connections() > 0 for r in cls.robots) and cls.tf.get_num_connections() > 2,
                   "SLAM does not listen")
        tf_static.publish(TFMessage([t for r in cls.robots for t in r.static]))
        cls.now = 0.0
        cls.tick(rospy.Time(1))
        cls.process = None

    @classmethod
    def tearDownClass(cls):
        if cls.process:
            cls.process.terminate()
            cls.process.wait()

    # ---- what goes in

    @classmethod
    def tick(cls, stamp):
        cls.now = max(cls.now, stamp.to_sec())
        cls.clock.publish(Clock(rospy.Time.from_sec(cls.now)))

    @classmethod
    def values(cls, name):
        return values_of(newest_status(cls.heard["diagnostics"], lambda each: each == name))

    def settle(self, robots):
        """Every scan sent is used, or waits for nothing."""
        def done():
            self.tick(rospy.Time.from_sec(self.now))
            return all(self.values(f"{r.name}/slam: SLAM").get("scans received") == str(r.sent) and
                       self.values(f"{r.name}/slam: SLAM").get("scans waiting") == "0" for r in robots)
        wait_until(done, lambda: str([(r.sent, self.values(f"{r.name}/slam: SLAM")) for r in robots]))

    def drive(self, robots, until=math.inf):
        """The robots' next messages side by side, in the order of their stamps; settles every two seconds of theirs."""
        checked = self.now
        while True:
            left = [r for r in robots if r.events and r.events[0][0].to_sec() <= until]
            if not left:
                break
            robot = min(left, key=lambda r: r.events[0][0])
            stamp, msg = robot.events.pop(0)
            if hasattr(msg, "ranges"):
                self.tick(stamp)
                robot.scan.publish(msg)
                robot.sent, robot.last = robot.sent + 1, stamp
            else:
                self.tf.publish(TFMessage([msg]))
                robot.odometry = planar_transform(msg.transform)
            if stamp.to_sec() > checked + 2.0:
                self.settle(robots)
                checked = stamp.to_sec()
        self.settle(robots)

    # ---- what comes out

    def status(self):
        return self.heard["shared_map_status"].messages[-1]

    def transform(self, parent, child):
        for msg in reversed(self.heard["tf"].messages):
            for t in msg.transforms:
                if t.header.frame_id == parent and t.child_frame_id == child:
                    return planar_transform(t.transform)
        return None

    def where(self, robot):
        """In the shared map, by tf."""
        return compose(compose(self.transform("map", f"{robot.name}/map"),
                               self.transform(f"{robot.name}/map", f"{robot.name}/odom")), robot.odometry)

    def assert_right(self):
        """Robots that stand in one map stand to each other in it as they do in truth."""
        a, b = self.robots
        seen = compose(inverse(self.where(a)), self.where(b))
        true = compose(inverse(a.truth()), b.truth())
        self.assertLess(math.hypot(seen[0] - true[0], seen[1] - true[1]), 0.4)

    def mergings(self):
        """By the newest diagnostics; -1 while there are none."""
        return int(self.values("shared_map: shared map").get("mergings", -1))

    def await_merging(self):
        """One that knows all that was told, from its begin; or nothing is new any more."""
        await_long(lambda: self.mergings() >= 0, lambda: "no diagnostics")
        count = self.mergings()
        await_long(lambda: self.mergings() >= count + 2 or self.idle(), lambda: self.status().text)

    def idle(self):
        seen = self.mergings()
        time.sleep(8.0 * SLOWNESS)  # longer than one of them takes
        return self.mergings() == seen >= 0

    def test_two_robots(self):
        if self.one_building:
            self.one_map()
        else:
            self.two_maps()

    def two_maps(self):
        self.drive(self.robots)
        await_long(lambda: self.mergings() > 0, lambda: self.status().text)
        self.await_merging()
        # That of the robot which had one first, for ever.
        one, other = ("a", "b") if self.transform("map", "a/map") else ("b", "a")
        self.assertEqual(self.status().text, f"the map is that of {one}; {other} is not recognized in it")
        self.assertIsNotNone(self.transform("map", f"{one}/map"))
        self.assertIsNone(self.transform("map", f"{other}/map"))
        free = lambda topic: sum(v == 0 for v in self.heard[topic].messages[-1].data)
        self.assertLess(abs(free("map") - free(f"{one}/map")), 0.05 * free(f"{one}/map"))
        self.assertNotIn("ties", {m.ns for m in self.heard["shared_map_markers"].messages[-1].markers})

    def one_map(self):
        a, b = self.robots
        end = max(r.events[-1][0].to_sec() for r in self.robots)
        # Nothing is recognized before they were at the same places.
        self.drive(self.robots, 0.06 * end)
        await_long(lambda: self.heard["map"].messages, lambda: "no map")
        self.assertIn("is not recognized in it", self.status().text)
        self.drive(self.robots)
        await_long(lambda: self.status().text == "a and b are in one map", lambda: self.status().text)
        self.await_merging()
        self.assert_right()
        status = self.status()
        self.assertEqual([r.frame for r in status.robots], ["a/map", "b/map"])
        self.assertGreater(status.robots[0].ties, 5)
        free = lambda grid: sum(v == 0 for v in grid.data)
        shared = rospy.ServiceProxy("/dynamic_map", GetMap)().map
        for own in ("a/map", "b/map"):
            self.assertGreater(free(shared), 1.1 * free(self.heard[own].messages[-1]), own)
        self.assertLess(free(shared), sum(free(self.heard[own].messages[-1]) for own in ("a/map", "b/map")))
        self.assertEqual({m.ns for m in self.heard["shared_map_markers"].messages[-1].markers},
                         {"", "path", "robots", "names", "ties"})
        self.saved()
        self.killed()

    def saved(self):
        """The one map can be gone on with."""
        save = rospy.ServiceProxy("/shared_map/save", StatePath)
        self.assertFalse(save("").success)
        self.assertFalse(save("/no/such/folder/x.state").success)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "both.state")
            answer = save(path)
            self.assertTrue(answer.success, answer.message)
            done = subprocess.run(["rosrun", "ngram_slam", "merge_maps", path, "--out", os.path.join(folder, "out")],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertIn("map: ", done.stdout)
            self.assertNotIn("map_2: ", done.stdout)

    def killed(self):
        a, b = self.robots
        keyframes = self.status().robots[1].keyframes
        subprocess.run(["rosnode", "kill", "/b/hyselam_manager"], check=True, stdout=subprocess.DEVNULL)
        await_long(lambda: not self.status().robots[1].answers, lambda: self.status().text)
        self.assertIn("a and b are in one map; b does not answer", self.status().text)
        self.assertEqual(self.status().robots[1].keyframes, keyframes)

        # Somebody answers nonsense in its place.
        nonsense = SlamGraphResponse(map="x", frame="b/map", new_keyframes=[SlamKeyframe(path_length=math.nan)])
        liar = rospy.Service("/b/slam_graph", SlamGraph, lambda _: nonsense)
        await_long(lambda: "not finite" in self.status().robots[1].reason, lambda: str(self.status()))
        nonsense.frame = "a/map"
        nonsense.new_keyframes = []
        await_long(lambda: "frame of that of a" in self.status().robots[1].reason, lambda: str(self.status()))
        self.assertEqual(self.status().robots[1].keyframes, keyframes)
        liar.shutdown()

        # It begins anew, without a state, and drives another round.
        type(self).robots[1] = b = Robot("b", Recording(route="office", seed=3), (0.1, 0.5), (5.0, 5.0, -1.0), self.now + 5.0)
        self.process = type(self).process = subprocess.Popen(
            [find_node("ngram_slam", "slam_node")[0], "__name:=slam", "__ns:=/b"], stdout=subprocess.DEVNULL)
        wait_until(lambda: b.scan.get_num_connections() > 0, "SLAM does not listen again")
        await_long(lambda: self.status().robots[1].answers, lambda: self.status().text)
        wait_until(lambda: self.values("b/slam: SLAM").get("scans received") == "0", "no news of it")
        self.drive([b])
        await_long(lambda: self.status().robots[1].in_map and self.status().robots[1].keyframes > keyframes,
                   lambda: self.status().text)
        self.await_merging()
        self.assertEqual(self.status().text, "a and b are in one map")
        self.assert_right()


if __name__ == "__main__":
    rospy.init_node("two_robots_test")
    rostest.rosrun("hyselam_bringup", "two_robots_test", TwoRobotsTest)
