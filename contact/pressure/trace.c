// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/trace.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

static void add(ContactTrace *sum, double weight, const ContactTrace *trace) {
  sum->force += weight * trace->force;
  sum->area += weight * trace->area;
  sum->volume += weight * trace->volume;
}

void contact_trace_add(const ContactLayout *layout, const ContactEvaluation *evaluation,
                       const bool *is_wanted, ContactTrace *traces) {
  for (int k = 0; k < evaluation->pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    const ContactFieldPair *field = &evaluation->fields[k];
    if (is_wanted && !is_wanted[pair->interface]) continue;
    ContactTrace trace = {.force = vec3_length(vec3_at(field->force)),
                          .area = contact_field_area(field),
                          .volume = field->volume};
    for (int side = 0; side < 2 && pair->cells[side] >= 0; side++)
      for (int v = 0; v < 4; v++)
        add(&traces[contact_layout_vertices(layout, pair->cells[side])[v]], fmax(field->weights[side][v], 0),
            &trace);
  }
}

void contact_trace_divide(const ContactLayout *layout, const ContactStars *stars, const ContactTrace *traces,
                          ContactTrace *sums, double *pressures, double *depths) {
  int count = stars->given_vertex_count;
  memset(sums, 0, (size_t)count * sizeof *sums);
  for (int v = 0; v < layout->def.vertex_count; v++) {
    if (layout->mesh.depths[v] > 0 || !(traces[v].area > 0)) continue;
    if (!stars->is_needed) {
      add(&sums[v], 1, &traces[v]);
      continue;
    }
    for (int r = stars->begin[v]; r < stars->begin[v + 1]; r++)
      add(&sums[stars->nodes[r]], fmax(stars->weights[r], 0), &traces[v]);
  }
  for (int v = 0; v < count; v++) {
    bool presses = sums[v].area > 0;
    pressures[v] = presses ? sums[v].force / sums[v].area : 0;
    depths[v] = presses ? sums[v].volume / sums[v].area : 0;
  }
}
