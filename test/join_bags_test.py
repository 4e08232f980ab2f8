#!/usr/bin/env python3
"""Bags of several robots become one: names before topics and frames, one beginning, all that stands still in one message."""
import os
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rospy
import rostest
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header, String
from tf2_msgs.msg import TFMessage

sys.dont_write_bytecode = True
from localization_rig import WAIT


def transform(parent, child, stamp):
    return TransformStamped(header=Header(frame_id=parent, stamp=stamp), child_frame_id=child)


class JoinBagsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = lambda name: os.path.join(folder.name, name)

    def write(self, name, begin):
        with rosbag.Bag(self.path(name), "w") as bag:
            def at(seconds):
                return rospy.Time.from_sec(begin + seconds)
            bag.write("/tf_static", TFMessage([transform("base_link", "laser", at(0))]), at(0))
            bag.write("/tf_static", TFMessage([transform("base_link", "camera", rospy.Time())]), at(0.5))
            for i in range(5):
                bag.write("/clock", Clock(at(i)), at(i))
                bag.write("/tf", TFMessage([transform("odom", "base_link", at(i))]), at(i))
                bag.write("/scan", LaserScan(header=Header(frame_id="/laser", stamp=at(i)), ranges=[1.0, 2.0]), at(i + 0.1))
            odometry = Odometry(header=Header(frame_id="odom", stamp=at(1)), child_frame_id="base_link")
            bag.write("/odometry", odometry, at(1.2))
            bag.write("/says", String("hello"), at(1.3))

    def join(self, *arguments):
        return subprocess.run([find_node("hyselam_bringup", "join_bags")[0], *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=WAIT)

    def test_two_robots_begin_together_each_with_its_name(self):
        self.write("a.bag", 5000.0)
        self.write("b.bag", 1000.0)
        done = self.join("a=" + self.path("a.bag"), "b=" + self.path("b.bag"), "--out", self.path("both.bag"))
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        self.assertEqual(sorted(os.listdir(self.path(""))), ["a.bag", "b.bag", "both.bag"])
        seen = {}
        with rosbag.Bag(self.path("both.bag")) as bag:
            for topic, message, stamp, header in bag.read_messages(return_connection_header=True):
                seen.setdefault(topic, []).append((stamp.to_sec() - 5000.0, message, header))
        self.assertEqual(set(seen), {"/tf", "/tf_static", "/a/scan", "/b/scan", "/a/odometry", "/b/odometry", "/a/says", "/b/says"})
        (at, fixed, header), = seen["/tf_static"]
        self.assertEqual((at, header["latching"]), (0.0, b"1"))
        self.assertEqual({(t.header.frame_id, t.child_frame_id) for t in fixed.transforms},
                         {(f"{robot}/base_link", f"{robot}/{frame}") for robot in "ab" for frame in ("laser", "camera")})
        self.assertEqual({t.header.stamp.to_sec() for t in fixed.transforms}, {0.0, 5000.0}, "no time stays none")
        for robot in "ab":
            for i, (at, scan, _) in enumerate(seen[f"/{robot}/scan"]):
                self.assertAlmostEqual(at, i + 0.1, places=6)
                self.assertEqual((scan.header.stamp.to_sec(), scan.header.frame_id, list(scan.ranges)), (5000.0 + i, f"{robot}/laser", [1.0, 2.0]))
            (_, odometry, _), = seen[f"/{robot}/odometry"]
            self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), (f"{robot}/odom", f"{robot}/base_link"))
            (_, said, _), = seen[f"/{robot}/says"]
            self.assertEqual(said.data, "hello")
        self.assertEqual([at for at, _, _ in seen["/tf"]], sorted(2 * [0.0, 1.0, 2.0, 3.0, 4.0]))

    def test_what_cannot_be_joined_is_refused_and_leaves_nothing(self):
        self.write("a.bag", 5000.0)
        a, out = self.path("a.bag"), self.path("out.bag")
        with open(self.path("none.bag"), "w") as file:
            file.write("#ROSBAG V9.9\n")
        for arguments, reason in ((["a=" + a, "a=" + a], "a name of its own"), (["a b=" + a], "NAME=BAG"), ([a], "NAME=BAG"),
                                  (["a=" + a, "b=" + self.path("nowhere.bag")], "nowhere.bag"), (["a=" + self.path("none.bag")], "error: ")):
            done = self.join(*arguments, "--out", out)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(reason, done.stdout)
            self.assertNotIn("Traceback", done.stdout)
        self.assertIn("one of the bags", self.join("a=" + a, "--out", a).stdout)
        self.assertEqual(sorted(os.listdir(self.path(""))), ["a.bag", "none.bag"])


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "join_bags_test", JoinBagsTest)
