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

# What CMake looks for when it configures, one per line. A build directory that was configured with other tools than
# the ones there are now is configured again: here, and by CMakeLists.txt for whoever builds with CMake alone.
readonly TOOLS="$ROOT/.dev/tools"

list_tools() {
    local name path
    for name in cmake ninja gcc g++ clang ruby cbmc arm-none-eabi-gcc qemu-system-arm clang-tidy; do
        path=$(command -v "$name") && readlink -f "$path"
    done
    for path in "$CMOCK_PREFIX"/usr/share/cmock/lib/cmock.rb /usr/share/cmock/lib/cmock.rb "$CBMC_PREFIX"/cbmc \
        /usr/include/eigen3 /usr/local/include/eigen3 \
        "$VENV"/pyvenv.cfg "$VENV"/lib/python*/site-packages/{fmpy,pytest}-*.dist-info; do
        [[ -e $path ]] && printf '%s\n' "$path"
    done
    return 0
}

note_tools() {
    list_tools >"$TOOLS.new"
    if cmp -s "$TOOLS.new" "$TOOLS"; then rm "$TOOLS.new"; else mv "$TOOLS.new" "$TOOLS"; fi
}

# configure PRESET [NAME=VALUE...], only if needed. A directory configured elsewhere (the repository was moved or copied)
# cannot be used; presets that changed since are not noticed by CMake itself. Everything else CMake finds out alone.
configure() {
    local preset=$1 directory=$ROOT/build/$1 options=()
    shift
    if [[ -f $directory/CMakeCache.txt ]]; then
        if ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$ROOT" "$directory/CMakeCache.txt"; then
            options=(--fresh)
        elif [[ $directory/build.ninja -nt $ROOT/CMakePresets.json && ! $TOOLS -nt $directory/build.ninja ]] &&
            variables_are "$directory/CMakeCache.txt" "$@"; then
            return
        fi
    fi
    options+=("${@/#/-D}")
    (cd "$ROOT" && run_logged "Configuring $preset" "configure-$preset" cmake --preset "$preset" "${options[@]}")
}

# tests_can_be_built: is all there that CMake insists on for them?
tests_can_be_built() { [[ -z $(missing_packages build host unit) ]] && cmock_is_there && venv_is_ready "${PYTHON_SETS[@]}"; }

# shellcheck disable=SC2120  # tools/dev passes them
# configure_host [NAME=VALUE...]: for the simulator, which needs none of the tests' tools. A directory that has the tests
# keeps them; without their tools it is configured without them, and `tools/dev test` adds them later.
configure_host() {
    local tests=OFF cache=$ROOT/build/host/CMakeCache.txt
    if [[ -f $cache ]] && variables_are "$cache" HUBFOC_TESTS=ON && tests_can_be_built; then tests=ON; fi
    configure host "HUBFOC_TESTS=$tests" "$@"
}

# build_targets PRESET [TARGET...], in a configured directory
build_targets() {
    local preset=$1 targets=()
    shift
    (($#)) && targets=(--target "$@")
    (cd "$ROOT" && LAST_LINE_IF_IDLE="ninja: no work to do." \
        run_logged "Building $preset" "build-$preset" cmake --build --preset "$preset" "${targets[@]}")
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
