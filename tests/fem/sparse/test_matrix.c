// SPDX-License-Identifier: GPL-3.0-or-later
// fem/sparse/pattern.h and matrix.h: layout by hand, sums against a dense matrix, products against a dense
// product.
#include "suite.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/sparse/matrix.h"

enum { VERTICES = 23, DOFS = 3 * VERTICES, CLIQUES = 40, MOST = 9 };

// Random cliques on VERTICES vertices, some coordinates and one whole vertex prescribed.
typedef struct Case {
  Random random;
  int unknown_of_dof[DOFS];
  int unknown_count;
  int clique_size[CLIQUES], clique[CLIQUES][MOST];
  FemPattern *pattern;
  FemMatrix matrix;
} Case;

static void draw_clique(Case *c, int k) {
  c->clique_size[k] = 1 + random_below(&c->random, MOST);
  for (int i = 0; i < c->clique_size[k]; i++) {
    int vertex, is_new;
    do {
      vertex = random_below(&c->random, VERTICES), is_new = 1;
      for (int j = 0; j < i; j++) is_new &= c->clique[k][j] != vertex;
    } while (!is_new);
    c->clique[k][i] = vertex;
  }
}

static void set_up(Case *c, uint64_t seed) {
  *c = (Case){.random = random_seeded(seed, 0)};
  for (int dof = 0; dof < DOFS; dof++) {
    int is_free = dof / 3 != 5 && random_uniform(&c->random) > 0.2;
    c->unknown_of_dof[dof] = is_free ? c->unknown_count++ : -1;
  }
  ck_assert_ok(fem_pattern_create(&c->pattern, VERTICES));
  for (int k = 0; k < CLIQUES; k++) {
    draw_clique(c, k);
    ck_assert_ok(fem_pattern_add_clique(c->pattern, c->clique_size[k], c->clique[k], NULL));
  }
  ck_assert_ok(fem_matrix_create(&c->matrix, c->pattern, c->unknown_of_dof));
}

static void tear_down(Case *c) {
  fem_matrix_destroy(&c->matrix);
  fem_pattern_destroy(c->pattern);
}

// A random symmetric (3 count, 3 count) matrix.
static void draw_symmetric(Random *random, int count, double *dense) {
  for (int i = 0; i < 3 * count; i++)
    for (int j = 0; j <= i; j++)
      dense[i * 3 * count + j] = dense[j * 3 * count + i] = random_between(random, -1, 1);
}

static void sum_dense(const Case *c, int count, const int *vertices, const double *dense, double scale,
                      double sum[DOFS][DOFS]) {
  for (int i = 0; i < 3 * count; i++)
    for (int j = 0; j < 3 * count; j++) {
      int row = c->unknown_of_dof[3 * vertices[i / 3] + i % 3];
      int column = c->unknown_of_dof[3 * vertices[j / 3] + j % 3];
      if (row >= 0 && column >= 0) sum[row][column] += scale * dense[i * 3 * count + j];
    }
}

static void check_equals(const FemMatrix *matrix, double sum[DOFS][DOFS]) {
  for (int j = 0; j < matrix->size; j++) {
    ck_assert_int_eq(matrix->row[matrix->col_begin[j]], j);
    for (int k = matrix->col_begin[j]; k < matrix->col_begin[j + 1]; k++) {
      if (k > matrix->col_begin[j]) ck_assert_int_lt(matrix->row[k - 1], matrix->row[k]);
      ck_assert_near(matrix->value[k], sum[matrix->row[k]][j], 1e-13);
      sum[matrix->row[k]][j] = 0;
    }
    for (int i = j; i < matrix->size; i++) ck_assert(sum[i][j] == 0); // nothing that the matrix lacks
  }
}

