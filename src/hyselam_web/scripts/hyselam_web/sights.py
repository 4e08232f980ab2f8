"""From messages to what pages are shown: plain values, short numbers. Messages are any objects with the fields of theirs."""
import base64
import math
import re

import numpy as np

MAX_RAYS = 240  # of a scan that is shown
MAX_PARTICLES = 300
MAX_WAY = 400  # points of a way
MAX_ITEMS = 5000  # places, doors, walls, objects
MAX_OUTLINE = 200
MAX_LABEL = 200  # characters of a name
MAX_CANDIDATES = 50  # places that a name may be of
CODES = {0: "SS", 1: "CC", 2: "VV"}  # as TopoEngine calls places
VIRTUAL, GLASS = 0, 1  # kinds of walls
OPEN_QUESTION = re.compile(r"\b(what|which|where|who|whose|how|qual|quais|que|onde|quem|quanto|quantos|quantas|como)\b", re.IGNORECASE)
CODE = re.compile(r"\b(?:SS|CC|VV)(\d{2,9})\b")


def cm(value):
    return round(float(value), 2)


def finite(*values):
    return all(math.isfinite(v) for v in values)


def yaw_of(q):
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def packed(points):
    """Points as little-endian 32 bit numbers of centimetres, in base64."""
    return base64.b64encode(np.round(np.asarray(points, float) * 100).astype("<i4").tobytes()).decode()


def packed_small(points):
    """The same with 16 bits, for points within 300 m."""
    return base64.b64encode(np.clip(np.round(np.asarray(points, float) * 100), -32000, 32000).astype("<i2").tobytes()).decode()


def pose(x, y, yaw):
    return {"x": cm(x), "y": cm(y), "a": round(yaw, 3)} if finite(x, y, yaw) else None


def scan(msg, laser_in_base, base_in_map):
    """Returns of a laser in the frame of the robot; None: none, or the pose is not known."""
    ranges = np.asarray(msg.ranges, float)
    seen = np.isfinite(ranges) & (ranges >= msg.range_min) & (ranges < msg.range_max)
    step = max(1, -(-len(ranges) // MAX_RAYS))
    chosen = np.arange(0, len(ranges), step)
    chosen = chosen[seen[chosen]]
    if not len(chosen) or base_in_map is None or laser_in_base is None:
        return None
    angles = msg.angle_min + chosen * msg.angle_increment
    x, y, z, w = laser_in_base[3:]
    flat = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z)]])
    points = np.stack([ranges[chosen] * np.cos(angles), ranges[chosen] * np.sin(angles)], axis=1) @ flat.T + laser_in_base[:2]
    value = pose(*base_in_map)
    return None if value is None else dict(value, p=packed_small(points))


