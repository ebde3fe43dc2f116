"""A certificate made on the spot: browsers let a page use the camera over TLS only."""

import ipaddress
import os
import socket
import ssl
from datetime import UTC, datetime, timedelta
from pathlib import Path
from tempfile import TemporaryDirectory

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from cubeling.app.errors import AppError

VALID_FOR = timedelta(days=397)
"""What browsers take at most of a certificate that is not in their store."""

FILE = "certificate.pem"
"""Key and certificate, in the folder of the preferences: who has said yes once is not asked again
at the same address."""

MAX_FILE_BYTES = 16_384


def tls_context(host: str, folder: Path | None) -> tuple[ssl.SSLContext, str]:
    """Return a server's context for an address, and the fingerprint of its certificate.

    The certificate is kept in the folder, if there is one.

    Raises
    ------
    AppError
        It cannot be kept.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    with TemporaryDirectory(prefix="cubeling-") as temporary:
        path = (Path(temporary) if folder is None else folder) / FILE
        certificate = _kept(path, host) or _make(path, host)
        context.load_cert_chain(path)
    digest = certificate.fingerprint(hashes.SHA256()).hex().upper()
    return context, ":".join(digest[place : place + 2] for place in range(0, len(digest), 2))


def _kept(path: Path, host: str) -> x509.Certificate | None:
    """Return the certificate of a file if it is still good for an address."""
    if not path.is_file() or path.stat().st_size > MAX_FILE_BYTES:
        return None
    try:
        data = path.read_bytes()
        certificate = x509.load_pem_x509_certificate(data)
        serialization.load_pem_private_key(data, None)
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except (OSError, ValueError, TypeError, x509.ExtensionNotFound):
        return None
    left = certificate.not_valid_after_utc - datetime.now(UTC)
    return certificate if left > timedelta(days=1) and _name(host) in names else None


def _make(path: Path, host: str) -> x509.Certificate:
    key = ec.generate_private_key(ec.SECP256R1())
    computer, now = socket.gethostname()[:60] or "this computer", datetime.now(UTC)
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"Cubeling on {computer}"[:64])])
    names = dict.fromkeys((_name(host), x509.DNSName("localhost")))
    certificate = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))  # the phone's clock may be another one
        .not_valid_after(now + VALID_FOR)
        .add_extension(x509.SubjectAlternativeName(names), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    data = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    ) + certificate.public_bytes(serialization.Encoding.PEM)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        # Nobody else may read the key, from its first byte on.
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
            file.write(data)
    except OSError as error:
        raise AppError(f"the certificate cannot be kept in '{path}': {error.strerror}") from error
    return certificate


def _name(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def lan_address() -> str:
    """Return the address of this computer in its network; raises AppError without a network.

    Nothing is sent: the system is asked by which of its addresses it would reach another one.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # an address for examples (RFC 5737)
        except OSError as error:
            raise AppError("this computer is in no network: leave out --lan") from error
        return str(probe.getsockname()[0])
