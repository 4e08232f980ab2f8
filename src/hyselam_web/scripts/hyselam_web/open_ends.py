"""What is open, and when it is over: the robot's question, its way. Free of ROS."""
import math

from . import sights

ARRIVED, LEFT = 0.5, 1.0  # [m] from the end of the way


class OpenQuestion:
    """The dialogue tells which question of its own is open; what others ask is open until something is said."""

    def __init__(self):
        self._own, self._others = None, None
        self._answered = False  # what was said may have answered it

    def told(self, text):
        """The dialogue's question; "": it has none."""
        self._own = text
        self._answered = False
        if self._others == text:
            self._others = None

    def heard(self, who, text):
        """A line of the talk."""
        self._answered = who == "human"
        self._others = text if who == "robot" and text != self._own else None

    def shown(self, here):
        """As sights.question()."""
        if self._own and not self._answered:
            return sights.question(self._own, here, True)
        return sights.question(self._others, here) if self._others else None


class Arrival:
    """Where nobody tells that a way is over, its end does."""

    def __init__(self):
        self._left_goal = False

    def sets_out(self):
        self._left_goal = False

    def is_at_end(self, way, pose):
        """Of a way (points) with the robot at a pose (x, y)."""
        far = math.dist(pose, way[-1])
        # There and back: it stands at its goal when it sets out.
        self._left_goal = self._left_goal or far > LEFT
        return far < ARRIVED and (self._left_goal or sum(math.dist(a, b) for a, b in zip(way, way[1:])) < LEFT)
