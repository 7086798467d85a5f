# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# tools/dev release: builds every part of a release; tools/release/collect.py checks them and puts
# them into one folder.

help_release() {
    cat <<'TEXT'
Usage: tools/dev release [-o DIR] [--trial] [--platforms]

Builds the firmware of the stm32f405's first board (BIN, HEX, ELF), the co-simulation units and the
Python wheel, and puts them with the configurations, the CAN protocol (DBC) and the licences into
DIR/hubfoc-VERSION (default: build/release), with the SHA-256 of every file in SHA256SUMS. The
version is that of project() in CMakeLists.txt. The same commit and compilers give the same BIN from
any folder.

  --trial        also with changed files and such that git does not know; with changed ones the
                 commit in every part ends in "+"
  --platforms    co-simulation units with binaries for other platforms (tools/dev fmu --help)
TEXT
}

cmd_release() {
    local output=$ROOT/build/release trial='' platforms='' wheels=$ROOT/build/wheel
    local units=$ROOT/build/host/host_sim/fmu
    while (($#)); do
        case $1 in
            -o | --output)
                (($# > 1)) || usage_fail "release: $1 needs a directory"
                output=$2
                shift
                ;;
            --trial) trial=yes ;;
            --platforms) platforms=zig ;;
            *) usage_fail "release: no option '$1' (tools/dev release --help)" ;;
        esac
        shift
    done
    [[ -n $trial ]] || check_committed
    ensure build host arm sim fmi test ${platforms:+"$platforms"}
    if [[ -z $trial ]] && ! is_a_commit; then
        usage_fail "release: not the files of a commit (tools/dev release --help)"
    fi
    SOURCE_DATE_EPOCH=$(git -C "$ROOT" log -1 --format=%ct 2>/dev/null || echo 0)
    export SOURCE_DATE_EPOCH
    configure stm32f405 "HUBFOC_CONFIG=$DEFAULT_CONFIG" "HUBFOC_BOARD=${BOARDS[0]}"
    # Changed files besides those that the rules know make a "+" too.
    rm -f "$ROOT/build/stm32f405/firmware/app/commit/stamp" "$ROOT"/build/host/host_sim/fmu/*.fmu
    build_targets stm32f405 hubfoc_stm32f405
    configure_host HUBFOC_FMU=ON "HUBFOC_FMU_CONFIG=$ROOT/tools/motors/$DEFAULT_CONFIG.toml"
    build_targets host fmu
    if [[ -n $platforms ]]; then
        rm -rf "$ROOT/build/fmu"
        build_for_platforms
        units=$ROOT/build/fmu
    fi
    rm -rf "$wheels"
    run_logged "Building the Python wheel" wheel build_wheel "$wheels" ||
        fail "the wheel could not be built"
    "$VENV_PYTHON" "$ROOT/tools/release/collect.py" --config "$DEFAULT_CONFIG" \
        --units "$units" --wheel "$wheels"/*.whl --output "$output"
}

# check_committed: refuses files that git does not know or that have changed: configurations, drives
# and modules of a release are found by their places.
check_committed() {
    local file
    [[ -e $ROOT/.git ]] || return 0
    file=$(git -C "$ROOT" status --porcelain --untracked-files=all | sed -n '1s/^...//p')
    [[ -z $file ]] || usage_fail "release: $file is not as in a commit; commit it, move it away," \
        "or --trial (tools/dev release --help)"
}

is_a_commit() {
    local commit
    commit=$("$VENV_PYTHON" -c 'from regen_table import installation; print(installation.commit())')
    [[ $commit =~ ^[0-9a-f]{40}$ ]]
}

build_wheel() {
    PATH=$VENV/bin:$PATH "$VENV_PYTHON" -m pip wheel --no-index --no-deps --no-build-isolation \
        --disable-pip-version-check --wheel-dir "$1" "$ROOT/host_sim/python"
}
