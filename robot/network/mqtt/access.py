"""The address of a broker, and the credentials: user, password, certificates."""

import os
import select
import ssl
import stat
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import SplitResult, unquote, urlsplit

from cubeling.robot.errors import RobotError

DEFAULT_PORTS = {"mqtt": 1883, "mqtts": 8883}
"""Default port of each scheme (IANA)."""

PASSWORD_VARIABLE = "CUBELING_MQTT_PASSWORD"
"""The environment variable that may hold the password."""

MAX_PASSWORD_BYTES = 1024
"""Most bytes read from a password file."""

PASSWORD_TIMEOUT_S = 5.0
"""Longest wait for a password from a pipe [s], for example of a password manager."""


@dataclass(frozen=True)
class Credentials:
    """Options next to the URL; each may be None."""

    user: str | None = None
    """Name of the user, if not in the URL."""

    password_file: Path | None = None
    """A file whose first line is the password."""

    ca: Path | None = None
    """Certificate authority of the broker's certificate (PEM); None for the system's."""

    certificate: Path | None = None
    """Client certificate (PEM), if the broker requires one."""

    key: Path | None = None
    """Private key of the certificate (PEM); None if it is in the same file."""


@dataclass(frozen=True)
class Address:
    """Address and credentials of a broker. Its text never contains the password."""

    host: str
    """Host name or IP address."""

    port: int
    """TCP port of the broker."""

    user: str | None = None
    """User name; None for an anonymous client."""

    password: str | None = field(default=None, repr=False)
    """Password of that user."""

    tls: ssl.SSLContext | None = field(default=None, repr=False)
    """TLS settings; None for an unencrypted connection."""

    @classmethod
    def of(cls, url: str, given: Credentials | None = None) -> "Address":
        """Parse "mqtt://[USER[:PASSWORD]@]HOST[:PORT]", or mqtts:// for TLS.

        The password is, in this order, the one in the URL, the first line of the password file,
        or the environment variable `PASSWORD_VARIABLE`.

        Parameters
        ----------
        url
            The broker's URL; without a port, the scheme's default.
        given
            User, password file and certificates next to the URL; None for none.

        Raises
        ------
        RobotError
            If the URL is not valid, or a file cannot be used; its text never contains a password.
        """
        given = given or Credentials()
        parts = _split(url)
        shown = f"{parts.scheme}://{parts.hostname}"
        if parts.query or parts.fragment or parts.path not in ("", "/"):
            raise RobotError(f"{shown}: a broker's URL has only a host and a port")
        user = unquote(parts.username) if parts.username else given.user
        password = unquote(parts.password) if parts.password else _password(given)
        if user is None and parts.password:
            raise RobotError(f"{shown}: a password needs a user: mqtt://USER@{parts.hostname}")
        return cls(
            parts.hostname or "",
            parts.port or DEFAULT_PORTS[parts.scheme],
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
    if parts.scheme not in DEFAULT_PORTS or not parts.hostname or port == 0:
        scheme = parts.scheme or "without a scheme"
        raise RobotError(f"not a broker's URL ({scheme}): mqtt://HOST[:PORT], or mqtts:// with TLS")
    try:
        parts.hostname.encode("idna")
    except UnicodeError as error:
        raise RobotError(f"{parts.hostname!r} cannot be a host name") from error
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
    """Return the first bytes of a file; of a pipe those within `PASSWORD_TIMEOUT_S`."""
    file = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    try:
        if stat.S_ISFIFO(os.fstat(file).st_mode):
            select.select([file], [], [], PASSWORD_TIMEOUT_S)
        return os.read(file, MAX_PASSWORD_BYTES)
    finally:
        os.close(file)


def _tls(scheme: str, given: Credentials) -> ssl.SSLContext | None:
    if scheme == "mqtt":
        if given.ca or given.certificate or given.key:
            raise RobotError("certificates need TLS: write mqtts:// instead of mqtt://")
        return None
    for path in (given.ca, given.certificate, given.key):
        if path is not None and path.exists() and not path.is_file():
            raise RobotError(f"cannot read {path}: not a file")  # OpenSSL would block on a pipe
    if given.key is not None and given.certificate is None:
        raise RobotError(f"the key {given.key} needs the certificate that belongs to it")
    try:
        context = ssl.create_default_context(cafile=given.ca)
    except (OSError, ssl.SSLError) as error:
        raise RobotError(f"{given.ca} contains no readable certificate (PEM)") from error
    context.sslsocket_class = _ClosingSocket
    if given.certificate is not None:
        try:
            # For an encrypted key OpenSSL would prompt in the terminal, from any thread.
            context.load_cert_chain(given.certificate, given.key, password=_no_passphrase)
        except (OSError, ssl.SSLError, ValueError) as error:
            named = given.key or given.certificate
            raise RobotError(
                f"{given.certificate} and the key in {named} do not match, cannot be read, "
                "or need a passphrase"
            ) from error
    return context


class _ClosingSocket(ssl.SSLSocket):
    """Closes itself if the handshake fails; paho leaves that to the garbage collector."""

    def do_handshake(self, block: bool = False) -> None:
        """Do the handshake; close if it fails."""
        try:
            super().do_handshake(block)
        except OSError:
            self.close()
            raise


def _no_passphrase() -> str:
    return ""
