#!/usr/bin/env python3
"""Robots as roslaunch starts them, left alone: a manager, a loader or the keeper is killed, and nobody starts anything."""
import os
import signal
import sys

import rospy
import rostest
from hyselam_msgs.srv import QueryObjects, StatePath

sys.dont_write_bytecode = True
from faults_rig import KNOWN, NEW, LaunchedStack, TwoRobots
from localization_rig import wait_until


class FaultsRespawnTest(TwoRobots):
    stack_kind = LaunchedStack

    def comes_back_alone(self, robot):
        """Every layer of the robot, whose manager has just been killed: what is heard now is heard of the new one."""
        for layer in self.stack.layers(robot):
            self.comes_back(robot, layer)

    def kill_manager(self, robot):
        manager = f"/{robot}/hyselam_manager"
        old = self.stack.process_of(manager)
        self.stack.kill(robot)
        wait_until(lambda: self.process_now(manager) not in (None, old), f"no new {manager}")
        self.robots.heard.clear()
        if robot == KNOWN:
            self.names.messages.clear()

    def process_now(self, node):
        try:
            return self.stack.process_of(node)
        except (OSError, IOError):
            return None

    def test_manager_killed_and_all_is_back_with_what_was_saved(self):
        self.assertIn("Kitchen", self.name("Kitchen"))
        self.call(KNOWN, "query_objects", QueryObjects, "There is a pen in the kitchen.")
        self.assertTrue(self.call(NEW, "slam/save", StatePath, "").success)
        keyframes = self.robots.count(NEW, "slam", "keyframes")
        wait_until(lambda: os.path.exists(self.path(KNOWN, "dialogue.state")), "the dialogue is not saved")
        for robot in (KNOWN, NEW):
            self.kill_manager(robot)
            self.comes_back_alone(robot)
        self.assertGreaterEqual(self.robots.count(NEW, "slam", "keyframes"), keyframes)
        self.assertIn("Kitchen", self.words())
        self.assertIn("kitchen", self.call(KNOWN, "query_objects", QueryObjects, "Where is the pen?").reply)
        self.works()

    def test_manager_killed_twice_and_the_keeper_with_it(self):
        self.assertIn("Kitchen", self.name("Kitchen"))
        keeper = f"/{KNOWN}/hyselam_manager_keeper"

        def keeper_sees_all():
            seen = rospy.get_param(keeper + "/seen", {})
            return (seen and seen["manager"][1] == self.process_now(f"/{KNOWN}/hyselam_manager") and
                    len(seen.get("loaders", [])) == len(self.stack.layers(KNOWN)))
        wait_until(keeper_sees_all, "the keeper sees all layers")
        os.kill(self.stack.process_of(keeper), signal.SIGKILL)
        self.kill_manager(KNOWN)
        self.comes_back_alone(KNOWN)
        wait_until(keeper_sees_all, "the keeper sees all layers again")
        self.kill_manager(KNOWN)
        self.comes_back_alone(KNOWN)
        self.works()

    def test_loader_killed(self):
        self.assertIn("Kitchen", self.name("Kitchen"))
        loader = f"/{KNOWN}/fsd"
        old = self.stack.process_of(loader)
        os.kill(old, signal.SIGKILL)
        wait_until(lambda: self.process_now(loader) not in (None, old), "no new loader")
        self.works()


if __name__ == "__main__":
    rospy.init_node("faults_respawn_test")
    rostest.rosrun("hyselam_bringup", "faults_respawn_test", FaultsRespawnTest)
