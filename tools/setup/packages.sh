# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The tools that are system packages: which are missing, and their installation with apt.
#
# The machine is examined each time instead of keeping a stamp: this takes a few hundredths of a
# second and is right also after a package was removed.
#
# Names are those of Debian 12, Debian 13 and Ubuntu 24.04, which agree on all of them.

readonly CMAKE_MINIMUM=3.25
# shellcheck disable=SC2034  # read by tools/dev
readonly SYSTEM_GROUPS=(build host unit proofs arm qemu checks browser)
# What few commands need: installed by them, or by name.
# shellcheck disable=SC2034
readonly RARE_GROUPS=(mcdc)

# A group is what one kind of work needs; each prints the packages that are missing.
missing_build() {
    cmake_is_recent || echo cmake
    have ninja || echo ninja-build
}

missing_host() {
    have gcc || echo gcc
    # A C++ compiler's package depends on the C library's headers, a C compiler's only recommends
    # them.
    have g++ || echo g++
}

missing_python() { python_is_ready || echo python3 python3-venv; }

missing_unit() {
    have ruby || echo ruby
    header_is_there eigen3/Eigen/Core || echo libeigen3-dev
}

# The model checker itself is cbmc.sh's; the fuzzer comes with clang.
missing_proofs() {
    have clang || echo clang
    fuzzer_is_there || echo libclang-rt-dev
}

missing_arm() {
    have arm-none-eabi-gcc || echo gcc-arm-none-eabi
    newlib_is_there || echo libnewlib-arm-none-eabi
}

missing_qemu() { have qemu-system-arm || echo qemu-system-arm; }

missing_checks() {
    have clang-tidy || echo clang-tidy
    have shellcheck || echo shellcheck
}

# Conditions by name of this version: its export has them.
missing_mcdc() {
    have clang-19 || echo clang-19
    have llvm-cov-19 || echo llvm-19
    [[ "$(clang-19 -print-file-name="libclang_rt.profile-$(uname -m).a" 2>/dev/null)" == */* ||
        "$(clang-19 -print-file-name=libclang_rt.profile.a 2>/dev/null)" == */* ]] ||
        echo libclang-rt-19-dev
}

missing_openocd() { have openocd || echo openocd; }

cmake_is_recent() {
    have cmake &&
        version_at_least "$(cmake --version | awk 'NR == 1 { print $3 }')" "$CMAKE_MINIMUM"
}

# header_is_there PATH: where distributions put the headers of C++ libraries.
header_is_there() {
    local prefix
    for prefix in /usr /usr/local; do
        [[ -f $prefix/include/$1 ]] && return
    done
    return 1
}

# The compiler answers with a full path for a file that it finds, and with the bare name otherwise.
newlib_is_there() {
    have arm-none-eabi-gcc && [[ "$(arm-none-eabi-gcc -print-file-name=nano.specs)" == */* ]]
}

fuzzer_is_there() {
    local own plain
    have clang || return
    own=$(clang -print-file-name="libclang_rt.fuzzer-$(uname -m).a")
    plain=$(clang -print-file-name=libclang_rt.fuzzer.a)
    [[ $own$plain == */* ]]
}

missing_packages() {
    local group
    for group in "$@"; do "missing_$group"; done | xargs -r -n 1 | sort -u | xargs -r
}

system_name() {
    # A subshell, because the file defines plain names such as VERSION.
    (. /etc/os-release 2>/dev/null && echo "${PRETTY_NAME:-unknown system}") ||
        echo "unknown system"
}

# can_administer PACKAGE...: may we change this machine? Root may; others need sudo, which asks for
# a password only on a terminal, and names the packages.
can_administer() {
    ((EUID == 0)) && return
    have sudo || return 1
    sudo -n true 2>/dev/null && return
    [[ -t 0 && -t 2 ]] && sudo -v -p "Password of %u, to install $*: "
}

as_root() {
    if ((EUID == 0)); then "$@"; else sudo "$@"; fi
}

# Waits for another apt to end instead of failing, and asks no questions.
apt_get() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=600 \
        -o Acquire::Retries=3 "$@"
}

# A fresh image has none.
apt_has_lists() { [[ -n "$(apt-get indextargets 'Identifier: Packages' 2>/dev/null)" ]]; }

apt_knows() { apt-cache show --no-all-versions "$1" >/dev/null 2>&1; }

# A fresh image has no package lists, an old one has lists that name files which no longer exist: in
# both cases update once. Lists that work are left alone, which saves the slowest step.
apt_install() {
    local package
    for package in "$@"; do
        apt_knows "$package" && continue
        run_logged "Updating the package lists" apt-update apt_get update || return
        # Without a network apt-get calls an update a success all the same.
        if ! apt_knows "$package" && reports_no_network "$LOG_DIR/apt-update.log"; then
            fail_without_network "Updating the package lists" "$LOG_DIR/apt-update.log"
        fi
        break
    done
    run_logged "Installing with apt-get" apt-install apt_get install --no-install-recommends "$@" &&
        return
    inform "Trying once more with new package lists"
    run_logged "Updating the package lists" apt-update apt_get update &&
        run_logged "Installing with apt-get" apt-install apt_get install --no-install-recommends \
            "$@"
}

# ensure_packages GROUP...
ensure_packages() {
    local missing left
    missing=$(missing_packages "$@")
    [[ -z $missing ]] && return
    have apt-get ||
        fail "missing (names of the Debian packages): $missing; install them by the means of" \
            "$(system_name) and run again"
    # shellcheck disable=SC2086  # a list of package names, one word each
    can_administer $missing ||
        fail "neither root nor sudo here; let an administrator run: apt-get update && apt-get" \
            "install -y --no-install-recommends $missing"
    inform "This machine ($(system_name)) lacks: $missing"
    # shellcheck disable=SC2086  # a list of package names, one word each
    apt_install $missing ||
        fail "apt-get could not install: $missing (on Ubuntu they are in the components main and" \
            "universe)"
    hash -r
    left=$(missing_packages "$@")
    [[ -z $left ]] ||
        fail "still missing after installation: $left$(explain_shadowed_cmake "$left")"
}

# An old cmake earlier on PATH hides the one just installed.
explain_shadowed_cmake() {
    [[ " $1 " == *" cmake "* ]] && have cmake &&
        printf ' (PATH finds %s first, which is older than %s)' "$(command -v cmake)" \
            "$CMAKE_MINIMUM"
    return 0
}
