#!/usr/bin/env python3
"""A bag played with its clock, through launch files, nodelets and nodes: the robot is found, and live equals
offline pose by pose."""
import math
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from hyselam_msgs.msg import FsdObservation, LocalizationStatus
from nav_msgs.msg import OccupancyGrid
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.dont_write_bytecode = True
from localization_rig import SLOWNESS, Listener, Recording, angle_between, newest_status, planar, play_bag, values_of, wait_until

RATE = 8 / SLOWNESS  # times real time; every scan must still be used, and that is checked


class LocalizationBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Recording()
        kinds = {"amcl_pose": PoseWithCovarianceStamped, "localization_status": LocalizationStatus,
                 "particlecloud": PoseArray, "density_field": OccupancyGrid, "fsd_observation": FsdObservation,
                 "local_map": OccupancyGrid, "fsd_markers": MarkerArray}
        cls.heard = {(ns, topic): Listener(f"/{ns}/{topic}", kind) for ns in ("nodelet", "node") for topic, kind in kinds.items()}
        cls.tf = Listener("/tf", TFMessage)
        cls.diagnostics = Listener("/diagnostics", DiagnosticArray)
        maps = [rospy.Publisher(f"/{ns}/map", OccupancyGrid, queue_size=1, latch=True) for ns in ("nodelet", "node")]
        for publisher in maps:
            publisher.publish(cls.run_.map)
        for ns in ("nodelet", "node"):
            cls.heard[ns, "density_field"].wait()
        play_bag(cls.run_.bag, RATE, ["/scan", "/tf", "/tf_static"])
        for ns in ("nodelet", "node"):
            wait_until(lambda: cls.value(f"{ns}/localization", "scans waiting") == "0"
                       and all(int(cls.value(f"{ns}/{name}", "scans used")) >= len(cls.run_.scans)
                               for name in ("localization", "fsd")),
                       lambda: f"{ns}: {cls.values(f'{ns}/localization')} {cls.values(f'{ns}/fsd')}")

    @classmethod
    def values(cls, node):
        return values_of(newest_status(cls.diagnostics, lambda name: name.startswith(node + ":")))

    @classmethod
    def value(cls, node, key):
        return cls.values(node).get(key, "0")

    def messages(self, ns, topic):
        return self.heard[ns, topic].messages

    def test_every_scan_was_used(self):
        for ns in ("nodelet", "node"):
            for name in ("localization", "fsd"):
                values = self.values(f"{ns}/{name}")
                self.assertEqual((values["scans used"], values["scans dropped"]), (str(len(self.run_.scans)), "0"), values)
            self.assertEqual(self.value(f"{ns}/localization", "searches late"), "0")

    def test_robot_is_found(self):
        for ns in ("nodelet", "node"):
            pose = self.messages(ns, "amcl_pose")[-1]
            x, y, theta = planar(pose.pose.pose)
            tx, ty, ttheta = self.run_.truth_at(pose.header.stamp.to_sec())
            self.assertLess(math.hypot(x - tx, y - ty), 0.15)
            self.assertLess(angle_between(theta, ttheta), math.radians(3))
            status = self.messages(ns, "localization_status")[-1]
            self.assertTrue(status.converged and status.phase == LocalizationStatus.TRACKING)
            self.assertGreater(status.match_quality, 0.8)
            self.assertEqual(pose.header.frame_id, "map")
            self.assertGreaterEqual(int(self.value(f"{ns}/localization", "places")), 1)
            self.assertGreater(float(self.value(f"{ns}/localization", "place probability")), 0.5)

    def test_live_equals_offline(self):
        out = os.path.join(self.run_.folder.name, "offline.tum")
        subprocess.run(["rosrun", "fsd_localization", "localize_offline", "--map", self.run_.yaml, "--bag", self.run_.bag,
                        "--trajectory", out], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(out) as file:
            offline = [[float(v) for v in line.split()] for line in file if not line.startswith("#")]
        for ns in ("nodelet", "node"):
            live = self.messages(ns, "amcl_pose")
            self.assertEqual(len(live), len(offline), ns)
            for msg, (stamp, x, y, _, _, _, qz, qw) in zip(live, offline):
                self.assertAlmostEqual(msg.header.stamp.to_sec(), stamp, places=6)
                lx, ly, ltheta = planar(msg.pose.pose)
                self.assertLess(math.hypot(lx - x, ly - y), 1e-6, f"{ns} at {stamp}")
                self.assertLess(angle_between(ltheta, 2 * math.atan2(qz, qw)), 1e-6, f"{ns} at {stamp}")

    def test_tf_is_told_once_converged_and_leads_to_the_robot(self):
        first = next(s.header.stamp for s in self.messages("nodelet", "localization_status") if s.converged)
        told = [t for m in self.tf.messages for t in m.transforms if t.header.frame_id == "map"]
        self.assertEqual({t.child_frame_id for t in told}, {"odom"})
        self.assertGreaterEqual(min(t.header.stamp for t in told), first)
        scans = [s for s in self.run_.scans if s.header.stamp >= first]
        self.assertEqual(len(told), len(scans), "one with each scan, between updates too")
        stamp = self.messages("nodelet", "amcl_pose")[-1].header.stamp
        last = next(t for t in told if abs((t.header.stamp - stamp).to_sec() - 0.1) < 1e-6).transform
        odom = next(t for m in self.tf.messages for t in m.transforms
                    if t.header.frame_id == "odom" and t.header.stamp == stamp).transform
        _, _, theta = planar(type("Pose", (), {"position": last.translation, "orientation": last.rotation}))
        x = last.translation.x + math.cos(theta) * odom.translation.x - math.sin(theta) * odom.translation.y
        y = last.translation.y + math.sin(theta) * odom.translation.x + math.cos(theta) * odom.translation.y
        px, py, _ = planar(self.messages("nodelet", "amcl_pose")[-1].pose.pose)
        self.assertLess(math.hypot(x - px, y - py), 1e-6)

    def test_what_rviz_shows(self):
        for ns in ("nodelet", "node"):
            field = self.messages(ns, "density_field")[-1]
            self.assertEqual((field.info.width, field.info.height), (self.run_.map.info.width, self.run_.map.info.height))
            for cell, density in zip(self.run_.map.data, field.data):
                self.assertTrue(1 <= density <= 98 if cell == 0 else density == 0)
            clouds = self.messages(ns, "particlecloud")
            self.assertTrue(clouds and all(0 < len(c.poses) <= 5000 for c in clouds))
            self.assertEqual({m.header.frame_id for m in self.messages(ns, "local_map")}, {"odom"})
            discs = [m for a in self.messages(ns, "fsd_markers") for m in a.markers if m.ns == "disc"]
            self.assertEqual({round(m.scale.x, 3) for m in discs}, {3.0, 6.0, 10.0})

    def test_densities_are_the_same_from_nodelet_and_node(self):
        a, b = self.messages("nodelet", "fsd_observation"), self.messages("node", "fsd_observation")
        self.assertGreater(len(a), 60)
        self.assertEqual([(m.header.stamp, m.soft, m.upper, m.frontiers) for m in a],
                         [(m.header.stamp, m.soft, m.upper, m.frontiers) for m in b])


if __name__ == "__main__":
    rospy.init_node("localization_bag_test")
    rostest.rosrun("hyselam_bringup", "localization_bag_test", LocalizationBagTest)
