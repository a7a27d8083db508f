# SPDX-License-Identifier: BSD-3-Clause
"""Hair in Mitsuba for pages and tests: a scene of strands, the engine's own hair and what it draws."""
