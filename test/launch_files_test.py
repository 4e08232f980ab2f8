#!/usr/bin/env python3
"""Every launch file of the stack can be started: it is found by name, its arguments resolve, its programs
and nodelet classes exist, and the packages that it uses are declared by the bringup."""
import os
import unittest
import xml.etree.ElementTree as ElementTree

import rospkg
import rostest
import roslaunch.config
from catkin_pkg.package import parse_package
from roslaunch.rlutil import resolve_launch_arguments
from roslib.packages import find_node

PACKAGE = "hyselam_bringup"
# Required arguments; the files need not exist to resolve a launch file.
ARGUMENTS = ["bag:=/nowhere/x.bag", "map:=/nowhere/x.yaml"]


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

    def test_there_are_launch_files(self):
        self.assertIn("localization.launch", self.files)

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
        declared = {d.name for d in parse_package(os.path.dirname(self.folder)).exec_depends}
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
