// SPDX-License-Identifier: GPL-3.0-or-later
// What the strategies draw: every pair proven to be of its kind, labels that are right, laws that are met.
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "datagen/draw/proof.h"
#include "datagen/draw/sampler.h"
#include "datagen/generate.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/separation.h"

enum { MEMBERS = 2500, MOST = 60000 };

static double coordinates[MOST * 24], gradients[MOST * 24], volumes[MOST];
static uint8_t status[MOST], kinds[MOST];
static const DatagenPairs arrays = {coordinates, status, kinds, volumes, gradients, NULL};

static DatagenPlan plan_of_kind(int kind, const char *law_name, uint64_t seed, long long count) {
  DatagenLaw law;
  DatagenPlan plan;
  ck_assert_ok(datagen_law_find(law_name, &law));
  memset(law.mix, 0, sizeof law.mix);
  law.mix[kind] = 1;
  ck_assert_ok(datagen_plan_make(&plan, &law, seed, count));
  plan.wants_gradient = true;
  return plan;
}

static void generate(const DatagenPlan *plan, int count) {
  long long attempts[DATAGEN_KIND_COUNT] = {0};
  ck_assert_int_le(count, MOST);
  ck_assert_ok(datagen_generate(plan, 0, count, &arrays, attempts));
}

START_TEST(every_member_is_of_its_kind_and_in_the_unit_cube) {
  DatagenPlan plan = plan_of_kind(_i, "paper-train", 5, MEMBERS);
  const DatagenKindInfo *info = datagen_kind_info(_i);
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++) {
    DatagenProof proof = datagen_proof_of(coordinates + 24 * i);
    ck_assert_msg(!proof.is_flat && proof.dimension == info->dimension &&
                      proof.carrier[0] == info->carrier[0] && proof.carrier[1] == info->carrier[1],
                  "%s %d: dimension %d in faces of dimension %d and %d", info->name, i, proof.dimension,
                  proof.carrier[0], proof.carrier[1]);
    ck_assert_int_eq(status[i], info->dimension >= 0);
    ck_assert_int_eq(kinds[i], _i);
    for (int c = 0; c < 24; c++) ck_assert(coordinates[24 * i + c] >= 0 && coordinates[24 * i + c] <= 1);
  }
}
END_TEST

// By other means than the proof: the exact model's V and flag, the separating axes' gap.
START_TEST(the_exact_model_and_the_separating_axes_bear_the_kind_out) {
  DatagenPlan plan = plan_of_kind(_i, "paper-train", 6, MEMBERS);
  const int dimension = datagen_kind_info(_i)->dimension;
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++) {
    double volume;
    unsigned flags;
    ck_assert_ok(overlap_exact_ops.eval_pair(NULL, coordinates + 24 * i,
                                             &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    ck_assert_int_eq((flags & OVERLAP_DISJOINT) == 0, dimension == 3);
    ck_assert(volumes[i] == volume && (volume > 0) == (dimension == 3));
    double gap = overlap_separation_pair(coordinates + 24 * i, INFINITY);
    if (dimension == -1) ck_assert(gap > -1e-14);
    if (dimension == 3) ck_assert(gap < 1e-14);
    if (dimension >= 0 && dimension < 3) ck_assert_near(gap, 0, 1e-9);
  }
}
END_TEST

// Moved ever so little, a pair that touches either parts or overlaps; both must happen.
START_TEST(touching_is_a_matter_of_the_last_digit) {
  DatagenPlan plan = plan_of_kind(_i, "paper-train", 7, MEMBERS);
  Random random = random_seeded(8, 0);
  int parted = 0, overlapping = 0;
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++) {
    double *pair = coordinates + 24 * i, direction[3];
    random_direction(&random, direction);
    for (int c = 12; c < 24; c++) pair[c] += 1e-13 * direction[c % 3];
    DatagenProof proof = datagen_proof_of(pair);
    parted += proof.dimension == -1, overlapping += proof.dimension == 3;
  }
  ck_assert_int_ge(parted + overlapping, MEMBERS * 99 / 100);
  ck_assert_int_ge(parted, MEMBERS * 2 / 5);
  ck_assert_int_ge(overlapping, MEMBERS / 5);
}
END_TEST

