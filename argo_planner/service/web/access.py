"""Who may do what: roles, and the tokens that give them."""

import hashlib
import hmac
import os
import secrets
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from urllib.parse import unquote

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_planner.service.core.plan_limits import require_name

SHORTEST_TOKEN = 16
"""characters"""
AUTHOR_HEADER = "argo-author"
"""the HTTP header in which a client says who is working, percent-encoded"""
_SECRET = ".token"
"""the file of a folder that has its token"""


class AccessRole(StrEnum):
    """What somebody may do; each may do what those before may."""

    VIEW = "view"
    """look at missions, runs and the world"""
    PLAN = "plan"
    """change missions and obstacles, suggest orders"""
    OPERATE = "operate"
    """start runs and steer them"""

    def includes(self, other: "AccessRole") -> bool:
        """Whether who has this one may do what the other one may."""
        roles = list(AccessRole)
        return roles.index(self) >= roles.index(other)


class AccessDenied(ArgoError):
    """The role does not allow it."""

    code = "access-denied"


class TokenMissing(ArgoError):
    """No token was given, or an unknown one."""

    code = "token-missing"


@dataclass(frozen=True)
class AccessToken:
    """A secret, and what who has it may do."""

    secret: str
    role: AccessRole = AccessRole.OPERATE
    name: str | None = None
    """who it is; None: who has it says so"""

    @property
    def cookie(self) -> str:
        """What stands for it in a cookie, from which it can't be found out."""
        return hmac.new(self.secret.encode(), b"argo cookie", hashlib.sha256).hexdigest()


@dataclass(frozen=True)
class Visitor:
    """Who has sent a request."""

    role: AccessRole
    author: str
    named: bool = False
    """whether the token says who it is"""

    def require(self, role: AccessRole) -> None:
        """Raises AccessDenied."""
        if not self.role.includes(role):
            raise AccessDenied(
                f"this takes the role `{role}`, and yours is `{self.role}`: ask for another token"
            )


class TokenBook:
    """The tokens of a service."""

    def __init__(self, tokens: Iterable[AccessToken]) -> None:
        self._tokens = tuple(tokens)

    def of_secret(self, secret: str) -> AccessToken | None:
        """The token with that secret. Takes as long for a wrong one."""
        return self._matching(secret, [token.secret for token in self._tokens])

    def of_cookie(self, cookie: str) -> AccessToken | None:
        """The token that a cookie stands for."""
        return self._matching(cookie, [token.cookie for token in self._tokens])

    def _matching(self, given: str, wanted: list[str]) -> AccessToken | None:
        found = None
        for token, one in zip(self._tokens, wanted, strict=True):
            if secrets.compare_digest(given.encode(errors="replace"), one.encode()):
                found = token
        return found


def visitor(token: AccessToken, headers: Mapping[str, str], query: Mapping[str, str]) -> Visitor:
    """Who has sent a request with that token. Raises Invalid for what can't be a name."""
    said = headers.get(AUTHOR_HEADER) or query.get("author")
    if token.name is not None or not said:
        return Visitor(token.role, token.name or "somebody", token.name is not None)
    author = unquote(said)
    require_name(author, "whoever sends this")
    return Visitor(token.role, author)


def read_tokens(path: Path) -> tuple[AccessToken, ...]:
    """The tokens in a file, one a line: the secret, its role, and who has it; `#` begins a remark.

    Raises Invalid with the line, Unavailable if it can't be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Unavailable(f"{path}: can't be read as a file of tokens: {error}") from None
    tokens = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].split(maxsplit=2)
        if not words:
            continue
        where = f"{path}, line {number}"
        role = words[1] if len(words) > 1 else AccessRole.OPERATE
        if role not in list(AccessRole):
            raise Invalid(f"{where}: no role `{role}`; there are: {', '.join(AccessRole)}")
        name = words[2].strip() if len(words) > 2 else None
        if name is not None:
            require_name(name, f"the owner of the token in {where}")
        tokens.append(AccessToken(checked_secret(words[0], where), AccessRole(role), name))
    if not tokens:
        raise Invalid(f"{path}: has no tokens: write one a line, such as `SECRET plan Ann`")
    if len({token.secret for token in tokens}) < len(tokens):
        raise Invalid(f"{path}: has a token twice: give each of them once")
    return tuple(tokens)


def checked_secret(secret: str, where: str) -> str:
    """The secret. Raises Invalid for one that is easily guessed or can't be sent."""
    if len(secret) < SHORTEST_TOKEN:
        raise Invalid(f"{where}: a token has at least {SHORTEST_TOKEN} characters")
    if not secret.isascii() or not all(c.isalnum() or c in "-._~" for c in secret):
        raise Invalid(f"{where}: a token has letters, digits and `-._~` only")
    return secret


def kept_secret(folder: Path) -> str:
    """The token of a folder of missions, made where there is none: a service that begins again has
    the same, so that open pages go on. Raises Unavailable where it can't be kept, Invalid where it
    was spoilt."""
    path = folder / _SECRET
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            file = os.open(path, flags, 0o600)
            with open(file, "w", encoding="ascii") as new:
                new.write(new_secret())
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        with open(file, encoding="ascii") as kept:
            return checked_secret(kept.read().strip(), str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise Unavailable(f"{path}: can't be kept: {error}; choose another folder") from None


def new_secret() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)
