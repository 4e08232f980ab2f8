"""Drives the localisation nodelets message by message: a simulated run, a clock of its own, and what the
nodelets answer. No test; the localization_*_test.py files import it."""
import copy
import math
import os
import pathlib
import random
import select
import subprocess
import sys
import tempfile
import time
import unittest
import xmlrpc.client

import rosbag
import rosgraph
import rosnode
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from hyselam_msgs.msg import FsdObservation, LocalizationStatus
from nav_msgs.msg import OccupancyGrid
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool
from tf2_msgs.msg import TFMessage

sys.path.insert(0, str(pathlib.Path(os.path.realpath(__file__)).parent.parent / "scripts"))

from free_port import free_port  # noqa: E402, F401 (for the tests)
from planar import compose, inverse, planar  # noqa: E402, F401 (for the tests)

SLOWNESS = float(os.environ.get("HYSELAM_SLOWNESS", "1"))  # of an instrumented build: bags are played so much slower
WAIT = 90.0 * SLOWNESS  # [s] of wall time; never reached when all is well


def angle_between(a, b):
    return abs(math.remainder(a - b, 2 * math.pi))


def wait_until(condition, what, patience=WAIT, pause=0.01):
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline or rospy.is_shutdown():
            raise AssertionError(f"not within {patience:.0f} s: {what() if callable(what) else what}")
        time.sleep(pause)


def delivered(manager="/manager"):
    """Returns when what was published before has come to the nodelets of that manager, and goes before what is published
    now: requests come to the process through the same thread as messages."""
    time.sleep(0.05)  # rospy hands messages to threads of their own
    for _ in range(5):
        rospy.ServiceProxy(f"{manager}/list", NodeletList)()


def load_nodelet(kind, node, topics):
    """Into `manager`, with other topics than its own; whether it is loaded."""
    rospy.wait_for_service("/manager/load_nodelet", WAIT)
    try:
        return rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)(node, kind, list(topics), list(topics.values()), [], "").success
    except rospy.ServiceException:
        return False


def forget_dead(node):
    """Of a node that was killed: when the next one of its name registers, the master would say "shutdown" to whoever has its
    port by then, another test's process for one."""
    rosnode.cleanup_master_blacklist(rosgraph.Master(rospy.get_name()), [node])


