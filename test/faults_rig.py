"""The whole stack as on robots, in processes that a test may kill: launch files started by hand on the test's master, a
simulated run with pictures fed message by message, and what each layer says of itself. No test; faults*_test.py use it."""
import copy
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import xmlrpc.client

import rosbag
import rosgraph
import roslaunch.config
import rospkg
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, PointStamped, PoseWithCovarianceStamped, Quaternion, Transform, Vector3
from hyselam_msgs.msg import AugmentedTopologicalMap
from hyselam_msgs.srv import NamePlace
from nav_msgs.srv import GetMap
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import CameraInfo, Image, LaserScan
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

sys.dont_write_bytecode = True
from localization_rig import WAIT, Listener, Recording, compose, inverse, planar, wait_until

KNOWN, NEW = "known", "new"  # the robots: one with a map and a camera, one that makes its map

PICTURES = {"color/image_raw": Image, "depth/image_raw": Image, "color/camera_info": CameraInfo,
            "depth/camera_info": CameraInfo}
# What a layer counts when it has used its input: name of the node, value of its diagnostics.
WORK = {"slam": "scans used", "localization": "scans used", "fsd": "scans used", "words_fsd": "scans used",
        "words": "observations received", "semantic_localization": "images used", "object_engine": "frames used"}


def program(package, name):
    return find_node(package, name)[0]


def run(*command, **environment):
    """A tool of the stack: its exit status and all that it said."""
    done = subprocess.run(list(command), env=dict(os.environ, **environment), stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)
    return done.returncode, done.stdout


class FilmedRun(Recording):
    """A run with what a camera sees, twice a second, and a model of what its places look like."""

    def __init__(self, route="small"):
        super().__init__(route)
        film, pictures = os.path.join(self.folder.name, "film.bag"), os.path.join(self.folder.name, "pictures")
        self.model = os.path.join(self.folder.name, "model")
        for command in (["hyselam_sim", "film", "--bag", self.bag, "--route", route, "--rate", "2", "--width", "160",
                         "--height", "120", "--out", film, "--images", pictures],
                        ["selovis", "train", "--labels", os.path.join(pictures, "labels.csv"), "--descriptor", "GLANCE+scan",
                         "--kernel", "exemplar", "--out", self.model]):
            subprocess.run([program(*command[:2])] + command[2:], check=True, stdout=subprocess.DEVNULL)
        self.pictures = {}  # stamp: {topic: message}
        with rosbag.Bag(film) as bag:
            for topic, msg, _ in bag.read_messages(["/tf_static"] + ["/camera/" + p for p in PICTURES]):
                if topic == "/tf_static":
                    self.static = msg.transforms  # with the camera's
                    continue
                self.pictures.setdefault(msg.header.stamp, {})[topic[len("/camera/"):]] = msg


class Stack:
    """Robots in namespaces: a nodelet manager each, as hyselam.launch loads it."""

    def __init__(self, robots):
        """robots: {name: arguments of hyselam.launch}."""
        self.managers, self.nodes = {}, {}
        file = os.path.join(rospkg.RosPack().get_path("hyselam_bringup"), "launch", "hyselam.launch")
        self.robots = [(robot, [file] + [f"{key}:={value}" for key, value in arguments.items()])
                       for robot, arguments in robots.items()]

    def start_all(self):
        for robot, command in self.robots:
            self.start(robot, command)

    def start(self, robot, command):
        """As a user does in the robot's namespace, but for the manager, which the test wants to hold."""
        self.start_manager(robot)
        config = roslaunch.config.load_config_default([(command[0], command[1:] + ["start_manager:=false"])], None,
                                                      verbose=False)
        for key, param in config.params.items():
            rospy.set_param(f"/{robot}{key}", param.value)
        for node in config.nodes:
            self.nodes[robot, node.name] = node
            rospy.set_param(f"/{robot}/{node.name}/diagnostic_period", 0.1)
            self.load(robot, node.name)

    def start_manager(self, robot):
        rospy.set_param(f"/{robot}/hyselam_manager/num_worker_threads", 8)  # as hyselam.launch does
        # Ignored, the signal leaves a write to a full disk with an error, as a full disk does.
        quiet = lambda: signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        self.managers[robot] = subprocess.Popen(
            [program("nodelet", "nodelet"), "manager", "__name:=hyselam_manager", f"__ns:=/{robot}"],
            preexec_fn=quiet, restore_signals=False)
        rospy.wait_for_service(f"/{robot}/hyselam_manager/load_nodelet", WAIT)

    def load(self, robot, name):
        node = self.nodes[robot, name]
        source, target = [], []
        for a, b in node.remap_args:
            source.append(f"/{robot}/{a}")
            target.append(b if b.startswith("/") else f"/{robot}/{b}")
        kind = node.args.split()[1]
        answer = rospy.ServiceProxy(f"/{robot}/hyselam_manager/load_nodelet", NodeletLoad)(
            f"/{robot}/{name}", kind, source, target, [], "")
        if not answer.success:
            raise AssertionError(f"{robot}: {name} is not loaded")

    def unload(self, robot, name):
        answer = rospy.ServiceProxy(f"/{robot}/hyselam_manager/unload_nodelet", NodeletUnload)(f"/{robot}/{name}")
        if not answer.success:
            raise AssertionError(f"{robot}: {name} is not unloaded")

    def layers(self, robot):
        return [name for (of, name) in self.nodes if of == robot]

    def kill(self, robot):
        """What the out-of-memory killer does."""
        self.managers[robot].kill()
        self.managers[robot].wait()

    def restart(self, robot):
        self.start_manager(robot)
        for name in self.layers(robot):
            self.load(robot, name)

    def alive(self, robot):
        return self.managers[robot].poll() is None

    def limit_files(self, robot, size=None):
        """No file of this manager grows beyond the size from now on; None: all may."""
        _, hard = resource.prlimit(self.managers[robot].pid, resource.RLIMIT_FSIZE)
        resource.prlimit(self.managers[robot].pid, resource.RLIMIT_FSIZE, (hard if size is None else size, hard))

    def close(self):
        for manager in self.managers.values():
            manager.terminate()
        for manager in self.managers.values():
            try:
                manager.wait(30)
            except subprocess.TimeoutExpired:
                manager.kill()
                manager.wait()


