// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/multigrid/level.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"

// The loops that read all of a matrix, also for the instructions that most processors have.
#if defined(__x86_64__) && !defined(__clang__)
#define FASTEST __attribute__((target_clones("avx2", "default")))
#else
#define FASTEST
#endif
// What they call, to be compiled for the same instructions.
#define INLINE static inline __attribute__((always_inline))

// As many chunks, at least: enough for many threads in each stage. Longer ones converge faster, since
// within them a sweep goes from neighbour to neighbour.
enum { CHUNKS = 64 };

static Status no_memory(void) {
  return status_no_memory("the multigrid of the condensed system");
}

// ---- Transposed rows.

// Columns of a matrix: rows ascending, and where their values stand.
typedef struct Columns {
  int *begin, *row, *source;
} Columns;

static void destroy_columns(Columns *columns) {
  memory_free(columns->begin), memory_free(columns->row), memory_free(columns->source);
}

static Status transpose(const FemRows *rows, Columns *columns) {
  size_t entries = (size_t)rows->begin[rows->count];
  columns->begin = memory_zeroed((size_t)rows->column_count + 2, sizeof *columns->begin);
  columns->row = memory_zeroed(entries, sizeof *columns->row);
  columns->source = memory_zeroed(entries, sizeof *columns->source);
  if (!columns->begin || !columns->row || !columns->source) return no_memory();
  int *end = columns->begin + 1; // of the column before: becomes where each ends
  for (int k = 0; k < rows->begin[rows->count]; k++) end[rows->column[k] + 1]++;
  for (int j = 0; j < rows->column_count; j++) end[j + 1] += end[j];
  for (int i = 0; i < rows->count; i++)
    for (int k = rows->begin[i]; k < rows->begin[i + 1]; k++) {
      int at = end[rows->column[k]]++;
      columns->row[at] = i, columns->source[at] = k;
    }
  return STATUS_OK;
}

// ---- Stages.

// While nodes are put in order.
typedef struct Stages {
  const FemRows *matrix;
  const Columns *columns; // NULL: entries have mirror images
  int size, chunk_count;  // rows of a chunk; chunks
  int *stage;             // of each chunk                             (chunk_count)
  int *seen;              // the last chunk that has a neighbour there (chunk_count + 1)
  int *next;              // where the next chunk of each stage goes   (chunk_count + 1)
} Stages;

static int smaller(int a, int b) {
  return a < b ? a : b;
}

static void see(Stages *stages, int chunk, const int *others, int begin, int end) {
  for (int k = begin; k < end; k++) {
    int other = others[k] / stages->size;
    if (other < chunk) stages->seen[stages->stage[other]] = chunk + 1;
  }
}

// The first stage in which a chunk has no neighbour, by row or by column. Returns how many stages there are.
static int choose_stages(Stages *stages) {
  const FemRows *matrix = stages->matrix;
  const Columns *columns = stages->columns;
  int count = 0;
  for (int c = 0; c < stages->chunk_count; c++) {
    int begin = c * stages->size, end = smaller(begin + stages->size, matrix->count), stage = 0;
    see(stages, c, matrix->column, matrix->begin[begin], matrix->begin[end]);
    if (columns) see(stages, c, columns->row, columns->begin[begin], columns->begin[end]);
    while (stages->seen[stage] == c + 1) stage++;
    stages->stage[c] = stage;
    count = stage + 1 > count ? stage + 1 : count;
  }
  return count;
}

static void number_places(const Stages *stages, FemLevel *level) {
  int nodes = stages->size / level->width;
  for (int c = 0; c < stages->chunk_count; c++) level->stage[stages->stage[c] + 1]++;
  for (int s = 0; s < level->stage_count; s++) {
    stages->next[s] = level->stage[s];
    level->stage[s + 1] += level->stage[s];
  }
  // The chunk at each position is noted where its first place will stand.
  for (int c = 0; c < stages->chunk_count; c++) level->chunk[stages->next[stages->stage[c]]++] = c;
  int place = 0;
  for (int k = 0; k < stages->chunk_count; k++) {
    int begin = level->chunk[k] * nodes, end = smaller(begin + nodes, level->count);
    level->chunk[k] = place;
    for (int node = begin; node < end; node++) {
      level->order[place] = node;
      level->place[node] = place++;
    }
  }
  level->chunk[stages->chunk_count] = place;
}

