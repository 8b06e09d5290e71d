// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/middle.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"

// How steeply the depth rises towards the middle, at least.
static const double STEEP = 0.5;

// Where the way goes on from each position, and how steep that is.
typedef struct Ways {
  int *next;    // itself: it ends there                    (position_count)
  double *rise; // of the depth along it: by length, from the surface in all
} Ways;

static void offer(const ContactMesh *mesh, const double *rest, int from, int to, Ways *ways) {
  double rise = mesh->depths[to] - mesh->depths[from];
  if (!(rise > 0)) return;
  if (mesh->depths[from] > 0) {
    rise /= vec3_length(vec3_sub(vec3_at(rest + 3 * (size_t)to), vec3_at(rest + 3 * (size_t)from)));
    if (!(rise >= STEEP)) return;
  }
  if (rise > ways->rise[from]) ways->rise[from] = rise, ways->next[from] = to;
}

// Depths rise along a way, so it has an end.
static double depth_of_end(const ContactMesh *mesh, const Ways *ways, int from) {
  while (ways->next[from] != from) from = ways->next[from];
  return mesh->depths[from];
}

static void find(const ContactMesh *mesh, const int (*tets)[4], const double *rest, Ways *ways,
                 double *middles) {
  for (int p = 0; p < mesh->position_count; p++) ways->next[p] = p;
  for (int cell = 0; cell < mesh->cell_count; cell++)
    for (int v = 0; v < 4; v++)
      for (int w = 0; w < 4; w++) offer(mesh, rest, mesh->cells[cell][v], mesh->cells[cell][w], ways);
  for (int cell = 0; cell < mesh->cell_count; cell++) {
    middles[cell] = 0;
    const int *vertices = tets[contact_mesh_tet(mesh, cell)];
    for (int v = 0; v < 4; v++) {
      middles[cell] = fmax(middles[cell], depth_of_end(mesh, ways, mesh->cells[cell][v]));
      middles[cell] = fmax(middles[cell], depth_of_end(mesh, ways, vertices[v]));
    }
  }
}

Status contact_middle_find(const ContactMesh *mesh, const int (*tets)[4], const double *rest,
                           double **middles) {
  size_t positions = (size_t)mesh->position_count;
  Ways ways = {.next = memory_zeroed(positions, sizeof *ways.next),
               .rise = memory_zeroed(positions, sizeof *ways.rise)};
  *middles = memory_zeroed((size_t)mesh->cell_count, sizeof **middles);
  bool has_room = ways.next && ways.rise && *middles;
  if (has_room) find(mesh, tets, rest, &ways, *middles);
  memory_free(ways.next);
  memory_free(ways.rise);
  return has_room ? STATUS_OK : status_no_memory("the middles of bodies");
}