class Driver:
    """Feeds one clock and all robots with the same run, in frames of their own."""

    def __init__(self, recording, robots):
        self.recording, self.robots = recording, robots
        self.clock = rospy.Publisher("/clock", Clock, queue_size=1000)
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=10000)
        self.static = rospy.Publisher("/tf_static", TFMessage, queue_size=10, latch=True)
        self.scan = {r: rospy.Publisher(f"/{r}/scan", LaserScan, queue_size=10000) for r in robots}
        self.picture = {r: {t: rospy.Publisher(f"/{r}/camera/{t}", kind, queue_size=1000) for t, kind in PICTURES.items()}
                        for r in robots}
        self.heard = {}  # node: [diagnoses]
        self.diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, self.hear, queue_size=1000)
        self.next, self.shift = 0, 0.0  # scan to feed; seconds added to all stamps
        self.offset = (0.0, 0.0, 0.0)  # odometry of the rounds before
        last = [self.pose(t) for t in recording.transforms if t.child_frame_id == "base_link"]
        # From the end of a round to the next start the odometry tells what the robot does in truth.
        leap = compose(inverse(recording.truth[-1][1]), recording.truth[0][1])
        self.lap = compose(last[-1], compose(leap, inverse(last[0])))
        self.now = recording.scans[0].header.stamp.to_sec() - 0.5
        self.static.publish(TFMessage([self.framed(t, r) for r in robots for t in recording.static]))
        threading.Thread(target=self.keep_time, daemon=True).start()

    def keep_time(self):
        """Who starts or waits hears the time, though it stands still."""
        while not rospy.is_shutdown():
            self.tick()
            time.sleep(0.1)

    def hear(self, array):
        for status in array.status:
            self.heard[status.name.split(":")[0]] = (time.monotonic(), status)

    # ---- What goes in.

    def framed(self, msg, robot):
        """A copy in the robot's frames, at the time of this round."""
        msg = copy.copy(msg)
        msg.header = copy.copy(msg.header)
        msg.header.frame_id = f"{robot}/{msg.header.frame_id}"
        msg.header.stamp = rospy.Time.from_sec(msg.header.stamp.to_sec() + self.shift)
        if hasattr(msg, "child_frame_id"):
            if msg.child_frame_id == "base_link":
                x, y, theta = compose(self.offset, self.pose(msg))
                msg.transform = Transform(Vector3(x, y, 0.0), Quaternion(0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2)))
            msg.child_frame_id = f"{robot}/{msg.child_frame_id}"
        return msg

    @staticmethod
    def pose(msg):
        q, p = msg.transform.rotation, msg.transform.translation
        return p.x, p.y, 2 * math.atan2(q.z, q.w)

    def tick(self, seconds=0.0):
        """Lets the clock go on."""
        self.now += seconds
        self.clock.publish(Clock(rospy.Time.from_sec(self.now)))

    def rewind(self, shift=None):
        """To the start of the run; the stamps as before (a bag looped) or shifted."""
        self.next, self.shift = 0, self.shift if shift is None else shift
        self.offset = (0.0, 0.0, 0.0)
        self.now = self.recording.scans[0].header.stamp.to_sec() + self.shift - 0.5
        self.tick()

    def feed(self, count, tf=True, scans=True, pictures=True, change=None):
        """So many more scans with odometry and pictures, round after round."""
        for _ in range(count):
            if self.next >= len(self.recording.scans):
                self.go_round()
            before = self.recording.scans[self.next - 1].header.stamp if self.next > 0 else rospy.Time(0)
            scan = self.recording.scans[self.next]
            stamp = scan.header.stamp
            if tf:
                self.tf.publish(TFMessage([self.framed(t, r) for r in self.robots for t in self.recording.transforms
                                           if before < t.header.stamp <= stamp]))
            self.now = stamp.to_sec() + self.shift
            self.tick()
            if change:
                scan = change(scan)
            for robot in self.robots:
                if scans:
                    self.scan[robot].publish(self.framed(scan, robot))
                for at, messages in self.recording.pictures.items() if pictures else ():
                    if before < at <= stamp:
                        self.send_pictures(robot, messages)
            self.next += 1
            time.sleep(0.02)

    def send_pictures(self, robot, messages):
        for topic in sorted(messages, key=lambda t: t.endswith("image_raw")):
            self.picture[robot][topic].publish(self.framed(messages[topic], robot))

    def go_round(self):
        """The run once more, later."""
        self.shift += self.recording.scans[-1].header.stamp.to_sec() - self.recording.scans[0].header.stamp.to_sec() + 0.1
        self.offset = compose(self.offset, self.lap)
        self.next = 0

    # ---- What comes out.

    def diagnosis(self, robot, layer):
        heard = self.heard.get(f"{robot}/{layer}")
        return heard[1] if heard else None

    def fresh(self, robot, layer):
        """A diagnosis that was filled after this call."""
        begin = time.monotonic() + 0.15
        wait_until(lambda: self.heard.get(f"{robot}/{layer}", (0, None))[0] > begin, f"no diagnostics of {robot}/{layer}")
        return self.diagnosis(robot, layer)

    def value(self, robot, layer, key):
        status = self.diagnosis(robot, layer)
        return next((v.value for v in status.values if v.key == key), None) if status else None

    def count(self, robot, layer, key):
        return int(float(self.value(robot, layer, key) or 0))

    def work(self, robot, layers):
        """Feeds until each of the layers has used more of its input."""
        layers = [name for name in layers if name in WORK]
        for name in layers:
            self.fresh(robot, name)
        before = {name: self.count(robot, name, WORK[name]) for name in layers}
        idle = set(layers)

        def working():
            self.feed(5)
            for name in list(idle):
                if self.count(robot, name, WORK[name]) > before[name]:
                    idle.discard(name)
            return not idle
        wait_until(working, lambda: f"{robot}: {sorted(idle)} do not work: " +
                   " | ".join(str(self.diagnosis(robot, n) and self.diagnosis(robot, n).message) for n in idle))

    def says(self, robot, layer, *words, while_doing=lambda: None):
        """Waits for a diagnosis whose message or values hold all the words."""
        def said():
            while_doing()
            status = self.diagnosis(robot, layer)
            if not status:
                return False
            told = " ".join([status.message] + [f"{v.key} {v.value}" for v in status.values])
            return all(w in told for w in words)
        wait_until(said, lambda: f"{robot}/{layer} to say {words}; it says {self.diagnosis(robot, layer)}")


