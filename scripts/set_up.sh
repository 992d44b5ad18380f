#!/usr/bin/env bash
# Creates .venv from requirements.lock, unless .venv is up to date.
# If root runs this script on Debian, it installs missing system packages; otherwise it prints their names.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh

venv=.venv
stamp=$venv/lock.sha256
wanted=$(cat requirements.lock pyproject.toml | sha256sum)

if [ -x $venv/bin/python ] && [ "$(cat $stamp 2>/dev/null)" = "$wanted" ]; then
    exit 0
fi

# Prints the path of the first Python of version 3.11 or later that can create environments. If PYTHON is set, only this
# Python is tried. Otherwise the Python of uv is tried last.
find_python() {
    local candidate
    for candidate in ${PYTHON:-python3.11 python3 python3.12 python3.13 "${HOME:-}/.local/bin/python3.11"}; do
        if "$candidate" -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            command -v "$candidate"
            return
        fi
    done
    return 1
}

if ! python=$(find_python); then
    packages="python3 python3-venv"
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        apt-get update -q
    fi
    packaged=$(packaged_python)
    if [ -z "$packaged" ] || dpkg --compare-versions "$packaged" lt 3.11; then
        # On Ubuntu 22.04, for example, the packages have only an older Python.
        cat >&2 <<END
Set-up needs Python 3.11 or later with its venv module. This system's packages have ${packaged:-none}. Run one of these commands, then set-up again:
  as any user, with uv:  python3 -m pip install --user uv && ~/.local/bin/uv python install 3.11    (pip is in the package python3-pip)
  on Ubuntu:             sudo apt-get install software-properties-common && sudo add-apt-repository ppa:deadsnakes/ppa && sudo apt-get install python3.11 python3.11-venv
If your Python is not in PATH: make setup PYTHON=/path/to/python3.11
END
        exit 1
    fi
    echo "Set-up needs Python 3.11 or later with its venv module: the packages $packages." >&2
    if [ "$(id -u)" != 0 ]; then
        echo "Install them with: sudo apt-get install $packages" >&2
        exit 1
    fi
    echo "Installing these packages with apt-get." >&2
    DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $packages
    if ! python=$(find_python); then
        echo "No suitable Python was found. Write its path: make setup PYTHON=/path/to/python3.11" >&2
        exit 1
    fi
fi

# System packages for Qt's windows and for their typeface. Without them, everything except the windows works.
missing_for_windows() {
    local package
    for package in libgl1 libegl1 libxkbcommon0 libdbus-1-3 libfontconfig1 libxkbcommon-x11-0 libxcb-cursor0 \
        libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 fonts-inter; do
        is_installed "$package" || echo "$package"
    done
    # In Debian 13, the package has the second name.
    is_installed libglib2.0-0 libglib2.0-0t64 || echo libglib2.0-0
}

if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
    packages=$(missing_for_windows | tr '\n' ' ')
    if [ -n "$packages" ] && [ "$(id -u)" = 0 ]; then
        echo "Installing for the windows: $packages"
        # shellcheck disable=SC2086 # one word per package
        if ! apt-get update -q >/dev/null ||
            ! DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $packages >/dev/null; then
            echo "Some of these packages could not be installed, so windows may not open. Everything else works." >&2
        fi
    elif [ -n "$packages" ]; then
        echo "Windows need some system packages: sudo apt-get install $packages" >&2
    fi
fi

if ! $venv/bin/python -c '' 2>/dev/null; then
    echo "Creating $venv with $python"
    "$python" -m venv --clear $venv
fi
echo "Installing the packages in requirements.lock; the first time, this takes a minute"
$venv/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
$venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
echo "$wanted" >$stamp
