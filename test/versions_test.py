#!/usr/bin/env python3
"""scripts/versions: the sources agree on the version of the stack, released messages stay, every reader of a version is told of. What it finds in
copies that disagree."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import rostest

ROOT = pathlib.Path(os.path.realpath(__file__)).parent.parent


def run(*arguments):
    done = subprocess.run([str(ROOT / "scripts/versions"), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class VersionsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for pattern in ("src/*/package.xml", "src/*/CHANGELOG.rst", "src/hyselam_msgs/*/*", "src/hyselam_msgs/released.md5", "CHANGELOG.md",
                        "docs/versions.md"):
            for file in ROOT.glob(pattern):
                if file.is_file():
                    copy = self.root / file.relative_to(ROOT)
                    copy.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(file, copy)

    def change(self, file, old, new):
        path = self.root / file
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1))

    def found(self):
        code, out, err = run("--root", self.root)
        self.assertEqual(code, 1, out + err)
        return out

    def test_the_sources_agree(self):
        code, out, err = run()
        self.assertEqual(code, 0, out + err)

    def test_the_copy_is_good(self):
        code, out, err = run("--root", self.root)
        self.assertEqual(code, 0, out + err)

    def test_a_package_of_another_version(self):
        self.change("src/selovis/package.xml", "<version>1.0.0<", "<version>1.0.1<")
        self.assertIn("src/selovis/package.xml: 1.0.1, but CHANGELOG.md begins with 1.0.0", self.found())

    def test_a_changelog_that_was_forgotten(self):
        self.change("src/selovis/CHANGELOG.rst", "1.0.0 (", "0.9.0 (")
        self.assertIn("src/selovis/CHANGELOG.rst: begins with 0.9.0, but the package has 1.0.0", self.found())

    def test_a_changed_message(self):
        with (self.root / "src/hyselam_msgs/msg/WallArray.msg").open("a") as file:
            file.write("uint32 one_more\n")
        self.assertIn("hyselam_msgs/WallArray is not what version 1 was released with", self.found())

    def test_a_comment_is_no_change(self):
        with (self.root / "src/hyselam_msgs/msg/WallArray.msg").open("a") as file:
            file.write("# a word more\n")
        self.test_the_copy_is_good()

    def test_a_new_message_has_to_be_recorded_for_a_release_only(self):
        (self.root / "src/hyselam_msgs/msg/OneMore.msg").write_text("uint32 more\n")
        self.test_the_copy_is_good()
        git = ["git", "-C", str(self.root), "-c", "user.name=a", "-c", "user.email=a@b"]
        for command in (["init", "--quiet"], ["commit", "--quiet", "--allow-empty", "-m", "x"], ["tag", "v1.0.0"]):
            subprocess.run([*git, *command], check=True)
        self.assertIn("hyselam_msgs/OneMore is new in a release and not in src/hyselam_msgs/released.md5", self.found())

    def test_a_removed_message(self):
        (self.root / "src/hyselam_msgs/srv/WhereAmI.srv").unlink()
        self.assertIn("hyselam_msgs/WhereAmI is missing", self.found())

    def test_a_format_that_is_not_told_of(self):
        reader = self.root / "src/selovis/src/core/new_format.cpp"
        reader.parent.mkdir(parents=True)
        reader.write_text('throw InputError(path, "", hyselam::versionRefusal(found, {1, 1}));\n')
        self.assertIn("docs/versions.md does not name src/selovis/src/core/new_format.cpp, which reads a version", self.found())


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "versions_test", VersionsTest)
