#!/usr/bin/env python3
"""scripts/platform without a network and without another system: its arguments, what it reads in logs, the page of its records, which folders
it leaves alone."""
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import rostest

SCRIPT = pathlib.Path(os.path.realpath(__file__)).parent.parent / "scripts/platform"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPT.parent))

import script_module

platform = script_module.load(SCRIPT)
RECORD = {"system": "debian-13", "compiler_asked": None, "compiler": "c++ (Debian 14.2.0-19) 14.2.0", "date": "2026-01-02", "commit": "0123abcd",
          "complete": True, "build_passed": True, "build_minutes": 41.6, "build_continued": False, "test_minutes": 12.2,
          "tests": {"passed": 7, "failed": 0, "skipped": 2}, "failures": [], "left_out": [], "versions": {"PCL": "1.15.0"}}
OLD = {**RECORD, "system": "debian-11", "compiler_asked": "g++-9", "compiler": "g++-9 (Debian 9.3.0-22) 9.3.0", "ccache": {"hits": 3, "misses": 4},
       "tests": {"passed": 5, "failed": 1, "skipped": 0}, "failures": ["a_package: Suite.case: too old"],
       "left_out": ["no package librapidcheck-dev here: the tests of properties are left out"], "demo": {"passed": True, "minutes": 3.0, "acts": ["1", "2"]}}
BROKEN = {**RECORD, "system": "debian-12", "complete": False, "build_passed": False}
for key in ("tests", "test_minutes"):
    del BROKEN[key]


class FakeSystem(platform.System):
    """Nothing is made, mounted or run: each step leaves a log and ends with a status."""
    commit_known = contextlib.nullcontext
    steps, statuses, logs_of = [], {}, {}

    def make(self, fresh):
        self.logs.mkdir(parents=True, exist_ok=True)

    def copy_tree(self, commit, rebuild):
        return False

    def run(self, step, command, network=False, idle=False, environment=()):
        FakeSystem.steps.append((step, command, network, dict(environment)))
        (self.logs / f"{step}.log").write_text(self.logs_of.get(step, ""))
        return self.statuses.get(step, 0), 60.0


class UnmadeSystem(platform.System):
    """Of debootstrap only what it leaves behind, or that it was broken off."""
    breaks_off = False

    def logged(self, step, command, check=True):
        self.asked = (step, command)
        for folder in ("etc/apt/apt.conf.d", "usr/sbin"):
            (self.root / folder).mkdir(parents=True)
        if self.breaks_off:
            raise platform.PlatformError("broken off")
        return 0


