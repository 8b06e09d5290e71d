// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/serve.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "app/loop/state.h"
#include "base/memory.h"

enum { HELLO = 1, ADVANCE, SET, FILL, KEEP, RESTORE, DROP, WRITE, READ, RECORD, GO, VERSION = 1, STEP = 1 };
enum { FILL_FORCES = 1, FILL_STRESS = 2, CONTACT_NUMBERS = 18, ALIGNMENT = 64 };

typedef struct Words {
  uint64_t what, length, a, b;
} Words;

// An array in the shared memory.
typedef struct Place {
  const char *name;
  int rows, columns;
  const char *type; // of NumPy
  size_t offset;    // [bytes]
} Place;
enum { POINTS, VELOCITIES, FORCES, PRESSURE, STRESS, CONTACTS, TETS, PLACE_COUNT };

typedef struct Server {
  AppLoop loop;
  int socket, memory;
  char *map;
  size_t map_size;
  Place places[PLACE_COUNT];
  char *bytes; // of a request, owned, ends with 0
  size_t capacity;
  long long shown;            // which reading of the loop is in the memory
  bool tells_steps, is_alone; // the other side is gone
  AppLoopState **states;      // owned; NULL: dropped                                (state_count)
  size_t state_count, state_capacity;
} Server;

static uint64_t bits_of(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static double value_of(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

// False: the other side has closed its end.
static bool receive(Server *server, void *bytes, size_t size) {
  for (char *at = bytes; size > 0;) {
    ssize_t got = recv(server->socket, at, size, 0);
    if (got < 0 && errno == EINTR && !*app_job_stop_flag()) continue;
    if (got <= 0) return !(server->is_alone = true);
    at += got, size -= (size_t)got;
  }
  return true;
}

static bool hand_over(Server *server, const void *bytes, size_t size) {
  for (const char *at = bytes; size > 0;) {
    ssize_t sent = send(server->socket, at, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR && !*app_job_stop_flag()) continue;
    if (sent <= 0) return !(server->is_alone = true);
    at += sent, size -= (size_t)sent;
  }
  return true;
}

static bool receive_request(Server *server, Words *request) {
  static const size_t MOST = (size_t)1 << 32;
  if (!receive(server, request, sizeof *request)) return false;
  if (request->length > MOST ||
      !memory_reserve((void **)&server->bytes, &server->capacity, (size_t)request->length + 1, 1))
    return false;
  server->bytes[request->length] = 0;
  return receive(server, server->bytes, (size_t)request->length);
}

static bool answer(Server *server, int code, const char *text, uint64_t b) {
  const double time = server->loop.session ? app_loop_time(&server->loop) : 0;
  const Words words = {(uint64_t)code, strlen(text), bits_of(time), b};
  return hand_over(server, &words, sizeof words) && hand_over(server, text, strlen(text));
}

// ---- The memory

static void lay_out(Server *server) {
  const FemModel *model = &server->loop.job.model;
  const int v = model->vertex_count, t = model->tet_count, c = server->loop.contact_count;
  const Place places[PLACE_COUNT] = {{"points", v, 3, "f8", 0}, {"velocities", v, 3, "f8", 0},
                                     {"forces", v, 3, "f8", 0}, {"pressure", v, 1, "f8", 0},
                                     {"stress", t, 6, "f8", 0}, {"contacts", c, CONTACT_NUMBERS, "f8", 0},
                                     {"tets", t, 4, "i4", 0}};
  memcpy(server->places, places, sizeof places);
  for (int p = 0; p < PLACE_COUNT; p++) {
    Place *place = &server->places[p];
    place->offset = server->map_size;
    size_t size = (size_t)place->rows * (size_t)place->columns * (place->type[0] == 'f' ? 8 : 4);
    server->map_size += (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  }
}

static Status share_memory(Server *server) {
  lay_out(server);
  if (ftruncate(server->memory, (off_t)server->map_size) != 0) return status_no_memory("arrays to share");
  server->map = mmap(NULL, server->map_size, PROT_READ | PROT_WRITE, MAP_SHARED, server->memory, 0);
  if (server->map == MAP_FAILED) {
    server->map = NULL;
    return status_no_memory("arrays to share");
  }
  const FemModel *model = &server->loop.job.model;
  memcpy(server->map + server->places[TETS].offset, model->tets,
         (size_t)model->tet_count * sizeof *model->tets);
  return STATUS_OK;
}

static double *array(const Server *server, int place) {
  return (double *)(void *)(server->map + server->places[place].offset);
}

// force 0, moment 3, centre 6, impulse 9, area 12, pressure 13, slip 14, volume 15, in contact 16; 17 is
// free.
static void put_contact(const AppLoopContact *contact, double *row) {
  memcpy(row, contact->force, 3 * sizeof *row);
  memcpy(row + 3, contact->moment, 3 * sizeof *row);
  memcpy(row + 6, contact->centre, 3 * sizeof *row);
  memcpy(row + 9, contact->impulse, 3 * sizeof *row);
  row[12] = contact->area, row[13] = contact->pressure, row[14] = contact->slip, row[15] = contact->volume;
  row[16] = contact->volume > 0;
}

static void show(Server *server) {
  const FemState *state = app_loop_state(&server->loop);
  if (server->shown == server->loop.readings) return;
  server->shown = server->loop.readings;
  const size_t bytes = 3 * (size_t)server->loop.job.model.vertex_count * sizeof(double);
  memcpy(array(server, POINTS), state->positions, bytes);
  memcpy(array(server, VELOCITIES), state->velocities, bytes);
  for (int i = 0; i < server->loop.contact_count; i++)
    put_contact(&server->loop.contacts[i], array(server, CONTACTS) + CONTACT_NUMBERS * (size_t)i);
}

static Status fill(Server *server, uint64_t which) {
  const size_t vertices = (size_t)server->loop.job.model.vertex_count;
  if (which & FILL_STRESS) app_loop_stress(&server->loop, array(server, STRESS));
  if (!(which & FILL_FORCES)) return STATUS_OK;
  const double *forces, *pressure;
  TRY(app_loop_vertex_forces(&server->loop, &forces, &pressure));
  if (forces) memcpy(array(server, FORCES), forces, 3 * vertices * sizeof *forces);
  if (pressure) memcpy(array(server, PRESSURE), pressure, vertices * sizeof *pressure);
  return STATUS_OK;
}

// ---- What there is, as JSON

static void record_places(const Server *server, Record *record) {
  Record *arrays = record_child(record, "arrays");
  for (int p = 0; p < PLACE_COUNT; p++) {
    const Place *place = &server->places[p];
    Record *at = record_child(arrays, place->name);
    record_integer(at, "offset", (long long)place->offset);
    record_integer(at, "rows", place->rows);
    record_integer(at, "columns", place->columns);
    record_text(at, "type", place->type);
  }
}

static void record_bodies(const FemModel *model, Record *record) {
  RecordList *bodies = record_list(record, "bodies");
  for (int b = 0; b < model->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    Record *at = record_append(bodies);
    record_text(at, "name", body->name);
    record_integer(at, "vertex_begin", body->vertex_begin);
    record_integer(at, "vertex_end", body->vertex_end);
    record_integer(at, "tet_begin", body->tet_begin);
    record_integer(at, "tet_end", body->tet_end);
    record_bool(at, "is_obstacle", body->is_obstacle);
    record_number(at, "mass", body->mass);
  }
}

static void record_groups(const AppLoopGroups *groups, Record *record) {
  RecordList *list = record_list(record, "groups");
  for (int g = 0; g < groups->count; g++) {
    Record *at = record_append(list);
    record_text(at, "name", groups->groups[g].name);
    record_text(at, "kind", groups->groups[g].kind == APP_LOOP_DRIVE ? "drive" : "load");
    record_integer(at, "vertices",
                   groups->groups[g].kind == APP_LOOP_LOAD ? groups->groups[g].load->vertex_count : 0);
  }
}

static void record_contacts(const AppLoop *loop, Record *record) {
  RecordList *contacts = record_list(record, "contacts");
  for (int i = 0; i < loop->contact_count; i++) {
    Record *at = record_append(contacts);
    record_text(at, "a", loop->contacts[i].a);
    record_text(at, "b", loop->contacts[i].b);
  }
}

static Status describe(const Server *server, char **text) {
  Record *record = record_new();
  const FemSceneDef *scene = &server->loop.job.scene;
  record_text(record, "scene", scene->path);
  record_number(record, "end", scene->end);
  record_bool(record, "is_static", scene->is_static);
  record_integer(record, "size", (long long)server->map_size);
  record_places(server, record);
  record_bodies(&server->loop.job.model, record);
  record_groups(&server->loop.groups, record);
  record_contacts(&server->loop, record);
  record_merge(record_child(record, "origin"), server->loop.origin);
  *text = record_text_of(record);
  record_destroy(record);
  return *text ? STATUS_OK : status_no_memory("a description");
}

// ---- Requests

static bool reply(Server *server, Status status, uint64_t b) {
  if (server->is_alone) return false;
  if (status) return answer(server, status_exit_code(status), status_message(), 0);
  show(server);
  return answer(server, 0, "", b);
}

// Of the loop, after a step: the other side may be gone, or want to see it.
static Status tell_step(void *self, AppLoop *loop) {
  Server *server = self;
  Words go;
  char peeked;
  if (recv(server->socket, &peeked, 1, MSG_PEEK | MSG_DONTWAIT) == 0) server->is_alone = true;
  if (!server->is_alone && server->tells_steps) {
    TRY(app_loop_read_areas(loop));
    show(server);
    bool goes_on = answer(server, STEP, "", 0);
    while (goes_on && (goes_on = receive_request(server, &go)) && go.what == FILL)
      goes_on = reply(server, fill(server, go.b), 0);
    if (goes_on && go.b == 1) app_loop_stop(loop);
  }
  return server->is_alone ? status_fail(STATUS_INTERRUPTED, "whoever stepped the run is gone") : STATUS_OK;
}

static Status set(Server *server, const Words *request) {
  const size_t name = strlen(server->bytes) + 1;
  if (name > request->length || (request->length - name) % sizeof(double) != 0)
    return status_fail(STATUS_USAGE, "what was to be set is no name with values");
  const size_t count = (request->length - name) / sizeof(double);
  double *values = memory_copy(server->bytes + name, count, sizeof *values);
  if (!values) return status_no_memory("values");
  Status status = app_loop_set(&server->loop, request->b == 0 ? APP_LOOP_DRIVE : APP_LOOP_LOAD, server->bytes,
                               value_of(request->a), values, (int)count);
  memory_free(values);
  return status;
}

// A new state, kept or read, and its number.
static Status add_state(Server *server, const char *path, uint64_t *number) {
  AppLoopState *state = memory_zeroed(1, sizeof *state);
  if (!state || !memory_reserve((void **)&server->states, &server->state_capacity, server->state_count + 1,
                                sizeof *server->states)) {
    memory_free(state);
    return status_no_memory("a state");
  }
  Status status =
      path ? app_loop_state_read(&server->loop, state, path) : app_loop_state_keep(&server->loop, state);
  *number = server->state_count;
  server->states[server->state_count++] = state;
  return status;
}

static void drop_state(Server *server, uint64_t number) {
  if (number >= server->state_count || !server->states[number]) return;
  app_loop_state_destroy(server->states[number]);
  memory_free(server->states[number]);
  server->states[number] = NULL;
}

static Status find_state(const Server *server, uint64_t number, const AppLoopState **state) {
  *state = number < server->state_count ? server->states[number] : NULL;
  return *state ? STATUS_OK : status_fail(STATUS_USAGE, "there is no state %llu", (unsigned long long)number);
}

static Status execute(Server *server, const Words *request, uint64_t *b) {
  const AppLoopState *state;
  switch (request->what) {
  case ADVANCE:
    server->tells_steps = request->b == 1;
    return app_loop_advance(&server->loop, value_of(request->a));
  case SET:
    return set(server, request);
  case FILL:
    return fill(server, request->b);
  case KEEP:
    return add_state(server, NULL, b);
  case READ:
    return add_state(server, server->bytes, b);
  case RESTORE:
    TRY(find_state(server, request->b, &state));
    return app_loop_state_restore(&server->loop, state);
  case DROP:
    drop_state(server, request->b);
    return STATUS_OK;
  case WRITE:
    TRY(find_state(server, request->b, &state));
    return app_loop_state_write(&server->loop, state, server->bytes);
  case RECORD:
    return app_loop_diary_write(&server->loop.diary, server->bytes);
  default:
    return status_fail(STATUS_USAGE, "there is no request %llu", (unsigned long long)request->what);
  }
}

static Status open_scene(Server *server, const AppLoopOptions *options) {
  TRY(app_loop_open(&server->loop, options));
  server->loop.on_step = tell_step;
  server->loop.on_step_self = server;
  return share_memory(server);
}

static bool greet(Server *server, const AppLoopOptions *options, const Words *request) {
  char *text = NULL;
  Status status = request->what == HELLO && request->a == VERSION
                      ? open_scene(server, options)
                      : status_fail(STATUS_USAGE,
                                    "this program speaks version %d of the channel, the other side "
                                    "%llu: use the package and the program of one version",
                                    VERSION, (unsigned long long)request->a);
  if (!status) status = describe(server, &text);
  if (!status) show(server);
  bool goes_on =
      answer(server, status ? status_exit_code(status) : 0, status ? status_message() : text, VERSION);
  memory_free(text);
  return goes_on && !status;
}

static void close_server(Server *server) {
  for (size_t i = 0; i < server->state_count; i++) drop_state(server, i);
  memory_free(server->states);
  memory_free(server->bytes);
  if (server->map) munmap(server->map, server->map_size);
  app_loop_close(&server->loop);
}

Status app_loop_serve(const AppLoopOptions *options, int socket, int memory) {
  Server server = {.socket = socket, .memory = memory};
  Words request;
  bool goes_on = receive_request(&server, &request) && greet(&server, options, &request);
  while (goes_on && receive_request(&server, &request)) {
    uint64_t b = 0;
    Status status = execute(&server, &request, &b);
    goes_on = reply(&server, status, b);
  }
  close_server(&server);
  return STATUS_OK;
}
