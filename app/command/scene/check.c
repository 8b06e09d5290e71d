// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdio.h>

#include "app/cli/parse.h"
#include "app/cli/ranks.h"
#include "app/command/scene/check_notes.h"
#include "app/job/job.h"
#include "app/job/stiffness.h"
#include "base/files/record.h"
#include "base/machine/cpu.h"
#include "base/ranks.h"
#include "base/text.h"
#include "fem/effect/effect.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/laws.h"
#include "fem/model/division.h"
#include "fem/model/tolerance.h"
#include "fem/run/check/choice.h"
#include "fem/sparse/solver.h"

typedef struct Options {
  AppJobOptions job;
  int rank_count; // --ranks; 0: not said
} Options;

// How many coordinates of a body are prescribed, fixed and driven.
typedef struct Prescribed {
  int fixed, driven;
} Prescribed;

static Prescribed count_prescribed(const FemModel *model, const FemModelBody *body) {
  Prescribed count = {0, 0};
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    if (driver->dof_count == 0) continue;
    int vertex = driver->dofs[0] / 3; // a driver belongs to one body
    if (vertex < body->vertex_begin || vertex >= body->vertex_end) continue;
    *(driver->is_fixed ? &count.fixed : &count.driven) += driver->dof_count;
  }
  return count;
}

static void describe_mesh(const char *path, const int cells[3], char *text, size_t size) {
  if (path)
    snprintf(text, size, "%s", path);
  else
    snprintf(text, size, "box of %d × %d × %d cubes", cells[0], cells[1], cells[2]);
}

// As text.

// What selects a part, as its group or "materials[0], box".
static void describe_part(const FemBodyDef *def, int item, char *text, size_t size) {
  static const char *const kinds[] = {
      [FEM_SELECT_BOX] = "box", [FEM_SELECT_HALFSPACE] = "halfspace", [FEM_SELECT_RADIUS] = "radius"};
  const FemSelectDef *select = item < 0 ? NULL : &def->parts[item].select;
  if (!select)
    snprintf(text, size, "material");
  else
    snprintf(text, size, "materials[%d], %s%s", item,
             select->kind == FEM_SELECT_GROUP ? "group " : kinds[select->kind],
             select->kind == FEM_SELECT_GROUP ? select->group : "");
}

static int count_tets(const FemModel *model, int part) {
  const FemModelBody *body = &model->bodies[model->parts[part].body];
  int count = 0;
  for (int e = body->tet_begin; e < body->tet_end; e++) count += model->tet_part[e] == part;
  return count;
}

// Which part it is only where the scene gives several materials.
static void print_part(const FemModel *model, int p, const FemBodyDef *def) {
  const FemModelPart *part = &model->parts[p];
  char name[160];
  describe_part(def, part->item, name, sizeof name);
  if (def->part_count > 0)
    printf("  %-12s %s, %d tetrahedra: ", "", name, count_tets(model, p));
  else
    printf("  %-12s ", "");
  printf("%s, E %g Pa, ν %g, ρ %g kg/m³: %.4g kg\n", fem_material_name(part->material.law),
         part->material.young, part->material.poisson, part->material.density, part->mass);
  if (part->damping > 0) printf("  %-12s damping β %g s\n", "", part->damping);
}

// Whether a body carries a line.
static bool has_line(const FemBodyDef *def, const FemLine *line) {
  return line->def >= def->lines && line->def < def->lines + def->line_count;
}

static void print_lines(const FemModel *model, const FemBodyDef *def) {
  for (int l = 0; l < model->line_count; l++) {
    const FemLine *line = &model->lines[l];
    if (has_line(def, line))
      printf("  %-12s line '%s': %d of %d points in the body\n", "", line->def->name, line->count,
             line->def->points);
  }
}

static void print_body(const AppJob *job, int b) {
  const FemModelBody *body = &job->model.bodies[b];
  const FemBodyDef *def = &job->scene.bodies[b];
  Prescribed prescribed = count_prescribed(&job->model, body);
  char mesh[512];
  double low[3], high[3];
  describe_mesh(def->mesh_path, def->box_cells, mesh, sizeof mesh);
  int quadratic_count = body->quadratic_end - body->quadratic_begin;
  printf("  %-12s %s: %d vertices, ", body->name, mesh, body->vertex_end - body->vertex_begin);
  if (quadratic_count > 0) printf("%d quadratic tetrahedra, for contact in ", quadratic_count);
  printf("%d tetrahedra\n", body->tet_end - body->tet_begin);
  app_check_notes_box(&job->model, body, low, high);
  printf("  %-12s %.4g × %.4g × %.4g m, from (%.4g, %.4g, %.4g)\n", "", high[0] - low[0], high[1] - low[1],
         high[2] - low[2], low[0], low[1], low[2]);
  for (int p = body->part_begin; p < body->part_end; p++) print_part(&job->model, p, def);
  if (prescribed.fixed + prescribed.driven > 0)
    printf("  %-12s %d coordinates fixed, %d driven\n", "", prescribed.fixed, prescribed.driven);
  print_lines(&job->model, def);
}

