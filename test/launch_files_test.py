#!/usr/bin/env python3
"""Every launch file of the stack can be started: it is found by name, its arguments resolve, its programs
and nodelet classes exist, and the packages that it uses are declared by the bringup."""
import itertools
import os
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from unittest import mock

import rospkg
import rostest
import roslaunch.config
from catkin_pkg.package import parse_package
from roslaunch.rlutil import resolve_launch_arguments
from roslib.packages import find_node

PACKAGE = "hyselam_bringup"
# Required arguments; the files need not exist to resolve a launch file.
ARGUMENTS = ["bag:=/nowhere/x.bag", "map:=/nowhere/x.yaml"]
# The layers that hyselam.launch can switch.
LAYERS = ["fsd", "words", "places", "dialogue", "vision", "objects"]


def nodelet_classes():
    """Class names that the packages of the environment declare to pluginlib for nodelet."""
    packages, names = rospkg.RosPack(), set()
    for package in packages.list():
        folder = packages.get_path(package)
        for export in packages.get_manifest(package).exports:
            if export.tag == "nodelet" and export.get("plugin"):
                path = export.get("plugin").replace("${prefix}", folder)
                if os.path.exists(path):
                    names |= {c.get("name") for c in ElementTree.parse(path).getroot().iter("class")}
    return names


class LaunchFilesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = os.path.join(rospkg.RosPack().get_path(PACKAGE), "launch")
        cls.files = sorted(f for f in os.listdir(cls.folder) if f.endswith(".launch"))
        # What roscore adds asks two programs for the version of ROS, each of some hundred times.
        roscore = mock.patch("roslaunch.config.load_roscore")
        roscore.start()
        cls.addClassCleanup(roscore.stop)

    def configurations(self):
        """The configuration of each file: alone, and in a manager where it takes one."""
        for name in self.files:
            with open(os.path.join(self.folder, name)) as file:
                taken = {a.get("name") for a in ElementTree.parse(file).getroot().findall("arg")}
            base = [a for a in ARGUMENTS if a.split(":=")[0] in taken]
            variants = [base] + ([base + ["manager:=m"]] if "manager" in taken else [])
            found = resolve_launch_arguments([PACKAGE, name])[0]
            for arguments in variants:
                yield name, roslaunch.config.load_config_default([(found, arguments)], None, verbose=False)

    def test_the_plugins_for_rviz_have_the_qt_of_rviz(self):
        libraries = [os.path.join(p, "lib/libhyselam_rviz_plugins.so") for p in os.environ["CMAKE_PREFIX_PATH"].split(":")]
        libraries = [path for path in libraries if os.path.exists(path)]
        if not libraries:
            self.skipTest("the plugins were not built")
        needed = subprocess.run(["ldd", libraries[0]], capture_output=True, text=True, check=True).stdout
        self.assertIn("librviz.so", needed)
        self.assertEqual(len(set(re.findall(r"libQt\d+Core", needed))), 1, needed)

    def whole(self, *arguments, name="hyselam.launch"):
        """What hyselam.launch starts: full name of each node -> its configuration."""
        config = roslaunch.config.load_config_default([(os.path.join(self.folder, name), list(arguments))], None, verbose=False)
        self.assertEqual(config.config_errors, [], arguments)
        nodes = {n.namespace + n.name: n for n in config.nodes}
        self.assertEqual(len(nodes), len(config.nodes), f"{arguments}: two nodes of one name")
        return nodes, config

    def test_every_combination_of_layers(self):
        declared = nodelet_classes()
        poses = (("slam", False), ("localization", True), ("other", True), ("other", False))
        for pose, known in poses:
            for on in itertools.product((False, True), repeat=len(LAYERS)):
                switch = dict(zip(LAYERS, on))
                arguments = [f"pose:={pose}"] + (["map:=/nowhere/x.yaml"] if known else [])
                arguments += [f"{layer}:={str(value).lower()}" for layer, value in switch.items()]
                nodes, _ = self.whole(*arguments)
                expected = {"/hyselam_manager", "/hyselam_manager_keeper"}
                expected |= {"/slam"} if pose == "slam" else set()
                expected |= {"/localization"} if pose == "localization" else set()
                expected |= {"/map_server"} if known and pose != "slam" else set()
                expected |= {"/fsd"} if switch["fsd"] else set()
                expected |= {"/words", "/words_fsd"} if switch["words"] and pose != "slam" else set()
                expected |= {"/gr2to"} if switch["places"] or switch["dialogue"] else set()
                expected |= {"/topo_engine"} if switch["dialogue"] else set()
                expected |= {"/semantic_localization"} if switch["vision"] else set()
                expected |= {"/object_engine"} if switch["objects"] else set()
                self.assertEqual(set(nodes), expected, arguments)
                for name, node in nodes.items():
                    words = node.args.split()
                    if node.type == "nodelet" and words[0] != "manager":
                        # One manager: messages pass between the layers without a copy.
                        self.assertEqual([words[0], words[2]], ["load", "hyselam_manager"], f"{arguments}: {name}")
                        self.assertIn(words[1], declared)

    def test_the_pose_is_chosen_by_the_map(self):
        self.assertIn("/slam", self.whole("rviz:=true")[0])
        self.assertIn("/rviz", self.whole("rviz:=true")[0])
        self.assertIn("/localization", self.whole("map:=/nowhere/x.yaml")[0])

    def test_a_pose_that_there_is_not_is_refused_in_words(self):
        for name in ("hyselam.launch", "demo.launch"):
            done = subprocess.run(["roslaunch", os.path.join(self.folder, name), *ARGUMENTS[:len(ARGUMENTS) * (name == "demo.launch")],
                                   "pose:=amcl"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=180)
            self.assertNotEqual(done.returncode, 0, name)
            self.assertIn("pose is slam, localization or other, not amcl", done.stdout, name)
            self.assertNotIn("started", done.stdout, name)
        told = subprocess.run(["roslaunch", "--ros-args", os.path.join(self.folder, "hyselam.launch")], stdout=subprocess.PIPE,
                              text=True, timeout=180).stdout
        self.assertIn("pose (default", told)
        self.assertNotIn("pose_number", told)

    def test_a_relative_path_is_refused_in_words(self):
        for name, arguments, text in (("hyselam.launch", ["map:=x.yaml"], "map is an absolute path, not x.yaml"),
                                      ("demo.launch", ["bag:=x.bag"], "bag is an absolute path, not x.bag"),
                                      ("two_robots.launch", ["bag:=x.bag"], "bag is an absolute path, not x.bag")):
            done = subprocess.run(["roslaunch", os.path.join(self.folder, name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  text=True, timeout=180)
            self.assertNotEqual(done.returncode, 0, name)
            self.assertIn(text, done.stdout, name)
            self.assertNotIn("started", done.stdout, name)

    def test_the_page_is_started_on_request_with_what_the_layers_read(self):
        self.assertNotIn("/web", self.whole()[0])
        nodes, config = self.whole("web:=true", "scan:=base_scan", "base_frame:=base", "web_port:=9000", "web_host:=0.0.0.0", "web_token_file:=/nowhere/tokens")
        self.assertIn(("scan", "base_scan"), [tuple(r) for r in nodes["/web"].remap_args])
        values = {key: p.value for key, p in config.params.items()}
        self.assertEqual([values["/web/" + name] for name in ("port", "host", "token_file", "base_frame", "map_frame")],
                         [9000, "0.0.0.0", "/nowhere/tokens", "base", "map"])

    def test_what_dies_is_started_again_unless_told_otherwise(self):
        for more, back in (([], True), (["respawn:=false"], False)):
            for pose in ("slam", "localization"):
                nodes, _ = self.whole(f"pose:={pose}", "map:=/nowhere/x.yaml", "vision:=true", "objects:=true", *more)
                self.assertEqual("/hyselam_manager_keeper" in nodes, back)
                self.assertEqual({n.respawn for n in nodes.values()}, {back}, more)
        # A manager that somebody else started is somebody else's.
        self.assertNotIn("/hyselam_manager_keeper", self.whole("start_manager:=false")[0])
        for name in ("fsd.launch", "topo_engine.launch", "words.launch"):
            self.assertEqual({n.respawn for n in self.whole(name=name)[0].values()}, {False}, name)
            self.assertEqual({n.respawn for n in self.whole("respawn:=true", name=name)[0].values()}, {True}, name)

    def test_work_dir_reaches_every_layer(self):
        params = self.whole("work_dir:=/w", "pose:=localization")[1].params
        self.assertEqual(params["/words/corpus"].value, "/w/words.corpus")
        self.assertEqual(params["/topo_engine/state_file"].value, "/w/dialogue.state")
        self.assertEqual(self.whole("work_dir:=/w", "vision:=true")[1].params["/semantic_localization/save_model"].value,
                         "/w/visual_places")
        self.assertEqual(self.whole("model:=/m", "vision:=true")[1].params["/semantic_localization/save_model"].value, "")
        self.assertEqual(self.whole("work_dir:=/w")[1].params["/slam/state"].value, "/w/slam.state")
        self.assertEqual(self.whole()[1].params["/slam/state"].value, "")

    def test_frames_and_topics_reach_every_layer(self):
        for pose in ("slam", "localization"):
            nodes, config = self.whole(f"pose:={pose}", "vision:=true", "objects:=true", "scan:=base_scan", "map_frame:=m", "odom_frame:=o",
                                       "base_frame:=b", "image:=eye")
            for name, key, value in (("slam", "global_frame_id", "m"), ("localization", "global_frame_id", "m"),
                                     ("fsd", "odom_frame_id", "o"), ("fsd", "base_frame_id", "b"),
                                     ("topo_engine", "base_frame", "b"), ("semantic_localization", "base_frame_id", "b"),
                                     ("semantic_localization", "global_frame_id", "m"),
                                     ("semantic_localization", "odom_frame_id", "o"),
                                     ("object_engine", "map_frame", "m")):
                if "/" + name in nodes:
                    self.assertEqual(config.params[f"/{name}/{key}"].value, value, f"{name} {key}")
            for name in ("slam", "localization", "fsd", "words", "semantic_localization"):
                if "/" + name in nodes:
                    self.assertIn(["scan", "base_scan"], [list(r) for r in nodes["/" + name].remap_args], name)
            self.assertIn(["image", "eye"], [list(r) for r in nodes["/semantic_localization"].remap_args])
            shown = [list(r) for r in self.whole("rviz:=true", "scan:=base_scan", "image:=eye")[0]["/rviz"].remap_args]
            self.assertIn(["scan", "base_scan"], shown)
            self.assertIn(["camera/color/image_raw", "eye"], shown)

    def test_further_parameters_reach_their_layers(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("further: 7\n")
            file.flush()
            for layer, name, more in (("slam", "slam", ["pose:=slam"]), ("localization", "localization", ["pose:=localization"]),
                                      ("words", "words", ["pose:=other"]), ("places", "gr2to", []),
                                      ("places", "gr2to", ["dialogue:=false"]), ("dialogue", "topo_engine", []),
                                      ("vision", "semantic_localization", ["vision:=true"]), ("objects", "object_engine", ["objects:=true"])):
                params = self.whole(f"{layer}_params:={file.name}", *more)[1].params
                self.assertEqual(params[f"/{name}/further"].value, 7, f"{layer} {more}")

    def test_cameras_know_places_by_the_names_that_people_gave(self):
        for dialogue, topic in (("true", "named_map"), ("false", "topological_map")):
            nodes, _ = self.whole("vision:=true", "objects:=true", f"dialogue:={dialogue}")
            for name in ("/semantic_localization", "/object_engine"):
                self.assertIn(["topological_map", topic], [list(r) for r in nodes[name].remap_args], name)

    def test_the_demo_waits_if_told_to(self):
        player = lambda *more: self.whole("bag:=/nowhere/x.bag", *more, name="demo.launch")[0]["/player"].args.split()  # noqa: E731
        self.assertIn("--pause", player("paused:=true"))
        self.assertNotIn("--pause", player())

    def test_a_demo_that_starts_later_knows_the_transforms_of_before(self):
        for name, more in (("demo.launch", []), ("demo_localization.launch", ["map:=/nowhere/x.yaml"])):
            nodes = self.whole("bag:=/nowhere/x.bag", "start:=12.5", *more, name=name)[0]
            self.assertEqual(nodes["/earlier_transforms"].args.split(), ["/nowhere/x.bag", "12.5"])
            self.assertNotIn("/earlier_transforms", self.whole("bag:=/nowhere/x.bag", *more, name=name)[0])

    def test_robots_share_the_master_and_the_map(self):
        nodes, config = self.whole("first:=a", "second:=b", "work_dir:=/w", name="two_robots.launch")
        of = {robot: {n[len(robot) + 2:] for n in nodes if n.startswith(f"/{robot}/")} for robot in "ab"}
        self.assertEqual(of["a"], of["b"])
        self.assertEqual({n for n in nodes if n.split("/")[1] not in "ab"}, {"/shared_map"})
        self.assertEqual(config.params["/shared_map/robots"].value, "a b")
        known, _ = self.whole("map:=/nowhere/x.yaml", name="two_robots.launch")
        self.assertNotIn("/shared_map", known)
        self.assertEqual(config.params["/a/slam/state"].value, "/w/a/slam.state")
        self.assertEqual(config.params["/b/slam/global_frame_id"].value, "b/map")
        for node in nodes.values():
            for source, target in node.remap_args:
                self.assertFalse(target.startswith("/"), f"{node.name}: {source} -> {target}")

    def test_robots_have_bags_topics_and_parameters_of_their_own(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("further: 7\n")
            file.flush()
            for layer, more in (("slam", []), ("localization", ["map:=/nowhere/x.yaml"])):
                for robot, which in (("robot1", "first"), ("robot2", "second")):
                    nodes, config = self.whole(f"{which}_{layer}_params:={file.name}", f"{which}_scan:=base_scan", *more, name="two_robots.launch")
                    self.assertEqual([key for key in config.params if key.endswith("/further")], [f"/{robot}/{layer}/further"])
                    self.assertEqual([n for n in nodes if ["scan", "base_scan"] in [list(r) for r in nodes[n].remap_args]],
                                     [n for n in nodes if n in (f"/{robot}/{layer}", f"/{robot}/fsd", f"/{robot}/words", f"/{robot}/words_fsd")])
        nodes, config = self.whole("bag:=/nowhere/x.bag", "rate:=3", name="two_robots.launch")
        self.assertEqual(nodes["/player"].args.split()[-3:], ["--rate", "3", "/nowhere/x.bag"])
        self.assertTrue(config.params["/use_sim_time"].value)
        nodes, config = self.whole(name="two_robots.launch")
        self.assertNotIn("/player", nodes)
        self.assertNotIn("/use_sim_time", config.params)

    def test_values_of_a_params_file_win(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in self.files:
                path = os.path.join(self.folder, name)
                root = ElementTree.parse(path).getroot()
                for rosparam in (r for r in root.findall("rosparam") if r.get("file") == "$(arg params)"):
                    node = rosparam.get("ns")
                    load = lambda *more: roslaunch.config.load_config_default([(path, list(more))], None, verbose=False).params
                    keys = [key for key in load() if key.startswith(f"/{node}/")]
                    self.assertTrue(keys, name)
                    with open(os.path.join(folder, "params.yaml"), "w") as file:
                        file.writelines(f"{key.split('/', 2)[2]}: won\n" for key in keys)
                    won = load(f"params:={file.name}")
                    self.assertEqual({won[key].value for key in keys}, {"won"}, name)
                # Within a node the values of its param tags would win.
                self.assertFalse([n.get("name") for n in root.findall("node") for r in n.findall("rosparam")
                                  if r.get("file") == "$(arg params)"], name)

    def test_there_are_launch_files(self):
        self.assertIn("localization.launch", self.files)

    def test_no_name_is_remapped_twice(self):
        # roslaunch takes the last one without a word.
        for name in self.files:
            with open(os.path.join(self.folder, name)) as file:
                for node in ElementTree.parse(file).getroot().iter("node"):
                    sources = [r.get("from") for r in node.findall("remap") if not (r.get("if") or r.get("unless"))]
                    self.assertEqual(len(sources), len(set(sources)), f"{name}: {node.get('name')}")

    def test_programs_exist(self):
        for name, config in self.configurations():
            for node in config.nodes:
                self.assertTrue(find_node(node.package, node.type), f"{name}: {node.package}/{node.type}")

    def test_nodelet_classes_are_declared(self):
        declared = nodelet_classes()
        for name, config in self.configurations():
            for node in config.nodes:
                words = node.args.split()
                if node.type == "nodelet" and words[0] in ("load", "standalone"):
                    self.assertTrue(words[1] in declared, f"{name}: no nodelet {words[1]}")

    def test_packages_are_declared(self):
        declared = {PACKAGE} | {d.name for d in parse_package(os.path.dirname(self.folder)).exec_depends}
        for name, config in self.configurations():
            for node in config.nodes:
                self.assertIn(node.package, declared, name)

    def test_every_argument_is_explained(self):
        for name in self.files:
            with open(os.path.join(self.folder, name)) as file:
                for arg in ElementTree.parse(file).getroot().findall("arg"):
                    self.assertTrue(arg.get("doc"), f"{name}: {arg.get('name')}")


if __name__ == "__main__":
    rostest.rosrun(PACKAGE, "launch_files_test", LaunchFilesTest)
