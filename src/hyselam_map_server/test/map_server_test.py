#!/usr/bin/env python3
"""The map server as node and as nodelet: what it publishes, and what a broken file does to it."""
import unittest

import rospy
import rostest
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from nodelet.srv import NodeletList, NodeletLoad

try:
    from nav_msgs.srv import LoadMap, LoadMapResponse
except ImportError:
    LoadMap = None

# tiny.pgm is drawn from the top, maps are counted from the bottom.
CELLS = [-1, 0, 100, 100, 0, 0]


class MapServerTest(unittest.TestCase):
    def service(self, name, kind):
        rospy.wait_for_service(name, 90)
        return rospy.ServiceProxy(name, kind)

    def test_topics_and_service_agree(self):
        grid = rospy.wait_for_message("map", OccupancyGrid, 90)
        info = rospy.wait_for_message("map_metadata", MapMetaData, 90)
        served = self.service("static_map", GetMap)().map
        self.assertEqual(list(grid.data), CELLS)
        self.assertEqual((grid.info.width, grid.info.height, grid.header.frame_id), (3, 2, "map"))
        self.assertEqual((info.origin.position.x, info.origin.position.y), (-1.0, 2.0))
        self.assertEqual(served.data, grid.data)

    @unittest.skipIf(LoadMap is None, "nav_msgs before 1.13.1 has no LoadMap")
    def test_a_map_that_cannot_be_loaded_changes_nothing(self):
        change = self.service("change_map", LoadMap)
        for name, result in (("no_image.yaml", LoadMapResponse.RESULT_INVALID_MAP_DATA),
                             ("nowhere.yaml", LoadMapResponse.RESULT_MAP_DOES_NOT_EXIST)):
            self.assertEqual(change(rospy.get_param("~data") + "/" + name).result, result)
        self.assertEqual(list(self.service("static_map", GetMap)().map.data), CELLS)
        self.assertEqual(change(rospy.get_param("~data") + "/tiny.yaml").result,
                         LoadMapResponse.RESULT_SUCCESS)

    def test_broken_input_stops_the_nodelet_but_not_its_manager(self):
        load = self.service("manager/load_nodelet", NodeletLoad)

        def loads(name):
            try:
                return load(name, "hyselam_map_server/MapServer", ["/map"], ["/floor_map"], [], "").success
            except rospy.ServiceException:
                return False

        self.assertFalse(loads("/broken"), "image is missing")
        self.assertFalse(loads("/nameless"), "frame is empty")
        self.assertFalse(loads("/unset"), "no file is given")
        self.assertEqual(list(self.service("manager/list", NodeletList)().nodelets), [])
        self.assertTrue(loads("/good"))
        grid = rospy.wait_for_message("floor_map", OccupancyGrid, 90)
        self.assertEqual((list(grid.data), grid.header.frame_id), (CELLS, "floor"))


if __name__ == "__main__":
    rospy.init_node("map_server_test")
    rostest.rosrun("hyselam_map_server", "map_server_test", MapServerTest)
