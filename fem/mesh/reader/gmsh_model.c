// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/gmsh_model.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fem/mesh/reader/shell.h"

enum { GMSH_TRIANGLE = 2, GMSH_TETRAHEDRON = 4, GMSH_SECOND_ORDER_TETRAHEDRON = 11 };

// gmsh's order of the nodes on edges (gmsh reference manual, "Node ordering", Tetrahedron10): 01, 12, 02, 03,
// 23, 13; here as numbers of fem_quadratic_edges. VTK (type 24) and MEDIT (TetrahedraP2) have the last two
// the other way round, which gmsh mends as it reads them.
static const int edge_order[6] = {0, 3, 1, 2, 5, 4};

// The elements of one type, all entities together: tags and corners as gmsh numbers them.
typedef struct Elements {
  size_t *tags, *nodes;
  size_t count, node_count;
} Elements;

static Status get_elements(const FemMeshGmshLibrary *gmsh, Elements *elements, int type) {
  int error = 0;
  *elements = (Elements){0};
  gmsh->ModelMeshGetElementsByType(type, &elements->tags, &elements->count, &elements->nodes,
                                   &elements->node_count, -1, 0, 1, &error);
  return error ? fem_mesh_gmsh_library_fail(gmsh, "list the elements") : STATUS_OK;
}

static void free_elements(const FemMeshGmshLibrary *gmsh, Elements *elements) {
  gmsh->Free(elements->tags), gmsh->Free(elements->nodes);
}

// A number of the file, and the place among the nodes or elements that it has.
typedef struct TagPlace {
  size_t tag;
  int place;
} TagPlace;

typedef struct Nodes {
  size_t *tags; // gmsh's
  double *positions;
  int count;
  TagPlace *places; // ours, sorted
} Nodes;

static int compare_tag(const void *left, const void *right) {
  const TagPlace *a = left, *b = right;
  return (a->tag > b->tag) - (a->tag < b->tag);
}

// Sorted; NULL: no memory.
static TagPlace *sort_tags(const size_t *tags, size_t count) {
  TagPlace *places = memory_zeroed(count, sizeof *places);
  for (size_t k = 0; places && k < count; k++) places[k] = (TagPlace){tags[k], (int)k};
  if (places) qsort(places, count, sizeof *places, compare_tag);
  return places;
}

// −1: there is no such number.
static int find_place(const TagPlace *places, size_t count, size_t tag) {
  TagPlace wanted = {tag, 0};
  const TagPlace *found = bsearch(&wanted, places, count, sizeof wanted, compare_tag);
  return found ? found->place : -1;
}

static Status get_nodes(const FemMeshGmshLibrary *gmsh, Nodes *nodes) {
  size_t count = 0, position_count = 0, parameter_count = 0;
  double *parameters = NULL;
  int error = 0;
  *nodes = (Nodes){0};
  gmsh->ModelMeshGetNodes(&nodes->tags, &count, &nodes->positions, &position_count, &parameters,
                          &parameter_count, -1, -1, 0, 0, &error);
  gmsh->Free(parameters);
  if (error) return fem_mesh_gmsh_library_fail(gmsh, "list the nodes");
  if (count > FEM_MESH_MAX_VERTICES)
    return status_fail(STATUS_INPUT, "%zu vertices are more than the %d that can be numbered", count,
                       FEM_MESH_MAX_VERTICES);
  nodes->count = (int)count;
  nodes->places = sort_tags(nodes->tags, count);
  return nodes->places ? STATUS_OK : status_no_memory("the vertex numbers of a mesh");
}

static void free_nodes(const FemMeshGmshLibrary *gmsh, Nodes *nodes) {
  gmsh->Free(nodes->tags), gmsh->Free(nodes->positions);
  memory_free(nodes->places);
}

static int place_of(const Nodes *nodes, size_t tag) {
  return find_place(nodes->places, (size_t)nodes->count, tag);
}

