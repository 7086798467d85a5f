# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The build, through the presets of CMakePresets.json and nothing else, so that `cmake --preset host` typed by hand and
# the commands of tools/dev meet in the same directories and never undo each other's work.

# shellcheck disable=SC2034  # read by tools/dev
readonly PORTS=(stm32f405 qemu) DEFAULT_CONFIG=lu2013
# variables_are FILE [NAME=VALUE...]: does CMake's cache say so?
variables_are() {
    local file=$1 variable
    shift
    for variable in "$@"; do
        grep -qx "${variable%%=*}:[A-Z]*=${variable#*=}" "$file" || return
    done
}

# configure PRESET [NAME=VALUE...], only if needed. A directory configured elsewhere (the repository was moved or copied)
# cannot be used; presets that changed since are not noticed by CMake itself. Everything else CMake finds out alone.
configure() {
    local preset=$1 directory=$ROOT/build/$1 options=()
    shift
    if [[ -f $directory/CMakeCache.txt ]]; then
        if ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$ROOT" "$directory/CMakeCache.txt"; then
            options=(--fresh)
        elif [[ $directory/build.ninja -nt $ROOT/CMakePresets.json ]] && variables_are "$directory/CMakeCache.txt" "$@"; then
            return
        fi
    fi
    options+=("${@/#/-D}")
    (cd "$ROOT" && run_logged "Configuring $preset" "configure-$preset" cmake --preset "$preset" "${options[@]}")
}

# build PRESET [TARGET...]
build() {
    local preset=$1 targets=()
    shift
    configure "$preset" || return
    (($#)) && targets=(--target "$@")
    (cd "$ROOT" && LAST_LINE_IF_IDLE="ninja: no work to do." \
        run_logged "Building $preset" "build-$preset" cmake --build --preset "$preset" "${targets[@]}")
}

# The runner's own output is the product of this step: it goes to the screen, and to a log for the summary at the end.
run_tests() {
    local preset=$1 log=$LOG_DIR/ctest-$1.log
    mkdir -p "$LOG_DIR"
    (cd "$ROOT" && ctest --preset "$preset" --parallel "$(nproc)") 2>&1 | tee "$log"
}

# What ctest says when it is through: failed tests by name, the count, the time.
closing_lines() {
    local log=$LOG_DIR/ctest-$1.log
    printf '%s:\n' "$1"
    sed -n '/tests passed\|No tests were found/,$p' "$log" | grep -v '^$' || echo "(no result; see ${log#"$ROOT"/})"
}
