"""Build interface packages for rclpy with rosidl's generators and gcc, without ament and CMake.

python scripts/peers/ros2_interfaces.py FOLDER...

Run it with the Python of `.peers/ros2`. Each FOLDER is a package with `msg`, `srv` and `action`. Each package becomes
one module with all its code: messages in C, type support for Fast DDS, and classes for Python. The packages are
installed next to those of the wheels, with their type descriptions in `share`.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

PREFIX = Path(sys.prefix)
# The generators find each other, and their templates, in this path.
os.environ["AMENT_PREFIX_PATH"] = str(PREFIX)

import numpy as np  # noqa: E402
from rosidl_parser import parser  # noqa: E402

# Each generator parses all files, which takes most of their time.
parse = parser.parse_idl_file
parsed: dict[Path, object] = {}
parser.parse_idl_file = lambda locator: (
    parsed.get(path := locator.get_absolute_path()) or parsed.setdefault(path, parse(locator))
)

import rosidl_generator_c.cli  # noqa: E402
import rosidl_generator_py.cli  # noqa: E402
import rosidl_generator_type_description.cli  # noqa: E402
import rosidl_typesupport_c.cli  # noqa: E402
import rosidl_typesupport_fastrtps_c.cli  # noqa: E402
import rosidl_typesupport_introspection_c.cli  # noqa: E402
from rosidl_adapter.action import convert_action_to_idl  # noqa: E402
from rosidl_adapter.msg import convert_msg_to_idl  # noqa: E402
from rosidl_adapter.srv import convert_srv_to_idl  # noqa: E402

SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
"""Type supports that are looked up in libraries of these names."""
CONVERTERS = {"msg": convert_msg_to_idl, "srv": convert_srv_to_idl, "action": convert_action_to_idl}
SHARE = PREFIX / "share"
SITE = Path(sysconfig.get_path("purelib"))


def describe(folder: Path, own: Path) -> tuple[list[str], list[str]]:
    """Write definitions in IDL and type descriptions with hashes of a package; return the files of both."""
    package = folder.name
    files = [
        f"{own}:{convert(folder, package, path.relative_to(folder), own / kind).relative_to(own)}"
        for kind, convert in CONVERTERS.items()
        for path in sorted((folder / kind).glob(f"*.{kind}"))
    ]
    hashes = rosidl_generator_type_description.cli.HashTypeDescription("").generate_type_hashes
    return files, hashes(package, files, [str(SHARE), str(own.parent)], own)


def generate(folder: Path, work: Path) -> None:
    """Write the code of a package into one subfolder of `work` per generator, since some files have equal names."""
    package = folder.name
    files, described = describe(folder, work / "idl" / package)
    for name, generator, arguments in (
        ("c", rosidl_generator_c.cli.GenerateC(""), (described,)),
        ("fastrtps", rosidl_typesupport_fastrtps_c.cli.GenerateFastRTPSCTypesupport(""), ()),
        ("introspection", rosidl_typesupport_introspection_c.cli.GenerateIntrospectionCTypesupport(""), ()),
        ("support", rosidl_typesupport_c.cli.GenerateCTypesupport("", typesupport_implementations=SUPPORTS), ()),
        ("py", rosidl_generator_py.cli.GeneratePython("", typesupport_implementations=["rosidl_typesupport_c"]), ()),
    ):
        generator.generate(package, files, [str(SHARE)], work / name / package, *arguments)


def compile_package(work: Path, module: Path) -> None:
    """Compile the code of a package into one module."""
    prefix = PREFIX / "include"
    include = [prefix, *prefix.iterdir(), *work.iterdir(), Path(sysconfig.get_path("include")), Path(np.get_include())]
    flags = ["-O0", "-fPIC", "-w", *(f"-I{path}" for path in include if path.is_dir())]
    # Files that include others, so that the compiler reads headers once. The descriptions have static names in common.
    sources = [*work.rglob("*__description.c"), work / "every.c", work / "every.cpp"]
    for every in sources[-2:]:
        parts = sorted(part for part in work.rglob(f"*{every.suffix}") if part not in sources)
        every.write_text("".join(f'#include "{part}"\n' for part in parts))

    def compiled(source: Path) -> Path:
        target = source.with_suffix(f"{source.suffix}.o")
        compiler = "g++" if source.suffix == ".cpp" else "gcc"
        subprocess.run([compiler, *flags, "-c", source, "-o", target], check=True)
        return target

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(compiled, sources))
    libraries = [
        path for ending in ("_c", "_cpp", "_py") for path in (PREFIX / "lib").glob(f"lib*__rosidl_*{ending}.so")
    ]
    libraries += (PREFIX / "lib").glob("librosidl_*.so")
    libraries += [PREFIX / "lib" / f"lib{name}.so" for name in ("fastcdr", "rcutils", "rmw")]
    subprocess.run(["g++", "-shared", "-o", module, *objects, "-Wl,--as-needed", *sorted(libraries)], check=True)


def install(folder: Path) -> None:
    """Build a package and install it."""
    with tempfile.TemporaryDirectory() as work:
        build(folder, Path(work))


def build(folder: Path, work: Path) -> None:
    """Build a package in an empty folder and install it."""
    package = folder.name
    generate(folder, work)
    site, share = SITE / package, SHARE / package
    for old in (site, share):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(work / "py" / package, site, ignore=shutil.ignore_patterns("*.c"))
    (site / "__init__.py").touch()
    shutil.copytree(work / "idl" / package, share)
    module = site / f"{package}_s__rosidl_typesupport_c.so"
    compile_package(work, module)
    for support in SUPPORTS:
        library = PREFIX / "lib" / f"lib{package}__{support}.so"
        library.unlink(missing_ok=True)
        library.symlink_to(module)


if __name__ == "__main__":
    with ProcessPoolExecutor() as pool:
        list(pool.map(install, [Path(folder).absolute() for folder in sys.argv[1:]]))
