#!/usr/bin/env python3
"""A table with a red box on it, seen and told of: the nodelet ObjectEngine with good and bad input."""
import math
import os
import struct
import subprocess
import tempfile
import types
import unittest

import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TransformStamped
from hyselam_msgs.msg import ObjectMap, PlaceState
from hyselam_msgs.srv import ObjectMapPath, QueryObjects
from nodelet.srv import NodeletLoad, NodeletUnload
from roslib.packages import find_node
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from localization_rig import Listener, WAIT, delivered, forget_dead
from localization_rig import wait_until as wait_for

WIDTH, HEIGHT, FOCAL, CAMERA = 320, 240, 230.0, 1.2  # the camera looks along x, 1.2 m above the floor
BOXES = [((1.6, -0.6, 0.0), (2.4, 0.6, 0.7), (120, 90, 60)),    # table
         ((1.8, -0.1, 0.7), (1.95, 0.1, 0.95), (200, 20, 20))]  # red box


def wait_until(condition, what="what was waited for"):
    wait_for(condition, what)


def hit(direction, low, high):
    """Distance along the ray from the camera to the box; None: it misses."""
    near, far = 0.0, math.inf
    for o, d, a, b in zip((0.0, 0.0, CAMERA), direction, low, high):
        if abs(d) < 1e-12:
            if not a <= o <= b:
                return None
            continue
        t1, t2 = sorted(((a - o) / d, (b - o) / d))
        near, far = max(near, t1), min(far, t2)
    return near if 0 < near <= far else None


def picture(boxes):
    """Depth [mm] and colours of boxes on a grey floor with a wall behind."""
    depth, colour = bytearray(), bytearray()
    scene = boxes + [((-9, -9, -0.1), (9, 9, 0.0), (150, 150, 150)), ((5, -9, 0), (5.2, 9, 3), (220, 220, 210))]
    for v in range(HEIGHT):
        for u in range(WIDTH):
            ray = (1.0, (WIDTH / 2 - 0.5 - u) / FOCAL, (HEIGHT / 2 - 0.5 - v) / FOCAL)
            hits = [(t, rgb) for t, rgb in ((hit(ray, low, high), rgb) for low, high, rgb in scene) if t]
            z, (r, g, b) = min(hits) if hits else (0.0, (0, 0, 0))
            depth += struct.pack("<H", round(1000 * z))
            colour += bytes((b, g, r))
    return bytes(depth), bytes(colour)


class ObjectEngineTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.load = rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)
        cls.unload = rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)
        cls.load.wait_for_service(WAIT)
        broadcaster = tf2_ros.StaticTransformBroadcaster()
        t = TransformStamped()
        t.header.frame_id, t.child_frame_id = "map", "camera_optical_frame"
        t.transform.translation.z = CAMERA
        q = t.transform.rotation
        q.x, q.y, q.z, q.w = -0.5, 0.5, -0.5, 0.5
        broadcaster.sendTransform(t)
        cls.broadcaster = broadcaster
        cls.seen = picture(BOXES)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.name = "/" + self.id().split(".")[-1]
        self.maps = Listener(self.name + "/object_map", ObjectMap)
        self.markers = Listener(self.name + "/object_markers", MarkerArray)
        self.replies = Listener(self.name + "/robot_text", String)
        self.loaded = False

    def tearDown(self):
        if self.loaded:
            self.unload(name=self.name + "/engine")
        self.folder.cleanup()

    def start(self, **params):
        params = dict({"publish_period": 0.2, "frame_period": 0.0}, **params)
        for key, value in params.items():
            rospy.set_param(self.name + "/engine/" + key, value)
        topics = ["camera/depth/image_raw", "camera/depth/camera_info", "camera/color/image_raw", "object_map",
                  "object_markers", "object_text", "robot_text", "place", "topological_map", "save_object_map",
                  "load_object_map", "query_objects", "points", "object_request", "object_answer", "conversation"]
        try:
            self.loaded = self.load(
                name=self.name + "/engine", type="hyselam_objects/ObjectEngine",
                remap_source_args=["/" + t for t in topics] + ["/diagnostics"],
                remap_target_args=[self.name + "/" + t for t in topics] + [self.name + "/diagnostics"]).success
        except rospy.ServiceException:
            self.loaded = False
        if self.loaded:
            wait_until(lambda: self.maps.messages)
        return self.loaded

    def publisher(self, topic, kind):
        publisher = rospy.Publisher(self.name + "/" + topic, kind, queue_size=20)
        wait_until(lambda: publisher.get_num_connections() > 0)
        return publisher

    def camera(self):
        return (self.publisher("camera/depth/camera_info", CameraInfo),
                self.publisher("camera/depth/image_raw", Image), self.publisher("camera/color/image_raw", Image))

    def show(self, camera, stamp, **changes):
        info = CameraInfo(width=WIDTH, height=HEIGHT)
        info.K = [FOCAL, 0, WIDTH / 2 - 0.5, 0, FOCAL, HEIGHT / 2 - 0.5, 0, 0, 1]
        depth = Image(width=WIDTH, height=HEIGHT, encoding="16UC1", step=2 * WIDTH, data=self.seen[0])
        colour = Image(width=WIDTH, height=HEIGHT, encoding="bgr8", step=3 * WIDTH, data=self.seen[1])
        frame = changes.pop("frame", "camera_optical_frame")
        for key, value in changes.items():
            setattr(depth, key, value)
        for publisher, msg in zip(camera, (info, depth, colour)):
            msg.header.frame_id = frame
            msg.header.stamp = rospy.Time(stamp)
            publisher.publish(msg)

    def kinds(self):
        return [o.kind for o in self.maps.messages[-1].objects] if self.maps.messages else []

    def see(self, camera, first=1000, enough=lambda: True):
        """Shows the table until it and the thing are on the map, and what is asked for."""
        stamp = [first]

        def seen():
            stamp[0] += 1
            self.show(camera, stamp[0])
            rospy.sleep(0.2)
            return sorted(self.kinds()) == ["furniture", "thing"] and enough()
        wait_until(seen)

    def test_seen_objects_with_relations_and_markers(self):
        self.assertTrue(self.start())
        # A relation is believed when both ends have been seen again.
        self.see(self.camera(), enough=lambda: any(r.word == "on" for r in self.maps.messages[-1].relations))
        newest = self.maps.messages[-1]
        box, = [o for o in newest.objects if o.kind == "thing"]
        table, = [o for o in newest.objects if o.kind == "furniture"]
        self.assertAlmostEqual(box.pose.position.x, 1.87, delta=0.08)
        self.assertAlmostEqual(box.pose.position.z, 0.83, delta=0.05)
        self.assertEqual(dict(zip(box.property_names, box.property_values))["colour"], "red")
        self.assertAlmostEqual(table.pose.position.z, 0.35, delta=0.03)
        self.assertTrue(any(r.object == box.id and r.word == "on" and r.other == table.id for r in newest.relations))
        wait_until(lambda: {m.ns for m in self.markers.messages[-1].markers} >= {"boxes", "names", "relations"})
        self.assertEqual(self.markers.messages[-1].markers[0].action, Marker.DELETEALL)

    def test_told_objects_questions_files(self):
        self.assertTrue(self.start())
        text = self.publisher("object_text", String)
        place = self.publisher("place", PlaceState)
        place.publish(PlaceState(name="kitchen"))
        delivered()
        text.publish("There is a cup on the table. It is red.")
        wait_until(lambda: self.replies.messages)
        self.assertIn("cup", self.replies.messages[0].data)
        self.assertIn("before my camera", self.replies.messages[0].data)
        ask = rospy.ServiceProxy(self.name + "/query_objects", QueryObjects)
        answer = ask("Where is the red cup?")
        self.assertTrue(answer.understood)
        self.assertEqual(answer.places, ["kitchen"])
        self.assertFalse(ask("Blah blah blah.").understood)
        path = os.path.join(self.folder.name, "objects.xml")
        save = rospy.ServiceProxy(self.name + "/save_object_map", ObjectMapPath)
        load = rospy.ServiceProxy(self.name + "/load_object_map", ObjectMapPath)
        self.assertTrue(save(path).success)
        ask("Forget the cup.")
        self.assertIn("know of no", ask("Where is the cup?").reply)
        self.assertTrue(load(path).success)
        self.assertIn("kitchen", ask("Where is the cup?").reply)
        self.assertFalse(load(os.path.join(self.folder.name, "none.xml")).success)
        with open(path, "w") as out:
            out.write("<object_map>")
        self.assertFalse(load(path).success)
        self.assertFalse(save("/does/not/exist/objects.xml").success)
        self.assertIn("kitchen", ask("Where is the cup?").reply, "what was there stays")

    def test_a_shown_object_is_learnt(self):
        path = os.path.join(self.folder.name, "dictionary.xml")
        self.assertTrue(self.start(dictionary_file=path, views_to_learn=3))
        ask = rospy.ServiceProxy(self.name + "/query_objects", QueryObjects)
        ask.wait_for_service(WAIT)
        ask("This is a milk carton.")
        camera = self.camera()
        stamp = [2000]

        def learnt():
            stamp[0] += 1
            self.show(camera, stamp[0])
            rospy.sleep(0.2)
            return "milk carton" in self.kinds()
        wait_until(learnt)
        self.assertTrue(any("Now I know" in m.data for m in self.replies.messages))
        with open(path) as file:
            self.assertIn("milk carton", file.read())

    def test_bad_frames_are_refused_and_the_next_is_used(self):
        self.assertTrue(self.start())
        camera = self.camera()
        for number, changes in enumerate([{"encoding": "8UC1"}, {"data": b"123"}, {"step": 1}, {"width": 0},
                                          {"is_bigendian": 1}, {"height": 99999}, {"frame": "nowhere"}]):
            self.show(camera, 10 + number, **changes)
        camera[0].publish(CameraInfo())
        self.see(camera)

    def number(self, key):
        """What the newest diagnosis counts."""
        return int({v.key: v.value for v in self.status().values}.get(key, -1))

    def test_what_the_camera_lacks_is_told_of(self):
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        self.assertTrue(self.start(diagnostic_period=0.05))
        info, depth, colour = self.camera()
        topics = {which: f"{self.name}/camera/{which}" for which in ("depth/image_raw", "color/image_raw", "depth/camera_info")}
        wait_until(lambda: all("on " + topic in self.status().message for topic in topics.values()), lambda: str(self.status()))
        self.assertEqual(self.status().level, DiagnosticStatus.WARN)
        stamp = [5000]

        def told(camera, condition):
            def shown():
                stamp[0] += 1
                self.show(camera, stamp[0])
                rospy.sleep(0.2)
                return any(condition(status.message) for array in self.diagnostics.messages for status in array.status)
            self.diagnostics.messages.clear()
            wait_until(shown, lambda: str(self.status()))
        silent = types.SimpleNamespace(publish=lambda msg: None)
        told((silent, depth, colour), lambda text: "no camera_info on " + topics["depth/camera_info"] in text
             and "no images" not in text)
        told((info, depth, silent), lambda text: "no images on " + topics["color/image_raw"] in text
             and topics["depth/image_raw"] not in text)

        def later(msg):
            msg.header.stamp += rospy.Duration(0.004)
            colour.publish(msg)
        told((info, depth, types.SimpleNamespace(publish=later)), lambda text: "has the same stamp" in text)
        told((info, depth, colour), lambda text: "no " not in text)

    def test_a_pose_that_comes_later_than_the_next_frame(self):
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        self.assertTrue(self.start(transform_wait=5.0, diagnostic_period=0.05))
        camera = self.camera()
        broadcaster = tf2_ros.TransformBroadcaster()
        count = [0]

        def used():
            count[0] += 1
            self.show(camera, 6000 + 0.1 * count[0], frame="late_optical_frame")
            pose = TransformStamped()
            pose.header.stamp = rospy.Time(6000 + 0.1 * (count[0] - 3))
            pose.header.frame_id, pose.child_frame_id = "map", "late_optical_frame"
            pose.transform.rotation.w = 1.0
            broadcaster.sendTransform(pose)
            rospy.sleep(0.1)
            return self.number("frames used") >= 2
        wait_until(used, lambda: str(self.status()))

    def test_a_late_frame_is_no_jump_back(self):
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        self.assertTrue(self.start(diagnostic_period=0.05))
        camera = self.camera()

        def counts(key, number):
            wait_until(lambda: self.number(key) >= number, lambda: str(self.status()))
        # Three connections: without what camera_info tells, the first pair would be left out.
        silent = types.SimpleNamespace(publish=lambda msg: None)
        self.show((camera[0], silent, silent), 6899.5)
        wait_until(lambda: self.status().name and "camera_info" not in self.status().message, lambda: str(self.status()))
        stamp = [6900]

        def used():
            """One frame after the other, until the pose of the camera is known, too."""
            stamp[0] += 1
            self.show(camera, stamp[0])
            wait_until(lambda: self.number("frames used") + self.number("frames without a pose") == stamp[0] - 6900, lambda: str(self.status()))
            return self.number("frames used") > 0
        wait_until(used, lambda: str(self.status()))
        self.assertEqual(self.number("frames used"), 1)
        self.show(camera, stamp[0] - 0.1)
        delivered()
        self.show(camera, 7001, encoding="8UC1")
        counts("frames refused", 1)
        self.assertEqual(self.number("frames used"), 1)
        self.show(camera, 6999)  # a bag begins again
        counts("frames used", 2)

    def look_from(self, x):
        t = TransformStamped()
        t.header.frame_id, t.child_frame_id = "map", "camera_optical_frame"
        t.transform.translation.x, t.transform.translation.z = x, CAMERA
        q = t.transform.rotation
        q.x, q.y, q.z, q.w = -0.5, 0.5, -0.5, 0.5
        self.broadcaster.sendTransform(t)

    def said_of_landmarks(self):
        return [v.value for array in self.diagnostics.messages for status in array.status
                for v in status.values if v.key == "landmarks"]

    def test_a_robot_that_is_a_metre_off_is_noticed(self):
        self.assertTrue(self.start(diagnostic_period=0.05))
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        camera = self.camera()
        self.see(camera)
        stamp = [1100]  # another visit

        def seen_until(wanted):
            def looked():
                stamp[0] += 1
                self.show(camera, stamp[0])
                rospy.sleep(0.2)
                return wanted in self.said_of_landmarks()
            wait_until(looked, lambda: str(set(self.said_of_landmarks())))
        seen_until("consistent")
        self.assertNotIn("displaced", self.said_of_landmarks())
        self.addCleanup(lambda: self.look_from(0.0))
        self.look_from(1.0)
        seen_until("displaced")
        self.assertTrue(any("seems to be elsewhere" in status.message for array in self.diagnostics.messages
                            for status in array.status))

    def test_clouds_that_no_camera_sees_are_refused(self):
        self.assertTrue(self.start(use_points=True, diagnostic_period=0.05))
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        points = self.publisher("points", PointCloud2)
        depth = struct.unpack("<%dH" % (WIDTH * HEIGHT), self.seen[0])

        def cloud(flip_x, flip_y):
            data = bytearray()
            for v in range(HEIGHT):
                for u in range(WIDTH):
                    z = 0.001 * depth[v * WIDTH + u] or math.nan
                    data += struct.pack("<4f", flip_x * (u - WIDTH / 2 + 0.5) / FOCAL * z,
                                        flip_y * (v - HEIGHT / 2 + 0.5) / FOCAL * z, z, 0.0)
            msg = PointCloud2(width=WIDTH, height=HEIGHT, point_step=16, row_step=16 * WIDTH, data=bytes(data))
            msg.fields = [PointField(name=n, offset=4 * i, datatype=PointField.FLOAT32, count=1)
                          for i, n in enumerate(("x", "y", "z", "rgb"))]
            msg.header.frame_id = "camera_optical_frame"
            return msg
        stamp = [3000]

        def sent_until(msg, condition):
            def sent():
                stamp[0] += 1
                msg.header.stamp = rospy.Time(stamp[0])
                points.publish(msg)
                rospy.sleep(0.2)
                return condition()
            wait_until(sent, "what the cloud leads to")

        def told(text):
            return any(text in status.message for array in self.diagnostics.messages for status in array.status)
        for number, flip in enumerate([(-1.0, 1.0), (1.0, -1.0)]):
            self.diagnostics.messages.clear()
            sent_until(cloud(*flip), lambda: told("not in the order of a camera's picture"))
            self.assertEqual(self.kinds(), [], number)
        self.diagnostics.messages.clear()
        sent_until(cloud(math.nan, 1.0), lambda: told("hardly a point is valid"))
        sent_until(cloud(1.0, 1.0), self.kinds)

    def asking(self):
        ask = rospy.ServiceProxy(self.name + "/query_objects", QueryObjects)
        ask.wait_for_service(WAIT)
        return lambda text: ask(text).reply

    def status(self):
        """The newest diagnosis of the engine."""
        all_of_it = [s for array in self.diagnostics.messages for s in array.status if s.name.endswith(": objects")]
        return all_of_it[-1] if all_of_it else DiagnosticStatus()

    def file_holds(self, text, name="objects.xml"):
        path = os.path.join(self.folder.name, name)
        if not os.path.exists(path):
            return False
        with open(path) as file:
            return text in file.read()

    def test_what_was_told_outlives_a_kill(self):
        path = os.path.join(self.folder.name, "objects.xml")
        # Of its own process; what it sees it would save in an hour.
        command = [find_node("hyselam_objects", "object_engine_node")[0], "__ns:=" + self.name, "_map_file:=" + path,
                   "_autosave_period:=3600"]
        for text, reply in (("There is a pen in the kitchen.", "pen"), ("Where is the pen?", "kitchen"),
                            ("The pen is red. Where is the red pen?", "kitchen"), ("Forget the pen.", ""),
                            ("Where is the pen?", "know of no")):
            engine = subprocess.Popen(command)
            try:
                wait_until(lambda: self.answers(text), "an answer")
                self.assertIn(reply, self.answer)
            finally:
                engine.kill()
                engine.wait()
                forget_dead(self.name + "/object_engine")
        self.assertEqual(os.listdir(self.folder.name), ["objects.xml"])

    def answers(self, text):
        try:
            self.answer = rospy.ServiceProxy(self.name + "/query_objects", QueryObjects)(text).reply
        except rospy.ServiceException:
            return False
        return True

    def test_what_is_seen_is_saved_by_itself_and_at_the_end(self):
        path = os.path.join(self.folder.name, "objects.xml")
        self.assertTrue(self.start(map_file=path, autosave_period=0.1))
        self.see(self.camera())
        wait_until(lambda: self.file_holds("furniture"), "what is seen in the file")
        self.unload(name=self.name + "/engine")
        path = os.path.join(self.folder.name, "slow.xml")
        self.name += "_slow"
        self.maps = Listener(self.name + "/object_map", ObjectMap)
        self.assertTrue(self.start(map_file=path, autosave_period=3600.0))
        self.see(self.camera())
        self.assertFalse(os.path.exists(path), "saved too soon")
        self.unload(name=self.name + "/engine")
        self.loaded = False
        wait_until(lambda: self.file_holds("furniture", "slow.xml"), "what is seen in the file at the end")

    def test_a_damaged_map_file_is_put_aside(self):
        path = os.path.join(self.folder.name, "objects.xml")
        with open(path, "w") as out:
            out.write("<object_map>")
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        self.assertTrue(self.start(map_file=path, diagnostic_period=0.05))
        wait_until(lambda: self.status().level == DiagnosticStatus.ERROR, lambda: str(self.status()))
        self.assertIn(path, self.status().message)
        with open(path + ".damaged") as file:
            self.assertEqual(file.read(), "<object_map>")
        self.assertFalse(os.path.exists(path))
        self.assertEqual(self.kinds(), [])
        ask = self.asking()
        ask("There is a pen in the kitchen.")
        self.assertTrue(self.file_holds("pen"))
        wait_until(lambda: self.status().level != DiagnosticStatus.ERROR, lambda: str(self.status()))

    def test_a_map_file_that_cannot_be_written_is_told_of(self):
        folder = os.path.join(self.folder.name, "later")
        self.diagnostics = Listener(self.name + "/diagnostics", DiagnosticArray)
        self.addCleanup(self.diagnostics.close)
        log = Listener("/rosout_agg", Log)
        self.addCleanup(log.close)
        wait_until(lambda: log.subscriber.get_num_connections() > 0)
        self.assertTrue(self.start(map_file=os.path.join(folder, "objects.xml"), autosave_period=0.1, diagnostic_period=0.05))
        ask = self.asking()
        ask("There is a pen in the kitchen.")
        wait_until(lambda: self.status().level == DiagnosticStatus.ERROR, lambda: str(self.status()))
        self.assertIn(folder, self.status().message)
        self.assertIn("kitchen", ask("Where is the pen?"))
        ask("There is a cup in the kitchen.")
        self.assertIn("kitchen", ask("Where is the cup?"))
        os.mkdir(folder)
        # Though nobody tells anything more.
        wait_until(lambda: self.status().level != DiagnosticStatus.ERROR, lambda: str(self.status()))
        self.assertIn("objects.xml", os.listdir(folder))
        wait_until(lambda: any(m.name == "/manager" and "not saved" in m.msg and folder in m.msg for m in log.messages), "the log")
        self.assertEqual(len([m for m in log.messages if m.name == "/manager" and "not saved" in m.msg and folder in m.msg]), 1)

    def test_bad_parameters_and_files_do_not_load(self):
        bad = os.path.join(self.folder.name, "bad.xml")
        with open(bad, "w") as out:
            out.write("no XML")
        for number, params in enumerate([{"frame_period": -1.0}, {"association_gate": 0.0}, {"autosave_period": 0.0}, {"dictionary_file": bad}]):
            self.name += str(number)
            self.assertFalse(self.start(**params), params)


if __name__ == "__main__":
    rospy.init_node("object_engine_test")
    rostest.rosrun("hyselam_bringup", "object_engine", ObjectEngineTest)