// Elements (count, corner_count) as places of their nodes.
static Status place_corners(const Nodes *nodes, const Elements *elements, size_t corner_count, int *corners) {
  for (size_t e = 0; e < elements->count; e++)
    for (size_t k = 0; k < corner_count; k++) {
      size_t tag = elements->nodes[corner_count * e + k];
      int place = place_of(nodes, tag);
      if (place < 0)
        return status_fail(STATUS_INPUT, "element %zu names node %zu, which is not there", elements->tags[e],
                           tag);
      corners[corner_count * e + k] = place;
    }
  return STATUS_OK;
}

// Refuses what is three-dimensional but no tetrahedron of the first two orders, by name.
static Status refuse_type(const FemMeshGmshLibrary *gmsh, int type) {
  char *name = NULL;
  double *local = NULL;
  size_t local_count = 0;
  int dimension = 0, order = 0, node_count = 0, primary_count = 0, error = 0;
  gmsh->ModelMeshGetElementProperties(type, &name, &dimension, &order, &node_count, &local, &local_count,
                                      &primary_count, &error);
  gmsh->Free(local);
  Elements elements;
  Status status = get_elements(gmsh, &elements, type);
  if (status != STATUS_OK) {
    gmsh->Free(name);
    return status;
  }
  status_fail(STATUS_INPUT,
              "has %zu elements of type '%s' (%d nodes), the first is element %zu; only tetrahedra of 4 or "
              "10 nodes are known: mesh it anew with those (element order 1 or 2, no recombination)",
              elements.count, error ? "unknown" : name, node_count, elements.count ? elements.tags[0] : 0);
  free_elements(gmsh, &elements);
  gmsh->Free(name);
  return STATUS_INPUT;
}

static Status refuse_without_tets(const FemMeshGmshLibrary *gmsh) {
  Elements triangles;
  TRY(get_elements(gmsh, &triangles, GMSH_TRIANGLE));
  free_elements(gmsh, &triangles);
  if (triangles.count == 0)
    return status_fail(STATUS_INPUT,
                       "has no tetrahedra; give a volume mesh, or a .stl or .geo to be meshed in place");
  return status_fail(
      STATUS_INPUT,
      "has no tetrahedra, only a surface of %zu triangles; give that surface as a .stl to be meshed in "
      "place, or mesh its volume first",
      triangles.count);
}

static Status refuse_two_orders(void) {
  return status_fail(STATUS_INPUT,
                     "has tetrahedra of 4 and of 10 nodes; mesh it anew with one element order");
}

// gmsh 4.8 takes all tetrahedra of a volume for what the first one is, and writes beyond its lists where
// others have more nodes. So those that it makes room for must be as many as are of that type.
static Status check_one_order(const FemMeshGmshLibrary *gmsh, int type) {
  int *types = NULL, error = 0;
  size_t *room = NULL, room_count = 0, *none = NULL, none_count = 0, type_count = 0, **element_tags = NULL;
  size_t *element_counts = NULL, list_count = 0, **node_tags = NULL, *node_counts = NULL, node_list_count = 0;
  size_t found = 0;
  gmsh->ModelMeshPreallocateElementsByType(type, 1, 0, &room, &room_count, &none, &none_count, -1, &error);
  if (!error)
    gmsh->ModelMeshGetElements(&types, &type_count, &element_tags, &element_counts, &list_count, &node_tags,
                               &node_counts, &node_list_count, 3, -1, &error);
  for (size_t k = 0; k < list_count; k++) found += element_counts[k], gmsh->Free(element_tags[k]);
  for (size_t k = 0; k < node_list_count; k++) gmsh->Free(node_tags[k]);
  gmsh->Free(room), gmsh->Free(none), gmsh->Free(types), gmsh->Free(element_tags), gmsh->Free(element_counts),
      gmsh->Free(node_tags), gmsh->Free(node_counts);
  if (error) return fem_mesh_gmsh_library_fail(gmsh, "count the elements");
  return found == room_count ? STATUS_OK : refuse_two_orders();
}

