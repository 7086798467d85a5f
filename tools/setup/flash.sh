# shellcheck shell=bash
# Writing a firmware image through a debug probe. OpenOCD is taken where there is a choice, because it knows the whole
# STM32F4 family by itself; pyOCD, if it is asked for, fetches a device pack for this part on first use.

readonly PYOCD_VERSION=0.46.0
readonly PYOCD_TARGET=stm32f405rg

# flash_openocd all|config IMAGE PROBE, where IMAGE is the path of the ELF without its ending
flash_openocd() {
    local what=$1 image=$2 probe=$3 file=$2.elf address=''
    if [[ $what == config ]]; then
        file=${image}_config.bin
        address=$(config_address "$image.elf")
    fi
    ensure_packages openocd
    flash_with "$probe" openocd -f "interface/$probe.cfg" -f target/stm32f4x.cfg \
        -c "program {$file} $address verify reset exit"
}

# flash_pyocd all|config IMAGE
flash_pyocd() {
    local what=$1 image=$2 pyocd=$VENV/bin/pyocd arguments=("$2.hex")
    if [[ $what == config ]]; then arguments=(--base-address "$(config_address "$image.elf")" "${image}_config.bin"); fi
    ensure python
    if [[ ! -x $pyocd ]]; then
        # The pins stay what they are: pyOCD may bring packages of its own but not move one of the project's.
        run_logged "Installing pyOCD into .dev/venv" pyocd "$VENV_PYTHON" -m pip install --disable-pip-version-check --no-input \
            --progress-bar off --constraint "$REQUIREMENTS" "pyocd==$PYOCD_VERSION" || fail "pyOCD could not be installed"
    fi
    # pyOCD calls an installation that found nothing a success, so its list of targets is what counts.
    if ! pyocd_knows_target "$pyocd"; then
        run_logged "Fetching pyOCD's device pack for $PYOCD_TARGET" pyocd-pack "$pyocd" pack install "$PYOCD_TARGET" || true
        pyocd_knows_target "$pyocd" || fail "flash: pyOCD could not fetch its pack for $PYOCD_TARGET; OpenOCD needs none: tools/dev flash --with openocd"
    fi
    flash_with "any that pyOCD knows" "$pyocd" flash --target "$PYOCD_TARGET" --no-wait "${arguments[@]}"
}

# Where the configuration lies in flash. The linker decided that; asking its product keeps the address in one place.
config_address() {
    local address
    address=$(arm-none-eabi-objdump -h "$1" | awk '$2 == ".hubfoc_config" { print "0x" $5 }')
    [[ -n $address ]] || fail "flash: no section .hubfoc_config in ${1#"$ROOT"/}"
    printf '%s\n' "$address"
}

pyocd_knows_target() { "$1" list --targets 2>/dev/null | grep -qw "$PYOCD_TARGET"; }

# flash_with PROBES COMMAND...: what goes wrong most often, nothing plugged in, gets a line of its own.
flash_with() {
    local probes=$1 log=$LOG_DIR/flash.log
    shift
    mkdir -p "$LOG_DIR"
    say "Flashing with ${1##*/}, debug probe: $probes"
    if "$@" >"$log" 2>&1 </dev/null; then
        say "Flashed and verified; the board has been reset"
        return
    fi
    if grep -qiE 'no .*debug probe|no j-link device|unable to find a matching|^error: open failed' "$log"; then
        fail "flash: no debug probe found (looked for: $probes); is it plugged in, and may this user open USB devices?"
    fi
    tail -n 20 "$log" | sed 's/^/    /' >&2
    fail "flash: failed; the whole story is in ${log#"$ROOT"/}"
}
