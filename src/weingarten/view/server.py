"""The server of the page: the standard library's, on loopback unless told otherwise. It answers GET alone.

A page of another site can make a browser ask this server by giving a name of its own this address (DNS
rebinding); such a question carries that name as its Host, and is refused.
"""

import ipaddress
import socket
import socketserver
import sys
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from weingarten.errors import OptionError
from weingarten.view.exhibit import Exhibit
from weingarten.view.routes import Answer, NotThereError, answer

LOOPBACK = ("127.0.0.1", "localhost", "::1")
EVERYWHERE = ("0.0.0.0", "::")
TEXT = "text/plain; charset=utf-8"
SECONDS = 30.0
"""That a connection may be silent for."""

HEADERS: Mapping[str, str] = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class Server(ThreadingHTTPServer):
    """Serves an exhibit and nothing else. Raises OptionError where the address cannot be had."""

    daemon_threads = True
    block_on_close = False

    def __init__(self, exhibit: Exhibit, host: str, port: int) -> None:
        self.exhibit, self.host = exhibit, host
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            super().__init__((host, port), Handler)
        except PermissionError as error:
            raise OptionError(f"Port {port} may not be used; choose one above 1023 with --port.") from error
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise OptionError(
                f"{host} port {port} cannot be listened to ({reason}); choose another --port or --host."
            ) from error

    def server_bind(self) -> None:
        """Without the base's search for the machine's name, which may wait for a network."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = self.host, self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that hangs up is no error; anything else is one of this program's."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)

    @property
    def address(self) -> str:
        """Of the page."""
        host = self.host if self.host not in EVERYWHERE else socket.gethostname()
        return f"http://{f'[{host}]' if ':' in host else host}:{self.server_port}/"

    def welcomes(self, name: str) -> bool:
        """Whether a question may carry this Host, without its port."""
        own = {*LOOPBACK, self.host.lower()}
        if self.host in EVERYWHERE:
            own.add(socket.gethostname().lower())
        return name in own or (self.host in EVERYWHERE and is_number(name))


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server  # pyright: ignore[reportIncompatibleVariableOverride]
    server_version, sys_version = "weingarten", ""
    protocol_version = "HTTP/1.1"
    timeout = SECONDS

    def do_GET(self) -> None:
        """Answer, or say that there is nothing."""
        if not self.server.welcomes(host_name(self.headers.get("Host", ""))):
            self.say(403, "This page is only for the machine that it was started on.")
            return
        try:
            found = answer(self.server.exhibit, self.path)
        except NotThereError as error:
            self.say(404, str(error))
            return
        self.send(200, found)

    def refuse(self) -> None:
        """Only GET is answered."""
        self.close_connection = True
        self.say(405, "Only GET is answered here.")

    do_POST = do_PUT = do_DELETE = do_PATCH = do_HEAD = do_OPTIONS = do_TRACE = do_CONNECT = refuse  # noqa: N815

    def say(self, code: int, text: str) -> None:
        """A sentence."""
        self.send(code, Answer(TEXT, f"{text}\n".encode()))

    def send(self, code: int, found: Answer) -> None:
        """The whole answer."""
        self.send_response(code)
        sent = {"Content-Type": found.kind, "Content-Length": str(len(found.content))}
        for name, value in {**sent, "Content-Security-Policy": found.policy, **HEADERS}.items():
            self.send_header(name, value)
        if code == 405:
            self.send_header("Allow", "GET")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(found.content)

    def log_message(self, format: str, *args: object) -> None:
        """Nothing is logged."""


def host_name(host: str) -> str:
    """The name in a Host header, without port and brackets, lower case."""
    name = host.strip().lower()
    if name.startswith("["):
        return name[1:].split("]")[0]
    return name.rsplit(":", 1)[0] if name.count(":") == 1 else name


def is_number(name: str) -> bool:
    """Whether a host is an address rather than a name: nobody can have another site's name mean it."""
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
