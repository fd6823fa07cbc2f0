# SPDX-License-Identifier: Apache-2.0
# gdb reads this file if it starts in this folder and add-auto-load-safe-path permits it (docs/debugging.md, "C++").
source scripts/gdb_printers.py