static Status put_in_stages(FemLevel *level, const FemRows *matrix, const Columns *columns, int chunk) {
  int size = chunk * level->width, chunk_count = (matrix->count + size - 1) / size;
  Stages stages = {matrix, columns, size, chunk_count, NULL, NULL, NULL};
  size_t chunks = (size_t)chunk_count, nodes = (size_t)level->count;
  stages.stage = memory_zeroed(chunks, sizeof *stages.stage);
  stages.seen = memory_zeroed(chunks + 1, sizeof *stages.seen);
  stages.next = memory_zeroed(chunks + 1, sizeof *stages.next);
  level->order = memory_zeroed(nodes, sizeof *level->order);
  level->place = memory_zeroed(nodes, sizeof *level->place);
  level->chunk = memory_zeroed(chunks + 1, sizeof *level->chunk);
  bool fits = stages.stage && stages.seen && stages.next && level->order && level->place && level->chunk;
  if (fits) {
    level->stage_count = choose_stages(&stages);
    level->stage = memory_zeroed((size_t)level->stage_count + 1, sizeof *level->stage);
    fits = level->stage;
  }
  if (fits) number_places(&stages, level);
  memory_free(stages.stage), memory_free(stages.seen), memory_free(stages.next);
  return fits ? STATUS_OK : no_memory();
}

// ---- The matrix.

// Numbers of a block of three rows; what is read of the last one and beyond it.
enum { BLOCK = 9, BEYOND = 1 };

static size_t block_size(const FemLevel *level) {
  return level->width == 1 ? 1 : BLOCK;
}

// Neighbours of each node: `begin` and `middle`, the entries of earlier places first.
static Status count_entries(FemLevel *level, const FemRows *matrix) {
  const int width = level->width;
  int *seen = memory_zeroed((size_t)level->count, sizeof *seen); // the last place that has met each
  if (!seen) return no_memory();
  for (int p = 0; p < level->count; p++) {
    int first = width * level->order[p], lower = 0, all = 0;
    for (int k = matrix->begin[first]; k < matrix->begin[first + width]; k++) {
      int other = level->place[matrix->column[k] / width];
      if (other == p || seen[other] == p + 1) continue;
      seen[other] = p + 1;
      all++;
      lower += other < p;
    }
    level->middle[p] = level->begin[p] + lower;
    level->begin[p + 1] = level->begin[p] + all;
  }
  memory_free(seen);
  return STATUS_OK;
}

// Where the block of `column` is among [begin, *end), or is now, at the end.
static int slot_of(const FemLevel *level, int begin, int *end, int column) {
  int k = begin;
  while (k < *end && level->column[k] != column) k++;
  if (k == *end) level->column[(*end)++] = column;
  return k;
}

static void fill_node(FemLevel *level, const FemRows *matrix, int p) {
  const int width = level->width, first = width * level->order[p];
  int lower = level->begin[p], upper = level->middle[p], last = -1, slot = 0;
  double *diagonal = level->diagonal + (size_t)width * (size_t)width * (size_t)p;
  for (int r = 0; r < width; r++)
    for (int k = matrix->begin[first + r]; k < matrix->begin[first + r + 1]; k++) {
      int other = level->place[matrix->column[k] / width], c = matrix->column[k] % width;
      if (other == p) {
        double value = matrix->value[k];
        diagonal[width * r + c] = r != c ? value : value > 0 ? 1 / value : 0;
        continue;
      }
      if (other != last && width > 1)
        slot = other < p ? slot_of(level, level->begin[p], &lower, other)
                         : slot_of(level, level->middle[p], &upper, other);
      if (width == 1) level->column[slot = other < p ? lower++ : upper++] = other;
      last = other;
      level->value[block_size(level) * (size_t)slot + (size_t)(3 * c + r)] = (float)matrix->value[k];
    }
}

static Status fill(FemLevel *level, const FemRows *matrix) {
  bool is_positive = true;
#pragma omp parallel for schedule(static) reduction(&& : is_positive) if (level->count > 1000)
  for (int p = 0; p < level->count; p++) {
    fill_node(level, matrix, p);
    for (int r = 0; r < level->width; r++)
      is_positive = is_positive && level->diagonal[(p * level->width + r) * level->width + r] > 0;
  }
  return is_positive ? STATUS_OK : status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
}

static Status make_matrix(FemLevel *level, const FemRows *matrix) {
  size_t nodes = (size_t)level->count, rows = (size_t)matrix->count;
  level->begin = memory_zeroed(nodes + 1, sizeof *level->begin);
  level->middle = memory_zeroed(nodes, sizeof *level->middle);
  if (!level->begin || !level->middle) return no_memory();
  TRY(count_entries(level, matrix));
  size_t entries = (size_t)level->begin[level->count];
  level->column = memory_zeroed(entries, sizeof *level->column);
  level->value = memory_zeroed(entries * block_size(level) + BEYOND, sizeof *level->value);
  level->diagonal = memory_zeroed(rows * (size_t)level->width, sizeof *level->diagonal);
  level->b = memory_zeroed(rows, sizeof *level->b);
  level->x = memory_zeroed(rows, sizeof *level->x);
  level->r = memory_zeroed(rows, sizeof *level->r);
  bool fits = level->column && level->value && level->diagonal && level->b && level->x && level->r;
  return fits ? fill(level, matrix) : no_memory();
}

