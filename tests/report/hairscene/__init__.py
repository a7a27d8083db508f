# SPDX-License-Identifier: BSD-3-Clause
"""Mitsuba with the plugin `hairlut`: the hair scene, its renders, and the page that reports them."""