START_TEST(only_new_couplings_count_as_growth) {
  FemPattern *pattern;
  ck_assert_ok(fem_pattern_create(&pattern, 10));
  int has_grown = 0, count;
  ck_assert_ok(fem_pattern_add_clique(pattern, 1, (int[]){4}, &has_grown));
  ck_assert_int_eq(has_grown, 0); // a vertex always couples with itself
  ck_assert_ok(fem_pattern_add_clique(pattern, 4, (int[]){7, 2, 7, 4}, &has_grown));
  ck_assert_int_eq(has_grown, 1);
  has_grown = 0;
  ck_assert_ok(fem_pattern_add_clique(pattern, 3, (int[]){4, 7, 2}, &has_grown));
  ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){7, 4}, &has_grown));
  ck_assert_int_eq(has_grown, 0);
  ck_assert_ok(fem_pattern_add_clique(pattern, 3, (int[]){2, 9, 3}, &has_grown));
  ck_assert_int_eq(has_grown, 1);
  const int *above = fem_pattern_above(pattern, 2, &count);
  ck_assert_int_eq(count, 4);
  ck_assert(above[0] == 3 && above[1] == 4 && above[2] == 7 && above[3] == 9);
  fem_pattern_above(pattern, 9, &count);
  ck_assert_int_eq(count, 0);
  fem_pattern_destroy(pattern);
}
END_TEST

// A chain of all vertices.
static FemPattern *make_chain(void) {
  FemPattern *pattern;
  ck_assert_ok(fem_pattern_create(&pattern, VERTICES));
  for (int v = 0; v + 1 < VERTICES; v++)
    ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){v, v + 1}, NULL));
  return pattern;
}

START_TEST(a_pattern_goes_back_to_its_mark) {
  FemPattern *chain = make_chain(), *marked = make_chain();
  FemMatrix matrix;
  int unknowns[DOFS];
  for (int dof = 0; dof < DOFS; dof++) unknowns[dof] = dof;
  ck_assert_ok(fem_matrix_create(&matrix, chain, unknowns));
  fem_pattern_mark(marked);
  ck_assert(fem_matrix_fits(&matrix, marked, unknowns));
  for (int round = 0; round < 2; round++) {
    int has_grown = 0;
    ck_assert_ok(fem_pattern_add_clique(marked, 3, (int[]){0, 11, 22}, NULL));
    ck_assert_ok(fem_pattern_add_clique(marked, 6, (int[]){0, 4, 9, 13, 17, 21}, &has_grown));
    ck_assert_int_eq(has_grown, 1);
    ck_assert(!fem_matrix_fits(&matrix, marked, unknowns));
    fem_pattern_take_back(marked);
    for (int v = 0; v < VERTICES; v++) {
      int count, expected_count;
      const int *expected = fem_pattern_above(chain, v, &expected_count),
                *above = fem_pattern_above(marked, v, &count);
      ck_assert_int_eq(count, expected_count);
      if (count > 0) ck_assert_mem_eq(above, expected, (size_t)count * sizeof *above);
    }
    ck_assert(fem_matrix_fits(&matrix, marked, unknowns));
  }
  fem_matrix_destroy(&matrix);
  fem_pattern_destroy(chain), fem_pattern_destroy(marked);
}
END_TEST

START_TEST(a_matrix_fits_the_unknowns_that_it_was_laid_out_for) {
  Case c;
  set_up(&c, 6);
  int other[DOFS], count = 0;
  for (int dof = 0; dof < DOFS; dof++) other[dof] = dof / 3 == 5 || c.unknown_of_dof[dof] >= 0 ? count++ : -1;
  ck_assert_int_gt(count, c.unknown_count);
  ck_assert(fem_matrix_fits(&c.matrix, c.pattern, c.unknown_of_dof));
  ck_assert(!fem_matrix_fits(&c.matrix, c.pattern, other));
  ck_assert(!fem_matrix_fits(&(FemMatrix){0}, c.pattern, c.unknown_of_dof));
  tear_down(&c);
}
END_TEST

START_TEST(a_large_clique_is_complete) {
  FemPattern *pattern;
  enum { SIZE = 300 };
  int clique[SIZE], has_grown = 0;
  ck_assert_ok(fem_pattern_create(&pattern, 2 * SIZE));
  for (int i = 0; i < SIZE; i++) clique[i] = 2 * ((i * 7) % SIZE);
  ck_assert_ok(fem_pattern_add_clique(pattern, SIZE, clique, NULL));
  for (int v = 0; v < 2 * SIZE; v++) {
    int count;
    const int *above = fem_pattern_above(pattern, v, &count);
    ck_assert_int_eq(count, v % 2 ? 0 : SIZE - 1 - v / 2);
    for (int k = 0; k < count; k++) ck_assert_int_eq(above[k], v + 2 * (k + 1));
  }
  ck_assert_ok(fem_pattern_add_clique(pattern, SIZE, clique, &has_grown));
  ck_assert_int_eq(has_grown, 0);
  fem_pattern_destroy(pattern);
}
END_TEST

