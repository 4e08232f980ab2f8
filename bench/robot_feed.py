"""A robot for hours, from one recorded round: time and odometry go on from round to round, and the whole stack listens.
No program; bench/load and bench/soak_stack import it."""
import math
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from planar import compose, inverse, moved, planar  # noqa: E402, F401 (for the benches)

PREFIX = pathlib.Path(os.environ.get("HYSELAM_PREFIX", ROOT / "devel"))
PICTURES = ("/camera/color/image_raw", "/camera/depth/image_raw", "/camera/color/camera_info", "/camera/depth/camera_info")


def enter_workspace():
    """Begins the program anew with the workspace's environment if that is not around it; ends it if there is none."""
    entered = "HYSELAM_ENTERED"  # the environment may name the workspace by another path than this
    if str(PREFIX) in os.environ.get("CMAKE_PREFIX_PATH", "").split(":") or os.environ.get(entered) == str(PREFIX):
        return
    if not (PREFIX / "env.sh").exists():
        print(f"error: {PREFIX} is missing: run 'make build'", file=sys.stderr)
        sys.exit(2)
    os.execve(PREFIX / "env.sh", ["env.sh", sys.executable, *sys.argv], {**os.environ, entered: str(PREFIX)})


def say(text):
    print(text, file=sys.stderr, flush=True)


def tool(package, name, *args):
    """Runs one program of the workspace; ends with its last line if it fails."""
    done = subprocess.run([PREFIX / "lib" / package / name, *map(str, args)], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"error: {name}: {(done.stderr.strip().splitlines() or [done.returncode])[-1]}")


