# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Packages that this Debian does not have yet but the next one has, without touching the system.
#
# They are fetched through a package list of their own, which is thrown away, and unpacked into a
# private folder: the system's sources, lists, pins and packages stay exactly as they were, the
# archive's signature is checked all the same, and no administrator is needed.

readonly DEBIAN_NEXT_SUITE=trixie

# The address and the signing keys of the Debian archive that this machine itself is set up to use.
# apt is asked, so it does not matter whether the source is written in the one-line or in the deb822
# way.
debian_archive() {
    # shellcheck disable=SC2016  # the dollars are apt's
    apt-get indextargets --format '$(REPO_URI) $(ORIGIN) $(COMPONENT) $(CODENAME)' \
        'Identifier: Packages' 2>/dev/null |
        awk '$2 == "Debian" && $3 == "main" && $4 !~ /-/ { print $1; exit }'
}

# fetch_from_next_suite ARCHIVE SCRATCH PACKAGE...: the packages, and only they, end up in
# SCRATCH/out.
fetch_from_next_suite() {
    local archive=$1 scratch=$2 keyring=/usr/share/keyrings/debian-archive-keyring.gpg options=
    shift 2
    [[ -f $keyring ]] && options="[signed-by=$keyring] "
    mkdir -p "$scratch"/{lists/partial,cache/archives/partial,parts,out} || return
    echo "deb $options$archive $DEBIAN_NEXT_SUITE main" >"$scratch/parts/next.list" || return
    local apt=(apt-get -q -o Acquire::Retries=3 -o Acquire::Languages=none
        -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$scratch/parts"
        -o "Dir::State::Lists=$scratch/lists" -o "Dir::Cache=$scratch/cache"
        -o APT::Sandbox::User="$(id -un)"
        -o Acquire::IndexTargets::deb::DEP-11::DefaultEnabled=false)
    "${apt[@]}" update && (cd "$scratch/out" && "${apt[@]}" download "$@")
}

# The same from the suite this machine has, for users without the right to install.
fetch_from_own_suite() {
    local scratch=$1
    shift
    (mkdir -p "$scratch/out" && cd "$scratch/out" && apt-get -q -o Acquire::Retries=3 download "$@")
}

# unpack_packages SCRATCH PREFIX: beside the final place first, moved there when complete, so that
# an interrupted run leaves no incomplete folder.
unpack_packages() {
    local scratch=$1 prefix=$2 package
    rm -rf "$prefix.new" && mkdir -p "$prefix.new" || return
    for package in "$scratch"/out/*.deb; do
        dpkg -x "$package" "$prefix.new" || return
    done
    rm -rf "$prefix" && mv "$prefix.new" "$prefix"
}

# unpack_privately PREFIX PACKAGE [PACKAGE IT NEEDS]...: from this suite if it knows the first one,
# else from the next.
unpack_privately() {
    local prefix=$1 scratch archive status=0
    shift
    scratch=$(mktemp -d) || return
    if apt_knows "$1"; then
        fetch_from_own_suite "$scratch" "$@" || status=$?
    else
        archive=$(debian_archive)
        if [[ -n $archive ]]; then
            fetch_from_next_suite "$archive" "$scratch" "$@" || status=$?
        else
            echo "no Debian archive among apt's sources; 'apt-get update' may never have run here"
            status=1
        fi
    fi
    ((status == 0)) && { unpack_packages "$scratch" "$prefix" || status=$?; }
    rm -rf "$scratch"
    return "$status"
}

# Without lists the question "does this release have it?" has no answer yet.
update_lists_for() {
    if ! apt_knows "$1" && [[ -z "$(debian_archive)" ]] && can_administer "$1"; then
        run_logged "Updating the package lists" apt-update apt_get update ||
            fail "apt-get update failed"
    fi
}
