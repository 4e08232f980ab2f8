#!/usr/bin/env python3
"""Scans, odometry, files and parameters that are not as they should be, and the services: SLAM says what it cannot
use, stays alive and goes on, also after it was killed."""
import math
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from hyselam_msgs.srv import StatePath
from nav_msgs.msg import OccupancyGrid
from roslib.packages import find_node
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

sys.dont_write_bytecode = True
from localization_rig import WAIT, Listener, Recording, Rig, angle_between, compose, forget_dead, inverse, load_nodelet, wait_until


class SlamRig(Rig):
    """SLAM as a nodelet, or as a process that can be killed."""

    def __init__(self, name, recording, process=False, **params):
        self.process_wanted, self.process, self.map_heard = process, None, None
        super().__init__(name, recording, kind="Slam", **params)
        self.map_heard = Listener(f"/{name}/map", OccupancyGrid)

    @classmethod
    def set_clock(cls, seconds):
        Rig.set_clock(seconds)  # one clock for all kinds of rigs

    def load(self, kind):
        if self.process_wanted:
            self.start()
            return True
        return load_nodelet("ngram_slam/NgramSlam", self.node, {"/diagnostics": f"/{self.name}/diagnostics"})

    def start(self):
        program = find_node("ngram_slam", "slam_node")[0]
        self.process = subprocess.Popen([program, "__name:=slam", f"__ns:=/{self.name}",
                                         f"/diagnostics:=/{self.name}/diagnostics"])

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        wait_until(lambda: self.scan.get_num_connections() == 0, "the dead node is still connected")
        forget_dead(self.node)
        self.sent = 0

    def close(self):
        if self.process:
            self.process.send_signal(signal.SIGINT)  # by SIGTERM it would stay registered
            self.process.wait()
            self.loaded = False
        if self.map_heard:
            self.map_heard.close()
        super().close()
        self.loaded = False  # once is enough

    def call(self, service, kind=Trigger, *args):
        rospy.wait_for_service(f"{self.node}/{service}", WAIT)
        return rospy.ServiceProxy(f"{self.node}/{service}", kind)(*args)

    def odometry_at(self, stamp):
        best = min((t for t in self.recording.transforms if t.header.frame_id == "odom"),
                   key=lambda t: abs(t.header.stamp.to_sec() - stamp))
        q, p = best.transform.rotation, best.transform.translation
        return p.x, p.y, 2 * math.atan2(q.z, q.w)

    def error(self, start=0):
        """Distance [m] and angle [deg] of the robot from where it is in truth, in a map that began at scan `start`."""
        first = self.recording.scans[start].header.stamp.to_sec()
        stamp = self.recording.scans[self.next - 1].header.stamp.to_sec()
        wait_until(lambda: self.odom_in_map(), lambda: f"no transform: {self.values()}")
        pose = compose(self.odom_in_map()[-1][1], self.odometry_at(stamp))
        # The map begins where odometry is.
        truth = compose(self.odometry_at(first), compose(inverse(self.recording.truth_at(first)),
                                                         self.recording.truth_at(stamp)))
        return math.hypot(pose[0] - truth[0], pose[1] - truth[1]), math.degrees(angle_between(pose[2], truth[2]))


class SlamInputTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recording = Recording()
        cls.folder = tempfile.TemporaryDirectory()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def rig(self, **params):
        name = self._testMethodName + ("" if "name" not in params else params.pop("name"))
        rig = SlamRig(name, self.recording, **params)
        self.addCleanup(rig.close)
        return rig

    def assert_right(self, rig):
        metres, degrees = rig.error()
        self.assertLess(metres, 0.1)
        self.assertLess(degrees, 2.0)

    def test_parameters_out_of_range_stop_only_this_nodelet(self):
        for i, (name, value) in enumerate((("resolution", 0.0), ("loops", "some"), ("global_frame_id", "odom"),
                                           ("keyframe_step", -1.0), ("occupied_ratio", 1.0),
                                           ("state", "/no/such/folder/map.slam"), ("save_period", -1.0))):
            rig = self.rig(name=str(i), **{name: value})
            self.assertFalse(rig.loaded, name)
            rig.wait_said(name, f"{value:g}" if isinstance(value, float) else value, level=Log.FATAL)
            if name == "state":
                rig.wait_said("work_dir", "mkdir -p /no/such/folder", level=Log.FATAL)
        rig = self.rig(name="good")
        rig.feed(3)
        self.assertEqual(rig.value("scans used"), "3")

    def test_unknown_parameters_are_told(self):
        rig = self.rig(keyframe_stepp=0.5)
        rig.wait_said("keyframe_stepp", "keyframe_step", level=Log.WARN)

    def test_a_state_that_cannot_be_used_is_put_aside(self):
        path = self.path("none.slam")
        contents = "P5 3 3 255\n", "again\n"
        for name, content, kept in (("first", contents[0], path + ".damaged"), ("again", contents[1], path + ".damaged.2")):
            with open(path, "w") as file:
                file.write(content)
            rig = self.rig(name=name, state=path, save_period=0.0)
            self.assertTrue(rig.loaded)
            rig.wait_said("begins a new map", path, "is no state of SLAM", kept, level=Log.ERROR)
            self.assertFalse(os.path.exists(path))
            rig.feed(60)
            self.assert_right(rig)
            self.assertIn("a new map was begun, the one before is kept as " + kept, rig.fresh_diagnosis().message)
            # Told until people save or load one.
            self.assertTrue(rig.call("save", StatePath, "").success)
            self.assertNotIn("a new map was begun", rig.fresh_diagnosis().message)
            rig.close()
            with open(kept) as file:
                self.assertEqual(file.read(), content)
        with open(path + ".damaged") as file:
            self.assertEqual(file.read(), contents[0], "what was put aside before stays")
        # Saved at the end as well, and gone on with.
        rig = self.rig(name="goes_on", state=path)
        rig.feed(1)
        self.assertEqual(rig.value("runs"), "2")

    def test_a_state_that_can_neither_be_used_nor_renamed_is_never_written(self):
        rig = self.rig(state="/proc/version")  # not even by root
        self.assertTrue(rig.loaded)
        rig.feed(20)
        self.assertIn("not saved: /proc/version: byte 0: is no state of SLAM", rig.fresh_diagnosis().message)
        self.assertIn("none given", rig.call("save", StatePath, "").message)

    def test_damaged_states_are_refused_and_the_map_stays(self):
        rig = self.rig()
        rig.feed(60)
        self.assertFalse(rig.call("save", StatePath, "").success)  # no name given, none known
        good = self.path("good.slam")
        self.assertTrue(rig.call("save", StatePath, good).success)
        with open(good, "rb") as file:
            whole = file.read()
        keyframes = rig.fresh_diagnosis().message
        for name, content, reason in (("cut", whole[:-9], "truncated"), ("empty", b"", "is no state of SLAM"),
                                      ("bits", whole[:500] + bytes([whole[500] ^ 1]) + whole[501:], "damaged"),
                                      ("version", whole[:8] + b"\x09" + whole[9:], "version")):
            path = self.path(name)
            with open(path, "wb") as file:
                file.write(content)
            answer = rig.call("load", StatePath, path)
            self.assertFalse(answer.success, name)
            self.assertIn(path, answer.message)
            self.assertIn(reason, answer.message)
        self.assertIn("does not exist", rig.call("load", StatePath, self.path("nowhere")).message.replace(
            "cannot be opened", "does not exist").replace("No such file", "does not exist"))
        self.assertFalse(rig.call("save", StatePath, "/no/such/folder/map.slam").success)
        self.assertEqual(rig.fresh_diagnosis().message, keyframes)
        rig.feed(40)
        self.assert_right(rig)
        self.assertTrue(rig.call("load", StatePath, good).success)
        rig.feed(40)
        self.assert_right(rig)
        self.assertEqual(rig.value("runs"), "2")

    def test_killed_and_started_again_it_goes_on(self):
        path = self.path("killed.slam")
        rig = self.rig(process=True, state=path, save_period=0.0, map_update_interval=0.5)
        rig.feed(120)
        answer = rig.call("save", StatePath, "")
        self.assertTrue(answer.success, answer.message)
        self.assertIn(path, answer.message)
        self.assert_right(rig)
        rig.feed(10)  # lost
        keyframes = int(rig.value("keyframes"))
        rig.kill()
        with open(path, "rb") as file:
            saved = file.read()
        maps = len(rig.map_heard.messages)
        rig.diagnostics_seen.messages.clear()
        rig.tf_seen.messages.clear()
        rig.start()
        wait_until(lambda: rig.scan.get_num_connections() > 0 and Rig.tf.get_num_connections() > 1, "not connected")
        rig.map_heard.wait(maps + 1)  # that of the state, before the first scan
        rig.wait_value("since the last session", "not known: the session is not tied to the map")
        rig.feed(40)
        self.assert_right(rig)
        rig.feed(60)
        self.assertEqual(rig.value("runs"), "2")
        self.assertGreater(int(rig.value("keyframes")), keyframes)
        wait_until(lambda: rig.value("since the last session").startswith("not known") == (rig.value("place of the run") != "tied"),
                   "changes are known where the run is tied")
        self.assert_right(rig)
        # The end saves as well; a damaged file is put aside with the reason, and a new map begun.
        rig.process.send_signal(signal.SIGINT)
        self.assertEqual(rig.process.wait(), 0)
        with open(path, "rb") as file:
            self.assertGreater(len(file.read()), len(saved))
        with open(path, "wb") as file:
            file.write(saved[:1000])
        rig.diagnostics_seen.messages.clear()
        rig.start()
        wait_until(lambda: rig.diagnosis() and "truncated" in rig.diagnosis().message, lambda: str(rig.diagnosis()))
        self.assertEqual(rig.value("keyframes"), "0")
        with open(path + ".damaged", "rb") as file:
            self.assertEqual(file.read(), saved[:1000])

    def test_sessions_end_while_it_drives(self):
        rig = self.rig(session_path=3.0)
        for _ in range(3):
            rig.feed(60)
            self.assert_right(rig)
        wait_until(lambda: rig.feed(1) or int(rig.value("sessions ended")) >= 2, "no session ends")
        rig.feed(20)
        self.assert_right(rig)
        self.assertEqual(int(rig.value("runs")), int(rig.value("sessions ended")) + 1)
        self.assertEqual(rig.value("place of the run"), "tied")
        self.assertEqual(rig.value("times lost"), "0")

    def test_pause_and_resume(self):
        rig = self.rig()
        rig.feed(80)
        keyframes = rig.value("keyframes")
        self.assertTrue(rig.call("pause").success)
        rig.feed(30)
        self.assertEqual(rig.value("keyframes"), keyframes)
        self.assertEqual(rig.value("scans while paused"), "30")
        self.assertIn("paused", rig.diagnosis().message)
        self.assertEqual(rig.call("pause").message, "paused already")
        self.assertTrue(rig.call("resume").success)
        rig.feed(60)
        self.assertNotIn("paused", rig.fresh_diagnosis().message)
        self.assert_right(rig)
        self.assertEqual(rig.call("resume").message, "was not paused")

    def test_scans_without_transform_are_dropped(self):
        rig = self.rig(transform_wait=1.0)  # long enough for a busy machine's transforms
        rig.feed(5, with_tf=False)
        self.assertEqual(rig.value("dropped: no transform"), "5")
        self.assertEqual(rig.value("keyframes"), "0")
        # The clock went on while the transforms were waited for: on with scans that are not late already.
        while self.recording.scans[rig.next].header.stamp.to_sec() <= rig.now:
            rig.next += 1
        start = rig.next
        rig.feed(60)
        self.assertEqual(rig.value("scans used"), "60")
        metres, _ = rig.error(start)
        self.assertLess(metres, 0.1)

    def test_bad_scans_are_refused(self):
        rig = self.rig()
        rig.feed(10)

        def no_increment(scan):
            scan.angle_increment = 0.0

        def no_ranges(scan):
            scan.ranges = []

        def nothing_seen(scan):
            scan.ranges = [float("nan")] * len(scan.ranges)
        rig.feed(1, no_increment)
        rig.feed(1, no_ranges)
        self.assertEqual(rig.value("dropped: refused"), "2")
        rig.feed(3, nothing_seen)  # odometry alone
        rig.feed(60)
        self.assert_right(rig)

    def test_time_going_back(self):
        rig = self.rig()
        rig.feed(150)
        # The bag begins again.
        rig.next = 0
        rig.set_clock(self.recording.scans[0].header.stamp.to_sec() - 0.5)
        rig.tf_seen.messages.clear()
        rig.wait_value("time went back", 1)
        rig.feed(120)
        self.assertEqual(rig.value("time went back"), "1")
        self.assertEqual(rig.value("runs"), "2")
        self.assert_right(rig)

    def test_initial_pose(self):
        rig = self.rig()
        rig.feed(100)
        msg = self.recording.truth_pose(self.recording.scans[99].header.stamp.to_sec())
        msg.header.frame_id = "elsewhere"
        rig.initialpose.publish(msg)
        rig.wait_said("initial pose ignored", "elsewhere", level=Log.ERROR)
        # Where the robot is, in the frame of the map, but for half a metre.
        stamp = self.recording.scans[99].header.stamp.to_sec()
        pose = compose(rig.odom_in_map()[-1][1], rig.odometry_at(stamp))
        msg.header.frame_id = "map"
        msg.pose.pose.position.x, msg.pose.pose.position.y = pose[0] + 0.4, pose[1] - 0.3
        msg.pose.pose.orientation.z, msg.pose.pose.orientation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
        rig.initialpose.publish(msg)
        rig.feed(1)
        wait_until(lambda: rig.feed(1) or rig.value("runs") == "2", "no run begins")
        rig.feed(60)
        self.assert_right(rig)

    def test_gmapping_names(self):
        rig = self.rig(map_update_interval=0.5)
        rig.feed(60)
        grid = rig.map_heard.wait()
        self.assertEqual(grid.header.frame_id, "map")
        self.assertGreater(sum(v == 100 for v in grid.data), 50)


if __name__ == "__main__":
    rospy.init_node("slam_input_test")
    rostest.rosrun("hyselam_bringup", "slam_input_test", SlamInputTest)
