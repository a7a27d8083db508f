# SPDX-License-Identifier: BSD-3-Clause
"""The engine with the plugin that runtime/mitsuba/plugin.py builds, and whether its llvm variants run."""

import subprocess
import sys

from report.places import ROOT

sys.path.insert(0, str(ROOT / "runtime" / "mitsuba"))

from plugin import DEFAULT_BUILD, PluginBroken, PluginUnavailable, load_engine

__all__ = ["DEFAULT_BUILD", "PluginBroken", "PluginUnavailable", "lack_of_llvm", "load_engine"]

PROBE = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
si = mi.SurfaceInteraction3f()
si.wi = mi.Vector3f([0.1, 0.2], 0.3, 0.9)
print(mi.load_dict({"type": "hair"}).sample(mi.BSDFContext(), si, 0.5, mi.Point2f(0.3, 0.6)))
"""


def lack_of_llvm() -> str:
    """Why llvm_ad_rgb does not run the engine's own hair; empty if it does.

    Another process tries it, since an LLVM that lacks instructions ends the one that does.
    """
    tried = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True, check=False)
    if tried.returncode == 0:
        return ""
    said = (tried.stderr.strip().splitlines() or ["no message"])[-1 if "Traceback" in tried.stderr else 0]
    return f"the engine's own hair does not run in llvm_ad_rgb ({said[:100]}): set DRJIT_LIBLLVM_PATH"
