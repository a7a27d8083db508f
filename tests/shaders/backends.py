# SPDX-License-Identifier: BSD-3-Clause
"""Runs the shipped shaders on software drivers: one function a back end, with the same records in and out.

A record holds theta_r, phi_r, offset, lobe; share, u_lobe, u_theta, u_phi; theta_i, phi_i and
the first six parameters. A result holds the samples (theta_i, phi_i, pdf_angle, pdf_solid_angle) of the lobe,
whose parameters have their standard values, of the hair, and of the hair with shares of the record's own; the
three densities of (theta_i, phi_i) and 1 / cos(theta_i); the lobe's two inverted numbers, 0, 0.
"""

import atexit
import base64
import contextlib
import ctypes
import functools
import importlib.util
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
SHADERS = HERE.parents[1] / "runtime" / "shaders"
INPUTS, OUTPUTS = 16, 20
WIDTH = 1024  # of the texture that a stream is
CHROMIUM_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
RUN_IN_BROWSER = """
const done = arguments[arguments.length - 1], [name, ...rest] = Array.from(arguments).slice(0, -1);
(async () => window[name](...rest))().then(done, error => done("error: " + error.message));
"""


@dataclass(frozen=True)
class Scene:
    """stream (n, 4) float32: texels of models; first: where the one to read begins."""

    stream: np.ndarray
    first: int = 0


