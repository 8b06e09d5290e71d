# SPDX-License-Identifier: Apache-2.0
"""Overlap volumes in this process, by the shared library, and networks as arrays. Knows nothing of runs."""
