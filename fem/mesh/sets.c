// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/sets.h"

#include "base/memory.h"

int *fem_mesh_sets_new(int count) {
  int *parent = memory_zeroed((size_t)count, sizeof *parent);
  for (int i = 0; parent && i < count; i++) parent[i] = i;
  return parent;
}

int fem_mesh_sets_find(int *parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

bool fem_mesh_sets_join(int *parent, int i, int j) {
  int a = fem_mesh_sets_find(parent, i), b = fem_mesh_sets_find(parent, j);
  parent[a > b ? a : b] = a > b ? b : a;
  return a != b;
}
