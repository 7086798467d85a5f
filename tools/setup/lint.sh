# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Formatting, and the static checks that the tests labelled "lint" are.

# tracked PATTERN...: files of a kind, new ones included, null-terminated. Generated ones stay as
# their generator wrote them.
tracked() {
    git -C "$ROOT" ls-files --cached --others --exclude-standard -z -- "$@" ':!:**/generated/**'
}

format_all() {
    (cd "$ROOT" &&
        tracked '*.c' '*.h' '*.cpp' '*.hpp' | xargs -0 -r "$VENV/bin/clang-format" -i &&
        tracked '*.py' | xargs -0 -r "$VENV/bin/ruff" format --quiet --config tools/setup/ruff.toml)
}

# Both run even when the first found something: one run shows the whole picture.
lint_all() {
    local status=0
    (cd "$ROOT" && ctest --preset host --label-regex lint --parallel "$(nproc)") || status=1
    (cd "$ROOT" && tracked tools/dev .ci/run 'tools/**.sh' | xargs -0 -r shellcheck -x) || status=1
    ((status == 0)) || fail "lint found something"
}
