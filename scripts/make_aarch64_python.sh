#!/usr/bin/env bash
# Creates FOLDER/python, a 64-bit ARM interpreter that runs on this machine by emulation, with the locked packages that thbridge
# needs. Debian packages and PyPI wheels are unpacked into the folder; nothing is installed. Use it with
#   THBRIDGE_PYTHONS=FOLDER/python .venv/bin/pytest -m slow tests/system/test_portability.py
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(realpath -m "${1:?Write the name of a folder; it needs about 2 GB}")
pip=$PWD/.venv/bin/python
if ! "$pip" -m pip --version >/dev/null 2>&1; then
    pip=$folder/pip/bin/python
    [ -x "$pip" ] || python3 -m venv "$folder/pip"
fi
mkdir -p "$folder"/{state/lists/partial,cache/archives/partial,debs,root,emulator,wheels,site}
touch "$folder/state/status"

# Apt's state on this machine does not include another architecture, so apt uses a separate state here.
foreign=(-qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$folder/state"
    -o Dir::State::status="$folder/state/status" -o Dir::Cache="$folder/cache" -o APT::Sandbox::User=root)
apt-get "${foreign[@]}" update
(cd "$folder/debs" && apt-get "${foreign[@]}" download python3.11 python3.11-minimal libpython3.11-minimal \
    libpython3.11-stdlib libc6 libexpat1 zlib1g libssl3 libffi8 libbz2-1.0 liblzma5 libsqlite3-0 libuuid1 libncursesw6 \
    libtinfo6 libreadline8 libgcc-s1 libstdc++6 libdb5.3 libcrypt1 libgomp1 libnsl2 libtirpc3 media-types)
(cd "$folder/emulator" && apt-get -qq -o APT::Sandbox::User=root download qemu-user libcapstone4 liburing2)
for package in "$folder"/debs/*.deb; do dpkg -x "$package" "$folder/root"; done
for package in "$folder"/emulator/*.deb; do dpkg -x "$package" "$folder/emulator"; done

# Use only the project's own dependencies, without tools. The lock file determines their versions.
.venv/bin/python - >"$folder/wanted.txt" <<'PYTHON'
import tomllib
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text())["project"]
print("\n".join((*project["dependencies"], *project["optional-dependencies"]["argumentation"])))
PYTHON
grep -oE '^[A-Za-z0-9_.-]+==[^ \\]+' requirements.lock >"$folder/pinned.txt"
platforms=(manylinux_2_28_aarch64 manylinux_2_27_aarch64 manylinux_2_26_aarch64 manylinux_2_24_aarch64 manylinux2014_aarch64
    manylinux_2_17_aarch64 any)
"$pip" -m pip download -q --dest "$folder/wheels" --python-version 3.11 --implementation cp --abi cp311 --abi abi3 --abi none \
    "${platforms[@]/#/--platform=}" --only-binary=:all: -r "$folder/wanted.txt" -c "$folder/pinned.txt"
for wheel in "$folder"/wheels/*.whl; do .venv/bin/python -m zipfile -e "$wheel" "$folder/site"; done

cat >"$folder/python" <<SHELL
#!/bin/sh
export LD_LIBRARY_PATH="$folder/emulator/usr/lib/$(uname -m)-linux-gnu"
exec "$folder/emulator/usr/bin/qemu-aarch64" -L "$folder/root" \\
    -E LD_LIBRARY_PATH="$folder/root/usr/lib/aarch64-linux-gnu:$folder/root/lib/aarch64-linux-gnu" \\
    -E PYTHONHOME="$folder/root/usr" -E PYTHONPATH="\$PYTHONPATH:$folder/site" "$folder/root/usr/bin/python3.11" "\$@"
SHELL
chmod +x "$folder/python"
"$folder/python" -c 'import platform, numpy; print(platform.machine(), platform.python_version(), "numpy", numpy.__version__)'
