"""Who may do what: tokens with roles, cookies that tell the role, hosts and origins."""
import hashlib
import hmac
import ipaddress
import secrets
from urllib.parse import urlsplit

ROLES = ("look", "talk", "drive")  # each may do what those before it may
NOBODY = ""
LIFETIME = 30 * 86400  # [s] of a cookie
MIN_TOKEN = 8  # characters


def may(role, needed):
    return needed == NOBODY or (role in ROLES and ROLES.index(role) >= ROLES.index(needed))


def parse_tokens(text):
    """{role: token} of "look=AAAA talk=BBBB drive=CCCC", or of one token, which drives. @throws ValueError."""
    tokens = {}
    for word in text.replace(",", " ").split():
        role, equals, token = word.partition("=")
        if not equals:
            role, token = "drive", word
        if role not in ROLES:
            raise ValueError(f"the role '{role}' is none of {', '.join(ROLES)}")
        if role in tokens:
            raise ValueError(f"there are two tokens of the role {role}")
        if len(token) < MIN_TOKEN:
            raise ValueError(f"the token of the role {role} has fewer than {MIN_TOKEN} characters")
        tokens[role] = token
    if len(set(tokens.values())) < len(tokens):
        raise ValueError("two roles have one token")
    return tokens


class Access:
    def __init__(self, tokens, hosts=(), port=0):
        self._tokens = {role: token.encode() for role, token in tokens.items()}
        self._hosts = {host.lower() for host in hosts} | {"localhost"}
        self.port = port
        # Cookies outlive a restart, and end with the tokens. Slowly made: who has a cookie could otherwise guess tokens without asking here.
        known = b"\0".join(r.encode() + b"=" + t for r, t in sorted(self._tokens.items()))
        self._key = hashlib.scrypt(known, salt=b"hyselam_web cookie", n=2 ** 14, r=8, p=1, dklen=32) if self._tokens else secrets.token_bytes(32)

    @property
    def needs_login(self):
        return bool(self._tokens)

    def role_of_token(self, token):
        """NOBODY: it is none. All are compared, in time that does not depend on what is given."""
        given, found = hashlib.sha256(token.encode("utf-8", "replace")).digest(), NOBODY
        for role, known in self._tokens.items():
            if hmac.compare_digest(given, hashlib.sha256(known).digest()):
                found = role
        return found

    def _sign(self, text):
        return hmac.new(self._key, text.encode("utf-8", "replace"), hashlib.sha256).hexdigest()

    def cookie(self, role, now):
        text = f"{role}.{int(now + LIFETIME)}.{secrets.token_hex(8)}"
        return f"{text}.{self._sign(text)}"

    def role_of_cookie(self, cookie, now):
        if not self._tokens:
            return "drive"
        text, _, signature = (cookie or "").rpartition(".")
        if not hmac.compare_digest(self._sign(text).encode(), signature.encode("utf-8", "replace")):
            return NOBODY
        role, until, _ = text.split(".")
        return role if now < int(until) and role in self._tokens else NOBODY

    def knows_host(self, host):
        """Of the header Host: a name of this machine, or an address. Another name may be someone else's that leads here
        (DNS rebinding)."""
        try:
            name = urlsplit("//" + host).hostname if host else None
        except ValueError:
            return False
        if not name:
            return False
        if name.lower() in self._hosts:
            return True
        try:
            ipaddress.ip_address(name)
            return True
        except ValueError:
            return False

    def knows_origin(self, origin, host):
        """Of a page that asks for something: the one that came from here."""
        try:
            return bool(origin) and bool(host) and urlsplit(origin).netloc.lower() == host.lower() and urlsplit(origin).scheme in ("http", "https")
        except ValueError:
            return False
