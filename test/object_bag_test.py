#!/usr/bin/env python3
"""A filmed run through a flat, frame by frame through the nodelet ObjectEngine: its map equals the one that
map_objects makes of the same bag without a master, object by object and relation by relation."""
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from hyselam_msgs.msg import ObjectMap
from hyselam_msgs.srv import ObjectMapPath, QueryObjects
from nodelet.srv import NodeletLoad
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage

sys.dont_write_bytecode = True
from localization_rig import Listener, WAIT, newest_status, values_of, wait_until

HERE = os.path.dirname(os.path.realpath(__file__))
CAMERA = "/camera"
FRAME = "odom"  # nobody localizes: the odometry's frame is that of the map
NAMES = {"o": "urn:hyselam:object_map:1"}


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


class ObjectBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        bag, cls.film, cls.offline, cls.live = (os.path.join(cls.folder.name, name)
                                                for name in ("run.bag", "film.bag", "offline.xml", "live.xml"))
        plan, route, things = (os.path.join(HERE, "object_bag_" + name) for name in ("flat.yaml", "route.yaml", "things.yaml"))
        run("rosrun", "hyselam_sim", "simulate", "--plan", plan, "--route", route, "--seed", "5", "--out", bag)
        run("rosrun", "hyselam_sim", "film", "--bag", bag, "--plan", plan, "--things", things, "--out", cls.film, "--rate", "1", "--lamps", "on")
        run("rosrun", "hyselam_objects", "map_objects", cls.film, "--map", cls.offline, "--frame", FRAME, "--frame-period", "0")
        cls.play()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def play(cls):
        """Each frame when the one before it is used: however slow the machine is, none is left out."""
        load = rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)
        load.wait_for_service(WAIT)
        for key, value in {"map_frame": FRAME, "frame_period": 0.0, "publish_period": 60.0, "transform_wait": 5.0,
                           "diagnostic_period": 0.05}.items():
            rospy.set_param("/object_engine/" + key, value)
        cls.maps = Listener("/object_map", ObjectMap)
        cls.diagnostics = Listener("/diagnostics", DiagnosticArray)
        assert load(name="/object_engine", type="hyselam_objects/ObjectEngine").success
        kinds = {"/tf": TFMessage, "/tf_static": TFMessage, CAMERA + "/depth/camera_info": CameraInfo,
                 CAMERA + "/depth/image_raw": Image, CAMERA + "/color/image_raw": Image}
        publishers = {topic: rospy.Publisher(topic, kind, queue_size=1000, latch=topic == "/tf_static") for topic, kind in kinds.items()}
        wait_until(lambda: all(each.get_num_connections() > 0 for each in publishers.values()), "nobody hears the bag")
        poses, stamps, held = [], {}, {}
        with rosbag.Bag(cls.film) as film:
            for topic, msg, _ in film.read_messages(["/tf", "/tf_static"]):
                if topic == "/tf_static":
                    publishers[topic].publish(msg)
                else:
                    poses.append(msg)
            for topic, msg, _ in film.read_messages([t for t in kinds if not t.startswith("/tf")]):
                if topic.endswith("camera_info"):
                    held[topic] = msg
                    continue
                stamps.setdefault(msg.header.stamp, {})[topic] = msg
        cls.frames = 0
        first, last = (poses[i].transforms[0].header.stamp for i in (0, -1))
        info = CAMERA + "/depth/camera_info"
        for stamp in sorted(stamps):
            if len(stamps[stamp]) < 2 or not first <= stamp <= last:
                continue
            while poses and poses[0].transforms[0].header.stamp <= stamp + rospy.Duration(1.0):
                publishers["/tf"].publish(poses.pop(0))  # the listener keeps 10 s
            publishers[info].publish(held[info])
            if cls.frames == 0:
                wait_until(lambda: "camera_info" not in cls.status().message and cls.status().name, lambda: str(cls.status()))
            for topic, msg in stamps[stamp].items():
                publishers[topic].publish(msg)
            cls.frames += 1
            wait_until(lambda: cls.number("frames used") == cls.frames, lambda: f"{cls.frames}: {cls.status()}")
        # A question publishes the map; then it is the one that is saved.
        rospy.ServiceProxy("/query_objects", QueryObjects)("Where is the cup?")
        assert rospy.ServiceProxy("/save_object_map", ObjectMapPath)(cls.live).success

    @classmethod
    def status(cls):
        return newest_status(cls.diagnostics, lambda name: name.endswith(": objects")) or DiagnosticStatus()

    @classmethod
    def number(cls, key):
        return int(values_of(cls.status()).get(key, -1))

    def objects(self, path):
        return {each.get("id"): each for each in ElementTree.parse(path).getroot().findall("o:object", NAMES)}

    def test_the_map_is_that_of_the_offline_program(self):
        live, offline = self.objects(self.live), self.objects(self.offline)
        self.assertEqual(sorted(live), sorted(offline))
        for key in live:
            a, b = live[key], offline[key]
            for name in ("kind", "seen", "missed", "overlooked"):
                self.assertEqual(a.get(name), b.get(name), (key, name))
            self.assertAlmostEqual(float(a.get("existence")), float(b.get("existence")), delta=1e-9)
            for name in ("x", "y", "z", "yaw"):
                self.assertAlmostEqual(float(a.find("o:pose", NAMES).get(name)), float(b.find("o:pose", NAMES).get(name)), delta=1e-6)
        def relations(path):
            return sorted((r.get("object"), r.get("word"), r.get("other")) for r in ElementTree.parse(path).getroot().findall("o:relation", NAMES))
        self.assertEqual(relations(self.live), relations(self.offline))

    def test_it_holds_what_stands_there(self):
        furniture = [o for o in self.maps.messages[-1].objects if "furniture" in o.property_names]
        things = [o for o in self.maps.messages[-1].objects if "furniture" not in o.property_names]
        self.assertEqual(len(furniture), 2)
        self.assertEqual(len(things), 4, [(o.kind, o.pose.position) for o in things])
        on = {r.object for r in self.maps.messages[-1].relations if r.word == "on"}
        self.assertEqual(on, {o.id for o in things})


if __name__ == "__main__":
    rospy.init_node("object_bag_test")
    rostest.rosrun("hyselam_bringup", "object_bag", ObjectBagTest)
