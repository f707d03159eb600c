"""Packs a Python package as a wheel for this machine, by the few rules that wheels have (PEP 427).

Arguments: the package's folder, its version, the folder for the wheel. Prints the wheel's path.
"""

import base64
import hashlib
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import zipfile


def content(path, folder):
    """A file's bytes; of a library without what debuggers read, which is most of it."""
    if path.suffix == ".so" and shutil.which("strip"):
        bare = folder / "bare.so"
        subprocess.run(["strip", "--strip-debug", "-o", bare, path], check=True)
        data = bare.read_bytes()
        bare.unlink()
        return data
    return path.read_bytes()


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def main(package, version, folder):
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    tag = f"cp310-abi3-{platform}"
    info = f"{package.name}-{version}.dist-info"
    files = {
        f"{package.name}/{path.name}": content(path, folder) for path in sorted(package.iterdir()) if path.is_file()
    }
    files[f"{info}/METADATA"] = f"Metadata-Version: 2.1\nName: {package.name}\nVersion: {version}\n".encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: xtask\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = "".join(f"{name},sha256={digest(data)},{len(data)}\n" for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    wheel = folder / f"{package.name}-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as zipped:
        for name, data in files.items():
            zipped.writestr(name, data)
    return wheel


if __name__ == "__main__":
    print(main(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])))
