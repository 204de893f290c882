"""The server: a fixed table of addresses, GET alone, and no host but its own."""

import http.client
import json
import socket
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from weingarten.errors import OptionError
from weingarten.view.exhibit import Exhibit
from weingarten.view.routes import ROUTES
from weingarten.view.server import Server, host_name

sys.path.insert(0, str(Path(__file__).parent))
from exhibits import Known, ball


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with Server(ball(), "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def asked(server: Server, address: str, method: str = "GET", host: str | None = None):
    """Code, headers and content of an answer."""
    link = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    link.putrequest(method, address, skip_host=True, skip_accept_encoding=True)
    link.putheader("Host", f"127.0.0.1:{server.server_port}" if host is None else host)
    link.endheaders()
    answer = link.getresponse()
    content = answer.read()
    link.close()
    return answer.status, answer.headers, content


def test_every_address_of_the_table_answers(server):
    more = ["/colours?by=mean", "/colours?by=primitives", "/section?axis=y&at=500"]
    for address in ["/", "/state", "/scene", "/points", *more]:
        code, headers, content = asked(server, address)
        assert code == 200, address
        assert len(content) == int(headers["Content-Length"]) > 10
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Cache-Control"] == "no-store"
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "Access-Control-Allow-Origin" not in headers
        assert "Python" not in headers["Server"]
    assert set(ROUTES) == {"/", "/state", "/scene", "/points", "/colours", "/section"}
    assert json.loads(asked(server, "/state")[2])["final"] == "1"


def test_the_page_allows_its_own_scripts_alone_and_escapes_names(server):
    _, headers, content = asked(server, "/")
    policy = headers["Content-Security-Policy"]
    assert "unsafe" not in policy
    assert "script-src 'sha256-" in policy
    assert "connect-src 'self'" in policy
    text = content.decode()
    assert "<title>ball &lt;b&gt;&amp;&quot;$x" in text
    assert "ball <b>" not in text
    assert text.count("<script>") == 1


@pytest.mark.parametrize(
    "address",
    [
        "/nothing", "/mesh.ply", "/checkpoint.safetensors", "//etc/passwd", "/../../etc/passwd", "/%2e%2e/",
        "/state/", "/state/../state", "/scene?file=/etc/passwd", "/scene?step=../1", "/scene?step=-1",
        "/scene?step=1e3", "/scene?step=%D9%A3", "/scene?step=99999999999", "/scene?step=3",
        "/scene?step=1&step=1",
        "/scene?step", "/scene?step=", "/colours", "/colours?by=/etc/passwd", "/colours?by=__class__",
        "/section?axis=w&at=1", "/section?axis=x", "/section?axis=x&at=1001", "/section?axis=x&at=nan",
        "/section?axis=xy&at=1", "/points?a=1", "/?x=1", "/state?" + "x" * 300, "http://127.0.0.1/nothing",
    ],
)  # fmt: skip
def test_all_else_is_not_there(server, address):
    code, _, content = asked(server, address)
    assert code == 404
    assert b"Traceback" not in content
    assert b"root:" not in content


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "HEAD", "OPTIONS", "TRACE", "CONNECT"])
def test_only_get_is_answered(server, method):
    code, headers, _ = asked(server, "/state", method)
    assert code == 405
    assert headers["Allow"] == "GET"


@pytest.mark.parametrize(
    ("host", "code"),
    [
        ("127.0.0.1:1", 200), ("localhost:8000", 200), ("LOCALHOST", 200), ("[::1]:80", 200),
        ("evil.example", 403), ("evil.example:8000", 403), ("127.0.0.1.evil.example", 403), ("", 403),
        ("192.168.0.7", 403), ("localhost.evil.example", 403), ("127.0.0.1:1:2", 403),
    ],
)  # fmt: skip
def test_names_of_others_are_refused(server, host, code):
    assert asked(server, "/state", host=host)[0] == code


def test_who_listens_everywhere_is_reached_by_number_or_own_name():
    with Server(Exhibit(Known(), 60_000), "0.0.0.0", 0) as server:
        assert server.welcomes("192.168.0.7")
        assert server.welcomes(socket.gethostname().lower())
        assert not server.welcomes("evil.example")
        assert socket.gethostname() in server.address
    assert host_name(" Example.ORG:80 ") == "example.org"


def test_ports_that_cannot_be_had_are_said(server):
    with pytest.raises(OptionError, match="cannot be listened to"):
        Server(Exhibit(Known(), 60_000), "127.0.0.1", server.server_port)
    with pytest.raises(OptionError, match="cannot be listened to"):
        Server(Exhibit(Known(), 60_000), "no such host", 0)
