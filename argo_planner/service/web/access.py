"""Access control: roles, and the tokens that grant them."""

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

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable, reason_text
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.operating_system import NO_LINK_FLAGS
from argo_planner.service.core.plan_limits import require_displayable_name
from argo_planner.service.storage.stored_files import read_stored_bytes

MIN_TOKEN_LENGTH = 16
"""in characters"""
AUTHOR_HEADER = "argo-author"
"""HTTP header with the name of the author, percent-encoded"""
_SECRET_FILE = ".token"
"""name of the file with the token of a folder of missions"""


class AccessRole(StrEnum):
    """Role of a client. Each role includes the rights of the roles before it."""

    VIEW = "view"
    """right to read missions, runs and the world"""
    PLAN = "plan"
    """right to change missions and obstacles, and to start jobs"""
    OPERATE = "operate"
    """right to start and control runs"""

    def includes(self, other: "AccessRole") -> bool:
        """Return True if this role has all rights of the other role."""
        roles = list(AccessRole)
        return roles.index(self) >= roles.index(other)


class AccessDenied(ArgoError):
    """A request that the role does not allow."""

    code = "access-denied"


class TokenMissing(ArgoError):
    """A request without a token, or with an unknown one."""

    code = "token-missing"


@dataclass(frozen=True)
class AccessToken:
    """A secret, with the role that it grants."""

    secret: str
    role: AccessRole = AccessRole.OPERATE
    name: str | None = None
    """name of the owner; None: each request states its author"""

    @property
    def cookie(self) -> str:
        """Value for a cookie, always the same for one secret, which can't be computed from it.

        It is an HMAC with the secret as the key.
        """
        return hmac.new(self.secret.encode(), b"argo cookie", hashlib.sha256).hexdigest()


@dataclass(frozen=True)
class Visitor:
    """Sender of a request: name and role."""

    role: AccessRole
    author: str
    named: bool = False
    """whether the name comes from the token"""
    key: str = ""
    """key of the token, the same for all that use it"""

    def require(self, role: AccessRole) -> None:
        """Raise AccessDenied if the visitor's role does not include `role`."""
        if not self.role.includes(role):
            raise AccessDenied(
                Message(
                    "this needs the role `{role}`, but yours is `{role_2}`: ask for another token",
                    role=role,
                    role_2=self.role,
                )
            )


class TokenBook:
    """The tokens of a service."""

    def __init__(self, tokens: Iterable[AccessToken]) -> None:
        self._tokens = tuple(tokens)

    def find_by_secret(self, secret: str) -> AccessToken | None:
        """Return the token with this secret, or None; the time taken is the same in both cases."""
        return self._find(secret, [token.secret for token in self._tokens])

    def find_by_cookie(self, cookie: str) -> AccessToken | None:
        """Return the token whose `cookie` is this value, or None if there is none."""
        return self._find(cookie, [token.cookie for token in self._tokens])

    def _find(self, given: str, values: list[str]) -> AccessToken | None:
        """Return the token whose value is the given one; compares with all, in constant time."""
        match = None
        for token, value in zip(self._tokens, values, strict=True):
            if secrets.compare_digest(given.encode(errors="replace"), value.encode()):
                match = token
        return match


def identify_visitor(
    token: AccessToken, headers: Mapping[str, str], query: Mapping[str, str]
) -> Visitor:
    """Return name and role of the sender of a request that has a valid token.

    The name is that of the token, else the text of AUTHOR_HEADER, else that of the parameter
    `author`, else `somebody`; empty texts don't count. Raises Invalid if the request states a text
    that can't be a name.
    """
    stated = headers.get(AUTHOR_HEADER) or query.get("author")
    if token.name is not None or not stated:
        name = token.name or "somebody"
        return Visitor(token.role, name, token.name is not None, token.cookie)
    author = unquote(stated)
    require_displayable_name(author, Message("the author of this request"))
    return Visitor(token.role, author, key=token.cookie)


def read_tokens(path: Path) -> tuple[AccessToken, ...]:
    """Return the tokens in a file.

    Each line has a secret, and optionally its role (`operate` by default) and its owner's name;
    `#` begins a comment. Raises Invalid with the line of an error, Unavailable if the file can't
    be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Unavailable(
            Message(
                "{path} can't be read as a token file: {error}", path=path, error=reason_text(error)
            )
        ) from None
    tokens = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].split(maxsplit=2)
        if not words:
            continue
        where = Message("{path}, line {number}", path=path, number=number)
        role = words[1] if len(words) > 1 else AccessRole.OPERATE
        if role not in list(AccessRole):
            raise Invalid(
                Message(
                    "{where}: there is no role `{role}`; choose from {accessrole}",
                    where=where,
                    role=role,
                    accessrole=Listing(AccessRole),
                )
            )
        name = words[2].strip() if len(words) > 2 else None
        if name is not None:
            require_displayable_name(
                name, Message("the owner of the token in {where}", where=where)
            )
        tokens.append(AccessToken(validate_secret(words[0], where), AccessRole(role), name))
    if not tokens:
        raise Invalid(
            Message(
                "{path} has no tokens: write one per line, such as `SECRET plan Ann`", path=path
            )
        )
    if len({token.secret for token in tokens}) < len(tokens):
        raise Invalid(
            Message(
                "{path} has the same token on two lines: remove one of them, or give it "
                "another token",
                path=path,
            )
        )
    return tuple(tokens)


def validate_secret(secret: str, where: str) -> str:
    """Return the secret unchanged; raise Invalid if it is too short or has other characters.

    Only characters that need no escapes in an address and in a header are allowed. `where` is the
    place of the secret, for the message.
    """
    if len(secret) < MIN_TOKEN_LENGTH:
        raise Invalid(
            Message(
                "{where}: a token needs at least {min_token_length} characters",
                where=where,
                min_token_length=MIN_TOKEN_LENGTH,
            )
        )
    if not secret.isascii() or not all(c.isalnum() or c in "-._~" for c in secret):
        raise Invalid(
            Message("{where}: a token may have only letters, digits and `-._~`", where=where)
        )
    return secret


def load_or_make_secret(folder: Path) -> str:
    """Return the token of a folder of missions; store a new one if it has none.

    A restarted service thus has the same token, and open pages stay connected. Raises Unavailable
    if the token can't be read or stored, Invalid if the stored one is not a valid token.
    """
    path = folder / _SECRET_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | NO_LINK_FLAGS
            file = os.open(path, flags, 0o600)
            with open(file, "w", encoding="ascii") as new:
                new.write(make_secret())
        secret = read_stored_bytes(path).decode("ascii")
        return validate_secret(secret.strip(), str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise Unavailable(
            Message(
                "{path}: the token can't be stored: {error}; choose another folder",
                path=path,
                error=reason_text(error),
            )
        ) from None


def make_secret() -> str:
    """Return a random secret of 24 bytes, in Base64 for URLs."""
    return secrets.token_urlsafe(24)
