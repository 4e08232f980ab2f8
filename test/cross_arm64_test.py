#!/usr/bin/env python3
"""scripts/cross_arm64 without a network and without another system: what is unpacked of a package, which gtests are the cores', how files are
compared, its section of the page."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

import rostest

SCRIPT = pathlib.Path(os.path.realpath(__file__)).parent.parent / "scripts/cross_arm64"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPT.parent))

import script_module

cross = script_module.load(SCRIPT)
RECORD = {"system": "debian-12", "cross": "arm64", "compiler_asked": None, "compiler": "aarch64-linux-gnu-g++ (Debian 12.2.0-14) 12.2.0", "emulator": "7.2",
          "date": "2026-01-02", "commit": "0123abcd", "complete": True, "build_passed": False, "build_minutes": 9.6, "build_continued": False,
          "built": {"objects": 20, "libraries": 3}, "gtests": {"of": 5, "with_ros": 2, "chosen": 3, "not_built": ["b_test"]}, "test_minutes": 4.4,
          "tests": {"passed": 7, "failed": 1, "skipped": 0}, "failures": ["a: S.c: no"], "left_out": [],
          "compared": [{"what": "places", "program": "p/gr2to", "arguments": "map.yaml", "files": ["a", "b"], "different": {}},
                       {"what": "graph", "program": "p/optimize", "arguments": "g", "files": ["c"], "different": {"c": "1 of 2 numbers differ, at most by 1e-09"}},
                       {"what": "names", "program": "p/names", "arguments": "n", "files": ["d"], "failed": "not built on both"}]}


class CrossTest(unittest.TestCase):
    def test_of_a_package_the_libraries_go_into_the_system_and_no_program(self):
        kept = {"./lib/aarch64-linux-gnu/libc.so.6": "usr/lib/aarch64-linux-gnu/libc.so.6", "./lib/ld-linux-aarch64.so.1": "usr/lib/ld-linux-aarch64.so.1",
                "./usr/lib/aarch64-linux-gnu/cmake/a/aConfig.cmake": "usr/lib/aarch64-linux-gnu/cmake/a/aConfig.cmake", "./usr/include/a.h": "usr/include/a.h",
                "./usr/lib/libarmadillo.so": "usr/lib/libarmadillo.so", "./usr/share/roscpp/package.xml": "usr/share/roscpp/package.xml",
                "./usr/bin/vtkWrapJava-9.1": "usr/bin/vtkWrapJava-9.1",
                "./usr/lib/python3/dist-packages/vtkmodules/vtkA.cpython-311-aarch64-linux-gnu.so":
                    "usr/lib/python3/dist-packages/vtkmodules/vtkA.cpython-311-aarch64-linux-gnu.so"}
        for name, expected in kept.items():
            self.assertEqual(cross.wanted_member(name), expected)
        for name in ("./usr/bin/python3", "./bin/sh", "./etc/passwd", "./usr/share/doc/a/copyright", "./usr/lib/qt5/bin/moc", "./usr/lib/python3/a.py", "./var/x"):
            self.assertIsNone(cross.wanted_member(name), name)

    @unittest.skipUnless(shutil.which("dpkg-deb"), "dpkg is not installed")
    def test_unpacking_leaves_what_is_there_and_keeps_links(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            tree, root = folder / "tree", folder / "root"
            library = tree / "usr/lib/aarch64-linux-gnu"
            for path, text in ((library / "blas/libblas.so.3", "arm"), (tree / "usr/include/both.h", "arm"), (tree / "usr/bin/tool", "arm"),
                               (tree / "DEBIAN/control", "Package: a\nVersion: 1\nArchitecture: arm64\nMaintainer: A <a@example.org>\nDescription: a\n")):
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            (library / "liba.so").symlink_to("liba.so.1")
            os.link(library / "blas/libblas.so.3", library / "libhard.so")
            subprocess.run(["dpkg-deb", "--build", str(tree), str(folder / "a.deb")], check=True, capture_output=True)
            (root / "usr/include").mkdir(parents=True)
            (root / "usr/include/both.h").write_text("amd64")
            cross.unpack(folder / "a.deb", root)
            cross.link_alternatives(root)
            there = root / "usr/lib/aarch64-linux-gnu"
            self.assertEqual((root / "usr/include/both.h").read_text(), "amd64")
            self.assertFalse((root / "usr/bin").exists())
            self.assertEqual(os.readlink(there / "liba.so"), "liba.so.1")
            self.assertEqual((there / "libhard.so").read_text(), "arm")
            self.assertEqual((os.readlink(there / "libblas.so.3"), (there / "libblas.so.3").read_text()), ("blas/libblas.so.3", "arm"))
            (folder / "b.deb").write_text("no package")
            with self.assertRaises((cross.platform.PlatformError, tarfile.TarError)):
                cross.unpack(folder / "b.deb", root)

    def test_libraries_are_asked_of_arm64_and_programs_are_not(self):
        packages = cross.arm_packages()
        self.assertIn("libroscpp-dev", packages)
        self.assertIn("zlib1g-dev", packages)
        self.assertEqual([p for p in packages if p in ("cmake", "chromium", "python3-rospy", "rviz", "build-essential")], [])

    def test_gtests_that_link_roscpp_are_told_apart(self):
        with tempfile.TemporaryDirectory() as folder:
            build = pathlib.Path(folder)
            for package in ("a", "b"):
                (build / package).mkdir()
                (build / package / "CTestTestfile.cmake").write_text(
                    f'add_test(_ctest_{package}_gtest_{package}_core "x")\nadd_test(_ctest_{package}_gtest_{package}_ros "x")\nadd_test(_ctest_{package}_rostest_t "x")\n')
            rule = "build /w/devel/lib/{0}/{0}_{1}: CXX_EXECUTABLE_LINKER__{0}_{1}_Release x.o\n  LINK_LIBRARIES = {2}\n\n"
            (build / "build.ninja").write_text("".join(rule.format(p, t, lib) for p in "ab" for t, lib in (("core", "liba.so"), ("ros", "/usr/lib/libroscpp.so"))))
            self.assertEqual(cross.gtests_of(build, []), {"a_core": False, "a_ros": True, "b_core": False, "b_ros": True})
            self.assertEqual(cross.gtests_of(build, ["b"]), {"b_core": False, "b_ros": True})

    def test_differences_are_told_in_numbers_where_only_numbers_differ(self):
        self.assertIsNone(cross.difference(b"x 1.5", b"x 1.5"))
        self.assertEqual(cross.difference(b"x 1.5 2 -3e-1", b"x 1.5 2.25 -3e-1"), "1 of 3 numbers differ, at most by 0.25")
        self.assertIn("other bytes", cross.difference(b"x 1.5", b"y 1.5"))
        self.assertTrue(cross.only_rounded(cross.difference(b"x 1.5", b"x 1.5000000000000002")))
        for other in (b"x 1.50001", b"y 1.5", b"x 1.5 1"):
            self.assertFalse(cross.only_rounded(cross.difference(b"x 1.5", other)), other)
        self.assertIn("other bytes", cross.difference(b"\x89PNG 1", b"\x89PNG 2"))

    def test_what_differs_is_replaced_by_what_amd64_wrote(self):
        with tempfile.TemporaryDirectory() as folder:
            here, there = pathlib.Path(folder) / "here", pathlib.Path(folder) / "there"
            for root, texts in ((here, {"same": "1", "m/a": "x 1", "m/only": "a", "other": "1"}), (there, {"same": "1", "m/a": "x 2", "m/theirs": "b"})):
                for name, text in texts.items():
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text(text)
            self.assertEqual(cross.differences(here, there, ["same", "m/", "other", "none"]),
                             {"m/a": "1 of 1 numbers differ, at most by 1", "m/only": "written on amd64 only", "m/theirs": "written on arm64 only",
                              "none": "written on neither", "other": "written on amd64 only"})
            self.assertEqual({str(p.relative_to(there)): p.read_text() for p in there.rglob("*") if p.is_file()},
                             {"same": "1", "m/a": "x 1", "m/a.differs": "x 2", "m/only": "a", "m/theirs.differs": "b", "other": "1"})

    def test_the_drawn_graph_is_always_the_same_and_has_loops(self):
        graph = cross.drawn_graph()
        self.assertEqual(graph, cross.drawn_graph())
        edges = [tuple(map(int, line.split()[1:3])) for line in graph.splitlines() if line.startswith("EDGE_SE2")]
        self.assertEqual(graph.count("VERTEX_SE2"), 240)
        self.assertGreater(sum(j - i > 1 for i, j in edges), 20)

    def test_the_page_has_a_section_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "debian-12-arm64.json").write_text(json.dumps(RECORD))
            cross.platform.write_table(folder, folder / "page.md")
            page = (folder / "page.md").read_text()
        section = page[page.index("## Debian 12, cross-built for arm64"):]
        self.assertNotIn("| Debian 12 |", page)
        self.assertIn("| aarch64-linux-gnu-g++ 12.2.0 | qemu-user 7.2 | 2026-01-02 | 0123abcd | 10, **not all** | 20 | 3 | 2 of the tree's 5 | 4 | 7 | 1 | 0 |", section)
        self.assertIn("- not built: b_test\n- failed: a: S.c: no\n", section)
        self.assertIn("| places | `gr2to map.yaml` | 2 | none, same bytes |", section)
        self.assertIn("| graph | `optimize g` | 1 | c: 1 of 2 numbers differ, at most by 1e-09 |", section)
        self.assertIn("| names | `names n` | 1 | not built on both |", section)

    def test_arguments_that_make_no_sense_are_refused(self):
        run = subprocess.run([str(SCRIPT), "--jobs", "0"], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2)
        self.assertIn("at least 1", run.stderr)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "cross_arm64_test", CrossTest)
