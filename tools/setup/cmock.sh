# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# CMock, which carries Unity: test runner and mock generators of the unit tests.
#
# Debian 13 and Ubuntu 24.04 have the package. Debian 12 has not, but the one package of the next
# suite is architecture-independent and needs only Ruby, so it is unpacked into .dev/cmock
# (next_suite.sh).

readonly CMOCK_PREFIX="$ROOT/.dev/cmock"

cmock_is_there() {
    local directory
    for directory in /usr/share/cmock "$CMOCK_PREFIX/usr/share/cmock"; do
        [[ -f $directory/lib/cmock.rb && -f $directory/vendor/unity/src/unity.c ]] && return
    done
    return 1
}

ensure_cmock() {
    cmock_is_there && return
    have apt-get ||
        fail "CMock is missing; put a copy of it (with vendor/unity) where" \
            "$CMOCK_PREFIX/usr/share/cmock/lib/cmock.rb is its generator"
    update_lists_for cmock
    if apt_knows cmock && can_administer cmock; then
        inform "This machine ($(system_name)) lacks: cmock"
        apt_install cmock || fail "apt-get could not install cmock"
    else
        inform "This machine ($(system_name)) lacks: cmock; it goes into .dev/cmock, outside the" \
            "system's packages"
        run_logged "Fetching cmock" cmock unpack_privately "$CMOCK_PREFIX" cmock ||
            fail "cmock could not be fetched (on Ubuntu it is in the component universe)"
    fi
    cmock_is_there ||
        fail "cmock was installed but its generator is not where it should be (.dev/cmock or" \
            "/usr/share/cmock)"
}
