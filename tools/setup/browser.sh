# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A Chromium without a window, for the tests that display the report and the live page.
#
# Debian has it as a package of its own. Ubuntu 24.04 has not: its chromium-browser only fetches a
# snap, which containers cannot run and which sees no temporary directory. There the test fails and
# names what it needs.

readonly BROWSER_PACKAGE=chromium-headless-shell

browser_is_there() { have "$BROWSER_PACKAGE" || have chromium || have google-chrome; }

# Not every system has the package, so a browser that is missing is no reason to stop; where the
# system has it, it is installed with the others.
missing_browser() { browser_is_there || ! apt_knows "$BROWSER_PACKAGE" || echo "$BROWSER_PACKAGE"; }

ensure_browser() {
    browser_is_there && return
    if have apt-get && ! apt_knows "$BROWSER_PACKAGE" && ! apt_has_lists &&
        can_administer "$BROWSER_PACKAGE"; then
        run_logged "Updating the package lists" apt-update apt_get update ||
            fail "apt-get update failed"
    fi
    if ! have apt-get || ! apt_knows "$BROWSER_PACKAGE"; then
        inform "$(system_name) has no package $BROWSER_PACKAGE: the tests report_in_browser and" \
            "live_in_browser will fail until 'chromium' or 'google-chrome' is on PATH"
        return
    fi
    can_administer "$BROWSER_PACKAGE" ||
        fail "neither root nor sudo here; let an administrator run: apt-get update && apt-get" \
            "install -y --no-install-recommends $BROWSER_PACKAGE"
    inform "This machine ($(system_name)) lacks: $BROWSER_PACKAGE"
    apt_install "$BROWSER_PACKAGE" || fail "apt-get could not install $BROWSER_PACKAGE"
    hash -r
    browser_is_there || fail "$BROWSER_PACKAGE was installed but is not on PATH"
}