def prepare(folder, pictures_per_second, size, scan_rate=10, seed=1, route="office", plan="office"):
    """Bag and map of a round through the office with pictures, and a model of what its places look like; kept in the
    folder for the next time."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "model" / "model.json").exists() or not (folder / "round.bag").exists():
        say("drives a round and films it")
        drive, width, height = folder / "drive.bag", *size
        tool("hyselam_sim", "simulate", "--plan", plan, "--route", route, "--seed", seed, "--scan-rate", scan_rate,
             "--odometry-rate", max(20, scan_rate), "--out", drive, "--map", folder / "map.yaml", "--resolution", 0.05)
        tool("hyselam_sim", "film", "--bag", drive, "--plan", plan, "--route", route, "--rate", pictures_per_second, "--width",
             width, "--height", height, "--images", folder / "pictures", "--out", folder / "round.bag")
        tool("selovis", "train", "--labels", folder / "pictures" / "labels.csv", "--descriptor", "GLANCE+scan", "--kernel",
             "exemplar", "--out", folder / "model")
    return folder


class Round:
    """What a bag holds, ready to be sent again: messages as bytes, the stamp in their header to be replaced."""

    def __init__(self, bag_path):
        import rosbag
        self.events = []  # (time since the start, topic, bytes or pose of the robot: /tf in odom, /ground_truth in the plan)
        self.static, truth = [], []
        begin = None
        with rosbag.Bag(str(bag_path)) as bag:
            wanted = ["/scan", "/tf", "/tf_static", "/ground_truth", *PICTURES]
            for topic, (_, data, _, _, kind), stamp in bag.read_messages(topics=wanted, raw=True):
                begin = stamp.to_sec() if begin is None else begin
                if topic == "/tf":
                    pose = self._odometry(kind().deserialize(data))
                    if pose:
                        self.events.append((stamp.to_sec() - begin, topic, pose))
                elif topic == "/tf_static":
                    self.static += kind().deserialize(data).transforms
                elif topic == "/ground_truth":
                    truth.append(planar(kind().deserialize(data).pose.pose))
                    self.events.append((stamp.to_sec() - begin, topic, truth[-1]))
                else:
                    self.events.append((stamp.to_sec() - begin, topic, bytearray(data)))
        # Odometry and truth before the scan of the same time, as on a robot.
        self.events.sort(key=lambda e: (round(e[0], 6), e[1] not in ("/tf", "/ground_truth")))
        poses = [e[2] for e in self.events if e[1] == "/tf"]
        self.duration = self.events[-1][0] + 0.05
        self.start = truth[0]
        # The frame of the odometry in the plan, as it is at both ends.
        self.odom_in_plan = [compose(t, inverse(p)) for t, p in ((truth[0], poses[0]), (truth[-1], poses[-1]))]

    @staticmethod
    def _odometry(msg):
        for t in msg.transforms:
            if t.child_frame_id.lstrip("/") == "base_link":
                return moved(t.transform.translation, t.transform.rotation)
        return None


def forever(rounds, begin=1.0):
    """(stamp, topic, bytes or pose) of one round after the other, again and again. From the end of one to the start of the
    next, the odometry tells what the robot does in truth."""
    offset, number = (0.0, 0.0, 0.0), 0
    while True:
        this, number = rounds[number % len(rounds)], number + 1
        for after, topic, what in this.events:
            yield begin + after, topic, compose(offset, what) if topic == "/tf" else what
        begin += this.duration
        offset = compose(offset, compose(inverse(this.odom_in_plan[1]), rounds[number % len(rounds)].odom_in_plan[0]))


def dated(data, stamp):
    """The message with another stamp: a header is 4 bytes of seq, then seconds and nanoseconds."""
    struct.pack_into("<II", data, 4, int(stamp), min(999999999, int(round((stamp - int(stamp)) * 1e9))))
    return data


class Raw:
    """Publishes messages that are bytes already."""

    def __init__(self, topic, kind, queue):
        import rospy

        class Bytes(kind):
            __slots__ = ["data_"]
            _has_header = False  # rospy would number it

            def __init__(self, data=b""):
                self.data_ = data

            def serialize(self, buff):
                buff.write(self.data_)

        Bytes._type, Bytes._md5sum, Bytes._full_text = kind._type, kind._md5sum, kind._full_text
        self.kind = Bytes
        self.publisher = rospy.Publisher(topic, Bytes, queue_size=queue)

    def send(self, data):
        self.publisher.publish(self.kind(bytes(data)))


def text(word):
    return struct.pack("<I", len(word)) + word


def odometry_message(pose, stamp):
    """odom -> base_link as the bytes of a tf2_msgs/TFMessage."""
    seconds = int(stamp)
    return (struct.pack("<IIII", 1, 0, seconds, min(999999999, int(round((stamp - seconds) * 1e9)))) + text(b"odom") +
            text(b"base_link") + struct.pack("<7d", pose[0], pose[1], 0.0, 0.0, 0.0, math.sin(pose[2] / 2), math.cos(pose[2] / 2)))


class Stack:
    """hyselam.launch, once or more, with a master of its own."""

    def __init__(self, folder):
        with socket.socket() as s:
            s.bind(("localhost", 0))
            self.port = s.getsockname()[1]
        self.folder = folder
        os.environ.update(ROS_MASTER_URI=f"http://localhost:{self.port}", ROS_HOSTNAME="localhost",
                          ROS_HOME=str(folder / "ros_home"))

    @staticmethod
    def include(arguments):
        inner = "".join(Stack.setting("arg", name, value) for name, value in arguments.items())
        return f'<include file="$(find hyselam_bringup)/launch/hyselam.launch">{inner}</include>'

    @staticmethod
    def setting(kind, name, value):
        return f'<{kind} name="{name}" value="{str(value).lower() if isinstance(value, bool) else value}"/>'

    def launch(self, *lines):
        path = self.folder / "stack.launch"
        path.write_text("<launch>\n" + "\n".join(lines) + "\n</launch>\n")
        self.log = open(self.folder / "stack.log", "w")
        self.process = subprocess.Popen(["roslaunch", "-p", str(self.port), str(path)], stdout=self.log,
                                        stderr=subprocess.STDOUT, start_new_session=True)

    def pid(self, node="/hyselam_manager", patience=60.0):
        """Of the process in which a node runs."""
        import rosgraph
        import xmlrpc.client
        deadline = time.monotonic() + patience
        while True:
            try:
                return xmlrpc.client.ServerProxy(rosgraph.Master("/bench").lookupNode(node)).getPid("/bench")[2]
            except (rosgraph.MasterException, OSError):
                if time.monotonic() > deadline:
                    sys.exit(f"error: {node} does not start: see {self.log.name}")
                time.sleep(0.2)

    def close(self):
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.terminate()
            self.process.wait()
        self.log.close()


class Diagnoses:
    """The newest diagnosis of each layer."""

    def __init__(self):
        import rospy
        from diagnostic_msgs.msg import DiagnosticArray
        self.of, self.log = {}, []
        self.subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self.hear, queue_size=200)

    def hear(self, array):
        for status in array.status:
            values = {v.key: v.value for v in status.values}
            self.of[status.name.split(":")[0]] = {"level": status.level, "message": status.message, **values}

    def number(self, layer, key):
        try:
            return float(self.of[layer][key])
        except (KeyError, ValueError):
            return None


def percentile(values, share):
    """The value that `share` of them do not exceed; None of none."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else None


def resident_mb(pid):
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmRSS"))


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
