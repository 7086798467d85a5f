# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The build, only through the presets of CMakePresets.json: `cmake --preset host` typed by hand and
# the commands of tools/dev use the same directories and do not undo each other's work.

# shellcheck disable=SC2034  # read by tools/dev
readonly PORTS=(stm32f405 stm32g431 qemu) DEFAULT_CONFIG=lu2013
# The boards of each port in CMakeLists.txt, the default first; all of them.
# shellcheck disable=SC2034
readonly BOARDS_stm32f405=(vesc6_mk3 vesc6_mk6 vesc4_10 vesc75_300 mks84_200_hp gate_board)
readonly BOARDS_stm32g431=(b_g431b_esc1)
# shellcheck disable=SC2034
readonly BOARDS_qemu=()
# shellcheck disable=SC2034
readonly BOARDS=("${BOARDS_stm32f405[@]}" "${BOARDS_stm32g431[@]}")
readonly TESTED_PRESETS=(host host-asan stm32f405 qemu)
# variables_are FILE [NAME=VALUE...]: does CMake's cache have these values?
variables_are() {
    local file=$1 variable
    shift
    for variable in "$@"; do
        grep -qx "${variable%%=*}:[A-Z]*=${variable#*=}" "$file" || return
    done
}

# What CMake looks for when it configures, one per line. A build directory that was configured with
# other tools than the ones there are now is configured again: here, and by CMakeLists.txt for a
# build with CMake alone.
readonly TOOLS="$ROOT/.dev/tools"

list_tools() {
    local path
    type -P cmake ninja gcc g++ clang ruby cbmc arm-none-eabi-gcc qemu-system-arm clang-tidy |
        xargs -r readlink -f || true
    for path in "$CMOCK_PREFIX"/usr/share/cmock/lib/cmock.rb /usr/share/cmock/lib/cmock.rb \
        "$CBMC_PREFIX"/cbmc \
        /usr/include/eigen3 /usr/local/include/eigen3 \
        "$VENV"/pyvenv.cfg "$VENV"/lib/python*/site-packages/{fmpy,pytest,unicorn}-*.dist-info \
        "$ROOT"/.dev/svd/pyocd-*.whl; do
        [[ -e $path ]] && printf '%s\n' "$path"
    done
    return 0
}

note_tools() {
    list_tools >"$TOOLS.new"
    if cmp -s "$TOOLS.new" "$TOOLS"; then rm "$TOOLS.new"; else mv "$TOOLS.new" "$TOOLS"; fi
}

# configure PRESET [NAME=VALUE...], only if needed. A directory configured elsewhere (the repository
# was moved or copied) cannot be used; presets that changed since are not noticed by CMake itself.
# Every other change CMake detects itself.
configure() {
    local preset=$1 directory=$ROOT/build/$1 options=()
    shift
    if [[ -f $directory/CMakeCache.txt ]]; then
        if ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$ROOT" "$directory/CMakeCache.txt"; then
            options=(--fresh)
        elif [[ $directory/build.ninja -nt $ROOT/CMakePresets.json &&
            ! $TOOLS -nt $directory/build.ninja ]] &&
            variables_are "$directory/CMakeCache.txt" "$@"; then
            return
        fi
    fi
    options+=("${@/#/-D}")
    (cd "$ROOT" && run_logged "Configuring $preset" "configure-$preset" \
        cmake --preset "$preset" "${options[@]}")
}

# tests_can_be_built: are the tools there without which CMake refuses to configure them?
tests_can_be_built() {
    [[ -z $(missing_packages build host unit) ]] && cmock_is_there &&
        venv_is_ready "${PYTHON_SETS[@]}"
}

# shellcheck disable=SC2120  # tools/dev passes them
# configure_host [NAME=VALUE...]: for the simulator, which needs none of the tests' tools. A
# directory that has the tests keeps them; without their tools it is configured without them, and
# `tools/dev test` adds them later.
configure_host() {
    local tests=OFF cache=$ROOT/build/host/CMakeCache.txt
    if [[ -f $cache ]] && variables_are "$cache" HUBFOC_TESTS=ON && tests_can_be_built; then
        tests=ON
    fi
    configure host "HUBFOC_TESTS=$tests" "$@"
}

