#!/usr/bin/env python3
"""The recording of the day, reports, and the page as one file."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import fake_robot  # noqa: E402, F401 (finds the package)
from hyselam_web import app, recording, reports, tiles, world  # noqa: E402
from web_world_test import apply  # noqa: E402


class RecordingTest(unittest.TestCase):
    def test_a_recording_gives_back_what_pages_saw(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w, map_tiles = os.path.join(folder, "day.jsonl"), world.World(), tiles.MapTiles()
            recorder = recording.Recorder(path)
            page = {"v": 0}
            for step in range(50):
                w.set("value", step // 5)
                w.set_table("table", {str(step // 10): step // 3})
                recorder.take(float(step), w, map_tiles)
            recorder.close()
            for entry in recording.read(path):
                apply(page, dict(entry, v=1))
            self.assertEqual((page["value"], page["table"]), (9, {"4": 16}))

    def full_recording(self, folder, text, steps):
        """One that ends at its size, and does."""
        path, w = os.path.join(folder, "day.jsonl"), world.World()
        recorder = recording.Recorder(path, most_bytes=2000)
        for step in range(steps):
            w.set("value", text + str(step))
            recorder.take(float(step), w, tiles.MapTiles())
        recorder.close()
        self.assertTrue(recorder.full)
        self.assertLessEqual(os.path.getsize(path), 2000)
        return path

    def test_a_recording_ends_at_its_size_and_one_that_is_cut_off_is_read_so_far(self):
        with tempfile.TemporaryDirectory() as folder:
            path = self.full_recording(folder, "x" * 20, 1000)
            entries = recording.read(path)
            self.assertGreater(len(entries), 10)
            with open(path, "r+") as file:
                file.truncate(os.path.getsize(path) - 5)
            self.assertEqual(recording.read(path), entries[:-1])

    def test_a_server_that_died_leaves_its_recording_to_the_next(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            for morning in range(3):
                recorder = recording.Recorder(path)  # and never closed
                w.set("value", morning)
                recorder.take(float(morning), w, tiles.MapTiles())
            recording.Recorder(path)
            recording.Recorder(path).close()  # there is nothing in the one before
            names = sorted(set(os.listdir(folder)) - {"day.jsonl"})
            self.assertEqual(len(names), 3, names)
            self.assertEqual(sorted(recording.read(os.path.join(folder, n))[0]["d"]["value"] for n in names), [0, 1, 2])

    def test_the_size_of_a_recording_is_one_of_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            self.full_recording(folder, "日本語" * 10, 100)

    @unittest.skipUnless(os.path.exists("/dev/full"), "this system has no /dev/full")
    def test_a_full_disc_ends_the_recording_and_nothing_else(self):
        w = world.World()
        recorder = recording.Recorder("/dev/full")
        w.set("value", 1)
        with self.assertLogs("hyselam_web", "ERROR"):
            recorder.take(0.0, w, tiles.MapTiles())
        self.assertTrue(recorder.full)
        recorder.take(5.0, w, tiles.MapTiles())
        recorder.close()

    def test_files_that_are_no_recordings_are_refused_with_their_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "day.jsonl")
            for text, reason in (("{}\n", "line 1"), ("nothing\n", "line 1"), (json.dumps(recording.FORMAT) + '\n{"t":1}\n', "line 2")):
                with open(path, "w") as file:
                    file.write(text)
                with self.assertRaisesRegex(ValueError, reason):
                    recording.read(path)

    def test_names_that_look_like_html_stay_text_in_the_page_of_a_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            path, w = os.path.join(folder, "day.jsonl"), world.World()
            recorder = recording.Recorder(path)
            w.set("names", ["</script><script>alert(1)</script>", "<!--"])
            recorder.take(0.0, w, tiles.MapTiles())
            recorder.close()
            page = os.path.join(folder, "index.html")
            recording.write_static(path, str(fake_robot.PACKAGE / "www"), page)
            with open(page) as file:
                text = file.read()
            self.assertNotIn("<script>alert", text)
            self.assertEqual(text.count("</script>"), 2)
            for asset in ("src=", "import ", "href=\"style.css"):
                self.assertNotIn(asset, text.split("window.HYSELAM_RECORDING")[0])


class ReportsTest(unittest.TestCase):
    def test_only_files_below_the_folder_are_found_by_names_from_the_list(self):
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "day/slam"))
            os.makedirs(os.path.join(folder, "day/web"))
            for name in ("day/slam/report.html", "day/map.png", "day/secret.key", "day/.hidden.html", "day/web/day.jsonl", "day/web/index.html"):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(name)
            os.symlink("/etc/passwd", os.path.join(folder, "day/link.txt"))
            os.symlink("/etc", os.path.join(folder, "day/etc"))
            found = reports.Reports(folder)
            self.assertEqual(found.scan(), ["day/slam/report.html"])
            self.assertIsNotNone(found.find("day/map.png"))
            for name in ("day/secret.key", "day/.hidden.html", "day/link.txt", "day/etc/passwd", "../etc/passwd", "/etc/passwd", "day/../day/map.png", ""):
                self.assertIsNone(found.find(name), name)


class PageTest(unittest.TestCase):
    def test_both_languages_say_everything(self):
        www = fake_robot.PACKAGE / "www"
        script = recording.one_script(str(www / "js"), "i18n.js") + "\nconsole.log(JSON.stringify([missingTexts(), Object.keys(TEXTS.en)]));"
        node = subprocess.run(["node", "-e", script], stdout=subprocess.PIPE, text=True) if shutil.which("node") else None
        if node is None:
            self.skipTest("node is not installed; the browser test looks, too")
        missing, keys = json.loads(node.stdout)
        self.assertEqual(missing, [])
        self.assertGreater(len(keys), 100)

    def test_all_modules_are_asked_for_at_once(self):
        files = app.static_files(str(fake_robot.PACKAGE / "www"))
        asked = re.findall(r'<link rel="modulepreload" href="([^"]*)">', files["/"][0].decode())
        self.assertEqual(["/" + each for each in asked], sorted(address for address in files if address.endswith(".js")))
        self.assertGreater(len(asked), 15)

    def test_nothing_is_loaded_from_elsewhere(self):
        for address, (data, kind) in app.static_files(str(fake_robot.PACKAGE / "www")).items():
            text = data.decode()
            for foreign in ("https://", "http://", "//cdn"):
                for line in text.splitlines():
                    self.assertFalse(foreign in line and "www.w3.org" not in line, f"{address}: {line[:80]}")
            self.assertNotIn("innerHTML", text, address)


if __name__ == "__main__":
    import rosunit
    rosunit.unitrun("hyselam_web", "web_recording_test", "web_recording_test")