// The type of the tetrahedra, which must be all that there is.
static Status find_type(const FemMeshGmshLibrary *gmsh, int *type) {
  int *types = NULL, error = 0;
  size_t count = 0;
  gmsh->ModelMeshGetElementTypes(&types, &count, 3, -1, &error);
  if (error) return fem_mesh_gmsh_library_fail(gmsh, "list the types of elements");
  Status status = count ? STATUS_OK : refuse_without_tets(gmsh);
  for (size_t k = 0; k < count && status == STATUS_OK; k++)
    if (types[k] != GMSH_TETRAHEDRON && types[k] != GMSH_SECOND_ORDER_TETRAHEDRON)
      status = refuse_type(gmsh, types[k]);
  if (status == STATUS_OK && count > 1) status = refuse_two_orders();
  if (status == STATUS_OK) status = check_one_order(gmsh, types[0]);
  if (status == STATUS_OK) *type = types[0];
  gmsh->Free(types);
  return status;
}

// Splits ten nodes of each tetrahedron into corners and the nodes on its edges.
static Status take_second_order(FemMeshSource *source, const Nodes *nodes, const Elements *tets) {
  int(*all)[10] = memory_zeroed(tets->count, sizeof *all);
  source->middles = memory_zeroed(tets->count, sizeof *source->middles);
  Status status = all && source->middles ? place_corners(nodes, tets, 10, &all[0][0])
                                         : status_no_memory("a second-order mesh");
  for (size_t t = 0; t < tets->count && status == STATUS_OK; t++) {
    memcpy(source->tets[t], all[t], sizeof source->tets[t]);
    for (int k = 0; k < 6; k++) source->middles[t][edge_order[k]] = all[t][4 + k];
  }
  memory_free(all);
  return status;
}

static Status take_tets(FemMeshSource *source, const Nodes *nodes, const Elements *tets, int type) {
  if (tets->count > FEM_MESH_MAX_TETS)
    return status_fail(STATUS_INPUT, "%zu tetrahedra are more than the %d that can be numbered", tets->count,
                       FEM_MESH_MAX_TETS);
  source->vertex_count = nodes->count, source->tet_count = (int)tets->count;
  source->positions = memory_copy(nodes->positions, (size_t)nodes->count, sizeof(double[3]));
  source->tets = memory_zeroed(tets->count, sizeof(int[4]));
  source->vertex_tags = memory_zeroed((size_t)nodes->count, sizeof(long long));
  source->tet_tags = memory_zeroed(tets->count, sizeof(long long));
  if (!source->positions || !source->tets || !source->vertex_tags || !source->tet_tags)
    return status_no_memory("a mesh");
  for (int v = 0; v < nodes->count; v++) source->vertex_tags[v] = (long long)nodes->tags[v];
  for (size_t t = 0; t < tets->count; t++) source->tet_tags[t] = (long long)tets->tags[t];
  return type == GMSH_TETRAHEDRON ? place_corners(nodes, tets, 4, &source->tets[0][0])
                                  : take_second_order(source, nodes, tets);
}

// What groups are made of.
typedef struct Content {
  const Nodes *nodes;
  const TagPlace *tets; // sorted (tet_count)
  size_t tet_count;
} Content;

// The group of that name, which is made if it is new: "top" may be a surface and a curve. NULL: no memory.
static FemMeshGroup *take_group(FemMeshSource *source, const char *name) {
  FemMeshGroup *group = source->groups;
  for (int g = 0; g < source->group_count && strcmp(group->name, name) != 0; g++) group++;
  if (group < source->groups + source->group_count) return group;
  group->name = memory_copy(name, strlen(name) + 1, 1);
  if (!group->name) return NULL;
  source->group_count++;
  return group;
}

