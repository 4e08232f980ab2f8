"""What pages may ask for: one JSON object a message, each field of a kind and within limits; all else is refused."""
import json
import math
import unicodedata

from . import limits

LINE = {"ax": "coordinate", "ay": "coordinate", "bx": "coordinate", "by": "coordinate"}  # from one end to the other

# name: (role, bucket, {field: kind}); a kind that ends with ? may be missing.
REQUESTS = {
    "stop": ("", "message", {"language": "language?"}),
    "hide": ("look", "message", {"on": "flag"}),
    "say": ("talk", "say", {"text": "text"}),
    "try": ("talk", "try", {"text": "short"}),
    "name": ("talk", "act", {"place": "id", "names": "names", "language": "language?"}),
    "go": ("drive", "act", {"place": "id", "language": "language"}),
    "here": ("drive", "act", {"place": "id"}),
    "pose": ("drive", "act", {"x": "coordinate", "y": "coordinate", "yaw": "coordinate"}),
    "wall": ("drive", "act", dict(LINE, language="language?")),
    "unwall": ("drive", "act", dict(LINE, virtual="flag", language="language?")),
    "shut": ("drive", "act", {"door": "id", "language": "language?"}),
    "learn": ("drive", "slow", {"on": "flag"}),
    "save": ("drive", "slow", {}),
    "doctor": ("look", "slow", {}),
}


class Refused(ValueError):
    """A request that is not taken: a word for programs, a reason for people, the page's number of it."""

    def __init__(self, code, reason, number=None):
        super().__init__(reason)
        self.code, self.number = code, number


def clean(text):
    """Without control characters; None: nothing is left."""
    kept = "".join(" " if unicodedata.category(c) in ("Cc", "Zl", "Zp") else c for c in text
                   if unicodedata.category(c) not in ("Cf", "Cs", "Co", "Cn") or c in "\u200c\u200d")
    return " ".join(kept.split()) or None


def checked(kind, value):
    """The value, or None: it is not of the kind."""
    if kind == "flag":
        return value if isinstance(value, bool) else None
    if kind == "id":
        return value if isinstance(value, int) and not isinstance(value, bool) and 0 < value < 2 ** 32 else None
    if kind == "coordinate":
        fits = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e5 and math.isfinite(value)
        return float(value) if fits else None
    if kind == "language":
        return value if value in ("en", "pt") else None
    if kind in ("text", "short"):
        most = limits.MAX_TEXT if kind == "text" else limits.MAX_QUESTION
        return clean(value) if isinstance(value, str) and len(value) <= most else None
    if kind == "names":
        if not isinstance(value, list) or len(value) > limits.MAX_NAMES:
            return None
        names = [clean(v) if isinstance(v, str) and len(v) <= limits.MAX_NAME else None for v in value]
        return None if None in names else names
    raise KeyError(kind)


def parse(text):
    """(name, fields, the page's number of it or None) of a message. @throws Refused."""
    def no_constant(_):
        raise ValueError("not a number")

    def whole(digits):
        if len(digits) > limits.MAX_DIGITS:  # Python before 3.10.7 reads any, in time that grows by their square
            raise ValueError("too many digits")
        return int(digits)
    try:
        message = json.loads(text, parse_constant=no_constant, parse_int=whole)
    except (ValueError, RecursionError):
        raise Refused("malformed", "this is no JSON")
    number = message.pop("n", None) if isinstance(message, dict) else None
    if isinstance(number, bool) or not isinstance(number, int) or abs(number) >= 2 ** 53:
        number = None
    if not isinstance(message, dict) or not isinstance(message.get("do"), str):
        raise Refused("malformed", "this is no request", number)
    name = message.pop("do")
    if name not in REQUESTS:
        raise Refused("unknown", "there is no such request", number)
    kinds, fields = REQUESTS[name][2], {}
    is_stop = name == "stop"  # nothing that comes with it keeps the robot from stopping: what does not fit is left out
    for field, kind in kinds.items():
        if kind.endswith("?") and field not in message:
            continue
        kind = kind.rstrip("?")
        value = checked(kind, message.pop(field, None))
        if value is None and is_stop:
            continue
        if value is None:
            raise Refused("invalid", f"'{field}' is missing, or no {kind}, or too long", number)
        fields[field] = value
    if message and not is_stop:
        raise Refused("invalid", "there are fields that do not belong to it", number)
    return name, fields, number