Status fem_level_create(FemLevel *level, const FemRows *matrix, int width) {
  int nodes = matrix->count / width, chunk = nodes > CHUNKS ? nodes / CHUNKS : 1;
  *level = (FemLevel){.width = width, .count = matrix->count / width};
  Columns columns = {0};
  Status status = width == 1 ? transpose(matrix, &columns) : STATUS_OK;
  if (!status) status = put_in_stages(level, matrix, width == 1 ? &columns : NULL, chunk);
  if (!status) status = make_matrix(level, matrix);
  destroy_columns(&columns);
  if (status) fem_level_destroy(level);
  return status;
}

static void destroy_map(FemLevelMap *map) {
  memory_free(map->begin), memory_free(map->column), memory_free(map->value);
}

void fem_level_destroy(FemLevel *level) {
  memory_free(level->order), memory_free(level->place), memory_free(level->stage), memory_free(level->chunk);
  memory_free(level->begin), memory_free(level->middle), memory_free(level->column);
  memory_free(level->value), memory_free(level->diagonal);
  memory_free(level->b), memory_free(level->x), memory_free(level->r);
  destroy_map(&level->to_coarse), destroy_map(&level->from_coarse);
  *level = (FemLevel){0};
}

// ---- Maps.

// Rows at the places of `to`, columns as places of `from`. Row i has the entries begin[i] … of `column`,
// whose values stand there, or where `source` says.
static Status make_map(FemLevelMap *map, const FemLevel *to, const FemLevel *from, const int *begin,
                       const int *column, const double *value, const int *source) {
  const int width = to->width, count = width * to->count;
  map->count = count;
  map->begin = memory_zeroed((size_t)count + 1, sizeof *map->begin);
  map->column = memory_zeroed((size_t)begin[count], sizeof *map->column);
  map->value = memory_zeroed((size_t)begin[count], sizeof *map->value);
  if (!map->begin || !map->column || !map->value) return no_memory();
  int end = 0;
  for (int p = 0; p < count; p++) {
    int row = width * to->order[p / width] + p % width;
    for (int k = begin[row]; k < begin[row + 1]; k++) {
      map->column[end] = fem_level_place(from, column[k]);
      map->value[end++] = (float)value[source ? source[k] : k];
    }
    map->begin[p + 1] = end;
  }
  return STATUS_OK;
}

Status fem_level_connect(FemLevel *level, const FemLevel *coarse, const FemRows *interpolation) {
  Columns columns = {0};
  Status status = transpose(interpolation, &columns);
  if (!status)
    status = make_map(&level->to_coarse, coarse, level, columns.begin, columns.row, interpolation->value,
                      columns.source);
  destroy_columns(&columns);
  TRY(status);
  return make_map(&level->from_coarse, level, coarse, interpolation->begin, interpolation->column,
                  interpolation->value, NULL);
}

// ---- Work of a team.

typedef struct Range {
  int begin, end;
} Range;

static Range share_of(FemTeam team, int begin, int end) {
  long long count = end - begin;
  return (Range){begin + (int)(count * team.rank / team.size),
                 begin + (int)(count * (team.rank + 1) / team.size)};
}

static void wait_for_all(FemTeam team) {
  if (team.size > 1) {
#pragma omp barrier
  }
}

// Nodes of this thread in a stage.
static Range nodes_of_stage(const FemLevel *level, int stage, FemTeam team) {
  Range chunks = share_of(team, level->stage[stage], level->stage[stage + 1]);
  return (Range){level->chunk[chunks.begin], level->chunk[chunks.end]};
}

// Two sums side by side.
INLINE double dot(const float *value, const int *column, int begin, int end, const double *x) {
  double even = 0, odd = 0;
  int k = begin;
  for (; k + 2 <= end; k += 2) {
    even += (double)value[k] * x[column[k]];
    odd += (double)value[k + 1] * x[column[k + 1]];
  }
  if (k < end) even += (double)value[k] * x[column[k]];
  return even + odd;
}

// Three numbers of a node, and one without a meaning.
typedef double Four __attribute__((vector_size(4 * sizeof(double))));
typedef float FourFloats __attribute__((vector_size(4 * sizeof(float))));

