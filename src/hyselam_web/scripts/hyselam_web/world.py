"""What a page is shown, as channels of plain JSON values, each with the number of its last change: whoever was told all up to
number n gets what changed since, and nothing else. A page that falls behind misses what is old, never what is new."""
import json

MAX_LOG = 300  # entries that a log keeps
MAX_REMOVED = 2000  # items of which it is remembered that they are gone


class World:
    """Three kinds of channels: values, tables of items with keys, and logs that only grow. The caller serializes access."""

    def __init__(self):
        self.version = 0
        self._values = {}  # name: (version, value)
        self._tables = {}  # name: {key: (version, value)}
        self._removed = {}  # name: {key: version}
        self._logs = {}  # name: [(version, entry)]
        self._forgotten = 0  # whoever knows less than this number gets everything anew

    def next_version(self):
        """A number for a change that is kept elsewhere."""
        self.version += 1
        return self.version

    def set(self, name, value):
        """True if that is another value than before."""
        known = self._values.get(name)
        if known is not None and known[1] == value:
            return False
        self._values[name] = (self.next_version(), value)
        return True

    def get(self, name, default=None):
        known = self._values.get(name)
        return default if known is None else known[1]

    def set_table(self, name, items):
        """The whole table: {key: value}, keys are texts."""
        table, removed = self._tables.setdefault(name, {}), self._removed.setdefault(name, {})
        changed = False
        for key in [k for k in table if k not in items]:
            del table[key]
            removed[key] = self.next_version()
            changed = True
        for key, value in items.items():
            known = table.get(key)
            if known is None or known[1] != value:
                table[key] = (self.next_version(), value)
                removed.pop(key, None)
                changed = True
        if len(removed) > MAX_REMOVED:
            self._forgotten = max(removed.values())
            removed.clear()
        return changed

    def table(self, name):
        return {key: value for key, (_, value) in self._tables.get(name, {}).items()}

    def item(self, name, key):
        known = self._tables.get(name, {}).get(str(key))
        return None if known is None else known[1]

    def append(self, name, entry):
        log = self._logs.setdefault(name, [])
        log.append((self.next_version(), entry))
        del log[:-MAX_LOG]

    def log(self, name):
        return [entry for _, entry in self._logs.get(name, [])]

    def delta(self, since):
        """What changed after number `since`: {"v": number, "d": {channel: ...}}, with "full" if the receiver shall forget all
        that it knew; None if nothing did. Tables come as {"+": {key: value}, "-": [key]}, logs as lists of new entries."""
        if since >= self.version and since > 0:
            return None
        full = since <= 0 or since < self._forgotten
        if full:
            since = 0
        changes = {name: value for name, (version, value) in self._values.items() if version > since}
        for name, table in self._tables.items():
            new = {key: value for key, (version, value) in table.items() if version > since}
            gone = [] if full else [key for key, version in self._removed[name].items() if version > since]
            if new or gone:
                changes[name] = dict(([("+", new)] if new else []) + ([("-", gone)] if gone else []))
        for name, log in self._logs.items():
            new = [entry for version, entry in log if version > since]
            if new:
                changes[name] = new
        message = {"v": self.version, "d": changes}
        if full:
            message["full"] = True
        return message


def to_text(value):
    """Short JSON, as it goes to pages and recordings. @throws ValueError for NaN and infinity."""
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
