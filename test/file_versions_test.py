#!/usr/bin/env python3
"""Files of the programs in Python: those of today are read, those of a version to come refused in words. Every program tells one version."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import rospkg
import rostest

HERE = pathlib.Path(os.path.realpath(__file__)).parent
ROOT = HERE.parent
SAMPLES = HERE / "file_versions"
sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(rospkg.RosPack().get_path("hyselam_web")) / "scripts"))

from hyselam_web import recording

NEWER = "has version 2, this program reads 1; it was written by a newer HySeLAM"


def run(*command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class FileVersionsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_knowledge_directory(self):
        copy = self.folder / "knowledge"
        shutil.copytree(SAMPLES / "knowledge", copy)
        code, out, err = run("rosrun", "hyselam_bringup", "knowledge", "check", copy)
        self.assertEqual(code, 0, err)
        self.assertIn("whole, objects", out)
        manifest = copy / "manifest.json"
        manifest.write_text(json.dumps({**json.loads(manifest.read_text()), "version": 2}))
        code, out, err = run("rosrun", "hyselam_bringup", "knowledge", "check", copy)
        self.assertEqual(code, 2)
        self.assertIn(f"{manifest}: {NEWER}", out + err)

    def test_a_recorded_day(self):
        self.assertEqual(len(recording.read(SAMPLES / "day.jsonl")), 1)
        later = self.folder / "day.jsonl"
        later.write_text((SAMPLES / "day.jsonl").read_text().replace('"version":1', '"version":2'))
        with self.assertRaisesRegex(ValueError, f"{later}: line 1: {NEWER}"):
            recording.read(later)
        later.write_text('{"format":"diary","version":1}\n')
        with self.assertRaisesRegex(ValueError, "line 1: this is no hyselam web recording"):
            recording.read(later)

    def test_every_program_tells_the_version_of_the_packages(self):
        version = xml.parse(ROOT / "src/hyselam_bringup/package.xml").getroot().findtext("version")
        for package, program in (("hyselam_bringup", "doctor"), ("hyselam_common", "build_map"), ("ngram_slam", "merge_maps")):
            with self.subTest(program=program):
                code, out, err = run("rosrun", package, program, "--version")
                self.assertEqual((code, out), (0, f"HySeLAM {version}\n"), err)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "file_versions_test", FileVersionsTest)