static Status add_nodes(FemMeshGroup *group, const Nodes *nodes, const size_t *tags, size_t count) {
  if (count > (size_t)(INT_MAX - group->vertex_count))
    return status_fail(STATUS_INPUT, "the group '%s' has more nodes than can be numbered", group->name);
  size_t capacity = (size_t)group->vertex_count;
  if (!memory_reserve((void **)&group->vertices, &capacity, capacity + count, sizeof(int)))
    return status_no_memory("the vertices of a group");
  for (size_t k = 0; k < count; k++) {
    int place = place_of(nodes, tags[k]);
    if (place >= 0) group->vertices[group->vertex_count++] = place;
  }
  return STATUS_OK;
}

static Status add_tets(FemMeshGroup *group, const Content *content, const size_t *tags, size_t count) {
  if (count > (size_t)(INT_MAX - group->tet_count))
    return status_fail(STATUS_INPUT, "the group '%s' has more elements than can be numbered", group->name);
  size_t capacity = (size_t)group->tet_count;
  if (!memory_reserve((void **)&group->tets, &capacity, capacity + count, sizeof(int)))
    return status_no_memory("the elements of a group");
  for (size_t k = 0; k < count; k++) {
    int place = find_place(content->tets, content->tet_count, tags[k]);
    if (place >= 0) group->tets[group->tet_count++] = place;
  }
  return STATUS_OK;
}

// The nodes of an entity's elements, those on its boundary included, where `nodes_too`, and its tetrahedra.
static Status add_entity(const FemMeshGmshLibrary *gmsh, FemMeshGroup *group, const Content *content,
                         int dimension, int tag, bool nodes_too) {
  int *types = NULL, error = 0;
  size_t type_count = 0, **element_tags = NULL, *element_counts = NULL, list_count = 0;
  size_t **node_tags = NULL, *node_counts = NULL, node_list_count = 0;
  gmsh->ModelMeshGetElements(&types, &type_count, &element_tags, &element_counts, &list_count, &node_tags,
                             &node_counts, &node_list_count, dimension, tag, &error);
  Status status = error ? fem_mesh_gmsh_library_fail(gmsh, "list the elements of an entity") : STATUS_OK;
  for (size_t k = 0; k < node_list_count; k++) {
    if (status == STATUS_OK && nodes_too)
      status = add_nodes(group, content->nodes, node_tags[k], node_counts[k]);
    gmsh->Free(node_tags[k]);
  }
  for (size_t k = 0; k < list_count; k++) {
    if (status == STATUS_OK && dimension == 3)
      status = add_tets(group, content, element_tags[k], element_counts[k]);
    gmsh->Free(element_tags[k]);
  }
  gmsh->Free(types), gmsh->Free(element_tags), gmsh->Free(element_counts), gmsh->Free(node_tags),
      gmsh->Free(node_counts);
  return status;
}

static Status add_volumes(const FemMeshGmshLibrary *gmsh, FemMeshGroup *group, const Content *content,
                          int tag) {
  int *entities = NULL, error = 0;
  size_t count = 0;
  gmsh->ModelGetEntitiesForPhysicalGroup(3, tag, &entities, &count, &error);
  Status status =
      error ? fem_mesh_gmsh_library_fail(gmsh, "list the volumes of a physical group") : STATUS_OK;
  for (size_t k = 0; k < count && status == STATUS_OK; k++)
    status = add_entity(gmsh, group, content, 3, entities[k], false);
  gmsh->Free(entities);
  return status;
}

static Status add_physical_group(const FemMeshGmshLibrary *gmsh, FemMeshGroup *group, const Content *content,
                                 int dimension, int tag) {
  size_t *tags = NULL, count = 0, position_count = 0;
  double *positions = NULL;
  int error = 0;
  gmsh->ModelMeshGetNodesForPhysicalGroup(dimension, tag, &tags, &count, &positions, &position_count, &error);
  Status status = error ? fem_mesh_gmsh_library_fail(gmsh, "list the nodes of a physical group")
                        : add_nodes(group, content->nodes, tags, count);
  gmsh->Free(tags), gmsh->Free(positions);
  return status == STATUS_OK && dimension == 3 ? add_volumes(gmsh, group, content, tag) : status;
}

