"""Where frames are in each other, from the bytes of tf messages. No message is made of what nobody looks at: of these bytes only a few
numbers are read."""
import collections
import math
import struct

HISTORY = 400  # transforms of an edge that are kept
NUMBERS = struct.Struct("<7d")
LENGTH = struct.Struct("<I")
TIME = struct.Struct("<II")
IDENTITY = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def parse(data):
    """(stamp, parent, child, (x, y, z, qx, qy, qz, qw)) of each transform of a serialized tf2_msgs/TFMessage.
    @throws ValueError: it is cut off, or has too many."""
    try:
        count, at = LENGTH.unpack_from(data, 0)[0], 4
        found = []
        for _ in range(count):
            seconds, nanoseconds = TIME.unpack_from(data, at + 4)
            at += 12
            names = []
            for _ in range(2):
                length = LENGTH.unpack_from(data, at)[0]
                names.append(bytes(data[at + 4:at + 4 + length]).decode("utf-8", "replace").lstrip("/"))
                at += 4 + length
            found.append((seconds + 1e-9 * nanoseconds, names[0], names[1], NUMBERS.unpack_from(data, at)))
            at += NUMBERS.size
        return found
    except struct.error:
        raise ValueError("a transform is cut off")


def rotate(q, v):
    x, y, z, w = q
    a, b, c = v
    tx, ty, tz = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return (a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx)


def compose(a, b):
    """First b, then a: of frame b in frame a's parent."""
    x, y, z = rotate(a[3:], b[:3])
    ax, ay, az, aw = a[3:]
    bx, by, bz, bw = b[3:]
    return (a[0] + x, a[1] + y, a[2] + z, aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def inverse(a):
    q = (-a[3], -a[4], -a[5], a[6])
    x, y, z = rotate(q, a[:3])
    return (-x, -y, -z) + q


def between(a, b, share):
    """The way from a to b, straight, rotation by normalized interpolation."""
    sign = 1.0 if sum(p * q for p, q in zip(a[3:], b[3:])) >= 0 else -1.0
    mixed = [p + share * (q - p) for p, q in zip(a[:3], b[:3])]
    turn = [p + share * (sign * q - p) for p, q in zip(a[3:], b[3:])]
    norm = math.sqrt(sum(v * v for v in turn)) or 1.0
    return tuple(mixed) + tuple(v / norm for v in turn)


def planar(a):
    """x, y, yaw."""
    x, y, z, w = a[3:]
    return a[0], a[1], math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


class TransformTree:
    def __init__(self):
        self._parent = {}  # child: parent
        self._edges = {}  # child: deque of (stamp, transform)

    def add(self, stamp, parent, child, transform):
        """False: it is not possible, and left out."""
        norm = sum(v * v for v in transform[3:])
        if not all(math.isfinite(v) for v in transform) or not 0.9 < norm < 1.1 or parent == child or not child:
            return False
        edge = self._edges.get(child)
        if edge is None or self._parent[child] != parent or (edge and stamp < edge[-1][0] - 1.0):  # time went back
            self._edges[child] = edge = collections.deque(maxlen=HISTORY)
            self._parent[child] = parent
        if not edge or stamp > edge[-1][0]:
            edge.append((stamp, transform))
        elif stamp == edge[-1][0]:
            edge[-1] = (stamp, transform)
        return True

    def add_message(self, data):
        return sum(self.add(*each) for each in parse(data))

    def _at(self, child, stamp):
        edge = self._edges[child]
        if stamp is None or stamp >= edge[-1][0] or len(edge) == 1:
            return edge[-1][1]
        newer = edge[-1]
        for older in reversed(edge):
            if older[0] <= stamp:
                span = newer[0] - older[0]
                return between(older[1], newer[1], (stamp - older[0]) / span) if span > 0 else older[1]
            newer = older
        return edge[0][1]

    def _to_root(self, frame, stamp):
        """[(frame, transform of the first frame in it)] upwards."""
        chain, transform = [(frame, IDENTITY)], IDENTITY
        while frame in self._parent and len(chain) < 100:
            transform = compose(self._at(frame, stamp), transform)
            frame = self._parent[frame]
            chain.append((frame, transform))
        return chain

    def lookup(self, target, source, stamp=None):
        """The transform of the frame `source` in `target`, at the stamp or as it is known last; None: there is no way."""
        target, source = target.lstrip("/"), source.lstrip("/")
        up = {}
        for frame, transform in self._to_root(target, stamp):
            up.setdefault(frame, transform)
        for frame, transform in self._to_root(source, stamp):
            if frame in up:
                return compose(inverse(up[frame]), transform)
        return None

    def stamp(self, child):
        """Of the newest transform of a frame; None: there is none."""
        edge = self._edges.get(child.lstrip("/"))
        return edge[-1][0] if edge else None
