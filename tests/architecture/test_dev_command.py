# SPDX-License-Identifier: Apache-2.0
"""Errors, help and set-up of tools/dev.

Help, usage errors and missing packages; offline, in seconds.
"""

import os
import re
import shutil
import subprocess
import unittest

from dev_fixture import ROOT, USAGE, DevFixture, needs_headers, write_program

COMMANDS = (
    "sim",
    "test",
    "table",
    "firmware",
    "flash",
    "hubsim",
    "study",
    "python",
    "fmu",
    "release",
    "bench",
    "coverage",
    "mutants",
    "oracle",
    "report",
    "format",
    "lint",
    "setup",
    "clean",
)
UNPRIVILEGED = 65534


class DevCommandTest(DevFixture):
    """Each test has its own copy of the command in a directory that holds nothing else."""

    def test_help_lists_every_command_and_does_not_install(self) -> None:
        for arguments in (["--help"], ["-h"], ["help"]):
            result = self.run_dev(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            for command in COMMANDS:
                self.assertRegex(result.stdout, rf"(?m)^  {command}\b")
        self.assertEqual(self.contents(), self.before)

    def test_every_command_has_its_own_help_and_help_does_not_install(self) -> None:
        for command in COMMANDS:
            for arguments in ([command, "--help"], ["help", command]):
                result = self.run_dev(*arguments)
                self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
                self.assertTrue(
                    result.stdout.startswith(f"Usage: tools/dev {command}"), result.stdout
                )
        self.assertEqual(self.contents(), self.before)

    def test_without_a_command_help_is_printed_to_stderr_with_the_usage_exit_status(
        self,
    ) -> None:
        result = self.run_dev()
        self.assertEqual((result.returncode, result.stdout), (USAGE, ""))
        self.assertIn("Usage:", result.stderr)

    def test_help_of_a_program_s_own_command_needs_python_alone_and_does_not_install(self) -> None:
        for arguments, words in (
            (["hubsim", "--help"], "usage: hubsim"),
            (["hubsim", "sweep", "--help"], "usage: hubsim sweep"),
            (["hubsim", "faults", "-h"], "usage: hubsim faults"),
            (["study"], "dips"),
            (["study", "dips", "--help"], "What is missing of the demand"),
            (["python", "-m", "regen_table", "solve", "--help"], "usage: regen_table solve"),
            (["python", "-m", "hubsim.fmu", "--help"], "usage: hubsim.fmu"),
        ):
            result = self.run_dev(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
            self.assertIn(words, result.stdout)
        self.assertEqual(self.contents(), self.before)

    def test_an_unknown_command_is_an_error_with_what_was_meant_or_all_that_there_are(self) -> None:
        for word, meant in (("simm", "sim"), ("tset", "test"), ("frimware", "firmware")):
            self.assert_refused(self.run_dev(word), f"'{word}', did you mean {meant}?")
        self.assert_refused(self.run_dev("xyzzy"), "'xyzzy', there are: sim test table")

    def test_every_command_names_a_drive_by_its_file_or_by_a_name(self) -> None:
        motors = self.home / "tools/motors/board"
        motors.mkdir(parents=True)
        for name in ("mine", "board/other"):
            (motors.parent / f"{name}.toml").touch()
        (self.base / "here.toml").touch()
        self.before = self.contents()
        for words in (["table"], ["fmu", "--config"], ["firmware", "--config"],
                      ["flash", "--config"], ["bench", "--config"]):  # fmt: skip
            self.assert_refused(self.run_dev(*words, "min"), "'min', did you mean mine?")
            self.assert_refused(self.run_dev(*words, "none.toml"), "none.toml: no such file")
            self.assert_refused(self.run_dev(*words, str(self.base)), "is a directory")
        # The firmware is built with a table, and the command that makes it is named.
        for drive in ("mine", "other", "here.toml"):
            for command in ("firmware", "flash", "bench"):
                result = self.run_dev(command, "--config", drive)
                self.assert_refused(result, f"'tools/dev table {drive}' makes it")

        path, environment = self.pretend_everything_is_installed()
        for drive, file in (("other", str(motors / "other.toml")), ("here.toml", "here.toml")):
            self.run_dev("table", drive, path=path, environment=environment)
            self.assertEqual(self.calls("python")[-1], f"-m regen_table generate {file}")
            self.run_dev("fmu", "--config", drive, path=path, environment=environment)
            configured = [call for call in self.calls("cmake") if "HUBFOC_FMU_CONFIG" in call]
            self.assertTrue(configured[-1].endswith(str((self.base / file).resolve())), configured)

    def test_a_folder_where_another_user_has_set_up_is_an_error_in_one_line(self) -> None:
        if os.geteuid() != 0:
            self.skipTest("only root can run a command as two users")
        for folder in (self.home, self.home / ".dev"):
            folder.mkdir(exist_ok=True)
            os.chown(folder, UNPRIVILEGED, -1)
        (self.home / ".dev/lock").touch()
        result = self.run_dev("setup", "qemu", user=UNPRIVILEGED)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(
            result.stderr,
            r"^tools/dev: \S+/\.dev/lock belongs to root: run this as that user[^\n]*\n$",
        )

    def test_a_release_with_a_file_that_git_does_not_know_is_refused(self) -> None:
        def git(*arguments: str) -> None:
            subprocess.run(["git", "-c", "user.name=x", "-c", "user.email=x@x", *arguments],
                           cwd=self.home, check=True, capture_output=True)  # fmt: skip

        git("init")
        git("add", ".")
        git("commit", "-m", "all")
        image = self.home / "firmware/config/generated/own.bin"
        image.parent.mkdir(parents=True)
        image.touch()
        self.before = self.contents()
        self.assert_refused(self.run_dev("release"), "firmware/config/generated/own.bin", "--trial")
        git("add", ".")
        git("commit", "-m", "own")
        (self.home / "tools/setup/flash.sh").write_text("# changed\n", encoding="utf-8")
        self.before = self.contents()
        self.assert_refused(self.run_dev("release"), "tools/setup/flash.sh", "--trial")

    def test_a_surplus_argument_is_an_error_that_names_it(self) -> None:
        for command in ("sim", "bench", "report", "format", "lint"):
            self.assert_refused(self.run_dev(command, "surplus"), command, "surplus")
        self.assert_refused(self.run_dev("firmware", "qemu", "surplus"), "surplus")
        self.assert_refused(self.run_dev("clean", "surplus"), "surplus")

    def test_an_unknown_option_or_group_is_an_error_that_names_it(self) -> None:
        self.assert_refused(self.run_dev("table", "--wrong"), "--wrong")
        self.assert_refused(self.run_dev("flash", "--wrong"), "--wrong")
        self.assert_refused(self.run_dev("clean", "--wrong"), "--wrong")
        self.assert_refused(self.run_dev("bench", "--wrong"), "--wrong")
        self.assert_refused(self.run_dev("setup", "wrong"), "wrong", "build", "arm", "qemu")

    def test_a_missing_argument_is_an_error_before_installation(self) -> None:
        self.assert_refused(self.run_dev("table"), "DRIVE")
        self.assert_refused(self.run_dev("table", "-o"), "-o")

    def test_an_unknown_port_or_probe_is_an_error_that_lists_the_known_ones(self) -> None:
        self.assert_refused(self.run_dev("firmware", "avr"), "avr", "stm32f405", "qemu")
        self.assert_refused(self.run_dev("flash", "--set", "a.b=1"), "--config")
        self.assert_refused(self.run_dev("flash", "avr"), "avr", "stm32f405")
        self.assert_refused(self.run_dev("flash", "qemu"), "qemu", "emulator")
        self.assert_refused(self.run_dev("flash", "--probe", "wand"), "wand", "stlink")
        self.assert_refused(
            self.run_dev("flash", "--with", "wand"), "wand", "openocd", "pyocd", "serial"
        )
        self.assert_refused(self.run_dev("flash", "--with", "serial"), "--only-config")
        self.assert_refused(
            self.run_dev("flash", "--with", "serial", "--only-config", "--line", "absent"),
            "absent",
            "no such serial line",
        )

    @unittest.skipUnless(
        shutil.which("shellcheck"), "no shellcheck here; tools/dev setup checks installs it"
    )
    def test_shell_scripts_pass_shellcheck(self) -> None:
        scripts = [
            "tools/dev",
            ".ci/run",
            *sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("tools/setup/*.sh")),
        ]
        result = subprocess.run(
            ["shellcheck", "-x", *scripts],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_command_works_through_a_link_and_from_another_directory(self) -> None:
        link = self.base / "hubfoc"
        link.symlink_to(self.home / "tools/dev")
        result = subprocess.run(
            [str(link), "--help"], cwd="/", capture_output=True, text=True, check=False
        )
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_setup_installs_only_missing_packages(
        self,
    ) -> None:
        path, apt = self.bare_path(), self.pretend_apt()
        first = self.run_dev("setup", "arm", "qemu", path=path, environment=apt)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stdout, "")
        installs = self.apt_installs()
        self.assertEqual(len(installs), 1, installs)
        self.assertIn("--no-install-recommends", installs[0])
        self.assertEqual(
            re.findall(r"\S*(?:arm)\S*", installs[0]),
            ["gcc-arm-none-eabi", "libnewlib-arm-none-eabi", "qemu-system-arm"],
        )
        # The packages to be installed are printed first.
        self.assertRegex(
            first.stderr, r"lacks: gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"
        )

        second = self.run_dev("setup", "arm", "qemu", path=path, environment=apt)
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertEqual(self.apt_installs(), installs)

        # A tool removed meanwhile is detected: its presence is checked in every run.
        (self.bin / "qemu-system-arm").unlink()
        third = self.run_dev("setup", "arm", "qemu", path=path, environment=apt)
        self.assertEqual(third.returncode, 0, third.stderr)
        self.assertTrue(
            self.apt_installs()[-1].endswith("--no-install-recommends qemu-system-arm"),
            self.apt_installs(),
        )

    def test_a_browser_is_installed_if_the_package_manager_offers_one(self) -> None:
        path, apt = self.bare_path(), self.pretend_apt()
        for _ in range(2):
            result = self.run_dev("setup", "browser", path=path, environment=apt)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(
            [call.split()[-1] for call in self.apt_installs()], ["chromium-headless-shell"]
        )

    def test_without_a_browser_package_one_line_names_the_test_that_fails(self) -> None:
        path, apt = self.bare_path(), self.pretend_apt()
        write_program(self.bin / "apt-cache", "#!/bin/sh\nexit 1\n")
        result = self.run_dev("setup", "browser", path=path, environment=apt)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(
            "report_in_browser and live_in_browser will fail until 'chromium' or 'google-chrome' is"
            " on PATH",
            result.stderr,
        )
        self.assertEqual(self.apt_installs(), [])

    def test_a_failing_installation_shows_the_end_of_its_log_and_fails(self) -> None:
        result = self.run_dev(
            "setup",
            "qemu",
            path=self.bare_path(),
            environment={"APT_BROKEN": "1"} | self.pretend_apt(),
        )
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("E: pretended failure", result.stderr)
        self.assertIn(".dev/log/", result.stderr)
        self.assertIn("qemu-system-arm", result.stderr.splitlines()[-1])

    def test_without_a_network_the_error_is_one_line(self) -> None:
        apt = self.pretend_apt()
        write_program(self.bin / "apt-cache", "#!/bin/sh\nexit 1\n")
        result = self.run_dev(
            "setup", "arm", path=self.bare_path(), environment={**apt, "APT_OFFLINE": "1"}
        )
        self.assertEqual(result.returncode, 1)
        self.assertEqual([line for line in result.stderr.splitlines() if "apt-install" in line], [])
        self.assertIn(
            "the package archive cannot be reached; is there a network?",
            result.stderr.splitlines()[-1],
        )

    def test_a_package_without_its_tool_is_not_reported_as_installed(self) -> None:
        result = self.run_dev(
            "setup", "checks", path=self.bare_path(), environment=self.pretend_apt()
        )
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn(
            "still missing after installation: clang-tidy shellcheck",
            result.stderr.splitlines()[-1],
        )

    def test_without_root_and_sudo_the_error_shows_the_command_for_an_administrator(self) -> None:
        path, apt = self.bare_path(), self.pretend_apt()
        (self.bin / "sudo").unlink()
        user = None
        if os.geteuid() == 0:
            user = UNPRIVILEGED
            for place in (self.home, self.home / "tools"):
                os.chown(place, UNPRIVILEGED, -1)
        result = self.run_dev("setup", "arm", path=path, user=user, environment=apt)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(
            "apt-get install -y --no-install-recommends gcc-arm-none-eabi libnewlib-arm-none-eabi",
            result.stderr,
        )
        self.assertEqual(self.apt_installs(), [])

    def test_without_apt_the_error_lists_the_missing_packages_in_one_line(self) -> None:
        result = self.run_dev("setup", "qemu", path=self.bare_path())
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn("qemu-system-arm", result.stderr)

    def test_setup_without_apt_succeeds_when_no_package_is_missing(self) -> None:
        path = self.bare_path()
        write_program(self.bin / "qemu-system-arm", "#!/bin/sh\n")
        self.assertEqual(self.run_dev("setup", "qemu", path=path).returncode, 0)

    @needs_headers
    def test_test_runs_every_preset_and_ends_with_the_closing_lines_of_each(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        result = self.run_dev("test", path=path, environment=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        presets = ["host", "host-asan", "stm32f405", "qemu"]
        self.assertEqual(self.names_run(), [f"{preset}:physics" for preset in presets])
        self.assertEqual(self.calls("apt-get"), [])
        *closing, counts = result.stdout.splitlines()[-3 * len(presets) - 1 :]
        self.assertEqual(closing[0::3], [f"{preset}:" for preset in presets])
        self.assertEqual(set(closing[1::3]), {"100% tests passed, 0 tests failed out of 1"})
        self.assertRegex(counts, r"^Cases: 4 tests ran\b.*\.$")
        # The omitted tests and the times.
        self.assertIn(
            "4 tests labelled full were left out; ./tools/dev test --full runs them.", result.stdout
        )
        self.assertRegex(result.stdout, r"\nSet-up took \d+ s, building \d+ s, testing \d+ s\.\n")

        # The second run configures nothing again.
        before = self.calls("cmake")
        again = self.run_dev("test", "--full", path=path, environment=environment)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertFalse(
            [call for call in self.calls("cmake")[len(before) :] if call.startswith("--preset")]
        )
        self.assertIn("100% tests passed, 0 tests failed out of 2", again.stdout)
        self.assertNotIn("left out", again.stdout)

    @needs_headers
    def test_a_failing_preset_fails_the_command_and_the_other_presets_still_run(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        broken = environment | {"BROKEN_BUILD": "--build --preset stm32f405", "BROKEN_TEST": "host"}
        result = self.run_dev("test", path=path, environment=broken)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(
            self.names_run(), [f"{preset}:physics" for preset in ("host", "host-asan", "qemu")]
        )
        self.assertIn(
            "\tphysics (Failed)", result.stdout.split("host-asan:\n")[0].rpartition("host:\n")[2]
        )
        self.assertIn("main.c:1: error: pretended", result.stderr)
        self.assertEqual(
            result.stderr.splitlines()[-1], "tools/dev: failed: host stm32f405 (build)"
        )

    def test_an_invalid_test_selection_is_an_error_before_installation(self) -> None:
        self.assert_refused(self.run_dev("test", "--wrong"), "--wrong", "tools/dev test --help")
        self.assert_refused(self.run_dev("test", "absent/folder"), "no folder 'absent/folder'")
        self.assert_refused(self.run_dev("test", "--since"), "--since")
        self.assert_refused(self.run_dev("test", "--since", "HEAD"), "--quick")
        self.assert_refused(self.run_dev("test", "--json"), "--json")
        self.assert_refused(self.run_dev("test", "--json", "no_folder/run.json"), "no_folder")
        self.assert_refused(self.run_dev("test", "--quick", "--full"), "--quick")
        self.assert_refused(self.run_dev("test", "--quick", "tools"), "--quick")

    def test_firmware_is_built_for_the_named_vehicle_and_by_default_for_lu2013(
        self,
    ) -> None:
        path, environment = self.pretend_everything_is_installed()
        generated = self.home / "firmware/config/generated"
        generated.mkdir(parents=True)
        for name in ("lu2013", "lu2013b"):
            (generated / f"{name}.c").touch()
        (self.home / "build/qemu").mkdir(parents=True)
        for suffix in ("bin", "hex"):
            (self.home / f"build/qemu/hubfoc_qemu.{suffix}").touch()

        for arguments, configured in (
            ([], ["--preset qemu -DHUBFOC_CONFIG=lu2013"]),
            ([], []),
            (["--config", "lu2013b"], ["--preset qemu -DHUBFOC_CONFIG=lu2013b"]),
            ([], ["--preset qemu -DHUBFOC_CONFIG=lu2013"]),
        ):
            before = len(self.calls("cmake")) if (self.base / "calls").exists() else 0
            result = self.run_dev(
                "firmware", "qemu", *arguments, path=path, environment=environment
            )
            self.assertEqual(result.returncode, 0, result.stderr)
            calls = self.calls("cmake")[before:]
            self.assertEqual([call for call in calls if call.startswith("--preset")], configured)
            self.assertEqual(calls[-1], "--build --preset qemu --target hubfoc_qemu")
            self.assertTrue(result.stdout.startswith("Memory region: pretended\n"), result.stdout)
            self.assertIn("build/qemu/hubfoc_qemu.hex", result.stdout)

        result = self.run_dev("firmware", "--config", "absent", path=path, environment=environment)
        self.assertEqual(
            (result.returncode, len(result.stderr.splitlines())), (USAGE, 1), result.stderr
        )
        self.assertIn("absent", result.stderr)

    def test_firmware_is_built_for_the_named_board_of_the_ones_that_there_are(self) -> None:
        cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
        help_text = self.run_dev("firmware", "--help").stdout
        boards = []
        for port, listed in re.findall(r"set\(HUBFOC_BOARDS_(\w+) (.*)\)", cmake):
            found = {path.stem for path in (ROOT / f"hal/{port}/boards").glob("*.h")}
            self.assertEqual(
                set(listed.split()), {name for name in found if not name.endswith("_common")}
            )
            self.assertIn(f"{port}: {listed}", help_text)
            boards += [(port, board) for board in listed.split()]
        self.assertEqual({port for port, _ in boards}, {"stm32f405", "stm32g431"})
        self.assert_refused(
            self.run_dev("firmware", "--board", "avr"), "avr", *(b for _, b in boards)
        )
        for port in ("qemu", "stm32f405"):
            self.assert_refused(self.run_dev("firmware", port, "--board", boards[-1][1]), "--board")
        for port, board in boards:
            for command in (["firmware"], ["flash", "--dry-run"]):
                self.assert_refused(
                    self.run_dev(*command, board), f"{port}, accepted: --board {board}"
                )

        path, environment = self.pretend_everything_is_installed()
        generated = self.home / "firmware/config/generated"
        generated.mkdir(parents=True)
        (generated / "lu2013.c").touch()
        for port in ("stm32f405", "stm32g431"):
            (self.home / f"build/{port}").mkdir(parents=True)
            for suffix in ("bin", "hex"):
                (self.home / f"build/{port}/hubfoc_{port}.{suffix}").touch()
        (generated / "wheel24v.c").touch()
        asked = [([], *boards[0]), *((["--board", board], port, board) for port, board in boards)]
        for arguments, port, board in asked:
            result = self.run_dev("firmware", *arguments, path=path, environment=environment)
            self.assertEqual(result.returncode, 0, result.stderr)
            configured = [c for c in self.calls("cmake") if c.startswith(f"--preset {port} ")]
            self.assertTrue(configured[-1].endswith(f"-DHUBFOC_BOARD={board}"), configured)
            config = "wheel24v" if port == "stm32g431" else "lu2013"
            self.assertIn(f"-DHUBFOC_CONFIG={config} ", configured[-1])

    def test_the_configuration_of_another_board_is_refused_before_anything_is_built(self) -> None:
        """Within 5 % of the full scales that the board's own header gives, as the board itself.

        And within 5 K at the code of 25 degrees Celsius that its switch sensor's divider has, its
        dead time, and the window of its shunts: a VESC 4's settle for 300 ns and are sampled for
        714 ns, with half of 1 us of dead time less than the pulse.
        """
        compiler = shutil.which("arm-none-eabi-gcc")
        if compiler is None:
            self.skipTest("needs the cross compiler")
        path, environment = self.pretend_everything_is_installed()
        (self.bin / "arm-none-eabi-gcc").unlink()
        (self.bin / "arm-none-eabi-gcc").symlink_to(compiler)
        (self.home / "hal").symlink_to(ROOT / "hal")
        generated = self.home / "firmware/config/generated"
        generated.mkdir(parents=True)
        (self.home / "build/stm32f405").mkdir(parents=True)
        for suffix in ("bin", "hex"):
            (self.home / f"build/stm32f405/hubfoc_stm32f405.{suffix}").touch()
        fitting = {
            **{"current_full_scale_mA": 165_000, "voltage_full_scale_mV": 61_800},
            **{"dead_time_ns": 1000, "min_pulse_ns": 500},
            **{"switch_lowest_code": 167, "switch_highest_code": 4031},
        }
        at_code_2048 = 32
        none = {"switch_lowest_code": 1, "switch_highest_code": 0}
        mk3, vesc4 = "vesc6_mk3", "vesc4_10"
        for board, values, shown_cc, wrong in (
            (mk3, {}, 2500, ""),
            # 4.97 and 4.85 % beside
            (
                mk3,
                {"current_full_scale_mA": 173_200, "voltage_full_scale_mV": 58_800} | none,
                0,
                "",
            ),
            (
                mk3,
                {"current_full_scale_mA": 173_300} | none,
                0,
                "is 173300, that of vesc6_mk3 is 165",
            ),
            (
                mk3,
                {"voltage_full_scale_mV": 58_700} | none,
                0,
                "is 58700, that of vesc6_mk3 is 618",
            ),
            (mk3, {"current_full_scale_mA": 280_000}, 0, "current_full_scale_mA is 280000"),
            (mk3, {}, 2999, ""),
            (mk3, {}, 4524, "the divider of vesc6_mk3, as 45 degC"),
            (mk3, {"switch_highest_code": 2047}, 2500, "is for another board"),
            (mk3, {"dead_time_ns": 360}, 2500, ""),
            (mk3, {"dead_time_ns": 359}, 2500, "dead_time_ns is 359, accepted: at least 360"),
            (vesc4, {}, 2500, "min_pulse_ns is 500, accepted: at least 1514"),
            (vesc4, {"min_pulse_ns": 1513}, 2500, "min_pulse_ns is 1513"),
            (vesc4, {"min_pulse_ns": 1514}, 2500, ""),
        ):
            points = [0] * 64
            points[at_code_2048] = shown_cc
            (generated / "mine.c").write_text(
                "".join(f"  .{key}  = {n}, /* [.] */\n" for key, n in (fitting | values).items())
                + f"  .switch_cC = {{{', '.join(map(str, points))}}},\n",
                encoding="utf-8",
            )
            for command in (["firmware"], ["flash", "--dry-run"]):
                (self.base / "calls").write_text("", encoding="utf-8")
                result = self.run_dev(
                    *command, "--config", "mine", "--board", board,
                    path=path, environment=environment,
                )  # fmt: skip
                self.assertEqual(result.returncode, USAGE if wrong else 0, result.stderr)
                self.assertIn(wrong, result.stderr)
                self.assertEqual([] if wrong else ["--build"], [
                    call.split()[0] for call in self.calls("cmake") if "--build" in call
                ])  # fmt: skip

    def test_table_writes_the_requested_files_and_plots_to_the_given_directory(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        (self.base / "mine.toml").touch()
        for arguments in ([], ["-o", "there"], ["--plots"], ["-o", "there", "--plots"]):
            result = self.run_dev(
                "table", "mine.toml", *arguments, path=path, environment=environment
            )
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(
                self.calls("python")[-1],
                " ".join(["-m regen_table generate mine.toml", *arguments]),
            )

    def test_hubsim_receives_its_arguments_unchanged_after_the_engine_is_built(self) -> None:
        path, environment = self.pretend_everything_is_installed()
        result = self.run_dev(
            "hubsim", "run", "stop", "--set", "a b=1", path=path, environment=environment
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("--build --preset host --target hubsim_engine", self.calls("cmake"))
        self.assertEqual(self.calls("python")[-1], "-m hubsim run stop --set a b=1")


if __name__ == "__main__":
    unittest.main()