// Which vertex touches must not be read off its number.
START_TEST(the_contact_is_at_any_vertex) {
  DatagenPlan plan = plan_of_kind(DATAGEN_VERTEX_VERTEX, "paper-train", 9, MEMBERS);
  int seen[4][4] = {{0}};
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++)
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++)
        seen[a][b] +=
            memcmp(coordinates + 24 * i + 3 * a, coordinates + 24 * i + 12 + 3 * b, 3 * sizeof(double)) == 0;
  for (int a = 0; a < 16; a++) ck_assert_near(seen[a / 4][a % 4], MEMBERS / 16.0, 5 * sqrt(MEMBERS / 16.0));
}
END_TEST

START_TEST(a_swap_share_exchanges_that_share) {
  DatagenPlan plan = plan_of_kind(DATAGEN_VERTEX_FACE, "paper-train", 10, MEMBERS);
  plan.law.swap_share = 0.25;
  int swapped = 0;
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++) swapped += datagen_proof_of(coordinates + 24 * i).carrier[0] == 0;
  ck_assert_near(swapped, MEMBERS * 0.25, 5 * sqrt(MEMBERS * 0.25 * 0.75));
}
END_TEST

START_TEST(labels_by_clip_and_by_exact_agree) {
  const int kind = _i ? DATAGEN_SCENE : DATAGEN_VOLUMETRIC;
  static double exact_volumes[MEMBERS], exact_gradients[MEMBERS * 24];
  DatagenPlan plan = plan_of_kind(kind, "paper-train", 12, MEMBERS);
  generate(&plan, MEMBERS);
  memcpy(exact_volumes, volumes, sizeof exact_volumes);
  memcpy(exact_gradients, gradients, sizeof exact_gradients);
  plan.label = DATAGEN_LABEL_CLIP;
  generate(&plan, MEMBERS);
  for (int i = 0; i < MEMBERS; i++) {
    double largest = 0;
    ck_assert(volumes[i] > 0);
    ck_assert_near(volumes[i], exact_volumes[i], 1e-9 * exact_volumes[i] + 1e-13);
    for (int c = 0; c < 24; c++) largest = fmax(largest, fabs(exact_gradients[24 * i + c]));
    ck_assert(largest > 0);
    for (int c = 0; c < 24; c++)
      ck_assert_near(gradients[24 * i + c], exact_gradients[24 * i + c], 1e-5 * largest + 1e-12);
  }
}
END_TEST

// V by central differences of the exact model along random directions.
START_TEST(the_gradient_is_that_of_the_volume) {
  DatagenPlan plan = plan_of_kind(DATAGEN_VOLUMETRIC, "paper-test", 13, 200);
  Random random = random_seeded(14, 0);
  generate(&plan, 200);
  for (int i = 0; i < 200; i++) {
    double step[24], moved[24], value[2], slope = 0, size = 0;
    unsigned flags;
    const double h = 1e-6;
    for (int c = 0; c < 24; c++) {
      step[c] = suite_normal(&random);
      slope += step[c] * gradients[24 * i + c];
      size += fabs(step[c] * gradients[24 * i + c]);
    }
    for (int side = 0; side < 2; side++) {
      for (int c = 0; c < 24; c++) moved[c] = coordinates[24 * i + c] + (side ? h : -h) * step[c];
      ck_assert_ok(overlap_exact_ops.eval_pair(NULL, moved,
                                               &(OverlapAnswer){.volume = &value[side], .flags = &flags}));
    }
    ck_assert_near((value[1] - value[0]) / (2 * h), slope, 1e-4 * size + 1e-9);
  }
}
END_TEST

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

// The largest distance of the sorted values' distribution from the uniform one on [low, high], times √n:
// above 1.95 with probability 1e-3 if they are uniform (Kolmogorov).
static double kolmogorov(double *values, int count, double low, double high) {
  double worst = 0;
  qsort(values, (size_t)count, sizeof *values, compare_doubles);
  for (int i = 0; i < count; i++) {
    double share = (values[i] - low) / (high - low);
    worst = suite_larger(worst, fmax(fabs(share - (double)i / count), fabs(share - (i + 1.0) / count)));
  }
  return worst * sqrt(count);
}

START_TEST(the_training_law_is_uniform_in_the_logarithm_of_the_volume) {
  enum { COUNT = 50000 };
  DatagenPlan plan = plan_of_kind(DATAGEN_VOLUMETRIC, "paper-train", 15, COUNT);
  plan.label = DATAGEN_LABEL_CLIP;
  generate(&plan, COUNT);
  for (int i = 0; i < COUNT; i++) volumes[i] = log(volumes[i]);
  double distance = kolmogorov(volumes, COUNT, log(1e-7), log(0.02));
  ck_assert_msg(distance < 1.95, "%g", distance);
}
END_TEST

