#!/usr/bin/env python3
"""bench/all in a repository of its own, with steps that only write a line: what is done is not done again, what fails stops nothing."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import rostest
import yaml

ROOT = pathlib.Path(os.path.realpath(__file__)).parent.parent
STEPS = [{"name": "First one", "command": "echo run >> runs; echo figure 1", "minutes": 1},
         {"name": "broken", "command": "echo run >> broken_runs; echo why >&2; exit 3", "minutes": 2},
         {"name": "of recordings", "command": "ls {data}/laser > {out}/laser.txt", "minutes": 3, "data": ["laser"]}]


class BenchAllTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name) / "tree"
        for program in ("bench/all", "scripts/records.py"):
            (self.root / program).parent.mkdir(parents=True)
            shutil.copy(ROOT / program, self.root / program)
        (self.root / "bench/all.yaml").write_text(yaml.safe_dump({"steps": STEPS}))
        for command in (["init", "--quiet"], ["add", "bench", "scripts"], ["commit", "--quiet", "-m", "x"]):
            subprocess.run(["git", "-C", str(self.root), "-c", "user.name=a", "-c", "user.email=a@b", *command], check=True)

    def all(self, *arguments, data=None):
        done = subprocess.run([str(self.root / "bench/all"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                              env={**os.environ, "HYSELAM_DATA": str(data or self.root / "nowhere")})
        return done.returncode, done.stdout

    def commit(self, *files):
        for command in (["add", *files], ["commit", "--quiet", "-m", "y"]):
            subprocess.run(["git", "-C", str(self.root), "-c", "user.name=a", "-c", "user.email=a@b", *command], check=True)

    def out(self):
        return next((self.root / "out/all").iterdir())

    def test_what_is_done_is_not_done_again_and_what_failed_is(self):
        for again, runs in (((), 1), ((), 1), (("--again",), 2)):
            code, said = self.all(*again)
            self.assertEqual(code, 1, said)
            self.assertIn("FAILED   broken", said)
            self.assertIn("left out of recordings: no laser in ", said)
            self.assertEqual((self.root / "runs").read_text().count("run"), runs)
        self.assertEqual((self.root / "broken_runs").read_text().count("run"), 3)
        summary = (self.out() / "summary.md").read_text()
        for words in ("## First one\n\n`echo run >> runs; echo figure 1`", "```\nfigure 1\n```", "**failed** with status 3; [broken.log](broken.log)\n\n```\nwhy\n```",
                      "Left out: no laser in HYSELAM_DATA."):
            self.assertIn(words, summary)

    def test_a_step_with_its_data_is_run_by_a_part_of_its_name(self):
        (self.root.parent / "data/laser/a_log").mkdir(parents=True)
        code, said = self.all("recordings", data=self.root.parent / "data")
        self.assertEqual(code, 0, said)
        self.assertEqual((self.out() / "laser.txt").read_text(), "a_log\n")
        self.assertEqual(json.loads((self.out() / "of_recordings.json").read_text())["status"], 0)
        self.assertIn("Not run yet.", (self.out() / "summary.md").read_text())

    def test_an_interrupted_step_is_not_done(self):
        self.all("First")
        (self.out() / "first_one.json").unlink()  # as one that was broken off leaves it
        self.all("First")
        self.assertEqual((self.root / "runs").read_text().count("run"), 2)

    def test_what_another_commit_has_kept_counts_while_its_sources_are_the_same(self):
        for package, needs in (("core", ""), ("robot", "<depend>core</depend>"), ("page", "")):
            (self.root / "src" / package).mkdir(parents=True)
            (self.root / "src" / package / "package.xml").write_text(needs)
        (self.root / "bench/all.yaml").write_text(yaml.safe_dump({"steps": [{**STEPS[0], "of": ["robot"]}]}))
        self.commit("bench", "src")
        code, said = self.all("--keep")
        self.assertEqual(code, 0, said)
        record = json.loads((self.root / "docs/measured/first_one.json").read_text())
        self.assertEqual((record["lines"], record["status"]), (["figure 1"], 0))
        self.assertIn("| the same |", (self.root / "docs/measured.md").read_text())
        # What it does not depend on, and documents.
        (self.root / "src/page/page.js").write_text("new\n")
        (self.root / "src/robot/README.md").write_text("new\n")
        self.commit("docs", "src")
        code, said = self.all()
        self.assertEqual(code, 0, said)
        self.assertIn(f"kept     First one, of {record['commit']}: its sources are the same", said)
        self.assertEqual((self.root / "runs").read_text().count("run"), 1)
        # What its package needs.
        (self.root / "src/core/core.cpp").write_text("int core;\n")
        self.commit("src")
        self.assertIn("begins   First one", self.all()[1])
        self.assertEqual((self.root / "runs").read_text().count("run"), 2)

    def test_what_a_later_step_takes_is_made_again(self):
        steps = [{"name": "odds", "command": "echo run >> runs; echo 1 > {out}/odds.txt", "minutes": 1, "makes": "odds.txt"},
                 {"name": "robots", "command": "cat {out}/odds.txt; cat src/a/size", "minutes": 1, "of": ["a"]}]
        (self.root / "src/a").mkdir(parents=True)
        (self.root / "src/a/package.xml").write_text("")
        (self.root / "src/a/size").write_text("1\n")
        (self.root / "bench/all.yaml").write_text(yaml.safe_dump({"steps": [{**steps[0], "of": ["none"]}, steps[1]]}))
        self.commit("bench", "src")
        self.assertEqual(self.all("--keep")[0], 0)
        self.commit("docs")
        self.assertEqual(self.all()[1].count("kept "), 2)
        (self.root / "src/a/size").write_text("2\n")
        self.commit("src")
        code, said = self.all()
        self.assertEqual((code, (self.root / "runs").read_text().count("run")), (0, 2), said)

    def test_what_makes_no_sense_is_refused(self):
        self.assertEqual(self.all("nothing"), (2, "error: there is no step nothing: bench/all --list\n"))
        (self.root / "bench/all.yaml").write_text((self.root / "bench/all.yaml").read_text() + "# more\n")
        self.assertEqual(self.all(), (2, "error: the tree is modified: commit it first\n"))

    def test_each_step_of_the_tree_is_a_program_that_there_is(self):
        steps = [s for file in ("all", "nightly") for s in yaml.safe_load((ROOT / f"bench/{file}.yaml").read_text())["steps"]]
        self.assertEqual(len({s["name"] for s in steps}), len(steps))
        for step in steps:
            program = next(word for word in step["command"].split() if "=" not in word and "%" not in word)
            self.assertTrue(program == "rosrun" or os.access(ROOT / program, os.X_OK) and (ROOT / program).is_file(), step)


if __name__ == "__main__":
    rostest.rosrun("hyselam_bringup", "bench_all_test", BenchAllTest)