static void print_obstacle(const AppJob *job, int o) {
  const FemObstacleDef *def = &job->scene.obstacles[o];
  char mesh[512] = "half-space";
  if (def->kind == FEM_OBSTACLE_BALL) snprintf(mesh, sizeof mesh, "sphere of radius %g m", def->radius);
  if (def->kind == FEM_OBSTACLE_BOX)
    snprintf(mesh, sizeof mesh, "box of %g m × %g m × %g m", def->size[0], def->size[1], def->size[2]);
  if (def->kind == FEM_OBSTACLE_CYLINDER)
    snprintf(mesh, sizeof mesh, "cylinder of radius %g m, length %g m", def->radius, def->length);
  if (def->kind == FEM_OBSTACLE_MESH) describe_mesh(def->mesh_path, def->box_cells, mesh, sizeof mesh);
  printf("  %-12s %s\n", def->name, mesh);
}

static void print_effects(const FemSceneDef *scene) {
  int count;
  const FemEffectOps *const *effects = fem_effect_list(&count);
  printf("effects       ");
  bool is_first = true;
  for (int i = 0; i < count; i++) {
    if (!effects[i]->is_wanted(scene)) continue;
    printf("%s%s", is_first ? "" : ", ", effects[i]->name);
    is_first = false;
  }
  putchar('\n');
}

static void print_laws(const FemContactDef *contact) {
  char text[EXPRESSION_MAX_TEXT + 64];
  if (!fem_laws_are_wanted(contact)) return;
  contact_law_describe(&contact->law.law, text, sizeof text);
  printf("              pressure law %s\n", text);
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    if (pair->law.law.kind == CONTACT_LAW_LINEAR) continue;
    contact_law_describe(&pair->law.law, text, sizeof text);
    printf("              pressure law of '%s' and '%s' %s\n", pair->names[0], pair->names[1], text);
  }
}

static void print_contact(const AppJob *job) {
  const FemContactDef *contact = &job->scene.contact;
  char text[1024];
  FemCompliance choice;
  if (!contact->is_on || fem_compliance_choose(&job->model, &choice)) return;
  app_stiffness_describe(&job->model, &choice, text, sizeof text);
  printf("contact       potential %s, overlap model %s\n", contact_def_potential_name(contact->potential),
         app_job_overlap(job));
  print_laws(contact);
  printf("              stiffness %s\n", text);
  app_stiffness_describe_levels(&job->model, &choice, text, sizeof text);
  if (text[0]) printf("              %s\n", text);
  fem_compliance_destroy(&choice);
}

static void print_memory(double bytes) {
  const double units[] = {1e9, 1e6}; // GB, MB
  bool is_small = bytes < units[0];
  printf("memory        about %.2g %s\n", bytes / units[is_small], is_small ? "MB" : "GB");
}

static void print_plan(const FemModel *model, const FemDivisionPlan *plan) {
  if (plan->rank_count == 0) return;
  FemRunChoice choice = fem_run_choice_over(model, plan->rank_count);
  printf(
      "ranks         %d: %d … %d vertices, %d … %d elements, %d … %d copies of others' vertices, solver %s\n",
      plan->rank_count, plan->vertices[0], plan->vertices[1], plan->elements[0], plan->elements[1],
      plan->copies[0], plan->copies[1], fem_solver_name(choice.kind));
  printf("              about %.2g GB a rank, %.2g GB in all\n", choice.bytes / 1e9,
         plan->rank_count * choice.bytes / 1e9);
}

