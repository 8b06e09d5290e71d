// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/friction.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/shape/shape.h"

// An element that is pressed with less than this share of the norms of its forces is not pressed along its
// normal: it lies nearly inside the other body.
static const double LEAST_DIRECTION = 1e-3;

Status contact_friction_create(ContactFriction *friction, ContactSystem *system, double coefficient,
                               double slip_speed) {
  *friction = (ContactFriction){.system = system, .slip_speed = slip_speed};
  if (!(coefficient >= 0 && isfinite(coefficient)))
    return status_fail(STATUS_INPUT, "friction: the coefficient is %g; it must not be negative", coefficient);
  if (!(slip_speed > 0 && isfinite(slip_speed)))
    return status_fail(STATUS_INPUT, "friction: the slip speed is %g m/s; it must be positive", slip_speed);
  contact_system_interfaces(system, &friction->interface_count);
  size_t count = (size_t)friction->interface_count;
  friction->coefficients = memory_zeroed(count, sizeof *friction->coefficients);
  friction->forces = memory_zeroed(count, sizeof *friction->forces);
  if (!friction->coefficients || !friction->forces) return status_no_memory("friction");
  for (size_t i = 0; i < count; i++) friction->coefficients[i] = coefficient;
  return STATUS_OK;
}

void contact_friction_destroy(ContactFriction *friction) {
  memory_free(friction->coefficients);
  memory_free(friction->forces);
  memory_free(friction->grips);
  memory_free(friction->vertices);
  memory_free(friction->weights);
  memory_free(friction->outer);
  memory_free(friction->place);
  memory_free(friction->forces_around);
  *friction = (ContactFriction){0};
}

