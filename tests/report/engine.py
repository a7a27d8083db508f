# SPDX-License-Identifier: BSD-3-Clause
"""The engine with the plugin: what runtime/mitsuba/plugin.py builds."""

import sys

from report.places import ROOT

sys.path.insert(0, str(ROOT / "runtime" / "mitsuba"))

from plugin import DEFAULT_BUILD, PluginBroken, PluginUnavailable, load_engine

__all__ = ["DEFAULT_BUILD", "PluginBroken", "PluginUnavailable", "load_engine"]
