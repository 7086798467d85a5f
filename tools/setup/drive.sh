# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# How commands name a drive: by its TOML file, or by the name of one in tools/motors.

drive_names() {
    local file
    for file in "$ROOT"/tools/motors/*.toml "$ROOT"/tools/motors/*/*.toml; do
        [[ ! -f $file ]] || basename "$file" .toml
    done
}

# find_drive COMMAND DRIVE: leaves its file in DRIVE_FILE, or refuses what is none.
DRIVE_FILE=''
# shellcheck disable=SC2034  # read by tools/dev
find_drive() {
    local known
    [[ ! -d $2 ]] || usage_fail "$1: $2: is a directory; a drive is a TOML file or a name"
    DRIVE_FILE=$2
    [[ ! -f $2 ]] || return 0
    [[ $2 != */* && $2 != *.toml ]] || usage_fail "$1: $2: no such file"
    for known in "$ROOT"/tools/motors/"$2".toml "$ROOT"/tools/motors/*/"$2".toml; do
        DRIVE_FILE=$known
        [[ ! -f $known ]] || return 0
    done
    # shellcheck disable=SC2046  # names are words
    check_known "$1: no drive" "$2" $(drive_names)
}

# find_table COMMAND DRIVE: leaves in DRIVE_NAME the name of the drive whose table the firmware is
# built with.
DRIVE_NAME=''
# shellcheck disable=SC2034  # read by tools/dev
find_table() {
    local tables=firmware/config/generated
    DRIVE_NAME=$(basename "$2" .toml)
    [[ ! -f $ROOT/$tables/$DRIVE_NAME.c || ($2 == *.toml && ! -f $2) ]] || return 0
    find_drive "$1" "$2"
    usage_fail "$1: no $tables/$DRIVE_NAME.c; 'tools/dev table $2' makes it"
}

# make_table COMMAND DRIVE [--set KEY=VALUE]...: makes the table of a drive with other values and
# leaves its name in DRIVE_NAME.
make_table() {
    local written
    find_drive "$1" "$2"
    ensure host sim
    written=$("$VENV_PYTHON" -m regen_table generate "$DRIVE_FILE" "${@:3}") || exit
    DRIVE_NAME=$(basename "${written##*$'\n'}" .bin)
    DRIVE_NAME=${DRIVE_NAME%.c}
}
