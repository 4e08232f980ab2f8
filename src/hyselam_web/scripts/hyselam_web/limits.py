"""How much one page may ask for."""
import collections

MAX_MESSAGE_BYTES = 16384  # of one frame from a page
MAX_TEXT = 2000  # characters of a sentence
MAX_QUESTION = 200  # of a sentence that is only tried
MAX_NAME = 80
MAX_NAMES = 8
MAX_DIGITS = 400  # of a whole number
MAX_PAGES = 100
MAX_PAGES_OF_ADDRESS = 40
MAX_STRANGERS = 20  # pages without a role
STALLED = 30.0  # [s] that a page may not take anything
FLOOD = 200  # refused messages at once after which a page is disconnected

# What may be asked for: so many at once, so many a second.
RATES = {"message": (40, 20.0), "say": (5, 1.0), "try": (5, 1.0), "act": (10, 2.0), "slow": (2, 0.1),
         "refused": (FLOOD, 1.0), "reason": (20, 1.0),  # refusals of a page, and those that are told
         "login": (5, 0.1), "logins": (300, 10.0)}  # wrong ones, of an address and of all


class Bucket:
    def __init__(self, size, rate):
        self.size, self.rate, self.level, self.last = size, rate, float(size), None

    def has(self, now):
        """Whether take() would be True."""
        self._fill(now)
        return self.level >= 1.0

    def _fill(self, now):
        if self.last is not None:
            self.level = min(self.size, self.level + self.rate * max(0.0, now - self.last))
        self.last = now

    def take(self, now):
        """False: too much."""
        if not self.has(now):
            return False
        self.level -= 1.0
        return True


class Buckets:
    """One set of buckets a page, or an address; the oldest are forgotten."""

    def __init__(self, kinds=None, most=1000):
        self._kinds, self._most, self._known = kinds or RATES, most, collections.OrderedDict()

    def has(self, who, kind, now):
        known = self._known.get((who, kind))
        return known is None or known.has(now)

    def take(self, who, kind, now):
        key = (who, kind)
        bucket = self._known.pop(key, None) or Bucket(*self._kinds[kind])
        self._known[key] = bucket
        while len(self._known) > self._most:
            self._known.popitem(last=False)
        return bucket.take(now)
