# Functions about Debian and Ubuntu packages, for scripts that source this file.

# Succeeds if one of the named packages is installed, even if its triggers are still pending.
is_installed() {
    { dpkg-query -W -f '${db:Status-Status}\n' "$@" 2>/dev/null || true; } |
        grep -qxE 'installed|triggers-pending|triggers-awaited'
}

# Prints the version of Python in this system's packages, such as 3.10.6-1~22.04, or nothing.
packaged_python() {
    { LC_ALL=C apt-cache policy python3 2>/dev/null || true; } | sed -n 's/^  Candidate: \([0-9]\)/\1/p'
}
