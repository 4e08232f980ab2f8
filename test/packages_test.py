#!/usr/bin/env python3
"""Packages of Debian without making one: what the packages say of themselves, the unit of systemd, the reading of a unit, an apt repository."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import rostest
from catkin_pkg.packages import find_packages

ROOT = pathlib.Path(os.path.realpath(__file__)).parent.parent
UNIT = ROOT / "src/hyselam_bringup/systemd/hyselam@.service"
CONF = ROOT / "src/hyselam_bringup/systemd/example.conf"
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "scripts"))
import deb_control as texts  # noqa: E402  pylint: disable=wrong-import-position
import script_module  # noqa: E402  pylint: disable=wrong-import-position


# A system with the packages of ROS as Debian 12 has them.
OWNERS = {"/usr/share/roscpp/package.xml": "libroscpp-dev", "/usr/lib/nodelet": "libnodeletlib-tools", "/usr/share/nodelet/package.xml": "libnodeletlib-tools",
          "/usr/lib/python3/dist-packages/rospy/__init__.py": "python3-rospy", "/usr/share/rospy/package.xml": "python3-rospy",
          "/usr/share/rosgraph_msgs/package.xml": "librosgraph-msgs-dev", "/usr/lib/python3/dist-packages/rosgraph_msgs/__init__.py": "python3-rosgraph-msgs",
          "/usr/share/message_runtime/package.xml": "ros-message-runtime"}


class Dependency:
    def __init__(self, name):
        self.name = name


class Package:
    def __init__(self, name, runs, exported=()):
        self.name, self.exec_depends = name, [Dependency(n) for n in runs]
        self.build_export_depends = [Dependency(n) for n in exported]


class PackagesTest(unittest.TestCase):
    def test_newer_commits_have_higher_versions(self):
        versions = [texts.debian_version("0.1.0", "debian12", "20251231.000000", before_release=True),
                    texts.debian_version("0.1.0", "debian12"), texts.debian_version("0.1.0", "debian12", "20260101.000000"),
                    texts.debian_version("0.1.0", "debian12", "20260102.000000"),
                    texts.debian_version("0.1.0", "debian12", "20260102.000000", True), texts.debian_version("0.1.0", "debian12", "20260102.000001"),
                    texts.debian_version("0.1.1", "debian12")]
        self.assertEqual(versions[1], "0.1.0-1~debian12")
        for older, newer in zip(versions, versions[1:]):
            self.assertEqual(subprocess.run(["dpkg", "--compare-versions", older, "lt", newer], check=False).returncode, 0, (older, newer))

    def test_keys_become_the_packages_that_hold_what_runs(self):
        for key, python, expected in (("roscpp", True, ([], ["libroscpp-dev"])), ("nodelet", False, (["libnodeletlib-tools"], [])),
                                      ("rospy", True, (["python3-rospy"], [])), ("rosgraph_msgs", False, ([], ["librosgraph-msgs-dev"])),
                                      ("rosgraph_msgs", True, (["python3-rosgraph-msgs"], ["librosgraph-msgs-dev"])), ("eigen", False, ([], ["libeigen3-dev"])),
                                      ("message_runtime", False, (["ros-message-runtime"], [])), ("python3-yaml", False, (["python3-yaml"], []))):
            self.assertEqual(texts.names_of(key, OWNERS.get, python), expected, key)

    def test_relations(self):
        package = Package("hyselam_bringup", ["hyselam_msgs", "hyselam_rviz_plugins", "nodelet", "roscpp"], ["zlib", "nodelet"])
        found = texts.relations(package, {"hyselam_msgs": "1-1", "hyselam_rviz_plugins": "2-1"}, OWNERS.get, False)
        self.assertEqual(texts.relations(Package("hyselam_bringup", ["selovis", "hyselam_topo"], []), {"selovis": "1-1", "hyselam_topo": "1-1"}, OWNERS.get, False),
                         {"Depends": ["ros-hyselam-topo (= 1-1)"], "Suggests": [],
                          "Recommends": ["python3-rosnode", "python3-rosservice", "python3-rostopic", "ros-selovis (= 1-1)"]})
        self.assertEqual(found, {"Depends": ["libnodeletlib-tools", "ros-hyselam-msgs (= 1-1)"],
                                 "Recommends": ["python3-rosnode", "python3-rosservice", "python3-rostopic", "ros-hyselam-rviz-plugins (= 2-1)"],
                                 "Suggests": ["libroscpp-dev", "zlib1g-dev"]})
        with self.assertRaisesRegex(KeyError, "ngram_slam: .* no_such_key"):
            texts.relations(Package("ngram_slam", ["no_such_key"]), {}, OWNERS.get, False)

    def test_the_icons_of_rviz_go_with_its_qt(self):
        linked = ["libc6 (>= 2.36)", "libqt6core6t64 (>= 6.8.2)", "libqt6widgets6 (>= 6.3.0)"]
        self.assertEqual(texts.recommended_with("hyselam_rviz_plugins", linked), ["qt6-svg-plugins"])
        self.assertEqual(texts.recommended_with("hyselam_rviz_plugins", ["libqt5gui5 (>= 5.7.0) | libqt5gui5-gles (>= 5.7.0)", "libqt5widgets5"]), [])
        self.assertEqual(texts.recommended_with("hyselam_topo", linked), [])

    def test_a_system_key_of_every_package_has_a_name(self):
        packages = find_packages(str(ROOT / "src")).values()
        listed = subprocess.run([str(ROOT / "scripts/deps"), "--list", "debian-12"], capture_output=True, text=True, check=True).stdout.split()
        for key in sorted({d.name for p in packages for d in (*p.exec_depends, *p.build_export_depends)} & set(texts.ROSDEP)):
            if key.endswith("-dev") or key in ("cli11", "eigen", "yaml-cpp", "zlib"):
                self.assertIn(texts.ROSDEP[key], listed, key)

    def test_what_scripts_call_is_what_the_tests_of_them_have(self):
        listed = subprocess.run([str(ROOT / "scripts/deps"), "--list", "debian-12"], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual({n for kind in (texts.SUGGESTED, texts.OPERATORS) for names in kind.values() for n in names} - set(listed), set())

    def test_names_of_files_are_short_enough_for_lintian(self):
        version = texts.debian_version("0.1.0", "debian12", "20260102.000000", True)
        for package in find_packages(str(ROOT / "src")).values():
            self.assertLessEqual(len(f"{texts.debian_name(package.name)}_{version}_kfreebsd-amd64.deb"), 80)

    def test_the_line_of_lists_ends_with_a_clause(self):
        self.assertEqual(texts.synopsis("The short one. More."), "short one")
        self.assertEqual(texts.synopsis("Objects in rooms: told by people, seen by a depth camera, kept in a map with all their relations."),
                         "Objects in rooms: told by people, seen by a depth camera")

    def test_every_control_file_has_a_line_that_lists_show(self):
        for package in find_packages(str(ROOT / "src")).values():
            text = texts.control({"Package": texts.debian_name(package.name), "Depends": ["a", "b (= 1)"], "Recommends": []}, package.description)
            lines = text.splitlines()
            self.assertEqual(lines[1], "Depends: a, b (= 1)")
            self.assertRegex(lines[2], r"^Description: \S.{10,76}[^.…]$")
            self.assertIn(" ".join(package.description.split()), " ".join("".join(lines[3:]).split()))
            self.assertTrue(all(line.startswith(" ") and line.strip() for line in lines[3:]), text)

    def test_the_copyright_is_that_of_the_licence(self):
        text = texts.copyright_file("p", "M <m@example.org>", (ROOT / "LICENSE").read_text())
        self.assertIn("\nCopyright: 2026, the HySeLAM authors\nLicense: BSD-3-clause\n Redistribution and use", text)
        self.assertNotIn("\n\n\n", text)

    def test_man_pages_show_the_help_as_it_is(self):
        page = texts.man_page("a_package", "tool", "usage: tool [-h]\n\nSays what\nit does. More.\n\n.dots 'quotes' a\\b --json\n", "1.0", "2026-01-02")
        self.assertIn("a_package\\-tool \\- Says what it does\n", page)
        self.assertIn("\n\\&.dots 'quotes' a\\eb \\-\\-json\n", page)
        self.assertIn("a program of a_package", texts.man_page("a_package", "tool", "Usage: tool\n\nOptions:\n  -h\n", "1.0", "2026-01-02"))
        if shutil.which("man"):
            run = subprocess.run(["man", "-l", "-"], input=page, capture_output=True, text=True, check=False, env={**os.environ, "MANWIDTH": "100"})
            self.assertIn(".dots 'quotes' a\\b --json", run.stdout)

    def test_plugins_are_found_without_an_environment(self):
        described = 0
        for package in find_packages(str(ROOT / "src")):
            for path in (ROOT / "src" / package).glob("*plugin*.xml"):
                text, names = texts.plugin_description(path.read_text())
                self.assertEqual([f'path="{n}"' in text for n in names], [True], path)
                self.assertNotIn('"lib/', text)
                described += 1
        self.assertGreater(described, 5)

    def test_libraries_do_not_tell_where_they_were_built(self):
        script = script_module.load(ROOT / "scripts/deb")
        allowed = {pathlib.Path(p).name for p in script.SOURCES_LAST}
        libraries = sorted((script.DEVEL / "lib").glob("lib*.so"))
        if not libraries:
            self.skipTest("the build is not in devel/")
        # The folder of libraries is in all of them here, and not in those that are installed.
        told = [p.name for p in libraries if f"{ROOT}/src/".encode() in p.read_bytes()]
        self.assertEqual(set(told) - allowed, set())

    def test_maintainer_scripts_are_shell(self):
        scripts = texts.maintainer_scripts("ros-x", True, ["x@.service"], ["/var/lib/x"])
        self.assertEqual(sorted(scripts), ["postinst", "postrm", "prerm"])
        for text in scripts.values():
            self.assertEqual(subprocess.run(["sh", "-n"], input=text, text=True, check=False).returncode, 0, text)
        self.assertIn('if [ "$1" = purge ]; then rm -rf /var/lib/x; fi', scripts["postrm"])
        self.assertIn("systemctl stop 'x@*.service'", scripts["prerm"])
        self.assertIn("rm -f /etc/systemd/system/*.wants/x@*.service", scripts["postrm"])
        self.assertEqual(texts.maintainer_scripts("ros-x", False, [], []), {})

    def test_every_override_has_a_reason(self):
        text = texts.overrides("ros-x", ["library"])
        self.assertRegex(text, r"^(# .{20,}\nros-x: [a-z-]+\n)+$")
        self.assertGreater(len(texts.overrides("ros-x", ["library", "pkg-config"])), len(text))
        self.assertEqual(texts.overrides("ros-x", []), "")

    def test_the_unit_runs_what_its_file_says(self):
        script = script_module.load(ROOT / "scripts/check_deb")
        variables, command = script.of_unit(UNIT.read_text(), CONF.read_text(), "example")
        self.assertEqual(command, ["/usr/bin/roslaunch", "hyselam_bringup", "hyselam.launch", "scan:=scan", "work_dir:=/var/lib/hyselam/example"])
        self.assertEqual(variables["ROS_HOME"], "/var/lib/hyselam/example")
        _, command = script.of_unit(UNIT.read_text(), "HYSELAM_LAUNCH=slam.launch\nROSLAUNCH_OPTIONS=--wait\n", "a")
        self.assertEqual(command, ["/usr/bin/roslaunch", "--wait", "hyselam_bringup", "slam.launch"])

    def test_what_apt_downloads_is_read(self):
        script = script_module.load(ROOT / "scripts/check_deb")
        text = ("0 upgraded, 533 newly installed, 0 to remove and 0 not upgraded.\nNeed to get {}272 MB of archives.\n"
                "After this operation, 1326 MB of additional disk space will be used.\n")
        for had in ("", "0 B/"):
            self.assertEqual(script.downloads(text.format(had)), ("533", "272 MB", "1326 MB"))
        self.assertIsNone(script.downloads("0 upgraded, 0 newly installed, 0 to remove and 0 not upgraded.\n"))

    def test_packages_are_checked_on_the_release_they_were_made_on(self):
        script = script_module.load(ROOT / "scripts/check_deb")
        self.assertEqual(script.system_here('PRETTY_NAME="Debian GNU/Linux 13 (trixie)"\nVERSION_ID="13"\nID=debian\n'), "debian-13")
        versions = [texts.debian_version("0.1.0", release, "20260101.000000") for release in ("debian12", "debian13")]
        self.assertEqual(script.made_elsewhere(versions, "debian-13"), versions[:1])
        self.assertEqual(script.made_elsewhere(versions[1:], "debian-13"), [])
        with tempfile.TemporaryDirectory() as folder:
            def said(*arguments):
                run = subprocess.run([str(ROOT / "scripts/check_deb"), "--deb", folder, "--folder", f"{folder}/system", *arguments], capture_output=True,
                                     text=True, check=False)
                self.assertEqual((run.returncode, os.path.exists(f"{folder}/system")), (2, False), run.stderr)
                return run.stderr
            self.assertIn("no system debian-1 can be made; with --system: debian-11, debian-12, debian-13", said("--system", "debian-1"))
            self.assertIn("holds no packages", said("--system", "debian-13"))
            (pathlib.Path(folder) / "p/DEBIAN").mkdir(parents=True)
            fields = {"Package": "ros-p", "Version": versions[0], "Architecture": "all", "Maintainer": "M <m@example.org>"}
            (pathlib.Path(folder) / "p/DEBIAN/control").write_text(texts.control(fields, "Packed for a test."))
            subprocess.run(["dpkg-deb", "--root-owner-group", "--build", f"{folder}/p", f"{folder}/ros-p.deb"], check=True, capture_output=True)
            self.assertIn(f"packages that were not made on debian-13: {versions[0]}", said("--system", "debian-13"))

    def test_what_runs_in_the_system_is_shell(self):
        script = script_module.load(ROOT / "scripts/check_deb")
        variables, command = script.of_unit(UNIT.read_text(), CONF.read_text(), "example")
        for text in (script.BARE, script.UNOWNED, script.DEMO, script.HELP, script.BOOT, script.BOOTED, script.ACTS, script.unit_step(variables, command)):
            run = subprocess.run(["bash", "-n"], input=text, text=True, capture_output=True, check=False)
            self.assertEqual((run.returncode, run.stderr), (0, ""), text)
        compile(script.PROBE, "PROBE", "exec")

    def test_the_unit_s_user_has_no_rights(self):
        text = UNIT.read_text()
        for line in ("DynamicUser=yes", "CapabilityBoundingSet=", "NoNewPrivileges=yes", "ProtectSystem=strict", "Restart=on-failure"):
            self.assertIn(f"\n{line}\n", text)

    @unittest.skipUnless(shutil.which("systemd-analyze") and pathlib.Path("/usr/bin/roslaunch").exists(), "no systemd-analyze, or ROS is not in /usr")
    def test_systemd_has_nothing_to_say_of_the_unit(self):
        run = subprocess.run(["systemd-analyze", "verify", "--man=no", str(UNIT)], capture_output=True, text=True, check=False)
        self.assertEqual([line for line in (run.stdout + run.stderr).splitlines() if "hyselam" in line], [])
        # systemd 247 ends with 1 where the machine was not booted by it, without a word.
        self.assertTrue(run.returncode == 0 or not pathlib.Path("/run/systemd/system").exists(), run.stderr)

    @unittest.skipUnless(shutil.which("dpkg-scanpackages"), "dpkg-dev is not installed")
    def test_an_apt_repository_of_a_folder(self):
        script = str(ROOT / "scripts/apt_repository")
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            run = subprocess.run([script, str(folder)], capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 1)
            self.assertIn("holds no .deb", run.stderr)
            (folder / "p/DEBIAN").mkdir(parents=True)
            (folder / "p/DEBIAN/control").write_text(texts.control({"Package": "ros-p", "Version": "1-1", "Architecture": "all", "Maintainer": "M <m@example.org>"},
                                                                   "Packed for a test."))
            subprocess.run(["dpkg-deb", "--root-owner-group", "--build", str(folder / "p"), str(folder / "ros-p_1-1_all.deb")], check=True, capture_output=True)
            run = subprocess.run([script, str(folder)], capture_output=True, text=True, check=True)
            self.assertEqual(run.stdout, f"deb [trusted=yes] file:{folder} ./\n")
            self.assertIn("Package: ros-p\n", (folder / "Packages").read_text())
            self.assertIn(" Packages.gz\n", (folder / "Release").read_text())


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "packages", PackagesTest)