static void print_text(const AppJob *job, const AppCheckNotes *notes, const FemDivisionPlan *plan) {
  const FemSceneDef *scene = &job->scene;
  const FemModel *model = &job->model;
  printf("%s%s%s\n", scene->path, scene->title ? ": " : "", scene->title ? scene->title : "");
  puts("bodies");
  for (int b = 0; b < scene->body_count; b++) print_body(job, b);
  if (scene->obstacle_count > 0) puts("obstacles");
  for (int o = 0; o < scene->obstacle_count; o++) print_obstacle(job, o);
  print_effects(scene);
  print_contact(job);
  printf("unknowns      %d displacements, %s velocities\n", model->free_count,
         scene->is_static ? "no" : "and as many");
  printf("time          0 to %g s, error per step %g m and %g m/s\n", scene->end,
         fem_model_position_tolerance(model), fem_model_velocity_tolerance(model));
  FemRunChoice choice = fem_run_choice(model, NULL);
  printf("solver        %s%s%s%s, %d threads\n", fem_solver_name(choice.kind),
         choice.why[0] ? " (chosen: " : "", choice.why, choice.why[0] ? ")" : "", cpu_thread_count());
  print_memory(choice.bytes);
  print_plan(model, plan);
  printf("output        %s: %d frames%s%s\n", job->directory, scene->frames + 1,
         scene->write_vtu ? ", VTU" : "",
         scene->history == FEM_HISTORY_NONE    ? ""
         : scene->history == FEM_HISTORY_STEPS ? ", history of steps"
                                               : ", history");
  for (int i = 0; i < notes->count; i++) printf("note: %s\n", notes->texts[i]);
}

// As JSON.

static void record_part(const FemModel *model, int p, const FemBodyDef *def, Record *record) {
  const FemModelPart *part = &model->parts[p];
  char name[160];
  describe_part(def, part->item, name, sizeof name);
  record_text(record, "of", name);
  record_text(record, "law", fem_material_name(part->material.law));
  record_number(record, "young", part->material.young);
  record_number(record, "poisson", part->material.poisson);
  record_number(record, "density", part->material.density);
  record_number(record, "damping", part->damping);
  record_integer(record, "tetrahedra", count_tets(model, p));
  record_number(record, "mass", part->mass);
}

static void record_lines(const FemModel *model, const FemBodyDef *def, Record *record) {
  if (def->line_count == 0) return;
  RecordList *lines = record_list(record, "lines");
  for (int l = 0; l < model->line_count; l++) {
    const FemLine *line = &model->lines[l];
    if (!has_line(def, line)) continue;
    Record *item = record_append(lines);
    record_text(item, "name", line->def->name);
    record_integer(item, "points", line->def->points);
    record_integer(item, "points_in_body", line->count);
  }
}

static void record_body(const AppJob *job, int b, Record *record) {
  const FemModelBody *body = &job->model.bodies[b];
  const FemBodyDef *def = &job->scene.bodies[b];
  Prescribed prescribed = count_prescribed(&job->model, body);
  char mesh[512];
  double low[3], high[3];
  describe_mesh(def->mesh_path, def->box_cells, mesh, sizeof mesh);
  record_text(record, "name", body->name);
  record_text(record, "mesh", mesh);
  app_check_notes_box(&job->model, body, low, high);
  record_numbers(record, "box_min", low, 3);
  record_numbers(record, "box_max", high, 3);
  record_integer(record, "vertices", body->vertex_end - body->vertex_begin);
  record_integer(record, "tetrahedra", body->tet_end - body->tet_begin);
  if (body->quadratic_end > body->quadratic_begin)
    record_integer(record, "quadratic_tetrahedra", body->quadratic_end - body->quadratic_begin);
  record_number(record, "mass", body->mass);
  RecordList *materials = record_list(record, "materials");
  for (int p = body->part_begin; p < body->part_end; p++)
    record_part(&job->model, p, def, record_append(materials));
  record_integer(record, "fixed_coordinates", prescribed.fixed);
  record_integer(record, "driven_coordinates", prescribed.driven);
  record_lines(&job->model, def, record);
}

static void record_effects(const FemSceneDef *scene, RecordList *list) {
  int count;
  const FemEffectOps *const *effects = fem_effect_list(&count);
  for (int i = 0; i < count; i++)
    if (effects[i]->is_wanted(scene)) record_append_text(list, effects[i]->name);
}

static void record_contact(const AppJob *job, Record *record) {
  const FemContactDef *contact = &job->scene.contact;
  record_text(record, "potential", contact_def_potential_name(contact->potential));
  FemCompliance choice;
  if (!fem_compliance_choose(&job->model, &choice)) {
    double range[2];
    int most = 0;
    fem_compliance_range(&job->model, &choice, range);
    record_number(record, "stiffness", range[0]);
    record_number(record, "largest_stiffness", range[1]);
    for (int b = 0; b < job->model.body_count; b++)
      if (choice.levels[b] > most) most = choice.levels[b];
    record_integer(record, "smooth", most);
    fem_compliance_destroy(&choice);
  }
  record_text(record, "stiffness_unit", contact_def_potential_unit(contact->potential));
  record_bool(record, "is_stiffness_chosen", !(contact->stiffness > 0));
  record_text(record, "overlap", app_job_overlap(job));
  if (!fem_laws_are_wanted(contact)) return;
  char law[EXPRESSION_MAX_TEXT + 64];
  contact_law_describe(&contact->law.law, law, sizeof law);
  record_text(record, "law", law);
}

