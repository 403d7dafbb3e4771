"""The command line: python3 -m mallow run scene.toml is what mallow run scene.toml is."""
import os
import shutil
import sys
from pathlib import Path


def program():
    """The program that was installed or built with this package, or else the one of the path."""
    here = Path(__file__).resolve().parent
    for folder in (here, Path(sys.prefix) / "bin", here.parent.parent / "bin"):
        if os.access(folder / "mallow", os.X_OK) and (folder / "mallow").is_file():
            return str(folder / "mallow")
    return shutil.which("mallow")


def main():
    found = program()
    if not found:
        print("mallow: the program mallow is neither beside the Python package nor in the path", file=sys.stderr)
        return 1
    os.execv(found, ["mallow", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