def assembler():
    """runtime/shaders/source/assemble.py as a module."""
    spec = importlib.util.spec_from_file_location("assemble", SHADERS / "source" / "assemble.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def source(harness: str, shader: str) -> str:
    """A test's main program with the shipped file, and what a test does with a record, pasted in."""
    record = (HERE / "record.inl").read_text()
    if shader.endswith(".wgsl"):
        record = assembler().wgsl(record)
    text = (HERE / harness).read_text().replace("//@hairlut", (SHADERS / shader).read_text())
    return text.replace("//@record", record)


def tool(name: str, package: str) -> str:
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is not installed: apt-get install {package}")
    return path


def run_glsl(scene: Scene, records: np.ndarray) -> np.ndarray:
    """GLSL 4.30 compute on Mesa's llvmpipe, without a display."""
    moderngl = pytest.importorskip("moderngl", reason="moderngl is not installed: pip install moderngl")
    try:
        context = moderngl.create_standalone_context(backend="egl", require=430)
    except Exception as error:  # a bare Exception where libGL is missing
        pytest.skip(f"no OpenGL 4.30 by EGL ({error}): apt-get install libgl1 libegl1 libgl1-mesa-dri")
    shader = context.compute_shader(source("harness.glsl", "hairlut.glsl"))
    size = WIDTH, len(scene.stream) // WIDTH
    texture = context.texture(size, 4, scene.stream.tobytes(), dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.use(0)
    context.buffer(records.tobytes()).bind_to_storage_buffer(0)
    out = context.buffer(reserve=len(records) * OUTPUTS * 4)
    out.bind_to_storage_buffer(1)
    shader["first"], shader["count"] = scene.first, len(records)
    shader.run((len(records) + 63) // 64)
    context.memory_barrier(moderngl.ALL_BARRIER_BITS)
    result = np.frombuffer(out.read(), np.float32).reshape(-1, OUTPUTS)
    context.release()
    return result


def run_wgsl(scene: Scene, records: np.ndarray) -> np.ndarray:
    """WGSL compute on Mesa's lavapipe."""
    return _run_wgpu(scene, records, source("harness.wgsl", "hairlut.wgsl"))


def run_hlsl(scene: Scene, records: np.ndarray) -> np.ndarray:
    """HLSL, compiled to SPIR-V, on Mesa's lavapipe."""
    return _run_wgpu(scene, records, spirv(source("harness.hlsl", "hairlut.hlsl")))


def spirv(hlsl: str) -> bytes:
    glslang = tool("glslangValidator", "glslang-tools")
    with tempfile.TemporaryDirectory() as folder:
        file, out = Path(folder, "harness.comp"), Path(folder, "harness.spv")
        file.write_text(hlsl)
        command = [glslang, "-D", "-V", "-S", "comp", "-e", "main", "-o", str(out), str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return out.read_bytes()


def _run_wgpu(scene: Scene, records: np.ndarray, code: str | bytes) -> np.ndarray:
    wgpu = pytest.importorskip("wgpu", reason="wgpu is not installed: pip install wgpu")
    adapters = [a for a in wgpu.gpu.enumerate_adapters_sync() if a.info["backend_type"] == "Vulkan"]
    if not adapters:
        pytest.skip("no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
    device = min(adapters, key=lambda a: a.info["adapter_type"] != "CPU").request_device_sync()
    hairs = device.create_buffer_with_data(data=scene.stream.tobytes(), usage="STORAGE")
    place = device.create_buffer_with_data(data=_place(scene, records).tobytes(), usage="UNIFORM")
    inputs = device.create_buffer_with_data(data=records.tobytes(), usage="STORAGE")
    out = device.create_buffer(size=len(records) * OUTPUTS * 4, usage="STORAGE | COPY_SRC")
    kinds = [
        {"buffer": {"type": "read-only-storage"}},
        {"buffer": {"type": "uniform"}},
        {"buffer": {"type": "read-only-storage"}},
        {"buffer": {"type": "storage"}},
    ]
    entries = [{"binding": k, "visibility": wgpu.ShaderStage.COMPUTE, **kind} for k, kind in enumerate(kinds)]
    group = device.create_bind_group_layout(entries=entries)
    buffers = [{"buffer": b, "offset": 0, "size": b.size} for b in (hairs, place, inputs, out)]
    resources = [{"binding": k, "resource": r} for k, r in enumerate(buffers)]
    pipeline = device.create_compute_pipeline(
        layout=device.create_pipeline_layout(bind_group_layouts=[group]),
        compute={"module": device.create_shader_module(code=code), "entry_point": "main"},
    )
    encoder = device.create_command_encoder()
    compute = encoder.begin_compute_pass()
    compute.set_pipeline(pipeline)
    compute.set_bind_group(0, device.create_bind_group(layout=group, entries=resources))
    compute.dispatch_workgroups((len(records) + 63) // 64)
    compute.end()
    device.queue.submit([encoder.finish()])
    return np.frombuffer(device.queue.read_buffer(out), np.float32).reshape(-1, OUTPUTS)


@contextlib.contextmanager
def chromium(width: int = 1280, height: int = 900) -> Iterator:
    """A headless Chromium with WebGL2 in software, as a Selenium driver."""
    pytest.importorskip("selenium", reason="selenium is not installed: pip install selenium")
    from selenium.webdriver import Chrome, ChromeOptions, ChromeService

    options = ChromeOptions()
    options.binary_location = tool("chromium", "chromium")
    for flag in (*CHROMIUM_FLAGS, f"--window-size={width},{height}"):
        options.add_argument(flag)
    driver = Chrome(options=options, service=ChromeService(tool("chromedriver", "chromium-driver")))
    try:
        driver.set_script_timeout(120)
        yield driver
    finally:
        driver.quit()


@functools.cache
def _browser():
    """A browser kept until the process ends: starting it takes longer than a shader."""
    open_until_exit = contextlib.ExitStack()
    driver = open_until_exit.enter_context(chromium())
    atexit.register(open_until_exit.close)
    driver.get((HERE / "browser.html").as_uri())
    return driver


def run_webgl(scene: Scene, records: np.ndarray) -> np.ndarray:
    """GLSL ES 3.00 in a browser: transform feedback of a vertex shader."""
    return _run_in_browser("runWebgl", source("harness.es.glsl", "hairlut.glsl"), scene, records)


def run_webgpu(scene: Scene, records: np.ndarray) -> np.ndarray:
    """WGSL compute in a browser."""
    return _run_in_browser("runWebgpu", source("harness.wgsl", "hairlut.wgsl"), scene, records)


def _run_in_browser(function: str, code: str, scene: Scene, records: np.ndarray) -> np.ndarray:
    arguments = [code, _text(scene.stream), scene.first, _text(records), len(records)]
    text = _browser().execute_async_script(RUN_IN_BROWSER, function, *arguments)
    if text in ("error: no WebGL2", "error: no WebGPU"):
        pytest.skip(f"this browser has {text[7:]}")
    assert not text.startswith("error:"), text
    return np.frombuffer(base64.b64decode(text), np.float32).reshape(-1, OUTPUTS)


def _place(scene: Scene, records: np.ndarray) -> np.ndarray:
    return np.int32([scene.first, len(records), 0, 0])


def _text(array: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(array, np.float32).tobytes()).decode()


@functools.cache
def cxx(folder: Path = SHADERS, harness: str = "harness.cpp", defines: tuple[str, ...] = ()) -> ctypes.CDLL:
    """The body of folder/hairlut.cuh compiled as C++17; a warning in the shipped one is an error."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if compiler is None:
        pytest.skip("no C++ compiler: apt-get install g++")
    out = Path(tempfile.mkdtemp(prefix="hairlut"), "body.so")
    flags = ["-std=c++17", "-O1", "-ffp-contract=off", "-shared", "-fPIC", f"-I{folder}", f"-I{HERE}"]
    flags += WARNINGS if folder == SHADERS else []
    flags += [f"-D{define}" for define in defines]
    subprocess.run([compiler, *flags, HERE / harness, "-o", out], check=True)
    return ctypes.CDLL(str(out))


def run_cxx(scene: Scene, records: np.ndarray, folder: Path = SHADERS) -> np.ndarray:
    """C++17."""
    out = np.empty((len(records), OUTPUTS), np.float32)
    stream, records = (np.ascontiguousarray(part, np.float32) for part in (scene.stream, records))
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (stream, records, out)]
    cxx(folder).evaluate(pointers[0], scene.first, ctypes.c_size_t(len(records)), *pointers[1:])
    return out


def run_limited(stream: np.ndarray, records: np.ndarray, lobes: int, *defines: str) -> np.ndarray:
    """(n, 2) densities: see limits.cpp."""
    out = np.empty((len(records), 2), np.float32)
    stream, records = (np.ascontiguousarray(part, np.float32) for part in (stream, records))
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (stream, records, out)]
    library = cxx(SHADERS, "limits.cpp", defines)
    library.evaluate(pointers[0], ctypes.c_size_t(len(records)), pointers[1], lobes, pointers[2])
    return out


def count_fetches(scene: Scene) -> dict[str, int]:
    """Texels read, without those of a model's head: see `count` in harness.cpp."""
    stream, counts = np.ascontiguousarray(scene.stream, np.float32), (ctypes.c_long * 5)()
    cxx().count(ctypes.c_void_p(stream.ctypes.data), scene.first, counts)
    return dict(zip(("sample_lobe", "pdf_lobe", "mixture", "sample_hair", "pdf_hair"), counts, strict=True))


BACKENDS: dict[str, Callable[[Scene, np.ndarray], np.ndarray]] = {
    "C++17": run_cxx,
    "GLSL 4.30, llvmpipe": run_glsl,
    "WGSL, lavapipe": run_wgsl,
    "HLSL as SPIR-V, lavapipe": run_hlsl,
    "GLSL ES 3.00, WebGL2 on SwiftShader": run_webgl,
    "WGSL, WebGPU on SwiftShader": run_webgpu,
}
