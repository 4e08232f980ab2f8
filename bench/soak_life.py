"""The life around a robot for hours: rounds that are never quite the same, a person who talks to it, one who watches its
page, and where it was in truth. No program; bench/soak_stack imports it."""
import collections
import importlib.machinery
import importlib.util
import math
import queue
import random
import threading
import time

import robot_feed as feed

ROOMS_AT = 1.6  # [m] from the middle of the corridor: beyond, the robot is in a room
PLANS = feed.ROOT / "src" / "hyselam_sim"


# ---- rounds

def changed_office(number):
    """Plan and route of another day in the office: things moved, doors open or shut, other people, the way back on odd days."""
    import yaml
    plan = yaml.safe_load((PLANS / "plans" / "office.yaml").read_text())
    route = yaml.safe_load((PLANS / "routes" / "office.yaml").read_text())
    if number == 0:
        return plan, route
    rng = random.Random(number)
    visited = {step for step in route["steps"] if isinstance(step, str)}
    for thing in rng.sample([t for t in plan["furniture"] if "box" in t and t["height"] < 1.2], 8):
        x, y, length, width, *turn = thing["box"]
        thing["box"] = [round(x + rng.uniform(-0.4, 0.4), 2), y, length, width, (turn[0] if turn else 0) + rng.choice((-10, 0, 10))]
    for i in range(4):  # carts and chairs along the corridor
        thing = [round(rng.uniform(4, 34), 2), rng.choice((7.1, 8.9)), 0.5, 0.4, rng.randrange(-20, 21)]
        if all(math.hypot(thing[0] - d["at"][0], thing[1] - d["at"][1]) > 1.2 for d in plan["doors"]):
            plan["furniture"].append({"name": f"cart {i}", "box": thing, "height": 1.0})
    for door in plan["doors"]:
        if door.get("swing") and not any(name.startswith(door["name"].replace(" door", "")) for name in visited):
            door.pop("schedule", None)
            door["open"] = rng.random() < 0.5
    if number % 2:
        route["steps"] = route["steps"][-2::-1] + route["steps"][-1:]
    route["people"] = [{"name": f"person {i}", "points": [[rng.uniform(2, 10), y], [rng.uniform(20, 34), y]],
                        "speed": round(rng.uniform(0.6, 1.3), 2), "from": 20 * i} for i, y in
                       enumerate(rng.choice(((8.6,), (8.6, 7.4), (8.6, 7.4, 8.0))))]
    return plan, route


def rounds(folder, count):
    """So many folders of feed.prepare(), of different days."""
    import yaml
    folders = []
    for number in range(count):
        place = folder / (f"round_{number}" if number else "round")
        place.mkdir(parents=True, exist_ok=True)
        plan, route = changed_office(number)
        for name, content in (("plan", plan), ("route", route)):
            (place / f"{name}.yaml").write_text(yaml.safe_dump(content, sort_keys=False))
        folders.append(feed.prepare(place, 1, (320, 240), seed=number + 1, route=place / "route.yaml", plan=place / "plan.yaml"))
    return folders


def place_names(plan):
    """[(name, x, y)] of the rooms; the places in the corridor are one."""
    return [(p["name"], *p["at"]) for p in plan["places"] if "corridor" not in p["name"]]


def place_of(pose, names):
    """Which room, or the corridor; None at doors."""
    name, x, y = min(names, key=lambda n: math.hypot(n[1] - pose[0], n[2] - pose[1]))
    if abs(pose[1] - 8.0) < 0.8 and pose[0] < 35:
        return "corridor"
    return name if math.hypot(x - pose[0], y - pose[1]) < ROOMS_AT else None


# ---- company

class Person:
    """Talks to the robot, one sentence at a time, in a thread: names the place, asks for one, asks where it is."""

    def __init__(self, names):
        import rospy
        from hyselam_msgs.srv import TellRobot
        rospy.wait_for_service("tell_robot", 120)
        self.tell = rospy.ServiceProxy("tell_robot", TellRobot)
        self.names, self.told, self.turn = names, [], 0
        self.counts, self.delays = collections.Counter(), []
        self.waiting = queue.Queue()
        threading.Thread(target=self._talk, daemon=True).start()

    def speak(self, pose):
        """The next sentence, with the robot at a pose of the plan."""
        here = place_of(pose, self.names)
        kind = ("names", "asks where something is", "asks where it is")[self.turn % 3]
        self.turn += 1
        if kind == "names" and here:
            self.told += [here] if here not in self.told else []
            self.waiting.put((kind, f"This is the {here}." if "'" not in here else f"This is {here}.", None))
        elif kind == "asks where something is" and self.told:
            name = self.told[self.turn // 3 % len(self.told)]
            self.waiting.put((kind, f"Where is {name}?" if "'" in name else f"Where is the {name}?", name))
        else:
            self.waiting.put(("asks where it is", "Where am I?", here if here in self.told else None))

    def _talk(self):
        import rospy
        while True:
            kind, text, expected = self.waiting.get()
            self.counts["said"] += 1
            begin = time.monotonic()
            try:
                answers = self.tell(text).answers
            except rospy.ServiceException:
                continue
            if not answers:
                continue
            self.counts["answered"] += 1
            self.delays.append(time.monotonic() - begin)
            if kind == "asks where it is" and expected:
                self.counts["asked where it is, in a place named before"] += 1
                self.counts["right"] += expected in " ".join(answers)

    def take(self):
        taken, self.delays = self.delays, []
        return taken


class Page:
    """A browser's page that is open all the time."""

    def __init__(self):
        import rospy
        loader = importlib.machinery.SourceFileLoader("web_load", str(feed.ROOT / "bench" / "web_load"))
        web_load = importlib.util.module_from_spec(importlib.util.spec_from_loader("web_load", loader))
        loader.exec_module(web_load)
        while not rospy.has_param("/web/bound_port"):
            time.sleep(0.2)
        self.audience = web_load.Audience(f"http://localhost:{rospy.get_param('/web/bound_port')}", 1)
        self.before = 0

    def take(self):
        """Bytes since the last time."""
        before, self.before = self.before, self.audience.total()
        return self.before - before


# ---- truth

class Errors:
    """How far the robot is from where it takes itself to be [m]. SLAM's map begins where its odometry does."""

    def __init__(self, knows_map):
        self.plan_in_map = (0.0, 0.0, 0.0) if knows_map else None
        self.of = []

    def add(self, truth, odometry, odom_in_map):
        if self.plan_in_map is None:
            self.plan_in_map = feed.compose(odometry, feed.inverse(truth))
        self.add_pose(truth, feed.compose(odom_in_map, odometry))

    def add_pose(self, truth, base_in_map):
        x, y, _ = feed.compose(feed.inverse(feed.compose(self.plan_in_map, truth)), base_in_map)
        self.of.append(math.hypot(x, y))

    def take(self):
        taken, self.of = self.of, []
        return taken
