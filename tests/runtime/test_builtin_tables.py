"""runtime/src/builtin_tables.c, committed so that a C build needs no Python, is what luts/ exports to."""

from runtime.c_library import MODELS, ROOT, RUNTIME, run, tool


def test_exporting_the_tables_again_gives_the_same_bytes(tmp_path):
    directories = [f"luts/{model}" for model in MODELS]
    out = tmp_path / "builtin_tables.c"
    run(tool("hairlut"), "export", *directories, "--to", "c", "--out", out, cwd=ROOT)
    assert out.read_bytes() == (RUNTIME / "src" / "builtin_tables.c").read_bytes(), (
        f"out of date: hairlut export {' '.join(directories)} --to c --out runtime/src/builtin_tables.c"
    )
