#!/usr/bin/env python3
"""The doctor at robots that are well and robots that are not: each ill is told by name, the healthy are let go."""
import copy
import json
import math
import os
import re
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import OccupancyGrid, Odometry
from roslib.packages import find_node
from hyselam_msgs.msg import LocalizationStatus
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from geometry_msgs.msg import TransformStamped

from localization_rig import Recording, free_port, wait_until, WAIT

ENOUGH_TO_SEE_THE_MOUNT = 250  # scans: the robot has gone some metres and turned


def transform(parent, child, stamp, rotation=(0.0, 0.0, 0.0, 1.0)):
    t = TransformStamped()
    t.header.frame_id, t.child_frame_id, t.header.stamp = parent, child, stamp
    r = t.transform.rotation
    r.x, r.y, r.z, r.w = rotation
    return t


def upside_down(scan):
    """What the same laser sees when it hangs upside down: its beams go round the other way."""
    scan = copy.deepcopy(scan)
    scan.angle_min, scan.angle_max = -scan.angle_max, -scan.angle_min
    scan.ranges = scan.ranges[::-1]
    return scan


def wait_at_rest(process):
    """Until it has heard and thought of all that it was sent: for half a second none of its threads has anything to do."""
    def runs():
        for task in os.listdir(f"/proc/{process.pid}/task"):
            try:
                with open(f"/proc/{process.pid}/task/{task}/stat") as file:
                    if file.read().rpartition(")")[2].split()[0] in "RD":
                        return True
            except OSError:
                pass  # it has ended
        return False
    quiet = [0]

    def rests():
        quiet[0] = 0 if process.poll() is None and runs() else quiet[0] + 1
        return quiet[0] > 50
    wait_until(rests, "the doctor is still busy")


def later(recording, seconds):
    """The same run, begun later."""
    moved = copy.copy(recording)
    for name in ("scans", "transforms"):
        messages = copy.deepcopy(getattr(recording, name))
        for msg in messages:
            msg.header.stamp = rospy.Time.from_sec(msg.header.stamp.to_sec() + seconds)
        setattr(moved, name, messages)
    return moved


class DoctorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recording = Recording("small")
        cls.folder = tempfile.TemporaryDirectory()
        cls.doctor = find_node("hyselam_bringup", "doctor")[0]  # rosrun hands no signal on

    def setUp(self):
        rospy.set_param("/use_sim_time", True)
        self.sent = {"/clock": 0, "/tf": 0, "/scan": 0}

    def call(self, play, *arguments, uri=None):
        """The doctor's exit status and findings; `play` feeds the robot meanwhile, and ends the watching when all is said."""
        path = os.path.join(self.folder.name, "findings.json")
        environment = dict(os.environ, ROS_MASTER_URI=uri) if uri else None
        doctor = subprocess.Popen([self.doctor, "--seconds", str(WAIT) if play else "1", "--json", path, *arguments],
                                  env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            if play:
                play(doctor)
            self.said, _ = doctor.communicate(timeout=WAIT)
        finally:
            doctor.kill()  # one that is left would be taken for that of the next case
            doctor.wait()
        with open(path) as file:
            return doctor.returncode, json.load(file)["findings"]

    def wrong(self, findings, name):
        return " | ".join(f"{f['text']} {f['hint']}" for f in findings if f["name"] == name and f["level"] == "WRONG")

    def robot(self, scan_of=lambda s: s, static=None, topic="scan", odom="odom", pose=True, grid=True, back=False, clock=True,
              says=None, scans=50, runs=""):
        """A player of the recording: clock, scans, tf, a map and a pose in it; `says`: what layers tell, by their names, of version `runs`."""
        def play(doctor):
            publish = {
                "clock": rospy.Publisher("/clock", Clock, queue_size=1000),
                "tf": rospy.Publisher("/tf", TFMessage, queue_size=5000),
                "static": rospy.Publisher("/tf_static", TFMessage, queue_size=10, latch=True),
                "scan": rospy.Publisher(topic, LaserScan, queue_size=1000),
                "said": rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10, latch=True)}
            if grid:
                publish["map"] = rospy.Publisher("map", OccupancyGrid, queue_size=2, latch=True)
            if not clock:
                publish.pop("clock").unregister()
            try:
                # The doctor has to know of the publishers when it asks the master; then it subscribes.
                publish["static"].publish(TFMessage(self.recording.static if static is None else static))
                publish["said"].publish(DiagnosticArray(status=[DiagnosticStatus(1, name, message, runs, [])
                                                                for name, message in (says or {}).items()]))
                if grid:
                    publish["map"].publish(self.recording.map if grid is True else grid)
                # /diagnostics is what it subscribes to last.
                wait_until(lambda: all(publish[n].get_num_connections() > 0 for n in ("tf", "static", "said")) or
                           doctor.poll() is not None, "the doctor does not listen")
                wait_at_rest(doctor)
                moving = self.recording.scans[:scans]
                transforms = iter(self.recording.transforms)
                next_tf = next(transforms)
                for i, scan in enumerate(moving):
                    if doctor.poll() is not None:
                        break
                    stamp = scan.header.stamp
                    if clock:
                        publish["clock"].publish(Clock(stamp - rospy.Duration(1 if back and i == scans // 2 else 0)))
                    while next_tf.header.stamp <= stamp + rospy.Duration(0.1):
                        t = copy.deepcopy(next_tf)
                        if t.header.frame_id == "odom":
                            t.header.frame_id = odom
                        publish["tf"].publish(TFMessage([t]))
                        next_tf = next(transforms)
                    if pose:
                        publish["tf"].publish(TFMessage([transform("map", odom, stamp)]))
                    publish["scan"].publish(scan_of(scan))
                    time.sleep(0.01)
                wait_at_rest(doctor)
                doctor.send_signal(signal.SIGINT)
                doctor.wait(WAIT)
            finally:
                for publisher in publish.values():
                    publisher.unregister()
        return play

    def test_no_master(self):
        status, findings = self.call(None, uri="http://localhost:9")
        self.assertEqual(status, 1)
        self.assertIn("no ROS master answers at http://localhost:9", self.wrong(findings, "master"))

    def test_nothing_runs(self):
        status, findings = self.call(None)
        self.assertEqual(status, 1)
        self.assertIn("nobody publishes /scan", self.wrong(findings, "scan"))
        self.assertIn("nobody publishes /map", self.wrong(findings, "map"))
        self.assertIn("tf has no frame odom and no frame base_link", self.wrong(findings, "tf"))
        self.assertIn("nobody publishes /clock: time stands still", self.wrong(findings, "clock"))

    def test_a_master_under_which_nothing_runs(self):
        port = free_port()
        master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            def answers():
                with socket.socket() as s:
                    return s.connect_ex(("localhost", port)) == 0
            wait_until(answers, "no master")
            status, findings = self.call(None, uri=f"http://localhost:{port}")
        finally:
            master.terminate()
            master.wait()
        self.assertEqual(status, 1)
        self.assertIn(f"nothing runs under the master http://localhost:{port}", self.wrong(findings, "nodes"), self.said)
        self.assertIn("roslaunch hyselam_bringup hyselam.launch", self.wrong(findings, "nodes"))
        self.assertEqual(len(findings), 1, "what follows from it is not told")

    def test_a_healthy_robot_is_let_go(self):
        status, findings = self.call(self.robot(scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertEqual(status, 0, self.said)
        self.assertIn("mounted as tf says", " ".join(f["text"] for f in findings if f["name"] == "laser" and f["level"] == "ok"))

    def test_a_laser_upside_down(self):
        status, findings = self.call(self.robot(scan_of=upside_down, scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertEqual(status, 1)
        self.assertIn("mounted upside down:", self.wrong(findings, "laser"), self.said)

    def test_a_laser_upside_down_that_tf_knows_of(self):
        static = copy.deepcopy(self.recording.static)
        for t in static:
            t.transform.rotation.x, t.transform.rotation.w = 1.0, 0.0
        status, _ = self.call(self.robot(scan_of=upside_down, static=static, scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertEqual(status, 0, self.said)

    def test_a_laser_backwards(self):
        static = copy.deepcopy(self.recording.static)
        for t in static:
            t.transform.rotation.z, t.transform.rotation.w = 1.0, 0.0
        status, findings = self.call(self.robot(static=static, scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertEqual(status, 1)
        self.assertIn("mounted backwards:", self.wrong(findings, "laser"), self.said)

    def test_a_laser_some_centimetres_and_degrees_beside_its_place(self):
        static = copy.deepcopy(self.recording.static)
        for t in static:
            t.transform.translation.x += 0.08
            t.transform.rotation.z, t.transform.rotation.w = math.sin(math.radians(2.5)), math.cos(math.radians(2.5))
        status, findings = self.call(self.robot(static=static, scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertEqual(status, 1)
        said = self.wrong(findings, "laser")
        self.assertIn("it is not where tf says", said, self.said)
        off = [float(number) for number in re.findall(r"(?:x|y|heading) ([+-][0-9.]+)", said)]
        self.assertAlmostEqual(off[0], -0.08, delta=0.03, msg=said)
        self.assertAlmostEqual(off[2], -5.0, delta=1.0, msg=said)

    def test_wrong_frame_no_pose_and_no_free_map(self):
        grid = copy.deepcopy(self.recording.map)
        grid.data = [-1] * len(grid.data)
        status, findings = self.call(self.robot(odom="odom_combined", pose=False, grid=grid))
        self.assertEqual(status, 1)
        self.assertIn("tf has no frame odom; it has base_link", self.wrong(findings, "tf"), self.said)
        self.assertIn("it has no free cell", self.wrong(findings, "map"))

    def test_what_is_missing_hides_nothing_of_the_rest(self):
        grid = copy.deepcopy(self.recording.map)
        grid.data, grid.header.frame_id = [-1] * len(grid.data), "plan"
        _, findings = self.call(self.robot(topic="base_scan", odom="odom_combined", static=[], pose=False, grid=grid))
        for name, told in (("scan", "start with scan:=/base_scan"), ("tf", "tf has no frame odom"), ("tf", "static_transform_publisher"),
                           ("tf", "start SLAM or a localisation"), ("map", "it has no free cell"), ("map", "it is in the frame 'plan'")):
            self.assertIn(told, self.wrong(findings, name), self.said)

    def test_the_laser_is_looked_at_under_other_names_of_topic_and_frame(self):
        _, findings = self.call(self.robot(scan_of=upside_down, topic="base_scan", odom="odom_combined", scans=ENOUGH_TO_SEE_THE_MOUNT))
        self.assertIn("start with scan:=/base_scan", self.wrong(findings, "scan"), self.said)
        self.assertIn("tf has no frame odom", self.wrong(findings, "tf"))
        self.assertIn("mounted upside down:", self.wrong(findings, "laser"))

    def test_what_does_not_load_is_told(self):
        def tells(scan):
            rospy.logfatal("[/slam] not loaded: parameter 'state' is /w/slam.state")
            return scan
        status, findings = self.call(self.robot(scan_of=tells))
        self.assertEqual(status, 1)
        self.assertRegex(self.wrong(findings, "log"), r"\[/slam\] not loaded: parameter 'state' is /w/slam.state \(\d+ times in ", self.said)

    def test_no_mount_and_no_pose(self):
        _, findings = self.call(self.robot(static=[], pose=False))
        self.assertIn("static_transform_publisher", self.wrong(findings, "tf"), self.said)
        self.assertIn("nobody publishes map -> odom", self.wrong(findings, "tf"))

    def test_other_topic_other_type_time_goes_back(self):
        wrong = rospy.Publisher("floor", String, queue_size=1, latch=True)
        try:
            _, findings = self.call(self.robot(topic="base_scan", back=True), "map:=floor")
        finally:
            wrong.unregister()
        self.assertIn("start with scan:=/base_scan", self.wrong(findings, "scan"), self.said)
        self.assertIn("/floor is a std_msgs/String", self.wrong(findings, "map"))
        self.assertIn("the time of /clock went back by", self.wrong(findings, "clock"))

    def test_an_old_bag_without_clock_and_a_blind_laser(self):
        rospy.set_param("/use_sim_time", False)

        def blind(scan):
            scan = copy.deepcopy(scan)
            scan.ranges = [float("inf")] * len(scan.ranges)
            return scan
        _, findings = self.call(self.robot(scan_of=blind, clock=False))
        self.assertIn("s ago a bag needs use_sim_time", self.wrong(findings, "clock"), self.said)
        self.assertIn("no beam ever returns", self.wrong(findings, "scan"))

    def test_scans_of_another_time_than_the_clock(self):
        for shift, text in ((-100, "ago"), (100, "ahead")):
            def moved(scan):
                scan = copy.deepcopy(scan)
                scan.header.stamp = rospy.Time.from_sec(scan.header.stamp.to_sec() + shift)
                return scan
            start, self.recording = self.recording, later(self.recording, 1000)
            try:
                _, findings = self.call(self.robot(scan_of=moved, says={"slam: SLAM": "0 keyframes"}, pose=False))
            finally:
                self.recording = start
            self.assertRegex(self.wrong(findings, "clock"), rf"scans are stamped (99|100)\.\d s {text}", self.said)
            self.assertIn("slam runs, but lacks the input reported here", self.wrong(findings, "tf"))

    def test_a_bag_played_without_its_clock(self):
        silent = rospy.Publisher("/clock", Clock, queue_size=1)  # as rosbag announces it
        try:
            _, findings = self.call(self.robot(clock=False))
        finally:
            silent.unregister()
        self.assertIn("/clock stands still play the bag with --clock", self.wrong(findings, "clock"), self.said)

    def test_a_mount_that_is_not_latched(self):
        silent = rospy.Publisher("/tf_static", TFMessage, queue_size=1)
        try:
            _, findings = self.call(self.robot(static=[]))
        finally:
            silent.unregister()
        self.assertIn("publishes /tf_static, but late subscribers receive nothing: it has to be latched",
                      self.wrong(findings, "tf"), self.said)

    def test_odometry_without_tf(self):
        topic = rospy.Publisher("wheels", Odometry, queue_size=1)
        try:
            _, findings = self.call(self.robot(odom="odom_combined", pose=False))
        finally:
            topic.unregister()
        self.assertIn("/wheels is published, but the layers need tf", self.wrong(findings, "tf"), self.said)

    def test_frames_as_the_launch_files_take_them(self):
        status, _ = self.call(self.robot(odom="odom_combined"), "odom_frame:=odom_combined")
        self.assertEqual(status, 0, self.said)

    def test_no_layer_runs(self):
        _, findings = self.call(self.robot(pose=False, grid=False))
        self.assertIn("start SLAM or a localisation: roslaunch hyselam_bringup hyselam.launch", self.wrong(findings, "tf"), self.said)
        self.assertIn("hyselam.launch map:=/path/map.yaml", self.wrong(findings, "map"))
        self.assertTrue([f for f in findings if f["name"] == "nodes" and f["level"] == "note"])

    def test_localisation_that_waits(self):
        """For a map, of which the layers' own grids are none; for a way by which it finds itself."""
        own = rospy.Publisher("local_map", OccupancyGrid, queue_size=1)
        try:
            _, findings = self.call(self.robot(pose=False, grid=False, says={"localization: localisation": "waiting for a map"}))
            self.assertIn("localization runs, and reports: waiting for a map", self.wrong(findings, "tf"), self.said)
            self.assertNotIn("local_map", self.wrong(findings, "map"))
            _, findings = self.call(self.robot(pose=False, says={"localization: localisation": "global, not converged"}))
            self.assertIn("has not converged yet", self.wrong(findings, "tf"), self.said)
            self.assertIn("2D Pose Estimate", self.wrong(findings, "tf"))
        finally:
            own.unregister()

    def test_a_layer_is_known_under_any_name_of_its_node(self):
        """As where it takes amcl's place; amcl itself is none."""
        told = {"amcl: localisation": "global, not converged"}
        _, findings = self.call(self.robot(pose=False, says=told, runs="HySeLAM 1.0.0"))
        self.assertIn("localization runs, but has not converged yet", self.wrong(findings, "tf"), self.said)
        self.assertNotIn("no layer", self.said)
        _, findings = self.call(self.robot(pose=False, says={"amcl: Standard deviation": "too large"}, runs="HySeLAM 1.0.0"))
        self.assertIn("no layer publishes /diagnostics", self.said)

    def test_the_scans_that_the_layers_read_are_meant(self):
        status = rospy.Publisher("localization_status", LocalizationStatus, queue_size=1)
        reader = rospy.Subscriber("base_scan", LaserScan, lambda _: None)
        try:
            code, findings = self.call(self.robot(topic="base_scan"))
            self.assertEqual(code, 0, self.said)
            self.assertTrue([f for f in findings if f["name"] == "scan" and f["level"] == "ok"], self.said)
            _, findings = self.call(self.robot(topic="base_scan"), "--scan", "scan")
            self.assertIn("nobody publishes /scan", self.wrong(findings, "scan"), "another one was asked for")
        finally:
            reader.unregister()
            status.unregister()

    def test_the_version_that_runs_is_told_beside_the_installed_one(self):
        installed = subprocess.run(["rosrun", "hyselam_bringup", "doctor", "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
        says = {"slam: SLAM": "38 keyframes"}
        for runs, level, text in ((installed, "ok", f"{installed} runs"), ("HySeLAM 0.9.0", "note", f"HySeLAM 0.9.0 runs, {installed} is installed here")):
            _, findings = self.call(self.robot(says=says, runs=runs))
            self.assertEqual([(f["level"], f["text"]) for f in findings if f["name"] == "version"], [(level, text)], self.said)
        _, findings = self.call(self.robot(says=says))
        self.assertFalse([f for f in findings if f["name"] == "version"], "of a program of before 1.0.0 nothing is known")

    def test_a_robot_in_a_namespace(self):
        """Its layers are meant, not another one's; who forgets the namespace is told of it."""
        told = {"robot1/slam: SLAM": "no scans", "robot2/slam: SLAM": "38 keyframes"}
        _, findings = self.call(self.robot(pose=False, says=told))
        self.assertIn("no layer runs in this namespace, but in /robot1, /robot2", self.wrong(findings, "nodes"), self.said)
        self.assertIn("ROS_NAMESPACE=robot1 rosrun hyselam_bringup doctor odom_frame:=robot1/odom", self.wrong(findings, "nodes"))
        self.assertNotIn("38 keyframes", self.said)
        _, findings = self.call(self.robot(odom="robot1/odom", topic="robot1/scan", pose=False, says=told), "__ns:=robot1")
        self.assertIn("is it robot1/odom?", self.wrong(findings, "tf"), self.said)
        self.assertIn("slam: SLAM: no scans", self.said)
        self.assertNotIn("38 keyframes", self.said)

    def test_slam_that_starves(self):
        """It announces a map that it cannot draw: the driver of the map is not to blame."""
        announced = rospy.Publisher("map", OccupancyGrid, queue_size=1)
        try:
            _, findings = self.call(self.robot(topic="elsewhere", pose=False, grid=False, says={"slam: SLAM": "0 keyframes; no scans"}))
        finally:
            announced.unregister()
        self.assertIn("slam runs, but lacks the input reported here", self.wrong(findings, "tf"), self.said)
        self.assertIn("SLAM has published no /map", self.wrong(findings, "map"))
        self.assertNotIn("ROS_IP", self.wrong(findings, "map"))

    def test_a_camera_that_is_missing(self):
        told = {"semantic_localization: visual places": "nothing has been learnt; no images on /camera/color/image_raw"}
        eye = rospy.Publisher("eye", Image, queue_size=1)
        try:
            status, findings = self.call(self.robot(says=told))
        finally:
            eye.unregister()
        self.assertEqual(status, 1)
        self.assertIn("no images on /camera/color/image_raw", self.wrong(findings, "camera"), self.said)
        self.assertIn("there is /eye: start with image:=/eye", self.wrong(findings, "camera"))

    def test_two_localisations(self):
        other = subprocess.Popen(["rosrun", "tf2_ros", "static_transform_publisher", "0", "0", "0", "0", "0", "0", "map", "odom"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_until(lambda: any("static_transform_publisher" in node for topic, nodes in rospy.get_master().getSystemState()[2][0]
                                   for node in nodes if topic == "/tf_static"), "the other localisation")
            _, findings = self.call(self.robot())
        finally:
            other.terminate()
            other.wait()
        self.assertIn("map -> odom is published by", self.wrong(findings, "tf"), self.said)
        self.assertFalse([f for f in findings if f["name"] == "tf" and f["level"] == "ok"], self.said)

    def test_ctrl_c_ends_the_watching_only(self):
        def interrupt(doctor):
            said = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1)
            wait_until(lambda: said.get_num_connections() > 0, "the doctor does not listen")
            doctor.send_signal(signal.SIGINT)
            said.unregister()
        status, findings = self.call(interrupt)
        self.assertEqual(status, 1)
        self.assertIn("nobody publishes /scan", self.wrong(findings, "scan"), self.said)
        self.assertNotIn("Traceback", self.said)

    def test_usage(self):
        done = subprocess.run(["rosrun", "hyselam_bringup", "doctor", "--seconds", "0"], stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--seconds", done.stderr)


if __name__ == "__main__":
    rospy.init_node("doctor_test")
    rostest.rosrun("hyselam_bringup", "doctor_test", DoctorTest)
