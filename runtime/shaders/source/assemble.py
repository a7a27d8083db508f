#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes hairlut.glsl, hairlut.hlsl, hairlut.cuh and hairlut.wgsl from one body and a prologue for each.

GLSL, HLSL, CUDA and C++ take the body as it stands. For WGSL it is rewritten, which is possible since it
keeps to a few forms: declarations of one variable each, `c ? a : b` only as the whole value of a statement,
braces after every if, no assignment to a parameter.

python3 runtime/shaders/source/assemble.py [FOLDER]     writes to runtime/shaders, or to FOLDER
"""

import re
import sys
from pathlib import Path

HERE = Path(__file__).parent
EPILOGUES = {
    "glsl": "\n#endif\n",
    "hlsl": "\n#endif\n",
    "cuh": "\n} // namespace hairlut_gpu\n\n#endif\n",
    "wgsl": "",
}
TYPES = {"float": "f32", "int": "i32", "bool": "bool", "hairlut_float4": "vec4f", "HAIRLUT_SOURCE": "i32"}


def assembled(language: str) -> str:
    """The text of hairlut.<language>."""
    prologue, body = ((HERE / name).read_text() for name in (f"prologue.{language}", "body.inl"))
    _, body = body.split("\n", 1)  # the licence, which the prologue has too
    return prologue + "\n" + (wgsl(body) if language == "wgsl" else body) + EPILOGUES[language]


def wgsl(body: str) -> str:
    """The body in WGSL."""
    body = re.sub(r"HAIRLUT_CONST (\w+) (\w+) = ", lambda m: f"const {m[2]}: {_type(m[1])} = ", body)
    body = re.sub(r"^struct (\w+) \{\n(.*?)^\};", _struct, body, flags=re.M | re.S)
    body = re.sub(r"^HAIRLUT_FN (\w+) (\w+)\((.*?)\)\n\{\n(.*?)^\}", _function, body, flags=re.M | re.S)
    left = re.findall(
        r"HAIRLUT_(?!FETCH|HEADER)\w+|[^?]\?[^?\n]* : .*", re.sub(r"//.*|/\*.*?\*/", "", body, flags=re.S)
    )
    if left:
        raise SystemExit(f"body.inl has a form that WGSL cannot take: {left[0]}")
    return body.replace("HAIRLUT_FETCH", "hairlut_fetch").replace("HAIRLUT_HEADER", "hairlut_header")


def _type(name: str) -> str:
    return TYPES.get(name, name)


def _struct(match: re.Match) -> str:
    fields = []
    for kind, name, count, remark in re.findall(r"    (\w+) (\w+)(?:\[(\w+)\])?; *(.*)", match[2]):
        kind = f"array<{_type(kind)}, {count}>" if count else _type(kind)
        fields.append((f"    {name}: {kind},", remark))
    width = max(len(field) for field, remark in fields if remark) if any(r for _, r in fields) else 0
    lines = (f"{field:{width}} {remark}".rstrip() for field, remark in fields)
    return f"struct {match[1]} {{\n" + "\n".join(lines) + "\n}"


def _function(match: re.Match) -> str:
    kind, name, parameters, text = match.groups()
    typed = (f"{variable}: {_type(of)}" for of, variable in re.findall(r"(\w+) (\w+)", parameters))
    return f"{_broken(f'fn {name}(', list(typed), f') -> {_type(kind)} {{')}\n{_statements(text)}}}"


def _broken(start: str, parts: list[str], end: str, width: int = 127) -> str:
    """A parameter list, in lines of at most that width."""
    lines = [start]
    for k, part in enumerate(parts or [""]):
        part += ", " if k + 1 < len(parts) else end
        if len(lines[-1] + part.rstrip()) > width:
            lines[-1] = lines[-1].rstrip()
            lines.append(" " * len(start))
        lines[-1] += part
    return "\n".join(lines)


def _statements(text: str) -> str:
    def declared(m: re.Match) -> str:
        space, kind, name, value = m.groups()
        if value is None:
            return f"{space}var {name}: {_type(kind)};"
        changes = re.search(rf"^\s*{name}(?:\.\w+)?(?:\[\w+\])? [-+*/]?= |\+\+{name}\b", text, flags=re.M)
        return f"{space}{'var' if changes else 'let'} {name} = {value};"

    def chosen(m: re.Match) -> str:
        return f"{m[1]}select({m[4]}, {m[3]}, {m[2]});"

    text = text.replace("HAIRLUT_PRECISE ", "")
    text = re.sub(r"for \(int (\w+) = (\d); (.*?); \+\+\1\)", r"for (var \1 = \2; \3; \1++)", text)
    text = re.sub(r"^( +)(?!return\b)([A-Za-z_]\w*) (\w+)(?: = ([^;]*))?;", declared, text, flags=re.M)
    text = re.sub(r"((?: = | \+= |return ))([^;?]*?)\s+\? ([^;?:]*) : ([^;?:]*);", chosen, text)
    return re.sub(r"\b(int|float)\(", lambda m: f"{_type(m[1])}(", text)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent
    for language in EPILOGUES:
        (folder / f"hairlut.{language}").write_text(assembled(language))


if __name__ == "__main__":
    main()
