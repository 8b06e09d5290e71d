// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/scene/check_notes.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "fem/effect/effect.h"
#include "fem/effect/system_energy.h"
#include "fem/mesh/mesh.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/thickness.h"
#include "fem/run/check/choice.h"
#include "fem/scene/drive.h"

// Elements through the thickness from which on linear ones bend as they should, roughly.
static const double ENOUGH_LAYERS = 3.5;
// A pressure over E from which on a body is said to be crushed: at half of it, it has half its height.
static const double CRUSHED = 0.5;
// Of the sizes of two bodies: from which on one of them may be in mm, the other in m.
static const double FAR_LARGER = 300;
// A body of this size may be in mm [m], unless its density says that the scene is in tonnes and mm [kg/m³].
static const double HUGE_SIDE = 50, OF_TONNES = 1;

static void note(AppCheckNotes *notes, bool is_true, const char *text) {
  if (is_true && notes->count < APP_CHECK_NOTES) notes->texts[notes->count++] = text;
}

static bool is_zero(const double v[3]) {
  return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

static bool is_at_rest(const FemSceneDef *scene) {
  bool moves = scene->has_gravity && !is_zero(scene->gravity);
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    moves = moves || body->driven_count > 0 || body->load_count > 0 || !is_zero(body->velocity) ||
            !is_zero(body->spin);
  }
  for (int o = 0; o < scene->obstacle_count; o++) {
    moves = moves || !fem_drive_is_still(&scene->obstacles[o].motion);
  }
  return !moves;
}

static bool is_locking(const FemModel *model) {
  bool locks = false;
  for (int p = 0; p < model->part_count; p++) {
    int body = model->parts[p].body;
    locks = locks || (model->parts[p].material.poisson >= 0.45 &&
                      model->bodies[body].element == FEM_ELEMENT_LINEAR && !fem_model_is_rigid(model, body));
  }
  return locks;
}

static bool meets_itself(const FemSceneDef *scene) {
  bool meets = false;
  for (int b = 0; b < scene->body_count; b++) meets = meets || scene->bodies[b].self_contact;
  return meets;
}

