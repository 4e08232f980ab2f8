#!/usr/bin/env python3
"""A bag played with its clock through the nodelet: a map and a way as good as offline, and everything that a user of
gmapping expects."""
import math
import os
import subprocess
import sys
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from hyselam_msgs.msg import MapChangeArray, RegionEdge, RegionGraph, SemanticRegionArray, WordArray, WordMatchArray
from hyselam_msgs.srv import SlamGraph
from nav_msgs.msg import MapMetaData, OccupancyGrid, Path
from nav_msgs.srv import GetMap
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.dont_write_bytecode = True
from localization_rig import SLOWNESS, WAIT, Listener, Recording, newest_status, planar, play_bag, values_of, wait_until

RATE = 12 / SLOWNESS  # times real time; every scan must still be used, and that is checked


def trajectory_error(way, truth_at):
    """Root mean square distance [m] of (stamp, x, y) from the truth after the best rigid motion."""
    points = [(complex(x, y), complex(*truth_at(stamp)[:2])) for stamp, x, y in way]
    mean = sum(p for p, _ in points) / len(points)
    true_mean = sum(t for _, t in points) / len(points)
    turn = sum((p - mean).conjugate() * (t - true_mean) for p, t in points)
    turn /= abs(turn)
    return math.sqrt(sum(abs(turn * (p - mean) - (t - true_mean)) ** 2 for p, t in points) / len(points))


class SlamBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Recording(route="mcl_a")
        kinds = {"map": OccupancyGrid, "map_metadata": MapMetaData, "path": Path, "region_graph": RegionGraph,
                 "words": WordArray, "word_matches": WordMatchArray, "semantic_regions": SemanticRegionArray,
                 "slam_markers": MarkerArray, "map_certainty": OccupancyGrid, "map_changes": MapChangeArray,
                 "map_change_markers": MarkerArray, "tf": TFMessage, "diagnostics": DiagnosticArray}
        cls.heard = {topic: Listener("/" + topic, kind) for topic, kind in kinds.items()}
        rospy.wait_for_service("/slam/save", WAIT)
        wait_until(lambda: all(h.subscriber.get_num_connections() > 0 for t, h in cls.heard.items() if t != "tf"),
                   "not connected")
        play_bag(cls.run_.bag, RATE, ["/scan", "/tf", "/tf_static"])
        wait_until(lambda: int(cls.values().get("scans used", 0)) >= len(cls.run_.scans), lambda: str(cls.values()))
        last = cls.run_.scans[-1].header.stamp.to_sec()
        wait_until(lambda: cls.heard["path"].messages and
                   cls.heard["path"].messages[-1].header.stamp.to_sec() > last - 5.0, "the path is old")
        wait_until(cls.rests, lambda: f"loops are still looked for: {cls.values()}")
        out = os.path.join(cls.run_.folder.name, "offline")
        subprocess.run(["rosrun", "ngram_slam", "slam_offline", "--bag", cls.run_.bag, "--out", out], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(os.path.join(out, "trajectory.tum")) as file:
            rows = [line.split() for line in file if not line.startswith("#")]
        with open(os.path.join(out, "graph.g2o")) as file:
            edges = [line.split()[1:6] for line in file if line.startswith("EDGE_SE2")]
        cls.offline_edges = [(int(a), int(b), *map(float, pose)) for a, b, *pose in edges]
        cls.offline = trajectory_error([tuple(map(float, r[:3])) for r in rows], cls.run_.truth_at)

    @classmethod
    def values(cls):
        return values_of(newest_status(cls.heard["diagnostics"], lambda name: name == "slam: SLAM"))

    @classmethod
    def rests(cls):
        """What it found, and the way that it published, are the same after a while, and nothing more is looked for."""
        def found():
            return [cls.values().get(key) for key in ("loops", "optimizations", "regions")], cls.heard["path"].messages[-1].header.stamp
        before = found()
        time.sleep(2.0 * SLOWNESS)
        return found() == before and cls.values().get("looking for loops") == "false"

    def test_way_is_as_good_as_offline(self):
        path = self.heard["path"].messages[-1]
        way = [(p.header.stamp.to_sec(), p.pose.position.x, p.pose.position.y) for p in path.poses]
        self.assertGreater(len(way), 200)
        live = trajectory_error(way, self.run_.truth_at)
        print(f"live {live:.3f} m, offline {self.offline:.3f} m")
        self.assertLess(self.offline, 0.2)
        # Offline all is optimized once more at the end.
        self.assertLess(live, 1.2 * self.offline + 0.02)

    def test_graph_equals_offline(self):
        """Whatever the threads did: each step and each loop, in the order in which they were found, but for those of the end, of
        which a robot does not know that it is one."""
        ask, keyframes, map_, odometry, complete = rospy.ServiceProxy("/slam_graph", SlamGraph), 0, "", [], False
        while not complete:
            answer = ask(map=map_, keyframes=keyframes, version=0, max_keyframes=100)
            map_, keyframes, complete = answer.map, answer.first + len(answer.new_keyframes), answer.complete
            odometry += answer.odometry
        self.assertEqual(self.values()["loops and optimizations late"], "0")
        offline = [[e for e in self.offline_edges if (e[0] + 1 == e[1]) == steps] for steps in (True, False)]
        self.assertEqual(len(odometry), len(offline[0]))
        self.assertGreater(len(answer.loops), 10)
        print(f"loops: live {len(answer.loops)}, offline {len(offline[1])}")
        self.assertLessEqual(len(answer.loops), len(offline[1]))
        self.assertLessEqual(len(offline[1]), len(answer.loops) + 3)
        for live, there in ((odometry, offline[0]), ([loop.edge for loop in answer.loops], offline[1])):
            for e, o in zip(live, there):
                self.assertEqual((e.from_, e.to), o[:2])
                pose = e.measured
                self.assertLess(max(abs(pose.x - o[2]), abs(pose.y - o[3]), abs(pose.theta - o[4])), 1e-6, o)

    def test_transform_is_published_all_the_time(self):
        stamps = [t.header.stamp.to_sec() for m in self.heard["tf"].messages for t in m.transforms
                  if t.header.frame_id == "map" and t.child_frame_id == "odom"]
        self.assertEqual(stamps, sorted(set(stamps)))
        self.assertGreater(len(stamps), 200)
        scans = [s.header.stamp.to_sec() for s in self.run_.scans]
        self.assertLess(stamps[0], scans[0] + 1.0)
        self.assertGreater(stamps[-1], scans[-1])

    def test_map_shows_the_plan(self):
        grid = self.heard["map"].messages[-1]
        self.assertEqual(grid.header.frame_id, "map")
        self.assertEqual(self.heard["map_metadata"].messages[-1].width, grid.info.width)
        self.assertGreater(len(self.heard["map"].messages), 20)
        answer = rospy.ServiceProxy("/dynamic_map", GetMap)().map
        self.assertEqual(answer.info.resolution, grid.info.resolution)
        self.assertAlmostEqual(grid.info.resolution, 0.05, places=6)
        free = sum(v == 0 for v in grid.data) * 0.05 ** 2
        plan = sum(v == 0 for v in self.run_.map.data) * self.run_.map.info.resolution ** 2
        self.assertGreater(free, 0.5 * plan)
        self.assertLess(free, 1.1 * plan)
        # The robot starts at the pose of its odometry and never drives through walls.
        path = self.heard["path"].messages[-1]
        for p in path.poses:
            x = int((p.pose.position.x - grid.info.origin.position.x) / 0.05)
            y = int((p.pose.position.y - grid.info.origin.position.y) / 0.05)
            self.assertNotEqual(grid.data[y * grid.info.width + x], 100)

    def test_how_sure_the_map_is_and_that_nothing_changed(self):
        grid, sure = self.heard["map"].messages[-1], self.heard["map_certainty"].messages[-1]
        self.assertEqual((sure.info.width, sure.info.height, sure.header.frame_id), (grid.info.width, grid.info.height, "map"))
        self.assertTrue(all((g < 0) == (s < 0) and (g < 0 or (g > 50) == (s > 50) or s == 50) for g, s in zip(grid.data, sure.data)))
        # There is no session before this one.
        self.assertEqual(self.heard["map_changes"].messages[-1].changes, [])
        self.assertEqual(len(self.heard["map_change_markers"].messages[-1].markers), 1)
        self.assertEqual(self.values()["since the last session"], "nothing changed")

    def test_words_regions_and_their_graph(self):
        for topic, field in (("words", "words"), ("word_matches", "matches"), ("semantic_regions", "regions")):
            items = [i for m in self.heard[topic].messages for i in getattr(m, field)]
            self.assertGreater(len(items), 3, topic)
        graph = self.heard["region_graph"].messages[-1]
        self.assertEqual(graph.header.frame_id, "map")
        self.assertEqual([n.id for n in graph.nodes], list(range(len(graph.nodes))))
        self.assertGreater(len(graph.nodes), 5)
        for edge in graph.edges:
            self.assertLess(edge.a, edge.b)
            self.assertLess(edge.b, len(graph.nodes))
        self.assertIn(RegionEdge.LOOP, {e.kind for e in graph.edges})
        # Nodes lie on the path.
        path = self.heard["path"].messages[-1]
        for node in graph.nodes:
            self.assertLess(min(math.hypot(p.pose.position.x - node.pose.x, p.pose.position.y - node.pose.y)
                                for p in path.poses), 0.5)

    def test_what_rviz_shows(self):
        markers = {m.ns for m in self.heard["slam_markers"].messages[-1].markers}
        self.assertGreaterEqual(markers, {"path", "loops", "regions", "region_links", "region_names"})

    def test_diagnostics(self):
        values = self.values()
        self.assertGreater(int(values["loops"]), 0)
        self.assertGreater(int(values["optimizations"]), 0)
        self.assertEqual(values["odometry jumps"], "0")
        self.assertEqual(values["publishing tf"], "true")


if __name__ == "__main__":
    rospy.init_node("slam_bag_test")
    rostest.rosrun("hyselam_bringup", "slam_bag_test", SlamBagTest)