// Vertices 0–1–2 in a chain; y of vertex 1 is prescribed: unknowns 0 1 2 | 3 4 | 5 6 7.
START_TEST(a_chain_is_laid_out_as_by_hand) {
  const int unknown_of_dof[9] = {0, 1, 2, 3, -1, 4, 5, 6, 7};
  const int begin[9] = {0, 5, 9, 12, 17, 21, 24, 26, 27};
  const int row[27] = {0, 1, 2, 3, 4, 1, 2, 3, 4, 2, 3, 4, 3, 4, 5, 6, 7, 4, 5, 6, 7, 5, 6, 7, 6, 7, 7};
  FemPattern *pattern;
  FemMatrix matrix;
  ck_assert_ok(fem_pattern_create(&pattern, 3));
  ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){1, 0}, NULL));
  ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){1, 2}, NULL));
  ck_assert_ok(fem_matrix_create(&matrix, pattern, unknown_of_dof));
  ck_assert_int_eq(matrix.size, 8);
  ck_assert_int_eq(matrix.entry_count, 27);
  ck_assert_mem_eq(matrix.col_begin, begin, sizeof begin);
  ck_assert_mem_eq(matrix.row, row, sizeof row);
  fem_matrix_destroy(&matrix);
  fem_pattern_destroy(pattern);
}
END_TEST

START_TEST(sums_equal_a_dense_matrix) {
  static double sum[DOFS][DOFS];
  for (uint64_t seed = 1; seed <= 20; seed++) {
    Case c;
    set_up(&c, seed);
    memset(sum, 0, sizeof sum);
    double mass[VERTICES];
    for (int v = 0; v < VERTICES; v++) mass[v] = random_uniform(&c.random);
    fem_matrix_add_mass(&c.matrix, mass, 2.5);
    for (int dof = 0; dof < DOFS; dof++)
      if (c.unknown_of_dof[dof] >= 0)
        sum[c.unknown_of_dof[dof]][c.unknown_of_dof[dof]] += 2.5 * mass[dof / 3];
    for (int k = 0; k < CLIQUES; k++) {
      double dense[9 * MOST * MOST];
      draw_symmetric(&c.random, c.clique_size[k], dense);
      fem_matrix_add(&c.matrix, c.clique_size[k], c.clique[k], dense, -0.75);
      sum_dense(&c, c.clique_size[k], c.clique[k], dense, -0.75, sum);
    }
    check_equals(&c.matrix, sum);
    fem_matrix_zero(&c.matrix);
    for (int k = 0; k < c.matrix.entry_count; k++) ck_assert(c.matrix.value[k] == 0);
    tear_down(&c);
  }
}
END_TEST

START_TEST(an_outer_product_equals_its_dense_form) {
  static double sum[DOFS][DOFS];
  Case c;
  set_up(&c, 31);
  memset(sum, 0, sizeof sum);
  for (int k = 0; k < CLIQUES; k++) {
    double w[3 * MOST], dense[9 * MOST * MOST];
    int size = 3 * c.clique_size[k];
    for (int i = 0; i < size; i++) w[i] = suite_normal(&c.random);
    for (int i = 0; i < size; i++)
      for (int j = 0; j < size; j++) dense[i * size + j] = w[i] * w[j];
    fem_matrix_add_outer(&c.matrix, c.clique_size[k], c.clique[k], w, 1.5);
    sum_dense(&c, c.clique_size[k], c.clique[k], dense, 1.5, sum);
  }
  check_equals(&c.matrix, sum);
  tear_down(&c);
}
END_TEST

