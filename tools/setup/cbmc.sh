# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# CBMC, the bounded model checker of tests/proofs.
#
# Debian 13 and Ubuntu 24.04 have it. Debian 12 has not, and the next suite's program wants that
# suite's C library, which must never come near the system's own. So program and libraries are
# unpacked together into .dev/cbmc, and a wrapper starts the program with the loader that lies
# beside it.

readonly CBMC_PREFIX="$ROOT/.dev/cbmc"

cbmc_is_there() { have cbmc || [[ -x $CBMC_PREFIX/cbmc ]]; }

# The wrapper finds its folder by itself: a moved repository keeps a working checker.
write_cbmc_wrapper() {
    cat >"$CBMC_PREFIX/cbmc" <<'WRAPPER' || return
#!/bin/bash
here=$(cd -P "$(dirname "$(readlink -f "$0")")" && pwd)
for loader in "$here"/usr/lib/*-linux-gnu*/ld-linux*.so.*; do
    libraries=${loader%/*}
    exec "$loader" --library-path "$libraries:$here/usr/lib" "$here/usr/bin/cbmc" "$@"
done
echo "no loader in $here/usr/lib" >&2
exit 1
WRAPPER
    chmod +x "$CBMC_PREFIX/cbmc"
}

install_cbmc_privately() {
    unpack_privately "$CBMC_PREFIX" cbmc minisat libc6 libstdc++6 libgcc-s1 zlib1g &&
        write_cbmc_wrapper && "$CBMC_PREFIX/cbmc" --version
}

ensure_cbmc() {
    cbmc_is_there && return
    have apt-get || fail "CBMC is missing; install it so that 'cbmc' is on PATH and run again"
    update_lists_for cbmc
    if apt_knows cbmc && can_administer cbmc; then
        inform "This machine ($(system_name)) lacks: cbmc"
        apt_install cbmc || fail "apt-get could not install cbmc"
    else
        inform "This machine ($(system_name)) lacks: cbmc; it goes into .dev/cbmc, outside the" \
            "system's packages"
        run_logged "Fetching cbmc" cbmc install_cbmc_privately ||
            fail "cbmc could not be fetched (on Ubuntu it is in the component universe)"
    fi
    cbmc_is_there || fail "cbmc was installed but is neither on PATH nor in .dev/cbmc"
}
