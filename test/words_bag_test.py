#!/usr/bin/env python3
"""A bag played with its clock through the nodelets and the node: the same words, places and regions as offline,
field by field."""
import csv
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from hyselam_msgs.msg import SemanticRegionArray, WordArray, WordMatch, WordMatchArray
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

sys.dont_write_bytecode = True
from localization_rig import SLOWNESS, WAIT, Listener, Recording, newest_status, play_bag, values_of, wait_until

RATE = 8 / SLOWNESS  # times real time; every scan must still be used, and that is checked
PLACES = ("fsd", "scan", "node")


class WordsBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Recording(route="mcl_b")
        kinds = {"words": WordArray, "word_matches": WordMatchArray, "semantic_regions": SemanticRegionArray,
                 "word_markers": MarkerArray}
        cls.heard = {(ns, topic): Listener(f"/{ns}/{topic}", kind) for ns in PLACES for topic, kind in kinds.items()}
        cls.diagnostics = Listener("/diagnostics", DiagnosticArray)
        for ns in PLACES:
            rospy.wait_for_service(f"/{ns}/words/start_run", WAIT)
        wait_until(lambda: all(l.subscriber.get_num_connections() > 0 for l in cls.heard.values()), "not connected")
        play_bag(cls.run_.bag, RATE, ["/scan", "/tf", "/tf_static"])
        for ns, name, key in (("fsd", "words_fsd", "scans used"), ("fsd", "words", "observations used"),
                              ("scan", "words", "scans used"), ("node", "words", "scans used")):
            wait_until(lambda: int(cls.values(f"{ns}/{name}").get(key, 0)) >= len(cls.run_.scans),
                       lambda: f"{ns}/{name}: {cls.values(f'{ns}/{name}')}")
        for ns in PLACES:
            # The last region becomes a word.
            assert rospy.ServiceProxy(f"/{ns}/words/start_run", Trigger)().success
        thesis = cls.write_offline("thesis", "--min-n", "2,3,4")
        improved = cls.write_offline("improved", "--improved", "--min-probability", "0.01")
        cls.offline = {"fsd": thesis, "node": thesis, "scan": improved}
        for ns in PLACES:
            wait_until(lambda: len(cls.items(ns, "words", "words")) >= len(cls.offline[ns]["words"]), "words are missing")
            wait_until(lambda: len(cls.items(ns, "semantic_regions", "regions")) >= len(cls.offline[ns]["regions"]),
                       "regions are missing")

    @classmethod
    def write_offline(cls, name, *options):
        out = os.path.join(cls.run_.folder.name, name)
        subprocess.run(["rosrun", "ngram_slam", "words_offline", cls.run_.bag, "--out", out, "--min-region", "3", *options],
                       check=True, stdout=subprocess.DEVNULL)
        tables = {}
        for table in ("words", "matches", "regions"):
            with open(os.path.join(out, table + ".csv"), newline="") as file:
                tables[table] = list(csv.DictReader(file))
        return tables

    @classmethod
    def values(cls, node):
        return values_of(newest_status(cls.diagnostics, lambda name: name.startswith(node + ":")))

    @classmethod
    def items(cls, ns, topic, field):
        return [item for message in cls.heard[ns, topic].messages for item in getattr(message, field)]

    def test_words_are_those_of_the_tool(self):
        for ns in PLACES:
            self.assertGreater(len(self.offline[ns]["words"]), 60)
            self.assertGreater(sum(row["level"] != "0" for row in self.offline[ns]["words"]), 10)
            words = self.items(ns, "words", "words")
            self.assertEqual(len(words), len(self.offline[ns]["words"]), ns)
            for word, row in zip(words, self.offline[ns]["words"]):
                self.assertEqual([word.index, word.level, word.first, word.last, word.run, word.density_class, word.size],
                                 [int(row[k]) for k in ("word", "level", "first", "last", "run", "class", "size")], ns)
                self.assertAlmostEqual(word.stamp_begin.to_sec(), float(row["stamp_begin"]), places=6)
                self.assertAlmostEqual(word.stamp_end.to_sec(), float(row["stamp_end"]), places=6)
                self.assertAlmostEqual(word.angle, float(row["angle"]), places=4)

    def test_matches_are_those_of_the_tool(self):
        self.assertIn("reverse", {row["direction"] for row in self.offline["scan"]["matches"]})
        for ns in PLACES:
            self.assertGreater(len(self.offline[ns]["matches"]), 5)
            matches = self.items(ns, "word_matches", "matches")
            self.assertEqual(len(matches), len(self.offline[ns]["matches"]), ns)
            direction = {"same": WordMatch.SAME, "reverse": WordMatch.REVERSE}
            for match, row in zip(matches, self.offline[ns]["matches"]):
                self.assertEqual([match.newer, match.older, match.level, match.n, match.run_newer, match.run_older],
                                 [int(row[k]) for k in ("word_a", "word_b", "level", "n", "run_a", "run_b")], ns)
                self.assertEqual(match.direction, direction[row["direction"]])
                self.assertAlmostEqual(match.stamp_newer.to_sec(), float(row["stamp_a"]), places=6)
                self.assertAlmostEqual(match.stamp_older.to_sec(), float(row["stamp_b"]), places=6)
                for value, name in ((match.alignment_rms, "alignment_rms"), (match.probability, "probability")):
                    self.assertAlmostEqual(value, float(row[name]), places=5)
                self.assertEqual(f"{match.chance:.4g}", f"{float(row['chance']):.4g}")

    def test_regions_are_those_of_the_tool(self):
        for ns in PLACES:
            self.assertGreater(len(self.offline[ns]["regions"]), 10)
            regions = self.items(ns, "semantic_regions", "regions")
            self.assertEqual(len(regions), len(self.offline[ns]["regions"]), ns)
            for region, row in zip(regions, self.offline[ns]["regions"]):
                self.assertEqual([region.class_name, region.first, region.last],
                                 [row["class"], int(row["first"]), int(row["last"])], ns)
                self.assertAlmostEqual(region.confidence, float(row["confidence"]), places=4)

    def test_stamps_and_frames(self):
        for ns in PLACES:
            for topic in ("words", "word_matches", "semantic_regions"):
                stamps = [m.header.stamp for m in self.heard[ns, topic].messages]
                self.assertEqual(stamps, sorted(stamps), (ns, topic))
                self.assertEqual({m.header.frame_id for m in self.heard[ns, topic].messages}, {"odom"})

    def test_what_rviz_shows(self):
        for ns in PLACES:
            arrays = self.heard[ns, "word_markers"].messages
            self.assertTrue(arrays, ns)
            last = {m.ns: m for m in arrays[-1].markers}
            self.assertGreaterEqual(set(last), {"classes", "kinds", "matches", "regions", "words"}, ns)
            for name in ("classes", "matches", "regions"):
                self.assertEqual(len(last[name].points), len(last[name].colors), ns)


if __name__ == "__main__":
    rospy.init_node("words_bag_test")
    rostest.rosrun("hyselam_bringup", "words_bag_test", WordsBagTest)
