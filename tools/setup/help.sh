# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The help texts of the commands.

help_top() {
    cat <<'TEXT'
Usage: tools/dev COMMAND [ARGUMENT...]

On a bare Debian 12 or 13 (Ubuntu 24.04 is expected to work, too), every command first installs what
it lacks (root or sudo; system packages with apt, Python packages into .dev/venv), then does its
work.

  sim                           the urban cycle with three braking strategies: energies and report
  test [--quick] [FOLDER...]    all tests: host, host with sanitizers, emulated Cortex-M4
  table DRIVE [-o DIR]          configuration and torque table of one vehicle, as C and binary
  firmware [PORT]               ELF, BIN, HEX, sizes, stack; stm32f405 (default), stm32g431, qemu
  flash [PORT]                  firmware onto a board through a debug probe
  hubsim ARGUMENT...            the simulator's own command
  live [OPTION...]              a virtual vehicle in real time: page in the browser, CAN bus
  study [NAME]                  measurements in closed loop: table, picture; no NAME: their list
  python ARGUMENT...            the project's Python, with hubsim and regen_table importable
  fmu [--config DRIVE]          units for co-simulation (FMI 2.0, 3.0): controller, whole vehicle
  release [-o DIR]              firmware, configurations, DBC, FMUs and wheel with SHA-256 sums
  bench                         instructions, stack, code size, simulation speed
  coverage [--mcdc]             which lines, branches and conditions the C tests reach
  mutants [MODULE...]           which changes of the control modules no unit test notices
  oracle --check [--quick]      whether the firmware computes what it did, by stored hashes
  report                        show the page that sim wrote
  format                        rewrite all sources in the project's format
  lint                          format, types and static checks
  setup [GROUP...]              only install
  clean [--all]                 remove build/ (with --all also .dev/)

A DRIVE is a TOML file, or the name of one in tools/motors.
tools/dev COMMAND --help has the details. Exit status: 0 done, 1 failed, 2 wrong usage, 130
interrupted.
TEXT
}

help_sim() {
    cat <<'TEXT'
Usage: tools/dev sim

Builds the simulation engine, drives the urban cycle with the three braking strategies, four
complete controllers each, prints the energy table and writes build/report/index.html (opens
offline) and build/report/summary.json.
TEXT
}

help_test() {
    cat <<'TEXT'
Usage: tools/dev test [--full] [--no-cache] [--json FILE] [FOLDER...]
       tools/dev test --quick [--since REV] [--json FILE]

Builds and tests four presets: host, host-asan (address and undefined-behaviour sanitizers),
stm32f405 and qemu (the firmware on an emulated Cortex-M4). All tests run in one run of ctest, the
longest first; the closing lines of each preset come last. A preset that cannot be built does not
keep the others from being tested.

  FOLDER         only the tests of a folder, for example unit/firmware/torque
  --full         also the tests labelled full: whole cycles, large sweeps, long fuzzing
  --no-cache     repeat proofs, static analysis and second builds that were good before with the
                 same content (.dev/known)
  --json FILE    write what was done and what it took, also when tests fail: wall_s, cpu_s, cores;
                 configure_s, build_s and test_s of each preset; cases by kind and preset; the names
                 of the tests left out and failed; proofs run and cached
  --quick        on a tree that was built and tested before: build and run, in at most 40 s, what
                 belongs to the files changed since HEAD or REV, by the build's own dependencies:
                 first their own unit tests, then the shortest; what was left out is named
TEXT
}

help_table() {
    cat <<'TEXT'
Usage: tools/dev table DRIVE [--set KEY=VALUE]... [-o DIR] [--plots]

Turns one vehicle's TOML file into the configuration that the firmware is built with. DRIVE is the
file, or the name of one in tools/motors. It becomes <name>.c and, with the same bytes, <name>.bin.
Without -o they go to firmware/config/generated. With --plots the figures of losses and optimum are
drawn as well, into DIR or else build/report/figures.

With --set a key of the file (section.key) has another value, and the name says so: `tools/dev table
mine --set vehicle.wheel_position=rear_left` makes mine_rear_left.c and .bin.
TEXT
}

# shellcheck disable=SC2154  # build.sh has the boards
help_firmware() {
    cat <<TEXT
Usage: tools/dev firmware [PORT] [--config DRIVE] [--board BOARD]

Builds the firmware for PORT, stm32f405 (default), stm32g431 or qemu; prints its sizes, the depth of
the stack and the paths of ELF, BIN and HEX. DRIVE is a TOML file or the name of one in
tools/motors, of which tools/dev table has made the configuration; if not given, wheel24v for
stm32g431 and lu2013 for the others. BOARD, from which PORT follows, is one of
    stm32f405: ${BOARDS_stm32f405[*]}
    stm32g431: ${BOARDS_stm32g431[*]}
(hal/<port>/boards); the port's first if not given.
TEXT
}

