"""Poses in the plane: (x, y, theta)."""
import math


def planar(pose):
    """Of geometry_msgs/Pose."""
    return moved(pose.position, pose.orientation)


def moved(by, turned):
    """Of a shift and a rotation, as geometry_msgs/Transform has them."""
    return by.x, by.y, 2 * math.atan2(turned.z, turned.w)


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]
