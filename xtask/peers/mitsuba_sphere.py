"""The paper's scatter through its sphere, as one fused kernel of Mitsuba 3's LLVM backend.

`mitsuba_sphere.py --version` prints Mitsuba's version if that backend works. Otherwise the argument is the set-up as
JSON; for each number of samples per pixel on a line of standard input, a line with the seconds that they took and the number of
display pixels that they hit is printed. Single precision, as that backend's kernels are meant to be used.
"""

import glob
import json
import os
import sys
import time

if "DRJIT_LIBLLVM_PATH" not in os.environ:
    # Where Debian keeps it; Dr.Jit itself looks for the name without a version.
    found = sorted(glob.glob("/usr/lib/*/libLLVM-*.so*"))
    if found:
        os.environ["DRJIT_LIBLLVM_PATH"] = found[-1]

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

if sys.argv[1] == "--version":
    dr.eval(dr.arange(mi.Float, 4) + 1)
    dr.sync_thread()
    print(mi.__version__)
    sys.exit()

setup = json.loads(sys.argv[1])
width, height = setup["resolution"]


def vector(v):
    return mi.Vector3f(*v)


def rectangle(name):
    r = setup[name]
    return vector(r["origin"]), [vector(a) for a in r["axes"]], r["size"]


def to_plane(point, direction, origin, normal):
    return point + direction * (dr.dot(origin - point, normal) / dr.dot(direction, normal))


def refract(direction, normal, eta):
    """Snell's law, `normal` against `direction`, `eta` the index before over the one behind."""
    cos_i = -dr.dot(direction, normal)
    cos_t = dr.sqrt(1 - eta * eta * (1 - cos_i * cos_i))
    return direction * eta + normal * (eta * cos_i - cos_t)


def scatter(spp, u_map, v_map):
    index = dr.arange(mi.UInt32, width * height * spp)
    pixel, sample = index // spp, index % spp
    # Samples on the diagonal of each pixel, spread by the golden ratio across it.
    du = (mi.Float(sample) + 0.5) / spp
    dv = mi.Float(0.5) if spp == 1 else dr.fma(mi.Float(sample), 0.61803399, 0.5)
    dv = dv - dr.floor(dv)
    u = (mi.Float(pixel % width) + du) / width
    v = (height - 1 - mi.Float(pixel // width) + dv) / height

    eye = vector(setup["viewpoint"])
    origin, (x, y, _), size = rectangle("image")
    target = origin + x * ((u - 0.5) * size[0]) + y * ((v - 0.5) * size[1])
    direction = dr.normalize(target - eye)

    # Into the sphere around the origin and out of it, in closed form.
    radius, ior = setup["radius"], setup["ior"]
    b = dr.dot(eye, direction)
    inside = b * b - dr.dot(eye, eye) + radius * radius
    point = eye + direction * (-b - dr.sqrt(inside))
    direction = refract(direction, point / radius, 1 / ior)
    point = point + direction * (-2 * dr.dot(point, direction))
    direction = refract(direction, -point / radius, ior)

    plate, (px, py, pz), plate_size = rectangle("plate")
    point = to_plane(point, direction, plate, pz)
    at = point - plate
    through = (abs(dr.dot(at, px)) <= plate_size[0] / 2) & (abs(dr.dot(at, py)) <= plate_size[1] / 2)
    direction = pz * (2 * dr.dot(direction, pz)) - direction

    display, (dx, dy, dz), display_size = rectangle("display")
    at = to_plane(point, direction, display, dz) - display
    s, t = dr.dot(at, dx) / display_size[0] + 0.5, dr.dot(at, dy) / display_size[1] + 0.5
    formed = (inside > 0) & through & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    column = dr.minimum(mi.UInt32(s * width), width - 1)
    row = dr.minimum(mi.UInt32((1 - t) * height), height - 1)
    place = row * width + column
    dr.scatter(u_map, u, place, formed)
    dr.scatter(v_map, v, place, formed)


for line in sys.stdin:
    spp = int(line)
    u_map, v_map = dr.full(mi.Float, -1, width * height), dr.full(mi.Float, -1, width * height)
    dr.eval(u_map, v_map)
    dr.sync_thread()
    start = time.perf_counter()
    scatter(spp, u_map, v_map)
    dr.eval(u_map, v_map)
    dr.sync_thread()
    seconds = time.perf_counter() - start
    hit = dr.count(u_map >= 0)
    print(seconds, hit[0] if hasattr(hit, "__getitem__") else hit, flush=True)
