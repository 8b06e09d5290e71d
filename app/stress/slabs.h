// SPDX-License-Identifier: GPL-3.0-or-later
// Two flat slabs whose regular meshes do not match, pressed together and slid by a tenth of an element at a
// time, without friction. The pressure must be even and must not push sideways, although each mesh cuts the
// other into ever different pieces.
//
//         ┌──┬──┬──┬──┬──┐  ──► slides
//      ┌──┼──┼──┼──┼──┼──┼──┐
//      └──┴──┴──┴──┴──┴──┴──┘
//
// Nothing moves by itself: forces are evaluated at given positions.
#ifndef TETLAP_APP_STRESS_SLABS_H
#define TETLAP_APP_STRESS_SLABS_H

#include "app/stress/run.h"

// Presses and slides; keeps the worst of all positions in run->extra.
Status app_stress_slabs_run(AppStressRun *run);
void app_stress_slabs_judge(const AppStressRun *run, AppStressRow *row);

#endif
