# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The private Python environment, .dev/venv: pinned packages, and the project's own ones through a .pth file.

readonly VENV="$ROOT/.dev/venv"
readonly VENV_PYTHON="$VENV/bin/python"
readonly REQUIREMENTS="$ROOT/tools/requirements.txt"

# Good enough means: at least 3.11 (tomllib), and able to make an environment with pip in it. Debian's python3
# without python3-venv cannot, and says so only when it has half made one.
python_is_good() {
    "$1" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1
}

# The system's own interpreter first: it outlives version managers that happen to be first on PATH today.
find_python() {
    local candidate
    for candidate in /usr/bin/python3 python3 python3.13 python3.12 python3.11; do
        have "$candidate" && python_is_good "$candidate" && command -v "$candidate" && return
    done
    return 1
}

# Asked of the environment itself, not of a stamp: it must start, hold every pinned version, and know this place as
# the project's (the scripts in an environment, and the .pth file, contain its path).
venv_is_ready() {
    [[ -x $VENV_PYTHON ]] && "$VENV_PYTHON" -I "$ROOT/tools/setup/check_venv.py" "$ROOT" "$REQUIREMENTS" >/dev/null 2>&1
}

python_is_ready() { venv_is_ready || find_python >/dev/null; }

# The .pth file comes last: an environment has one when it is one, and a run cut short here starts again.
make_venv() {
    local site
    "$1" -m venv --clear "$VENV" &&
        site=$("$VENV_PYTHON" -c 'import sysconfig; print(sysconfig.get_path("purelib"))') &&
        printf '%s\n' "$ROOT/tools" "$ROOT/host_sim/python" >"$site/hubfoc.pth"
}

# Only ready-made packages are taken (no compiler on the way); the index is the one that this machine's pip is set up for.
fill_venv() {
    "$VENV_PYTHON" -m pip install --disable-pip-version-check --no-input --progress-bar off --only-binary=:all: \
        -r "$REQUIREMENTS"
}

venv_belongs_here() {
    [[ -x $VENV_PYTHON ]] && "$VENV_PYTHON" -I "$ROOT/tools/setup/check_venv.py" --place "$ROOT" >/dev/null 2>&1
}

# The ones the project itself uses; the file lists theirs after them.
direct_requirements() { sed '/^# Needed by/,$d; /^#/d; s/==.*//' "$REQUIREMENTS" | xargs; }

ensure_venv() {
    venv_is_ready && return
    local python
    # An environment of this place that only misses some packages is completed; anything else is made anew.
    if ! venv_belongs_here; then
        python=$(find_python) || fail "no Python 3.11 or newer that can make an environment (venv, ensurepip) was found"
        run_logged "Making the Python environment .dev/venv ($("$python" -V))" venv make_venv "$python" ||
            fail "the Python environment could not be made"
    fi
    say "Python packages into .dev/venv: $(direct_requirements) and what these need, pinned in tools/requirements.txt"
    run_logged "Installing the Python packages" pip fill_venv || fail "the Python packages could not be installed"
    venv_is_ready || fail "the Python environment is not as it should be: $("$VENV_PYTHON" -I "$ROOT/tools/setup/check_venv.py" "$ROOT" "$REQUIREMENTS" 2>&1 | head -n 1)"
}