static void record_range(Record *record, const char *name, const int range[2]) {
  Record *child = record_child(record, name);
  record_integer(child, "least", range[0]);
  record_integer(child, "most", range[1]);
}

static void record_plan(const FemModel *model, const FemDivisionPlan *plan, Record *record) {
  FemRunChoice choice = fem_run_choice_over(model, plan->rank_count);
  record_integer(record, "count", plan->rank_count);
  record_range(record, "vertices", plan->vertices);
  record_range(record, "elements", plan->elements);
  record_range(record, "copies", plan->copies);
  record_text(record, "solver", fem_solver_name(choice.kind));
  record_whole(record, "memory_bytes", choice.bytes);
}

static void record_job(const AppJob *job, const AppCheckNotes *notes, const FemDivisionPlan *plan,
                       Record *record) {
  const FemSceneDef *scene = &job->scene;
  const FemModel *model = &job->model;
  record_text(record, "scene", scene->path);
  record_text(record, "title", scene->title);
  RecordList *bodies = record_list(record, "bodies"), *obstacles = record_list(record, "obstacles");
  for (int b = 0; b < scene->body_count; b++) record_body(job, b, record_append(bodies));
  for (int o = 0; o < scene->obstacle_count; o++)
    record_text(record_append(obstacles), "name", scene->obstacles[o].name);
  record_effects(scene, record_list(record, "effects"));
  if (scene->contact.is_on) record_contact(job, record_child(record, "contact"));
  record_integer(record, "vertices", model->vertex_count);
  record_integer(record, "tetrahedra", model->tet_count);
  record_integer(record, "unknowns", model->free_count);
  record_number(record, "end", scene->end);
  record_bool(record, "is_static", scene->is_static);
  record_number(record, "length_m", model->length);
  record_number(record, "tolerance", scene->tolerance);
  record_number(record, "velocity_tolerance_m_s", fem_model_velocity_tolerance(model));
  FemRunChoice choice = fem_run_choice(model, NULL);
  record_text(record, "solver", fem_solver_name(choice.kind));
  record_text(record, "solver_why", choice.why);
  record_integer(record, "threads", cpu_thread_count());
  record_whole(record, "memory_bytes", choice.bytes);
  if (plan->rank_count > 0) record_plan(model, plan, record_child(record, "ranks"));
  record_text(record, "output", job->directory);
  record_integer(record, "frames", scene->frames + 1);
  RecordList *list = record_list(record, "notes");
  for (int i = 0; i < notes->count; i++) record_append_text(list, notes->texts[i]);
}

static Status print_json(const AppJob *job, const AppCheckNotes *notes, const FemDivisionPlan *plan) {
  Record *record = record_new();
  if (!record) return status_no_memory("the report");
  record_job(job, notes, plan, record);
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static Status print(const AppJob *job, const Options *options) {
  FemDivisionPlan plan = {0};
  AppCheckNotes notes;
  if (options->rank_count > 0) TRY(fem_model_division_plan(&job->model, options->rank_count, &plan));
  TRY(app_check_notes_take(job, &notes));
  if (options->job.is_json) return print_json(job, &notes, &plan);
  print_text(job, &notes, &plan);
  return STATUS_OK;
}

static Status check(const Options *options) {
  AppJob job;
  TRY(app_job_open(&job, &options->job, NULL, NULL));
  Status status = print(&job, options);
  if (!status && fflush(stdout) != 0) status = status_fail(STATUS_IO, "standard output cannot be written");
  app_job_close(&job);
  return status;
}

static const AppOption option_table[] = {
    {"ranks", 0, "N", "Say how N processes would share it, and the memory of each (tetlap-mpi)", 1,
     CLI_INTEGER, CLI_TO(Options, rank_count), 1, RANKS_MOST},
    {.table = app_job_options, .offset = offsetof(Options, job)},
    {0},
};

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_check, argument_count, arguments, &options);
  app_job_prepare(&options.job);
  Status status = options.rank_count > 0 ? app_ranks_become() : STATUS_OK;
  if (!status) status = check(&options);
  return app_cli_command_end(status);
}

const AppCommand app_command_check = {.name = "check",
                                      .help = "say what a run would do, without running",
                                      .options = option_table,
                                      .arguments = &app_job_scene,
                                      .doc = "Say what a run of SCENE would do, without running.",
                                      .run = run_command};
