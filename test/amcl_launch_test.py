#!/usr/bin/env python3
"""amcl's own launch file with the node's type changed: what a robot with amcl does goes on to work. Cases run in the
order of their names, on one node: it is told its pose, drives, is reconfigured, and looks for itself."""
import math
import unittest

import rospy
import rostest
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from nav_msgs.srv import GetMap, GetMapResponse, SetMap
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

from localization_rig import WAIT, Listener, Recording, angle_between, compose, make_map, planar, wait_until


class AmclLaunchTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Recording()
        cls.next = 0
        cls.log = Listener("/rosout_agg", Log)
        cls.poses = Listener("/amcl_pose", PoseWithCovarianceStamped)
        cls.clouds = Listener("/particlecloud", PoseArray)
        cls.told = Listener("/tf", TFMessage)
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=100)
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=10000)
        cls.tf_static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        cls.scan = rospy.Publisher("/scan", LaserScan, queue_size=1000)
        cls.initialpose = rospy.Publisher("/initialpose", PoseWithCovarianceStamped, queue_size=1)
        cls.tf_static.publish(TFMessage(cls.run_.static))
        cls.map_server = rospy.Service("/static_map", GetMap, lambda _: GetMapResponse(cls.run_.map))
        wait_until(lambda: cls.scan.get_num_connections() and cls.initialpose.get_num_connections()
                   and cls.tf.get_num_connections() > 1 and cls.clock.get_num_connections() > 1, "the node does not listen")
        wait_until(lambda: cls.said("map ready"), "no map was taken from the service static_map")

    @classmethod
    def said(cls, *words):
        return any(m.name == "/amcl" and all(w in m.msg for w in words) for m in cls.log.messages)

    @classmethod
    def drive(cls, scans):
        """The next scans with their odometry, faster than the robot drove, but not faster than the node."""
        for scan in cls.run_.scans[cls.next:cls.next + scans]:
            stamp = scan.header.stamp
            before = cls.run_.scans[cls.next - 1].header.stamp if cls.next else rospy.Time(0)
            cls.tf.publish(TFMessage([t for t in cls.run_.transforms if before < t.header.stamp <= stamp]))
            cls.clock.publish(Clock(stamp))
            told = len(cls.told.messages)
            cls.scan.publish(scan)
            cls.next += 1
            wait_until(lambda: any(t.header.frame_id == "map" and 0.0 < (t.header.stamp - stamp).to_sec() < 1.0
                                   for m in cls.told.messages[told:] for t in m.transforms), "no transform for a scan")

    def transforms(self):
        return [t for m in self.told.messages for t in m.transforms
                if (t.header.frame_id, t.child_frame_id) == ("map", "odom")]

    def assert_right(self, pose=None, meters=0.3, degrees=6.0):
        """By amcl_pose, the last one if none is given, and by tf."""
        pose = pose or self.poses.messages[-1]
        stamp = pose.header.stamp.to_sec()
        truth = self.run_.truth_at(stamp)
        x, y, theta = planar(pose.pose.pose)
        self.assertLess(math.hypot(x - truth[0], y - truth[1]), meters)
        self.assertLess(angle_between(theta, truth[2]), math.radians(degrees))
        self.assertEqual(pose.header.frame_id, "map")
        frame = lambda t: (t.translation.x, t.translation.y, 2 * math.atan2(t.rotation.z, t.rotation.w))
        last = min(self.transforms(), key=lambda t: abs(t.header.stamp.to_sec() - 0.1 - stamp))
        odom = min((t for t in self.run_.transforms if t.header.frame_id == "odom"),
                   key=lambda t: abs(t.header.stamp.to_sec() - stamp))
        x, y, _ = compose(frame(last.transform), frame(odom.transform))
        self.assertLess(math.hypot(x - truth[0], y - truth[1]), meters)

    def test_1_told_its_pose_it_drives(self):
        start = self.run_.scans[0].header.stamp
        self.clock.publish(Clock(start))
        pose = self.run_.truth_pose(start.to_sec())
        pose.header.stamp = rospy.Time(0)
        self.initialpose.publish(pose)
        wait_until(lambda: self.said("initial pose x"), "the initial pose was not taken")
        self.drive(len(self.run_.scans) // 3)
        wait_until(lambda: len(self.poses.messages) > 5 and self.transforms() and self.clouds.messages, "no pose, tf or cloud")
        self.assert_right()
        self.assertTrue(self.clouds.messages[-1].poses)

    def test_2_pose_is_on_the_parameter_server(self):
        wait_until(lambda: rospy.has_param("/amcl/initial_pose_x"), "no pose was saved")
        truth = [self.run_.truth_at(s.header.stamp.to_sec()) for s in self.run_.scans[:self.next]]
        x, y = rospy.get_param("/amcl/initial_pose_x"), rospy.get_param("/amcl/initial_pose_y")
        self.assertLess(min(math.hypot(x - t[0], y - t[1]) for t in truth), 0.3)
        self.assertGreater(rospy.get_param("/amcl/initial_cov_xx"), 0.0)
        self.assertGreater(rospy.get_param("/amcl/initial_cov_aa"), 0.0)

    def test_3_parameters_change_while_it_runs(self):
        try:
            from dynamic_reconfigure.client import Client
        except ImportError:
            self.skipTest("dynamic_reconfigure is missing here")
        client = Client("/amcl", timeout=WAIT)
        now = client.get_configuration(timeout=WAIT)
        self.assertEqual((now["max_particles"], now["odom_alpha3"], now["update_min_d"]), (5000, 0.8, 0.2))
        # At once, without another localiser.
        self.assertEqual(client.update_configuration({"transform_tolerance": 0.5})["transform_tolerance"], 0.5)
        self.assertEqual(self.maps_ready(), 1)
        told = len(self.transforms())
        self.drive(3)
        wait_until(lambda: len(self.transforms()) > told, "no transform")
        stamp = self.run_.scans[self.next - 1].header.stamp
        wait_until(lambda: any(abs((t.header.stamp - stamp).to_sec() - 0.5) < 1e-6 for t in self.transforms()),
                   "no transform dated 0.5 s ahead")
        client.update_configuration({"transform_tolerance": 0.1})
        # A new localiser, that goes on where the other one was.
        self.assertEqual(client.update_configuration({"update_min_d": 0.1})["update_min_d"], 0.1)
        wait_until(lambda: self.maps_ready() == 2, "no new localiser")
        poses = len(self.poses.messages)
        self.drive(len(self.run_.scans) // 4)
        wait_until(lambda: len(self.poses.messages) > poses + 3, "no poses after the change")
        self.assert_right()
        # What is not here, or only at the start, or makes no sense: refused, and said.
        self.assertEqual(client.update_configuration({"laser_model_type": "beam"})["laser_model_type"], "likelihood_field")
        wait_until(lambda: self.said("'laser_model_type'", "no effect"), "laser_model_type is not refused aloud")
        self.assertEqual(client.update_configuration({"odom_frame_id": "wheels"})["odom_frame_id"], "odom")
        wait_until(lambda: self.said("'odom_frame_id'", "start only"), "odom_frame_id is not refused aloud")
        refused = client.update_configuration({"min_particles": 9000, "update_min_a": 0.3})
        self.assertEqual((refused["min_particles"], refused["update_min_a"]), (500, 0.5))
        wait_until(lambda: self.said("stay as they are"), "more min_particles than max_particles")
        self.assertEqual(client.update_configuration({"restore_defaults": True})["update_min_d"], 0.2)
        # The next start shall not warn of what nobody set; what the launch file sets stays.
        wait_until(lambda: not rospy.has_param("/amcl/do_beamskip"), "amcl's unused parameters are left behind")
        self.assertTrue(rospy.has_param("/amcl/odom_alpha5"))
        client.close()

    def maps_ready(self):
        return sum(m.name == "/amcl" and "map ready" in m.msg for m in self.log.messages)

    def test_4_pose_of_a_map_that_takes_its_time_moves_with_the_robot(self):
        map_, side = self.run_.map, 2500
        info = map_.info
        # A hall beside the building, which gives the preparation work.
        rows = [list(map_.data[r * info.width:(r + 1) * info.width]) + [0] * side for r in range(info.height)]
        rows += [[-1] * info.width + [0] * side for _ in range(side - info.height)]
        large = make_map([v for row in rows for v in row], info.width + side, len(rows), info.resolution,
                         info.origin.position.x, info.origin.position.y)
        ready = self.maps_ready()
        stamp = self.run_.scans[self.next - 1].header.stamp.to_sec()
        self.assertTrue(rospy.ServiceProxy("/set_map", SetMap)(large, self.run_.truth_pose(stamp)).success)
        start = self.run_.truth_at(stamp)
        while self.moved(start) < 0.6:
            self.drive(1)
        self.assertEqual(self.maps_ready(), ready, "the map was ready too soon for this test")
        wait_until(lambda: self.maps_ready() > ready, "the large map is never ready")
        poses = len(self.poses.messages)
        while len(self.poses.messages) <= poses:
            self.drive(1)
        self.assert_right(self.poses.messages[poses])

    def moved(self, start):
        x, y, _ = self.run_.truth_at(self.run_.scans[self.next - 1].header.stamp.to_sec())
        return math.hypot(x - start[0], y - start[1])

    def test_5_services(self):
        poses = len(self.poses.messages)
        rospy.ServiceProxy("/request_nomotion_update", Empty)()
        self.drive(1)
        wait_until(lambda: len(self.poses.messages) > poses, "no update without motion")
        stamp = self.run_.scans[self.next - 1].header.stamp.to_sec()
        self.assertTrue(rospy.ServiceProxy("/set_map", SetMap)(self.run_.map, self.run_.truth_pose(stamp)).success)
        poses = len(self.poses.messages)
        self.drive(len(self.run_.scans) // 8)
        wait_until(lambda: len(self.poses.messages) > poses + 1, "no poses after the map was set")
        self.assert_right()
        rospy.ServiceProxy("/global_localization", Empty)()
        wait_until(lambda: self.said("searching the whole map"), "global_localization")


if __name__ == "__main__":
    rospy.init_node("amcl_launch_test")
    rostest.rosrun("hyselam_bringup", "amcl_launch_test", AmclLaunchTest)
