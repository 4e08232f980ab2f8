#!/usr/bin/env python3
"""Scans, transforms and clocks that are not as they should be: the localisation says so, counts it, stays
alive, and goes on as soon as it can. Nothing is published on a guess."""
import copy
import math
import sys

import rospy
import rostest
from rosgraph_msgs.msg import Log
from tf2_msgs.msg import TFMessage

sys.dont_write_bytecode = True
from localization_rig import Rig, RigCase, wait_until

NAN, INF = float("nan"), float("inf")


class LocalizationInputTest(RigCase):
    def rig(self, kind="Localization", **params):
        rig = super().rig(kind, **params)
        self.assertTrue(rig.loaded)
        return rig

    def guided(self, **params):
        """A rig that was told where the robot is and has seen a few scans."""
        rig = self.rig(**params)
        rig.use_map()
        rig.initialpose.publish(self.run_.truth_pose(1.0))
        rig.wait_said("initial pose x")
        rig.feed(40)
        self.assertLess(rig.error()[0], 0.3)
        return rig

    def assert_on_track(self, rig):
        distance, angle = rig.error()
        self.assertLess(distance, 0.3)
        self.assertLess(angle, 10.0)
        self.assertTrue(rig.status.messages[-1].converged, rig.status.messages[-1].text)

    def assert_refused(self, change, *words):
        """A scan changed like this is refused with these words; the next good one is used."""
        rig = self.guided()
        used, last = int(rig.value("scans used")), self.run_.scans[39].header.stamp  # guided() has fed 40
        rig.feed(1, change)
        self.assertEqual(int(rig.value("scans used")), used)
        self.assertEqual(rig.value("dropped: refused"), "1")
        for word in words:
            self.assertIn(word, rig.value("last dropped"))
        rig.wait_said("scan dropped", *words, level=Log.WARN)
        self.assertTrue(all(pose.header.stamp <= last for pose in rig.poses.messages))
        rig.feed(30)
        self.assert_on_track(rig)

    # Scans that say nothing.

    def test_scan_without_ranges(self):
        self.assert_refused(lambda s: setattr(s, "ranges", []), "no ranges")

    def test_scan_with_nan_angle(self):
        self.assert_refused(lambda s: setattr(s, "angle_min", NAN), "not finite")

    def test_scan_with_zero_increment(self):
        self.assert_refused(lambda s: setattr(s, "angle_increment", 0.0), "angle_increment is 0")

    def test_scan_with_limits_in_the_wrong_order(self):
        self.assert_refused(lambda s: setattr(s, "range_max", 0.01), "range_max")

    def test_scan_without_frame(self):
        self.assert_refused(lambda s: setattr(s.header, "frame_id", ""), "frame_id")

    def test_scan_without_stamp(self):
        self.assert_refused(lambda s: setattr(s.header, "stamp", rospy.Time(0)), "no stamp")

    def test_scan_stamped_as_the_one_before(self):
        before = self.run_.scans[39].header.stamp  # guided() has fed 40
        self.assert_refused(lambda s: setattr(s.header, "stamp", before), "not later")

    def test_scans_of_nan_and_inf_are_survived(self):
        """They are valid messages: nothing was seen, and nothing is learnt from them."""
        rig = self.guided()
        for value in (NAN, INF, -INF, -1.0, 0.0):
            rig.feed(4, lambda s, v=value: setattr(s, "ranges", [v] * len(s.ranges)))
        self.assertEqual(rig.value("scans dropped"), "0")
        rig.feed(30)
        self.assert_on_track(rig)

    # Where the laser and the robot are.

    def test_missing_odometry_transform(self):
        # Long enough that the transforms that do come later are not late on a busy machine.
        rig = self.rig(transform_wait=0.3)
        rig.use_map()
        rig.feed(3, with_tf=False)
        self.assertEqual(rig.value("dropped: no transform"), "3")
        rig.wait_said("no transform", "odom -> base_link", level=Log.WARN)
        self.assertEqual((rig.poses.messages, rig.odom_in_map()), ([], []))
        self.assertGreater(rig.fresh_diagnosis().level, 0)
        while self.run_.scans[rig.next].header.stamp.to_sec() <= Rig.now:  # the clock went on meanwhile
            rig.next += 1
        rig.feed(5)
        self.assertEqual(rig.value("scans used"), "5")

    def test_unknown_laser_frame(self):
        rig = self.guided(transform_wait=0.3)
        last = self.run_.scans[39].header.stamp
        Rig.tf.publish(rig.odometry_of_next())  # so that only the laser's frame is missing
        for early in (0.003, 0.002, 0.001):
            scan = copy.deepcopy(self.run_.scans[rig.next])
            scan.header.frame_id = "nowhere"
            scan.header.stamp -= rospy.Duration(early)
            rig.send(scan)
        rig.settle(tick=0.02)
        self.assertEqual(rig.value("dropped: no transform"), "3")
        rig.wait_said("no transform", "base_link -> nowhere", level=Log.WARN)
        self.assertTrue(all(pose.header.stamp <= last for pose in rig.poses.messages))
        rig.feed(30)
        self.assert_on_track(rig)

    def test_transform_that_comes_late_is_waited_for(self):
        rig = self.guided()
        scan = self.run_.scans[rig.next]
        late = rig.odometry_of_next()
        rig.set_clock(scan.header.stamp.to_sec())
        rig.send(scan)
        rig.wait_value("scans waiting", 1)
        Rig.tf.publish(late)
        rig.settle()
        self.assertEqual(rig.value("scans dropped"), "0")

    def lay_laser(self, name, roll=0.0, yaw=0.0):
        """Another laser frame at the place of the first one."""
        t = copy.deepcopy(self.run_.static[0])
        t.child_frame_id = name
        q = t.transform.rotation
        # yaw, then roll about the new x axis
        q.x, q.y, q.z, q.w = (math.cos(yaw / 2) * math.sin(roll / 2), math.sin(yaw / 2) * math.sin(roll / 2),
                              math.sin(yaw / 2) * math.cos(roll / 2), math.cos(yaw / 2) * math.cos(roll / 2))
        Rig.tf_static.publish(TFMessage(self.run_.static + [t]))

    def test_laser_that_hangs_upside_down(self):
        rig = self.guided()
        self.lay_laser("hanging", roll=math.pi)

        def hang(scan):
            scan.header.frame_id = "hanging"
            scan.ranges = scan.ranges[::-1]
        rig.feed(120, hang)
        self.assert_on_track(rig)

    def test_laser_that_looks_backwards(self):
        rig = self.guided()
        self.lay_laser("backwards", yaw=math.pi)

        def turn(scan):  # sees the same: its zero points to the robot's back
            scan.header.frame_id = "backwards"
            scan.angle_min -= math.pi
            scan.angle_max -= math.pi
        rig.feed(120, turn)
        self.assert_on_track(rig)

    def test_laser_on_its_side_is_refused(self):
        rig = self.guided()
        self.lay_laser("on_its_side", roll=math.pi / 2)
        rig.feed(1, lambda s: setattr(s.header, "frame_id", "on_its_side"))
        self.assertIn("not horizontal", rig.value("last dropped"))
        rig.feed(30)
        self.assert_on_track(rig)

    def test_laser_geometry_that_changes(self):
        rig = self.guided()

        def thin_out(scan):  # every second beam of the left two thirds
            scan.ranges = scan.ranges[60::2]
            scan.angle_min += 60 * scan.angle_increment
            scan.angle_increment *= 2
            scan.range_max = 20.0
        rig.feed(120, thin_out)
        self.assertEqual((rig.value("laser changed"), rig.value("scans dropped")), ("1", "0"))
        rig.wait_said("the laser changed", "61 beams", "181 beams", level=Log.WARN)
        self.assert_on_track(rig)

    # Time.

    def test_bag_that_loops(self):
        rig = self.guided()
        particles = rig.status.messages[-1].particles
        end = rig.next
        rig.feed(10)
        rig.next = 0
        jumped = len(rig.poses.messages)
        rig.set_clock(0.6)
        rig.wait_said("time went back", "clock", level=Log.WARN)
        told = len(rig.odom_in_map())
        rig.feed(1)
        # Odometry begins again where it began, and so does the robot: hardly moved in this time.
        self.assertEqual(rig.value("time went back"), "1")
        wait_until(lambda: len(rig.poses.messages) > jumped, "the first scan after it is an update")
        self.assertEqual(rig.status.messages[-1].particles, particles, "the particles are kept")
        self.assertEqual(rig.value("scans dropped"), "0")
        self.assertTrue(all(s < 2.0 for s, _ in rig.odom_in_map()[told:]), "no transform of the old time")
        rig.feed(end)
        self.assertEqual(rig.value("scans dropped"), "0")
        self.assertEqual(rig.value("time went back"), "1")

    def test_stamps_that_go_back_without_clock(self):
        rig = self.guided()
        scan = copy.deepcopy(self.run_.scans[0])
        rig.send(scan)  # 4 s older than the last one; the clock stays
        rig.wait_said("time went back", "stamps of the scans", level=Log.WARN)
        rig.wait_value("time went back", 1)

    def test_two_clocks_that_fight(self):
        """Each jump counts, and one line tells of the first."""
        rig = self.guided()
        now = rig.now
        for jump in range(1, 6):
            rig.set_clock(now + 5.0)
            rig.fresh_diagnosis()
            rig.set_clock(now)
            rig.wait_value("time went back", jump)
        rig.wait_said("time went back", level=Log.WARN)
        told = [m.msg for m in rig.log.messages[rig.logged_before:] if "time went back" in m.msg]
        self.assertEqual(len(told), 1, told)

    # The density nodelet takes its scans the same way.

    def test_fsd_observes_by_distance(self):
        rig = self.rig("Fsd", update_min_d=0.25)
        rig.feed(120)
        seen = rig.observations.messages
        self.assertGreater(len(seen), 5)
        for a, b in zip(seen, seen[1:]):
            step = math.hypot(b.base_in_odom.x - a.base_in_odom.x, b.base_in_odom.y - a.base_in_odom.y)
            self.assertGreaterEqual(step, 0.25)
            self.assertLess(step, 0.25 + 0.2)
        last = seen[-1]
        self.assertEqual((last.header.frame_id, list(last.bandwidths)), ("odom", [1.5, 3.0, 5.0]))
        self.assertEqual(last.kernel_names, ["uniform"] * 3)
        for soft, hard, upper in zip(last.soft, last.hard, last.upper):
            self.assertTrue(0.0 <= soft <= upper <= 1.0)
            self.assertTrue(math.isnan(hard) or hard == soft)
        self.assertGreater(last.travelled, 0.25 * (len(seen) - 1))

    def test_fsd_refuses_and_goes_on(self):
        rig = self.rig("Fsd")
        rig.feed(30)
        rig.feed(1, lambda s: setattr(s, "ranges", []))
        self.assertEqual(rig.value("dropped: refused"), "1")
        seen = len(rig.observations.messages)
        rig.feed(40)
        self.assertGreater(len(rig.observations.messages), seen)

    def test_fsd_starts_afresh_when_time_goes_back(self):
        rig = self.rig("Fsd")
        rig.feed(60)
        self.assertGreater(rig.observations.messages[-1].travelled, 0.2)
        rig.next = 0
        rig.set_clock(0.6)
        rig.wait_said("time went back")
        seen = len(rig.observations.messages)
        rig.feed(1)
        self.assertEqual(rig.observations.wait(seen + 1).travelled, 0.0)


if __name__ == "__main__":
    rospy.init_node("localization_input_test")
    rostest.rosrun("hyselam_bringup", "localization_input_test", LocalizationInputTest)