// Rows of both triangles, one by one, and a product vertex by vertex, against those of the whole.
START_TEST(rows_and_vertices_are_parts_of_the_matrix) {
  Case c;
  set_up(&c, 53);
  for (int k = 0; k < c.matrix.entry_count; k++) c.matrix.value[k] = suite_normal(&c.random);
  double x[DOFS], whole[DOFS], by_rows[DOFS], by_vertices[DOFS] = {0}, values[DOFS];
  int columns[DOFS];
  for (int i = 0; i < c.matrix.size; i++) x[i] = suite_normal(&c.random);
  fem_matrix_multiply(&c.matrix, x, whole);
  for (int dof = 0; dof < DOFS; dof++) {
    int unknown = c.unknown_of_dof[dof];
    if (unknown < 0) continue;
    int count = fem_matrix_row(&c.matrix, dof / 3, unknown, columns, values);
    ck_assert_int_eq(count, fem_matrix_row(&c.matrix, dof / 3, unknown, NULL, NULL));
    by_rows[unknown] = 0;
    for (int k = 0; k < count; k++) {
      if (k > 0) ck_assert_int_lt(columns[k - 1], columns[k]);
      by_rows[unknown] += values[k] * x[columns[k]];
    }
  }
  for (int v = VERTICES - 1; v >= 0; v--) {
    fem_matrix_add_product(&c.matrix, 1, &v, x, by_vertices);
    if (v == 5) ck_assert(!fem_matrix_is_coupled(&c.matrix, v)); // it is prescribed
  }
  for (int i = 0; i < c.matrix.size; i++) {
    ck_assert_near(by_rows[i], whole[i], 1e-12);
    ck_assert_near(by_vertices[i], whole[i], 1e-12);
  }
  tear_down(&c);
}
END_TEST

START_TEST(slots_address_the_entries_that_add_fills) {
  Case c;
  set_up(&c, 77);
  int tet_count = 0;
  for (int k = 0; k < CLIQUES; k++) {
    if (c.clique_size[k] < 4) continue;
    tet_count++;
    double dense[144];
    int slots[144];
    draw_symmetric(&c.random, 4, dense);
    fem_matrix_slots(&c.matrix, 4, c.clique[k], slots);
    fem_matrix_zero(&c.matrix);
    fem_matrix_add(&c.matrix, 4, c.clique[k], dense, 3);
    for (int s = 0; s < 144; s++)
      if (slots[s] >= 0) c.matrix.value[slots[s]] -= 3 * dense[s];
    for (int s = 0; s < c.matrix.entry_count; s++) ck_assert(c.matrix.value[s] == 0);
  }
  ck_assert_int_gt(tet_count, 10);
  tear_down(&c);
}
END_TEST

static void fill(Case *c) {
  for (int k = 0; k < CLIQUES; k++) {
    double dense[9 * MOST * MOST];
    draw_symmetric(&c->random, c->clique_size[k], dense);
    fem_matrix_add(&c->matrix, c->clique_size[k], c->clique[k], dense, 1);
  }
}

START_TEST(a_product_equals_the_dense_one) {
  Case c;
  set_up(&c, 5);
  fill(&c);
  double x[DOFS], y[DOFS], expected[DOFS] = {0};
  for (int i = 0; i < c.matrix.size; i++) x[i] = suite_normal(&c.random);
  for (int j = 0; j < c.matrix.size; j++)
    for (int k = c.matrix.col_begin[j]; k < c.matrix.col_begin[j + 1]; k++) {
      int i = c.matrix.row[k];
      expected[i] += c.matrix.value[k] * x[j];
      if (i != j) expected[j] += c.matrix.value[k] * x[i];
    }
  fem_matrix_multiply(&c.matrix, x, y);
  for (int i = 0; i < c.matrix.size; i++) ck_assert_near(y[i], expected[i], 1e-12);
  tear_down(&c);
}
END_TEST

// A chain long enough to be shared out among threads.
START_TEST(a_product_has_the_same_bits_with_any_number_of_threads) {
  enum { LENGTH = 6000 }; // several pieces
  static int unknown_of_dof[3 * LENGTH];
  static double x[3 * LENGTH], one[3 * LENGTH], many[3 * LENGTH], expected[3 * LENGTH];
  Random random = random_seeded(8, 0);
  FemPattern *pattern;
  FemMatrix matrix;
  int count = 0;
  ck_assert_ok(fem_pattern_create(&pattern, LENGTH));
  for (int v = 0; v + 4 < LENGTH; v++)
    ck_assert_ok(fem_pattern_add_clique(pattern, 3, (int[]){v, v + 1, (v + 4 + v % 7 * 500) % LENGTH}, NULL));
  for (int dof = 0; dof < 3 * LENGTH; dof++)
    unknown_of_dof[dof] = dof % 5 == 4 ? -1 : count++, x[dof] = suite_normal(&random);
  ck_assert_ok(fem_matrix_create(&matrix, pattern, unknown_of_dof));
  for (int k = 0; k < matrix.entry_count; k++) matrix.value[k] = suite_normal(&random);
  int before = omp_get_max_threads();
  omp_set_num_threads(1);
  fem_matrix_multiply(&matrix, x, one);
  omp_set_num_threads(5);
  fem_matrix_multiply(&matrix, x, many);
  omp_set_num_threads(before);
  ck_assert_mem_eq(one, many, sizeof one);
  for (int j = 0; j < matrix.size; j++)
    for (int k = matrix.col_begin[j]; k < matrix.col_begin[j + 1]; k++) {
      expected[matrix.row[k]] += matrix.value[k] * x[j];
      if (matrix.row[k] != j) expected[j] += matrix.value[k] * x[matrix.row[k]];
    }
  for (int i = 0; i < matrix.size; i++) ck_assert_near(one[i], expected[i], 1e-12);
  fem_matrix_destroy(&matrix);
  fem_pattern_destroy(pattern);
}
END_TEST

