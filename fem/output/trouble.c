// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/trouble.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/tet.h"
#include "base/vec3.h"
#include "fem/mesh/faces.h"
#include "fem/model/compliance/compliance.h"

static const double COVERED = 0.999, DEEP = 0.5, PULL = 0.5, FORCE_FLOOR = 1e-3, SLIVER_SHAPE = 1e-3;

static const struct {
  const char *name, *what, *unit, *advice;
} kinds[FEM_TROUBLE_KIND_COUNT] = {
    {"inverted", "inverted elements", "element", NULL}, // by their law
    {"enclosed", "elements wholly inside another body, which nothing pushes out", "element",
     "try a larger contact.stiffness, a finer mesh or a shorter time.max_step, and bodies apart at the "
     "start"},
    {"wrong_way", "contact pushing the wrong way", "vertex",
     "a body is pierced there: try a larger contact.stiffness, or a shorter time.max_step"},
    {"energy", "energy out of nothing", NULL,
     "try a smaller time.tolerance, or a smaller contact.stiffness; a learned contact.overlap gives some by "
     "itself, which a run with clip shows"},
    {"passed", "bodies passed through each other", "element",
     "try a larger contact.stiffness, a shorter time.max_step, or a thicker or finer body"},
};

// What a refusal asks for, of the stiffness: the energy of a blow is then stored within a third of the depth
// by faces that meet, whose pressure grows with the depth, within a half by edges.
static const double STIFFER = 10;

static Status list_surface(FemTroubleWatch *watch) {
  const FemModel *model = watch->model;
  FemMeshFace *faces;
  TRY(fem_mesh_faces_list(&faces, model->vertex_count, model->tet_count, (const int(*)[4])model->tets));
  int face_count = 4 * model->tet_count;
  watch->triangles = memory_zeroed((size_t)face_count, sizeof *watch->triangles);
  for (int f = 0, end; f < face_count && watch->triangles; f = end) {
    end = fem_mesh_faces_end(faces, face_count, f);
    if (end - f != 1) continue;
    int *triangle = watch->triangles[watch->triangle_count++];
    const int *tet = model->tets[faces[f].tet], *order = tet_faces[faces[f].local];
    for (int k = 0; k < 3; k++) triangle[k] = tet[order[k]];
  }
  memory_free(faces);
  return watch->triangles ? STATUS_OK : status_no_memory("the surface");
}

static Status create(FemTroubleWatch *watch) {
  const FemModel *model = watch->model;
  watch->marks = memory_zeroed((size_t)model->tet_count, sizeof *watch->marks);
  if (!watch->marks) return status_no_memory("the marks of elements");
  if (!model->scene->contact.is_on) return STATUS_OK;
  watch->normals = memory_zeroed(3 * (size_t)model->vertex_count, sizeof *watch->normals);
  watch->is_wrongway = memory_zeroed((size_t)model->vertex_count, sizeof *watch->is_wrongway);
  watch->is_corner = memory_zeroed((size_t)model->vertex_count, sizeof *watch->is_corner);
  watch->is_deep = memory_zeroed((size_t)model->vertex_count, sizeof *watch->is_deep);
  if (!watch->normals || !watch->is_wrongway || !watch->is_corner || !watch->is_deep)
    return status_no_memory("the marks of vertices");
  if (model->scene->contact.potential == CONTACT_POTENTIAL_FIELD)
    for (int e = 0; e < model->quadratic_count; e++)
      for (int k = 0; k < 4; k++) watch->is_corner[model->quadratic_nodes[e][k]] = true;
  return list_surface(watch);
}

Status fem_trouble_watch_create(FemTroubleWatch *watch, const FemModel *model) {
  *watch = (FemTroubleWatch){.model = model};
  Status status = create(watch);
  if (status) fem_trouble_watch_destroy(watch);
  return status;
}

void fem_trouble_watch_destroy(FemTroubleWatch *watch) {
  memory_free(watch->triangles);
  memory_free(watch->normals);
  memory_free(watch->marks);
  memory_free(watch->is_wrongway);
  memory_free(watch->is_corner);
  memory_free(watch->is_deep);
  *watch = (FemTroubleWatch){0};
}

static void count(FemTroubleState *state, FemTroubleKind kind, int where) {
  if (state->count[kind]++ == 0) state->first[kind] = where;
}

static void look_at_elements(FemTroubleWatch *watch, const double *det_F, const double *overlap,
                             FemTroubleState *state) {
  const FemModel *model = watch->model;
  for (int e = 0; e < model->tet_count; e++) {
    watch->marks[e] = 0;
    if (model->bodies[model->tet_body[e]].is_obstacle) continue;
    if (!(det_F[e] > 0)) {
      watch->marks[e] |= FEM_TROUBLE_MARK_INVERTED;
      count(state, FEM_TROUBLE_INVERTED, e);
    }
    if (overlap[e] > 0 && overlap[e] >= COVERED * fabs(det_F[e])) {
      watch->marks[e] |= FEM_TROUBLE_MARK_ENCLOSED;
      count(state, FEM_TROUBLE_ENCLOSED, e);
    }
  }
}