START_TEST(the_test_law_is_uniform_in_the_volume) {
  enum { COUNT = 15000 };
  DatagenPlan plan = plan_of_kind(DATAGEN_VOLUMETRIC, "paper-test", 16, COUNT);
  plan.label = DATAGEN_LABEL_CLIP;
  generate(&plan, COUNT);
  double distance = kolmogorov(volumes, COUNT, 0, 0.02);
  ck_assert_msg(distance < 1.95, "%g", distance);
}
END_TEST

// The shapes are those of uniform pairs of the same volume, not moved or scaled ones: the smaller tetrahedron
// of pairs with V about 1e-3, drawn through the law and drawn without it.
START_TEST(a_volume_law_leaves_the_shapes_alone) {
  enum { COUNT = 4000 };
  static double size[2][COUNT];
  Random random = random_seeded(17, 0);
  DatagenVolumeSieve sieves[2];
  ck_assert_ok(datagen_volume_law_sieve_make(&sieves[0], &(DatagenVolumeLaw){DATAGEN_VOLUME_NATURAL, 0, 0}));
  ck_assert_ok(datagen_volume_law_sieve_make(&sieves[1],
                                             &(DatagenVolumeLaw){DATAGEN_VOLUME_LOG_UNIFORM, 9e-4, 1.1e-3}));
  for (int s = 0; s < 2; s++)
    for (int i = 0; i < COUNT;) {
      DatagenSample sample = datagen_sampler_draw(DATAGEN_VOLUMETRIC, &sieves[s], 0, &random);
      double volume;
      unsigned flags;
      ck_assert_ok(overlap_clip_ops.eval_pair(NULL, sample.pair,
                                              &(OverlapAnswer){.volume = &volume, .flags = &flags}));
      if (!(volume > 9e-4 && volume < 1.1e-3)) continue;
      double x[2];
      for (int t = 0; t < 2; t++) {
        const double *v = sample.pair + 12 * t;
        x[t] = fabs(vec3_det4(vec3_at(v), vec3_at(v + 3), vec3_at(v + 6), vec3_at(v + 9))) / 6;
      }
      size[s][i++] = fmin(x[0], x[1]);
    }
  for (int s = 0; s < 2; s++) qsort(size[s], COUNT, sizeof(double), compare_doubles);
  double worst = 0; // Smirnov's two-sample distance
  for (int i = 0, j = 0; i < COUNT && j < COUNT;) {
    if (size[0][i] <= size[1][j])
      i++;
    else
      j++;
    worst = fmax(worst, abs(i - j) / (double)COUNT);
  }
  ck_assert_msg(worst * sqrt(COUNT / 2.0) < 1.95, "%g", worst * sqrt(COUNT / 2.0));
}
END_TEST

// The natural density, which the laws rest on, against pairs drawn here; within 5 standard deviations in each
// of twelve bins from 1e-7 to 0.02.
START_TEST(the_natural_density_of_volumes_is_as_recorded) {
  enum { DRAWN = 400000, BINS = 12 };
  const double low = log(1e-7), width = (log(0.02) - low) / BINS;
  long long counts[BINS] = {0}, intersecting = 0;
  for (int i = 0; i < DRAWN; i++) {
    Random random = random_seeded(18, (uint64_t)i);
    double pair[24], volume;
    unsigned flags;
    for (int c = 0; c < 24; c++) pair[c] = random_uniform(&random);
    ck_assert_ok(
        overlap_clip_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    intersecting += volume > 0;
    double place = volume > 0 ? (log(volume) - low) / width : -1;
    if (place >= 0 && place < BINS) counts[(int)place]++;
  }
  ck_assert_near((double)intersecting / DRAWN, 0.6108623, 5 * sqrt(0.61 * 0.39 / DRAWN));
  for (int b = 0; b < BINS; b++) {
    double expected = 0;
    for (int k = 0; k < 100; k++)
      expected += DRAWN * exp(datagen_volume_law_natural(low + width * (b + (k + 0.5) / 100))) * width / 100;
    ck_assert_near((double)counts[b], expected, 5 * sqrt(expected));
  }
}
END_TEST

// Dropping early what cannot be kept is only right if nothing below the floor can be.
START_TEST(the_floor_of_a_volume_law_drops_nothing_that_would_be_kept) {
  static const char *const texts[] = {"uniform:0:0.02", "log-uniform:1e-7:0.02", "uniform:0.001:0.03",
                                      "log-uniform:1e-12:1e-6", "natural"};
  Random random = random_seeded(19, 0);
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    DatagenVolumeLaw law;
    DatagenVolumeSieve sieve;
    ck_assert_ok(datagen_volume_law_parse(&law, texts[k]));
    ck_assert_ok(datagen_volume_law_sieve_make(&sieve, &law));
    for (int i = 0; i < 20000; i++) {
      double volume = exp(random_between(&random, log(1e-13), log(0.04)));
      double keeps = datagen_volume_law_sieve_keeps(&sieve, volume);
      ck_assert(keeps >= 0 && keeps <= 1);
      if (keeps > 0) ck_assert(datagen_volume_law_sieve_floor(&sieve, keeps * (1 - 1e-12)) <= volume);
    }
  }
}
END_TEST

