# SPDX-License-Identifier: GPL-3.0-or-later
import a_module_that_nobody_has


def model(pairs):
    return a_module_that_nobody_has.volume(pairs)
