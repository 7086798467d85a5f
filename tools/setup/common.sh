# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Messages, and commands with long output. Sourced by tools/dev, which sets ROOT. All messages go to
# stderr: stdout belongs to the command that was asked for, so that `tools/dev python -m regen_table
# solve ... --json` can be piped even on the run that installs things.

readonly LOG_DIR="$ROOT/.dev/log"
readonly EXIT_USAGE=2

inform() { printf '%s\n' "$*" >&2; }

fail() {
    printf 'tools/dev: %s\n' "$*" >&2
    exit 1
}

# For mistakes in the command line: unknown words, files that do not exist.
usage_fail() {
    printf 'tools/dev: %s\n' "$*" >&2
    exit "$EXIT_USAGE"
}

# edit_distance A B: how many letters are added, left out or changed between two words.
edit_distance() {
    local a=$1 b=$2 i j changed above row=()
    for ((j = 0; j <= ${#b}; j++)); do row[j]=$j; done
    for ((i = 1; i <= ${#a}; i++)); do
        changed=${row[0]} row[0]=$i
        for ((j = 1; j <= ${#b}; j++)); do
            above=${row[j]}
            [[ ${a:i-1:1} == "${b:j-1:1}" ]] || changed=$((changed + 1))
            row[j]=$changed
            ((above + 1 >= row[j])) || row[j]=$((above + 1))
            ((row[j - 1] + 1 >= row[j])) || row[j]=$((row[j - 1] + 1))
            changed=$above
        done
    done
    printf '%d' "${row[${#b}]}"
}

# suggestion WORD KNOWN...: the known word that was meant, or all of them where none is near.
suggestion() {
    local word=$1 known nearest='' distance least
    shift
    least=$((${#word} / 2 + 1))
    for known in "$@"; do
        distance=$(edit_distance "$word" "$known")
        if ((distance < least)); then nearest=$known least=$distance; fi
    done
    if [[ -n $nearest ]]; then
        printf 'did you mean %s?' "$nearest"
    else
        printf 'there are: %s' "$*"
    fi
}

# check_known WHAT WORD KNOWN...: refuses another word; WHAT is its place, as in "flash: no probe".
check_known() {
    contains "$2" "${@:3}" || usage_fail "$1 '$2', $(suggestion "${@:2}")"
}

contains() {
    local wanted=$1 word
    shift
    for word in "$@"; do [[ $word == "$wanted" ]] && return; done
    return 1
}

# Ctrl-C ends tools/dev also where the running program handles it and ends normally, as ctest does.
trap 'exit 130' INT
trap 'exit 143' TERM

have() { command -v "$1" >/dev/null 2>&1; }

# version_at_least HAVE WANT: dotted numbers.
version_at_least() {
    [[ "$(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1)" == "$2" ]]
}

# Prints how long the step has run and the last line of its log, once a second on a terminal, after
# 2, 4, 8 s and so on in a log file. Ends by itself when tools/dev does, whatever ended it. `read
# -t` is the pause because, unlike `sleep`, it leaves no child behind that keeps a pipe open.
report_progress() {
    local label=$1 log=$2 parent=$3 begin=$SECONDS period=2 line
    [[ -t 2 ]] && period=1
    while read -rt "$period" _ <> <(:) || kill -0 "$parent" 2>/dev/null; do
        line=$(tail -n 1 "$log" 2>/dev/null | tr -d '\000-\037' | cut -c 1-70) || line=
        if [[ -t 2 ]]; then
            printf '\r\033[K%s: %d s  %s' "$label" "$((SECONDS - begin))" "$line" >&2
        else
            printf '%s: %d s  %s\n' "$label" "$((SECONDS - begin))" "$line" >&2
            ((period >= 32)) || period=$((2 * period))
        fi
    done
}

# The messages of apt, pip and git when there is no network, as opposed to a file that no longer
# exists.
reports_no_network() {
    grep -qE -e 'Could not (resolve|connect)|Temporary failure (resolving|in name resolution)' \
        -e 'Name or service not known|Unable to connect|Connection (timed out|refused)' \
        -e 'Network is unreachable|NewConnectionError|NameResolutionError' "$1"
}

fail_without_network() {
    fail "$1: the package archive cannot be reached; is there a network?" \
        "(${2#"$ROOT"/} has the details)"
}

# run_logged LABEL LOGNAME COMMAND...: the output goes to a log; its last lines are shown only if
# the command fails. Where the cause is a missing network, one line is shown instead. The command
# stays in the foreground and the reporter goes to the background, because bash makes background
# commands ignore Ctrl-C, and the command has to receive it.
run_logged() {
    local label=$1 log=$LOG_DIR/$2.log begin=$SECONDS status=0 reporter
    shift 2
    mkdir -p "$LOG_DIR"
    : >"$log"
    report_progress "$label" "$log" "$$" &
    reporter=$!
    # shellcheck disable=SC2064  # the number is meant to be put in now
    trap "kill $reporter 2>/dev/null; exit 130" INT
    # 9 is the set-up lock, which a service that apt starts must not keep.
    "$@" >"$log" 2>&1 </dev/null 9>&- || status=$?
    kill "$reporter" 2>/dev/null || true
    wait "$reporter" 2>/dev/null || true
    trap 'exit 130' INT
    [[ -t 2 ]] && printf '\r\033[K' >&2
    if ((status != 0)) && reports_no_network "$log"; then fail_without_network "$label" "$log"; fi
    if ((status != 0)); then
        inform "$label: failed after $((SECONDS - begin)) s; the end of ${log#"$ROOT"/}:"
        tail -n 20 "$log" | cut -c 1-200 | sed 's/^/    /' >&2
        return "$status"
    fi
    # No message if there was nothing to do, which the program reports by this last line.
    [[ -n ${LAST_LINE_IF_IDLE:-} && $(tail -n 1 "$log") == "$LAST_LINE_IF_IDLE" ]] ||
        inform "$label: done in $((SECONDS - begin)) s"
}