static double machine_memory(void) {
  return (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
}

// Who overlaps before anything has moved.
static Status note_overlaps(const AppJob *job, AppCheckNotes *notes) {
  FemSystem system = {0};
  Status status = fem_system_create(&system, &job->model);
  const ContactEvaluation *contact;
  FemEnergy energy;
  if (!status) status = fem_system_energy(&system, &system.accepted, &energy);
  if (!status) status = fem_effect_contact_evaluate(&system, &system.accepted, &contact);
  int count = status ? 0 : fem_run_start_overlaps(&system, contact, notes->overlaps);
  for (int k = 0; k < count; k++) note(notes, true, notes->overlaps[k]);
  fem_system_destroy(&system);
  return status;
}

// Bodies that bend and have too few elements for it; quadratic ones need but one.
static Status note_thin(const AppJob *job, AppCheckNotes *notes) {
  const FemSceneDef *scene = &job->scene;
  for (int b = 0, k = 0; b < scene->body_count && k < APP_CHECK_THIN; b++) {
    FemThickness found;
    if (scene->bodies[b].element == FEM_ELEMENT_QUADRATIC || fem_model_is_rigid(&job->model, b)) continue;
    TRY(fem_thickness_find(&job->model, b, &found));
    if (!found.is_slender || !(found.layers < ENOUGH_LAYERS)) continue;
    snprintf(notes->thin[k], sizeof notes->thin[k],
             "'%s' is slender, %.3g m thick, and has about %.0f linear %s through that: it bends too "
             "stiffly; take element: "
             "quadratic, or four layers or more",
             scene->bodies[b].name, found.thickness, fmax(1, round(found.layers)),
             round(found.layers) > 1 ? "elements" : "element");
    note(notes, true, notes->thin[k++]);
  }
  return STATUS_OK;
}

// The least E of a body's materials [Pa].
static double softest(const FemModel *model, int body) {
  double least = INFINITY;
  for (int p = model->bodies[body].part_begin; p < model->bodies[body].part_end; p++)
    least = fmin(least, model->parts[p].material.young);
  return least;
}

// Of the two that press each other hardest beside what they are made of.
static Status note_crushed(const AppJob *job, AppCheckNotes *notes) {
  const FemModel *model = &job->model;
  FemCompliance choice;
  double worst = CRUSHED;
  if (!job->scene.contact.is_on) return STATUS_OK;
  TRY(fem_compliance_choose(model, &choice));
  for (int a = 0; a < job->scene.body_count; a++)
    for (int b = 0; b < choice.party_count; b++) {
      double pressure = choice.pressures[a * choice.party_count + b], young = softest(model, a);
      if (!fem_compliance_meets(model, a, b) || !(pressure > worst * young)) continue;
      worst = pressure / young;
      snprintf(
          notes->crushed, sizeof notes->crushed,
          "'%s' and '%s' may press each other with up to %.2g Pa, %.2g of the Young's modulus of '%s', by "
          "loads and the hardest impact: it is crushed then, and what it does depends on its mesh; is that "
          "meant, and are all units SI?",
          model->bodies[a].name, fem_compliance_party_name(model, b), pressure, worst, model->bodies[a].name);
    }
  note(notes, worst > CRUSHED, notes->crushed);
  fem_compliance_destroy(&choice);
  return STATUS_OK;
}

void app_check_notes_box(const FemModel *model, const FemModelBody *body, double low[3], double high[3]) {
  for (int c = 0; c < 3; c++) {
    low[c] = INFINITY, high[c] = -INFINITY;
    for (int v = body->vertex_begin; v < body->vertex_end; v++) {
      low[c] = fmin(low[c], model->rest[3 * (size_t)v + (size_t)c]);
      high[c] = fmax(high[c], model->rest[3 * (size_t)v + (size_t)c]);
    }
  }
}

static double largest_side(const FemModel *model, const FemModelBody *body) {
  double low[3], high[3];
  app_check_notes_box(model, body, low, high);
  return fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
}

static double least_density(const FemModel *model, const FemModelBody *body) {
  double least = INFINITY;
  for (int p = body->part_begin; p < body->part_end; p++)
    least = fmin(least, model->parts[p].material.density);
  return least;
}

// A mesh in mm among others in m, or a single one.
static void note_units(const FemModel *model, AppCheckNotes *notes) {
  int least = 0, most = 0;
  for (int b = 0; b < model->body_count; b++) {
    if (largest_side(model, &model->bodies[b]) < largest_side(model, &model->bodies[least])) least = b;
    if (largest_side(model, &model->bodies[b]) > largest_side(model, &model->bodies[most])) most = b;
  }
  double ratio = largest_side(model, &model->bodies[most]) / largest_side(model, &model->bodies[least]);
  snprintf(notes->far_larger, sizeof notes->far_larger,
           "'%s' is %.0f times as large as '%s'; if the mesh of one is in mm, it needs place: {scale: 0.001}",
           model->bodies[most].name, ratio, model->bodies[least].name);
  bool is_far_larger = ratio > FAR_LARGER;
  double side = largest_side(model, &model->bodies[most]);
  bool is_huge = side >= HUGE_SIDE && least_density(model, &model->bodies[most]) > OF_TONNES;
  if (is_huge && !is_far_larger)
    snprintf(
        notes->far_larger, sizeof notes->far_larger,
        "'%s' is %.3g m long, and lengths are in m; if its mesh is in mm, it needs place: {scale: 0.001}",
        model->bodies[most].name, side);
  note(notes, is_far_larger || is_huge, notes->far_larger);
}

// Lines that miss most of their body.
static void note_lines(const FemModel *model, AppCheckNotes *notes) {
  for (int l = 0, k = 0; l < model->line_count && k < APP_CHECK_LINES; l++) {
    const FemLine *line = &model->lines[l];
    if (!(2 * line->count < line->def->points)) continue;
    snprintf(
        notes->lines[k], sizeof notes->lines[k],
        "line '%.64s' has %d of its %d points in the body: from and to are places [m] of the body as placed, "
        "at rest; is that meant?",
        line->def->name, line->count, line->def->points);
    note(notes, true, notes->lines[k++]);
  }
}

// Bodies whose mesh is open where vertices lie on each other: cracks that no picture shows.
static Status note_seams(const FemModel *model, AppCheckNotes *notes) {
  for (int b = 0, k = 0; b < model->body_count && k < APP_CHECK_SEAMS; b++) {
    const FemModelBody *body = &model->bodies[b];
    int coincident;
    TRY(fem_mesh_coincident(model->rest + 3 * (size_t)body->vertex_begin,
                            body->vertex_end - body->vertex_begin, &coincident));
    if (coincident == 0) continue;
    snprintf(notes->seams[k], sizeof notes->seams[k],
             "'%.64s' has %d vertices that lie exactly on another: its mesh is open there; merge them unless "
             "it is meant",
             body->name, coincident);
    note(notes, true, notes->seams[k++]);
  }
  return STATUS_OK;
}

static AppCheckNotes take_notes(const AppJob *job) {
  const FemSceneDef *scene = &job->scene;
  int solids = scene->body_count + scene->obstacle_count;
  AppCheckNotes notes = {.count = 0};
  note(&notes, solids > 1 && !scene->contact.is_on,
       "there is no 'contact' section: the bodies will pass through each other and through obstacles");
  note(&notes, solids == 1 && scene->contact.is_on && !meets_itself(scene),
       "contact is on, but there is only one body, without self_contact, and no obstacle to touch");
  note(&notes, is_at_rest(scene),
       "nothing moves: no gravity, no initial velocity, no driven vertices, no moving obstacle");
  note(&notes, is_locking(&job->model),
       "linear tetrahedra are too stiff at a Poisson's ratio of 0.45 and above: bending is underestimated; "
       "try element: quadratic or nodal");
  note(&notes, job->model.free_count == 0, "every vertex is prescribed: there is nothing to solve");
  note(&notes, fem_run_choice(&job->model, NULL).bytes > machine_memory(),
       "the run needs more memory than this machine has");
  return notes;
}

Status app_check_notes_take(const AppJob *job, AppCheckNotes *notes) {
  *notes = take_notes(job);
  if (job->scene.contact.is_on) TRY(note_overlaps(job, notes));
  TRY(note_thin(job, notes));
  TRY(note_crushed(job, notes));
  TRY(note_seams(&job->model, notes));
  note_units(&job->model, notes);
  note_lines(&job->model, notes);
  return STATUS_OK;
}
