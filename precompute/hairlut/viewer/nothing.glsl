#version 300 es
// SPDX-License-Identifier: BSD-3-Clause
void main() {}
