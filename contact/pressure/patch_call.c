// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/patch_call.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/vec3.h"
#include "net/kernel/kernel.h"

enum { TRIANGLES = 8, HIDDEN = 32, POOLED = 32, INPUTS = 14, BLOCK = 32, COLUMNS = TRIANGLES * BLOCK };

static struct {
  float a[INPUTS][HIDDEN], a_bias[HIDDEN], b[HIDDEN][HIDDEN], b_bias[HIDDEN];
  float u[HIDDEN][POOLED], u_bias[POOLED], w[POOLED][POOLED], w_bias[POOLED];
  float o[POOLED][5], o_bias[5], p[POOLED][HIDDEN], q[POOLED][HIDDEN];
} net;
static int mode = -1; // 0 off, 1 exact sums, 2 network
static double spent_net, spent_gather, error_square, force_square, volume_error, volume_sum;
static long calls, pairs_seen;

static double cpu(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void tell(void) {
  fprintf(stderr, "PATCH calls %ld pairs %ld gather_us %.3f net_us %.3f force_error %.4f volume_error %.4f\n", calls, pairs_seen,
          1e6 * spent_gather / (double)calls, 1e6 * spent_net / (double)calls, sqrt(error_square / force_square),
          volume_error / volume_sum);
}

static void start(void) {
  const char *word = getenv("TETLAP_PATCH");
  mode = 0;
  if (!word) return;
  mode = 1;
  atexit(tell);
  if (strcmp(word, "pairs") == 0) mode = 3;
  if (mode == 3) return;
  if (strcmp(word, "exact") == 0) return;
  FILE *file = fopen(word, "rb");
  if (!file || fread(&net, sizeof net, 1, file) != 1) abort();
  fclose(file);
  mode = 2;
}

// A call: cell `own` of side `side` against the other body.
typedef struct Call {
  int facing, side, own, first, count; // its pairs in the order
  double factor;                       // c s
  double volume, centroid[3], slope[3], depth; // of i ∩ B; Σ V g / V; mean depth
  int holder;                          // pair whose other cell holds x̄
  Vec3 normals[TRIANGLES], corners[TRIANGLES][3];
} Call;

typedef struct Key {
  int facing, side, own, pair;
} Key;

static int compare(const void *left, const void *right) {
  const int *a = left, *b = right;
  for (int k = 0; k < 4; k++)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

static Key *keys;
static Call *call_list;
static size_t key_capacity;

static int find_calls(const ContactEvaluation *evaluation) {
  int count = evaluation->mesh_pair_count, made = 0;
  if (key_capacity < (size_t)count) {
    key_capacity = 2 * (size_t)count;
    keys = realloc(keys, 2 * key_capacity * sizeof *keys);
    call_list = realloc(call_list, 2 * key_capacity * sizeof *call_list);
  }
  for (int k = 0; k < count; k++)
    for (int t = 0; t < 2; t++) keys[2 * k + t] = (Key){evaluation->pairs[k].facing, t, evaluation->pairs[k].tets[t], k};
  qsort(keys, 2 * (size_t)count, sizeof *keys, compare);
  for (int k = 0; k < 2 * count; k++) {
    if (mode == 3 || k == 0 || keys[k].facing != keys[k - 1].facing || keys[k].side != keys[k - 1].side || keys[k].own != keys[k - 1].own)
      call_list[made++] = (Call){.facing = keys[k].facing, .side = keys[k].side, .own = keys[k].own, .first = k};
    call_list[made - 1].count++;
  }
  return made;
}

static void sum_exactly(const ContactEvaluation *evaluation, const ContactLayout *layout, Call *call) {
  call->factor = 0;
  for (int k = call->first; k < call->first + call->count; k++) {
    const ContactFieldPair *field = &evaluation->fields[keys[k].pair];
    int other = 1 - call->side;
    call->volume += field->volume;
    call->factor += layout->facings[call->facing].stiffness * field->weighed[call->side];
    call->depth += field->volume * field->depths[other];
    for (int c = 0; c < 3; c++) {
      call->centroid[c] += field->volume * field->centroid[c];
      call->slope[c] += field->volume * field->slopes[other][c];
    }
  }
  call->factor /= call->volume;
  call->depth /= call->volume;
  for (int c = 0; c < 3; c++) call->centroid[c] /= call->volume, call->slope[c] /= call->volume;
}

static const int corners_of[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// The nearest outer triangles of the other body, nearest first, wound outward.
static void find_nearest(const ContactLayout *layout, const double *positions, Call *call) {
  const ContactFacing *facing = &layout->facings[call->facing];
  int body = call->side == 0 ? facing->b : facing->a, places[TRIANGLES], held = 0;
  double best[TRIANGLES], x[12];
  contact_layout_gather(layout, call->own, positions, x);
  Vec3 middle = {0, 0, 0};
  for (int v = 0; v < 4; v++) middle = vec3_add(middle, vec3_scale(0.25, vec3_at(x + 3 * v)));
  for (int cell = layout->depth.cell_begin[body]; cell < layout->depth.cell_begin[body + 1]; cell++)
    for (int f = 0; f < 4; f++) {
      if (!(layout->depth.outer[cell] >> f & 1)) continue;
      Vec3 sum = {0, 0, 0};
      for (int v = 0; v < 3; v++)
        sum = vec3_add(sum, vec3_scale(1 / 3.0, vec3_at(positions + 3 * (size_t)layout->depth.cells[cell][corners_of[f][v]])));
      Vec3 arm = vec3_sub(sum, middle);
      double square = vec3_dot(arm, arm);
      if (held == TRIANGLES && square >= best[held - 1]) continue;
      int at = held < TRIANGLES ? held++ : held - 1;
      for (; at > 0 && best[at - 1] > square; at--) best[at] = best[at - 1], places[at] = places[at - 1];
      best[at] = square;
      places[at] = 4 * cell + f;
    }
  if (held < TRIANGLES) abort();
  for (int k = 0; k < TRIANGLES; k++) {
    const int *cell = layout->depth.cells[places[k] / 4], *of = corners_of[places[k] % 4];
    Vec3 *p = call->corners[k], apex = vec3_at(positions + 3 * (size_t)cell[places[k] % 4]);
    for (int v = 0; v < 3; v++) p[v] = vec3_at(positions + 3 * (size_t)cell[of[v]]);
    Vec3 n = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    if (vec3_dot(n, vec3_sub(apex, p[0])) > 0) {
      Vec3 swapped = p[1];
      p[1] = p[2];
      p[2] = swapped;
      n = vec3_scale(-1, n);
    }
    call->normals[k] = vec3_scale(1 / vec3_length(n), n);
  }
}

static float compress(double y) {
  return (float)(fabs(y) > 3 ? copysign(3 * (1 + log(fabs(y) / 3)), y) : y);
}

// Share of a tetrahedron's volume where a linear function with values h at the vertices is negative, and its centroid.
static double below(const double h[4], float centroid[4]) {
  int order[4] = {0, 1, 2, 3}, count = 0;
  double k[4], points[8][4] = {{0}}, mean[4] = {0}, volume = 0;
  for (int v = 1; v < 4; v++)
    for (int w = v; w > 0 && h[order[w]] < h[order[w - 1]]; w--) {
      int swapped = order[w];
      order[w] = order[w - 1];
      order[w - 1] = swapped;
    }
  for (int v = 0; v < 4; v++) k[v] = h[order[v]], count += k[v] < 0;
  for (int v = 0; v < 4; v++) points[v][v] = 1;
  if (count == 0 || count == 4) {
    for (int v = 0; v < 4; v++) centroid[v] = 0.25f;
    return count / 4;
  }
  if (count != 2) {
    int tip = count == 1 ? 0 : 3;
    double product = 1;
    for (int v = 0; v < 4; v++) {
      double t = v == tip ? 0 : k[tip] / (k[tip] - k[v]);
      if (v != tip) product *= t;
      mean[v] += t / 4, mean[tip] += (1 - t) / 4;
    }
    volume = count == 1 ? product : 1 - product;
    for (int v = 0; v < 4; v++)
      if (count == 3) mean[v] = (0.25 - product * mean[v]) / fmax(volume, 1e-12);
  } else {
    for (int e = 0; e < 4; e++) {
      int from = e / 2, to = 2 + e % 2;
      double t = k[from] / (k[from] - k[to]);
      points[4 + e][from] = 1 - t, points[4 + e][to] = t;
    }
    static const int parts[3][4] = {{0, 4, 5, 7}, {0, 4, 6, 7}, {0, 1, 6, 7}};
    for (int q = 0; q < 3; q++) {
      double m[3][3];
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) m[r][c] = points[parts[q][r + 1]][c + 1] - points[parts[q][0]][c + 1];
      double part = fabs(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
      volume += part;
      for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++) mean[c] += part * points[parts[q][r]][c] / 4;
    }
    for (int c = 0; c < 4; c++) mean[c] /= fmax(volume, 1e-300);
  }
  for (int v = 0; v < 4; v++) centroid[order[v]] = (float)mean[v];
  return volume;
}

typedef struct Frame {
  Vec3 x[4]; // deepest first
  double volume;
  double shares[TRIANGLES]; // of the volume below each triangle's plane
  float means[TRIANGLES][4];
} Frame;

// The inputs of a call: columns t BLOCK + place of a matrix with 9 rows.
static void gather(const ContactLayout *layout, const double *positions, const Call *call, int place, float *inputs, Frame *frame) {
  double x[12], height[4];
  int order[4] = {0, 1, 2, 3};
  contact_layout_gather(layout, call->own, positions, x);
  for (int v = 0; v < 4; v++) height[v] = vec3_dot(vec3_sub(vec3_at(x + 3 * v), call->corners[0][0]), call->normals[0]);
  for (int v = 1; v < 4; v++)
    for (int w = v; w > 0 && height[order[w]] < height[order[w - 1]]; w--) {
      int swapped = order[w];
      order[w] = order[w - 1];
      order[w - 1] = swapped;
    }
  for (int v = 0; v < 4; v++) frame->x[v] = vec3_at(x + 3 * order[v]);
  Vec3 a = vec3_sub(frame->x[1], frame->x[0]), b = vec3_sub(frame->x[2], frame->x[0]), c = vec3_sub(frame->x[3], frame->x[0]);
  Vec3 bc = vec3_cross(b, c);
  double det = vec3_dot(a, bc);
  Vec3 rows[3] = {vec3_scale(1 / det, bc), vec3_scale(1 / det, vec3_cross(c, a)), vec3_scale(1 / det, vec3_cross(a, b))};
  frame->volume = fabs(det) / 6;
  for (int t = 0; t < TRIANGLES; t++) {
    double y[3][3], rest[3];
    for (int v = 0; v < 3; v++) {
      Vec3 arm = vec3_sub(call->corners[t][det < 0 ? (3 - v) % 3 : v], frame->x[0]);
      for (int d = 0; d < 3; d++) y[v][d] = vec3_dot(rows[d], arm);
      rest[v] = 1 - y[v][0] - y[v][1] - y[v][2];
    }
    double h[4];
    for (int v = 0; v < 4; v++) h[v] = vec3_dot(vec3_sub(frame->x[v], call->corners[t][0]), call->normals[t]);
    frame->shares[t] = fmax(below(h, frame->means[t]), 1e-9);
    int at = BLOCK * t + place;
    inputs[COLUMNS * 9 + at] = logf((float)frame->shares[t] + 1e-4f) / 3;
    for (int v = 0; v < 4; v++) inputs[COLUMNS * (10 + v) + at] = frame->means[t][v];
    int least = rest[1] < rest[0] ? 1 : 0;
    if (rest[2] < rest[least]) least = 2;
    for (int v = 0; v < 3; v++)
      for (int d = 0; d < 3; d++) inputs[COLUMNS * (3 * v + d) + BLOCK * t + place] = compress(y[(least + v) % 3][d]);
  }
}

static void layer(const NetKernel_f32 *kernel, int m, int n, int k, const float *weights, const float *bias, const float *b, float *c,
                  bool has_relu) {
  NetProduct_f32 product = {.m = m, .n = n, .k = k, .a = weights, .a_row = 1, .a_column = m, .b = b, .b_row = n, .bias = bias,
                            .c = c, .c_row = n, .has_relu = has_relu};
  kernel->product(&product);
}

static void attend(const float *g, const float *p, float share[TRIANGLES][BLOCK]) {
  memset(share, 0, TRIANGLES * sizeof *share);
  for (int r = 0; r < HIDDEN; r++)
    for (int t = 0; t < TRIANGLES; t++)
      for (int j = 0; j < BLOCK; j++) share[t][j] += g[COLUMNS * r + BLOCK * t + j] * p[BLOCK * r + j];
  for (int j = 0; j < BLOCK; j++) {
    float most = share[0][j], total = 0;
    for (int t = 1; t < TRIANGLES; t++) most = fmaxf(most, share[t][j]);
    for (int t = 0; t < TRIANGLES; t++) total += share[t][j] = expf((share[t][j] - most) / 6);
    for (int t = 0; t < TRIANGLES; t++) share[t][j] /= total;
  }
}

static void ask_network(const ContactLayout *layout, const double *positions, int count, Call *list) {
  static _Alignas(64) float inputs[INPUTS * COLUMNS], h[HIDDEN * COLUMNS], g[HIDDEN * COLUMNS], sum[HIDDEN * BLOCK],
      u[POOLED * BLOCK], w[POOLED * BLOCK], out[5 * BLOCK], p[HIDDEN * BLOCK], q[HIDDEN * BLOCK], near[TRIANGLES][BLOCK],
      turn[TRIANGLES][BLOCK];
  const NetKernel_f32 *kernel = net_kernel_f32(net_kernel_best());
  Frame frames[BLOCK];
  double t0 = cpu();
  for (int k = 0; k < count; k++) gather(layout, positions, &list[k], k, inputs, &frames[k]);
  double t1 = cpu();
  layer(kernel, HIDDEN, COLUMNS, INPUTS, net.a[0], net.a_bias, inputs, h, true);
  layer(kernel, HIDDEN, COLUMNS, HIDDEN, net.b[0], net.b_bias, h, g, true);
  for (int r = 0; r < HIDDEN; r++)
    for (int j = 0; j < BLOCK; j++) {
      float s = 0;
      for (int t = 0; t < TRIANGLES; t++) s += g[COLUMNS * r + BLOCK * t + j];
      sum[BLOCK * r + j] = s / 4;
    }
  layer(kernel, POOLED, BLOCK, HIDDEN, net.u[0], net.u_bias, sum, u, true);
  layer(kernel, POOLED, BLOCK, POOLED, net.w[0], net.w_bias, u, w, true);
  layer(kernel, 5, BLOCK, POOLED, net.o[0], net.o_bias, w, out, false);
  layer(kernel, HIDDEN, BLOCK, POOLED, net.p[0], NULL, w, p, false);
  layer(kernel, HIDDEN, BLOCK, POOLED, net.q[0], NULL, w, q, false);
  attend(g, p, near);
  attend(g, q, turn);
  for (int j = 0; j < count; j++) {
    const Frame *frame = &frames[j];
    Call *call = &list[j];
    double share = 0, z[4] = {0}, total = 0;
    for (int t = 0; t < TRIANGLES; t++) {
      double part = near[t][j] * frame->shares[t];
      share += part;
      for (int v = 0; v < 4; v++) z[v] += part * frame->means[t][v];
    }
    for (int v = 0; v < 4; v++) total += z[v] = fmax(z[v] / share, 1e-6) * (v == 0 ? 1 : exp(out[BLOCK * v + j]));
    Vec3 slope = {0, 0, 0}, at = {0, 0, 0};
    for (int v = 0; v < 4; v++) at = vec3_add(at, vec3_scale(z[v] / total, frame->x[v]));
    call->depth = 0;
    for (int t = 0; t < TRIANGLES; t++) {
      slope = vec3_sub(slope, vec3_scale(turn[t][j], call->normals[t]));
      call->depth += turn[t][j] * vec3_dot(call->normals[t], vec3_sub(call->corners[t][0], at));
    }
    call->volume = frame->volume * share * exp(1.5 * tanh(out[j]));
    vec3_store(call->centroid, at);
    vec3_store(call->slope, slope);
  }
  spent_gather += t1 - t0;
  spent_net += cpu() - t1;
}

static void locate(const double x[12], const double at[3], double lambda[4]) {
  Vec3 o = vec3_at(x), a = vec3_sub(vec3_at(x + 3), o), b = vec3_sub(vec3_at(x + 6), o), c = vec3_sub(vec3_at(x + 9), o),
       r = vec3_sub(vec3_at(at), o);
  double det = vec3_dot(a, vec3_cross(b, c));
  lambda[1] = vec3_dot(r, vec3_cross(b, c)) / det;
  lambda[2] = vec3_dot(r, vec3_cross(c, a)) / det;
  lambda[3] = vec3_dot(r, vec3_cross(a, b)) / det;
  lambda[0] = 1 - lambda[1] - lambda[2] - lambda[3];
}

static void hand_on(ContactEvaluation *evaluation, const ContactLayout *layout, Call *call) {
  double most = -INFINITY, held[4] = {0};
  for (int k = call->first; k < call->first + call->count; k++) {
    int pair = keys[k].pair;
    double lambda[4], least = INFINITY;
    locate(evaluation->coordinates + 24 * (size_t)pair + 12 * (1 - call->side), call->centroid, lambda);
    for (int v = 0; v < 4; v++) least = fmin(least, lambda[v]);
    if (least > most) {
      most = least;
      call->holder = pair;
      memcpy(held, lambda, sizeof held);
    }
  }
  double own[4], *gradient = evaluation->gradients + 24 * (size_t)call->holder;
  locate(evaluation->coordinates + 24 * (size_t)call->holder + 12 * call->side, call->centroid, own);
  contact_depth_fold(&layout->depth, &layout->def, call->own, own);
  contact_depth_fold(&layout->depth, &layout->def, evaluation->pairs[call->holder].tets[1 - call->side], held);
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) {
      double force = -call->factor * call->volume * call->slope[c];
      gradient[12 * call->side + 3 * v + c] -= own[v] * force;
      gradient[12 * (1 - call->side) + 3 * v + c] += held[v] * force;
    }
  evaluation->fields[call->holder].energy += call->factor * call->volume * call->depth;
}

void contact_patch_call_press(ContactEvaluation *evaluation, const ContactLayout *layout) {
  if (mode < 0) start();
  if (mode == 0 || evaluation->mesh_pair_count == 0) return;
  int count = find_calls(evaluation);
  for (int k = 0; k < count; k++) {
    sum_exactly(evaluation, layout, &call_list[k]);
    if (mode == 2) find_nearest(layout, evaluation->positions, &call_list[k]);
  }
  for (int first = 0; mode == 2 && first < count; first += BLOCK) {
    Call exact[BLOCK];
    int some = count - first < BLOCK ? count - first : BLOCK;
    memcpy(exact, call_list + first, (size_t)some * sizeof *exact);
    ask_network(layout, evaluation->positions, some, call_list + first);
    for (int k = 0; k < some; k++) {
      const Call *call = &call_list[first + k];
      volume_error += fabs(call->volume - exact[k].volume);
      volume_sum += exact[k].volume;
      for (int c = 0; c < 3; c++) {
        double is = call->factor * call->volume * call->slope[c], was = call->factor * exact[k].volume * exact[k].slope[c];
        error_square += (is - was) * (is - was);
        force_square += was * was;
      }
    }
  }
  calls += count;
  pairs_seen += evaluation->mesh_pair_count;
  memset(evaluation->gradients, 0, 24 * (size_t)evaluation->mesh_pair_count * sizeof(double));
  for (int k = 0; k < evaluation->mesh_pair_count; k++) evaluation->fields[k].energy = 0;
  for (int k = 0; k < count; k++) hand_on(evaluation, layout, &call_list[k]);
}
