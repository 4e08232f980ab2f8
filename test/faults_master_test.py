#!/usr/bin/env python3
"""The master dies and comes back. Nobody can find the robot's layers then, as nothing in ROS 1 registers again: the tools
say so in words, what was saved is whole, and the stack started anew goes on with it."""
import os
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import rostest

sys.dont_write_bytecode = True
from faults_rig import program, run
from localization_rig import free_port

PATIENCE = 180.0  # [s] never reached when all is well


class FaultsMasterTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.port = free_port()
        self.environment = {"ROS_MASTER_URI": f"http://localhost:{self.port}", "ROS_HOME": self.path("ros_home")}
        self.running = []
        self.addCleanup(self.end_all)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def start(self, *command):
        process = subprocess.Popen(command, env=dict(os.environ, **self.environment), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        self.running.append(process)
        return process

    def end(self, process):
        process.terminate()
        try:
            process.wait(60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def end_all(self):
        for process in reversed(self.running):
            if process.poll() is None:
                self.end(process)

    def tool(self, name, *arguments):
        return run(program("hyselam_bringup", name), *arguments, **self.environment)

    def until(self, condition, what):
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.5)

    def start_master(self):
        master = self.start("rosmaster", "--core", "-p", str(self.port))

        def answers():
            with socket.socket() as s:
                return s.connect_ex(("localhost", self.port)) == 0
        self.until(answers, "no master")
        return master

    def start_robot(self, map_file):
        return self.start("roslaunch", "hyselam_bringup", "hyselam.launch", f"map:={map_file}", "fsd:=false",
                          "words:=false", f"work_dir:={self.path('work')}")

    def service(self, name, arguments=""):
        return run("rosservice", "call", name, *([arguments] if arguments else []), **self.environment)

    def test_master_killed_and_restarted(self):
        os.makedirs(self.path("work"))
        map_file, saved = self.path("map.yaml"), self.path("saved")
        subprocess.run([program("hyselam_sim", "plan_to_map"), "small", map_file], check=True, stdout=subprocess.DEVNULL)
        master = self.start_master()
        robot = self.start_robot(map_file)
        kitchen = "{point: {header: {frame_id: map}, point: {x: 1.5, y: 2.0}}, names: [Kitchen]}"
        self.until(lambda: "success: True" in self.service("/name_place", kitchen)[1], "the place is not named")
        code, text = self.tool("knowledge", "save", saved)
        self.assertEqual(code, 0, text)

        master.kill()
        master.wait()
        code, text = self.tool("knowledge", "save", saved)
        self.assertEqual(code, 2, text)
        self.assertIn(f"no ROS master at http://localhost:{self.port}", text)
        code, text = self.tool("doctor", "--seconds", "1")
        self.assertNotEqual(code, 0)
        self.assertIn("master", text)

        self.start_master()
        code, text = self.tool("knowledge", "save", saved)
        self.assertEqual(code, 1, text)
        self.assertIn("no layer runs here", text)
        self.assertIn("started before the master", text)
        code, text = self.tool("knowledge", "check", saved)
        self.assertEqual(code, 0, text)

        self.end(robot)
        self.start_robot(map_file)
        self.until(lambda: "found: True" in self.service("/word_to_pose", "{word: Kitchen}")[1], "the name is forgotten")
        code, text = self.tool("knowledge", "save", saved)
        self.assertEqual(code, 0, text)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "faults_master_test", FaultsMasterTest)
