"""The robot as the server sees it: its topics and services in ROS."""
import asyncio
import collections
import concurrent.futures
import json
import math
import os
import subprocess
import tempfile
import threading
import time

import numpy as np
import rosgraph
import rospy
from actionlib_msgs.msg import GoalID
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from hyselam_msgs.msg import AugmentedTopologicalMap, LocalizationStatus, ObjectMap, PlaceState, VisualPlace, WallArray
from hyselam_msgs.srv import AddGlassWall, AddGlassWallRequest, NamePlace, NamePlaceRequest, TellRobot, UseLanguage, WordToPose
from nav_msgs.msg import OccupancyGrid, Path
from rospy.impl.registration import Registration, get_registration_listeners, get_topic_manager
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

from . import inbox, open_ends, sentences, sights
from .requests import Refused
from .tiles import MapTiles
from .transforms import TransformTree, planar
from .world import World

MASTER_PERIOD = 2.0  # [s] between two looks whether the master knows this node
SERVICE_WAIT = 1.0  # [s] for a service to be there
ANSWER_WAIT = 30.0  # [s] for its answer
PROGRAM_WAIT = 60.0  # [s] for doctor and knowledge
STILL = 1.0  # [s] between two scans of a robot that stands
OBJECT_WAIT = 3.0  # [s] for an answer about objects, unless the dialogue was told otherwise


class Latest:
    """The bytes of the newest message of a topic; a message is made of them when somebody wants to look at it."""

    def __init__(self, topic, kind, big=False):
        self.topic, self.kind, self.wrong = topic, kind, None
        self._newest = inbox.Newest()
        more = {"buff_size": 1 << 20} if big else {}
        self.subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._take, queue_size=1, **more)

    def _take(self, msg):
        kind = msg._connection_header.get("type")
        if kind != self.kind._type:
            if self.wrong != kind:
                rospy.logwarn("%s is a %s, not a %s: it is not shown", self.topic, kind, self.kind._type)
            self.wrong = kind
            return
        self._newest.put(msg._buff)

    def is_new(self):
        return self._newest.is_new()

    def bytes(self):
        """None: there is nothing new."""
        return self._newest.take()

    def message(self):
        """None: there is nothing new, or it cannot be read."""
        data = self.bytes()
        if data is None:
            return None
        try:
            return self.kind().deserialize_numpy(data, np)
        except Exception as error:  # genpy raises what struct, numpy and its own checks do
            rospy.logwarn_throttle(10, "%s: a message cannot be read: %s" % (self.topic, error))
            return None