// One group each for (dimension, tag) pairs, by their names or "surface_7".
static Status take_group_list(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, const Content *content,
                              const int *pairs, size_t count, bool are_physical) {
  static const char *const kinds[] = {"point", "curve", "surface", "volume"};
  source->groups = memory_zeroed(count, sizeof *source->groups);
  if (!source->groups) return status_no_memory("the groups of a mesh");
  for (size_t k = 0; k < count; k++) {
    int dimension = pairs[2 * k], tag = pairs[2 * k + 1], error = 0;
    char *given = NULL, name[32];
    snprintf(name, sizeof name, "%s_%d", kinds[dimension], tag);
    if (are_physical) gmsh->ModelGetPhysicalName(dimension, tag, &given, &error);
    const char *chosen = given && given[0] ? given : name;
    FemMeshGroup *group = take_group(source, chosen);
    Status status = !group         ? status_no_memory("the name of a group")
                    : are_physical ? add_physical_group(gmsh, group, content, dimension, tag)
                                   : add_entity(gmsh, group, content, dimension, tag, true);
    gmsh->Free(given);
    TRY(status);
  }
  return STATUS_OK;
}

static Status list_groups(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, const Content *content) {
  int *pairs = NULL, error = 0;
  size_t count = 0;
  gmsh->ModelGetPhysicalGroups(&pairs, &count, -1, &error);
  bool are_physical = !error && count > 0;
  if (!error && !are_physical) {
    gmsh->Free(pairs), pairs = NULL;
    gmsh->ModelGetEntities(&pairs, &count, -1, &error);
  }
  Status status = error ? fem_mesh_gmsh_library_fail(gmsh, "list the groups")
                        : take_group_list(gmsh, source, content, pairs, count / 2, are_physical);
  gmsh->Free(pairs);
  return status;
}

static Status take_groups(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, const Nodes *nodes,
                          const Elements *tets) {
  TagPlace *places = sort_tags(tets->tags, tets->count);
  if (!places) return status_no_memory("the elements of a mesh");
  Status status = list_groups(gmsh, source, &(Content){nodes, places, tets->count});
  memory_free(places);
  return status;
}

Status fem_mesh_gmsh_model_take(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, bool has_groups) {
  Nodes nodes = {0};
  Elements tets = {0};
  int type = GMSH_TETRAHEDRON;
  Status status = find_type(gmsh, &type);
  if (status == STATUS_OK) status = get_nodes(gmsh, &nodes);
  if (status == STATUS_OK) status = get_elements(gmsh, &tets, type);
  if (status == STATUS_OK) status = take_tets(source, &nodes, &tets, type);
  if (status == STATUS_OK && has_groups) status = take_groups(gmsh, source, &nodes, &tets);
  free_elements(gmsh, &tets);
  free_nodes(gmsh, &nodes);
  return status;
}

Status fem_mesh_gmsh_model_check_shell(const FemMeshGmshLibrary *gmsh, size_t *triangle_count) {
  Nodes nodes = {0};
  Elements elements = {0};
  int *triangles = NULL;
  Status status = get_nodes(gmsh, &nodes);
  if (status == STATUS_OK) status = get_elements(gmsh, &elements, GMSH_TRIANGLE);
  if (status == STATUS_OK) {
    triangles = memory_zeroed(elements.count, sizeof(int[3]));
    status = triangles ? place_corners(&nodes, &elements, 3, triangles) : status_no_memory("a surface");
  }
  if (status == STATUS_OK && elements.count > FEM_MESH_MAX_TETS)
    status = status_fail(STATUS_INPUT, "%zu triangles are more than can be numbered", elements.count);
  if (status == STATUS_OK)
    status = fem_mesh_shell_check(nodes.positions, (int)elements.count, (const int(*)[3])triangles);
  *triangle_count = elements.count;
  memory_free(triangles);
  free_elements(gmsh, &elements);
  free_nodes(gmsh, &nodes);
  return status;
}
