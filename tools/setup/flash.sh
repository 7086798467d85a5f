# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Writing a firmware image through a debug probe. OpenOCD is taken where there is a choice, because
# it knows both STM32 families by itself; pyOCD, if it is asked for, fetches a device pack for
# this part on first use. With DRY_RUN set nothing is installed or written, and what
# would be done is printed.

readonly PYOCD_VERSION=0.46.0
# chip_of IMAGE pyocd|openocd: what the program calls the chip of an image, whose name ends in it.
chip_of() {
    case ${1##*_},$2 in
        stm32f405,pyocd) echo stm32f405rg ;;
        stm32f405,openocd) echo stm32f4x ;;
        stm32g431,pyocd) echo stm32g431cbux ;;
        stm32g431,openocd) echo stm32g4x ;;
    esac
}

# flash_openocd all|config IMAGE PROBE, where IMAGE is the path of the ELF without its ending
flash_openocd() {
    local what=$1 image=$2 probe=$3 file=$2.elf brown_out=()
    [[ $image != *_stm32f405 ]] ||
        brown_out=(-f "$ROOT/tools/setup/brown_out.tcl" -c brown_out_level_3)
    [[ $what == all ]] || file=${image}_config_probe.hex
    [[ -n $DRY_RUN ]] || ensure_packages openocd
    flash_with "$probe" openocd -f "interface/$probe.cfg" \
        -f "target/$(chip_of "$image" openocd).cfg" "${brown_out[@]:0:2}" \
        -c "program {$file} verify" "${brown_out[@]:2}" -c "reset run" -c shutdown
    [[ -n $DRY_RUN ]] || grep -h 'brown-out level' "$LOG_DIR/flash.log" || true
}

# flash_pyocd all|config IMAGE
flash_pyocd() {
    local what=$1 image=$2 pyocd=$VENV/bin/pyocd file=$2.hex target
    target=$(chip_of "$image" pyocd)
    [[ $what == all ]] || file=${image}_config_probe.hex
    if [[ -n $DRY_RUN ]]; then
        flash_with "any that pyOCD knows" "$pyocd" flash --target "$target" --no-wait "$file"
        return
    fi
    ensure sim
    if [[ ! -x $pyocd ]]; then
        run_logged "Installing pyOCD into .dev/venv" pyocd install_pyocd ||
            fail "pyOCD could not be installed"
    fi
    # pyOCD reports success also if it found no pack, so its list of targets is checked.
    if ! pyocd_knows_target "$pyocd" "$target"; then
        run_logged "Fetching pyOCD's device pack for $target" pyocd-pack "$pyocd" pack \
            install "$target" || true
        pyocd_knows_target "$pyocd" "$target" ||
            fail "flash: pyOCD could not fetch its pack for $target; OpenOCD needs none:" \
                "tools/dev flash --with openocd"
    fi
    flash_with "any that pyOCD knows" "$pyocd" flash --target "$target" --no-wait \
        "$file"
}

# pyOCD may bring packages of its own but not change the version of one of the project's.
install_pyocd() {
    local constraints status=0
    constraints=$(mktemp)
    sed -n 's/^\([^#]*==[^ ]*\).*/\1/p' "$REQUIREMENTS"/*.txt | sort -u >"$constraints"
    "$VENV_PYTHON" -m pip install --disable-pip-version-check --no-input --progress-bar off \
        --constraint "$constraints" "pyocd==$PYOCD_VERSION" || status=$?
    rm -f "$constraints"
    return "$status"
}

# flash_serial config IMAGE PROBE LINE: through the firmware's own shell, so that a board in its
# housing needs no probe.
flash_serial() {
    local image=$2_config.hex line=$4
    if [[ -n $DRY_RUN ]]; then
        inform "Would send ${image#"$ROOT"/} over $line to the shell's command install"
        return
    fi
    inform "Sending ${image##*/} over $line; the wheel has to stand still, switched off"
    stty -F "$line" 115200 raw -echo 2>/dev/null ||
        fail "flash: $line cannot be set to 115200 baud; may this user open it?"
    exec 8<>"$line" || fail "flash: $line cannot be opened"
    printf '\003install\r' >&8
    answer_with 'Intel HEX' || fail "flash: nothing on $line answers as hubfoc's shell does"
    cat "$image" >&8
    answer_with 'accepted:|refused:|given up|as it was' ||
        fail "flash: no answer to the configuration; is it on?"
    [[ $ANSWER == *accepted:* ]] || fail "flash: ${ANSWER//$'\r'/}"
    answer_with 'written|FAILED|refused:' ||
        fail "flash: no answer about the memory; the board has to be inspected"
    exec 8>&-
    [[ $ANSWER == *written* ]] || fail "flash: ${ANSWER//$'\r'/}"
    inform "Written; the board restarts with it"
}

# answer_with REGEX: leaves the first line on the serial line that matches in ANSWER; false after
# five seconds without one. Must not run in a subshell: `read` takes more from a terminal than it
# returns.
ANSWER=''
answer_with() {
    while IFS= read -r -t 5 -u 8 ANSWER; do
        ANSWER=${ANSWER#> } # the prompt
        if [[ $ANSWER =~ $1 ]]; then return; fi
    done
    return 1
}

pyocd_knows_target() { "$1" list --targets 2>/dev/null | grep -qw "$2"; }

# flash_with PROBES COMMAND...: a missing debug probe, the most frequent mistake, is reported in one
# line.
flash_with() {
    local probes=$1 log=$LOG_DIR/flash.log
    shift
    if [[ -n $DRY_RUN ]]; then
        inform "Would flash with debug probe: $probes"
        printf '   '
        printf ' %q' "$@"
        printf '\n'
        return
    fi
    mkdir -p "$LOG_DIR"
    inform "Flashing with ${1##*/}, debug probe: $probes"
    if "$@" >"$log" 2>&1 </dev/null; then
        inform "Flashed and verified; the board has been reset"
        return
    fi
    if grep -qiE 'no .*debug probe|no j-link device|unable to find a matching|^error: open failed' \
        "$log"; then
        fail "flash: no debug probe found (looked for: $probes); is it plugged in, and may this" \
            "user open USB devices?"
    fi
    tail -n 20 "$log" | sed 's/^/    /' >&2
    fail "flash: failed; the details are in ${log#"$ROOT"/}"
}
