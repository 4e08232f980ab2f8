"""What came and was not looked at yet. Free of ROS; whoever puts and whoever takes may be different threads."""
import collections

STALE = 5.0  # [s] after which a part that reports nothing is shown so
MAX_STATUSES = 500


class Newest:
    """The newest of what was put in, once."""

    def __init__(self):
        self._kept = collections.deque(maxlen=1)

    def put(self, data):
        self._kept.append(data)

    def is_new(self):
        return bool(self._kept)

    def take(self):
        """None: there is nothing new."""
        try:
            return self._kept.popleft()
        except IndexError:
            return None


class Statuses:
    """The newest diagnostic status of each name: parts of one process report under one caller id."""

    LEVELS = ("ok", "warn", "error", "stale")

    def __init__(self):
        self._known = {}  # name: (when, level, message)

    def put(self, name, level, message, when):
        self._known.pop(name, None)
        self._known[name] = (when, level, message)
        while len(self._known) > MAX_STATUSES:
            del self._known[next(iter(self._known))]

    def layers(self, namespace, now):
        """{node: what is shown} of the nodes of a namespace; of several statuses of a node the worst."""
        found = {}
        for name, (when, level, message) in self._known.items():
            node, _, what = name.partition(":")
            node = "/" + node.strip().lstrip("/")
            if not node.startswith(namespace):
                continue
            level = 3 if now - when > STALE else level if 0 <= level < 4 else 2
            key = node[len(namespace):]
            if key not in found or level > found[key][0]:
                found[key] = (level, {"level": self.LEVELS[level], "what": what.strip()[:60], "text": message[:300]})
        return {key: shown for key, (_, shown) in sorted(found.items())[:100]}
