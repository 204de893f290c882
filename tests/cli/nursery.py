"""A process that has imported what commands import, and is forked for each: to import torch takes seconds."""

import json
import os
import signal
import socket
import sys
from typing import NoReturn

import weingarten.cli.progress
import weingarten.metrics.exact
import weingarten.metrics.published
import weingarten.reconstruction  # noqa: F401
from weingarten.cli.main import command


def serve(requests: socket.socket) -> None:
    """A command for each request, until nobody is left to ask for one."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    while True:
        _, files, _, _ = socket.recv_fds(requests, 1, 4)
        if not files:
            return
        if os.fork() == 0:
            requests.close()
            mind(*files)
        for file in files:
            os.close(file)


def mind(asked: int, out: int, err: int, report: int) -> NoReturn:
    """Begin the command, and report its process and how it ended."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    with os.fdopen(asked, encoding="utf-8") as file:
        order = json.load(file)
    begun = os.fork()
    if begun == 0:
        os.close(report)
        become(order, out, err)
    os.close(out)
    os.close(err)
    os.write(report, begun.to_bytes(8, "little"))
    _, status = os.waitpid(begun, 0)
    os.write(report, os.waitstatus_to_exitcode(status).to_bytes(8, "little", signed=True))
    os._exit(0)


def become(order: dict, out: int, err: int) -> NoReturn:
    """The command; what it raises ends this process as it would end another."""
    for file, standard in ((out, 1), (err, 2)):
        os.dup2(file, standard)
        os.close(file)
    if order["alone"]:
        os.setsid()
    os.chdir(order["folder"])
    os.environ.clear()
    os.environ.update(order["environment"])
    sys.argv[1:] = order["words"]
    command()


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
