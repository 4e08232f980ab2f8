#!/usr/bin/env python3
"""Densities, odometry, files and parameters that are not as they should be, and the services: the text says what it
cannot use, stays alive, and goes on. Runs and corpora: what was written before is recognised later."""
import copy
import math
import os
import sys
import tempfile
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from hyselam_msgs.msg import FsdObservation, SemanticRegionArray, WordArray, WordMatchArray
from hyselam_msgs.srv import CorpusPath
from nodelet.srv import NodeletList, NodeletUnload
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

sys.dont_write_bytecode = True
from localization_rig import WAIT, Listener, LogReader, load_nodelet, newest_status, take_in, values_of, wait_until

NAN = float("nan")
# Density, length [0.1 m] and turn of the stretches of a circuit.
CIRCUIT = [(0.31, 60, 0), (0.56, 25, 1.57), (0.31, 40, 0), (0.44, 20, 0), (0.31, 50, 0), (0.56, 28, 1.57),
           (0.19, 70, 0), (0.69, 30, 1.57), (0.31, 30, 0), (0.44, 15, 0), (0.31, 45, 0), (0.56, 22, 1.57)]
LAP = sum(length for _, length, _ in CIRCUIT)


class Rig(LogReader):
    """One Words nodelet in a namespace of its own, fed by hand."""

    def __init__(self, name, **params):
        self.read_log()
        self.name, self.node = name, f"/{name}/words"
        self.pose, self.steps, self.sent = (0.0, 0.0, 0.0), 0, 0
        self.stamp = 100.0
        settings = dict(levels=2, min_n=[5, 8], diagnostic_period=0.05, save_period=0.0)
        settings.update(params)
        for key, value in settings.items():
            rospy.set_param(f"{self.node}/{key}", value)
        self.publisher = rospy.Publisher(f"/{name}/fsd_observation", FsdObservation, queue_size=10000)
        self.words = Listener(f"/{name}/words", WordArray)
        self.matches = Listener(f"/{name}/word_matches", WordMatchArray)
        self.regions = Listener(f"/{name}/semantic_regions", SemanticRegionArray)
        self.diagnostics = Listener(f"/{name}/diagnostics", DiagnosticArray)
        self.loaded = self.load()
        if self.loaded:
            wait_until(lambda: self.publisher.get_num_connections() > 0
                       and self.words.subscriber.get_num_connections() > 0
                       and self.matches.subscriber.get_num_connections() > 0, "the nodelet does not listen")

    def load(self):
        return load_nodelet("ngram_slam/Words", self.node, {"/diagnostics": f"/{self.name}/diagnostics"})

    def unload(self):
        if self.loaded:
            rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)(self.node)
            self.loaded = False

    def close(self):
        self.unload()
        for listener in (self.words, self.matches, self.regions, self.diagnostics):
            listener.close()
        self.publisher.unregister()

    def observation(self):
        """The next one along the circuit."""
        at = self.steps % LAP
        for density, length, turn in CIRCUIT:
            if at < length:
                break
            at -= length
        x, y, theta = self.pose
        theta += turn / length
        self.pose = (x + 0.1 * math.cos(theta), y + 0.1 * math.sin(theta), math.remainder(theta, 2 * math.pi))
        self.steps += 1
        self.stamp += 0.2
        msg = FsdObservation()
        msg.header.stamp = rospy.Time.from_sec(self.stamp)
        msg.header.frame_id = "odom"
        msg.base_in_odom.x, msg.base_in_odom.y, msg.base_in_odom.theta = self.pose
        msg.kernel_names = ["gaussian", "uniform"]
        msg.bandwidths = [2.5, 2.5]
        msg.soft = [0.9, density + 0.005 * math.sin(self.steps)]
        msg.hard = [NAN, NAN]
        msg.upper = [1.0, 1.0]
        msg.gradient_direction = [NAN, NAN]
        msg.frontiers = [2, 2]
        return msg

    def feed(self, count, change=None):
        for _ in range(count):
            msg = self.observation()
            if change:
                change(msg)
            self.publisher.publish(msg)
            self.sent += 1
        wait_until(lambda: self.value("observations received") == str(self.sent),
                   lambda: f"sent {self.sent}, {self.values()}")
        take_in([self.words, self.matches, self.regions])

    def values(self):
        status = newest_status(self.diagnostics, lambda name: name.startswith(self.node[1:] + ":"))
        return dict(values_of(status), level=status.level, message=status.message) if status else {}

    def value(self, key):
        return self.values().get(key)

    def call(self, service, kind, *args):
        rospy.wait_for_service(f"{self.node}/{service}", WAIT)
        return rospy.ServiceProxy(f"{self.node}/{service}", kind)(*args)

    def all(self, listener, field):
        return [item for message in listener.messages for item in getattr(message, field)]


class WordsInputTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def rig(self, name=None, **params):
        rig = Rig(name or self._testMethodName, **params)
        self.addCleanup(rig.close)
        return rig

    def assert_refused(self, change, *words):
        """An observation changed like this is refused with these words; the next good one is used."""
        rig = self.rig()
        rig.feed(30)
        rig.feed(1, change)
        self.assertEqual(rig.value("dropped: refused"), "1")
        self.assertEqual(rig.value("observations used"), "30")
        for word in words:
            self.assertIn(word, rig.value("last dropped"))
        rig.wait_said("observation dropped", *words, level=Log.WARN)
        rig.feed(LAP)
        self.assertEqual(rig.value("observations dropped"), "1")
        self.assertEqual(rig.value("runs"), "1")
        self.assertGreater(int(rig.value("words")), 8)

    # Densities and poses that say nothing.

    def test_nan_density(self):
        self.assert_refused(lambda m: m.soft.__setitem__(1, NAN), "soft density", "nan")

    def test_density_above_one(self):
        self.assert_refused(lambda m: m.soft.__setitem__(1, 1.5), "soft density", "1.5")

    def test_nan_pose(self):
        self.assert_refused(lambda m: setattr(m.base_in_odom, "y", NAN), "base_in_odom", "not finite")

    def test_no_stamp(self):
        self.assert_refused(lambda m: setattr(m.header, "stamp", rospy.Time(0)), "no stamp")

    def test_wrong_frame(self):
        self.assert_refused(lambda m: setattr(m.header, "frame_id", "map"), "'map'", "'odom'")

    def test_arrays_of_unequal_lengths(self):
        self.assert_refused(lambda m: m.frontiers.pop(), "unequal lengths")

    def test_no_such_kernel(self):
        self.assert_refused(lambda m: m.bandwidths.__setitem__(1, 5.0), "no uniform kernel of 2.5")

    def test_stamp_a_little_back(self):
        self.assert_refused(lambda m: setattr(m.header, "stamp", m.header.stamp - rospy.Duration(1.0)), "not later")

    # Breaks of the run.

    def test_time_going_back_starts_a_run(self):
        rig = self.rig()
        rig.feed(100)
        rig.stamp -= 15.0
        rig.feed(100)
        self.assertEqual((rig.value("time went back"), rig.value("runs")), ("1", "2"))
        self.assertEqual(rig.value("observations dropped"), "0")
        rig.wait_said("time went back", "new run", level=Log.WARN)

    def test_jump_of_the_odometry_starts_a_run(self):
        rig = self.rig()
        rig.feed(100)
        rig.pose = (50.0, 50.0, 0.0)
        rig.feed(100)
        self.assertEqual((rig.value("odometry jumps"), rig.value("runs")), ("1", "2"))
        rig.wait_said("the run ends", "jumped")
        words = rig.all(rig.words, "words")
        self.assertFalse([w for w in words if w.run == 0 and w.end_in_odom.x > 40])

    def test_standing_still_writes_nothing(self):
        rig = self.rig()
        rig.feed(50)
        pose = copy.copy(rig.pose)
        for _ in range(100):
            rig.pose = pose
            rig.steps -= 1
            rig.feed(1, lambda m: (setattr(m.base_in_odom, "x", pose[0]), setattr(m.base_in_odom, "y", pose[1])))
        self.assertEqual(rig.value("observations used"), "150")
        self.assertLessEqual(int(rig.value("observations")), 51)

    # Runs and corpora.

    def test_a_place_is_recognised_in_a_later_run_and_life(self):
        corpus = self.path("life.corpus")
        rig = self.rig("first_life", corpus=corpus)
        rig.feed(LAP)
        self.assertEqual(rig.all(rig.matches, "matches"), [])
        self.assertTrue(rig.call("start_run", Trigger).success)
        rig.pose = (3.0, -4.0, 2.0)
        rig.feed(LAP)
        wait_until(lambda: rig.all(rig.matches, "matches"), "no match with the run before")
        match = rig.all(rig.matches, "matches")[-1]
        self.assertEqual((match.run_newer, match.run_older), (1, 0))
        self.assertGreaterEqual(match.n, 5)
        self.assertGreater(match.stamp_newer, match.stamp_older)
        answer = rig.call("save", CorpusPath, "")
        self.assertTrue(answer.success, answer.message)
        observations, words = rig.value("observations"), rig.value("words")
        rig.close()
        self.assertTrue(os.path.getsize(corpus) > 10000)
        second = self.rig("second_life", corpus=corpus)
        wait_until(lambda: second.value("observations") == observations, lambda: str(second.values()))
        # The last region of the run has become a word.
        self.assertEqual(int(second.value("words")), int(words) + 1)
        second.pose = (30.0, 0.0, 1.0)
        second.stamp = 10000.0
        second.feed(LAP)
        wait_until(lambda: {m.run_older for m in second.all(second.matches, "matches")} >= {0, 1}, "no matches")
        second.unload()
        third = self.rig("third_life", corpus=corpus)
        wait_until(lambda: third.value("runs") == "3", lambda: str(third.values()))

    def test_it_saves_now_and_then(self):
        corpus = self.path("period.corpus")
        rig = self.rig(corpus=corpus, save_period=0.2)
        rig.feed(100)
        wait_until(lambda: rig.value("observations saved") == rig.value("observations") != "0", lambda: str(rig.values()))
        self.assertTrue(os.path.exists(corpus))

    def test_save_and_load_another_file(self):
        rig = self.rig()
        rig.feed(LAP)
        self.assertTrue(rig.call("save", CorpusPath, self.path("copy.corpus")).success)
        other = self.rig("other_robot")
        other.feed(50)
        self.assertTrue(other.call("load", CorpusPath, self.path("copy.corpus")).success)
        wait_until(lambda: other.value("observations") == rig.value("observations"), lambda: str(other.values()))
        other.feed(LAP)
        self.assertEqual(other.value("runs"), "2")

    def test_files_that_cannot_be_used_change_nothing(self):
        rig = self.rig()
        rig.feed(100)
        with open(self.path("broken.corpus"), "wb") as file:
            file.write(b"NGRAMTXT and then nonsense")
        before = rig.value("observations")
        for service, path, words in (("load", self.path("missing.corpus"), "does not exist"),
                                     ("load", self.path("broken.corpus"), "broken.corpus"),
                                     ("load", "", "no path"), ("save", "", "no path"),
                                     ("save", self.path("no/such/folder.corpus"), "folder.corpus")):
            answer = rig.call(service, CorpusPath, path)
            self.assertFalse(answer.success, (service, path))
            self.assertIn(words, answer.message)
        rig.feed(100)
        self.assertEqual(int(rig.value("observations")), int(before) + 100)
        self.assertEqual(rig.value("runs"), "1")

    # Parameters.

    def assert_not_loaded(self, *words, **params):
        rig = self.rig(**params)
        self.assertFalse(rig.loaded)
        rig.wait_said("not loaded", *words, level=Log.FATAL)
        self.assertNotIn(rig.node, rospy.ServiceProxy("/manager/list", NodeletList)().nodelets)
        self.assertEqual(rig.publisher.get_num_connections(), 0)

    def test_broken_corpus(self):
        path = self.path("life2.corpus")
        with open(path, "wb") as file:
            file.write(b"NGRAMTXT and then nonsense")
        self.assert_not_loaded("life2.corpus", corpus=path)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), b"NGRAMTXT and then nonsense")

    def test_corpus_in_a_missing_folder(self):
        self.assert_not_loaded("corpus", "existing folder", "work_dir", corpus=self.path("no/such/c.corpus"))

    def test_parameter_out_of_range(self):
        self.assert_not_loaded("step", "0", step=0.0)

    def test_parameter_of_the_wrong_type(self):
        self.assert_not_loaded("levels", "many", levels="many")

    def test_min_n_for_other_levels(self):
        self.assert_not_loaded("min_n", "one per level, 2", min_n=[5, 8, 11])

    def test_look_back_without_scans(self):
        self.assert_not_loaded("look_back", "input is scan", look_back=2.5)

    def test_unknown_word(self):
        self.assert_not_loaded("word_density", "soft", "full", word_density="hard")

    def test_misspelt_parameter(self):
        rig = self.rig(size_tolerence=0.2)
        self.assertTrue(rig.loaded)
        rig.wait_said("size_tolerence", "did you mean", "size_tolerance", level=Log.WARN)


if __name__ == "__main__":
    rospy.init_node("words_input_test")
    rostest.rosrun("hyselam_bringup", "words_input_test", WordsInputTest)