class LaunchedStack(Stack):
    """The same robots, all of them started by roslaunch as on a robot: what comes back comes back by itself."""

    def start(self, robot, command):
        config = roslaunch.config.load_config_default([(command[0], command[1:])], None, verbose=False)
        for node in config.nodes:
            if node.type == "nodelet" and node.args != "manager":
                self.nodes[robot, node.name] = node
                rospy.set_param(f"/{robot}/{node.name}/diagnostic_period", 0.1)
        self.managers[robot] = subprocess.Popen(["roslaunch", *command], env=dict(os.environ, ROS_NAMESPACE=robot))
        # One robot after the other, and no test of how fast: many programs start at once.
        rospy.wait_for_service(f"/{robot}/hyselam_manager/list", WAIT)
        for name in self.layers(robot):
            wait_until(lambda: f"/{robot}/{name}" in self.loaded(robot), f"{robot}: {name} is not loaded")

    def kill(self, robot):
        os.kill(self.process_of(f"/{robot}/hyselam_manager"), signal.SIGKILL)

    @staticmethod
    def loaded(robot):
        return rospy.ServiceProxy(f"/{robot}/hyselam_manager/list", NodeletList)().nodelets

    @staticmethod
    def process_of(node):
        return xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode(node)).getPid("/test")[2]


