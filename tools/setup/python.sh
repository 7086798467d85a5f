# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The private Python environment .dev/venv: pinned packages, and the project's own ones through a
# .pth file.
#
# Packages come in sets, so that the simulator does not bring what only the tests use. Each set is a
# list of packages, requirements/NAME.in, and its lock file NAME.txt with versions and hashes.

readonly VENV="$ROOT/.dev/venv"
readonly VENV_PYTHON="$VENV/bin/python"
readonly REQUIREMENTS="$ROOT/tools/setup/requirements"
# shellcheck disable=SC2034  # read by tools/dev
readonly PYTHON_SETS=(sim figures formats sweep live fmi examples bench test dev)
# Not among all sets: 411 MB that one option of two commands needs.
# shellcheck disable=SC2034
readonly RARE_SETS=(zig)

# find_interpreter [MODULE...]: a Python of at least 3.11 (tomllib) that has these modules. The
# system's own first: version managers change which one is first on PATH.
find_interpreter() {
    local candidate modules
    modules=$(printf ', %s' sys "$@")
    for candidate in /usr/bin/python3 python3 python3.13 python3.12 python3.11; do
        have "$candidate" && "$candidate" -c "import ${modules#, }
sys.exit(sys.version_info < (3, 11))" >/dev/null 2>&1 && command -v "$candidate" && return
    done
    return 1
}

# Able to make an environment with pip in it. Debian's python3 without python3-venv cannot, and
# fails only after it has made half of one.
find_python() { find_interpreter venv ensurepip; }

# check_venv [--place] [SET...]: asked of the environment itself: it must start, contain every
# pinned version of the sets, and have been made for this directory (its scripts and the .pth file
# contain the path).
check_venv() {
    local option=() set files=()
    if [[ ${1:-} == --place ]]; then
        option=(--place)
        shift
    fi
    for set in "$@"; do files+=("$REQUIREMENTS/$set.txt"); done
    [[ -x $VENV_PYTHON ]] &&
        "$VENV_PYTHON" -I "$ROOT/tools/setup/check_venv.py" "${option[@]}" "$ROOT" "${files[@]}"
}

venv_is_ready() { check_venv "$@" >/dev/null 2>&1; }
venv_belongs_here() { check_venv --place >/dev/null 2>&1; }
python_is_ready() { venv_belongs_here || find_python >/dev/null; }

# Where the project's own packages are.
readonly PACKAGE_FOLDERS=("$ROOT/tools" "$ROOT/host_sim/python" "$ROOT/host_sim")

# And, for a test run, what a test's Python programs read (tools/run_tests).
pth_text() {
    printf '%s\n' "${PACKAGE_FOLDERS[@]}" \
        'import os; "HUBFOC_OPENED" in os.environ and __import__("run_tests.opened")'
}

# The .pth file is written last, so an environment without it is incomplete and is made again.
make_venv() { "$1" -m venv --clear "$VENV" && write_pth; }

write_pth() {
    local site
    for site in "$VENV"/lib/python*/site-packages; do
        [[ -d $site ]] || continue
        pth_text | cmp -s - "$site/hubfoc.pth" || pth_text >"$site/hubfoc.pth" || return
    done
}

# fill_venv SET...: only wheels whose hash is in the lock file; the index is the one that this
# machine's pip uses. Compiled on all cores, and without the packages' own tests, of which pip would
# make a third of what it compiles on one.
fill_venv() {
    local set site options=()
    for set in "$@"; do options+=(-r "$REQUIREMENTS/$set.txt"); done
    "$VENV_PYTHON" -m pip install --disable-pip-version-check --no-input --progress-bar off \
        --only-binary=:all: --no-compile \
        --no-deps --require-hashes "${options[@]}" || return
    for site in "$VENV"/lib/python*/site-packages; do
        "$VENV_PYTHON" -m compileall -q -j 0 -x '/tests/' "$site" >/dev/null || true
    done
}

# direct_requirements SET...: the packages that the project itself uses.
direct_requirements() {
    local set
    for set in "$@"; do sed '/^#/d; s/==.*//' "$REQUIREMENTS/$set.in"; done | xargs
}

# ensure_venv SET...
ensure_venv() {
    if venv_is_ready "$@"; then
        write_pth
        return
    fi
    local python
    # An environment of this directory that lacks some packages is completed; any other is made
    # anew.
    if venv_belongs_here; then
        write_pth
    else
        python=$(find_python) ||
            fail "no Python 3.11 or newer that can make an environment (venv, ensurepip) was found"
        run_logged "Making the Python environment .dev/venv ($("$python" -V))" venv make_venv \
            "$python" ||
            fail "the Python environment could not be made"
    fi
    inform "Python packages into .dev/venv: $(direct_requirements "$@") and their dependencies," \
        "pinned in tools/setup/requirements"
    run_logged "Installing the Python packages" pip fill_venv "$@" ||
        fail "the Python packages could not be installed"
    venv_is_ready "$@" ||
        fail "the Python environment is incomplete: $(check_venv "$@" 2>&1 | head -n 1)"
}

# The vendor's description of the chip, with which a test compares the register headers: data in a
# wheel, not installed.
ensure_svd() {
    compgen -G "$ROOT/.dev/svd/pyocd-*.whl" >/dev/null && return
    run_logged "Fetching the vendor's description of the chip" svd \
        "$VENV_PYTHON" -m pip download --disable-pip-version-check --no-input --no-deps \
            --require-hashes \
        -r "$ROOT/tests/unit/hal/requirements-svd.txt" -d "$ROOT/.dev/svd" ||
        fail "the description of the chip could not be fetched"
}