def play_bag(path, rate, topics):
    """Plays it with its clock, from when everybody whom the master knows to listen is connected."""
    name = f"/player_{random.randrange(1 << 30)}"
    player = subprocess.Popen([find_node("rosbag", "play")[0], "--clock", "--quiet", "--pause", "--rate", str(rate), "--queue", "100000", path,
                               "--topics", *topics, f"__name:={name[1:]}"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        master = rosgraph.Master(rospy.get_name())

        def connected():
            subscribers = dict(master.getSystemState()[1])
            told = xmlrpc.client.ServerProxy(master.lookupNode(name)).getBusInfo(rospy.get_name())[2]
            return all(len({each[1] for each in told if each[2] == "o" and each[4] == topic}) >= len(set(subscribers.get(topic, [])) - {name})
                       for topic in ["/clock", *topics])
        rospy.wait_for_service(name + "/pause_playback", WAIT)
        wait_until(connected, "not everybody hears the bag")
        rospy.ServiceProxy(name + "/pause_playback", SetBool)(False)
        if player.wait() != 0:
            raise AssertionError(f"rosbag play ended with {player.returncode}")
    finally:
        player.kill()
        player.wait()


class Recording:
    """A run through a shipped plan: its bag and map as files and as messages."""

    def __init__(self, route="small", seed=1):
        self.folder = tempfile.TemporaryDirectory()
        self.bag = os.path.join(self.folder.name, route + ".bag")
        self.yaml = os.path.join(self.folder.name, route + ".yaml")
        subprocess.run(["rosrun", "hyselam_sim", "simulate", "--route", route, "--seed", str(seed), "--out", self.bag,
                        "--map", self.yaml], check=True, stdout=subprocess.DEVNULL)
        self.scans, self.transforms, self.static, self.truth = [], [], [], []
        with rosbag.Bag(self.bag) as bag:
            for topic, msg, _ in bag.read_messages():
                if topic == "/scan":
                    self.scans.append(msg)
                elif topic == "/tf":
                    self.transforms += msg.transforms
                elif topic == "/tf_static":
                    self.static += msg.transforms
                elif topic == "/ground_truth":
                    self.truth.append((msg.header.stamp.to_sec(), planar(msg.pose.pose)))
        self.map = read_map(self.yaml)

    def truth_at(self, stamp):
        return min(self.truth, key=lambda entry: abs(entry[0] - stamp))[1]

    def truth_pose(self, stamp, stddev=0.2):
        """The true pose as an initialpose message."""
        x, y, theta = self.truth_at(stamp)
        msg = PoseWithCovarianceStamped()
        msg.header.frame_id = "map"
        msg.pose.pose.position.x, msg.pose.pose.position.y = x, y
        msg.pose.pose.orientation.z, msg.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
        for i in (0, 7, 35):
            msg.pose.covariance[i] = stddev ** 2
        msg.pose.covariance = list(msg.pose.covariance)
        return msg


def make_map(cells, width, height, resolution, x=0.0, y=0.0, yaw=0.0, frame="map"):
    grid = OccupancyGrid()
    grid.header.frame_id = frame
    grid.info.width, grid.info.height, grid.info.resolution = width, height, resolution
    grid.info.origin.position.x, grid.info.origin.position.y = x, y
    grid.info.origin.orientation.z, grid.info.origin.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    grid.data = cells
    return grid


def read_map(yaml):
    """The PGM and YAML that programs of hyselam_sim write, as a map server would publish them."""
    keys = dict(line.split(": ", 1) for line in open(yaml).read().splitlines() if ": " in line)
    with open(os.path.join(os.path.dirname(yaml), keys["image"].strip()), "rb") as file:
        words = file.read().split(maxsplit=4)
    width, height, pixels = int(words[1]), int(words[2]), words[4]
    x, y, _ = (float(v) for v in keys["origin"].strip("[] ").split(","))
    value = {254: 0, 0: 100}
    rows = [[value.get(p, -1) for p in pixels[r * width:(r + 1) * width]] for r in range(height)]
    return make_map([v for row in reversed(rows) for v in row], width, height, float(keys["resolution"]), x, y)


class Listener:
    """Keeps what comes on a topic."""

    def __init__(self, topic, kind):
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.messages.append, queue_size=10000)

    def wait(self, count=1):
        wait_until(lambda: len(self.messages) >= count,
                   lambda: f"{count} messages on {self.subscriber.name}, {len(self.messages)} came")
        return self.messages[-1]

    def is_unread(self):
        """Something has come that is not among the messages yet."""
        sockets = [each.socket for each in self.subscriber.impl.connections if getattr(each, "socket", None) is not None]
        try:
            return bool(select.select(sockets, [], [], 0.0)[0])
        except (OSError, ValueError):
            return False  # one of them was closed

    def close(self):
        self.subscriber.unregister()


def newest_status(listener, is_wanted):
    """Of those whose name is wanted, in the diagnostics that came; None: there was none."""
    for array in reversed(listener.messages):
        for status in array.status:
            if is_wanted(status.name):
                return status
    return None


def values_of(status):
    """By key; empty for None."""
    return {v.key: v.value for v in status.values} if status else {}


def take_in(listeners):
    """Returns when what has come to this process is among the messages: each topic has a connection and a thread of its own."""
    quiet = [0]

    def taken():
        quiet[0] = 0 if any(listener.is_unread() for listener in listeners) else quiet[0] + 1
        return quiet[0] > 2
    wait_until(taken, "messages are not taken in")


class LogReader:
    """Reads what nodes log: one connection for all rigs."""
    log = None  # /rosout_agg

    def read_log(self):
        """From now on."""
        if LogReader.log is None:
            LogReader.log = Listener("/rosout_agg", Log)
            wait_until(lambda: LogReader.log.subscriber.get_num_connections() > 0, "no connection to /rosout_agg")
        self.logged_before = len(LogReader.log.messages)

    def said(self, *words, level=None):
        """Whether one log message since the rig began holds all the words."""
        return any(all(w in m.msg for w in words) and (level is None or m.level == level)
                   for m in LogReader.log.messages[self.logged_before:])

    def wait_said(self, *words, level=None):
        wait_until(lambda: self.said(*words, level=level),
                   lambda: f"{words}; said: {[m.msg for m in LogReader.log.messages[self.logged_before:]]}")


class Rig(LogReader):
    """One nodelet in the manager `manager`, in a namespace of its own, fed by hand.

    Simulated time is what the rig says. The frames of all rigs are the same; so only one rig lives at a time.
    """
    clock = None

    def __init__(self, name, recording, kind="Localization", **params):
        if Rig.clock is None:
            Rig.clock = rospy.Publisher("/clock", Clock, queue_size=1000)
            Rig.tf = rospy.Publisher("/tf", TFMessage, queue_size=10000)
            Rig.tf_static = rospy.Publisher("/tf_static", TFMessage, queue_size=10, latch=True)
        self.read_log()
        self.name, self.recording = name, recording
        self.node = f"/{name}/{kind.lower()}"
        self.next = 0  # scan to feed
        self.sent = 0  # scans published
        self.set_clock(recording.scans[0].header.stamp.to_sec() - 0.5)
        Rig.tf_static.publish(TFMessage(recording.static))
        params.setdefault("diagnostic_period", 0.05)
        if kind == "Localization":
            params.setdefault("use_map_topic", True)
            params.setdefault("save_pose_rate", -1.0)
        for key, value in params.items():
            rospy.set_param(f"{self.node}/{key}", value)
        self.map_publisher = rospy.Publisher(f"/{name}/map", OccupancyGrid, queue_size=5, latch=True)
        self.scan = rospy.Publisher(f"/{name}/scan", LaserScan, queue_size=10000)
        self.initialpose = rospy.Publisher(f"/{name}/initialpose", PoseWithCovarianceStamped, queue_size=10)
        self.poses = Listener(f"/{name}/amcl_pose", PoseWithCovarianceStamped)
        self.status = Listener(f"/{name}/localization_status", LocalizationStatus)
        self.observations = Listener(f"/{name}/fsd_observation", FsdObservation)
        self.fields = Listener(f"/{name}/density_field", OccupancyGrid)
        self.tf_seen = Listener("/tf", TFMessage)
        self.diagnostics_seen = Listener(f"/{name}/diagnostics", DiagnosticArray)
        self.loaded = self.load(kind)
        if self.loaded:
            inputs = [self.scan] + ([self.initialpose] if kind == "Localization" else [])
            wait_until(lambda: all(topic.get_num_connections() > 0 for topic in inputs + [Rig.clock])
                       and Rig.tf.get_num_connections() > 1, "the nodelet does not listen")
            self.listen_to_tf()

    def listen_to_tf(self):
        """Hears every publisher of /tf that the master knows. Where a nodelet gave the topic up and the next one of
        its process advertises it at once, rospy may meet the gap, and does not try again; a new subscription does."""
        def connected():
            publishers = dict(rosgraph.Master(rospy.get_name()).getSystemState()[0]).get("/tf", [])
            greeted = {connection.callerid_pub for connection in self.tf_seen.subscriber.impl.connections}
            if greeted.issuperset(publishers):
                return True
            if time.monotonic() > self.tf_due:
                self.tf_seen.close()
                self.tf_seen = Listener("/tf", TFMessage)
                self.tf_due = time.monotonic() + 1.0
            return False
        self.tf_due = time.monotonic() + 1.0
        wait_until(connected, "not every publisher of /tf is heard")

    def load(self, kind):
        # A topic for each rig: one that another nodelet of the same process gave up a moment ago is at times not
        # connected again.
        return load_nodelet("fsd_localization/" + kind, self.node, {"/diagnostics": f"/{self.name}/diagnostics"})

    def close(self):
        if self.loaded:
            rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)(self.node)
        for listener in (self.poses, self.status, self.observations, self.fields, self.tf_seen, self.diagnostics_seen):
            listener.close()
        for publisher in (self.map_publisher, self.scan, self.initialpose):
            publisher.unregister()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # What goes in.

    @classmethod
    def set_clock(cls, seconds):
        cls.now = seconds

        def heard():
            cls.clock.publish(Clock(rospy.Time.from_sec(seconds)))
            time.sleep(0.001)
            return abs(rospy.get_time() - seconds) < 1e-6
        wait_until(heard, "the clock is not heard")

    def give_map(self, grid=None):
        self.map_publisher.publish(grid or self.recording.map)

    def use_map(self, grid=None):
        """Gives a map and waits until it is in use."""
        fields = len(self.fields.messages)
        self.give_map(grid)
        self.fields.wait(fields + 1)

    def send(self, scan):
        self.scan.publish(scan)
        self.sent += 1

    def odometry_of_next(self):
        """The transforms since the scan before, up to the next one."""
        before = self.recording.scans[self.next - 1].header.stamp if self.next > 0 else rospy.Time(0)
        stamp = self.recording.scans[self.next].header.stamp
        return TFMessage([t for t in self.recording.transforms if before < t.header.stamp <= stamp])

    def feed(self, count, change=None, with_tf=True):
        """The next scans of the run with their odometry, `change` applied to a copy of each."""
        for _ in range(count):
            scan = self.recording.scans[self.next]
            stamp = scan.header.stamp
            if with_tf:
                Rig.tf.publish(self.odometry_of_next())
            self.set_clock(stamp.to_sec())
            if change:
                scan = copy.deepcopy(scan)
                change(scan)
            self.send(scan)
            self.next += 1
        self.settle(tick=0.0 if with_tf else 0.02)

    def feed_until_converged(self):
        while self.next + 10 <= len(self.recording.scans):
            self.feed(10)
            if self.status.messages and self.status.messages[-1].converged:
                return
        raise AssertionError("the run ended before the robot was found")

    def settle(self, tick=0.0):
        """Waits until every scan sent has been used or dropped; the clock goes on by `tick` meanwhile."""
        def settled():
            if self.value("scans received") == str(self.sent) and self.value("scans waiting") == "0":
                return True
            if tick:
                self.set_clock(Rig.now + tick)
            return False
        wait_until(settled, lambda: f"sent {self.sent}, " + str(self.values()))
        take_in([self.poses, self.status, self.observations, self.fields, self.tf_seen])

    # What comes out.

    def diagnosis(self):
        return newest_status(self.diagnostics_seen, lambda name: name.startswith(self.node[1:] + ":"))

    def fresh_diagnosis(self):
        """One that was filled after this call."""
        seen = len(self.diagnostics_seen.messages)
        wait_until(lambda: len(self.diagnostics_seen.messages) > seen + 1, "no diagnostics")
        return self.diagnosis()

    def values(self):
        return values_of(self.diagnosis())

    def value(self, key):
        return self.values().get(key)

    def wait_value(self, key, value):
        wait_until(lambda: self.value(key) == str(value), lambda: f"{key} = {value}, it is {self.value(key)}")

    def odom_in_map(self):
        """Everything that tf was told about map -> odom, as (stamp, pose)."""
        return [(t.header.stamp.to_sec(), (t.transform.translation.x, t.transform.translation.y,
                                          2 * math.atan2(t.transform.rotation.z, t.transform.rotation.w)))
                for m in self.tf_seen.messages for t in m.transforms
                if t.header.frame_id == "map" and t.child_frame_id == "odom"]

    def error(self, truth=None):
        """Distance [m] and angle [deg] of the last pose from the truth."""
        pose = self.poses.messages[-1]
        x, y, theta = planar(pose.pose.pose)
        tx, ty, ttheta = truth or self.recording.truth_at(pose.header.stamp.to_sec())
        return math.hypot(x - tx, y - ty), math.degrees(angle_between(theta, ttheta))


class RigCase(unittest.TestCase):
    """A test whose rigs are fed with one recording."""

    @classmethod
    def setUpClass(cls):
        cls.run_ = Recording()

    def rig(self, kind="Localization", **params):
        rig = Rig(self._testMethodName, self.run_, kind, **params)
        self.addCleanup(rig.close)
        return rig
