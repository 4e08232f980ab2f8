#!/usr/bin/env python3
"""What people and other nodes ask of the localisation: maps, initial poses, services, parameters. Every
request that cannot be met is refused with a reason and changes nothing."""
import math
import sys

import rospy
import rostest
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse, SetMap
from nodelet.srv import NodeletList
from rosgraph_msgs.msg import Log
from std_srvs.srv import Empty

sys.dont_write_bytecode = True
from localization_rig import WAIT, Listener, Rig, RigCase, make_map, planar, wait_until

NAN = float("nan")


def turned(grid, yaw):
    """The same cells with an origin turned by `yaw` about the map frame's zero."""
    x, y = grid.info.origin.position.x, grid.info.origin.position.y
    c, s = math.cos(yaw), math.sin(yaw)
    return make_map(grid.data, grid.info.width, grid.info.height, grid.info.resolution, c * x - s * y, s * x + c * y, yaw)


class LocalizationControlTest(RigCase):
    def started(self, scans=40, **params):
        """A rig with its map and a few scans, that nobody told where the robot is."""
        rig = self.rig(**params)
        self.assertTrue(rig.loaded)
        rig.use_map()
        rig.feed(scans)
        return rig

    def call(self, rig, service, kind, *args):
        name = f"/{rig.name}/{service}"
        rospy.wait_for_service(name, WAIT)
        return rospy.ServiceProxy(name, kind)(*args)

    def last_status(self, rig):
        return rig.status.messages[-1]

    # Maps.

    def test_late_map(self):
        rig = self.rig()
        rig.feed(5)
        self.assertEqual(rig.value("dropped: no map"), "5")
        self.assertIn("waiting for a map", rig.fresh_diagnosis().message)
        rig.wait_said("scan dropped", "no map", level=Log.WARN)
        self.assertEqual((rig.poses.messages, rig.odom_in_map()), ([], []))
        rig.use_map()
        rig.feed(5)
        self.assertEqual((rig.value("scans used"), rig.value("dropped: no map")), ("5", "5"))

    def assert_map_refused(self, grid, *words, **params):
        """Refused with these words, the map before stays in use; a good one is taken afterwards."""
        rig = self.started(scans=10, **params)
        used = int(rig.value("scans used"))
        rig.give_map(grid)
        rig.wait_said("map refused", "the map before stays", *words, level=Log.ERROR)
        self.assertEqual(rig.fresh_diagnosis().level, 2)
        rig.feed(5)
        self.assertEqual(int(rig.value("scans used")), used + 5)
        self.assertEqual(len(rig.fields.messages), 1)
        rig.use_map(turned(self.run_.map, 0.3))
        self.assertLess(rig.fresh_diagnosis().level, 2)

    def test_map_without_cells(self):
        self.assert_map_refused(make_map([], 0, 0, 0.1), "no cells")

    def test_map_with_missing_data(self):
        self.assert_map_refused(make_map([0] * 50, 10, 10, 0.1), "50 cells instead of 10 x 10")

    def test_map_too_large(self):
        self.assert_map_refused(make_map([0] * 5000, 50, 100, 0.1), "max_map_cells", max_map_cells=4999)

    def test_map_that_claims_to_be_huge(self):
        self.assert_map_refused(make_map([0], 4294967295, 4294967295, 0.1), "max_map_cells")

    def test_map_without_resolution(self):
        self.assert_map_refused(make_map([0] * 100, 10, 10, 0.0), "resolution")

    def test_map_with_nan_origin(self):
        self.assert_map_refused(make_map([0] * 100, 10, 10, 0.1, x=NAN), "origin", "not finite")

    def test_map_in_another_frame(self):
        self.assert_map_refused(make_map([0] * 100, 10, 10, 0.1, frame="floor2"), "'floor2'", "'map'")

    def test_map_with_values_outside_the_convention(self):
        self.assert_map_refused(make_map([101] * 100, 10, 10, 0.1), "value 101")

    def test_map_without_free_cells(self):
        self.assert_map_refused(make_map([100] * 2500, 50, 50, 0.1), "free cell")

    def test_map_with_turned_origin(self):
        """The pose lies in the map frame, wherever the cells begin and however they are turned."""
        yaw = 2.0
        rig = self.rig()
        rig.use_map(turned(self.run_.map, yaw))
        self.assertAlmostEqual(planar(rig.fields.messages[-1].info.origin)[2], yaw, places=5)
        rig.feed_until_converged()
        x, y, theta = self.run_.truth_at(rig.poses.messages[-1].header.stamp.to_sec())
        c, s = math.cos(yaw), math.sin(yaw)
        distance, angle = rig.error((c * x - s * y, s * x + c * y, theta + yaw))
        self.assertLess(distance, 0.3)
        self.assertLess(angle, 10.0)

    def test_map_that_is_replaced(self):
        rig = self.started()
        self.assertEqual(rig.fields.messages[-1].info.width, self.run_.map.info.width)
        rig.use_map(make_map([0] * 2500, 50, 50, 0.1))
        self.assertEqual(rig.fields.messages[-1].info.width, 50)
        rig.feed(10)
        x, y, _ = planar(rig.poses.messages[-1].pose.pose)
        self.assertTrue(-1.0 < x < 6.0 and -1.0 < y < 6.0, "on the new map")

    def test_map_that_is_corrected_keeps_the_pose(self):
        rig = self.started(scans=0)
        rig.initialpose.publish(self.run_.truth_pose(1.0))
        rig.wait_said("initial pose x")
        rig.feed(40)
        cells = list(self.run_.map.data)
        cells[0] = 0
        rig.use_map(make_map(cells, self.run_.map.info.width, self.run_.map.info.height, 0.1, -0.5, -0.5))
        rig.feed(20)
        self.assertLess(rig.error()[0], 0.3)
        self.assertTrue(self.last_status(rig).converged)

    def test_same_map_again_changes_nothing(self):
        rig = self.started(scans=20)
        particles, fields = self.last_status(rig), len(rig.fields.messages)
        rig.give_map()
        rig.wait_said("the same map again")
        rig.feed(10)
        self.assertEqual(len(rig.fields.messages), fields)
        self.assertGreater(self.last_status(rig).travelled, particles.travelled)

    def test_first_map_only(self):
        rig = self.started(scans=5, first_map_only=True)
        rig.give_map(make_map([0] * 2500, 50, 50, 0.1))
        rig.wait_said("ignored (first_map_only)")
        rig.feed(5)
        self.assertEqual([f.info.width for f in rig.fields.messages], [self.run_.map.info.width])

    def test_map_from_the_service(self):
        rig = self.rig(use_map_topic=False)
        rig.feed(3)
        self.assertEqual(rig.value("dropped: no map"), "3")
        service = rospy.Service(f"/{rig.name}/static_map", GetMap, lambda _: GetMapResponse(self.run_.map))
        self.addCleanup(service.shutdown)
        rig.fields.wait()
        rig.feed(10)
        self.assertEqual(rig.value("scans used"), "10")

    def test_bad_map_from_the_service(self):
        served = [make_map([], 0, 0, 0.1)]
        service = rospy.Service("/test_bad_map_from_the_service/static_map", GetMap,
                                lambda _: GetMapResponse(served[-1]))
        self.addCleanup(service.shutdown)
        rig = self.rig(use_map_topic=False)
        rig.wait_said("map refused", "service", "no cells", level=Log.ERROR)
        rig.feed(3)
        self.assertEqual(rig.value("dropped: no map"), "3")
        self.assertEqual(rig.fresh_diagnosis().level, 2)
        served.append(self.run_.map)
        rig.fields.wait()
        rig.feed(10)
        self.assertEqual(rig.value("scans used"), "10")

    def test_set_map(self):
        rig = self.started(scans=5)
        grid, pose = turned(self.run_.map, 1.0), self.run_.truth_pose(1.0)
        pose.header.frame_id = "elsewhere"
        self.assertFalse(self.call(rig, "set_map", SetMap, grid, pose).success)
        pose.header.frame_id = "map"
        self.assertFalse(self.call(rig, "set_map", SetMap, make_map([], 0, 0, 0.1), pose).success)
        fields = len(rig.fields.messages)
        self.assertTrue(self.call(rig, "set_map", SetMap, grid, pose).success)
        rig.fields.wait(fields + 1)
        rig.wait_said("initial pose x")

    def test_set_map_without_free_cells(self):
        rig = self.started(scans=5)
        full = make_map([100] * 2500, 50, 50, 0.1)
        self.assertFalse(self.call(rig, "set_map", SetMap, full, self.run_.truth_pose(1.0)).success)
        rig.wait_said("map refused", "free cell", "the map before stays", level=Log.ERROR)
        rig.use_map(turned(self.run_.map, 1.0))
        rig.wait_said("searching the whole map", "a new map")
        self.assertFalse(rig.said("initial pose x"), "the pose went with the map it was given for")

    def test_initial_pose_out_of_the_world(self):
        rig = self.started(scans=5)
        pose = self.run_.truth_pose(1.0)
        pose.pose.pose.position.x = 1e12
        rig.initialpose.publish(pose)
        rig.wait_said("initial pose ignored", "1000 km", level=Log.ERROR)
        rig.feed(5)
        self.assertEqual(rig.value("scans used"), "10")

    # Initial poses.

    def test_initial_pose(self):
        rig = self.started(scans=20)
        self.assertEqual(rig.odom_in_map(), [], "tf is withheld until the pose is known")
        rig.initialpose.publish(self.run_.truth_pose(3.0))
        rig.wait_said("initial pose x")
        rig.feed(20)
        distance, angle = rig.error()
        self.assertLess(distance, 0.3)
        self.assertLess(angle, 10.0)
        self.assertTrue(self.last_status(rig).converged)
        wait_until(lambda: abs(rig.odom_in_map()[-1][0] - Rig.now - 0.1) < 1e-6,
                   lambda: f"dated ahead by transform_tolerance: {rig.odom_in_map()[-1][0] - Rig.now}")
        _, (x, y, theta) = rig.odom_in_map()[-1]
        scan = self.run_.scans[rig.next - 1].header.stamp
        odom = min(self.run_.transforms, key=lambda t: abs((t.header.stamp - scan).to_sec())).transform
        c, s = math.cos(theta), math.sin(theta)
        px, py = x + c * odom.translation.x - s * odom.translation.y, y + s * odom.translation.x + c * odom.translation.y
        tx, ty, _ = self.run_.truth_at(scan.to_sec())
        self.assertLess(math.hypot(px - tx, py - ty), 0.3, "tf leads from the map to the robot")

    def test_initial_pose_before_the_map(self):
        rig = self.rig()
        rig.initialpose.publish(self.run_.truth_pose(1.0))
        rig.wait_said("kept for when a map is ready")
        rig.use_map()
        rig.feed(10)
        self.assertLess(rig.error()[0], 0.3)
        self.assertTrue(self.last_status(rig).converged)

    def test_initial_pose_without_frame_is_taken_as_the_map(self):
        rig = self.started(scans=5)
        pose = self.run_.truth_pose(1.5)
        pose.header.frame_id = ""
        rig.initialpose.publish(pose)
        rig.wait_said("without frame_id", level=Log.WARN)
        rig.feed(10)
        self.assertLess(rig.error()[0], 0.3)

    def assert_pose_ignored(self, change, *words):
        rig = self.started(scans=10)
        particles = self.last_status(rig).particles
        pose = self.run_.truth_pose(1.0)
        change(pose)
        rig.initialpose.publish(pose)
        rig.wait_said("initial pose ignored", *words, level=Log.ERROR)
        rig.feed(10)
        self.assertFalse(self.last_status(rig).converged)
        self.assertEqual(self.last_status(rig).particles, particles)
        self.assertEqual(rig.odom_in_map(), [])

    def test_initial_pose_in_the_wrong_frame(self):
        self.assert_pose_ignored(lambda p: setattr(p.header, "frame_id", "odom"), "'odom'", "'map'")

    def test_initial_pose_with_nan(self):
        self.assert_pose_ignored(lambda p: setattr(p.pose.pose.position, "x", NAN), "not finite")

    def test_initial_pose_with_empty_quaternion(self):
        def change(p):
            p.pose.pose.orientation.z = p.pose.pose.orientation.w = 0.0
        self.assert_pose_ignored(change, "quaternion")

    def test_initial_pose_with_nan_quaternion(self):
        self.assert_pose_ignored(lambda p: setattr(p.pose.pose.orientation, "w", NAN), "quaternion")

    def test_initial_pose_without_covariance(self):
        self.assert_pose_ignored(lambda p: setattr(p.pose, "covariance", [0.0] * 36), "covariance of x", "> 0")

    def test_initial_pose_with_negative_variance(self):
        def change(p):
            p.pose.covariance[35] = -1.0
        self.assert_pose_ignored(change, "covariance of yaw", "> 0")

    def test_initial_pose_with_infinite_variance(self):
        def change(p):
            p.pose.covariance[7] = float("inf")
        self.assert_pose_ignored(change, "covariance of y", "> 0")

    def test_initial_pose_from_parameters(self):
        x, y, theta = self.run_.truth_at(1.0)
        rig = self.started(scans=10, initial_pose_x=x, initial_pose_y=y, initial_pose_a=theta)
        self.assertLess(rig.error()[0], 0.3)
        self.assertTrue(self.last_status(rig).converged)

    def test_pose_is_saved(self):
        rig = self.started(scans=5, save_pose_rate=1000.0)
        rig.initialpose.publish(self.run_.truth_pose(1.5))
        rig.wait_said("initial pose x")
        rig.feed(20)
        for _ in range(4):  # one by one, so that no update comes too soon after the one before to be saved
            rig.feed(1)
        def pose():
            return planar(rig.poses.messages[-1].pose.pose)

        def saved():
            return [rospy.get_param(f"{rig.node}/initial_pose_{k}", math.inf) for k in "xya"]
        wait_until(lambda: all(abs(a - b) < 1e-6 for a, b in zip(pose(), saved())), lambda: f"saved {saved()}, not {pose()}")
        self.assertGreater(rospy.get_param(f"{rig.node}/initial_cov_xx"), 0.0)

    # What is said while nothing is known.

    def test_a_guess_does_not_look_certain(self):
        rig = self.started(scans=20, found_probability=1 - 1e-12)  # the search may suppose the right place by now
        self.assertFalse(self.last_status(rig).converged)
        self.assertEqual(self.last_status(rig).phase, 0)
        covariance = rig.poses.messages[-1].pose.covariance
        self.assertTrue(covariance[0] >= 1.0 and covariance[7] >= 1.0, "[m^2]")
        self.assertEqual(rig.odom_in_map(), [])

    def test_unconverged_tf_on_request(self):
        rig = self.started(scans=20, publish_unconverged_tf=True)
        self.assertFalse(self.last_status(rig).converged)
        self.assertGreater(len(rig.odom_in_map()), 10)

    def test_no_tf_on_request(self):
        rig = self.started(scans=5, tf_broadcast=False, publish_unconverged_tf=True)
        rig.feed(20)
        self.assertEqual(rig.odom_in_map(), [])

    # Services.

    def test_global_localization(self):
        rig = self.started(scans=0)
        rig.initialpose.publish(self.run_.truth_pose(1.0))
        rig.wait_said("initial pose x")
        rig.feed(20)
        self.assertTrue(self.last_status(rig).converged)
        self.call(rig, "global_localization", Empty)
        rig.status.wait()
        rig.wait_said("searching the whole map", "global_localization")
        told = len(rig.odom_in_map())
        rig.feed(5)
        self.assertFalse(self.last_status(rig).converged)
        self.assertEqual(self.last_status(rig).phase, 0)
        self.assertEqual(self.last_status(rig).particles, 20000)
        self.assertEqual(len(rig.odom_in_map()), told, "tf is withheld again")
        self.assertFalse(rig.odom_in_map() == [])

    def test_global_localization_without_map(self):
        rig = self.rig()
        self.call(rig, "global_localization", Empty)
        rig.use_map()
        rig.feed(3)
        self.assertEqual(rig.value("scans used"), "3")

    def test_update_without_motion(self):
        # An answer of the search is an update, too: it counts after the test.
        rig = self.started(scans=1, update_min_d=100.0, update_min_a=100.0, search_latency=60.0)
        rig.poses.wait()
        self.assertEqual(len(rig.poses.messages), 1)
        rig.feed(10)
        self.assertEqual(rig.value("updates"), "1")
        self.call(rig, "request_nomotion_update", Empty)
        rig.feed(5)
        self.assertEqual(rig.value("updates"), "2")

    # Parameters.

    def assert_not_loaded(self, name, value, *words, kind="Localization"):
        rig = self.rig(kind, **{name: value})
        self.assertFalse(rig.loaded)
        rig.wait_said("not loaded", name.rstrip("s"), *words, level=Log.FATAL)
        alive = rospy.ServiceProxy("/manager/list", NodeletList)()
        self.assertEqual(list(alive.nodelets), [], "the manager lives on")
        self.assertEqual(rig.scan.get_num_connections(), 0, "nothing was subscribed")

    def test_parameter_out_of_range(self):
        self.assert_not_loaded("laser_z_hit", 1.5, "1.5", "in [1e-06, 1]")

    def test_parameter_of_the_wrong_type(self):
        self.assert_not_loaded("max_particles", "many", "'many'", "a whole number")

    def test_parameter_with_nan(self):
        self.assert_not_loaded("odom_alpha1", NAN, "nan", ">= 0")

    def test_parameter_with_an_unknown_word(self):
        self.assert_not_loaded("model", "lidar", "'lidar'", "fsd, beam, cosine, likelihood, hybrid")

    def test_parameters_that_contradict_each_other(self):
        self.assert_not_loaded("hypothesis_particles", 10, ">= tracking_particles")

    def test_frame_that_is_empty(self):
        self.assert_not_loaded("odom_frame_id", "", "name of a frame")

    def test_frames_that_are_the_same(self):
        self.assert_not_loaded("global_frame_id", "odom", "another frame")

    def test_cache_folder_that_does_not_exist(self):
        self.assert_not_loaded("cache_dir", "/nowhere/at/all", "existing folder")

    def test_fsd_kernel_larger_than_the_local_map(self):
        self.assert_not_loaded("bandwidths", [20.0], "20", "smaller than the local map", kind="Fsd")

    def test_fsd_list_with_a_word(self):
        self.assert_not_loaded("bandwidths", [1.5, "wide"], "list of at least 1", kind="Fsd")

    def test_unknown_parameter(self):
        rig = self.rig(max_partcles=3000)
        self.assertTrue(rig.loaded)
        rig.wait_said("unknown parameter", "max_partcles", "did you mean 'max_particles'", level=Log.WARN)

    def test_parameters_of_amcl_without_effect(self):
        rig = self.rig(resample_interval=2, odom_model_type="diff-corrected", laser_z_short=0.1)
        self.assertTrue(rig.loaded)
        rig.wait_said("resample_interval", "no effect", level=Log.WARN)
        rig.wait_said("odom_model_type", "no effect", level=Log.WARN)
        self.assertFalse(rig.said("unknown parameter"))


if __name__ == "__main__":
    rospy.init_node("localization_control_test")
    rostest.rosrun("hyselam_bringup", "localization_control_test", LocalizationControlTest)