# build_for_platforms: the units of the host preset with binaries for Linux, Windows and macOS, in
# build/fmu. What the compiler keeps stays below .dev.
build_for_platforms() {
    export ZIG_GLOBAL_CACHE_DIR="$ROOT/.dev/zig" ZIG_LOCAL_CACHE_DIR="$ROOT/.dev/zig"
    (cd "$ROOT" && run_logged "Compiling for five platforms" platforms \
        "$VENV_PYTHON" -m hubsim.fmu platforms build/host/host_sim/fmu/*.fmu -o build/fmu) ||
        fail "the units could not be compiled for other platforms"
}

# build_targets PRESET [TARGET...], in a configured directory; by default all but what only tests
# labelled full need (tools/cmake/HubfocFull.cmake)
build_targets() {
    local preset=$1 targets=()
    shift
    if (($#)); then targets=(--target "$@"); else targets=(--target all); fi
    (cd "$ROOT" && LAST_LINE_IF_IDLE="ninja: no work to do." \
        run_logged "Building $preset" "build-$preset" \
            cmake --build --preset "$preset" "${targets[@]}")
}

build_engine() {
    # shellcheck disable=SC2119
    configure_host
    build_targets host hubsim_engine
}

# build PRESET [TARGET...]: with its tests
build() {
    local preset=$1
    shift
    configure "$preset" HUBFOC_TESTS=ON && build_targets "$preset" "$@"
}

# build_for_tests FULL [FOLDER...]: all presets, or what the tests of these folders need of them;
# with a FULL that is not empty also what the tests labelled full need. Leaves the presets' names in
# BUILT and NOT_BUILT, and what each took in the file times of LOG_DIR.
BUILT=()
NOT_BUILT=()
build_for_tests() {
    local full=$1 preset begin took_us targets builds=()
    shift
    BUILT=()
    NOT_BUILT=()
    mkdir -p "$LOG_DIR"
    : >"$LOG_DIR/times"
    for preset in "${TESTED_PRESETS[@]}"; do
        begin=${EPOCHREALTIME/[.,]/}
        if ! configure "$preset" HUBFOC_TESTS=ON; then
            NOT_BUILT+=("$preset")
            continue
        fi
        took_us=$((${EPOCHREALTIME/[.,]/} - begin))
        printf '%s configure %d.%02d\n' "$preset" $((took_us / 1000000)) \
            $((took_us / 10000 % 100)) >>"$LOG_DIR/times"
        targets=all${full:+ full_tests}
        if (($#)); then
            targets=$("$VENV_PYTHON" -m run_tests ${full:+--full} --presets "$preset" \
                --list-targets "$@") ||
                fail "test: ctest cannot list the tests"
            [[ -n $targets ]] || continue
        fi
        builds+=("$preset:$targets")
    done
    if ((${#builds[@]})); then
        # All have failed until the build says which ones have.
        printf '%s\n' "${builds[@]%%:*}" >"$LOG_DIR/build-failed"
        run_logged "Building $(join_by ' ' "${builds[@]%%:*}")" build \
            "$VENV_PYTHON" -m run_tests.build "$LOG_DIR" "${builds[@]}" || true
    fi
    for preset in "${builds[@]%%:*}"; do
        if grep -qsx "$preset" "$LOG_DIR/build-failed"; then
            NOT_BUILT+=("$preset")
        else
            BUILT+=("$preset")
        fi
    done
}

# default_config PORT: the board of the stm32g431 is made for 25 V.
default_config() {
    if [[ $1 == stm32g431 ]]; then echo wheel24v; else echo "$DEFAULT_CONFIG"; fi
}

# board_fact PORT BOARD EXPRESSION: a number of a board, as its header computes it. Of a zero the
# compiler writes no word.
board_fact() {
    local found
    found=$(arm-none-eabi-gcc -x c -S -o - \
        -I "$ROOT/hal/$1" -I "$ROOT/hal/stm32" -I "$ROOT/hal/include" \
        "-DHUBFOC_BOARD_HEADER=\"boards/$2.h\"" - <<<"#include \"board.h\"
#include \"analog_start.h\"
const int fact = $3;" | sed -n 's/^[[:space:]]*\.word[[:space:]]*//p')
    printf '%s' "${found:-0}"
}

# table_value CONFIG FIELD: a number of a configuration; 0 if it has no such field.
table_value() {
    local found
    found=$(sed -n "s/^ *\.$2 *= \([0-9]*\),.*/\1/p" "$ROOT/firmware/config/generated/$1.c")
    printf '%s' "${found:-0}"
}

# check_board COMMAND PORT BOARD CONFIG: refuses the configuration of another board, as the board
# itself would (board_check.c, inverter.c).
check_board() {
    check_scales "$@"
    check_switch_sensor "$@"
    check_dead_time "$@"
}

# check_scales COMMAND PORT BOARD CONFIG: full scales within 5 %.
check_scales() {
    local field macro own of_board
    for field in current_full_scale_mA voltage_full_scale_mV; do
        macro=${field%_*}
        of_board=$(board_fact "$2" "$3" "BOARD_${macro^^}_${field##*_}")
        own=$(table_value "$4" "$field")
        ((20 * (own - of_board) <= of_board && 20 * (of_board - own) <= of_board)) ||
            usage_fail "$1: $4 is for another board: its $field is $own, that of $3 is $of_board," \
                "accepted: within 5 %"
    done
}

# check_switch_sensor COMMAND PORT BOARD CONFIG: the sensor beside the switches is in the board's
# divider: its code of 25 degrees has to be within 5 K of them.
check_switch_sensor() {
    local table=$ROOT/firmware/config/generated/$4.c code lowest highest points shown
    code=$(board_fact "$2" "$3" BOARD_SWITCH_25C_code)
    lowest=$(table_value "$4" switch_lowest_code)
    highest=$(table_value "$4" switch_highest_code)
    ((highest > 0 && lowest <= highest)) || return 0
    IFS=', ' read -r -a points < <(sed -n 's/^ *\.switch_cC = {\(.*\)},$/\1/p' "$table")
    shown=$((points[code / 64] + (points[code / 64 + 1] - points[code / 64]) * (code % 64) / 64))
    ((code >= lowest && code <= highest && shown >= 2000 && shown <= 3000)) ||
        usage_fail "$1: $4 is for another board: its switch_sensor reads the code $code, 25 degC" \
            "by the divider of $3, as $((shown / 100)) degC, accepted: within 5 K"
}

# check_dead_time COMMAND PORT BOARD CONFIG: at least what the board's switches need, and of
# low-side shunts a window in which they settle and are sampled, with current into the board.
check_dead_time() {
    local own least settled window
    own=$(table_value "$4" dead_time_ns)
    least=$(board_fact "$2" "$3" BOARD_DEAD_TIME_LEAST_ns)
    ((own >= least)) ||
        usage_fail "$1: $4 is for another board: its dead_time_ns is $own, accepted: at least" \
            "$least, the least of $3"
    settled=$(board_fact "$2" "$3" \
        "BOARD_AMPLIFIER_SETTLING_ns ? BOARD_AMPLIFIER_SETTLING_ns + ANALOG_SAMPLING_ns : 0")
    window=$(table_value "$4" min_pulse_ns)
    ((settled == 0 || window >= settled + own / 2)) ||
        usage_fail "$1: $4 is for another board: its min_pulse_ns is $window, accepted: at least" \
            "$((settled + own / 2)), in which the low-side shunts of $3 are sampled"
}

# port_of_board BOARD: nothing if there is no such board.
port_of_board() {
    local port
    for port in "${PORTS[@]}"; do
        local -n boards=BOARDS_$port
        contains "$1" "${boards[@]}" && printf '%s' "$port"
    done
    return 0
}

# join_by SEPARATOR [WORD...]
join_by() {
    local IFS=$1
    shift
    printf '%s' "$*"
}

# The tests of one preset, with ctest's own output.
run_tests() { (cd "$ROOT" && ctest --preset "$1" --parallel "$(nproc)"); }