help_flash() {
    cat <<'TEXT'
Usage: tools/dev flash [PORT] [--config DRIVE [--set KEY=VALUE]... [--only-config]]
                       [--board BOARD] [--probe stlink|cmsis-dap|jlink] [--with openocd|pyocd]
                       [--dry-run]
       tools/dev flash [PORT] --config DRIVE --only-config --with serial --line DEVICE

Builds the firmware (as tools/dev firmware does) and writes it to the board through a debug probe,
by default an ST-Link, with OpenOCD (default) or with pyOCD, which finds the probe itself and
fetches a device pack on first use. With --only-config the program on the board stays and only the
configuration's sectors are written: another motor, the same firmware. That also goes without a
probe, over the serial line to the firmware's shell (--with serial); the wheel has to stand still,
and the firmware checks the configuration before it replaces the old one. The wheel must be off the
ground.
With --set the table is made first, as by tools/dev table, so that one file serves all wheels:
--config mine --set vehicle.wheel_position=rear_left.
With --dry-run everything is built, and printed is what would be written and by which command.

OpenOCD also sets an STM32F405's brown-out level to 3 (option bytes; only of a chip without
protection); pyOCD does not. The firmware reports another level at its start. The counters of faults
since production stay, unless the BIN file is written by hand.
TEXT
}

help_hubsim() {
    cat <<'TEXT'
Usage: tools/dev hubsim ARGUMENT...

Brings the simulation engine up to date and hands the arguments to `python -m hubsim`, whose own
help follows; `tools/dev hubsim COMMAND --help` is its own as well and installs nothing. Sweeps,
pictures and files that end in .parquet or .mf4 install their Python packages first; `run SCENARIO
--on qemu` installs the emulator and builds the cross-compiled controllers, `--on board` builds the
whole application for this machine.
TEXT
}

help_live() {
    cat <<'TEXT'
Usage: tools/dev live [OPTION...]

Builds the whole application for this machine and lets a virtual vehicle with it run in real time,
with a page in the browser and a CAN bus: `python -m hubfoc live`, whose own help follows.
TEXT
}

help_study() {
    cat <<'TEXT'
Usage: tools/dev study [NAME [OPTION...]]

Brings the simulation engine up to date and measures what a study of host_sim/studies asks; without
NAME it lists them. The table NAME.csv, its origin NAME.json and the picture go to the folder of -o,
without it to build/studies/NAME; --json FILE has everything for machines; --refresh measures all of
it again and renews table, picture and page in host_sim/studies/NAME. `tools/dev study NAME --help`
has the rest. Exit status 1 if what the study asks for does not hold.
TEXT
}

help_python() {
    cat <<'TEXT'
Usage: tools/dev python ARGUMENT...

Runs the private Python environment .dev/venv, in which hubsim and regen_table can be imported. For
example:
  tools/dev python -m regen_table solve tools/motors/lu2013.toml --speed-rpm 100,200 --json
TEXT
}

help_fmu() {
    cat <<'TEXT'
Usage: tools/dev fmu [--config DRIVE] [--platforms]

Builds four units for co-simulation from one drive, a TOML file or the name of one in tools/motors
(default: lu2013), and prints their paths: hubfoc_controller (one controller) and hubfoc_vehicle
(controllers with motors, battery, brakes and road), each for FMI 2.0 and 3.0, with binary for this
machine and complete source.

  --platforms    units in build/fmu with binaries for Linux with a C library from 2.17 on (x86-64,
                 ARM64), Windows (x86-64) and macOS (x86-64, ARM64), by the compiler in the Python
                 package ziglang, which is installed then (411 MB); takes minutes the first time
TEXT
}

help_bench() {
    cat <<'TEXT'
Usage: tools/dev bench [--config DRIVE] [--no-simulation] [--update-readme]

Measures both step functions on emulated cores (instructions, code, stack), the interrupts of the
flashable images on the models of their chips, the firmware's size and the simulation's speed;
prints them and writes build/bench.json. A missed budget is a failure. --update-readme writes the
tables of tools/benchmark/README.md.
TEXT
}

