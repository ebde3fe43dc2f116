"""Where a broker is, and how to get in: address, user and password, certificates."""

import os
import select
import ssl
import stat
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import SplitResult, unquote, urlsplit

from robot.errors import RobotError

PORTS = {"mqtt": 1883, "mqtts": 8883}
"""The usual port of each scheme (IANA)."""

PASSWORD_VARIABLE = "CUBELING_MQTT_PASSWORD"
"""The environment variable that may hold the password."""

PASSWORD_BYTES = 1024
"""Longest password file that is read [bytes]."""

PASSWORD_WITHIN = 5.0
"""Longest wait for a password that comes through a pipe, from a password manager say [s]."""


@dataclass(frozen=True)
class Credentials:
    """What a person gives beside the URL; each may be None."""

    user: str | None = None
    """Name of the user."""

    password_file: Path | None = None
    """A file whose first line is the password."""

    ca: Path | None = None
    """The certificate authority that signed the broker's certificate (PEM); None: the system's."""

    certificate: Path | None = None
    """Our own certificate (PEM), where the broker asks for one."""

    key: Path | None = None
    """Its private key (PEM); None if it is in the same file."""


@dataclass(frozen=True)
class Address:
    """Where a broker is, and how to get in. Its text never shows the password."""

    host: str
    """Name or number of its computer."""

    port: int
    """Its TCP port."""

    user: str | None = None
    """Who we are; None for nobody."""

    password: str | None = field(default=None, repr=False)
    """The password of that user."""

    tls: ssl.SSLContext | None = field(default=None, repr=False)
    """How to encrypt; None for not at all."""

    @classmethod
    def of(cls, url: str, given: Credentials | None = None) -> "Address":
        """Read "mqtt://[USER[:PASSWORD]@]HOST[:PORT]", or mqtts:// for TLS.

        The password is, in this order: that of the URL, the first line of the password file, the
        environment variable `PASSWORD_VARIABLE`.

        Raises
        ------
        RobotError
            If the URL is none, or a file cannot be used; the line never shows a password.
        """
        given = given or Credentials()
        parts = _split(url)
        shown = f"{parts.scheme}://{parts.hostname}"
        if parts.query or parts.fragment or parts.path not in ("", "/"):
            raise RobotError(f"{shown}: only a host and a port stand in a broker's URL")
        user = unquote(parts.username) if parts.username else given.user
        password = unquote(parts.password) if parts.password else _password(given)
        if user is None and parts.password:
            raise RobotError(
                f"{shown}: a password needs a user, as in mqtt://USER@{parts.hostname}"
            )
        return cls(
            parts.hostname or "",
            parts.port or PORTS[parts.scheme],
            user,
            password if user is not None else None,
            _tls(parts.scheme, given),
        )

    def __str__(self) -> str:
        scheme = "mqtt" if self.tls is None else "mqtts"
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{scheme}://{host}:{self.port}"


def _split(url: str) -> SplitResult:
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError as error:
        raise RobotError("the broker's URL has no valid port; mqtt://HOST:1883 is one") from error
    if parts.scheme not in PORTS or not parts.hostname or port == 0:
        scheme = parts.scheme or "without a scheme"
        raise RobotError(f"no broker's URL ({scheme}): mqtt://HOST[:PORT], or mqtts:// with TLS")
    return parts


def _password(given: Credentials) -> str | None:
    if given.password_file is None:
        return os.environ.get(PASSWORD_VARIABLE)
    try:
        lines = _first_bytes(given.password_file).decode().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RobotError(f"cannot read the password file {given.password_file}") from error
    if not lines or not lines[0] or not lines[0].isprintable():
        raise RobotError(f"the first line of {given.password_file} must be the password")
    return lines[0]


def _first_bytes(path: Path) -> bytes:
    """Read a file's beginning; of a pipe what comes within `PASSWORD_WITHIN`."""
    file = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    try:
        if stat.S_ISFIFO(os.fstat(file).st_mode):
            select.select([file], [], [], PASSWORD_WITHIN)
        return os.read(file, PASSWORD_BYTES)
    finally:
        os.close(file)


def _tls(scheme: str, given: Credentials) -> ssl.SSLContext | None:
    if scheme == "mqtt":
        if given.ca or given.certificate or given.key:
            raise RobotError("certificates are for TLS: write mqtts:// for mqtt://")
        return None
    for path in (given.ca, given.certificate, given.key):
        if path is not None and path.exists() and not path.is_file():
            raise RobotError(f"cannot read {path}: it is no file")  # OpenSSL would wait for a pipe
    if given.key is not None and given.certificate is None:
        raise RobotError(f"the key {given.key} needs the certificate that belongs to it")
    try:
        context = ssl.create_default_context(cafile=given.ca)
    except (OSError, ssl.SSLError) as error:
        raise RobotError(f"{given.ca} holds no certificate (PEM) that can be read") from error
    context.sslsocket_class = _WholeOrClosed
    if given.certificate is not None:
        try:
            # A key under a passphrase would make OpenSSL ask at the terminal, from any thread.
            context.load_cert_chain(given.certificate, given.key, password=_no_passphrase)
        except (OSError, ssl.SSLError, ValueError) as error:
            named = given.key or given.certificate
            raise RobotError(
                f"{given.certificate} and the key in {named} do not fit together, cannot be read, "
                "or need a passphrase"
            ) from error
    return context


class _WholeOrClosed(ssl.SSLSocket):
    """Is closed if the handshake fails; paho would leave it to the garbage collector."""

    def do_handshake(self, block: bool = False) -> None:
        """Shake hands, or close."""
        try:
            super().do_handshake(block)
        except OSError:
            self.close()
            raise


def _no_passphrase() -> str:
    return ""
