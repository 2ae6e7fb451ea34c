"""Sizes of Argo's installation: of a plain one, and of what each extra adds to it.

    python -m benchmarks.install_sizes
    python -m benchmarks.install_sizes --only film --python-version 3.12

For each row, uv installs Argo's wheel and the packages that `constraints.txt` names into an empty
folder, for CPython on Linux x86-64, whatever the machine. The sizes are those of the files, in MB
of a million bytes, without the bytecode that Python adds to them. PyTorch is left out, since its
size depends on the build. The largest packages of each row are named with their sizes.
"""

import argparse
import csv
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLATFORM = "x86_64-manylinux_2_28"
FOR_CONTRIBUTORS = {"bench", "dev"}
NAMED = 3
"""number of packages that a row names"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = sorted(project["optional-dependencies"].keys() - FOR_CONTRIBUTORS)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="*", choices=extras, default=extras, help="extras")
    parser.add_argument("--python-version", default="3.13", help="version of CPython")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run_uv("build", "--wheel", "--out-dir", folder, ROOT)
        (wheel,) = folder.glob("*.whl")
        plain = installed_sizes(folder, wheel, "", options.python_version)
        print("| install | MB | largest packages, MB |\n| -- | -- | -- |")
        print_row("plain", plain)
        for extra in options.only:
            sizes = installed_sizes(folder, wheel, extra, options.python_version)
            added = {package: size for package, size in sizes.items() if package not in plain}
            print_row(f"`{extra}` adds", added)


def run_uv(*arguments: object) -> None:
    """Run uv, and raise CalledProcessError if it fails."""
    uv = Path(sys.executable).with_name("uv")
    subprocess.run([uv, *map(str, arguments), "--quiet"], check=True)


def installed_sizes(folder: Path, wheel: Path, extra: str, version: str) -> dict[str, float]:
    """Install Argo with an extra, or with none, and return the size of each package in MB."""
    overrides = folder / "overrides.txt"
    overrides.write_text("torch; sys_platform == 'none'\n", encoding="utf-8")
    target = folder / (extra or "plain")
    run_uv(
        *("pip", "install", "--target", target, "--link-mode", "symlink"),
        *("--python-version", version, "--python-platform", PLATFORM, "--only-binary", ":all:"),
        *("--constraint", ROOT / "constraints.txt", "--overrides", overrides),
        f"{wheel}[{extra}]" if extra else wheel,
    )
    return {
        record.parent.name.partition("-")[0]: package_size(record) / 1e6
        for record in target.glob("*.dist-info/RECORD")
    }


def package_size(record: Path) -> int:
    """Return the size in bytes of the files that an installed package lists."""
    target = record.parents[1]
    rows = csv.reader(record.read_text(encoding="utf-8").splitlines())
    paths = [target / name for name, _digest, _size in rows]
    return sum(path.stat().st_size for path in paths if path.is_file())


def print_row(name: str, sizes: dict[str, float]) -> None:
    """Print the sum of the sizes of packages, and the largest packages."""
    largest = sorted(sizes, key=lambda package: -sizes[package])[:NAMED]
    named = ", ".join(f"{package} {sizes[package]:.0f}" for package in largest)
    print(f"| {name} | {sum(sizes.values()):.0f} | {named} |", flush=True)


if __name__ == "__main__":
    main()
