#!/usr/bin/env python3
"""What a robot knows is saved into one directory and comes back from it as a whole; a damaged directory is refused by
the name of its file, and a layer that fails leaves everything as it was."""
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import types
import unittest
from unittest import mock

import rosgraph
import rospkg
import rospy
import rostest
from geometry_msgs.msg import Point, PointStamped
from hyselam_msgs.msg import AugmentedTopologicalMap
from hyselam_msgs.srv import (NamePlace, ObjectMapPath, ObjectMapPathResponse, QueryObjects, StatePath, StatePathResponse)
from nav_msgs.msg import MapMetaData, OccupancyGrid
from roslib.packages import find_node
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse

from localization_rig import Listener, Recording, wait_until, WAIT


class FakeSlam:
    """A SLAM that knows one text, and can be told to fail."""

    why = "the disk is full"

    def __init__(self, namespace=""):
        self.text, self.fails, self.refuses = "first", "", ""
        self.waits, self.entered, self.go_on = [], threading.Semaphore(0), threading.Semaphore(0)
        self.one_at_a_time = threading.Lock()
        self.services = [rospy.Service(namespace + "slam/save", StatePath, lambda r: self.serve("save", r)),
                         rospy.Service(namespace + "slam/load", StatePath, lambda r: self.serve("load", r))]

    def serve(self, call, request):
        with self.one_at_a_time:
            if self.waits[:1] == [call]:
                self.waits.pop()
                self.entered.release()
                self.go_on.acquire(timeout=WAIT)
            return getattr(self, call)(request)

    def save(self, request):
        if self.fails == "save":
            return StatePathResponse(False, self.why)
        with open(request.path, "w") as file:
            file.write(self.text)
        return StatePathResponse(True, "")

    def load(self, request):
        with open(request.path) as file:
            text = file.read()
        if self.fails == "load" and text != self.text or text == self.refuses:
            return StatePathResponse(False, "of another building")
        self.text = text
        return StatePathResponse(True, "")

    def stop(self):
        for service in self.services:
            service.shutdown()


class StubbornObjects:
    """What knows objects, and takes back what it has saved itself, nothing else."""

    def __init__(self, namespace):
        self.services = [rospy.Service(namespace + "save_object_map", ObjectMapPath, self.save),
                         rospy.Service(namespace + "load_object_map", ObjectMapPath, self.load)]

    def save(self, request):
        with open(request.path, "w") as file:
            file.write("its own")
        return ObjectMapPathResponse(True, "")

    def load(self, request):
        with open(request.path) as file:
            return ObjectMapPathResponse(file.read() == "its own", "of another robot")

    def stop(self):
        for service in self.services:
            service.shutdown()


class FakeCamera:
    """Visual places that are one text in a directory."""

    def __init__(self, folder):
        self.folder = folder
        self.learn("first")
        rospy.set_param("semantic_localization/save_model", folder)
        self.service = rospy.Service("semantic_localization/save", Trigger, lambda _: TriggerResponse(True, ""))

    def learn(self, text):
        os.makedirs(self.folder, exist_ok=True)
        with open(os.path.join(self.folder, "model.json"), "w") as file:
            file.write(text)

    def knows(self):
        with open(os.path.join(self.folder, "model.json")) as file:
            return file.read()

    def stop(self):
        self.service.shutdown()
        rospy.delete_param("semantic_localization/save_model")


class KnowledgeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        # rosrun looks for it each time, which takes longer than the tool, and hands no signal on.
        cls.program = find_node("hyselam_bringup", "knowledge")[0]
        cls.map_publisher = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        cls.map_publisher.publish(Recording("small").map)
        cls.named = Listener("named_map", AugmentedTopologicalMap)
        cls.named.wait()
        rospy.wait_for_service("name_place", WAIT)
        rospy.wait_for_service("words/save", WAIT)
        rospy.wait_for_service("save_topological_map", WAIT)
        rospy.wait_for_service("query_objects", WAIT)

    def setUp(self):
        self.slam = FakeSlam()
        self.addCleanup(self.slam.stop)
        self.path = os.path.join(self.folder.name, self.id())
        self.camera = FakeCamera(self.path + "_model")
        self.addCleanup(self.camera.stop)
        self.dictionary = self.path + "_dictionary.xml"
        self.show("first")
        rospy.set_param("object_engine/dictionary_file", self.dictionary)

    def run_tool(self, command, path=None, **environment):
        done = subprocess.run([self.program, command, path or self.path], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=WAIT, env=dict(os.environ, **environment))
        self.out, self.err = done.stdout, done.stderr
        return done.returncode

    def refused(self, command, status, text, path=None):
        self.assertEqual(self.run_tool(command, path), status, self.out + self.err)
        self.assertIn(text, self.err)
        self.assertEqual(self.err.count("error: "), 1)

    def show(self, text):
        with open(self.dictionary, "w") as file:
            file.write(text)

    def shown(self):
        with open(self.dictionary) as file:
            return file.read()

    def ask(self, text):
        return rospy.ServiceProxy("query_objects", QueryObjects)(text).reply

    def left_over(self):
        return [f for f in os.listdir(self.folder.name) if f.startswith(".")]

    def name(self, *names):
        point = PointStamped(Header(frame_id="map"), Point(1.5, 2.0, 0.0))
        answer = rospy.ServiceProxy("name_place", NamePlace)(0, point, list(names))
        self.assertTrue(answer.success, answer.message)

    def names(self):
        places = self.named.messages[-1].places if self.named.messages else []
        return {word.text for place in places for word in place.words}

    def test_all_layers_there_and_back(self):
        self.name("Kitchen")
        wait_until(lambda: "Kitchen" in self.names(), lambda: f"the name; there are {self.names()}")
        self.ask("There is a pen in the kitchen.")
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.assertIn("saved map, slam, words, places, dialogue, objects, vision, dictionary", self.out)
        self.assertEqual(self.run_tool("check", ROS_MASTER_URI="http://localhost:9"), 0, self.err)
        with open(os.path.join(self.path, "manifest.json")) as file:
            self.assertEqual(sorted(json.load(file)["files"]),
                             ["dialogue.state", "dictionary.xml", "map.pgm", "map.yaml", "objects.xml", "slam.state", "topo.xml",
                              "visual_places/model.json", "words.corpus"])
        self.name("Library")
        self.slam.text = "second"
        self.camera.learn("second")
        self.show("second")
        self.ask("There is a cup in the kitchen.")
        wait_until(lambda: "Library" in self.names(), "the other name")
        # Knowledge moves: nothing in it tells of the place where it was saved.
        moved = self.path + "_moved"
        shutil.move(self.path, moved)
        self.assertEqual(self.run_tool("load", moved), 0, self.err)
        self.assertIn("loaded slam, words, places, dialogue, objects; put in place for the next start: dictionary, vision; "
                      "not running: map", self.out)
        self.assertEqual([self.slam.text, self.camera.knows(), self.shown()], ["first"] * 3)
        self.assertIn("kitchen", self.ask("Where is the pen?"))
        self.assertNotIn("kitchen", self.ask("Where is the cup?"))
        wait_until(lambda: "Kitchen" in self.names() and "Library" not in self.names(), lambda: f"{self.names()}")
        self.assertEqual(self.left_over(), [])

    def test_damage_is_named(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        for name in ("dialogue.state", "map.pgm", "slam.state", "topo.xml", "objects.xml", "dictionary.xml", "visual_places/model.json"):
            path = os.path.join(self.path, name)
            with open(path, "rb") as file:
                good = file.read()
            with open(path, "wb") as file:
                file.write(bytes([good[0] ^ 1]) + good[1:])
            self.slam.text = "present"
            self.refused("check", 2, f"{path}: is damaged")
            self.refused("load", 2, f"{path}: is damaged")
            with open(path, "wb") as file:
                file.write(good[:-1])
            self.refused("load", 2, f"{path}: has {len(good) - 1} bytes")
            os.remove(path)
            self.refused("load", 2, f"{path}: is missing")
            # Nor is a damaged directory written over, as if what it held of other layers did not matter.
            self.refused("save", 2, f"{path}: is missing")
            with open(path, "wb") as file:
                file.write(good)
        self.assertEqual(self.slam.text, "present")
        self.assertEqual(self.run_tool("check"), 0, self.err)

    def test_manifests_that_cannot_be(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        path = os.path.join(self.path, "manifest.json")
        with open(path) as file:
            good = json.load(file)
        outside = {**good["files"], "../secret": {"bytes": 1, "sha256": ""}}
        for bad, text in (({**good, "version": 2}, "has version 2, this program reads 1; it was written by a newer HySeLAM"), ({**good, "format": "x"}, "this is no hyselam knowledge"),
                          ({**good, "files": outside}, "outside of the directory"), ({**good, "layers": {"slam": ["gone"]}}, "slam lacks gone"),
                          ([], "is damaged"), ({}, "is damaged")):
            with open(path, "w") as file:
                json.dump(bad, file)
            self.refused("load", 2, text)
        os.remove(path)
        self.refused("check", 2, f"{path}: cannot be read")
        # A directory with other things in it is nobody's to replace.
        self.refused("save", 2, "nothing is overwritten")

    def test_a_layer_that_fails_leaves_what_was(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.fails, self.slam.text = "save", "second"
        self.refused("save", 1, "slam: the disk is full")
        self.assertEqual(self.run_tool("check"), 0, self.err)
        with open(os.path.join(self.path, "slam.state")) as file:
            self.assertEqual(file.read(), "first")
        self.slam.fails = "load"
        self.camera.learn("second")
        self.show("second")
        self.refused("load", 1, "slam: of another building; all layers know what they knew before")
        self.assertEqual([self.slam.text, self.camera.knows(), self.shown()], ["second"] * 3)
        self.assertEqual(self.left_over(), [])

    def interrupt(self, command, number, times=1):
        """Sends the signal while SLAM is in the command, each time that it is; the tool's exit status."""
        self.slam.waits = [command] * times
        self.slam.entered, self.slam.go_on = threading.Semaphore(0), threading.Semaphore(0)
        tool = subprocess.Popen([self.program, command, self.path], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)
        try:
            for _ in range(times):
                self.assertTrue(self.slam.entered.acquire(timeout=WAIT), f"SLAM is not asked to {command}")
                tool.send_signal(number)
                self.slam.go_on.release()
            self.out, self.err = tool.communicate(timeout=WAIT)
        finally:
            self.slam.waits = []
            self.slam.go_on.release()
            tool.kill()
        return tool.returncode

    def test_an_interrupt_that_comes_late_is_too_late_or_undoes_all(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        outcomes = {(0, ""), (1, "error: interrupted; all is as it was\n")}
        for wait in (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6):
            self.slam.waits, self.slam.entered = ["save"], threading.Semaphore(0)
            self.slam.go_on = threading.Semaphore(1)  # it need not wait
            tool = subprocess.Popen([self.program, "save", self.path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertTrue(self.slam.entered.acquire(timeout=WAIT), "SLAM is not asked to save")
            time.sleep(wait)
            tool.send_signal(signal.SIGINT)
            out, err = tool.communicate(timeout=WAIT)
            self.assertIn((tool.returncode, err), outcomes)
            self.assertEqual(tool.returncode == 0, "saved" in out)
            self.assertEqual(self.run_tool("check"), 0, self.err)
            self.assertEqual(self.left_over(), [])

    def kept(self):
        """The directory that the error names, for what the layers knew."""
        path = self.err.strip().rsplit("can be loaded from ", 1)[1]
        self.addCleanup(shutil.rmtree, path)
        self.assertEqual(self.run_tool("check", path), 0, self.err)
        return path

    def test_a_save_that_is_killed_leaves_what_was(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.text = "second"
        self.assertEqual(self.interrupt("save", signal.SIGKILL), -signal.SIGKILL)
        self.assertEqual(self.run_tool("check"), 0, self.err)
        self.assertNotEqual(self.left_over(), [])
        for number in (signal.SIGINT, signal.SIGTERM):
            before = self.left_over()
            self.assertEqual(self.interrupt("save", number), 1, self.out + self.err)
            self.assertEqual(self.err, "error: interrupted; all is as it was\n")
            self.assertTrue(set(self.left_over()) <= set(before))
        with open(os.path.join(self.path, "slam.state")) as file:
            self.assertEqual(file.read(), "first")
        # The next one clears away what the killed one left.
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.assertEqual(self.left_over(), [])
        # Where a disk cannot exchange directories in one step, it may have been killed between two: it goes on with the old one.
        gone = subprocess.Popen(["true"])
        gone.wait()
        parent, name = os.path.split(self.path)
        os.rename(self.path, os.path.join(parent, f".{name}.{gone.pid}.abcdefgh.old"))
        self.slam.stop()
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.assertIn("kept slam", self.out)
        self.assertEqual(self.left_over(), [])

    def test_a_load_that_is_interrupted_goes_back(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.text = "second"
        self.camera.learn("second")
        self.assertEqual(self.interrupt("load", signal.SIGINT), 1, self.out + self.err)
        self.assertEqual(self.err, "error: interrupted; all layers know what they knew before\n")
        wait_until(lambda: [self.slam.text, self.camera.knows()] == ["second"] * 2, lambda: f"{self.slam.text}")

    def test_what_was_known_is_kept_when_the_way_back_fails(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        stubborn = {"ROS_NAMESPACE": "stubborn"}
        slam = FakeSlam("stubborn/")
        self.addCleanup(slam.stop)
        objects = StubbornObjects("stubborn/")
        self.addCleanup(objects.stop)
        slam.text = slam.refuses = "second"
        self.assertEqual(self.run_tool("load", **stubborn), 1)
        self.assertIn("error: objects: of another robot; and the way back failed: slam: of another building; what the layers "
                      "knew before can be loaded from /", self.err)
        path = self.kept()
        self.assertEqual(slam.text, "first")
        slam.refuses = ""
        self.assertEqual(self.run_tool("load", path, **stubborn), 0, self.err)
        self.assertEqual(slam.text, "second")

    def test_what_was_known_is_kept_when_the_way_back_is_interrupted(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.text = "second"
        self.assertEqual(self.interrupt("load", signal.SIGINT, 2), 1, self.out + self.err)
        self.assertIn("error: interrupted; and the way back failed: interrupted; what the layers knew before", self.err)
        path = self.kept()
        self.slam.text = "third"
        self.assertEqual(self.run_tool("load", path), 0, self.err)
        self.assertEqual(self.slam.text, "second")

    def test_a_map_server_that_is_dead_is_told_of(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        slam = FakeSlam("dead/")
        self.addCleanup(slam.stop)
        slam.text = "second"
        # Registered still, and nobody answers: what a killed one leaves.
        master, service = rosgraph.Master("/dead_map_server"), ("/dead/change_map", "rosrpc://localhost:9")
        master.registerService(*service, "http://localhost:9")
        self.addCleanup(master.unregisterService, *service)
        self.assertEqual(self.run_tool("load", ROS_NAMESPACE="dead"), 1)
        self.assertRegex(self.err, r"^error: map: change_map: .*; all layers know what they knew before\n$")
        self.assertEqual(slam.text, "second")

    def test_a_map_of_another_size_than_its_cells(self):
        grid = OccupancyGrid(info=MapMetaData(width=2, height=2, resolution=0.05), data=[0, 0, 0])
        publisher = rospy.Publisher("odd/map", OccupancyGrid, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        publisher.publish(grid)
        self.assertEqual(self.run_tool("save", ROS_NAMESPACE="odd"), 1)
        self.assertEqual(self.err, "error: map: /odd/map: its 3 cells are not 2 x 2\n")
        self.assertFalse(os.path.exists(self.path))

    def test_a_load_that_is_killed_leaves_the_visual_places(self):
        """Where a disk cannot exchange directories in one step, killed between the two."""
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.camera.learn("second")
        tool = self.tool()
        tool.ctypes = types.SimpleNamespace(CDLL=lambda *_, **__: None)  # an old C library
        gone = subprocess.Popen(["true"])
        gone.wait()
        move = os.rename

        def killed(source, target):
            move(source, target)
            raise KeyboardInterrupt
        with mock.patch("os.getpid", lambda: gone.pid):
            fresh = tool.beside(self.camera.folder)
        shutil.copytree(os.path.join(self.path, "visual_places"), fresh, dirs_exist_ok=True)
        with mock.patch("os.rename", killed), self.assertRaises(KeyboardInterrupt):
            tool.exchange(fresh, self.camera.folder)
        self.assertFalse(os.path.exists(self.camera.folder))
        self.assertEqual(self.run_tool("save", self.path + "_other"), 0, self.err)
        self.assertEqual(self.camera.knows(), "second")
        self.assertEqual(self.left_over(), [])

    def tool(self):
        """The tool as a module."""
        path = os.path.join(rospkg.RosPack().get_path("hyselam_bringup"), "scripts", "knowledge")
        module = types.ModuleType("knowledge")
        module.__file__ = path
        with open(path) as file:
            exec(compile(file.read(), path, "exec"), module.__dict__)
        return module

    def test_a_layer_that_still_writes_leaves_nothing_behind(self):
        """A save that is interrupted clears its draft away while the layer that it had asked goes on."""
        tool, remove, late = self.tool(), os.rmdir, ["topo.xml", "slam.state"]
        draft = tool.beside(self.path)

        def writes_between(path, *args, **kwargs):
            if late:
                with open(os.path.join(draft, late.pop()), "w") as file:
                    file.write("second")
            remove(path, *args, **kwargs)
        with mock.patch("os.rmdir", writes_between):
            tool.discard(draft)
        self.assertEqual(late, [])
        self.assertEqual(self.left_over(), [])

    def test_a_power_cut_after_a_save_loses_nothing(self):
        """Files, and the directories that name them, are on the disk before the exchange, which is before the end."""
        tool, order, wait, move = self.tool(), [], os.fsync, os.rename

        def waits(descriptor):
            order.append(os.readlink(f"/proc/self/fd/{descriptor}"))
            wait(descriptor)

        def moves(source, target):
            order.append("exchange")
            move(source, target)
        fresh = tool.beside(self.path)
        os.makedirs(os.path.join(fresh, "inner"))
        for name in ("outer.txt", "inner/deep.txt"):
            with open(os.path.join(fresh, name), "w") as file:
                file.write("known")
        with mock.patch("os.fsync", waits), mock.patch("os.rename", moves):
            tool.seal(fresh, {}, {})
            tool.exchange(fresh, self.path)
        names = [os.path.relpath(path, fresh) if path != "exchange" else path for path in order]
        self.assertEqual(sorted(names[:-2]), [".", "inner", "inner/deep.txt", "manifest.json", "outer.txt"])
        self.assertEqual(names[-2:], ["exchange", ".."])

    def test_what_cannot_be_set_aside_is_not_replaced(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.text, self.slam.fails = "second", "save"
        self.refused("load", 1, "nothing is loaded, as what the layers know cannot be set aside in ")
        self.assertIn("slam: the disk is full", self.err)
        self.assertEqual(self.slam.text, "second")

    def test_layers_that_do_not_run_are_kept(self):
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.slam.stop()
        self.assertEqual(self.run_tool("save"), 0, self.err)
        self.assertIn("kept slam", self.out)
        with open(os.path.join(self.path, "slam.state")) as file:
            self.assertEqual(file.read(), "first")
        self.assertEqual(self.run_tool("check"), 0, self.err)

    def test_a_failure_that_sounds_like_knowing_nothing_is_one(self):
        self.slam.fails, self.slam.why = "save", "the disk is not there yet"
        self.refused("save", 1, "slam: the disk is not there yet")
        self.slam.why = "there is no topological map yet"  # that is for another layer to say
        self.refused("save", 1, "slam: there is no topological map yet")
        self.assertFalse(os.path.exists(self.path))

    def test_a_layer_that_knows_nothing_yet_is_left_out(self):
        fresh = {"ROS_NAMESPACE": "fresh"}  # there Gr2To has no map
        nothing = "places: there is no topological map yet"
        rospy.wait_for_service("fresh/save_topological_map", WAIT)
        self.assertEqual(self.run_tool("save", **fresh), 1)
        self.assertEqual(self.err, f"error: {nothing}; nothing is saved\n")
        self.assertFalse(os.path.exists(self.path))
        slam = FakeSlam("fresh/")
        self.addCleanup(slam.stop)
        self.assertEqual(self.run_tool("save", **fresh), 0, self.err)
        self.assertEqual(self.out, f"{self.path}: saved slam; left out {nothing}\n")
        with open(os.path.join(self.path, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertEqual(manifest["left_out"], {"places": "there is no topological map yet"})
        self.assertEqual(list(manifest["layers"]), ["slam"])
        self.assertEqual(self.run_tool("check", **fresh), 0, self.err)
        self.assertIn(f"without {nothing}", self.out)
        # What is there of it stays, and is not missed.
        full = self.path + "_full"
        self.assertEqual(self.run_tool("save", full), 0, self.err)
        slam.text = "fresh"
        self.assertEqual(self.run_tool("save", full, **fresh), 0, self.err)
        self.assertIn("places", self.out.split("kept ")[1].split(";")[0])
        with open(os.path.join(full, "manifest.json")) as file:
            self.assertEqual(json.load(file)["left_out"], {})
        # It takes what it is given; when another one refuses, there is nothing that it could go back to.
        slam.text = "second"
        self.addCleanup(StubbornObjects("fresh/").stop)
        self.assertEqual(self.run_tool("load", full, **fresh), 1)
        self.assertEqual(self.err, "error: objects: of another robot; all other layers know what they knew before; "
                                   "places knew nothing before and keeps what it was given\n")
        self.assertEqual(slam.text, "second")

    def test_usage_and_no_master(self):
        self.assertEqual(self.run_tool("save", ROS_MASTER_URI="http://localhost:9"), 2)
        self.assertIn("no ROS master at http://localhost:9", self.err)
        self.assertEqual(self.run_tool("forget"), 2)
        self.assertEqual(self.run_tool("save", ROS_NAMESPACE="nobody"), 1)
        self.assertIn("no layer runs here", self.err)
        self.assertEqual(self.left_over(), [])


if __name__ == "__main__":
    rospy.init_node("knowledge_test")
    rostest.rosrun("hyselam_bringup", "knowledge_test", KnowledgeTest)