class Robot:
    def __init__(self, params):
        self.params = params  # map_frame, base_frame, knowledge
        self.world, self.tiles = World(), MapTiles()
        self.transforms, self._lock = TransformTree(), threading.Lock()
        self._threads = concurrent.futures.ThreadPoolExecutor(max_workers=6)
        # What takes long never keeps a sentence waiting, nor the map.
        self._speaker, self._mapper = (concurrent.futures.ThreadPoolExecutor(max_workers=1) for _ in range(2))
        self._pending = 0
        self._sentences = sentences.Sentences(self._tell, self._publish_stop, lambda: self._ways + self._followed, lambda: self._forwarded, lambda: self._patience)
        self._talk, self._diagnostics, self._statuses = collections.deque(maxlen=1000), collections.deque(maxlen=1000), inbox.Statuses()
        self._ways = self._followed = 0
        self._forwarded, self._patience, self._goal = 0, OBJECT_WAIT, b""
        self._preparing = self._scan_shown = self._doctor = None
        self._following, self._reached = False, True
        self._question, self._arrival = open_ends.OpenQuestion(), open_ends.Arrival()
        self._times = {}
        self._spoken = 0
        self.topics = {name: Latest(name, kind, big) for name, kind, big in (
            ("map", OccupancyGrid, True), ("scan", LaserScan, False), ("particlecloud", PoseArray, False), ("amcl_pose", PoseWithCovarianceStamped, False),
            ("localization_status", LocalizationStatus, False), ("named_map", AugmentedTopologicalMap, True), ("place", PlaceState, False),
            ("goal_path", Path, False), ("object_map", ObjectMap, False), ("visual_place", VisualPlace, False), ("known_names", String, False),
            ("name_candidates", String, False), ("open_question", String, False), ("next_undo", String, False), ("halted_goal", String, False),
            ("told_walls", WallArray, False))}
        rospy.Subscriber("/tf", rospy.AnyMsg, self._on_tf, queue_size=200)
        rospy.Subscriber("/tf_static", rospy.AnyMsg, self._on_tf, queue_size=200)
        rospy.Subscriber("conversation", String, self._on_talk, queue_size=200)
        rospy.Subscriber("goal_path", rospy.AnyMsg, self._on_way, queue_size=20)
        rospy.Subscriber("follow_person", Bool, self._on_follow, queue_size=20)
        rospy.Subscriber("object_request", rospy.AnyMsg, self._on_forwarded, queue_size=20)
        rospy.Subscriber("/diagnostics", rospy.AnyMsg, self._on_diagnostics, queue_size=100)
        self._human = rospy.Publisher("human_text", String, queue_size=20)
        self._cancel = rospy.Publisher("move_base/cancel", GoalID, queue_size=5)
        self._initial = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=5)
        self.world.set("can", {"save": bool(params.get("knowledge"))})
        threading.Thread(target=self._watch_master, daemon=True).start()

    # ---- What comes, in rospy's threads ----

    def _on_tf(self, msg):
        with self._lock:
            try:
                self.transforms.add_message(msg._buff)
            except ValueError as error:
                rospy.logwarn_throttle(10, "/tf: %s" % error)

    def _on_talk(self, msg):
        self._talk.append((time.time(), msg.data))

    def _on_way(self, msg):
        # Header (12 bytes, its frame), then the number of poses.
        frame = int.from_bytes(msg._buff[12:16], "little")
        going = msg._buff[16 + frame:20 + frame] not in (b"", b"\0\0\0\0")
        goal = msg._buff[-56:-40] if going else b""  # x and y of the last pose; the same: another way to where it goes anyway
        self._ways += going and goal != self._goal
        self._goal = goal

    def _on_follow(self, msg):
        self._followed += bool(msg.data)
        self._following = msg.data

    def _on_forwarded(self, _):
        self._forwarded += 1

    def _on_diagnostics(self, msg):
        self._diagnostics.append((time.monotonic(), msg._buff))

    # ---- What pages are shown, in the server's loop ----

    def now(self):
        return rospy.get_time()

    def _due(self, what, period):
        now = time.monotonic()
        if now - self._times.get(what, -1e9) < period:
            return False
        self._times[what] = now
        return True

    def collect(self):
        world = self.world
        world.set("reach", {"master": self._reached})
        self._collect_pose()
        if self._due("places", 0.4):
            self._collect_places()
        if self._due("slowly", 1.0):
            self._collect_particles()
            self._collect_diagnostics()
        way = self.topics["goal_path"].message()
        if way is not None:
            world.set("way", sights.way(way))
            world.set("arrived", None)
            self._arrival.sets_out()
        self._collect_arrival()
        world.set("following", self._following)
        place = self.topics["place"].message()
        if place is not None:
            world.set("here", sights.here(place))
        names = self.topics["known_names"].message()
        if names is not None:
            world.set("names", [n[:sights.MAX_LABEL] for n in names.data.splitlines()[:1000] if n])
        candidates = self.topics["name_candidates"].message()
        if candidates is not None:
            world.set("candidates", sights.candidates(candidates.data))
        status = self.topics["localization_status"].message()
        if status is not None:
            world.set("status", sights.status(status))
        for topic, name in (("next_undo", "undo"), ("halted_goal", "halted")):
            text = self.topics[topic].message()
            if text is not None:
                world.set(name, text.data[:500])
        self._collect_talk()
        if self._preparing is None and self.topics["map"].is_new():
            data = self.topics["map"].bytes()
            if data is not None:
                self._preparing = asyncio.ensure_future(self._take_map(data))

    async def _take_map(self, data):
        def prepare():
            msg = OccupancyGrid().deserialize_numpy(data, np)
            q = msg.info.origin.orientation
            return self.tiles.prepare(msg.info.width, msg.info.height, float(np.float32(msg.info.resolution).astype(float).round(7)),
                                      (msg.info.origin.position.x, msg.info.origin.position.y, sights.yaw_of(q)), np.asarray(msg.data, np.int8).tobytes())
        try:
            prepared = await asyncio.get_event_loop().run_in_executor(self._mapper, prepare)
            self.tiles.commit(prepared, self.world.next_version)
            total = sum(number for number, picture in self.tiles.tiles.values() if picture)
            self.world.set("map", dict(self.tiles.info, sum=total % 2 ** 32))
            self.world.set("refused", None)
        except Exception as error:  # genpy raises what struct and its own checks do
            rospy.logwarn_throttle(10, "the map is not shown: %s" % error)
            self.world.set("refused", f"map: {error}"[:300])
        finally:
            self._preparing = None

    def _collect_pose(self):
        frames, topics = self.params, self.topics
        with self._lock:
            base = self.transforms.lookup(frames["map_frame"], frames["base_frame"])
        if base is not None:
            x, y, yaw = planar(base)
            known = self.world.get("pose")
            # Less than can be seen is no news.
            if not known or math.hypot(known["x"] - x, known["y"] - y) > 0.015 or abs(math.remainder(known["a"] - yaw, 2 * math.pi)) > 0.01:
                value = sights.pose(x, y, yaw)
                if value:
                    self.world.set("pose", value)
        spread = topics["amcl_pose"].message()
        if spread is not None:
            self.world.set("spread", sights.spread(spread))
        if topics["scan"].is_new() and (self._scan_shown != self.world.get("pose") or self._due("scan", STILL)):
            self._scan_shown = self.world.get("pose")
            scan = topics["scan"].message()
            if scan is not None:
                stamp = scan.header.stamp.to_sec()
                with self._lock:
                    laser = self.transforms.lookup(frames["base_frame"], scan.header.frame_id)
                    base = self.transforms.lookup(frames["map_frame"], frames["base_frame"], stamp)
                self.world.set("scan", sights.scan(scan, laser, planar(base)) if base and laser else None)

    def _collect_places(self):
        named = self.topics["named_map"].message()
        if named is not None:
            self.world.set_table("places", sights.places(named))
            self.world.set_table("doors", sights.doors(named))
            self.world.set_table("walls", sights.walls(named))
        walls = self.topics["told_walls"].message()
        if walls is not None:
            self.world.set_table("told", sights.told_walls(walls))
        objects = self.topics["object_map"].message()
        if objects is not None:
            self.world.set_table("objects", sights.objects(objects))
        view = self.topics["visual_place"].message()
        if view is not None:
            self.world.set("camera", sights.camera(view))

    def _collect_particles(self):
        status = self.world.get("status")
        if status is None or status["phase"] == "sure":
            self.world.set("particles", None)
            return
        cloud = self.topics["particlecloud"].message()
        if cloud is not None:
            self.world.set("particles", sights.particles(cloud))

    def _collect_diagnostics(self):
        while self._diagnostics:
            when, data = self._diagnostics.popleft()
            try:
                statuses = DiagnosticArray().deserialize(data).status
            except Exception:  # as in Latest
                continue
            for each in statuses:
                self._statuses.put(each.name, each.level, each.message, when)
        layers = self._statuses.layers(rospy.get_namespace(), time.monotonic())
        if layers:
            self.world.set_table("layers", layers)

    def _collect_arrival(self):
        way, pose = self.world.get("way"), self.world.get("pose")
        if way and pose and self._arrival.is_at_end(way, (pose["x"], pose["y"])):
            self.world.set("way", [])
            self.world.set("arrived", way[-1])

    def _collect_question(self):
        question = self.topics["open_question"].message()
        if question is not None:
            self._question.told(question.data)
        self.world.set("asked", self._question.shown((self.world.get("here") or {}).get("place", 0)))

    def _collect_talk(self):
        while self._talk:
            when, line = self._talk.popleft()
            who, _, text = line.partition(": ")
            if who not in ("human", "robot"):
                continue
            self._spoken += 1
            self.world.append("talk", {"i": self._spoken, "w": who, "s": text[:4000], "t": int(when)})
            self._question.heard(who, text)
        self._collect_question()

    # ---- The master ----

    def _watch_master(self):
        """Nothing in ROS 1 registers again when its master comes back; this does."""
        name, master = rospy.get_name(), rosgraph.Master(rospy.get_name())
        while not rospy.is_shutdown():
            time.sleep(MASTER_PERIOD)
            try:
                known = any(name in nodes for kind in master.getSystemState()[:2] for _, nodes in kind)
                if not known and not rospy.is_shutdown():
                    rospy.logwarn("the master does not know this node: it registers again")
                    self._register()
                self._reached = True
            except Exception:  # sockets, XML-RPC
                self._reached = False

    @staticmethod
    def _register():
        topics, listeners = get_topic_manager(), get_registration_listeners()
        for kind, entries in ((Registration.PUB, topics.get_publications()), (Registration.SUB, topics.get_subscriptions())):
            for topic, of_type in entries:
                listeners.notify_added(topic, of_type, kind)

    # ---- What pages ask for ----

    def stop(self, say=True, language=""):
        """At once: what waits to be said is not said any more. Returns how many hear it."""
        self._sentences.stopped()
        return self._publish_stop(say, language)

    def _publish_stop(self, say=True, language=""):
        """Said to the dialogue, which ends the way, and to a move_base, should nobody else tell it."""
        self._cancel.publish(GoalID())
        if say:
            self._human.publish(String(data=sentences.stop(language)))
        return self._human.get_num_connections() + self._cancel.get_num_connections()

    async def act(self, name, fields, role):
        return await getattr(self, "_do_" + name)(fields, role)

    async def _in_thread(self, call, wait):
        if self._pending >= 16:
            raise Refused("busy", "the robot is busy with what was asked before")
        self._pending += 1
        future = asyncio.get_event_loop().run_in_executor(self._threads, call)
        future.add_done_callback(lambda _: setattr(self, "_pending", self._pending - 1))
        try:
            return await asyncio.wait_for(asyncio.shield(future), wait)
        except asyncio.TimeoutError:
            raise Refused("no_answer", f"no answer within {wait:.0f} s")

    async def _call(self, service, kind, *args):
        def call():
            try:
                rospy.wait_for_service(service, SERVICE_WAIT)
                return rospy.ServiceProxy(service, kind)(*args)
            except rospy.ROSException:
                raise Refused("nobody", f"nobody offers {service}: that part of the robot does not run")
            except rospy.ServiceException as error:
                raise Refused("failed", f"{service}: {error}"[:300])
        return await self._in_thread(call, ANSWER_WAIT)

    async def _tell(self, text, check):
        def call():
            try:
                rospy.wait_for_service("tell_robot", SERVICE_WAIT)
                try:
                    self._patience = float(rospy.get_param("topo_engine/object_answer_timeout", OBJECT_WAIT))
                except (OSError, ValueError, TypeError):
                    pass  # the master is away, or it is no number
                check()
                return list(rospy.ServiceProxy("tell_robot", TellRobot)(text).answers)
            except rospy.ROSException:
                raise Refused("nobody", "nobody offers tell_robot: that part of the robot does not run")
            except rospy.ServiceException as error:
                raise Refused("failed", f"tell_robot: {error}"[:300])
        return await asyncio.get_event_loop().run_in_executor(self._speaker, call)

    async def _do_say(self, fields, role):
        return {"answers": await self._sentences.say(fields["text"], role == "drive")}

    async def _do_go(self, fields, role):
        return await self._do_say({"text": sentences.go_to(self._place(fields["place"]), fields["language"])}, role)

    def _place(self, number):
        place = self.world.item("places", number)
        if place is None:
            raise Refused("unknown", f"there is no place {number}")
        return place

    async def _do_try(self, fields, _):
        answer = await self._call("understands", TellRobot, fields["text"])
        return {"understood": not answer.answers}

    async def _answer_in(self, language):
        """What is done by tapping is answered in the language of the page."""
        if language:
            await self._call("use_language", UseLanguage, language)

    async def _do_name(self, fields, _):
        self._place(fields["place"])
        await self._answer_in(fields.get("language"))
        answer = await self._call("name_place", NamePlace, NamePlaceRequest(place=fields["place"], names=fields["names"]))
        return self._checked(answer)

    @staticmethod
    def _checked(answer):
        if not answer.success:
            raise Refused("failed", answer.message[:300])
        return {"message": answer.message[:300]}

    async def _do_here(self, fields, _):
        place = self._place(fields["place"])
        answer = await self._call("set_initial_place", WordToPose, place["e"])
        if not answer.found:
            raise Refused("failed", answer.message[:300])
        return {}

    async def _do_pose(self, fields, _):
        if self._initial.get_num_connections() == 0:
            raise Refused("nobody", "nobody listens for initialpose: no localization runs")
        msg = PoseWithCovarianceStamped()
        msg.header.stamp, msg.header.frame_id = rospy.Time.now(), self.params["map_frame"]
        msg.pose.pose.position.x, msg.pose.pose.position.y = fields["x"], fields["y"]
        msg.pose.pose.orientation.z, msg.pose.pose.orientation.w = math.sin(fields["yaw"] / 2), math.cos(fields["yaw"] / 2)
        msg.pose.covariance[0] = msg.pose.covariance[7] = 0.25  # as rviz does
        msg.pose.covariance[35] = (math.pi / 12) ** 2
        self._initial.publish(msg)
        return {}

    async def _change_wall(self, service, a, b, is_virtual, language):
        if service == "add_glass_wall" and not 0.2 <= math.dist(a, b) <= 50:
            raise Refused("invalid", "a wall has between 0.2 and 50 m")
        request = AddGlassWallRequest(is_virtual=is_virtual)
        request.a.x, request.a.y, request.b.x, request.b.y = *a, *b
        await self._answer_in(language)
        return self._checked(await self._call(service, AddGlassWall, request))

    async def _do_wall(self, fields, _):
        return await self._change_wall("add_glass_wall", *self._ends(fields), False, fields.get("language"))

    async def _do_unwall(self, fields, _):
        return await self._change_wall("remove_wall", *self._ends(fields), fields["virtual"], fields.get("language"))

    @staticmethod
    def _ends(fields):
        return (fields["ax"], fields["ay"]), (fields["bx"], fields["by"])

    async def _do_shut(self, fields, _):
        door = self.world.item("doors", fields["door"])
        if door is None:
            raise Refused("unknown", f"there is no door {fields['door']}")
        half = door["w"] / 2 + 0.1
        along = (-door["ny"] * half, door["nx"] * half)
        ends = (door["x"] - along[0], door["y"] - along[1]), (door["x"] + along[0], door["y"] + along[1])
        return await self._change_wall("add_glass_wall", *ends, True, fields.get("language"))

    async def _do_learn(self, fields, _):
        answer = await self._call("semantic_localization/" + ("start_learning" if fields["on"] else "stop_learning"), Trigger)
        result = self._checked(answer)
        self.world.set("learning", fields["on"])
        return result

    async def _program(self, *command):
        def call():
            try:
                done = subprocess.run(["rosrun", "hyselam_bringup", *command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      timeout=PROGRAM_WAIT, text=True, errors="replace")
            except (OSError, subprocess.TimeoutExpired) as error:
                raise Refused("failed", f"{command[0]}: {type(error).__name__}")
            return done.returncode, done.stdout.strip()[-2000:]
        return await self._in_thread(call, PROGRAM_WAIT + 5)

    async def _do_save(self, _, __):
        folder = self.params.get("knowledge")
        if not folder:
            raise Refused("nobody", "the server was started without a folder for it: knowledge:=FOLDER")
        code, said = await self._program("knowledge", "save", folder)
        if code != 0:
            raise Refused("failed", said)
        return {"message": said}

    async def _do_doctor(self, _, __):
        """One at a time: who asks meanwhile gets the same findings."""
        if self._doctor is None or self._doctor.done():
            self._doctor = asyncio.ensure_future(self._examine())
        return await asyncio.shield(self._doctor)

    async def _examine(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "findings.json")
            frames = [f"{key}:={self.params[key]}" for key in ("map_frame", "base_frame")]
            topics = [f"scan:={rospy.resolve_name('scan')}", f"map:={rospy.resolve_name('map')}"]
            code, said = await self._program("doctor", "--seconds", "5", "--json", path, *frames, *topics)
            if code not in (0, 1) or not os.path.exists(path):
                raise Refused("failed", said)
            with open(path) as file:
                return json.load(file)
