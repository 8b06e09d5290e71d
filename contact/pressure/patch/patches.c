// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/patch/patches.h"

#include "base/memory.h"

static int *minus_ones(int count) {
  int *array = memory_zeroed((size_t)count, sizeof(int));
  for (int k = 0; array && k < count; k++) array[k] = -1;
  return array;
}

Status contact_patches_create(ContactPatches *patches, const ContactLayout *layout) {
  *patches = (ContactPatches){0};
  patches->element_of_tet = minus_ones(layout->def.tet_count);
  patches->node_of_vertex = minus_ones(layout->def.vertex_count);
  return patches->element_of_tet && patches->node_of_vertex ? STATUS_OK : status_no_memory("contact patches");
}

void contact_patches_destroy(ContactPatches *patches) {
  memory_free(patches->patches);
  memory_free(patches->elements);
  memory_free(patches->nodes);
  memory_free(patches->pair_elements);
  memory_free(patches->element_of_tet);
  memory_free(patches->node_of_vertex);
  *patches = (ContactPatches){0};
}

// Room for the most that these pairs can bring, so that adding cannot fail halfway.
static Status reserve(ContactPatches *patches, int interface_count, int pair_count) {
  size_t pairs = (size_t)pair_count;
  bool fits =
      memory_reserve((void **)&patches->patches, &patches->patch_capacity, (size_t)interface_count,
                     sizeof(ContactPatch)) &&
      memory_reserve((void **)&patches->elements, &patches->element_capacity, 2 * pairs,
                     sizeof(ContactElement)) &&
      memory_reserve((void **)&patches->nodes, &patches->node_capacity, 8 * pairs, sizeof(ContactNode)) &&
      memory_reserve((void **)&patches->pair_elements, &patches->pair_capacity, pairs,
                     sizeof *patches->pair_elements);
  return fits ? STATUS_OK : status_no_memory("contact patches");
}

static int node_at(ContactPatches *patches, int vertex, int side) {
  int *node = &patches->node_of_vertex[vertex];
  if (*node < 0) {
    *node = patches->node_count++;
    patches->nodes[*node] = (ContactNode){.vertex = vertex, .side = side};
  }
  return *node;
}

static int element_at(ContactPatches *patches, const ContactLayout *layout, int cell, int side) {
  if (cell < 0) return -1;
  int tet = contact_mesh_tet(&layout->mesh, cell);
  int *element = &patches->element_of_tet[tet];
  if (*element < 0) {
    *element = patches->element_count++;
    ContactElement *e = &patches->elements[*element];
    *e = (ContactElement){.tet = tet, .side = side};
    for (int v = 0; v < 4; v++) e->nodes[v] = node_at(patches, layout->def.tets[tet][v], side);
  }
  return *element;
}

static void close_patch(ContactPatches *patches, ContactPatch *patch) {
  patch->pair_end = patches->pair_count;
  patch->element_end = patches->element_count;
  patch->node_end = patches->node_count;
  for (int e = patch->element_begin; e < patch->element_end; e++)
    patches->element_of_tet[patches->elements[e].tet] = -1;
  for (int n = patch->node_begin; n < patch->node_end; n++)
    patches->node_of_vertex[patches->nodes[n].vertex] = -1;
}

Status contact_patches_build(ContactPatches *patches, const ContactLayout *layout, int pair_count,
                             const ContactPair *pairs) {
  patches->patch_count = patches->element_count = patches->node_count = patches->pair_count = 0;
  TRY(reserve(patches, layout->interface_count, pair_count));
  for (int k = 0; k < pair_count;) {
    ContactPatch *patch = &patches->patches[patches->patch_count++];
    *patch = (ContactPatch){.interface = pairs[k].interface,
                            .pair_begin = k,
                            .element_begin = patches->element_count,
                            .node_begin = patches->node_count};
    for (; k < pair_count && pairs[k].interface == patch->interface; k++, patches->pair_count++)
      for (int side = 0; side < 2; side++)
        patches->pair_elements[k][side] = element_at(patches, layout, pairs[k].cells[side], side);
    close_patch(patches, patch);
  }
  return STATUS_OK;
}
