# SPDX-License-Identifier: Apache-2.0
"""``hubfoc live`` as a person starts it: ready, healthy, ended by Ctrl-C, refused in one line."""

import json
import os
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request

import pytest
from hubfoc.live import service

COMMAND = (sys.executable, "-m", "hubfoc", "live")


def test_the_first_line_says_where_everything_is_and_ctrl_c_ends_it() -> None:
    with subprocess.Popen(
        [*COMMAND, "--ready-json", "--no-page"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        assert process.stderr is not None
        ready = json.loads(process.stdout.readline())
        assert ready["ready"] is True
        assert ready["pid"] == process.pid
        assert ready["can"].startswith("udp_multicast:239.")
        assert [wheel["position"] for wheel in ready["wheels"]] == [
            "front_left", "front_right", "rear_left", "rear_right",
        ]  # fmt: skip
        assert all(wheel["serial"].startswith("/dev/") for wheel in ready["wheels"])
        with urllib.request.urlopen(ready["url"] + "health", timeout=30) as answer:
            health = json.load(answer)
        assert set(health) == {"time_s", "realtime_factor", "late_ms_max", "cpu_share"}
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(ready["url"] + "else", timeout=30)
        with urllib.request.urlopen(ready["url"].rpartition("/")[0].rpartition("/")[0] + "/health",
                                    timeout=30) as answer:  # fmt: skip
            assert json.load(answer)["time_s"] >= health["time_s"]
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
        lines = [line for line in process.stderr if "too slow" not in line]
    assert lines == ["hubfoc live: interrupted\n"]


def test_a_vehicle_is_driven_and_watched_from_a_terminal() -> None:
    with subprocess.Popen(
        [*COMMAND, "--ready-json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        assert process.stdout is not None
        bus = json.loads(process.stdout.readline())["can"]
        given = ["demand", "--can", bus, "--drive", "20", "--for", "2.2"]
        done = subprocess.run(
            [sys.executable, "-m", "hubfoc", *given], check=False, capture_output=True, text=True,
            timeout=120, env=os.environ | {"COLUMNS": "120"},
        )  # fmt: skip
        process.send_signal(signal.SIGINT)
    assert done.returncode == 0, done.stderr
    last = done.stdout.rpartition("front left")[2].splitlines()
    shown = {line[:28].strip(): line[28:].split() for line in last[1:]}
    assert shown["mode"] == ["RUN"] * 4
    assert shown["motor torque, N m"] == ["20.0"] * 4


def test_a_bus_without_a_vehicle_is_one_line() -> None:
    for given in (["watch"], ["demand", "--brake", "1"]):
        done = subprocess.run(
            [sys.executable, "-m", "hubfoc", *given, "--can", "virtual"], check=False,
            capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        assert done.returncode == 2
        assert done.stderr.count("\n") == 1
        assert "no wheel on this bus" in done.stderr


def test_a_scenario_ends_by_itself_and_people_get_words() -> None:
    given = ["--scenario", "brake_onset", "--fast", "--can", "virtual", "--no-page"]
    done = subprocess.run(
        [*COMMAND, *given], check=False,
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0
    assert done.stdout.startswith(f"vehicle on virtual, http://{service.HOST}:")
    assert "front_left: shell on /dev/" in done.stdout


def test_what_cannot_be_is_one_line() -> None:
    with socket.socket() as other:
        other.bind((service.HOST, 0))
        other.listen()
        port = str(other.getsockname()[1])
        for given, why in (
            (["--port", port, "--can", "virtual"], "accepted: a free port, or 0 for any"),
            (["--can", "can99"], "can99: no such bus"),
            (["--scenario", "simm"], "simm"),
            (["--config", "lu2031"], "lu2013"),
        ):
            done = subprocess.run(
                [*COMMAND, *given], check=False, capture_output=True, text=True, timeout=120
            )
            assert done.returncode == 2, given
            assert done.stderr.count("\n") == 1
            assert why in done.stderr
