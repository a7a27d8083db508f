# SPDX-License-Identifier: BSD-3-Clause
"""The C library as the tests see it: built once a session, called through ctypes on numpy arrays."""

import contextlib
import ctypes
import fcntl
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "runtime"
BUILD = ROOT / "build"
HERE = Path(__file__).resolve().parent
MODELS = ("printed", "fitted")
BUILTIN = (*MODELS, "brown")
AXES = ("direct_theta", "direct_phi", "multiple_theta")
LOBES = ("direct", "multiple")
MESSAGE_SIZE = 512
OK, ARGUMENT, MEMORY, FILE, ATTRIBUTE, VERSION, TABLE, UNSUPPORTED = range(8)
SAMPLE = np.dtype([(name, np.float32) for name in ("theta_i", "phi_i", "pdf_angle", "pdf_solid_angle")])
FLAGS = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]


def tool(name: str) -> str | None:
    """The path of a program, also of one that pip installed beside this Python; None if there is none."""
    beside = Path(sys.executable).parent / name
    return str(beside) if os.access(beside, os.X_OK) else shutil.which(name)


def run(*command: str | Path, timeout: float = 300, **options) -> subprocess.CompletedProcess:
    """Runs a command and shows its output if it fails."""
    done = subprocess.run(
        [str(word) for word in command], text=True, capture_output=True, timeout=timeout, **options
    )
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}"
    return done