static void find_normals(FemTroubleWatch *watch, const double *positions) {
  memset(watch->normals, 0, 3 * (size_t)watch->model->vertex_count * sizeof *watch->normals);
  for (int t = 0; t < watch->triangle_count; t++) {
    const int *v = watch->triangles[t];
    Vec3 a = vec3_at(positions + 3 * v[0]);
    Vec3 ab = vec3_sub(vec3_at(positions + 3 * v[1]), a), ac = vec3_sub(vec3_at(positions + 3 * v[2]), a);
    for (int k = 0; k < 3; k++) vec3_accumulate(watch->normals + 3 * v[k], vec3_cross(ab, ac));
  }
}

static void find_deep(FemTroubleWatch *watch, const double *det_F, const double *overlap) {
  const FemModel *model = watch->model;
  memset(watch->is_deep, 0, (size_t)model->vertex_count * sizeof *watch->is_deep);
  for (int e = 0; e < model->tet_count; e++)
    if (overlap[e] >= DEEP * fabs(det_F[e]))
      for (int k = 0; k < 4; k++) watch->is_deep[model->tets[e][k]] = true;
}

static void look_at_forces(FemTroubleWatch *watch, const double *positions, const double *force,
                           FemTroubleState *state) {
  const FemModel *model = watch->model;
  double largest = 0;
  for (int a = 0; a < model->vertex_count; a++) {
    largest = fmax(largest, vec3_length(vec3_at(force + 3 * a)));
    watch->is_wrongway[a] = 0;
  }
  if (!(largest > 0)) return;
  find_normals(watch, positions);
  for (int b = 0; b < model->scene->body_count; b++)
    for (int a = model->bodies[b].vertex_begin; a < model->bodies[b].vertex_end; a++) {
      Vec3 f = vec3_at(force + 3 * a), n = vec3_at(watch->normals + 3 * a);
      double size = vec3_length(f), area = vec3_length(n);
      if (watch->is_corner[a] || !watch->is_deep[a]) continue;
      if (!(size > FORCE_FLOOR * largest) || !(vec3_dot(f, n) > PULL * size * area)) continue;
      watch->is_wrongway[a] = 1;
      count(state, FEM_TROUBLE_WRONG_WAY, a);
    }
}

void fem_trouble_find(FemTroubleWatch *watch, const double *positions, const double *force,
                      const double *det_F, const double *overlap, FemTroubleState *state) {
  *state = (FemTroubleState){.first = {-1, -1, -1, -1, -1}, .passed = {-1, -1}};
  look_at_elements(watch, det_F, overlap, state);
  if (!force || !watch->triangles) return;
  find_deep(watch, det_F, overlap);
  look_at_forces(watch, positions, force, state);
}

// 6 V / (longest edge)³
static double shape_of(const double *rest, const int tet[4]) {
  Vec3 x[4];
  double longest = 0;
  for (int k = 0; k < 4; k++) {
    x[k] = vec3_at(rest + 3 * tet[k]);
    for (int l = 0; l < k; l++) longest = fmax(longest, vec3_length(vec3_sub(x[k], x[l])));
  }
  return fabs(vec3_det4(x[0], x[1], x[2], x[3])) / (longest * longest * longest);
}

FemTrouble fem_trouble_begin(const FemModel *model) {
  FemTrouble trouble = {
      .passed = {-1, -1}, .worst_sliver = -1, .worst_shape = INFINITY, .smallest_step = INFINITY};
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) trouble.of[k].first = -1;
  for (int e = 0; e < model->tet_count; e++) {
    if (model->bodies[model->tet_body[e]].is_obstacle) continue;
    double shape = shape_of(model->rest, model->tets[e]);
    trouble.sliver_count += !(shape >= SLIVER_SHAPE);
    if (!(shape >= trouble.worst_shape)) trouble.worst_shape = shape, trouble.worst_sliver = e;
  }
  return trouble;
}

bool fem_trouble_add(FemTrouble *trouble, double time, const FemTroubleState *state) {
  bool has_begun = false;
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    if (state->count[k] == 0) continue;
    if (trouble->of[k].steps++ == 0) {
      trouble->of[k].first_time = time;
      trouble->of[k].first = state->first[k];
      if (k == FEM_TROUBLE_PASSED)
        for (int side = 0; side < 2; side++) trouble->passed[side] = state->passed[side];
    }
    bool is_new = trouble->last.count[k] == 0;
    trouble->of[k].events += is_new;
    has_begun = has_begun || is_new;
    if (state->count[k] > trouble->of[k].most) trouble->of[k].most = state->count[k];
  }
  trouble->last = *state;
  return has_begun;
}

static const char *body_of_element(const FemModel *model, int tet) {
  return model->bodies[model->tet_body[tet]].name;
}