size_t contact_friction_bytes(const ContactFriction *friction) {
  const void *const arrays[] = {friction->coefficients, friction->grips, friction->vertices,
                                friction->weights,      friction->outer, friction->forces_around,
                                friction->place,        friction->forces};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

// Where an element is met: its place in the evaluation's lists.
typedef struct Meeting {
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const ContactElement *element;
  const int *pairs; // (pair_count)
  int pair_count;
} Meeting;

// Which of the pair's tetrahedra the element is.
static int side_in(const Meeting *meeting, int pair) {
  const ContactPatches *patches = &meeting->evaluation->patches;
  int first = patches->pair_elements[pair][0];
  return first >= 0 && &patches->elements[first] == meeting->element ? 0 : 1;
}

// F of an element.
static Vec3 force_on(const Meeting *meeting) {
  Vec3 sum = {0, 0, 0};
  for (int r = 0; r < meeting->pair_count; r++) {
    int k = meeting->pairs[r];
    const double *gradient = meeting->evaluation->gradients + 24 * (size_t)k + 12 * side_in(meeting, k);
    for (int v = 0; v < 4; v++)
      sum = vec3_sub(sum, vec3_scale(meeting->evaluation->pressures[k], vec3_at(gradient + 3 * v)));
  }
  return sum;
}

// The sum of the norms that F is made of.
static double norms_on(const Meeting *meeting) {
  double sum = 0;
  for (int r = 0; r < meeting->pair_count; r++) {
    int k = meeting->pairs[r];
    const double *gradient = meeting->evaluation->gradients + 24 * (size_t)k + 12 * side_in(meeting, k);
    for (int v = 0; v < 4; v++)
      sum += meeting->evaluation->pressures[k] * vec3_length(vec3_at(gradient + 3 * v));
  }
  return sum;
}

// What presses an element along its normal; force 0: nothing.
typedef struct Press {
  Vec3 normal;
  double force;
} Press;

static Press press_on(const ContactFriction *friction, const Meeting *meeting, int element) {
  const double *by_node = friction->forces_around + 3 * (size_t)meeting->evaluation->patches.element_count;
  Vec3 around = {0, 0, 0};
  for (int v = 0; v < 4; v++)
    around = vec3_add(around, vec3_at(by_node + 3 * (size_t)meeting->element->nodes[v]));
  double length = vec3_length(around);
  if (!(length > 0)) return (Press){.force = 0};
  Press press = {.normal = vec3_scale(1 / length, around)};
  double force = vec3_dot(vec3_at(friction->forces_around + 3 * (size_t)element), press.normal);
  press.force = force > LEAST_DIRECTION * norms_on(meeting) ? force : 0;
  return press;
}

static Meeting meeting_at(const ContactFriction *friction, const ContactEvaluation *evaluation, int element) {
  const ContactRows *rows = &evaluation->patches.element_pairs;
  return (Meeting){.layout = contact_system_layout(friction->system),
                   .evaluation = evaluation,
                   .element = &evaluation->patches.elements[element],
                   .pairs = rows->items + rows->begin[element],
                   .pair_count = rows->begin[element + 1] - rows->begin[element]};
}

// F of the elements and its sums at the nodes.
static Status sum_forces(ContactFriction *friction, const ContactEvaluation *evaluation) {
  const ContactPatches *patches = &evaluation->patches;
  size_t elements = (size_t)patches->element_count, nodes = (size_t)patches->node_count;
  if (!memory_reserve((void **)&friction->forces_around, &friction->around_capacity, 3 * (elements + nodes),
                      sizeof(double)))
    return status_no_memory("friction");
  double *by_node = friction->forces_around + 3 * elements;
  for (size_t k = 0; k < 3 * nodes; k++) by_node[k] = 0;
  for (int e = 0; e < patches->element_count; e++) {
    Meeting meeting = meeting_at(friction, evaluation, e);
    Vec3 force = force_on(&meeting);
    vec3_store(friction->forces_around + 3 * (size_t)e, force);
    for (int v = 0; v < 4; v++) vec3_accumulate(by_node + 3 * (size_t)meeting.element->nodes[v], force);
  }
  return STATUS_OK;
}

static Status reserve(ContactFriction *friction, int entry_count) {
  size_t n = (size_t)entry_count;
  bool fits = memory_reserve((void **)&friction->vertices, &friction->vertex_capacity, n, sizeof(int)) &&
              memory_reserve((void **)&friction->weights, &friction->weight_capacity, n, sizeof(double)) &&
              memory_reserve((void **)&friction->outer, &friction->outer_capacity, 3 * n, sizeof(double));
  return fits ? STATUS_OK : status_no_memory("friction");
}

// The weight of a node in the grip that is being filled.
static double *weight_of(ContactFriction *friction, ContactGrip *grip, const ContactPatches *patches,
                         int node) {
  int *place = &friction->place[node];
  if (*place == 0) {
    int entry = grip->begin + grip->count;
    friction->vertices[entry] = patches->nodes[node].vertex;
    friction->weights[entry] = 0;
    *place = ++grip->count;
  }
  return &friction->weights[grip->begin + *place - 1];
}

static void fill_weights(ContactFriction *friction, const Meeting *meeting, Press press, ContactGrip *grip) {
  const ContactEvaluation *evaluation = meeting->evaluation;
  const ContactPatches *patches = &evaluation->patches;
  for (int r = 0; r < meeting->pair_count; r++) {
    int k = meeting->pairs[r];
    for (int side = 0; side < 2; side++) {
      int e = patches->pair_elements[k][side];
      if (e < 0) continue;
      const double *gradient = evaluation->gradients + 24 * (size_t)k + 12 * side;
      for (int v = 0; v < 4; v++)
        *weight_of(friction, grip, patches, patches->elements[e].nodes[v]) +=
            -evaluation->pressures[k] * vec3_dot(vec3_at(gradient + 3 * v), press.normal) / press.force;
    }
  }
  for (int r = 0; r < meeting->pair_count; r++)
    for (int side = 0; side < 2; side++) {
      int e = patches->pair_elements[meeting->pairs[r]][side];
      for (int v = 0; e >= 0 && v < 4; v++) friction->place[patches->elements[e].nodes[v]] = 0;
    }
}

// Against an obstacle μ, between bodies, whose elements count on both sides, half of it.
static double coefficient_of(const ContactFriction *friction, const ContactLayout *layout, int facing,
                             int side) {
  return friction->coefficients[facing] * layout->facings[facing].weight[side];
}

// The velocity of a shape where it is pressed.
static void set_obstacle(const ContactFriction *friction, const Meeting *meeting, ContactGrip *grip) {
  int s = meeting->layout->facings[grip->interface].shape;
  if (s < 0) return;
  Vec3 x = {0, 0, 0};
  for (int n = grip->begin; n < grip->begin + grip->count; n++) {
    Vec3 vertex = vec3_at(meeting->evaluation->positions + 3 * (size_t)friction->vertices[n]);
    x = vec3_add(x, vec3_scale(friction->weights[n], vertex));
  }
  vec3_store(grip->obstacle,
             contact_shape_velocity(&meeting->layout->def.shapes[s], meeting->evaluation->time, x));
}

static Status take_element(ContactFriction *friction, const Meeting *meeting, int element) {
  int facing = meeting->evaluation->pairs[meeting->pairs[0]].facing, side = meeting->element->side;
  double coefficient = coefficient_of(friction, meeting->layout, facing, side);
  if (!(coefficient > 0)) return STATUS_OK;
  Press press = press_on(friction, meeting, element);
  friction->dropped += !(press.force > 0);
  if (!(press.force > 0)) return STATUS_OK;
  TRY(reserve(friction, friction->entry_count + 4 + 4 * meeting->pair_count));
  ContactGrip *grip = &friction->grips[friction->grip_count++];
  *grip = (ContactGrip){
      .interface = facing, .side = side, .begin = friction->entry_count, .limit = coefficient * press.force};
  vec3_store(grip->normal, press.normal);
  fill_weights(friction, meeting, press, grip);
  set_obstacle(friction, meeting, grip);
  friction->entry_count += grip->count;
  friction->taken++;
  return STATUS_OK;
}

Status contact_friction_update(ContactFriction *friction) {
  const ContactEvaluation *evaluation;
  TRY(contact_system_look(friction->system, &evaluation));
  const ContactPatches *patches = &evaluation->patches;
  bool fits = memory_reserve((void **)&friction->grips, &friction->grip_capacity,
                             (size_t)patches->element_count, sizeof *friction->grips) &&
              memory_reserve((void **)&friction->place, &friction->place_capacity,
                             (size_t)patches->node_count, sizeof *friction->place);
  if (!fits) return status_no_memory("friction");
  friction->grip_count = friction->entry_count = 0;
  friction->updates++;
  TRY(sum_forces(friction, evaluation));
  for (int e = 0; e < patches->element_count; e++) {
    Meeting meeting = meeting_at(friction, evaluation, e);
    TRY(take_element(friction, &meeting, e));
  }
  return STATUS_OK;
}

// The slip velocity of a grip, in its tangent plane.
static Vec3 slip_of(const ContactFriction *friction, const ContactGrip *grip, const double *velocities) {
  Vec3 slip = vec3_scale(-1, vec3_at(grip->obstacle)), normal = vec3_at(grip->normal);
  for (int n = grip->begin; n < grip->begin + grip->count; n++) {
    Vec3 velocity = vec3_at(velocities + 3 * (size_t)friction->vertices[n]);
    slip = vec3_add(slip, vec3_scale(friction->weights[n], velocity));
  }
  return vec3_sub(slip, vec3_scale(vec3_dot(slip, normal), normal));
}

// φ(|s|/ε) / |s|, finite at rest.
static double resistance(double speed, double slip_speed) {
  return speed < slip_speed ? (2 - speed / slip_speed) / slip_speed : 1 / speed;
}

// The friction force on the element.
static Vec3 force_of(const ContactFriction *friction, const ContactGrip *grip, Vec3 slip) {
  return vec3_scale(-grip->limit * resistance(vec3_length(slip), friction->slip_speed), slip);
}

void contact_friction_add_force(const ContactFriction *friction, const double *velocities, double *force) {
  for (int g = 0; g < friction->grip_count; g++) {
    const ContactGrip *grip = &friction->grips[g];
    Vec3 pull = force_of(friction, grip, slip_of(friction, grip, velocities));
    for (int n = grip->begin; n < grip->begin + grip->count; n++)
      vec3_accumulate(force + 3 * (size_t)friction->vertices[n], vec3_scale(friction->weights[n], pull));
  }
}

// Two unit vectors that make a right-handed frame with the normal, the first along the slip if there is any.
static void tangents(Vec3 normal, Vec3 slip, Vec3 tangent[2]) {
  double speed = vec3_length(slip);
  if (!(speed > 0)) {
    Vec3 least = fabs(normal.x) < 0.6 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0};
    slip = vec3_cross(normal, least);
    speed = vec3_length(slip);
  }
  tangent[0] = vec3_scale(1 / speed, slip);
  tangent[1] = vec3_cross(normal, tangent[0]);
}