def particles(msg):
    step = max(1, -(-len(msg.poses) // MAX_PARTICLES))
    points = [(p.position.x, p.position.y) for p in msg.poses[::step] if finite(p.position.x, p.position.y)]
    return packed(points) if points else None


def spread(msg):
    """The ellipse of one standard deviation of a pose: half axes [m], direction."""
    c = msg.pose.covariance
    if not finite(c[0], c[1], c[7]):
        return None
    values, vectors = np.linalg.eigh(np.array([[c[0], c[1]], [c[1], c[7]]]))
    big, small = math.sqrt(max(values[1], 0.0)), math.sqrt(max(values[0], 0.0))
    return {"l": cm(min(big, 1e4)), "s": cm(min(small, 1e4)), "a": round(math.atan2(vectors[1, 1], vectors[0, 1]), 2)}


def way(msg):
    points = [(p.pose.position.x, p.pose.position.y) for p in msg.poses]
    if not points or not all(finite(*p) for p in points):
        return []
    step = max(1, -(-len(points) // MAX_WAY))
    chosen = points[::step] if points[-1] in points[::step][-1:] else points[::step] + [points[-1]]
    return [[cm(x), cm(y)] for x, y in chosen]


def words(entries):
    return [[w.text[:MAX_LABEL], 1 if w.confirmed else 0] for w in entries[:8]]


def places(msg):
    found = {}
    for place in msg.places[:MAX_ITEMS]:
        step = max(1, -(-len(place.outline_x) // MAX_OUTLINE))
        corners = list(zip(place.outline_x[::step], place.outline_y[::step]))
        item = {"k": place.kind, "e": f"{CODES.get(place.kind, 'SS')}{place.id:02d}", "n": words(place.words), "s": round(place.area, 1) if finite(place.area) else 0}
        if place.has_centre and finite(place.centre.x, place.centre.y):
            item["c"] = [cm(place.centre.x), cm(place.centre.y)]
        if corners and all(finite(x, y) for x, y in corners):
            item["o"] = [cm(v) for corner in corners for v in corner]
        found[str(place.id)] = item
    return found


def doors(msg):
    found = {}
    for edge in msg.edges[:MAX_ITEMS]:
        for door in edge.doors:
            if finite(door.position.x, door.position.y, door.normal.x, door.normal.y, door.width):
                found[str(door.id)] = {"x": cm(door.position.x), "y": cm(door.position.y), "nx": round(door.normal.x, 3), "ny": round(door.normal.y, 3),
                                       "w": cm(door.width), "r": bool(door.real), "st": door.state, "a": edge.a, "b": edge.b}
    return found


def walls(msg):
    """Those that no laser sees: of glass, and virtual ones."""
    found = {}
    for place in msg.places[:MAX_ITEMS]:
        for wall in place.walls:
            if wall.kind in (GLASS, VIRTUAL) and wall.curvature == 0 and finite(wall.position.x, wall.position.y, wall.normal.x, wall.normal.y, wall.length):
                found[str(wall.id)] = {"x": cm(wall.position.x), "y": cm(wall.position.y), "nx": round(wall.normal.x, 3), "ny": round(wall.normal.y, 3),
                                       "l": cm(wall.length), "k": wall.kind}
    return found


def told_walls(msg):
    """Those that people told of, from one end to the other."""
    found = {}
    for wall in msg.walls[:MAX_ITEMS]:
        if finite(wall.position.x, wall.position.y, wall.normal.x, wall.normal.y, wall.length):
            dx, dy = -wall.normal.y * wall.length / 2, wall.normal.x * wall.length / 2
            found[str(wall.id)] = {"ax": cm(wall.position.x - dx), "ay": cm(wall.position.y - dy), "bx": cm(wall.position.x + dx), "by": cm(wall.position.y + dy),
                                   "v": wall.kind == VIRTUAL}
    return found


def objects(msg):
    at = {}
    for relation in msg.relations:
        if relation.place and relation.object not in at:
            at[relation.object] = [relation.word[:20], relation.place[:MAX_LABEL]]
    found = {}
    for each in msg.objects[:MAX_ITEMS]:
        item = {"k": each.kind[:MAX_LABEL], "p": [f"{n}: {v}"[:MAX_LABEL] for n, v in zip(each.property_names, each.property_values)][:5]}
        if each.has_pose and finite(each.pose.position.x, each.pose.position.y):
            item["c"] = [cm(each.pose.position.x), cm(each.pose.position.y)]
        if each.id in at:
            item["at"] = at[each.id]
        found[str(each.id)] = item
    return found


def candidates(text):
    """{name: numbers of the places where it may be} of names whose place is not sure, from lines of a name and ids of the map."""
    found = {}
    for line in text.splitlines()[:MAX_ITEMS]:
        name, *codes = line.split("\t")
        numbers = [int(each.group(1)) for each in map(CODE.fullmatch, codes) if each]
        if name and numbers:
            found[name[:MAX_LABEL]] = numbers[:MAX_CANDIDATES]
    return found


def here(msg):
    return {"place": msg.place, "name": msg.name[:MAX_LABEL], "sure": bool(msg.confirmed), "door": bool(msg.in_doorway)}


def camera(msg):
    ranked = sorted(zip(msg.probabilities, msg.names), reverse=True)[:3]
    return {"name": msg.name[:MAX_LABEL], "place": msg.place, "p": round(float(msg.probability), 2) if finite(msg.probability) else 0,
            "seen": bool(msg.descriptive), "top": [[name[:MAX_LABEL], round(float(p), 2)] for p, name in ranked if finite(p)]}


def status(msg):
    return {"phase": ("search", "sure", "lost")[msg.phase] if msg.phase < 3 else "search", "text": msg.text[:300],
            "q": round(float(msg.match_quality), 2) if finite(msg.match_quality) else None}


def question(text, here_now, is_open=False):
    """What the robot asks with a sentence: of which place, and whether yes or no is an answer; None: it asks nothing. Of what is known to be an
    open question, more may be said behind it."""
    parts = re.split(r"(?<=[.!?])\s+", text.strip())
    last = next((part for part in reversed(parts) if part.endswith("?")), "") if is_open else parts[-1]
    if not last.endswith("?"):
        return {"text": text[:500], "place": 0, "yes": False} if is_open else None
    code = CODE.search(text)
    this = re.search(r"\b(this place|este lugar|deste lugar|this)\b", text if is_open else last, re.IGNORECASE)
    return {"text": text[:500], "place": int(code.group(1)) if code else here_now if this else 0, "yes": not OPEN_QUESTION.match(last)}