class TwoRobots(unittest.TestCase):
    """Robots that work and what tells whether they do; the tests derive from it."""
    stack_kind = Stack

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.recording = FilmedRun()
        for robot in (KNOWN, NEW):
            os.makedirs(cls.path(robot))
        frames = lambda robot: {"odom_frame": f"{robot}/odom", "base_frame": f"{robot}/base_link", "work_dir": cls.path(robot)}
        x, y, yaw = cls.recording.truth[0][1]
        for axis, value in zip("xya", (x, y, yaw)):
            rospy.set_param(f"/{KNOWN}/localization/initial_pose_{axis}", value)
        cls.robots = Driver(cls.recording, [KNOWN, NEW])
        cls.log = Listener("/rosout", Log)
        cls.poses = Listener(f"/{KNOWN}/amcl_pose", PoseWithCovarianceStamped)
        cls.names = Listener(f"/{KNOWN}/named_map", AugmentedTopologicalMap)
        cls.stack = cls.stack_kind({
            KNOWN: {"map": cls.recording.yaml, "pose": "localization", "vision": "true", "objects": "true",
                    "model": cls.recording.model, "save_model": cls.path(KNOWN, "model"), **frames(KNOWN)},
            NEW: {"pose": "slam", "map_frame": f"{NEW}/map", **frames(NEW)}})
        cls.addClassCleanup(cls.stack.close)
        cls.stack.start_all()
        cls.saved = cls.path("saved")
        robots = cls.robots
        robots.work(KNOWN, cls.stack.layers(KNOWN))
        robots.work(NEW, cls.stack.layers(NEW))

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.folder.name, *names)

    def call(self, robot, service, kind, *args):
        name = f"/{robot}/{service}"
        rospy.wait_for_service(name, WAIT)
        return rospy.ServiceProxy(name, kind)(*args)

    def name(self, word):
        """Names the left room; the names of the map afterwards."""
        wait_until(lambda: self.names.messages and self.names.messages[-1].places, "no places with names")
        point = PointStamped(Header(frame_id="map"), Point(1.5, 2.0, 0.0))
        answer = self.call(KNOWN, "name_place", NamePlace, 0, point, [word])
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: word in self.words(), lambda: f"{word}; there are {self.words()}")
        return self.words()

    def words(self):
        return {w.text for p in self.names.messages[-1].places for w in p.words} if self.names.messages else set()

    def works(self):
        """All layers of both robots have something to do and do it, and the known robot is where it thinks."""
        self.robots.work(KNOWN, self.stack.layers(KNOWN))
        self.robots.work(NEW, self.stack.layers(NEW))
        self.right_pose()

    def right_pose(self):
        seen = len(self.poses.messages)

        def right():
            self.robots.feed(5)
            if len(self.poses.messages) == seen:
                return False
            pose = self.poses.messages[-1]
            at = pose.header.stamp.to_sec() - self.robots.shift
            (x, y, _), (tx, ty, _) = planar(pose.pose.pose), self.recording.truth_at(at)
            self.error = abs(x - tx) + abs(y - ty)
            return self.error < 0.3
        wait_until(right, lambda: f"the right pose; error {getattr(self, 'error', None)}, " +
                   str(self.robots.diagnosis(KNOWN, "localization").message))

    def comes_back(self, robot, layer):
        """What a layer without a count of its input gives again."""
        if layer == "map_server":
            self.assertGreater(len(self.call(robot, "static_map", GetMap).map.data), 0)
        elif layer == "gr2to":
            self.robots.says(robot, "gr2to", "places", while_doing=lambda: self.robots.feed(2))
            self.assertGreater(len(rospy.wait_for_message(f"/{robot}/topological_map", AugmentedTopologicalMap, WAIT).places), 0)
        elif layer == "topo_engine":
            map = rospy.wait_for_message(f"/{robot}/named_map", AugmentedTopologicalMap, WAIT)
            if robot == KNOWN:
                wait_until(lambda: "Kitchen" in self.words(), lambda: f"the name; there are {self.words()}")
            self.assertGreater(len(map.places), 0)
        else:
            self.robots.work(robot, [layer])
