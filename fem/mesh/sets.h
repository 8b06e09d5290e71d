// SPDX-License-Identifier: GPL-3.0-or-later
// Disjoint sets of 0 … count − 1: an array of parents where a root, the smallest of its set, is its own.
#ifndef TETLAP_FEM_MESH_SETS_H
#define TETLAP_FEM_MESH_SETS_H

#include <stdbool.h>

int *fem_mesh_sets_new(int count); // each alone; owned by the caller (memory_free). NULL: no memory
int fem_mesh_sets_find(int *parent, int i);
bool fem_mesh_sets_join(int *parent, int i, int j); // whether they were apart

#endif
