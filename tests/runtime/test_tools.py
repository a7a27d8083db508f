# SPDX-License-Identifier: BSD-3-Clause
"""`make` on machines where something is missing: what is said, and that nothing is left behind.

Each case runs the scripts in a folder of their own, with a PATH of the programs that the machine has.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from runtime.c_library import RUNTIME, tool

UTILITIES = "sh cat cp dirname env find grep head id mkdir mktemp rm sed tail"


class Machine:
    """A folder with the scripts and a bin/ that is its whole PATH."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.bin = folder, folder / "bin"
        for name in ("runtime", "precompute", "bin"):
            (folder / name).mkdir()
        for script in ("tools.sh", "packages.sh"):
            shutil.copy(RUNTIME / script, folder / "runtime")
        (folder / "precompute" / "pyproject.toml").touch()
        for name in UTILITIES.split():
            (self.bin / name).symlink_to(shutil.which(name))

    def program(self, name: str, text: str) -> None:
        """A shell script on the PATH, in the place of a link to the real one if there is one."""
        (self.bin / name).unlink(missing_ok=True)
        (self.bin / name).write_text(f"#!/bin/sh\n{text}\n")
        (self.bin / name).chmod(0o755)

    def has(self, name: str, path: str) -> None:
        """A program of this machine on the PATH."""
        self.program(name, f'exec "{path}" "$@"')

    def run(self, script: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            ["/bin/sh", self.folder / "runtime" / script, *arguments],
            env={"PATH": str(self.bin), "TMPDIR": str(self.folder)} | environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )

    def refuses(self, *arguments: str, **environment: str) -> str:
        """What tools.sh says before it ends with 2, having written nothing."""
        before = sorted(self.folder.rglob("*"))
        done = self.run("tools.sh", *arguments, **environment)
        assert done.returncode == 2, done.stdout + done.stderr
        assert sorted(self.folder.rglob("*")) == before
        return done.stderr


@pytest.fixture
def machine(tmp_path) -> Machine:
    return Machine(tmp_path)


@pytest.fixture
def complete(machine) -> Machine:
    """With Python and a compiler."""
    machine.has("python3", sys.executable)
    compiler = os.path.realpath(tool("cc"))
    machine.program("cc", f'PATH="{os.environ["PATH"]}" exec "{compiler}" "$@"')
    return machine


def test_a_complete_machine_is_content(complete):
    done = complete.run("tools.sh", "python3")
    assert (done.returncode, done.stderr) == (0, "")


def test_without_python(machine):
    assert "there is no program 'python3': apt-get install python3" in machine.refuses("python3")


@pytest.mark.parametrize("said", ["echo hello", "exit 3", "echo Python 2.7"])
def test_what_is_no_python(machine, said):
    machine.program("other", said)
    assert "'other' is no Python 3" in machine.refuses("other")


def test_an_old_python(machine):
    machine.program("python3", "echo Python 3.9")
    assert "'python3' is Python 3.9, expected 3.11 or newer" in machine.refuses("python3")


def test_python_without_venv(machine):
    machine.program("python3", 'case "$2" in *venv*) exit 1;; esac; echo Python 3.13')
    assert "apt-get install python3-venv" in machine.refuses("python3")


def test_python_is_not_checked_once_the_environment_exists(complete):
    os.utime(complete.folder / "precompute" / "pyproject.toml", (1, 1))
    ready = complete.folder / ".ready"
    ready.touch()
    assert complete.run("tools.sh", "none", str(ready)).returncode == 0


def test_without_a_compiler(complete):
    (complete.bin / "cc").unlink()
    assert "there is no C compiler (no cc, gcc or clang): apt-get install gcc" in complete.refuses("python3")


def test_a_compiler_that_is_named_and_absent(complete):
    assert "CC is 'tcc -m32', and there is no such program" in complete.refuses("python3", CC="tcc -m32")


def test_without_the_headers_of_the_c_library(complete):
    complete.program("cc", 'echo "x.c:1:10: fatal error: stdio.h: No such file or directory" >&2; exit 1')
    said = complete.refuses("python3")
    assert "fatal error: stdio.h" in said
    assert "apt-get install libc6-dev" in said


def test_a_compiler_that_does_not_link(complete):
    complete.program("cc", 'case "$1" in -c) exit 0;; esac; echo "ld: cannot find Scrt1.o" >&2; exit 1')
    assert "does not link an empty program: ld: cannot find Scrt1.o" in complete.refuses("python3")


@pytest.mark.parametrize(
    ("compiler", "kept"), [("CMAKE_C_COMPILER-NOTFOUND", False), ("/gone/gcc", False), ("{cc}", True)]
)
def test_a_build_folder_without_a_compiler_is_configured_anew(complete, compiler, kept):
    cache = complete.folder / "build" / "runtime" / "CMakeCache.txt"
    (cache.parent / "CMakeFiles").mkdir(parents=True)
    cache.write_text(f"CMAKE_C_COMPILER:FILEPATH={compiler.format(cc=complete.bin / 'cc')}\n")
    assert complete.run("tools.sh", "python3").returncode == 0
    assert cache.exists() == kept == (cache.parent / "CMakeFiles").exists()


def debian(machine: Machine, refusing: str = "none") -> Path:
    """Makes it a Debian machine as root, without packages; returns the log of what was installed. apt knows
    all packages but libclang-rt-dev, and fails where `refusing` is among what it is to install."""
    log = machine.folder / "installed"
    machine.program("dpkg-query", "exit 1")
    machine.program("id", "echo 0")
    machine.program("apt-cache", '[ "$2" != libclang-rt-dev ]')
    install = f'case " $* " in *" {refusing} "*) exit 100;; esac; echo "$@" >> "{log}"'
    machine.program("apt-get", f'[ "$1" = update ] && exit 0\n{install}')
    return log


def test_a_package_that_the_release_lacks_does_not_lose_the_others(machine):
    log = debian(machine)
    done = machine.run("packages.sh", "extras")
    assert done.returncode == 0
    assert "this release has no package libclang-rt-dev: left out" in done.stdout
    assert {"clang", "valgrind"} <= set(log.read_text().split())
    assert "libclang-rt-dev" not in log.read_text()


def test_a_package_that_cannot_be_installed_does_not_lose_the_others(machine):
    log = debian(machine, refusing="chromium")
    done = machine.run("packages.sh", "extras")
    assert done.returncode == 0
    assert "could not install chromium" in done.stdout
    assert {"clang", "valgrind"} <= set(log.read_text().split())


def test_without_being_root_the_line_is_printed(machine):
    debian(machine)
    machine.program("id", "echo 1000")
    done = machine.run("packages.sh", "base")
    assert "To install: sudo apt-get install" in done.stdout
    assert done.returncode == 0
