"""A day as the pages saw it, in a file of lines: {"t": seconds, "d": what changed, "tiles": [[column, row, PNG in base64]]}. The page plays
it, from the server or from a folder without any."""
import base64
import itertools
import json
import logging
import os
import re
import time

from . import world as worlds

FORMAT = {"format": "hyselam web recording", "version": 1}
LIVE_ONLY = ("login", "alive")  # channels that make no sense afterwards


log = logging.getLogger("hyselam_web")


def put_aside(path):
    """Renames what was recorded before: day.jsonl becomes day-20261126-081500.jsonl, of the time of its end. Returns the new name, or None."""
    if not os.path.isfile(path) or os.path.getsize(path) <= len(worlds.to_text(FORMAT)) + 1:
        return None
    start, ending = os.path.splitext(path)
    stamp = time.strftime("-%Y%m%d-%H%M%S", time.gmtime(os.path.getmtime(path)))
    names = (start + stamp + more + ending for more in itertools.chain([""], (f"-{n}" for n in itertools.count(2))))
    name = next(each for each in names if not os.path.exists(each))
    os.rename(path, name)
    return name


class Recorder:
    """Appends what changes to a new file, at most once a `period` of the robot's time; ends when the file has `most_bytes`. A recording that is
    there already, of a server that was killed, gets another name."""

    def __init__(self, path, period=1.0, most_bytes=20000000):
        self.path, self.period, self.most_bytes = path, period, most_bytes
        self.full = False
        self._since, self._last = 0, None
        self._bytes = 0
        put_aside(path)
        self._file = open(path, "w", encoding="utf-8")
        self._write(FORMAT)

    def _write(self, value):
        line = worlds.to_text(value) + "\n"
        self._bytes += len(line.encode())
        if self._bytes > self.most_bytes:
            self.full = True
            log.warning("%s: the recording ends: it has %d bytes", self.path, self.most_bytes)
            return
        self._file.write(line)

    def take(self, now, world, tiles):
        """What has changed since the last time; `now` is the robot's clock."""
        if self.full or (self._last is not None and 0 <= now - self._last < self.period):
            return
        delta = world.delta(self._since)
        if delta is None:
            return
        entry = {"t": round(now, 2), "d": {k: v for k, v in delta["d"].items() if k not in LIVE_ONLY}}
        if delta.get("full") and self._since > 0:
            entry["full"] = True
        pictures = [[x, y, base64.b64encode(tiles.tiles[(x, y)][1]).decode()] for x, y in tiles.changed_since(self._since)]
        if pictures:
            entry["tiles"] = pictures
        self._since, self._last = delta["v"], now
        if entry["d"] or pictures:
            try:
                self._write(entry)
                self._file.flush()
            except OSError as error:  # a full disc: pages go on
                self.full = True
                log.error("%s: the recording ends: %s", self.path, error.strerror or error)

    def close(self):
        try:
            self._file.close()
        except OSError:
            pass  # said before


def read(path):
    """The entries of a recording; a last line that is cut off is left out. @throws ValueError naming file and line."""
    entries = []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            try:
                value = json.loads(line)
            except ValueError:
                if not line.endswith("\n"):
                    break
                raise ValueError(f"{path}: line {number}: this is no JSON")
            if number == 1:
                if not isinstance(value, dict) or value.get("format") != FORMAT["format"]:
                    raise ValueError(f"{path}: line 1: this is no {FORMAT['format']}")
                if value != FORMAT:
                    newer = isinstance(value.get("version"), int) and value["version"] > FORMAT["version"]
                    raise ValueError(f"{path}: line 1: has version {value.get('version')!r}, this program reads {FORMAT['version']}" +
                                     ("; it was written by a newer HySeLAM" if newer else ""))
            elif not isinstance(value, dict) or not isinstance(value.get("t"), (int, float)) or not isinstance(value.get("d"), dict):
                raise ValueError(f"{path}: line {number}: this is no entry of a recording")
            else:
                entries.append(value)
    return entries


IMPORT = re.compile(r'^import [^;]*? from "\./([a-z0-9_]+\.js)";\n', re.MULTILINE | re.DOTALL)


def one_script(folder, first):
    """The modules of a page as one script, those that others need before them: browsers load no modules from files."""
    done, parts = set(), []

    def add(name):
        if name in done:
            return
        done.add(name)
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            text = file.read()
        for needed in IMPORT.findall(text):
            add(needed)
        parts.append(re.sub(r"^export ", "", IMPORT.sub("", text), flags=re.MULTILINE))
    add(first)
    return '"use strict";\n' + "\n".join(parts)


def write_static(recording, www, target):
    """One page that shows a recording, with all that it needs, for browsers without a server."""
    def text(*names):
        with open(os.path.join(www, *names), encoding="utf-8") as file:
            return file.read()
    entries = read(recording)
    page = text("index.html")
    data = worlds.to_text(entries).replace("<", "\\u003c")
    script = one_script(os.path.join(www, "js"), "main.js").replace("</script", "<\\/script")
    page = page.replace('<link rel="stylesheet" href="style.css">', "<style>\n" + text("style.css") + "</style>")
    page = page.replace('<link rel="icon" href="icon.svg">', "").replace('<link rel="manifest" href="manifest.json">', "")
    page = page.replace('<script type="module" src="js/main.js"></script>',
                        f"<script>window.HYSELAM_RECORDING={data};</script>\n<script>\n(() => {{\n{script}\n}})();\n</script>")
    draft = target + ".part"
    with open(draft, "w", encoding="utf-8") as file:
        file.write(page)
    os.replace(draft, target)
