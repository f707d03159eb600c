from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Calibration",
    "Check",
    "ContentError",
    "Error",
    "FileError",
    "Finding",
    "Map",
    "Rays",
    "RequestError",
    "Samples",
    "Scene",
    "SceneError",
    "__version__",
    "fit",
    "load_map",
    "thread_count",
    "use_threads",
]
__version__: str

_Value: TypeAlias = bool | int | float | str | Sequence[float] | Sequence[Sequence[float]] | NDArray[Any]
_Read: TypeAlias = bool | int | float | str | list[int] | list[float] | list[list[float]]
_Path: TypeAlias = str | PathLike[str]
_Size: TypeAlias = Sequence[int]
_Point: TypeAlias = Sequence[float]
_Format: TypeAlias = Literal[
    "exr",
    "exr-half",
    "npy",
    "png16",
    "blender",
    "touchdesigner",
    "touchdesigner-png",
    "ffmpeg",
    "opencv",
    "opencv-yaml",
    "mpcdi",
]

class Error(Exception):
    message: str
    file: str | None
    line: int | None
    remedy: str | None

class SceneError(Error, ValueError): ...
class FileError(Error, OSError): ...
class ContentError(Error, ValueError): ...
class RequestError(Error, ValueError): ...

@final
class Finding:
    @property
    def kind(self) -> str: ...
    @property
    def severity(self) -> Literal["fault", "warning", "note"]: ...
    @property
    def sentence(self) -> str: ...
    @property
    def remedy(self) -> str | None: ...
    @property
    def values(self) -> dict[str, _Read]: ...

@final
class Check:
    @property
    def formed(self) -> float: ...
    @property
    def shares(self) -> dict[str, float]: ...
    @property
    def findings(self) -> list[Finding]: ...
    @property
    def data(self) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...

@final
class Calibration:
    @property
    def scene(self) -> Scene: ...
    @property
    def parameters(self) -> list[dict[str, Any]]: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def data(self) -> dict[str, Any]: ...

@final
class Rays:
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def directions(self) -> NDArray[np.float64]: ...
    @property
    def met(self) -> NDArray[np.int16]: ...
    @property
    def action(self) -> NDArray[np.uint8]: ...
    @property
    def end(self) -> NDArray[np.uint8]: ...
    @property
    def st(self) -> NDArray[np.float64]: ...
    @property
    def elements(self) -> list[str]: ...

@final
class Samples:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Map:
    @property
    def uv(self) -> NDArray[np.float64]: ...
    @property
    def status(self) -> NDArray[np.uint8]: ...
    @property
    def gain(self) -> NDArray[np.float32] | None: ...
    @property
    def error_bound(self) -> float: ...
    @property
    def resolution(self) -> tuple[int, int]: ...
    @property
    def counts(self) -> dict[str, int]: ...
    @property
    def channels(self) -> tuple[Map, Map, Map] | None: ...
    @property
    def report(self) -> dict[str, Any] | None: ...
    @property
    def notes(self) -> list[str]: ...
    def uv_bytes(self) -> bytes: ...
    def status_bytes(self) -> bytes: ...
    def apply(self, picture: ArrayLike, *, optimal: bool = False) -> NDArray[Any]: ...
    def bled(self, pixels: int) -> Map: ...
    def to_opencv(
        self, *, source: _Size | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def to_stmap(self) -> NDArray[np.float32]: ...
    def save(
        self,
        path: _Path,
        *,
        format: _Format | None = None,
        source: _Size | None = None,
        bleed: int = 0,
    ) -> list[Any]: ...

@final
class Scene:
    def __new__(
        cls,
        source: _Path | Mapping[str, Any],
        *,
        files: _Path | Mapping[str, bytes] | None = None,
    ) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def toml(self) -> str: ...
    @property
    def elements(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def display(self) -> dict[str, list[float] | list[int]]: ...
    def index(self, element: int | str) -> float | None: ...
    def __getitem__(self, path: str, /) -> Any: ...
    def __setitem__(self, path: str, value: _Value, /) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _restored(text: str, name: str, files: dict[str, bytes]) -> Scene: ...
    def update(self, values: dict[str, _Value]) -> None: ...
    def changed(self, values: dict[str, _Value]) -> Scene: ...
    def unit(self, path: str) -> str | None: ...
    def save(self, path: _Path) -> None: ...
    def map(
        self,
        *,
        resolution: _Size | None = None,
        method: Literal["inverse", "splat"] = "inverse",
        spp: int | None = None,
        gain: Literal["fit", "clip", "soft"] | None = None,
        per_channel: bool = False,
        tolerance: float = 1e-6,
    ) -> Map: ...
    def uncompensated_map(self, *, resolution: _Size | None = None) -> Map: ...
    def view(
        self,
        display: ArrayLike,
        *,
        eye: _Point | None = None,
        size: _Size | None = None,
        window: float = 1.0,
        supersampling: int = 2,
        spp: int | None = None,
        plate: Literal["ideal", "slit-mirror"] | None = None,
        aperture: float | None = None,
        focus: float | None = None,
        light: Literal["real", "stray", "all"] | None = None,
        exposure: float | None = None,
        seed: int | None = None,
    ) -> NDArray[Any]: ...
    def check(self) -> Check: ...
    def trace(self, uv: ArrayLike, *, eye: _Point | None = None) -> Rays: ...
    @overload
    def forward(  # type: ignore[overload-overlap]
        self, uv: bytes, *, beyond: bool = False
    ) -> bytes: ...
    @overload
    def forward(self, uv: ArrayLike, *, beyond: bool = False) -> NDArray[np.float64]: ...
    @overload
    def jacobian(  # type: ignore[overload-overlap]
        self, uv: bytes, *, beyond: bool = False
    ) -> bytes: ...
    @overload
    def jacobian(self, uv: ArrayLike, *, beyond: bool = False) -> NDArray[np.float64]: ...
    @overload
    def seen(self, uv: bytes, built: Scene) -> bytes: ...  # type: ignore[overload-overlap]
    @overload
    def seen(self, uv: ArrayLike, built: Scene) -> NDArray[np.float64]: ...
    def evaluate(
        self,
        photographs: dict[str, ArrayLike] | None = None,
        *,
        azimuths: Sequence[float] = ...,
        plate: Literal["ideal", "slit-mirror"] = "slit-mirror",
        spp: int = 512,
        size: int = 384,
        lpips: bool = False,
    ) -> dict[str, Any]: ...
    def plate(self, *, aperture: float = 4.0) -> dict[str, Any]: ...
    def layout(self) -> dict[str, Any]: ...
    def drawing(self) -> str: ...
    def _repr_svg_(self) -> str: ...

def fit(
    scene: Scene,
    views: Mapping[str, tuple[ArrayLike, ArrayLike]],
    *,
    focal: _Point | None = None,
    centre: _Point | None = None,
    distortion: Sequence[float] = ...,
    position: float = 3.0,
    rotation: float = 3.0,
    ior: float = 0.02,
    size: float = 0.5,
    free: Sequence[str] = ...,
    fix: Sequence[str] = ...,
    together: Sequence[Sequence[str]] = ...,
    starts: int = 8,
) -> Calibration: ...
def load_map(
    path: _Path,
    *,
    format: _Format | None = None,
    source: _Size | None = None,
    region: str | None = None,
) -> Map: ...
def use_threads(count: int | None = None) -> None: ...
def thread_count() -> int: ...
