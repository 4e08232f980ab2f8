#!/usr/bin/env python3
"""A bad day of two robots: what is killed comes back to work, what is missing is told by name, and what was saved stays
whole. One robot localises on a known map with all layers, the other one makes a map."""
import glob
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from hyselam_msgs.msg import AugmentedTopologicalMap
from hyselam_msgs.srv import CorpusPath, ObjectMapPath, StatePath, TopologicalMapPath
from nav_msgs.srv import GetMap
from tf2_msgs.msg import TFMessage

try:
    from nav_msgs.srv import LoadMap
except ImportError:
    LoadMap = None

sys.dont_write_bytecode = True
from faults_rig import KNOWN, NEW, TwoRobots, program, run
from localization_rig import WAIT, Listener, wait_until

SAVE = {"slam/save": (NEW, StatePath, "slam.state"), "words/save": (KNOWN, CorpusPath, "words.corpus"),
        "save_topological_map": (KNOWN, TopologicalMapPath, "topo.xml"), "save_dialogue": (KNOWN, StatePath, "d.state"),
        "save_object_map": (KNOWN, ObjectMapPath, "objects.xml")}


class FaultsTest(TwoRobots):
    def setUp(self):
        self.assertIn("Kitchen", self.name("Kitchen"))
        if not os.path.exists(self.saved):
            code, text = self.knowledge("save")
            self.assertEqual(code, 0, text)

    def tearDown(self):
        for robot in (KNOWN, NEW):
            self.assertTrue(self.stack.alive(robot), f"the manager of {robot} died")
        code, text = self.knowledge("check")
        self.assertEqual(code, 0, text)

    # ---- Helpers.

    def knowledge(self, command, folder=None, robot=KNOWN):
        return run(program("hyselam_bringup", "knowledge"), command, folder or self.saved, ROS_NAMESPACE=robot)

    def known_cells(self, robot):
        return sum(cell >= 0 for cell in self.call(robot, "dynamic_map", GetMap).map.data)

    # ---- Faults.

    def test_every_nodelet_killed_and_restarted_in_turn(self):
        for robot in (KNOWN, NEW):
            for layer in self.stack.layers(robot):
                with self.subTest(robot=robot, layer=layer):
                    self.stack.unload(robot, layer)
                    self.robots.feed(3)
                    self.robots.heard.pop(f"{robot}/{layer}", None)
                    self.stack.load(robot, layer)
                    self.comes_back(robot, layer)
        self.works()

    def test_manager_killed_with_all_its_nodelets(self):
        self.assertTrue(self.call(NEW, "slam/save", StatePath, "").success)
        known = self.known_cells(NEW)
        state = self.path(KNOWN, "dialogue.state")
        wait_until(lambda: os.path.exists(state), "the dialogue is not saved")
        for robot in (KNOWN, NEW):
            self.stack.kill(robot)
            self.robots.heard.clear()
            self.stack.restart(robot)
            for layer in self.stack.layers(robot):
                self.comes_back(robot, layer)
        # Keyframes that showed nothing new are dropped with a loaded state; what they saw is not.
        wait_until(lambda: self.known_cells(NEW) >= 0.98 * known, lambda: f"{known} known cells; there are {self.known_cells(NEW)}")
        self.works()

    def test_bag_looped(self):
        self.robots.feed(40)
        self.robots.rewind()
        self.works()
        for robot, layer in ((KNOWN, "localization"), (KNOWN, "fsd"), (NEW, "slam")):
            self.assertGreaterEqual(self.robots.count(robot, layer, "time went back"), 1, layer)
        self.assertTrue(any("time went back" in m.msg for m in self.log.messages))

    def test_clock_jumps_forward_and_back(self):
        self.robots.rewind(self.robots.shift + 3600.0)
        self.works()
        self.robots.rewind(self.robots.shift - 1800.0)
        self.works()

    def test_no_odometry_for_5_s(self):
        self.robots.feed(50, tf=False)
        # The scans wait their time in the clock, too.
        for robot, layer in ((KNOWN, "localization"), (NEW, "slam")):
            self.robots.says(robot, layer, "no transform", f"{robot}/odom -> {robot}/base_link",
                             while_doing=lambda: self.robots.feed(1, tf=False))
        self.works()

    def test_no_scans_for_5_s(self):
        self.robots.feed(50, scans=False)
        for robot, layer in ((KNOWN, "localization"), (KNOWN, "fsd"), (NEW, "slam")):
            self.robots.says(robot, layer, "no scans", while_doing=lambda: self.robots.feed(1, scans=False))
        self.works()

    def test_flood_of_images(self):
        """A camera that sends what it has kept for minutes, at once: the oldest go, the laser's layers do not wait."""
        before = self.robots.count(KNOWN, "localization", "scans used")
        received = self.robots.count(KNOWN, "semantic_localization", "images received")
        at, messages = next(iter(self.recording.pictures.items()))
        self.robots.tick(1.0)
        for i in range(600):
            self.robots.shift += 0.001
            self.robots.send_pictures(KNOWN, messages)
            if i % 60 == 0:
                self.robots.feed(1, pictures=False)
        wait_until(lambda: self.robots.count(KNOWN, "semantic_localization", "images received") > received, "no image came")
        self.robots.work(KNOWN, ["localization"])
        self.assertGreater(self.robots.count(KNOWN, "localization", "scans used"), before)
        self.robots.says(KNOWN, "semantic_localization", "images waiting 0", while_doing=lambda: self.robots.feed(2))
        self.works()

    @unittest.skipIf(LoadMap is None, "nav_msgs before 1.13.1 has no LoadMap")
    def test_map_of_another_building(self):
        other = self.path("other.yaml")
        if not os.path.exists(other):
            subprocess.run([program("hyselam_sim", "plan_to_map"), "office", other], check=True,
                           stdout=subprocess.DEVNULL)
        places = self.robots.count(KNOWN, "gr2to", "places")
        answer = self.call(KNOWN, "change_map", LoadMap, other)
        self.assertEqual(answer.result, 0)
        wait_until(lambda: self.robots.count(KNOWN, "gr2to", "places") > places + 5, "the places of the other building")
        self.robots.says(KNOWN, "localization", "not converged", while_doing=lambda: self.robots.feed(2))
        # Back: everything is as it was saved.
        code, text = self.knowledge("load")
        self.assertEqual(code, 0, text)
        wait_until(lambda: self.robots.count(KNOWN, "gr2to", "places") == places, "the places of before")
        wait_until(lambda: "Kitchen" in self.words(), lambda: f"the name; there are {self.words()}")
        self.works()

    def test_disk_full(self):
        folder = self.path("full")
        os.makedirs(folder, exist_ok=True)
        for robot in (KNOWN, NEW):
            self.stack.limit_files(robot, 16)
            self.addCleanup(self.stack.limit_files, robot)
        self.refused(folder, "File too large")
        # The whole, into a directory that holds something good: it stays.
        code, text = self.knowledge("save")
        self.assertEqual(code, 1, text)
        self.assertIn("error: ", text)
        self.assertRegex(text, "File too large|disk full")
        self.assertEqual(glob.glob(self.path(".saved.*")), [])
        self.robots.feed(20)
        for robot in (KNOWN, NEW):
            self.stack.limit_files(robot)
        code, text = self.knowledge("save")
        self.assertEqual(code, 0, text)
        self.works()

    def test_disk_really_full(self):
        """The same with a disk that is full, where the test may mount one."""
        folder = self.path("disk")
        os.makedirs(folder)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", folder], stderr=subprocess.DEVNULL).returncode:
            self.skipTest("no right to mount a small disk here; test_disk_full limits the size of files instead")
        self.addCleanup(subprocess.run, ["umount", "-l", folder])
        with open(os.path.join(folder, "other"), "wb", buffering=0) as file:
            try:
                while file.write(bytes(4096)):
                    pass
            except OSError:
                pass
        self.refused(folder, "No space left on device")
        code, text = self.knowledge("save", os.path.join(folder, "saved"))
        self.assertEqual(code, 1, text)
        self.assertRegex(text, "No space left on device|disk full")
        self.assertEqual(sorted(os.listdir(folder)), ["other"])
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        self.refused(folder, "Read-only file system")
        code, text = self.knowledge("save", os.path.join(folder, "saved"))
        self.assertEqual(code, 1, text)
        self.assertIn("Read-only file system", text)
        self.works()

    def test_place_that_cannot_be_written(self):
        file = self.path("file")
        with open(file, "w") as out:
            out.write("no directory")
        self.refused(file, "Not a directory")
        code, text = self.knowledge("save", os.path.join(file, "saved"))
        self.assertEqual(code, 1, text)
        self.assertIn(file, text)
        self.works()

    def refused(self, folder, reason):
        """Every layer says which file it cannot write and why, and leaves nothing."""
        before = sorted(os.listdir(folder)) if os.path.isdir(folder) else None
        for service, (robot, kind, name) in SAVE.items():
            path = os.path.join(folder, name)
            answer = self.call(robot, service, kind, path)
            self.assertFalse(answer.success, service)
            self.assertIn(path, answer.message, service)
            self.assertRegex(answer.message, f"{reason}|disk full", service)
        if before is not None:
            self.assertEqual(sorted(os.listdir(folder)), before)

    def test_robots_in_namespaces_leave_each_other_alone(self):
        transforms = Listener("/tf", TFMessage)
        self.addCleanup(transforms.close)
        self.stack.kill(NEW)
        before = self.robots.count(KNOWN, "localization", "scans used")
        self.robots.work(KNOWN, self.stack.layers(KNOWN))
        self.assertGreater(self.robots.count(KNOWN, "localization", "scans used"), before)
        # Its map is its own: the other one's names and frames stay out.
        self.stack.restart(NEW)
        self.works()
        wait_until(lambda: any(t.header.frame_id == f"{NEW}/map" for m in transforms.messages for t in m.transforms),
                   "no transform of the other robot")
        pairs = {(t.header.frame_id, t.child_frame_id) for m in transforms.messages for t in m.transforms}
        for parent, child in pairs:
            if parent.startswith(NEW + "/"):
                self.assertTrue(child.startswith(NEW + "/"), (parent, child))
            if child.startswith(KNOWN + "/"):
                self.assertIn(parent, ("map", KNOWN + "/odom", KNOWN + "/base_link"))
        other = rospy.wait_for_message(f"/{NEW}/named_map", AugmentedTopologicalMap, WAIT)
        self.assertNotIn("Kitchen", {w.text for p in other.places for w in p.words})
        code, text = self.knowledge("save", self.path("saved_new"), NEW)
        self.assertEqual(code, 0, text)
        self.assertIn("slam", text)
        self.assertNotIn("objects", text)


if __name__ == "__main__":
    rospy.init_node("faults_test")
    rostest.rosrun("hyselam_bringup", "faults_test", FaultsTest)
