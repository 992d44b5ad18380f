# Functions about packages of Debian and Ubuntu, for the scripts that source this file.

# True if one of the packages named is installed; a package whose triggers are still to run is.
is_installed() {
    { dpkg-query -W -f '${db:Status-Status}\n' "$@" 2>/dev/null || true; } |
        grep -qxE 'installed|triggers-pending|triggers-awaited'
}

# Version of Python in the packages of this system, such as 3.10.6-1~22.04; empty if there is none.
packaged_python() {
    { LC_ALL=C apt-cache policy python3 2>/dev/null || true; } | sed -n 's/^  Candidate: \([0-9]\)/\1/p'
}