START_TEST(volume_laws_that_cannot_be_met_are_refused) {
  static const struct {
    const char *text, *reason;
  } wrong[] = {{"", "give natural"},
               {"log", "give natural"},
               {"uniform", "give natural"},
               {"uniform:0", "give natural"},
               {"uniform:0:0.02:1", "give natural"},
               {"uniform:a:b", "give natural"},
               {"uniform:nan:0.02", "give natural"},
               {"natural:0:1", "give natural"},
               {"uniform:0:0.5", "are not possible"},
               {"uniform:-1:0.02", "are not possible"},
               {"uniform:0.02:0.01", "are not possible"},
               {"log-uniform:0:0.01", "are not possible"},
               {"uniform:0.02:0.020001", "so rare"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    DatagenVolumeLaw law;
    DatagenVolumeSieve sieve;
    Status result = datagen_volume_law_parse(&law, wrong[k].text);
    if (result == STATUS_OK) result = datagen_volume_law_sieve_make(&sieve, &law);
    ck_assert_int_eq(result, STATUS_USAGE);
    ck_assert_msg(strstr(status_message(), wrong[k].reason), "%s: %s", wrong[k].text, status_message());
  }
}
END_TEST

START_TEST(laws_print_as_they_are_read) {
  int count;
  const DatagenLaw *laws = datagen_law_list(&count);
  for (int k = 0; k < count; k++) {
    char text[DATAGEN_MIX_TEXT];
    double mix[DATAGEN_KIND_COUNT];
    DatagenVolumeLaw volume;
    datagen_law_print_mix(laws[k].mix, text, sizeof text);
    ck_assert_ok(datagen_law_parse_mix(mix, text));
    ck_assert_mem_eq(mix, laws[k].mix, sizeof mix);
    datagen_volume_law_print(&laws[k].volume, text, sizeof text);
    ck_assert_ok(datagen_volume_law_parse(&volume, text));
    ck_assert(volume.shape == laws[k].volume.shape && volume.low == laws[k].volume.low &&
              volume.high == laws[k].volume.high);
  }
}
END_TEST

START_TEST(wrong_mixes_are_refused_by_what_is_wrong) {
  static const struct {
    const char *text, *reason;
  } wrong[] = {{"", "KIND=SHARE"},
               {"none", "KIND=SHARE"},
               {"none=50,", "KIND=SHARE"},
               {"none=fifty", "a number from 0 up"},
               {"none=-1", "a number from 0 up"},
               {"none=nan", "a number from 0 up"},
               {"none=0", "sum to 0"},
               {"none=1,none=2", "twice"},
               {"vertex-fase=1", "did you mean 'vertex-face'"},
               {"captured=1", "from a run"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    double mix[DATAGEN_KIND_COUNT];
    ck_assert_int_eq(datagen_law_parse_mix(mix, wrong[k].text), STATUS_USAGE);
    ck_assert_msg(strstr(status_message(), wrong[k].reason), "%s: %s", wrong[k].text, status_message());
  }
}
END_TEST

START_TEST(counts_of_kinds_are_the_mix_rounded) {
  long long counts[DATAGEN_KIND_COUNT];
  datagen_law_divide((double[DATAGEN_KIND_COUNT]){50, 5, 7, 20, 18}, 12000000, counts);
  ck_assert(counts[0] == 6000000 && counts[1] == 600000 && counts[2] == 840000 && counts[3] == 2400000 &&
            counts[4] == 2160000);
  datagen_law_divide((double[DATAGEN_KIND_COUNT]){1, 1, 1}, 8, counts);
  ck_assert_int_eq(counts[0] + counts[1] + counts[2], 8);
  for (int k = 0; k < 3; k++) ck_assert(counts[k] == 2 || counts[k] == 3);
}
END_TEST

// Over the whole each kind comes exactly as often as planned, and any stretch has about its share.
START_TEST(kinds_are_mixed_evenly_and_in_exact_numbers) {
  enum { STRETCH = 2000 };
  static const long long sizes[] = {1, 2, 3, 17, 4096, 4097, 30000};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    DatagenLaw law;
    DatagenPlan plan;
    long long counts[DATAGEN_KIND_COUNT] = {0};
    ck_assert_ok(datagen_law_find("paper-train", &law));
    ck_assert_ok(datagen_plan_make(&plan, &law, 20, sizes[s]));
    int disjoint = 0;
    for (long long i = 0; i < sizes[s]; i++) {
      DatagenKind kind = datagen_plan_kind(&plan, i);
      counts[kind]++;
      disjoint += kind == DATAGEN_NONE;
      if (i % STRETCH != STRETCH - 1) continue;
      ck_assert_near(disjoint, STRETCH * 0.5, 5 * sqrt(STRETCH * 0.25));
      disjoint = 0;
    }
    ck_assert_mem_eq(counts, plan.kind_counts, sizeof counts);
  }
}
END_TEST

START_TEST(shards_are_the_whole_without_gaps) {
  DatagenLaw law;
  DatagenPlan plan;
  ck_assert_ok(datagen_law_find("scene", &law));
  ck_assert_ok(datagen_plan_make(&plan, &law, 1, 1003));
  for (int shards = 1; shards < 40; shards++) {
    long long expected = 0, first, count;
    for (int shard = 1; shard <= shards; shard++, expected += count) {
      datagen_plan_shard(&plan, shard, shards, &first, &count);
      ck_assert_int_eq(first, expected);
      ck_assert(count == 1003 / shards || count == 1003 / shards + 1);
    }
    ck_assert_int_eq(expected, 1003);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("pairs");
  tcase_add_loop_test(cases, every_member_is_of_its_kind_and_in_the_unit_cube, 0, DATAGEN_CAPTURED);
  tcase_add_loop_test(cases, the_exact_model_and_the_separating_axes_bear_the_kind_out, 0, DATAGEN_CAPTURED);
  tcase_add_loop_test(cases, touching_is_a_matter_of_the_last_digit, DATAGEN_VERTEX_FACE, DATAGEN_VOLUMETRIC);
  tcase_add_loop_test(cases, touching_is_a_matter_of_the_last_digit, DATAGEN_VERTEX_VERTEX, DATAGEN_SCENE);
  tcase_add_test(cases, the_contact_is_at_any_vertex);
  tcase_add_test(cases, a_swap_share_exchanges_that_share);
  tcase_add_loop_test(cases, labels_by_clip_and_by_exact_agree, 0, 2);
  tcase_add_test(cases, the_gradient_is_that_of_the_volume);
  tcase_add_test(cases, the_training_law_is_uniform_in_the_logarithm_of_the_volume);
  tcase_add_test(cases, the_test_law_is_uniform_in_the_volume);
  tcase_add_test(cases, a_volume_law_leaves_the_shapes_alone);
  tcase_add_test(cases, the_natural_density_of_volumes_is_as_recorded);
  tcase_add_test(cases, the_floor_of_a_volume_law_drops_nothing_that_would_be_kept);
  tcase_add_test(cases, volume_laws_that_cannot_be_met_are_refused);
  tcase_add_test(cases, laws_print_as_they_are_read);
  tcase_add_test(cases, wrong_mixes_are_refused_by_what_is_wrong);
  tcase_add_test(cases, counts_of_kinds_are_the_mix_rounded);
  tcase_add_test(cases, kinds_are_mixed_evenly_and_in_exact_numbers);
  tcase_add_test(cases, shards_are_the_whole_without_gaps);
  return suite_run("datagen_pairs", cases, 120);
}
