"""Where a laser is mounted, by the scans of a moving robot against its odometry: the same as ngram_slam's estimateLaserMount(), for
some seconds of a live robot."""
import math

import numpy as np

MIN_PAIRS, MIN_TURN = 12, 1.5  # pairs of scans; turned in all of them [rad]
SIGNIFICANCE = 4.0  # standard deviations
TOLERANCE, ANGLE_TOLERANCE = 0.03, 0.02  # [m], [rad]
SIGMA = 0.03  # of a point from its surface [m]
LIKELY_SCALE = 0.05  # standard deviation of the scales of odometry, before


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return np.array([a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], math.remainder(a[2] + b[2], 2 * math.pi)])


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return np.array([-c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]])


def normals_of(points):
    """Of each point of a scan: across the line through its neighbours; 0 where these are not one surface."""
    along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    length = np.hypot(along[:, 0], along[:, 1])
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(length, 1e-9)[:, None]
    off = np.abs(((points - np.roll(points, 1, axis=0)) * normals).sum(axis=1))
    good = (length < 0.1 + 0.1 * np.hypot(points[:, 0], points[:, 1])) & (off < 0.05)
    good[[0, -1]] = False
    return normals, good


def scan_motion(old, new, guess):
    """The motion of the laser between two scans, (pose, information), by points to lines; None if they do not fit."""
    normals, good = normals_of(old)
    pose, h, near = np.array(guess, dtype=float), np.zeros((3, 3)), None
    for i in range(15):
        c, s = math.cos(pose[2]), math.sin(pose[2])
        moved = new @ np.array([[c, s], [-s, c]]) + pose[:2]
        squares = ((moved[:, None, :] - old[None, :, :]) ** 2).sum(axis=2)
        nearest = squares.argmin(axis=1)
        near = squares.min(axis=1) < max(0.15, 0.5 * 0.7 ** i) ** 2
        used = near & good[nearest]
        if used.sum() < 20:
            return None
        n, q = normals[nearest[used]], old[nearest[used]]
        arm = moved[used] - pose[:2]
        residual = ((moved[used] - q) * n).sum(axis=1)
        jacobian = np.column_stack([n, n[:, 1] * arm[:, 0] - n[:, 0] * arm[:, 1]])
        weight = 1.0 / (1.0 + (residual / SIGMA) ** 2) / SIGMA ** 2
        h = (jacobian * weight[:, None]).T @ jacobian
        step = np.linalg.solve(h + 1e-3 * np.eye(3), -(jacobian * weight[:, None]).T @ residual)
        pose += step
        if np.abs(step).max() < 1e-5 and i > 6:
            break
    if near.mean() < 0.6:
        return None
    c, s = math.cos(pose[2]), math.sin(pose[2])
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return pose, turn.T @ h @ turn  # in the frame of the newer scan


def solve(pairs, told):
    """Mount and the scales of odometry by robust least squares, with their covariance. pairs: (odometry, laser, information)."""
    value = np.array([*told, 0.0, 0.0])
    prior = np.diag([0, 0, 0, LIKELY_SCALE ** -2, LIKELY_SCALE ** -2])

    def error(v, odometry, laser):
        base = odometry * [1 + v[3], 1 + v[3], 1 + v[4]]
        return compose(inverse(laser), compose(compose(inverse(v[:3]), base), v[:3]))

    h, cost = prior, 0.0
    for _ in range(15):
        h, g, cost = prior.copy(), prior @ value * [0, 0, 0, 1, 1], 0.0
        for odometry, laser, information in pairs:
            e = error(value, odometry, laser)
            j = np.column_stack([(error(value + 1e-6 * np.eye(5)[k], odometry, laser) - e) / 1e-6 for k in range(5)])
            driven, turned = math.hypot(odometry[0], odometry[1]), abs(odometry[2])
            heading = 0.005 + 0.01 * driven + 0.03 * turned
            position = 0.005 + 0.03 * driven + math.hypot(value[0], value[1]) * heading
            w = np.linalg.inv(np.linalg.inv(0.1 * information + 1e-6 * np.eye(3)) + np.diag([position, position, heading]) ** 2)
            squares = e @ w @ e
            robust = min(1.0, 1.345 / math.sqrt(squares / 3)) if squares > 0 else 1.0
            h, g, cost = h + robust * j.T @ w @ j, g + robust * j.T @ w @ e, cost + robust * squares
        step = np.linalg.solve(h, -g)
        value = value + step
        if np.abs(step).max() < 1e-7:
            break
    return value, max(1.0, cost / max(1.0, 3 * len(pairs) - 5)) * np.linalg.inv(h)


def laser_in_base(view):
    """Points of a view in the frame of its laser, as a laser that is not upside down, and where that is: (x, y, heading)."""
    _, _, _, points, (x, y, mount) = view
    if np.linalg.det(mount) < 0:
        points, mount = points * [1, -1], mount @ np.diag([1.0, -1.0])
    return points, np.array([x, y, math.atan2(mount[1, 0], mount[0, 0])])


def estimate(views):
    """views as the doctor's: (x, y, theta of the base in odom, points, planar mount). None if they tell nothing, else a dict: told,
    estimated (x, y, heading), stddev, pairs, wrong."""
    if not views:
        return None
    pairs, last, turned = [], None, 0.0
    told = laser_in_base(views[0])[1]
    for view in views:
        if last is not None:
            odometry = compose(inverse(np.array(last[:3])), np.array(view[:3]))
            driven, turn = math.hypot(odometry[0], odometry[1]), abs(odometry[2])
            if driven < 0.3 and turn < 0.3:
                continue
            if driven < 2.0:  # else a jump of the odometry
                guess = compose(compose(inverse(told), odometry), told)
                found = scan_motion(laser_in_base(last)[0], laser_in_base(view)[0], guess)
                if found is not None and abs(math.hypot(*found[0][:2]) - math.hypot(*guess[:2])) < 0.25 and abs(found[0][2] - guess[2]) < 0.3:
                    pairs.append((odometry, *found))
                    turned += turn
        last = view
    pairs = pairs[:: max(1, len(pairs) // 100)]
    if len(pairs) < MIN_PAIRS or turned < MIN_TURN:
        return None
    value, covariance = solve(pairs, told)
    stddev = np.sqrt(np.diag(covariance)[:3])
    off = np.array([value[0] - told[0], value[1] - told[1], math.remainder(value[2] - told[2], 2 * math.pi)])
    limit = np.maximum([TOLERANCE, TOLERANCE, ANGLE_TOLERANCE], SIGNIFICANCE * stddev)
    return {"told": told, "estimated": value[:3], "off": off, "stddev": stddev, "pairs": len(pairs), "wrong": bool((np.abs(off) > limit).any())}
