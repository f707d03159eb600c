"""Sweeps: what becomes of a set-up while some of its values vary."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias, Union

from . import _core
from ._core import Scene

if TYPE_CHECKING:
    import xarray

Found: TypeAlias = Mapping[str, float]
Measure: TypeAlias = Union[str, Callable[[Scene], Union[float, Found]]]

#: A task of less work is not worth its sending, seconds.
_TASK = 0.1


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[Any]],
    measure: Sequence[Measure] = ("formed",),
    *,
    client: Any = None,
    store: Any = None,
) -> xarray.Dataset:
    """What is measured of a scene for all combinations of values at some of its paths, as an xarray.Dataset.

    over: values by scene path, such as {"viewpoint.position.x": [-10, 0, 10]}. The dataset's dimensions are these paths, with their units.

    measure: names, or functions of the varied scene that return a number, or several by name. The names:

    - "formed": the share of the image that is formed, of 65 x 65 image points;
    - "displacement": while the display shows what was computed for `scene`, the set-up is built as varied: how far from their places 9 x 9
      image points are then seen, mean over those that are seen, mm on the image; "displacement_max": the farthest;
    - "gain": the mean share of the display's light that arrives.

    client: a Dask distributed client, on whose workers all is computed; else here. store: a zarr store (a folder's name) that keeps what was
    found: the same sweep goes on from there when it was interrupted. A set-up that fails has NaN, and says why in `message`.

    Needs xarray, and zarr for a store: pip install midair[sweep].
    """
    import numpy as np

    xr = _import("xarray")
    # Misspelt paths are told before any work is done.
    axes = {path: _values(path, values) for path, values in over.items()}
    units = {path: scene.unit(path) for path in axes}
    measures = _named(measure)
    shape = tuple(len(values) for values in axes.values())
    count = math.prod(shape)

    found = _Findings(count)
    kept = None
    if store is not None:
        kept = _Store(store, scene, axes, list(measures), count)
        kept.read_into(found)
    todo = [i for i in range(count) if not found.done[i]]
    settings = _Settings(axes, shape)
    runs = _here(scene, settings, measures, todo) if client is None else _there(
        client, scene, settings, measures, todo
    )
    for batch in runs:
        found.add(batch)
        if kept is not None:
            kept.write(batch, found)

    failed = [message for message in found.messages if message]
    if count and len(failed) == count:
        warnings.warn(f"all {count} set-ups failed, the first one so: {failed[0]}", stacklevel=2)
    dims = tuple(axes)
    coords = {
        path: (path, values, {"units": units[path] or "1", "long_name": path})
        for path, values in axes.items()
    }
    data: dict[str, Any] = {
        name: (dims, np.asarray(values).reshape(shape), _ATTRIBUTES.get(name, {}))
        for name, values in found.values.items()
    }
    for name in measures:
        # Of names that never were found, as where all set-ups fail.
        if isinstance(measures[name], str) and name not in data:
            data[name] = (dims, np.full(shape, np.nan), _ATTRIBUTES.get(name, {}))
    messages = np.asarray(found.messages, dtype=object).reshape(shape)
    data["message"] = (dims, messages, {"long_name": "why a set-up failed"})
    return xr.Dataset(data, coords, {"scene": scene.toml, "midair": _core.__version__})


def _import(name: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"sweeps need {name}: pip install midair[sweep]") from error


def _values(path: str, values: Sequence[Any]) -> Any:
    import numpy as np

    array = np.asarray(values)
    if array.ndim != 1 or array.size == 0 or array.dtype.kind not in "biufU":
        raise ValueError(f"{path}: give a list of numbers, or of texts, with at least one in it")
    return array


# What is measured.


def _grid(n: int) -> Any:
    import numpy as np

    places = (np.arange(n) + 0.5) / n
    return np.stack(np.meshgrid(places, places), axis=-1)


def _formed(_: Scene, varied: Scene) -> float:
    import numpy as np

    return float(np.isfinite(varied.forward(_grid(65))[..., 0]).mean())


def _displacements(scene: Scene, varied: Scene) -> Any:
    import numpy as np

    uv = _grid(9)
    off = (scene.seen(uv, varied) - uv) * np.asarray(scene["image.size"])
    lengths = np.linalg.norm(off, axis=-1)
    if not np.isfinite(lengths).any():
        raise ValueError("none of the image points is seen")
    return lengths


def _displacement(scene: Scene, varied: Scene) -> float:
    import numpy as np

    return float(np.nanmean(_displacements(scene, varied)))


def _displacement_max(scene: Scene, varied: Scene) -> float:
    import numpy as np

    return float(np.nanmax(_displacements(scene, varied)))


def _gain(_: Scene, varied: Scene) -> float:
    import numpy as np

    gain = varied.map(resolution=(64, 64)).gain
    if gain is None or not np.isfinite(gain).any():
        raise ValueError("nothing is formed")
    return float(np.nanmean(gain))


_MEASURES: dict[str, Callable[[Scene, Scene], float]] = {
    "formed": _formed,
    "displacement": _displacement,
    "displacement_max": _displacement_max,
    "gain": _gain,
}
_ATTRIBUTES = {
    "formed": {"units": "1", "long_name": "share of the image that is formed"},
    "displacement": {"units": "mm", "long_name": "mean displacement on the image"},
    "displacement_max": {"units": "mm", "long_name": "largest displacement on the image"},
    "gain": {"units": "1", "long_name": "mean share of the display's light that arrives"},
}


def _named(measure: Sequence[Measure]) -> dict[str, Measure]:
    if isinstance(measure, str) or callable(measure):
        measure = [measure]
    named: dict[str, Measure] = {}
    for one in measure:
        if isinstance(one, str) and one not in _MEASURES:
            raise ValueError(f"there is no measure {one!r}; there are {', '.join(_MEASURES)}")
        name = one if isinstance(one, str) else getattr(one, "__name__", type(one).__name__)
        if name in named:
            raise ValueError(f"two measures are called {name!r}: give the functions other names")
        named[name] = one
    return named


def _measured(scene: Scene, varied: Scene, measures: Mapping[str, Measure]) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, measure in measures.items():
        if isinstance(measure, str):
            found[name] = _MEASURES[measure](scene, varied)
            continue
        value = measure(varied)
        if isinstance(value, Mapping):
            found.update((key, float(number)) for key, number in value.items())
        else:
            found[name] = float(value)
    return found


# Set-ups by their number.


class _Settings:
    """The values of each set-up, by its number: the last path's vary fastest."""

    def __init__(self, axes: Mapping[str, Any], shape: tuple[int, ...]) -> None:
        self.axes, self.shape = axes, shape

    def __getitem__(self, number: int) -> dict[str, Any]:
        import numpy as np

        places = np.unravel_index(number, self.shape)
        # Texts of numpy's are Python's own.
        return {path: values[at].item() for (path, values), at in zip(self.axes.items(), places)}


#: A set-up's number, what was measured, and else why not.
_Result: TypeAlias = "tuple[int, dict[str, float] | None, str]"


def _run(
    scene: Scene, settings: _Settings, measures: Mapping[str, Measure], numbers: Sequence[int]
) -> list[_Result]:
    results: list[_Result] = []
    for number in numbers:
        try:
            varied = scene.changed(settings[number])
            results.append((number, _measured(scene, varied, measures), ""))
        except Exception as error:  # Whatever is wrong with one set-up, the others go on.
            message = getattr(error, "message", "") or str(error) or type(error).__name__
            results.append((number, None, message))
    return results


def _here(
    scene: Scene, settings: _Settings, measures: Mapping[str, Measure], todo: Sequence[int]
) -> Iterator[list[_Result]]:
    start, batch = time.monotonic(), []
    for number in todo:
        batch += _run(scene, settings, measures, [number])
        if time.monotonic() - start >= _TASK:
            yield batch
            start, batch = time.monotonic(), []
    if batch:
        yield batch


@contextmanager
def _one_thread() -> Iterator[None]:
    _core.use_threads(1)
    try:
        yield
    finally:
        _core.use_threads(None)


def _task(
    scene: Scene, settings: _Settings, measures: Mapping[str, Measure], numbers: Sequence[int]
) -> list[_Result]:
    """A task on a worker: its own thread is one of as many as the worker has, and does the work alone."""
    with _one_thread():
        return _run(scene, settings, measures, numbers)


def _sent(scene: Scene) -> Scene:
    return scene


def _there(
    client: Any,
    scene: Scene,
    settings: _Settings,
    measures: Mapping[str, Measure],
    todo: Sequence[int],
) -> Iterator[list[_Result]]:
    distributed = _import("distributed")
    # The first ones, here: they tell how long the others take.
    first = 0
    start = time.monotonic()
    with _one_thread():
        while first < len(todo) and time.monotonic() - start < _TASK:
            yield _run(scene, settings, measures, [todo[first]])
            first += 1
    each = (time.monotonic() - start) / max(first, 1)
    size = max(1, math.ceil(_TASK / max(each, 1e-6)))
    # The outcome of a task, not scattered data: should its worker die, it is made again.
    there = client.submit(_sent, scene, pure=False)
    batches = [todo[at : at + size] for at in range(first, len(todo), size)]
    futures = {
        client.submit(_task, there, settings, measures, batch, pure=False): batch
        for batch in batches
    }
    try:
        for future in distributed.as_completed(list(futures)):
            batch = futures.pop(future)
            error = future.exception()
            if error is None:
                yield future.result()
            else:
                yield [(number, None, f"its task failed: {error}") for number in batch]
            future.release()
    finally:
        client.cancel(list(futures))


class _Findings:
    """What was found so far, by the set-ups' numbers."""

    def __init__(self, count: int) -> None:
        import numpy as np

        self.count = count
        self.values: dict[str, Any] = {}
        self.messages = [""] * count
        self.done = np.zeros(count, bool)

    def of(self, name: str) -> Any:
        import numpy as np

        return self.values.setdefault(name, np.full(self.count, np.nan))

    def add(self, batch: Sequence[_Result]) -> None:
        for number, values, message in batch:
            for name, value in (values or {}).items():
                self.of(name)[number] = value
            self.messages[number] = message
            self.done[number] = True


class _Store:
    """A zarr group with what was found: an array for each measure, and `done`, which is written last."""

    _CHUNK = 4096

    def __init__(
        self, store: Any, scene: Scene, axes: Mapping[str, Any], measures: list[str], count: int
    ) -> None:
        zarr = _import("zarr")
        self.group = zarr.open_group(store, mode="a")
        described = {
            "midair": _core.__version__,
            "scene": scene.toml,
            "over": {path: values.tolist() for path, values in axes.items()},
            "measure": measures,
        }
        held = self.group.attrs.get("sweep")
        if held is None:
            if list(self.group.members()):
                raise ValueError(f"{store}: holds something else; give another store")
            self.group.attrs["sweep"] = described
        elif held != described:
            other = [key for key in described if held.get(key) != described[key]]
            raise ValueError(
                f"{store}: holds another sweep ({', '.join(other)} differ); give another store"
            )
        self.count = count
        self.done = self._array("done", "bool", False)

    def _array(self, name: str, dtype: str, fill: Any) -> Any:
        if name in self.group:
            return self.group[name]
        chunks = (min(self.count, self._CHUNK),)
        return self.group.create_array(
            name, shape=(self.count,), chunks=chunks, dtype=dtype, fill_value=fill
        )

    def read_into(self, found: _Findings) -> None:
        found.done[:] = self.done[:]
        for name, array in self.group.members():
            if name.startswith("found."):
                found.of(name.removeprefix("found."))[:] = array[:]
        for number, message in self.group.attrs.get("messages", {}).items():
            found.messages[int(number)] = message

    def write(self, batch: Sequence[_Result], found: _Findings) -> None:
        import numpy as np

        numbers = np.asarray([number for number, _, _ in batch])
        for name, values in found.values.items():
            self._array(f"found.{name}", "float64", float("nan"))[numbers] = values[numbers]
        messages = {str(number): message for number, _, message in batch if message}
        if messages:
            self.group.attrs["messages"] = {**self.group.attrs.get("messages", {}), **messages}
        self.done[numbers] = True
