#!/usr/bin/env python3
"""The nodelet SemanticLocalization: the same places as offline, bad images, learning while driving, tests of the pose."""
import copy
import csv
import json
import math
import os
import subprocess
import tempfile
import unittest

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from hyselam_msgs.msg import AugmentedTopologicalMap, LocalizationStatus, Place, PlaceEdge, PlaceState, PlaceWord, VisualPlace
from nodelet.srv import NodeletList, NodeletUnload
from sensor_msgs.msg import CompressedImage, Image, LaserScan
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from localization_rig import Listener, delivered, load_nodelet, newest_status, values_of, wait_until

COLOR = "/camera/color/image_raw"
ROOMS = {"left room": (1, 2.0), "right room": (2, 6.0)}  # id, x of the middle; the wall is at x = 4


def tool(package, name, *args):
    done = subprocess.run(["rosrun", package, name, *map(str, args)], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{name}: {done.stderr}")


def as_ppm(image):
    """The same pixels as a file that `evaluate` reads without loss."""
    pixels = bytearray(image.data)
    pixels[0::3], pixels[2::3] = pixels[2::3], pixels[0::3]
    return b"P6\n%d %d\n255\n" % (image.width, image.height) + bytes(pixels)


class Film:
    """The plan `small`, filmed raw and as JPEG; lists of both for the offline tools, models of both."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        at = lambda name: os.path.join(self.folder.name, name)  # noqa: E731
        tool("hyselam_sim", "simulate", "--route", "small", "--out", at("run.bag"))
        common = ["--bag", at("run.bag"), "--route", "small", "--rate", 1, "--width", 160, "--height", 120]
        tool("hyselam_sim", "film", *common, "--out", at("raw.bag"), "--images", at("images"))
        tool("hyselam_sim", "film", *common, "--out", at("jpeg.bag"), "--jpeg", 90)
        with open(at("images/labels.csv"), newline="") as file:
            rows = {round(float(row["stamp"]), 3): row for row in csv.DictReader(file)}
        place = {stamp: row["place"] for stamp, row in rows.items()}
        self.raw, self.jpeg, self.scans, self.places, self.poses = [], [], {}, [], []
        with rosbag.Bag(at("raw.bag")) as bag:
            for topic, msg, _ in bag.read_messages(["/scan", COLOR]):
                if topic == "/scan":
                    self.scans[round(msg.header.stamp.to_sec(), 3)] = msg
                elif round(msg.header.stamp.to_sec(), 3) in place:
                    self.raw.append(msg)
                    row = rows[round(msg.header.stamp.to_sec(), 3)]
                    self.places.append(row["place"])
                    self.poses.append([float(row[key]) for key in ("x", "y", "theta")])
        with rosbag.Bag(at("jpeg.bag")) as bag:
            for _, msg, _ in bag.read_messages([COLOR + "/compressed"]):
                if round(msg.header.stamp.to_sec(), 3) in place:
                    self.jpeg.append(msg)
        self.raw_list = self.write("raw", "ppm", self.raw, as_ppm)
        self.jpeg_list = self.write("jpeg", "jpg", self.jpeg, lambda image: bytes(image.data))
        self.scan_model, self.model = at("scan_model"), at("model")
        for labels, model, descriptor in ((self.raw_list, self.scan_model, "GLANCE+scan"),
                                          (self.jpeg_list, self.model, "GLANCE")):
            tool("selovis", "train", "--labels", labels, "--descriptor", descriptor, "--kernel", "exemplar",
                 "--out", model)

    def scan_of(self, image):
        return self.scans[round(image.header.stamp.to_sec(), 3)]

    def write(self, name, extension, images, content):
        folder = os.path.join(self.folder.name, name)
        os.mkdir(folder)
        beams = len(self.scan_of(images[0]).ranges)
        with open(os.path.join(folder, "labels.csv"), "w", newline="") as file:
            rows = csv.writer(file)
            pose = ["x", "y", "theta"]
            rows.writerow(["image_path", "place", "stamp", *pose, *("odom_" + p for p in pose)]
                          + [f"scan_{i}" for i in range(beams)])
            for i, image in enumerate(images):
                with open(os.path.join(folder, f"{i:04d}.{extension}"), "wb") as out:
                    out.write(content(image))
                rows.writerow([f"{i:04d}.{extension}", self.places[i], image.header.stamp.to_sec(), *self.poses[i],
                               *self.poses[i], *self.scan_of(image).ranges])
        return os.path.join(folder, "labels.csv")

    def predictions(self, model, labels, kind="bayes"):
        path = os.path.join(self.folder.name, "predictions.csv")
        tool("selovis", "evaluate", model, "--labels", labels, "--filter", kind, "--predictions", path)
        with open(path, newline="") as file:
            return list(csv.DictReader(file))

    def frame_in(self, place):
        """A raw frame from the middle of a stay in the place."""
        at = [i for i, p in enumerate(self.places) if p == place]
        return self.raw[at[len(at) // 2]]


def topological_map(names=tuple(ROOMS)):
    """The two rooms, each 4 m x 4 m, joined."""
    msg = AugmentedTopologicalMap()
    msg.header.frame_id = "map"
    msg.next_place_id, msg.next_wall_id, msg.next_door_id = 10, 1, 1
    for name in names:
        place = Place()
        place.id = ROOMS[name][0] if name in ROOMS else 3
        place.words = [PlaceWord(name, True)]
        place.has_centre = True
        place.centre.x, place.centre.y = ROOMS.get(name, (3, 6.0))[1], 2.0
        msg.places.append(place)
    msg.edges = [PlaceEdge(a=msg.places[0].id, b=msg.places[1].id)] if len(names) > 1 else []
    msg.has_grid = True
    msg.grid.width, msg.grid.height, msg.grid.resolution = 80, 40, 0.1
    msg.grid.places = [p.id for p in msg.places]
    right = 2 if len(names) > 1 else 0
    msg.grid.labels = [1 if x < 40 else right for _ in range(40) for x in range(80)]
    return msg


def transform(image, parent, pose):
    """The robot's pose at the time of an image."""
    msg = TransformStamped()
    msg.header.frame_id, msg.header.stamp, msg.child_frame_id = parent, image.header.stamp, "base_link"
    msg.transform.translation.x, msg.transform.translation.y = pose[:2]
    msg.transform.rotation.z, msg.transform.rotation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
    return msg


class Rig:
    """One nodelet in the manager, in a namespace of its own."""

    def __init__(self, name, compressed=False, **params):
        self.name, self.node, self.sent = name, f"/{name}/visual", 0
        params.setdefault("diagnostic_period", 0.05)
        params.setdefault("queue_size", 1000)
        if compressed:
            params["image_transport"] = "compressed"
        for key, value in params.items():
            rospy.set_param(f"{self.node}/{key}", value)
        pub = lambda topic, kind, **kw: rospy.Publisher(f"/{name}/{topic}", kind, queue_size=1000, **kw)  # noqa: E731
        self.image = pub("image/compressed", CompressedImage) if compressed else pub("image", Image)
        self.scan, self.map, self.place = pub("scan", LaserScan), pub("topological_map", AugmentedTopologicalMap), \
            pub("place", PlaceState)
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=1000)
        self.localization = pub("localization_status", LocalizationStatus)
        self.seen = Listener(f"/{name}/visual_place", VisualPlace)
        self.kidnapped = Listener(f"{self.node}/kidnapped", Bool)
        self.initialpose = Listener(f"/{name}/initialpose", PoseWithCovarianceStamped)
        self.markers = Listener(f"/{name}/place_markers", MarkerArray)
        self.diagnostics = Listener(f"/{name}/diagnostics", DiagnosticArray)
        self.loaded = load_nodelet("selovis/SemanticLocalization", self.node, {"/diagnostics": f"/{name}/diagnostics"})
        if self.loaded:
            outputs = (self.seen, self.kidnapped, self.initialpose, self.diagnostics, self.markers)
            wait_until(lambda: all(p.get_num_connections() > 0 for p in (self.image, self.map, self.place, self.tf, self.localization))
                       and all(o.subscriber.get_num_connections() > 0 for o in outputs), "no connections")

    def close(self):
        if self.loaded:
            rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)(self.node)
        for listener in (self.seen, self.kidnapped, self.initialpose, self.diagnostics, self.markers):
            listener.close()
        for publisher in (self.image, self.scan, self.map, self.place, self.tf, self.localization):
            publisher.unregister()

    def give(self, image, scan=None):
        if scan is not None:
            self.scan.publish(scan)
        self.image.publish(image)
        self.sent += 1

    def wait_used(self):
        """Waits until every image has been used or dropped."""
        wait_until(lambda: self.number("images received") == self.sent
                   and self.number("images used") + self.number("images dropped") == self.sent,
                   lambda: f"sent {self.sent}: {self.values()}")

    def give_map(self, msg):
        self.map.publish(msg)

    def status(self):
        return newest_status(self.diagnostics, lambda name: name == self.node[1:] + ": visual places")

    def values(self):
        return values_of(self.status())

    def number(self, key):
        return int(self.values().get(key, "-1"))

    def call(self, service):
        return rospy.ServiceProxy(f"{self.node}/{service}", Trigger)()


class VisualPlacesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.film = Film()

    def rig(self, after="", **params):
        rig = Rig(self._testMethodName[5:25] + after, **params)
        self.addCleanup(rig.close)
        return rig

    def assert_same(self, rig, expected):
        rig.seen.wait(len(expected))
        self.assertEqual(len(rig.seen.messages), len(expected))
        for got, want in zip(rig.seen.messages, expected):
            self.assertEqual(got.name, want["predicted"])
            self.assertEqual(got.frame_name, want["frame_alone"])
            self.assertAlmostEqual(got.probability, float(want["probability"]), delta=2e-5)
            self.assertAlmostEqual(got.novelty, float(want["novelty"]), delta=2e-5)
        return sum(g.name == p for g, p in zip(rig.seen.messages, self.film.places)) / len(expected)

    def test_camera_and_laser_as_offline(self):
        rig = self.rig(model=self.film.scan_model)
        wait_until(lambda: rig.scan.get_num_connections() > 0, "the nodelet does not listen to scans")
        for image in self.film.raw:
            rig.give(image, self.film.scan_of(image))
        rig.wait_used()
        expected = self.film.predictions(self.film.scan_model, self.film.raw_list)
        self.assertGreater(self.assert_same(rig, expected), 0.9)
        self.assertEqual(rig.values()["images dropped"], "0")

    def test_compressed_images_as_offline(self):
        rig = self.rig(model=self.film.model, compressed=True)
        for image in self.film.jpeg:
            rig.give(image)
        rig.wait_used()
        self.assert_same(rig, self.film.predictions(self.film.model, self.film.jpeg_list))

    def test_poses_and_odometry_as_offline(self):
        rig = self.rig(model=self.film.model, compressed=True, filter="poses", odom_frame_id="drift")
        moved = [transform(image, "drift", pose) for image, pose in zip(self.film.jpeg, self.film.poses)]
        for i, image in enumerate(self.film.jpeg):
            rig.tf.publish(TFMessage(moved[i:i + 2]))  # one ahead: tf and images come on threads of their own
            if i == 0:
                rospy.sleep(1.0)
            rig.give(image)
            rig.wait_used()
        expected = self.film.predictions(self.film.model, self.film.jpeg_list, "poses")
        rig.seen.wait(len(expected))
        self.assertEqual(len(rig.seen.messages), len(expected))
        # Angles go through a quaternion: a particle may fall the other way.
        same = sum(got.name == want["predicted"] for got, want in zip(rig.seen.messages, expected))
        self.assertGreater(same / len(expected), 0.95)
        self.assertGreater(sum(g.name == p for g, p in zip(rig.seen.messages, self.film.places)) / len(expected), 0.9)

    def test_filter_of_poses_without_poses_is_refused(self):
        self.assertFalse(self.rig(descriptor="GLANCE", kernel="rbf", filter="poses").loaded)

    def test_bad_images_in_mid_stream(self):
        rig = self.rig(model=self.film.model, descriptive_filter="corners")
        good = self.film.frame_in("left room")

        def changed(**fields):
            image = copy.deepcopy(good)
            for key, value in fields.items():
                setattr(image, key, value)
            return image
        for _ in range(5):
            rig.give(good)
        rig.wait_used()
        before = rig.seen.wait(5)
        self.assertEqual(before.name, "left room")
        bad = {
            "a grey image": changed(encoding="mono8", step=good.width, data=bytes(good.width * good.height)),
            "too few bytes": changed(data=good.data[:1000]),
            "no pixels": changed(width=0, height=0, data=b""),
            "an unknown encoding": changed(encoding="cmyk"),
            "depth": changed(encoding="16UC1"),
        }
        for what, image in bad.items():
            if what == "a grey image":
                continue  # GLANCE needs colour: checked below
            rig.give(image)
            rig.wait_used()
        self.assertEqual(rig.number("images dropped"), 4)
        rig.seen.wait(5)
        self.assertEqual(len(rig.seen.messages), 5)
        # In the dark: passed over, the place stays.
        rig.give(changed(data=bytes(len(good.data))))
        rig.wait_used()
        dark = rig.seen.wait(6)
        self.assertFalse(dark.descriptive)
        self.assertEqual((dark.name, dark.probabilities), (before.name, before.probabilities))
        # Another resolution: half of the rows.
        rig.give(changed(height=good.height // 2, data=good.data[:len(good.data) // 2]))
        rig.wait_used()
        rig.seen.wait(7)
        self.assertEqual(len(rig.seen.messages), 7)
        rig.give(bad["a grey image"])
        seen = len(rig.seen.messages)
        rig.give(good)
        rig.wait_used()
        self.assertEqual(rig.seen.wait(seen + 1).name, "left room")

    def test_truncated_jpeg(self):
        rig = self.rig(model=self.film.model, compressed=True)
        for image in self.film.jpeg[:3]:
            rig.give(image)
        for length in (len(self.film.jpeg[3].data) // 2, 10, 0):
            cut = copy.deepcopy(self.film.jpeg[3])
            cut.data = cut.data[:length]
            rig.give(cut)
        rig.give(self.film.jpeg[4])
        rig.wait_used()
        self.assertEqual(rig.number("images dropped"), 3)
        rig.seen.wait(4)
        self.assertEqual(len(rig.seen.messages), 4)

    def test_missing_readings(self):
        rig = self.rig(model=self.film.scan_model, sync_timeout=0.1)
        wait_until(lambda: rig.scan.get_num_connections() > 0, "the nodelet does not listen to scans")
        rig.give(self.film.raw[0])
        rig.wait_used()
        self.assertEqual(rig.number("dropped: no reading"), 1)
        self.assertIn("no scan", rig.values()["last dropped"])
        other = copy.deepcopy(self.film.scan_of(self.film.raw[1]))
        other.ranges = other.ranges[:20]  # too few for 61 groups of beams
        rig.give(self.film.raw[1], other)
        rig.wait_used()
        rig.give(self.film.raw[2], self.film.scan_of(self.film.raw[2]))
        rig.wait_used()
        rig.seen.wait()

    def test_models_that_cannot_be_used(self):
        cut = os.path.join(self.film.folder.name, "cut")
        subprocess.run(["cp", "-r", self.film.model, cut], check=True)
        data = next(f for f in os.listdir(cut) if f.startswith("signatures"))
        with open(os.path.join(cut, data), "r+b") as file:
            file.truncate(1000)
        other = os.path.join(self.film.folder.name, "other")
        subprocess.run(["cp", "-r", self.film.model, other], check=True)
        with open(os.path.join(other, "model.json")) as file:
            manifest = json.load(file)
        manifest["descriptor"] = "SLBP"
        with open(os.path.join(other, "model.json"), "w") as file:
            json.dump(manifest, file)
        for number, params in enumerate(({"model": "/nowhere"}, {"model": cut}, {"model": other}, {"filter": "magic"},
                                         {"kidnapping_false_alarm_hours": -1.0}, {"known_from": -1.0}, {"descriptor": "BOF-ORB500"},
                                         {"descriptor": "no such"})):
            rig = Rig(f"unusable_{number}", **params)
            self.addCleanup(rig.close)
            self.assertFalse(rig.loaded, params)
        self.assertEqual(list(rospy.ServiceProxy("/manager/list", NodeletList)().nodelets), [])

    def test_map_with_and_without_a_place(self):
        rig = self.rig(model=self.film.model)
        rig.give_map(topological_map())
        wait_until(lambda: rig.values().get("places of the map") == "2", "the map")
        for _ in range(3):
            rig.give(self.film.frame_in("right room"))
        rig.wait_used()
        seen = rig.seen.wait(3)
        self.assertEqual((seen.name, seen.place), ("right room", 2))
        bars = [m for m in rig.markers.wait().markers if m.ns == "bars"]
        self.assertEqual(sorted(m.id for m in bars), [1, 2])
        self.assertGreater(max(bars, key=lambda m: m.scale.z).pose.position.x, 4.0)
        rig.give_map(topological_map(["left room"]))
        wait_until(lambda: rig.values().get("places not on the map") == "1", "a place is gone")
        rig.give(self.film.frame_in("right room"))
        rig.wait_used()
        self.assertEqual(rig.seen.wait(4).place, 0, "it is recognised, and has no id")
        broken = topological_map()
        broken.grid.width = 7
        rig.give_map(broken)
        wait_until(lambda: "topological_map" in rig.status().message, "a broken map is reported")
        rig.give(self.film.frame_in("right room"))
        rig.wait_used()

    def test_learning_while_driving(self):
        folder = os.path.join(self.film.folder.name, "learned")
        topo = os.path.join(self.film.folder.name, "learned.xml")
        rig = self.rig(save_model=folder, save_map=topo, autosave=False, retrain_every=0, min_travel=0.0, min_turn=0.0)
        self.assertFalse(rig.call("retrain").success)
        self.assertFalse(rig.call("save").success, "nothing has been learned")
        rig.give_map(topological_map())
        wait_until(lambda: rig.values().get("places of the map") == "2", "the map")
        self.assertTrue(rig.call("start_learning").success)
        self.learn_tour(rig)
        self.assertIn("frames collected", rig.call("stop_learning").message)
        collected = rig.number("frames collected")
        # A place and the image after it come on two connections: the first may overtake.
        self.assertGreaterEqual(collected, len(self.film.raw) - 2)
        answer = rig.call("retrain")
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: rig.number("frames trained") == collected, "trained")
        self.assertIn(f"{collected} frames collected, not saved yet", rig.status().message)
        answer = rig.call("save")
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: "not saved" not in rig.status().message, "saved")
        begun = len(rig.seen.messages)
        for image in self.film.raw:
            rig.give(image)
        rig.wait_used()

        def recognized():  # place of each image after the training, by its time
            return {g.header.stamp: g.name for g in rig.seen.messages[begun:]}

        wait_until(lambda: all(image.header.stamp in recognized() for image in self.film.raw), "all images")
        right = sum(recognized()[image.header.stamp] == place
                    for image, place in zip(self.film.raw, self.film.places))
        self.assertGreater(right / len(self.film.places), 0.9)
        # What was saved is what offline tools read; the map holds the signatures, enough to learn from again.
        self.assertEqual(len(self.film.predictions(folder, self.film.raw_list)), len(self.film.raw))
        with open(topo) as file:
            self.assertEqual(file.read().count("<signature"), 5 * collected)

    def test_trained_models_are_saved(self):
        folder = os.path.join(self.film.folder.name, "autosaved")
        rig = self.rig(save_model=folder, retrain_every=20, learn=True, min_travel=0.0, min_turn=0.0)
        rig.give_map(topological_map())
        wait_until(lambda: rig.values().get("places of the map") == "2", "the map")
        self.learn_tour(rig)
        wait_until(lambda: rig.number("frames trained") >= 20, "trained")
        trained = rig.number("frames trained")
        self.assertEqual({row["predicted"] for row in self.film.predictions(folder, self.film.raw_list)}, set(ROOMS))
        collected = rig.number("frames collected")
        wait_until(lambda: (f"{collected - trained} frames collected, not saved yet" in rig.status().message) == (collected > trained),
                   "only what came after the training is not saved")
        kept = self.rig("_kept", model="/nowhere", save_model=folder)
        self.assertTrue(kept.loaded, "what was kept goes before what there was to begin with")
        wait_until(lambda: kept.values().get("places") == "2", lambda: str(kept.values()))
        # A place that gets another name keeps what was learned of it.
        named = topological_map()
        named.places[1].words = [PlaceWord("lab", True)]
        rig.give_map(named)
        wait_until(lambda: rig.number("places renamed") >= 1, "the new name")
        rig.wait_used()
        before = len(rig.seen.messages)
        rig.give(self.film.frame_in("right room"))
        rig.wait_used()
        seen = rig.seen.wait(before + 1)
        self.assertEqual((seen.name, seen.place), ("lab", 2))
        self.assertEqual(rig.values()["places"], "2")
        # Also if a training that had begun before ends after it.
        wait_until(lambda: {row["predicted"] for row in self.film.predictions(folder, self.film.raw_list)} == {"left room", "lab"},
                   "the new name, saved")
        # The next one goes on with it; where it cannot write, it says so and lives.
        other = self.rig("_again", model=folder, save_model="/dev/null/none", retrain_every=0, learn=True,
                         min_travel=0.0, min_turn=0.0)
        other.give_map(topological_map())
        wait_until(lambda: other.values().get("places of the map") == "2", "the map")
        self.learn_tour(other)
        self.assertTrue(other.seen.messages, "it knows the places")
        self.assertTrue(other.call("retrain").success)
        wait_until(lambda: "/dev/null/none" in other.status().message, "the folder is named")
        self.assertEqual(other.status().level, DiagnosticStatus.ERROR)

    def learn_tour(self, rig):
        for image, name in zip(self.film.raw, self.film.places):
            state = PlaceState(place=ROOMS[name][0], name=name, confirmed=True)
            state.header.stamp = image.header.stamp
            state.header.frame_id = "map"
            state.pose.x, state.pose.y = ROOMS[name][1], 2.0
            self.place_then_image(rig, state, image)

    def place_then_image(self, rig, state, image):
        rig.place.publish(state)
        rig.give(image)
        rig.wait_used()

    def test_kidnapped_robot(self):
        rig = self.rig(model=self.film.model, expected_place_radius=0.2, grace_period=2.0)
        rig.give_map(topological_map())
        wait_until(lambda: rig.values().get("places of the map") == "2", "the map")
        here, there = self.film.frame_in("left room"), self.film.frame_in("right room")
        clock = [here.header.stamp + rospy.Duration(1000)]

        def show(image, x):
            clock[0] += rospy.Duration(0, 200000000)
            pose = TransformStamped()
            pose.header.stamp, pose.header.frame_id, pose.child_frame_id = clock[0], "map", "base_link"
            pose.transform.translation.x, pose.transform.translation.y, pose.transform.rotation.w = x, 2.0, 1.0
            rig.tf.publish(TFMessage([pose]))
            tested = rig.number("frames tested")
            frame = copy.deepcopy(image)
            frame.header.stamp = clock[0]
            delivered()
            rig.give(frame)
            rig.wait_used()
            return rig.number("frames tested") > tested
        self.assertTrue(any([show(here, 1.5) for _ in range(10)]))
        self.assertEqual([m.data for m in rig.kidnapped.messages], [False])
        frames = 0
        for _ in range(40):
            frames += show(there, 1.5)  # the pose still says left; one whose pose comes late is not tested
            if rig.kidnapped.messages[-1].data:
                break
        wait_until(lambda: rig.kidnapped.messages[-1].data, "the alarm")
        self.assertLessEqual(frames, 12)
        guess = rig.initialpose.wait()
        self.assertEqual(guess.header.frame_id, "map")
        self.assertGreater(guess.pose.pose.position.x, 4.0)
        self.assertGreater(guess.pose.covariance[35], 1.0)
        for _ in range(20):
            show(there, 6.0)  # the localisation has found it
        wait_until(lambda: not rig.kidnapped.messages[-1].data, "they agree again")
        self.assertEqual(rig.values()["alarms"], "1")

    def test_lost_localization(self):
        rig = self.rig(model=self.film.model, expected_place_radius=0.2, relocalization_timeout=1.0,
                       kidnapping_min_place_probability=0.97)  # two frames
        rig.give_map(topological_map())
        wait_until(lambda: rig.values().get("places of the map") == "2", "the map")
        there = self.film.frame_in("right room")
        clock = [there.header.stamp + rospy.Duration(1000)]

        def report(phase):
            msg = LocalizationStatus(phase=phase, converged=phase == LocalizationStatus.TRACKING)
            msg.header.stamp, msg.header.frame_id = clock[0], "map"
            rig.localization.publish(msg)

        def show(count=1):
            for _ in range(count):
                clock[0] += rospy.Duration(0, 200000000)
                rig.tf.publish(TFMessage([transform(there, "map", (1.5, 2.0, 0.0))]))
                frame = copy.deepcopy(there)
                frame.header.stamp = clock[0]
                rig.give(frame)
                rig.wait_used()

        # It searches from the start on: no place is forced upon it.
        report(LocalizationStatus.GLOBAL)
        delivered()
        show(20)
        self.assertFalse(rig.kidnapped.messages[-1].data or rig.initialpose.messages)
        report(LocalizationStatus.LOST)
        delivered()
        show(10)
        guess = rig.initialpose.wait()
        self.assertGreater(guess.pose.pose.position.x, 4.0)
        self.assertEqual((rig.values()["alarms"], rig.values()["localisation lost"]), ("0", "1"))
        show(10)  # the last status still says lost: that was before the pose was set
        self.assertEqual(len(rig.initialpose.messages), 1)
        report(LocalizationStatus.LOST)  # the pose that was set did not do
        delivered()
        show(10)
        wait_until(lambda: len(rig.initialpose.messages) == 2, "the place is set again")
        # It finds itself before the place is known: nothing is set any more.
        show(10)
        report(LocalizationStatus.LOST)
        delivered()
        show(1)
        wait_until(lambda: rig.kidnapped.messages[-1].data, "lost")
        report(LocalizationStatus.TRACKING)
        delivered()
        show(1)
        wait_until(lambda: not rig.kidnapped.messages[-1].data, "it has found itself")
        self.assertEqual(len(rig.initialpose.messages), 2)


if __name__ == "__main__":
    rospy.init_node("visual_places_test")
    rostest.rosrun("hyselam_bringup", "visual_places_test", VisualPlacesTest)
