#!/usr/bin/env python3
"""A bag that is played from its middle has the transforms of /tf_static that were told before, each by one publisher."""
import os
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rospy
import rostest
from geometry_msgs.msg import TransformStamped
from roslib.packages import find_node
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

sys.dont_write_bytecode = True
from localization_rig import WAIT, wait_until


def fixed(*frames):
    message = TFMessage()
    for frame in frames:
        t = TransformStamped(header=Header(frame_id="base_link"), child_frame_id=frame)
        t.transform.rotation.w = 1.0
        message.transforms.append(t)
    return message


def header(caller=None):
    of_type = {"topic": "/tf_static", "type": TFMessage._type, "md5sum": TFMessage._md5sum, "message_definition": TFMessage._full_text}
    return dict(of_type, callerid=caller, latching="1") if caller else of_type


class BagStartTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "run.bag")

    def write(self, *told):
        """A bag of 100 s that begins at 1000 s; `told`: (seconds, header, frames)."""
        with rosbag.Bag(self.path, "w") as bag:
            for seconds, of_connection, frames in told:
                bag.write("/tf_static", fixed(*frames), rospy.Time.from_sec(1000.0 + seconds), connection_header=of_connection)
            for i in range(101):
                bag.write("/header", Header(seq=i), rospy.Time.from_sec(1000.0 + i))

    def start(self, *command):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

        def end():
            process.terminate()
            process.communicate(timeout=WAIT)
        self.addCleanup(end)
        return process

    def heard(self, frames):
        """Who publishes which frame, as one hears that subscribes late."""
        authors = {}

        def hear(message):
            for t in message.transforms:
                authors.setdefault(t.child_frame_id, set()).add(message._connection_header["callerid"])
        wait_until(lambda: dict(rospy.get_master().getTopicTypes()[2]).get("/header"), "the player has not begun")
        subscriber = rospy.Subscriber("/tf_static", TFMessage, hear)
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: frames <= set(authors), lambda: f"heard {authors}")
        return authors

    def play(self, start):
        self.start("rosbag", "play", "--quiet", "--start", str(start), self.path, "__name:=player")
        return self.start(find_node("hyselam_bringup", "earlier_transforms")[0], self.path, str(start))

    def test_what_is_not_marked_as_latched_is_published(self):
        self.write((0.0, header(), ["laser", "camera"]), (60.0, header(), ["late"]))
        self.play(50)
        authors = self.heard({"laser", "camera"})
        self.assertEqual(authors, {"laser": {"/earlier_transforms"}, "camera": {"/earlier_transforms"}})

    def test_all_messages_of_a_publisher_count(self):
        self.write((0.0, header("/driver"), ["laser"]), (1.0, header("/driver"), ["camera"]))
        self.play(50)
        authors = self.heard({"laser", "camera"})
        self.assertEqual(authors, {"laser": {"/earlier_transforms"}, "camera": {"/player"}}, "what the player repeats is published by it alone")

    def test_nothing_is_published_where_the_player_repeats_all(self):
        self.write((0.0, header("/driver"), ["laser"]))
        self.assertEqual(self.play(50).wait(WAIT), 0)
        self.assertEqual(self.heard({"laser"}), {"laser": {"/player"}})

    def test_a_bag_that_cannot_be_read_is_told(self):
        done = subprocess.run([find_node("hyselam_bringup", "earlier_transforms")[0], "/no/such.bag", "5"], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=WAIT)
        self.assertEqual(done.returncode, 2)
        self.assertIn("error: /no/such.bag", done.stdout)
        self.assertNotIn("Traceback", done.stdout)


if __name__ == "__main__":
    rospy.init_node("bag_start_test")
    rostest.rosrun("hyselam_bringup", "bag_start_test", BagStartTest)