// −∂f/∂s = μ N [ φ′/ε t tᵀ + φ/|s| b bᵀ ], t along the slip, b across; both factors ≥ 0.
void contact_friction_add_damping(ContactFriction *friction, const double *velocities,
                                  const ContactStiffnessSink *sink) {
  double slip_speed = friction->slip_speed;
  for (int g = 0; g < friction->grip_count; g++) {
    const ContactGrip *grip = &friction->grips[g];
    Vec3 slip = slip_of(friction, grip, velocities), tangent[2];
    double speed = vec3_length(slip);
    double along = speed < slip_speed ? 2 * (1 - speed / slip_speed) / slip_speed : 0;
    double *w = friction->outer + 3 * (size_t)grip->begin;
    const double slopes[2] = {grip->limit * along, grip->limit * resistance(speed, slip_speed)};
    tangents(vec3_at(grip->normal), slip, tangent);
    for (int k = 0; k < 2; k++) {
      if (!(slopes[k] > 0)) continue;
      for (int n = 0; n < grip->count; n++)
        vec3_store(w + 3 * n, vec3_scale(friction->weights[grip->begin + n], tangent[k]));
      sink->add_outer(sink->self, grip->count, friction->vertices + grip->begin, w, slopes[k]);
    }
  }
}

ContactFrictionPower contact_friction_power(ContactFriction *friction, const double *velocities) {
  ContactFrictionPower power = {0, 0};
  for (int i = 0; i < friction->interface_count; i++)
    if (!contact_system_is_resting(friction->system, i)) vec3_store(friction->forces[i], (Vec3){0, 0, 0});
  for (int g = 0; g < friction->grip_count; g++) {
    const ContactGrip *grip = &friction->grips[g];
    Vec3 slip = slip_of(friction, grip, velocities), pull = force_of(friction, grip, slip);
    power.dissipated -= vec3_dot(pull, slip);
    power.driven += vec3_dot(pull, vec3_at(grip->obstacle));
    if (contact_system_is_resting(friction->system, grip->interface)) continue;
    vec3_accumulate(friction->forces[grip->interface], grip->side == 0 ? pull : vec3_scale(-1, pull));
  }
  return power;
}
