#!/usr/bin/env python3
"""scripts/layers: what a build leaves out for each layer, what it refuses; launch files tell of a layer that is not there."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import rostest

ROOT = pathlib.Path(os.path.realpath(__file__)).parent.parent


def run(*command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def layers(*off):
    return run(ROOT / "scripts/layers", *(f"-DHYSELAM_{layer}=OFF" for layer in off))


class LayersTest(unittest.TestCase):
    def left_out(self, *off):
        code, out, err = layers(*off)
        self.assertEqual(code, 0, err)
        packages = out.strip().split(";") if out.strip() else []
        for package in packages:
            self.assertIn(f"left out: {package} (", err)
        return set(packages)

    def test_all_is_kept_by_default(self):
        self.assertEqual(self.left_out(), set())
        code, out, _ = run(ROOT / "scripts/layers", "-DHYSELAM_VISION=ON", "-DHYSELAM_WERROR=OFF", "-DCMAKE_BUILD_TYPE=Debug")
        self.assertEqual((code, out), (0, "\n"))

    def test_a_layer_goes_with_what_only_it_needs(self):
        self.assertEqual(self.left_out("VISION"), {"selovis", "hyselam_examples"})
        self.assertEqual(self.left_out("SLAM"), {"ngram_slam", "hyselam_pose_graph", "hyselam_examples"})
        self.assertEqual(self.left_out("OBJECTS"), {"hyselam_objects", "hyselam_conversation", "hyselam_examples"})
        self.assertEqual(self.left_out("WEB"), {"hyselam_web"})
        self.assertLessEqual({"hyselam_topological_map", "hyselam_language"}, self.left_out("PLACES", "OBJECTS", "VISION"))
        self.assertNotIn("hyselam_topological_map", self.left_out("PLACES", "OBJECTS"))

    def test_what_a_kept_layer_needs_is_refused(self):
        code, out, err = layers("LOCALIZATION")
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(err, "error: HYSELAM_LOCALIZATION=OFF leaves out fsd_localization, which ngram_slam needs: give -DHYSELAM_SLAM=OFF, too, or keep both\n")
        self.assertIn("fsd_localization", self.left_out("LOCALIZATION", "SLAM"))

    def test_options_that_are_none_are_refused(self):
        for option, why in (("-DHYSELAM_VISON=OFF", "there is no HYSELAM_VISON: HYSELAM_VISION?"), ("-DHYSELAM_WEB=OF", "ON or OFF is wanted"),
                            ("-DHYSELAM_EVERYTHING=OFF", "there is no HYSELAM_EVERYTHING; layers are LOCALIZATION, SLAM, "), ("-DHYSELAM_WEB", "ON or OFF is wanted")):
            code, out, err = run(ROOT / "scripts/layers", "-DCMAKE_BUILD_TYPE=Debug", option)
            self.assertEqual((code, out), (2, ""), option)
            self.assertIn(f"error: {option}: {why}", err)
        self.assertEqual(run(ROOT / "scripts/layers", "-DHYSELAM_WEB:BOOL=off")[1], "hyselam_web\n")

    def test_the_build_refuses_so_before_it_configures(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([str(ROOT / "scripts/build")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                                  env={**os.environ, "CMAKE_ARGS": "-DHYSELAM_LOCALIZATION=OFF", "BUILD_DIR": folder + "/b", "DEVEL_DIR": folder + "/d"})
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn("which ngram_slam needs", done.stderr)
            self.assertFalse(os.path.exists(folder + "/b/CMakeCache.txt"))

    def test_each_nodelet_is_told_of_by_its_launch_file(self):
        for file in sorted((ROOT / "launch").glob("*.launch")):
            text = file.read_text()
            for package in set(re.findall(r"'(?:standalone|load) ([a-z_]+)/", text)) - {"hyselam_map_server", "fsd_localization"}:
                with self.subTest(file=file.name, package=package):
                    self.assertIn(f'value="$(find {package})"', text)

    def test_a_launch_file_whose_layer_is_not_there_says_so(self):
        text = (ROOT / "launch/selovis.launch").read_text()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "selovis.launch"
            file.write_text(text.replace("$(find selovis)", "$(find selovis_left_out)"))
            code, out, err = run("roslaunch", "--nodes", file)
        self.assertNotEqual(code, 0)
        self.assertIn("the build left it out: without HYSELAM_VISION=OFF it is there", out + err)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "layers_test", LayersTest)