class PlatformTest(unittest.TestCase):
    def refuses(self, *arguments):
        run = subprocess.run([str(SCRIPT), *arguments], capture_output=True, text=True, check=False)
        self.assertEqual((run.returncode, run.stdout), (2, ""), run.stderr)
        return run.stderr

    def test_arguments_that_make_no_sense_are_refused(self):
        self.assertIn("debian-11", self.refuses("debian-9"))
        self.assertIn("a SYSTEM or --table", self.refuses())
        self.assertIn("a SYSTEM or --table", self.refuses("debian-11", "--table"))
        self.assertIn("g++-9", self.refuses("debian-11", "--compiler", "tcc; true"))
        self.assertIn("at least 1", self.refuses("debian-11", "--jobs", "0"))

    def test_without_root_it_says_so(self):
        with mock.patch("os.geteuid", return_value=1000), self.assertRaisesRegex(platform.PlatformError, "root is needed"):
            platform.check_host()

    def test_a_missing_tool_is_named_with_its_package(self):
        with mock.patch("os.geteuid", return_value=0), mock.patch("shutil.which", side_effect=lambda tool: tool != "unshare"), \
                self.assertRaisesRegex(platform.PlatformError, "unshare is missing: apt-get install util-linux"):
            platform.check_host()

    def test_the_mirror_is_the_one_of_either_format_of_sources(self):
        self.assertEqual(platform.mirror_in(["# deb http://no/debian x", "deb [signed-by=/k] http://a.org/debian/ bookworm main"]), "http://a.org/debian")
        self.assertEqual(platform.mirror_in(["Types: deb", "URIs: https://node.example/x", "URIs: http://b.org/debian"]), "http://b.org/debian")
        self.assertIsNone(platform.mirror_in(["deb http://a.org/debian-security bookworm-security main", "deb http://a.org/ubuntu focal main"]))

    def test_counts_are_of_the_last_summary(self):
        self.assertEqual(platform.counts_of("1 passed, 2 failed\nx\n10 passed, 0 failed, 3 skipped\n"), {"passed": 10, "failed": 0, "skipped": 3})
        self.assertEqual(platform.counts_of("4 passed, 1 failed\n"), {"passed": 4, "failed": 1, "skipped": 0})
        self.assertIsNone(platform.counts_of("100% tests passed, 0 tests failed out of 5\n"))

    def test_what_is_done_without_is_read_of_what_was_said(self):
        deps = "deps: no package librapidcheck-dev here: the tests of properties are left out\ndeps: all 97 packages are installed\n"
        configure = "-- a: no RapidCheck found, the tests of properties are left out in all packages\n-- Using Python nosetests\n" \
                    "-- octomap_msgs: the official package in /usr is used\n"
        self.assertEqual(platform.left_out_of(deps, configure + configure),
                         ["no package librapidcheck-dev here: the tests of properties are left out",
                          "a: no RapidCheck found, the tests of properties are left out in all packages"])

    def test_versions_are_upstream_s(self):
        for package, version in (("4.10.0+dfsg-5", "4.10.0"), ("1:1.13.1-2+b1", "1.13.1"), ("3.25.1-1", "3.25.1"), ("0~20200520.x-1", "0~20200520.x")):
            self.assertEqual(platform.upstream(package), version)
        self.assertIsNone(platform.upstream(None))

    def test_the_compiler_is_told_by_name_and_version(self):
        for line, words in (("c++ (Debian 10.2.1-6) 10.2.1 20210110", "c++ 10.2.1"), ("g++-9 (Debian 9.3.0-22) 9.3.0", "g++-9 9.3.0"), ("unknown", "unknown")):
            self.assertEqual(platform.compiler_words(line), words)

    def test_hits_of_the_compiler_cache(self):
        text = "cache_miss\t4\ndirect_cache_hit\t2\npreprocessed_cache_hit\t1\nstats_zeroed_timestamp\t0\n"
        self.assertEqual(platform.hits_of(text), {"hits": 3, "misses": 4})

    def test_the_page_of_the_records(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for record in (RECORD, OLD, BROKEN):
                platform.write_record(folder / "records" / f"{platform.name_of(record['system'], record['compiler_asked'])}.json", record)
            self.assertEqual(json.loads((folder / "records/debian-11-g++-9.json").read_text()), OLD)
            platform.write_table(folder / "records", folder / "page.md")
            page = (folder / "page.md").read_text()
        rows = [line for line in page.splitlines() if line.startswith("| Debian")]
        self.assertEqual(rows, [
            "| Debian 11 | g++-9 9.3.0 | 2026-01-02 | 0123abcd | – | 12 | 5 | 1 | 0 | passed (2 acts) |",
            "| Debian 12 | c++ 14.2.0 | 2026-01-02 | 0123abcd | **failed** |  |  |  |  | not run |",
            "| Debian 13 | c++ 14.2.0 | 2026-01-02 | 0123abcd | 42 | 12 | 7 | 0 | 2 | not run |"])
        self.assertIn("- failed: a_package: Suite.case: too old\n", page)
        self.assertIn("- without: no package librapidcheck-dev here", page)
        self.assertIn("| PCL | 1.15.0 | 1.15.0 | 1.15.0 |", page)
        self.assertIn("| CLI11 | not packaged |", page)

    def run_of(self, *arguments, statuses=None, logs=None):
        """Exit status, record and page of a run on a fake system."""
        FakeSystem.steps, FakeSystem.statuses, FakeSystem.logs_of = [], statuses or {}, {
            "test": "12 passed, 0 failed, 1 skipped\n", "compiler": "g++-9 (Debian) 9.3.0\n", "versions": "cmake installed 3.18.4-2+deb11u1\n",
            "build": "/x/a.cpp:3:1: warning: w\n/x/a.cpp:3:1: warning: w\n", "ccache": "cache_miss\t5\n",
            "demo": "== 1. The robot\n== 2. It\n", "deps": "deps: no package librapidcheck-dev here: the tests of properties are left out\n", **(logs or {})}
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            with mock.patch.multiple(platform, System=FakeSystem, RECORDS=folder / "records", TABLE=folder / "page.md", check_host=lambda: None,
                                     git=lambda *_: "0123abcd" + 32 * "0"), \
                    mock.patch.object(sys, "argv", ["platform", "debian-11", "--folder", str(folder / "system"), *arguments]):
                status = platform.main()
            records = [json.loads(p.read_text()) for p in (folder / "records").glob("*.json")]
            return status, (records or [None])[0], (folder / "page.md").read_text() if records else ""

    def test_a_run_that_goes_well(self):
        status, record, page = self.run_of("--compiler", "g++-9", "--demo", "--ccache")
        self.assertEqual(status, 0)
        self.assertEqual([step for step, *_ in FakeSystem.steps], ["packages", "deps", "ccache", "build", "ccache", "compiler", "versions", "test", "demo"])
        self.assertEqual([network for _, _, network, _ in FakeSystem.steps], [True, True] + 7 * [False])
        self.assertEqual((FakeSystem.steps[3][3]["CC"], FakeSystem.steps[3][3]["CXX"]), ("gcc-9", "g++-9"))
        self.assertEqual(record["tests"], {"passed": 12, "failed": 0, "skipped": 1})
        self.assertEqual((record["warnings"], record["ccache"], record["demo"]["acts"]), (1, {"hits": 0, "misses": 5}, ["1", "2"]))
        self.assertEqual((record["versions"]["CMake"], record["versions"]["CLI11"]), ("3.18.4", None))
        self.assertIn("| Debian 11 | g++-9 9.3.0 | ", page)
        self.assertIn("- without: no package librapidcheck-dev here", page)

    def test_packages_are_made_of_the_commit_and_looked_at(self):
        log = "| ros-a | all | 0.01 | 0.02 | 0 |\n20 packages in /opt/hyselam/out/deb, 9.8 MB\nlintian: {} errors and warnings\n"
        status, record, page = self.run_of("--deb", logs={"deb": log.format(0)})
        self.assertEqual([(step, network) for step, _, network, _ in FakeSystem.steps][-3:], [("test", False), ("deb_tools", True), ("deb", False)])
        self.assertEqual((status, record["deb"]), (0, {"passed": True, "minutes": 1.0, "packages": 20, "megabytes": 9.8, "lintian": 0}))
        self.assertIn("- `make deb`: 20 packages, 9.8 MB, 0 errors and warnings of lintian\n", page)
        status, record, page = self.run_of("--deb", logs={"deb": log.format(2)}, statuses={"deb": 1})
        self.assertEqual((status, record["deb"]["passed"], record["deb"]["lintian"]), (1, False, 2))
        self.assertIn("- `make deb` **failed**: 20 packages, 9.8 MB, 2 errors and warnings of lintian\n", page)
        status, record, page = self.run_of("--deb", logs={"deb": "error: the build failed\n"}, statuses={"deb": 2})
        self.assertEqual((status, record["deb"]), (1, {"passed": False, "minutes": 1.0}))
        self.assertIn("- `make deb` **failed**\n", page)
        self.assertIsNone(platform.packed_of("20 packages in /x, 9.8 MB\nlintian: not installed, left out: apt-get install lintian\n")["lintian"])

    def test_the_tree_there_knows_its_commit_while_it_is_packed(self):
        commit = subprocess.run(["git", "-C", str(SCRIPT.parent), "rev-parse", "HEAD"], capture_output=True, text=True, check=False).stdout.strip()
        if not commit:
            self.skipTest("no checkout of git")
        with tempfile.TemporaryDirectory() as folder:
            system = platform.System(pathlib.Path(folder), "suite", "http://a.org/debian", False)
            tree = system.root / platform.TREE
            tree.mkdir(parents=True)
            with system.commit_known(commit):
                head = subprocess.run(["git", "-C", str(tree), "log", "--format=%H"], capture_output=True, text=True, check=True).stdout.split()
            self.assertEqual((head, list(tree.iterdir())), ([commit], []))

    def test_the_compiler_cache_of_an_earlier_run_is_not_kept(self):
        for arguments, cmake, folder in ((("--ccache",), "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache", "/var/cache/ccache"),
                                         ((), "-UCMAKE_CXX_COMPILER_LAUNCHER -UCMAKE_C_COMPILER_LAUNCHER", None)):
            self.run_of(*arguments)
            environments = [environment for step, _, _, environment in FakeSystem.steps if step in ("build", "test")]
            self.assertEqual([(e["CMAKE_ARGS"], e.get("CCACHE_DIR")) for e in environments], 2 * [(cmake, folder)])

    def test_what_the_system_lacks_of_cli11_is_remarked(self):
        _, record, page = self.run_of(logs={"packages": "Reading…\nplatform: CLI11 is not packaged, it is that of Debian 12\n"})
        self.assertEqual(record["remarks"], ["CLI11 is not packaged, it is that of Debian 12"])
        self.assertIn("- CLI11 is not packaged, it is that of Debian 12\n", page)
        command = next(command for step, command, *_ in FakeSystem.steps if step == "packages")
        self.assertLess(command.index("download libcli11-dev"), command.index("make deps"))

    def test_what_a_job_of_the_build_needs_is_told(self):
        _, record, page = self.run_of("--jobs", "1", logs={"build": "[1/1] Linking\nlargest process: 1234 MB\n"})
        self.assertEqual((record["build_jobs"], record["build_largest_mb"]), (1, 1234))
        self.assertIn("- built with 1 job at a time, each of at most 1234 MB\n", page)
        self.assertNotIn("at a time", self.run_of("--ccache", logs={"build": "largest process: 1234 MB\n"})[2])
        self.assertIsNone(self.run_of()[1]["build_largest_mb"])

    def test_the_memory_told_is_that_of_the_largest_process(self):
        command = [sys.executable, "-c", platform.MEASURED, sys.executable, "-c", "x = b'1' * 300_000_000; raise SystemExit(3)"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 3)
        self.assertTrue(290 < platform.largest_of(run.stdout) < 400, run.stdout)

    def test_failures_are_written_down_and_are_the_exit_status(self):
        status, record, page = self.run_of(statuses={"test": 1}, logs={"test": "FAILED   p: A.b: no\n3 passed, 1 failed\n"})
        self.assertEqual((status, record["complete"], record["failures"]), (1, True, ["p: A.b: no"]))
        self.assertIn("- failed: p: A.b: no", page)
        status, record, page = self.run_of("--demo", statuses={"build": 1})
        self.assertEqual((status, record["build_passed"], "tests" in record, "demo" in record), (1, False, False, False))
        self.assertIn("**failed**", page)
        status, record, _ = self.run_of(logs={"test": "the runner died\n"}, statuses={"test": 137})
        self.assertEqual((status, record["complete"], record["tests"]), (1, False, None))
        status, record, page = self.run_of("--demo", statuses={"demo": 1})
        self.assertEqual((status, record["demo"]["passed"]), (1, False))
        self.assertEqual(self.run_of(statuses={"packages": 100}), (2, None, ""))

    def test_a_foreign_root_survives(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "root").mkdir()
            (folder / "root/precious").write_text("1")
            for fresh in (False, True):
                with self.assertRaisesRegex(platform.PlatformError, "no system that this program began"):
                    UnmadeSystem(folder, "suite", "http://a.org/debian", False).make(fresh)
            self.assertEqual([p.relative_to(folder).as_posix() for p in sorted(folder.rglob("*"))], ["root", "root/precious"])

    def test_without_a_mirror_nothing_is_removed(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(platform, "host_mirror", return_value=None):
            folder = pathlib.Path(folder)
            (folder / "root").mkdir()
            (folder / "made").write_text("http://a.org/debian\n")
            with self.assertRaisesRegex(platform.PlatformError, "--mirror"):
                UnmadeSystem(folder, "suite", None, False).make(True)
            self.assertTrue((folder / "root").exists() and (folder / "made").exists())

    def test_a_system_of_its_own_is_made_again(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder) / "system"

            def make(fresh, breaks_off=False):
                system = UnmadeSystem(folder, "suite", "http://a.org/debian", False)
                system.asked, system.breaks_off = None, breaks_off
                try:
                    system.make(fresh)
                finally:
                    system.held.close()
                return system.asked

            with self.assertRaisesRegex(platform.PlatformError, "broken off"):
                make(False, breaks_off=True)
            (folder / "root/half").touch()
            step, command = make(False)
            self.assertEqual((step, command[:len(platform.NAMESPACE)], command[-2:]),
                             ("debootstrap", platform.NAMESPACE, [str(folder / "root"), "http://a.org/debian"]))
            self.assertFalse((folder / "root/half").exists())
            self.assertIsNone(make(False))
            self.assertIsNotNone(make(True))

    def test_a_folder_is_one_run_s_at_a_time(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            first = UnmadeSystem(folder, "suite", "http://a.org/debian", False)
            first.make(False)
            (folder / "root/built").touch()
            for fresh in (False, True):
                with self.assertRaisesRegex(platform.PlatformError, "is in use"):
                    UnmadeSystem(folder, "suite", "http://a.org/debian", False).make(fresh)
            self.assertTrue((folder / "root/built").exists())
            first.held.close()
            UnmadeSystem(folder, "suite", "http://a.org/debian", False).make(True)
            self.assertFalse((folder / "root/built").exists())

    @unittest.skipUnless(shutil.which("git"), "git is not installed")
    def test_the_committed_tree_is_copied_and_what_did_not_change_is_left_alone(self):
        def git(*arguments):
            subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@example.org", "-C", str(tree), *arguments], check=True, capture_output=True)

        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            tree, copy = folder / "tree", folder / "system/root" / platform.TREE
            tree.mkdir()
            for name in ("stays", "changes", "goes"):
                (tree / name).write_text("1")
            git("init", "-q")
            git("add", "-A")
            git("commit", "-qm", "1")
            (tree / "not committed").write_text("1")
            system = platform.System(folder / "system", "suite", None, False)
            with mock.patch.object(platform, "ROOT", tree):
                self.assertFalse(system.copy_tree("HEAD", False))
                self.assertEqual(sorted(p.name for p in copy.iterdir()), ["changes", "goes", "stays"])
                (copy / "build").mkdir()
                os.utime(copy / "stays", (1, 1))
                (copy / "changes").unlink()  # an interrupted run
                (tree / "goes").unlink()
                (tree / "changes").write_text("2")
                git("commit", "-qam", "2")
                os.utime(copy / "stays", (1, 1))
                self.assertTrue(system.copy_tree("HEAD", False))
                self.assertEqual(sorted(p.name for p in copy.iterdir()), ["build", "changes", "stays"])
                self.assertEqual((copy / "changes").read_text(), "2")
                self.assertFalse(system.copy_tree("HEAD", True))
                with self.assertRaisesRegex(platform.PlatformError, "git cannot copy"):
                    system.copy_tree("nothing", False)
            with mock.patch.object(platform, "ROOT", folder / "system"), self.assertRaisesRegex(platform.PlatformError, "no checkout of git"):
                system.copy_tree("HEAD", False)

    def test_no_records_are_told(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(platform.PlatformError, "no records"):
            platform.write_table(pathlib.Path(folder), pathlib.Path(folder) / "page.md")


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "platform_test", PlatformTest)