@contextlib.contextmanager
def alone(folder: Path) -> Iterator[None]:
    """One process at a time builds in a folder: `make test` runs two files of tests at once."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def cmake(source: Path, build: Path, *definitions: str, targets: tuple[str, ...] = ()) -> Path:
    """Configures and builds a CMake project with the Ninja that is at hand; returns the build folder."""
    with alone(build):
        run(
            tool("cmake"),
            "-S",
            source,
            "-B",
            build,
            "-G",
            "Ninja",
            f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}",
            *definitions,
        )
        run(tool("cmake"), "--build", build, *(["--target", *targets] if targets else []))
    return build


@cache
def build() -> Path:
    """The build folder that `make build` fills, up to date."""
    return cmake(RUNTIME, BUILD / "runtime", "-DCMAKE_BUILD_TYPE=Release")


def has_exr() -> bool:
    """Whether the loader was built."""
    return any(build().glob("libhairlut_exr.*"))


@cache
def core() -> ctypes.CDLL:
    """libhairlut."""
    library = ctypes.CDLL(str(_shared(build(), "hairlut")), mode=ctypes.RTLD_GLOBAL)
    library.hairlut_builtin.restype = ctypes.c_void_p
    library.hairlut_builtin.argtypes = [ctypes.c_char_p]
    library.hairlut_free.argtypes = [ctypes.c_void_p]
    library.hairlut_free.restype = None
    library.hairlut_result_string.restype = ctypes.c_char_p
    library.hairlut_lobe_name.restype = ctypes.c_char_p
    library.hairlut_lobe_name.argtypes = [ctypes.c_void_p, ctypes.c_int]
    library.hairlut_parameter_name.restype = ctypes.c_char_p
    library.hairlut_parameter_name.argtypes = [ctypes.c_void_p, ctypes.c_int]
    library.hairlut_pdf_to_solid_angle.restype = ctypes.c_float
    library.hairlut_pdf_to_solid_angle.argtypes = [ctypes.c_float, ctypes.c_float]
    return library


@cache
def exr() -> ctypes.CDLL:
    """libhairlut_exr."""
    core()
    return ctypes.CDLL(str(_shared(build(), "hairlut_exr")))


@cache
def loops() -> ctypes.CDLL:
    """loops.c, linked against libhairlut."""
    core()
    folder = BUILD / "tests"
    folder.mkdir(parents=True, exist_ok=True)
    out = folder / "loops.so"
    include = [f"-I{RUNTIME / 'include'}", f"-I{RUNTIME / 'src'}"]
    compiler = os.environ.get("CC", "cc")
    run(compiler, *FLAGS, "-fno-math-errno", "-fPIC", "-shared", *include, HERE / "loops.c", "-o", out,
        f"-L{build()}", "-lhairlut", f"-Wl,-rpath,{build()}")  # fmt: skip
    return ctypes.CDLL(str(out))


def _shared(folder: Path, name: str) -> Path:
    suffix = "dylib" if sys.platform == "darwin" else "so"
    return folder / f"lib{name}.{suffix}"


class LoadError(Exception):
    """A result that is not HAIRLUT_OK, with the message beside it."""

    def __init__(self, result: int, message: str) -> None:
        super().__init__(f"{result}: {message}")
        self.result, self.message = result, message


class Model:
    """A hairlut_model; calls take scalars or arrays that broadcast, and return float32 arrays. A lobe is its
    name or number; an axis is `<lobe>_theta` or `<lobe>_phi`."""

    def __init__(self, pointer: int, name: str, owned: bool) -> None:
        self.pointer, self.name, self.owned = ctypes.c_void_p(pointer), name, owned

    def __repr__(self) -> str:
        return self.name

    def __del__(self) -> None:
        if self.owned:
            core().hairlut_free(self.pointer)

    @property
    def lobes(self) -> list[str]:
        """The lobes' names, in order."""
        count = core().hairlut_lobe_count(self.pointer)
        return [core().hairlut_lobe_name(self.pointer, k).decode() for k in range(count)]

    def lobe_index(self, lobe: str | int) -> int:
        """The number of a lobe."""
        return lobe if isinstance(lobe, int) else core().hairlut_lobe_index(self.pointer, lobe.encode())

    def sample(self, lobe: str | int, theta_r, phi_r, u_theta, u_phi) -> np.ndarray:
        """Records of SAMPLE."""
        inputs = _floats(theta_r, phi_r, u_theta, u_phi)
        out = np.empty(inputs[0].shape, SAMPLE)
        self._loop("loop_sample", (self.lobe_index(lobe),), *inputs, out)
        return out

    def pdf(self, lobe: str | int, theta_r, phi_r, theta_i, phi_i) -> np.ndarray:
        """Densities per rad^2."""
        inputs = _floats(theta_r, phi_r, theta_i, phi_i)
        out = np.empty_like(inputs[0])
        self._loop("loop_pdf", (self.lobe_index(lobe),), *inputs, out)
        return out

    def invert(self, lobe: str | int, theta_r, phi_r, theta_i, phi_i) -> tuple[np.ndarray, np.ndarray]:
        """(u_theta, u_phi)."""
        inputs = _floats(theta_r, phi_r, theta_i, phi_i)
        out = np.empty((*inputs[0].shape, 2), np.float32)
        self._loop("loop_invert", (self.lobe_index(lobe),), *inputs, out)
        return out[..., 0], out[..., 1]

    def sample_hair(self, theta_r, phi_r, u_lobe, u_theta, u_phi, offset=0.0, shares=None) -> np.ndarray:
        """Records of SAMPLE. shares: None, a number a lobe, or (..., lobes) of the inputs' shape."""
        inputs = _floats(theta_r, phi_r, offset, u_lobe, u_theta, u_phi)
        out = np.empty(inputs[0].shape, SAMPLE)
        self._loop("loop_sample_hair", (self._shares(shares, inputs[0]),), *inputs, out)
        return out

    def pdf_hair(self, theta_r, phi_r, theta_i, phi_i, offset=0.0, shares=None) -> np.ndarray:
        """Densities per rad^2; shares as in sample_hair."""
        inputs = _floats(theta_r, phi_r, offset, theta_i, phi_i)
        out = np.empty_like(inputs[0])
        self._loop("loop_pdf_hair", (self._shares(shares, inputs[0]),), *inputs, out)
        return out

    def sample_strand(
        self, parameters, theta_r, phi_r, u_lobe, u_theta, u_phi, offset=0.0, shares=None
    ) -> np.ndarray:
        """Records of SAMPLE. parameters: None, or (..., parameters), which broadcasts; shares as in
        sample_hair."""
        inputs = _floats(theta_r, phi_r, offset, u_lobe, u_theta, u_phi)
        out = np.empty(inputs[0].shape, SAMPLE)
        which = self._parameters(parameters, inputs[0]), self._shares(shares, inputs[0])
        self._loop("loop_sample_strand", which, *inputs, out)
        return out

    def pdf_strand(self, parameters, theta_r, phi_r, theta_i, phi_i, offset=0.0, shares=None) -> np.ndarray:
        """Densities per rad^2; parameters and shares as in sample_strand."""
        inputs = _floats(theta_r, phi_r, offset, theta_i, phi_i)
        out = np.empty_like(inputs[0])
        which = self._parameters(parameters, inputs[0]), self._shares(shares, inputs[0])
        self._loop("loop_pdf_strand", which, *inputs, out)
        return out

    @property
    def parameters(self) -> list[str]:
        """The parameters' names, in order."""
        count = core().hairlut_parameter_count(self.pointer)
        return [core().hairlut_parameter_name(self.pointer, p).decode() for p in range(count)]

    def _parameters(self, parameters, like: np.ndarray):
        if parameters is None:
            return None
        shape = *like.shape, len(self.parameters)
        self._strands = np.array(np.broadcast_to(np.asarray(parameters, np.float32), shape), order="C")
        return self._strands.ctypes.data_as(ctypes.c_void_p)

    def _shares(self, shares, like: np.ndarray):
        if shares is None:
            return None
        self._kept = np.array(
            np.broadcast_to(np.asarray(shares, np.float32), (*like.shape, len(self.lobes))), order="C"
        )
        return self._kept.ctypes.data_as(ctypes.c_void_p)

    def axis_sample(self, axis: str, theta_r, u) -> tuple[np.ndarray, np.ndarray]:
        """(angle, density per rad) of one table."""
        inputs = _floats(theta_r, u)
        x, pdf = np.empty_like(inputs[0]), np.empty_like(inputs[0])
        self._loop("axis_sample", self._axis(axis), *inputs, x, pdf)
        return x, pdf

    def axis_pdf(self, axis: str, theta_r, x) -> np.ndarray:
        """Density per rad of one table."""
        return self._axis_loop("axis_pdf", axis, theta_r, x)

    def axis_invert(self, axis: str, theta_r, x) -> np.ndarray:
        """u of an angle of one table."""
        return self._axis_loop("axis_invert", axis, theta_r, x)

    def axis_cell_width(self, axis: str, theta_r, x) -> np.ndarray:
        """Width of the cell that contains an angle of one table."""
        return self._axis_loop("axis_cell_width", axis, theta_r, x)

    def _axis(self, axis: str) -> tuple[int, int]:
        lobe, angle = axis.rsplit("_", 1)
        return self.lobe_index(lobe), ("theta", "phi").index(angle)

    def _axis_loop(self, function: str, axis: str, theta_r, x) -> np.ndarray:
        inputs = _floats(theta_r, x)
        out = np.empty_like(inputs[0])
        self._loop(function, self._axis(axis), *inputs, out)
        return out

    def _loop(self, function: str, which: tuple, *arrays: np.ndarray) -> None:
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]
        getattr(loops(), function)(self.pointer, *which, ctypes.c_size_t(arrays[0].size), *pointers)


def _floats(*values) -> list[np.ndarray]:
    arrays = np.broadcast_arrays(*(np.asarray(value, np.float32) for value in values))
    return [np.array(np.atleast_1d(array), np.float32, order="C") for array in arrays]


def builtin(name: str) -> Model:
    """A compiled-in model."""
    pointer = core().hairlut_builtin(name.encode())
    assert pointer, name
    return Model(pointer, name, owned=False)


def load(directory: Path) -> Model:
    """A model from table files; LoadError if they are refused."""
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(MESSAGE_SIZE)
    result = exr().hairlut_load_with(os.fsencode(directory), None, ctypes.byref(out), message)
    if result != OK:
        assert out.value is None
        raise LoadError(result, message.value.decode(errors="replace"))
    return Model(out.value, str(directory), owned=True)
