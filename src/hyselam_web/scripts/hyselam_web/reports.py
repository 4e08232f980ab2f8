"""Reports that others wrote (SLAM, places, visual places), served by names from a list: a page never names a file."""
import os

TYPES = {".html": "text/html", ".png": "image/png", ".jpg": "image/jpeg", ".svg": "image/svg+xml", ".csv": "text/csv", ".json": "application/json",
         ".txt": "text/plain"}
RECORDING = "day.jsonl"
MAX_FILES = 2000
MAX_BYTES = 50000000
# Nothing is run, and nothing is asked of anybody.
POLICY = "default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'; frame-src 'self'; frame-ancestors 'self'; form-action 'none'; sandbox allow-same-origin"


class Reports:
    """The files below one folder, without hidden ones and without links."""

    def __init__(self, folder=""):
        self.folder = folder
        self._files = {}

    def scan(self):
        """Looks anew; returns the pages among the files, by name."""
        files = {}
        for root, folders, names in os.walk(self.folder) if self.folder else ():
            folders[:] = sorted(f for f in folders if not f.startswith(".") and not os.path.islink(os.path.join(root, f)))
            for name in sorted(names) if RECORDING not in names else ():  # the page plays it itself
                path = os.path.join(root, name)
                ending = os.path.splitext(name)[1].lower()
                if ending in TYPES and not name.startswith(".") and not os.path.islink(path) and os.path.isfile(path):
                    files[os.path.relpath(path, self.folder).replace(os.sep, "/")] = (path, TYPES[ending])
                if len(files) >= MAX_FILES:
                    folders.clear()
                    break
        self._files = files
        return [name for name in files if name.endswith(".html")]

    def find(self, name):
        """(path, type) of a file of the last scan; None: it is not in it."""
        found = self._files.get(name)
        if found is None or os.path.islink(found[0]) or not os.path.isfile(found[0]) or os.path.getsize(found[0]) > MAX_BYTES:
            return None
        return found
