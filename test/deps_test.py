#!/usr/bin/env python3
"""scripts/deps with a package manager that only writes down what it is asked."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import rostest

SCRIPTS = pathlib.Path(os.path.realpath(__file__)).parent.parent / "scripts"
NOBODY = 65534
# What the package manager holds is in files of one name a line: installed, packaged. What CMake would find is the file `cmake_finds`.
PROGRAMS = {
    "dpkg-query": 'sed "s/^/installed /" "$HERE/installed"',
    "apt-cache": '[ "$1" = madison ] || exit 1; grep -x "$2" "$HERE/packaged" || true',
    "apt-get": 'echo "$*" >> "$HERE/asked"; [ "$1" = update ] || { [ ! -e "$HERE/broken" ] && printf "%s\\n" "${@:4}" >> "$HERE/installed"; }',
    "cmake": '[ -e "$HERE/cmake_finds" ] || grep -qx libcli11-dev "$HERE/installed"',
    "sudo": 'exec "$@"'}


class DepsTest(unittest.TestCase):
    def deps(self, lacking, packaged=(), programs=("sudo",), files=(), release=11):
        """Exit status, what was said and what apt-get was asked, as a user of a release of Debian who lacks these packages."""
        with tempfile.TemporaryDirectory() as folder:
            here = pathlib.Path(folder)
            (here / "scripts").mkdir()
            (here / "bin").mkdir()
            text = (SCRIPTS / "deps").read_text()
            self.assertEqual(text.count(". /etc/os-release"), 1)
            (here / "scripts/deps").write_text(text.replace("/etc/os-release", f"{here}/os-release"))
            (here / "os-release").write_text(f"ID=debian\nVERSION_ID={release}\n")
            (here / "scripts/env.sh").write_text(f". '{SCRIPTS}/env.sh'\nPATH={here}/bin\n")
            for tool in ("awk", "bash", "cat", "comm", "dirname", "env", "fmt", "grep", "mktemp", "rm", "sed", "sort"):
                (here / "bin" / tool).symlink_to(shutil.which(tool))
            for name in ("dpkg-query", "apt-cache", "apt-get", "cmake", *programs):
                (here / "bin" / name).write_text(f"#!{shutil.which('bash')}\nHERE={here}\n{PROGRAMS[name]}\n")
                (here / "bin" / name).chmod(0o755)
            every = subprocess.run(["bash", here / "scripts/deps", "--list"], capture_output=True, text=True, check=True).stdout.split()
            self.assertLessEqual(set(lacking), set(every))
            (here / "installed").write_text("".join(f"{name}\n" for name in every if name not in lacking))
            (here / "packaged").write_text("".join(f"{name}\n" for name in packaged))
            for name in ("asked", *files):
                (here / name).touch()
            for path in (here, *here.iterdir()):
                path.chmod(0o777)
            run = subprocess.run(["bash", here / "scripts/deps"], capture_output=True, text=True, check=False,
                                 preexec_fn=lambda: os.geteuid() == 0 and os.setuid(NOBODY))
            return run.returncode, run.stdout + run.stderr, (here / "asked").read_text().splitlines()

    def test_with_all_there_nothing_is_asked(self):
        status, said, asked = self.deps([])
        self.assertEqual((status, asked), (0, []), said)
        self.assertIn("packages are installed", said)

    def test_an_optional_package_stops_nobody(self):
        rapidcheck = ["librapidcheck-dev"]
        status, said, asked = self.deps(rapidcheck)
        self.assertEqual((status, asked), (0, []), said)
        self.assertIn("no package librapidcheck-dev here: the tests of properties are left out", said)
        status, said, asked = self.deps(rapidcheck, packaged=rapidcheck, programs=())
        self.assertEqual((status, asked), (0, []), said)
        self.assertRegex(said, "^deps: librapidcheck-dev is not installed, .*neither root nor .* sudo: the tests of properties are left out")
        status, said, asked = self.deps(rapidcheck, packaged=rapidcheck, files=["broken"])
        self.assertEqual((status, len(asked)), (0, 2), said)
        self.assertIn("could not install it: the tests of properties are left out", said)
        status, said, asked = self.deps(rapidcheck, packaged=rapidcheck)
        self.assertEqual((status, asked), (0, ["update -qq", "install -y --no-install-recommends librapidcheck-dev"]), said)

    def test_a_needed_package_does(self):
        status, said, asked = self.deps(["catkin", "librapidcheck-dev"], packaged=["catkin", "librapidcheck-dev"], programs=())
        self.assertEqual((status, asked), (1, []), said)
        self.assertIn("neither root nor a user with sudo: catkin", said)
        status, said, _ = self.deps(["catkin"], packaged=["catkin"], files=["broken"])
        self.assertEqual(status, 1, said)
        self.assertIn("could not install", said)

    def test_the_panel_is_compiled_against_the_qt_of_rviz(self):
        for release, qt in ((11, ["qtbase5-dev"]), (12, ["qtbase5-dev"]), (13, ["qt6-base-dev", "qt6-svg-plugins"])):
            status, said, asked = self.deps(qt, release=release)
            self.assertEqual((status, asked[1:]), (0, [f"install -y --no-install-recommends {' '.join(qt)}"]), said)

    def test_cli11_is_needed_of_a_package_or_of_its_sources(self):
        cli11 = ["libcli11-dev"]
        for programs in ((), ("sudo",)):
            status, said, asked = self.deps(cli11, programs=programs)
            self.assertEqual(status, 1, said)
            self.assertIn("CLI11 2.0 or newer is needed, is not packaged here, and CMake finds no CLI11Config.cmake", said)
            self.assertFalse([line for line in asked if line.startswith("install")])
        status, said, asked = self.deps(cli11, files=["cmake_finds"])
        self.assertEqual((status, asked), (0, []), said)
        status, said, asked = self.deps(cli11, packaged=cli11)
        self.assertEqual((status, asked[1:]), (0, ["install -y --no-install-recommends libcli11-dev"]), said)
        # The rest is installed all the same.
        status, said, asked = self.deps([*cli11, "catkin"], packaged=["catkin"])
        self.assertEqual((status, asked[1:]), (1, ["install -y --no-install-recommends catkin"]), said)
        self.assertIn("CLI11 2.0 or newer is needed", said)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "deps_test", DepsTest)