help_coverage() {
    cat <<'TEXT'
Usage: tools/dev coverage
       tools/dev coverage --mcdc [--least SHARE] [--jobs N]

Builds the host-coverage preset, runs the unit and closed-loop tests in C and prints lines and
branches reached in each file of the firmware; build/coverage/index.html shows them line by line,
build/coverage/summary.json is for machines.

  --mcdc         builds the host-mcdc preset instead (clang 19), runs the unit tests of the pure
                 modules, prints how many branches and conditions (MC/DC) of each they reach, and
                 names the others
  --least SHARE  exit status 1 if a module has a smaller share of either; default: 0.95
  --jobs N       so many at the same time; default: one for each processor
TEXT
}

help_mutants() {
    cat <<'TEXT'
Usage: tools/dev mutants [MODULE...] [--json FILE] [--least SCORE] [--sample N] [--file NAME]
                         [--jobs N] [--list]

Mutation testing of modules of the firmware (default: those of tests/mutants/modules.txt). Every
relation, sum, constant, condition, limit and statement is changed, one at a time, and the unit
tests of the module meet each change. Changes that survive are listed. The score of a module is
killed / (compiled - same_code), where same_code are changes that make no other instructions.

  --json FILE    also write to FILE, by module: compiled, same_code, killed, score, and survivors,
                 each with file, line, operator, before, after
  --least SCORE  exit status 1 if a module scores less; default: 0.92. With --sample: if a module
                 with this score would be drawn so badly once in a hundred times
  --sample N     only N mutants, drawn at random, the same ones each time
  --file NAME    only those of one file, e.g. monitor_speed.c
  --jobs N       so many at the same time; default: one for each processor
  --list         print the mutants; nothing is built
TEXT
}

help_oracle() {
    cat <<'TEXT'
Usage: tools/dev oracle --check [--quick] [--baseline FILE] [--part PART]... [--reached] [--jobs N]
       tools/dev oracle -o FILE [--quick] [--part PART]... [--reached] [--jobs N]
       tools/dev oracle --values PART ENTRY -o FILE

Runs both control steps through many thousand drives and hashes every value that they give
(tests/oracle/README.md): for changes of the firmware that are to change nothing.

  --check           compare with the stored hashes; status 1 if any differs, with the part, what of
                    it (fast, slow, events, bytes), and the first entry that differs
  --quick           a part of everything, for every commit: no long cycle, a third of the random
                    drives and of the faults
  --baseline FILE   compare with this file; default: tests/oracle/d6b76bd7.json
  -o FILE           write the hashes into a file
  --part PART       only this one, several with several options: sequences, random_slow,
                    random_fast, application, scenarios, cycle, faults
  --reached         print how many slow steps reached each mode, bridge mode, fault and limit
  --jobs N          so many processes; default: two
  --values PART ENTRY -o FILE
                    write every change of a value in one entry: "step controller value number" a
                    line. The files of two trees, compared, show where they begin to differ.
TEXT
}

help_report() {
    cat <<'TEXT'
Usage: tools/dev report

Opens build/report/index.html in the browser, or prints its path where there is no desktop. Runs sim
first if the page does not exist.
TEXT
}

help_format() {
    cat <<'TEXT'
Usage: tools/dev format

Rewrites every C and Python source, except generated ones, in the project's format (clang-format and
ruff, both pinned).
TEXT
}

help_lint() {
    cat <<'TEXT'
Usage: tools/dev lint

Checks without changing anything: the tests labelled lint (clang-format, ruff, mypy, clang-tidy) and
shellcheck. Exit status 1 if any found something.
TEXT
}

help_setup() {
    cat <<'TEXT'
Usage: tools/dev setup [GROUP...]

Installs what the other commands would install when they need it. Groups (all, if none is named):
  build     cmake, ninja                    host     gcc, g++
  unit      ruby, CMock with Unity, Eigen   proofs   CBMC, clang with its fuzzer
  arm       arm-none-eabi-gcc, newlib       qemu     qemu-system-arm
  checks    clang-tidy, shellcheck          browser  Chromium without a window
Sets of Python packages in .dev/venv (python means all of them):
  sim       numpy, pydantic, cffi, rich     figures  matplotlib
  formats   pyarrow, asammdf                sweep    dask
  live      python-can, foxglove-sdk        fmi      fmpy
  examples  motulator, scipy                bench    unicorn
  test      pytest, cantools                dev      ruff, mypy, clang-format, gcovr
Only if named, or for fmu --platforms and release --platforms:
  zig       ziglang, a compiler for other platforms (411 MB)
TEXT
}

help_clean() {
    cat <<'TEXT'
Usage: tools/dev clean [--all]

Removes build/; with --all also .dev/, that is the Python environment, CMock and the logs.
TEXT
}