const char *fem_trouble_what(FemTroubleKind kind) {
  return kinds[kind].what;
}

const char *fem_trouble_advice(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind) {
  if (kind == FEM_TROUBLE_INVERTED) return fem_material_limit(fem_model_law(model, trouble->of[kind].first));
  // What a static scene errs by is the work along its steps of load.
  if (model->scene->is_static && kind == FEM_TROUBLE_ENERGY)
    return "try shorter steps of load: more output.frames, or a shorter time.max_step";
  return kinds[kind].advice;
}

void fem_trouble_place(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind, char *text,
                       size_t size) {
  int first = trouble->of[kind].first;
  double time = trouble->of[kind].first_time;
  if (kind == FEM_TROUBLE_ENERGY) {
    long long times = trouble->of[kind].events;
    snprintf(text, size, "first at t = %.6g s, %lld %s in all", time, times, times > 1 ? "times" : "time");
    return;
  }
  if (kind == FEM_TROUBLE_PASSED) {
    snprintf(text, size, "'%s' and '%s' at t = %.6g s, element %d first",
             fem_compliance_party_name(model, trouble->passed[0]),
             fem_compliance_party_name(model, trouble->passed[1]), time, first);
    return;
  }
  const char *body =
      kind == FEM_TROUBLE_WRONG_WAY ? fem_model_body_name(model, first) : body_of_element(model, first);
  snprintf(text, size, "first at t = %.6g s, %s %d of body '%s'; %d at once at most, in %lld %s", time,
           kinds[kind].unit, first, body, trouble->of[kind].most, trouble->of[kind].steps,
           trouble->of[kind].steps > 1 ? "steps" : "step");
}

void fem_trouble_describe(const FemTrouble *trouble, const FemModel *model, FemTroubleKind kind, char *text,
                          size_t size) {
  char place[256];
  fem_trouble_place(trouble, model, kind, place, sizeof place);
  snprintf(text, size, "%s: %s (%s)", kinds[kind].what, place, fem_trouble_advice(trouble, model, kind));
}

// A hint for what is seen in the refused state: elements inside out are not held by any contact.
static void describe_remedy(const FemTrouble *trouble, const FemModel *model, const FemTroubleState *found,
                            double stiffness, char *text, size_t size) {
  int inverted = found->count[FEM_TROUBLE_INVERTED] > 0 ? found->first[FEM_TROUBLE_INVERTED] : -1;
  int body = inverted < 0 ? -1 : model->tet_body[inverted];
  if (body >= 0 && (body == trouble->passed[0] || body == trouble->passed[1])) {
    snprintf(
        text, size,
        "%d elements are inverted, element %d of body '%s' first, and contact holds no inverted element: %s",
        found->count[FEM_TROUBLE_INVERTED], inverted, body_of_element(model, inverted),
        fem_material_limit(fem_model_law(model, inverted)));
    return;
  }
  if (!(stiffness > 0)) {
    snprintf(text, size, "write a steeper contact.law, or refine both meshes there");
    return;
  }
  snprintf(text, size,
           "its contact has a stiffness of %.3g: write contact: {pairs: [{bodies: [%s, %s], stiffness: "
           "%.3g}]}, or "
           "refine both meshes there",
           stiffness, fem_compliance_party_name(model, trouble->passed[0]),
           fem_compliance_party_name(model, trouble->passed[1]), STIFFER * stiffness);
}

void fem_trouble_describe_refusal(const FemTrouble *trouble, const FemModel *model,
                                  const FemTroubleState *found, double stiffness, char *text, size_t size) {
  char remedy[512];
  int first = trouble->of[FEM_TROUBLE_PASSED].first;
  describe_remedy(trouble, model, found, stiffness, remedy, sizeof remedy);
  snprintf(
      text, size,
      "at t = %.9g s: '%s' and '%s' would pass through each other (element %d of body '%s' first, %d in this "
      "step). The run ends before that; %s",
      trouble->of[FEM_TROUBLE_PASSED].first_time, fem_compliance_party_name(model, trouble->passed[0]),
      fem_compliance_party_name(model, trouble->passed[1]), first, body_of_element(model, first),
      found->count[FEM_TROUBLE_PASSED], remedy);
}

void fem_trouble_record(const FemTrouble *trouble, Record *record) {
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    Record *row = record_child(record, kinds[k].name);
    record_integer(row, "steps", trouble->of[k].steps);
    record_integer(row, "events", trouble->of[k].events);
    record_integer(row, "most", trouble->of[k].most);
    record_number(row, "first_time", trouble->of[k].steps ? trouble->of[k].first_time : NAN);
    record_integer(row, "first", trouble->of[k].first);
  }
  record_integer(record, "slivers", trouble->sliver_count);
  record_integer(record, "worst_element", trouble->worst_sliver);
  record_number(record, "worst_shape", trouble->worst_shape);
  record_number(record, "smallest_step", trouble->smallest_step);
}