// Blocks [begin, end) times x.
INLINE void add_blocks(const FemLevel *level, int begin, int end, Four *sum) {
  const float *block = level->value + BLOCK * (size_t)begin;
  Four all = {0, 0, 0, 0};
  for (int k = begin; k < end; k++, block += BLOCK) {
    const double *x = level->x + 3 * (size_t)level->column[k];
    FourFloats columns[3];
    for (int c = 0; c < 3; c++) memcpy(&columns[c], block + 3 * c, sizeof *columns);
    all += __builtin_convertvector(columns[0], Four) * x[0] +
           __builtin_convertvector(columns[1], Four) * x[1] +
           __builtin_convertvector(columns[2], Four) * x[2];
  }
  *sum = all;
}

INLINE void down_node(const FemLevel *level, int p) {
  const double *d = level->diagonal + 9 * (size_t)p, *b = level->b + 3 * (size_t)p;
  double *x = level->x + 3 * (size_t)p;
  Four sum;
  add_blocks(level, level->begin[p], level->middle[p], &sum);
  x[0] = d[0] * (b[0] - sum[0]);
  x[1] = d[4] * (b[1] - sum[1] - d[3] * x[0]);
  x[2] = d[8] * (b[2] - sum[2] - d[6] * x[0] - d[7] * x[1]);
}

INLINE void leave_node(const FemLevel *level, int p) {
  const double *d = level->diagonal + 9 * (size_t)p, *x = level->x + 3 * (size_t)p;
  double *r = level->r + 3 * (size_t)p;
  Four sum;
  add_blocks(level, level->middle[p], level->begin[p + 1], &sum);
  r[0] = -sum[0] - d[1] * x[1] - d[2] * x[2];
  r[1] = -sum[1] - d[5] * x[2];
  r[2] = -sum[2];
}

INLINE void up_node(const FemLevel *level, int p) {
  const double *d = level->diagonal + 9 * (size_t)p, *b = level->b + 3 * (size_t)p;
  double *x = level->x + 3 * (size_t)p;
  Four sum;
  add_blocks(level, level->begin[p], level->begin[p + 1], &sum);
  x[2] = d[8] * (b[2] - sum[2] - d[6] * x[0] - d[7] * x[1]);
  x[1] = d[4] * (b[1] - sum[1] - d[3] * x[0] - d[5] * x[2]);
  x[0] = d[0] * (b[0] - sum[0] - d[1] * x[1] - d[2] * x[2]);
}

FASTEST
static void sweep_down(FemLevel *level, Range nodes) {
  double *x = level->x;
  for (int p = nodes.begin; p < nodes.end && level->width == 3; p++) down_node(level, p);
  for (int p = nodes.begin; p < nodes.end && level->width == 1; p++)
    x[p] = level->diagonal[p] *
           (level->b[p] - dot(level->value, level->column, level->begin[p], level->middle[p], x));
}

// What a sweep from nothing leaves of a row: the entries right of the diagonal.
FASTEST
static void leave(FemLevel *level, Range nodes) {
  for (int p = nodes.begin; p < nodes.end && level->width == 3; p++) leave_node(level, p);
  for (int p = nodes.begin; p < nodes.end && level->width == 1; p++)
    level->r[p] = -dot(level->value, level->column, level->middle[p], level->begin[p + 1], level->x);
}

FASTEST
static void sweep_up(FemLevel *level, Range nodes) {
  double *x = level->x;
  for (int p = nodes.end - 1; p >= nodes.begin && level->width == 3; p--) up_node(level, p);
  for (int p = nodes.end - 1; p >= nodes.begin && level->width == 1; p--)
    x[p] = level->diagonal[p] *
           (level->b[p] - dot(level->value, level->column, level->begin[p], level->begin[p + 1], x));
}

void fem_level_sweep_down(FemLevel *level, FemTeam team) {
  for (int s = 0; s < level->stage_count; s++) {
    sweep_down(level, nodes_of_stage(level, s, team));
    wait_for_all(team);
  }
  leave(level, share_of(team, 0, level->count));
  wait_for_all(team);
}

void fem_level_sweep_up(FemLevel *level, FemTeam team) {
  for (int s = level->stage_count - 1; s >= 0; s--) {
    sweep_up(level, nodes_of_stage(level, s, team));
    wait_for_all(team);
  }
}

void fem_level_restrict(const FemLevel *level, FemLevel *coarse, FemTeam team) {
  const FemLevelMap *map = &level->to_coarse;
  Range rows = share_of(team, 0, map->count);
  for (int p = rows.begin; p < rows.end; p++)
    coarse->b[p] = dot(map->value, map->column, map->begin[p], map->begin[p + 1], level->r);
  wait_for_all(team);
}

void fem_level_prolong(FemLevel *level, const FemLevel *coarse, FemTeam team) {
  const FemLevelMap *map = &level->from_coarse;
  Range rows = share_of(team, 0, map->count);
  for (int p = rows.begin; p < rows.end; p++)
    level->x[p] += dot(map->value, map->column, map->begin[p], map->begin[p + 1], coarse->x);
  wait_for_all(team);
}