START_TEST(a_copy_shares_the_layout_but_not_the_values) {
  Case c;
  FemMatrix copy, other;
  set_up(&c, 9);
  fill(&c);
  ck_assert_ok(fem_matrix_copy_layout(&copy, &c.matrix));
  ck_assert_ok(fem_matrix_create(&other, c.pattern, c.unknown_of_dof));
  ck_assert(copy.layout == c.matrix.layout);
  ck_assert(other.layout != c.matrix.layout && other.layout != 0);
  for (int k = 0; k < copy.entry_count; k++) ck_assert(copy.value[k] == 0);
  fem_matrix_destroy(&c.matrix); // the copy lives on
  double mass[VERTICES], x[DOFS], y[DOFS];
  for (int v = 0; v < VERTICES; v++) mass[v] = 1 + v;
  for (int i = 0; i < copy.size; i++) x[i] = 1;
  fem_matrix_add_mass(&copy, mass, 1);
  fem_matrix_multiply(&copy, x, y);
  for (int dof = 0; dof < DOFS; dof++)
    if (c.unknown_of_dof[dof] >= 0) ck_assert(y[c.unknown_of_dof[dof]] == 1 + dof / 3);
  fem_matrix_destroy(&copy);
  fem_matrix_destroy(&other);
  tear_down(&c);
}
END_TEST

START_TEST(every_failed_allocation_is_an_error) {
  Case c;
  set_up(&c, 3);
  int failures = 0;
  for (long k = 1;; k++, failures++) {
    FemPattern *pattern = NULL;
    FemMatrix matrix = {0}, copy = {0};
    memory_fail_at(k);
    Status status = fem_pattern_create(&pattern, VERTICES);
    if (status == STATUS_OK) fem_pattern_mark(pattern);
    for (int i = 0; i < CLIQUES && status == STATUS_OK; i++)
      status = fem_pattern_add_clique(pattern, c.clique_size[i], c.clique[i], NULL);
    if (status == STATUS_OK) status = fem_matrix_create(&matrix, pattern, c.unknown_of_dof);
    if (status == STATUS_OK) status = fem_matrix_copy_layout(&copy, &matrix);
    memory_fail_at(0);
    fem_matrix_destroy(&copy);
    fem_matrix_destroy(&matrix);
    fem_pattern_destroy(pattern);
    if (status == STATUS_OK) break;
    ck_assert_int_eq(status, STATUS_MEMORY);
  }
  ck_assert_int_gt(failures, 12);
  tear_down(&c);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("matrix");
  tcase_add_test(cases, only_new_couplings_count_as_growth);
  tcase_add_test(cases, a_pattern_goes_back_to_its_mark);
  tcase_add_test(cases, a_matrix_fits_the_unknowns_that_it_was_laid_out_for);
  tcase_add_test(cases, a_large_clique_is_complete);
  tcase_add_test(cases, a_chain_is_laid_out_as_by_hand);
  tcase_add_test(cases, sums_equal_a_dense_matrix);
  tcase_add_test(cases, an_outer_product_equals_its_dense_form);
  tcase_add_test(cases, rows_and_vertices_are_parts_of_the_matrix);
  tcase_add_test(cases, slots_address_the_entries_that_add_fills);
  tcase_add_test(cases, a_product_equals_the_dense_one);
  tcase_add_test(cases, a_product_has_the_same_bits_with_any_number_of_threads);
  tcase_add_test(cases, a_copy_shares_the_layout_but_not_the_values);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("matrix", cases, 30);
}
