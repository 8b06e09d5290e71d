// SPDX-License-Identifier: GPL-3.0-or-later
// app/pairs, app/dataset/import.h, `tetlap overlap` and `tetlap dataset import`: one's own pairs of
// tetrahedra.
#include "suite.h"

#include <hdf5.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "app/dataset/import.h"
#include "app/pairs/npy.h"
#include "app/pairs/reader.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "overlap/models.h"

enum { MOST_TEXT = 1 << 16, PAIRS = 300 };

static char directory[64];

static const char *scratch(const char *name) {
  static char paths[4][128];
  static int next;
  if (!directory[0]) {
    strcpy(directory, "/tmp/tetlap-pairs-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(directory));
  }
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", directory, name);
  return path;
}

static void remove_scratch(void) {
  char command[96];
  if (!directory[0]) return;
  snprintf(command, sizeof command, "rm -rf %s", directory);
  ck_assert_int_eq(system(command), 0);
  directory[0] = 0;
}

static const char *put(const char *name, const void *content, size_t size) {
  const char *path = scratch(name);
  FILE *stream = fopen(path, "wb");
  ck_assert_ptr_nonnull(stream);
  ck_assert_uint_eq(fwrite(content, 1, size, stream), size);
  ck_assert_int_eq(fclose(stream), 0);
  return path;
}

static const char *put_text(const char *name, const char *content) {
  return put(name, content, strlen(content));
}

// The exit code; what it says and prints goes to `text`.
static int run(const char *arguments, char text[MOST_TEXT]) {
  char command[1024];
  snprintf(command, sizeof command, "cd %s && { %s %s; } 2>&1", scratch(""), TETLAP_PROGRAM, arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t size = fread(text, 1, MOST_TEXT - 1, pipe);
  text[size] = 0;
  return WEXITSTATUS(pclose(pipe));
}

// The corner x, y, z ≥ 0, x + y + z ≤ 1, and the same moved by a tenth along each axis: what they share is a
// corner of edge 0.7, V = 0.343 / 6, its centroid a quarter of that from the faces. Moved by t along x, it is
// (0.7 − t)³ / 6: −0.49 / 2.
#define CORNERS "0,0,0, 1,0,0, 0,1,0, 0,0,1, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1"
static const double corner_volume = 0.343 / 6, corner_slope = -0.49 / 2, corner_centroid = 0.1 + 0.7 / 4;

// The numbers behind a key of the first line of JSON.
static void numbers_of(const char *text, const char *key, int count, double *numbers) {
  char head[32];
  snprintf(head, sizeof head, "\"%s\":[", key);
  const char *at = strstr(text, head);
  ck_assert_msg(at != NULL, "%s in %s", key, text);
  at += strlen(head);
  for (int k = 0; k < count; k++) {
    char *end;
    numbers[k] = strtod(at, &end);
    ck_assert_msg(end != at && *end == (k + 1 < count ? ',' : ']'), "%s in %s", key, text);
    at = end + 1;
  }
}

START_TEST(a_pair_that_a_hand_can_compute) {
  static char text[MOST_TEXT];
  double gradient[24], centroid[3];
  put_text("corners.csv", CORNERS "\n");
  ck_assert_int_eq(run("overlap corners.csv --model exact --json", text), 0);
  Record *record;
  ck_assert_ok(record_parse(&record, text, strlen(text), "answer"));
  ck_assert_near(record_find_number(record, "volume"), corner_volume, 1e-15);
  ck_assert_int_eq(record_count(record_find(record, "flags")), 0);
  record_destroy(record);
  numbers_of(text, "gradient", 24, gradient);
  numbers_of(text, "centroid", 3, centroid);
  for (int c = 0; c < 3; c++) {
    double slope = 0;
    for (int v = 0; v < 4; v++) slope += gradient[12 + 3 * v + c];
    ck_assert_near(slope, corner_slope, 1e-14);
    ck_assert_near(centroid[c], corner_centroid, 1e-14);
  }
}
END_TEST

START_TEST(order_0_gives_volumes_and_flags_have_names) {
  static char text[MOST_TEXT];
  put_text("apart.csv", CORNERS "\n0,0,0, 1,0,0, 0,1,0, 0,0,1, 5,0,0, 6,0,0, 5,1,0, 5,0,1\n");
  ck_assert_int_eq(run("overlap apart.csv --order 0 -o apart.json && cat apart.json", text), 0);
  ck_assert_ptr_null(strstr(text, "gradient"));
  ck_assert_ptr_nonnull(strstr(text, "{\"volume\":0,\"centroid\":[0,0,0],\"flags\":[\"disjoint\"]}\n"));
  ck_assert_int_eq(run("overlap apart.csv --order 0 -m geo", text), 0);
  ck_assert_int_eq(strncmp(text, "volume,centroid_x,centroid_y,centroid_z,flags\n0.05", 50), 0);
  ck_assert_ptr_nonnull(strstr(text, "\n0,0,0,0,disjoint\n"));
}
END_TEST

// Uniform in the unit cube.
static void fill(double pairs[PAIRS][24]) {
  Random random = random_seeded(7, 0);
  for (int i = 0; i < PAIRS; i++)
    for (int k = 0; k < 24; k++) pairs[i][k] = random_uniform(&random);
}

static void put_csv(const char *name, const char *head, double pairs[PAIRS][24], const char *between) {
  FILE *stream = fopen(scratch(name), "w");
  ck_assert_ptr_nonnull(stream);
  fputs(head, stream);
  for (int i = 0; i < PAIRS; i++)
    for (int k = 0; k < 24; k++) fprintf(stream, "%.17g%s", pairs[i][k], k < 23 ? between : "\r\n");
  ck_assert_int_eq(fclose(stream), 0);
}

// A .npy file as numpy.save writes it: head filled up with blanks to 128 bytes.
static void put_npy(const char *name, const char *type, const char *shape, const void *content, size_t size) {
  FILE *stream = fopen(scratch(name), "wb");
  ck_assert_ptr_nonnull(stream);
  fwrite("\x93NUMPY\x01\x00\x76\x00", 1, 10, stream);
  int length = fprintf(stream, "{'descr': '%s', 'fortran_order': False, 'shape': %s, }", type, shape);
  fprintf(stream, "%*s\n", 117 - length, "");
  fwrite(content, 1, size, stream);
  ck_assert_int_eq(fclose(stream), 0);
}

static void expect_volumes(const char *path, const double *volumes, double tolerance) {
  static AppPairsReader reader;
  static double found[PAIRS];
  OverlapModel model;
  ck_assert_ok(app_pairs_reader_open(&reader, path, false));
  ck_assert_ok(app_pairs_reader_next(&reader));
  ck_assert_int_eq(reader.block.count, PAIRS);
  ck_assert_ok(overlap_models_create(&model, "exact"));
  ck_assert_ok(overlap_model_eval(
      &model, &(OverlapBatch){.pair_count = PAIRS, .pairs = reader.block.coordinates, .volume = found}));
  overlap_model_destroy(&model);
  for (int i = 0; i < PAIRS; i++) ck_assert_near(found[i], volumes[i], tolerance);
  ck_assert_ok(app_pairs_reader_next(&reader));
  ck_assert_int_eq(reader.block.count, 0);
  app_pairs_reader_close(&reader);
}

START_TEST(every_form_of_the_same_pairs_gives_the_same_volumes) {
  static double pairs[PAIRS][24], volumes[PAIRS], swapped[PAIRS][24];
  static float narrow[PAIRS][24];
  double sum = 0;
  OverlapModel model;
  fill(pairs);
  ck_assert_ok(overlap_models_create(&model, "exact"));
  ck_assert_ok(overlap_model_eval(
      &model, &(OverlapBatch){.pair_count = PAIRS, .pairs = &pairs[0][0], .volume = volumes}));
  overlap_model_destroy(&model);
  for (int i = 0; i < PAIRS; i++) sum += volumes[i];
  ck_assert_double_gt(sum, 0.05); // they do overlap
  put_csv("a.csv", "", pairs, ",");
  put_csv("b.csv", "# made by hand\n\n", pairs, " \t ");
  put_csv("c.csv", "\xef\xbb\xbf", pairs, "; ");
  put_csv("d.csv", "x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4,X1,Y1,Z1,X2,Y2,Z2,X3,Y3,Z3,X4,Y4,Z4\n", pairs, ",");
  for (int i = 0; i < 4; i++)
    expect_volumes(scratch((const char *[]){"a.csv", "b.csv", "c.csv", "d.csv"}[i]), volumes, 0);
  put_npy("a.npy", "<f8", "(300, 2, 4, 3)", pairs, sizeof pairs);
  expect_volumes(scratch("a.npy"), volumes, 0);
  for (int i = 0; i < PAIRS; i++)
    for (int k = 0; k < 24; k++) {
      uint64_t bits;
      memcpy(&bits, &pairs[i][k], sizeof bits);
      bits = __builtin_bswap64(bits);
      memcpy(&swapped[i][k], &bits, sizeof bits);
      narrow[i][k] = (float)pairs[i][k];
    }
  put_npy("b.npy", ">f8", "(300, 24)", swapped, sizeof swapped);
  expect_volumes(scratch("b.npy"), volumes, 0);
  put_npy("c.npy", "<f4", "(300, 8, 3)", narrow, sizeof narrow);
  expect_volumes(scratch("c.npy"), volumes, 1e-6);
}
END_TEST

static void expect_fault(const char *name, const char *words) {
  static char text[MOST_TEXT];
  char arguments[128];
  snprintf(arguments, sizeof arguments, "overlap %s -o answer.csv", name);
  ck_assert_msg(run(arguments, text) == 65, "%s: %s", name, text);
  ck_assert_msg(strstr(text, words) != NULL, "'%s' lacks '%s'", text, words);
  ck_assert_msg(!file_exists(scratch("answer.csv")), "%s", name);
}

// An array of native floats or doubles in a file of its own.
static void put_hdf5(const char *name, const char *array, hid_t type, int rank, const hsize_t *shape,
                     const void *content) {
  hid_t file = H5Fcreate(scratch(name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  hid_t space = H5Screate_simple(rank, shape, NULL);
  hid_t dataset = H5Dcreate2(file, array, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  ck_assert_int_ge(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, content), 0);
  H5Dclose(dataset), H5Sclose(space), H5Fclose(file);
}

START_TEST(hdf5_files_of_others_are_read_by_their_array) {
  static double pairs[PAIRS][24], volumes[PAIRS];
  static float narrow[PAIRS][24];
  OverlapModel model;
  fill(pairs);
  for (int i = 0; i < PAIRS; i++)
    for (int k = 0; k < 24; k++) narrow[i][k] = (float)pairs[i][k];
  ck_assert_ok(overlap_models_create(&model, "exact"));
  ck_assert_ok(overlap_model_eval(
      &model, &(OverlapBatch){.pair_count = PAIRS, .pairs = &pairs[0][0], .volume = volumes}));
  overlap_model_destroy(&model);
  put_hdf5("a.h5", "coordinates", H5T_NATIVE_DOUBLE, 4, (hsize_t[4]){PAIRS, 2, 4, 3}, pairs);
  expect_volumes(scratch("a.h5"), volumes, 0);
  put_hdf5("b.h5", "x", H5T_NATIVE_DOUBLE, 2, (hsize_t[2]){PAIRS, 24}, pairs);
  expect_volumes(scratch("b.h5"), volumes, 0);
  put_hdf5("c.h5", "pairs", H5T_NATIVE_FLOAT, 3, (hsize_t[3]){PAIRS, 8, 3}, narrow);
  expect_volumes(scratch("c.h5"), volumes, 1e-6);
  put_hdf5("d.h5", "x", H5T_NATIVE_DOUBLE, 2, (hsize_t[2]){2 * PAIRS, 12}, pairs);
  expect_fault("d.h5", "d.h5: the array 'x' is not one of floating point numbers, 24 a row");
  pairs[3][4] = NAN;
  put_hdf5("e.h5", "x", H5T_NATIVE_DOUBLE, 2, (hsize_t[2]){PAIRS, 24}, pairs);
  expect_fault("e.h5", "e.h5: pair 3, number 4 (both from 0): nan");
  put("f.h5", "\x89HDF\r\n\x1a\n and no more", 20);
  static char text[MOST_TEXT];
  ck_assert_int_eq(run("overlap f.h5", text), 74);
  ck_assert_ptr_nonnull(strstr(text, "f.h5: cannot be opened as HDF5"));
}
END_TEST

// The second tetrahedron's columns first, a number in front.
START_TEST(a_header_that_names_the_columns_gives_their_order) {
  static char text[MOST_TEXT], expected[MOST_TEXT];
  put_text("named.csv", "id,\"b0x\",b0y,b0z,b1x,b1y,b1z,b2x,b2y,b2z,b3x,b3y,b3z,A0X,a0y,a0z,a1x,a1y,a1z,a2x,"
                        "a2y,a2z,a3x,a3y,a3z\n"
                        "17,.1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1,0,0,0, 1,0,0, 0,1,0, 0,0,1\n");
  put_text("corners.csv", CORNERS "\n");
  ck_assert_int_eq(run("overlap corners.csv", expected), 0);
  ck_assert_int_eq(run("overlap named.csv", text), 0);
  ck_assert_str_eq(text, expected);
  ck_assert_int_eq(run("overlap - < corners.csv", text), 0);
  ck_assert_str_eq(text, expected);
}
END_TEST

START_TEST(what_is_wrong_is_told_with_line_and_column) {
  put_text("letter.csv",
           CORNERS "\n\n0,0,0, 1,0,x, 0,1,0, 0,0,1, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1\n");
  expect_fault("letter.csv", "letter.csv:3:12: 'x' is none; a number is expected");
  put_text("nan.csv", "0,0,0, 1,nan,0, 0,1,0, 0,0,1, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1\n");
  expect_fault("nan.csv", "nan.csv:1:10: 'nan' is not finite");
  put_text("gap.csv", "0,0,0, 1,,0, 0,1,0, 0,0,1, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1\n");
  expect_fault("gap.csv", "gap.csv:1:10: nothing stands here");
  put_text("short.csv", CORNERS "\n1,2,3\n");
  expect_fault("short.csv", "short.csv:2:5: 3 numbers; the first line has 24");
  put_text("few.csv", "1,2,3\n");
  expect_fault("few.csv", "few.csv:1: 3 numbers in a row; expected 24");
  put_text("labelled.csv", CORNERS ",0.5\n"); // which of the 25 would be a coordinate?
  expect_fault("labelled.csv", "labelled.csv:1: 25 numbers in a row");
  put_text("head.csv", "a0x,a0y,a0z,a1x\n1,2,3,4\n");
  expect_fault("head.csv", "head.csv:1: the header has no column 'a1y'");
  put_text("twice.csv", "a0x,a0x\n1,2\n");
  expect_fault("twice.csv", "the header has the column 'a0x' twice");
  put_text("empty.csv", "\n# nothing\n");
  expect_fault("empty.csv", "empty.csv: is empty");
  put("zero.csv", "1,2\0,3\n", 7);
  expect_fault("zero.csv", "zero.csv:1:4: a zero byte");
}
END_TEST

START_TEST(npy_files_that_cannot_be_read_say_what_would_be_right) {
  static double pairs[PAIRS][24];
  fill(pairs);
  put_npy("short.npy", "<f8", "(300, 24)", pairs, sizeof pairs / 2);
  expect_fault("short.npy", "announces 300 rows and ends in row 150");
  put_npy("whole.npy", "<i8", "(300, 24)", pairs, sizeof pairs);
  expect_fault("whole.npy", "its type is '<i8'; float64 or float32 is expected");
  put_npy("records.npy", "|V192", "(300,)", pairs, sizeof pairs);
  expect_fault("records.npy", "float64 or float32 is expected");
  put_npy("wide.npy", "<f8", "(300, 12)", pairs, sizeof pairs / 2);
  expect_fault("wide.npy", "12 numbers in a row; expected 24");
  put_npy("deep.npy", "<f8", "(3, 100, 24)", pairs, sizeof pairs);
  expect_fault("deep.npy", "(n, 24) or (n, 2, 4, 3) is expected");
  put_npy("none.npy", "<f8", "(0, 24)", pairs, 0);
  expect_fault("none.npy", "holds no pairs");
  put("cut.npy", "\x93NUMPY\x01", 7);
  expect_fault("cut.npy", "ends within the head");
  pairs[7][5] = NAN;
  put_npy("nan.npy", "<f8", "(300, 24)", pairs, sizeof pairs);
  expect_fault("nan.npy", "row 7, number 5 (both from 0): nan");
}
END_TEST

// Fields in memory order: V, 24 derivatives, centroid, flags.
START_TEST(npy_answers_are_records_behind_a_head_of_whole_lines_of_64_bytes) {
  static char text[MOST_TEXT];
  put_text("corners.csv", CORNERS "\n" CORNERS "\n");
  ck_assert_int_eq(run("overlap corners.csv -o answer.npy", text), 0);
  char *content;
  size_t size;
  ck_assert_ok(file_read(scratch("answer.npy"), &content, &size));
  const char *head =
      "{'descr': [('volume', '<f8'), ('gradient', '<f8', (2, 4, 3)), ('centroid', '<f8', (3,)), ('flags', "
      "'<u4')], 'fortran_order': False, 'shape': (2,), }";
  size_t start = 10 + ((unsigned char)content[8] | (size_t)(unsigned char)content[9] << 8);
  ck_assert_int_eq(memcmp(content, "\x93NUMPY\x01\x00", 8), 0);
  ck_assert_uint_eq(start % 64, 0);
  ck_assert_int_eq(strncmp(content + 10, head, strlen(head)), 0);
  ck_assert_int_eq(content[start - 1], '\n');
  ck_assert_uint_eq(size, start + 2 * (28 * 8 + 4));
  for (int i = 0; i < 2; i++) {
    double record[28];
    unsigned flags;
    memcpy(record, content + start + (size_t)i * 228, sizeof record);
    memcpy(&flags, content + start + (size_t)i * 228 + sizeof record, sizeof flags);
    ck_assert_near(record[0], corner_volume, 1e-15);
    ck_assert_near(record[1 + 12] + record[1 + 15] + record[1 + 18] + record[1 + 21], corner_slope, 1e-14);
    ck_assert_near(record[25], corner_centroid, 1e-14);
    ck_assert_uint_eq(flags, 0);
  }
  memory_free(content);
  ck_assert_int_eq(run("overlap corners.csv -o answer.txt", text), 64);
  ck_assert_int_eq(run("overlap corners.csv --json -o answer.npy", text), 64);
  ck_assert_int_eq(run("overlap corners.csv > /dev/full", text), 74);
  ck_assert_int_eq(run("overlap .", text), 74);
  ck_assert_int_eq(run("overlap corners.csv --model clpi", text), 64);
  ck_assert_ptr_nonnull(strstr(text, "did you mean 'clip'"));
}
END_TEST

static void ignore_signal(int number) {
  (void)number;
}

// A signal that is handled, as Ctrl-C is, repeated so that one that comes before the wait is not the only
// one.
START_TEST(a_signal_ends_the_wait_for_standard_input) {
  static AppPairsReader reader;
  int ends[2];
  struct sigaction action = {.sa_handler = ignore_signal};
  sigaction(SIGALRM, &action, NULL);
  ck_assert_int_eq(pipe(ends), 0);
  ck_assert_int_eq(dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
  struct itimerval often = {{0, 20000}, {0, 20000}}, never = {0};
  setitimer(ITIMER_REAL, &often, NULL);
  Status status = app_pairs_reader_open(&reader, "-", false);
  setitimer(ITIMER_REAL, &never, NULL);
  ck_assert_int_eq(status, STATUS_INTERRUPTED);
  app_pairs_reader_close(&reader);
  // the same in the middle of a file
  clearerr(stdin);
  ck_assert_int_eq(write(ends[1], CORNERS "\n", strlen(CORNERS) + 1), (int)strlen(CORNERS) + 1);
  ck_assert_ok(app_pairs_reader_open(&reader, "-", false));
  setitimer(ITIMER_REAL, &often, NULL);
  status = app_pairs_reader_next(&reader);
  setitimer(ITIMER_REAL, &never, NULL);
  ck_assert_int_eq(status, STATUS_INTERRUPTED);
  app_pairs_reader_close(&reader);
}
END_TEST

// Labels of the corners: V right, half as large, and 0; status; and a pair that is apart, with V and status
// of one that is not.
#define APART "0,0,0, 1,0,0, 0,1,0, 0,0,1, 5,0,0, 6,0,0, 5,1,0, 5,0,1"
#define LABELS                                                                                               \
  CORNERS ",1,0.05716666666666666\n" CORNERS ",1,0.03\n" CORNERS ",0,0\n" APART ",0,0\n" APART ",1,0.25\n"

static void import(const char *path, AppImportDef def, AppImport *result, Status expected) {
  static AppPairsReader reader;
  ck_assert_ok(app_pairs_reader_open(&reader, path, true));
  ck_assert_int_eq(app_dataset_import_run(&reader, &def, result), expected);
  app_pairs_reader_close(&reader);
}

START_TEST(wrong_labels_are_counted_named_and_replaced) {
  AppImport result;
  const char *set = scratch("set.h5");
  import(put_text("labels.csv", LABELS), (AppImportDef){.output = set, .program = "test", .tolerance = 1e-6},
         &result, STATUS_OK);
  static const struct {
    AppImportFault fault;
    long long count, place;
  } expected[] = {
      {APP_IMPORT_WRONG_VOLUME, 1, 2}, {APP_IMPORT_MISSED_VOLUME, 1, 3}, {APP_IMPORT_MISSED_CONTACT, 1, 3},
      {APP_IMPORT_FALSE_VOLUME, 1, 5}, {APP_IMPORT_FALSE_CONTACT, 1, 5}, {APP_IMPORT_WRONG_GRADIENT, 0, 0},
      {APP_IMPORT_FLAT, 0, 0}};
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
    const AppImportFinding *finding = &result.findings[expected[k].fault];
    ck_assert_int_eq(finding->count, expected[k].count);
    if (finding->count) ck_assert_int_eq(finding->places[0], expected[k].place);
  }
  ck_assert_near(result.findings[APP_IMPORT_MISSED_VOLUME].largest, corner_volume, 1e-15);
  ck_assert_int_eq(app_dataset_import_fault_count(&result), 5);
  char text[512];
  app_dataset_import_tell(&result, APP_IMPORT_MISSED_VOLUME, "line", text, sizeof text);
  ck_assert_str_eq(
      text,
      "1 of 5 pairs: the label's V is 0, but the tetrahedra overlap (line 3); at most by 0.0572, in line 3");
  // in JSON places are whole numbers
  Record *record = record_new();
  app_dataset_import_record(&result, record);
  char *json = record_text_of(record);
  ck_assert_ptr_nonnull(strstr(json, "\"places\": [\n        3\n      ]"));
  memory_free(json);
  record_destroy(record);
  // the set has the right ones
  static AppPairsReader reader;
  ck_assert_ok(app_pairs_reader_open(&reader, set, false));
  ck_assert_ok(app_pairs_reader_next(&reader));
  ck_assert_int_eq(reader.block.count, 5);
  for (int i = 0; i < 5; i++) {
    ck_assert_near(reader.block.volume[i], i < 3 ? corner_volume : 0, 1e-15);
    ck_assert_int_eq(reader.block.status[i], i < 3);
  }
  ck_assert(!reader.has_gradient);
  app_pairs_reader_close(&reader);
}
END_TEST

START_TEST(a_strict_import_of_wrong_labels_writes_nothing) {
  AppImport result;
  const char *set = scratch("strict.h5");
  import(put_text("labels.csv", LABELS),
         (AppImportDef){.output = set, .program = "test", .tolerance = 1e-6, .is_strict = true}, &result,
         STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "5 labels are wrong"));
  ck_assert(!file_exists(set));
  // half of V is within a tolerance of 0.9
  import(put_text("loose.csv", CORNERS ",1,0.03\n"),
         (AppImportDef){.output = set, .program = "test", .tolerance = 0.9, .is_strict = true}, &result,
         STATUS_OK);
  ck_assert(file_exists(set));
}
END_TEST

START_TEST(flat_pairs_are_left_out_and_told) {
  static char text[MOST_TEXT];
  put_text("flat.csv",
           CORNERS ",0.05716666666666666\n0,0,0, 1,0,0, 0,1,0, 1,1,0, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, "
                   ".1,.1,1.1,0\n");
  ck_assert_int_eq(run("dataset import flat.csv -o flat.h5", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "a tetrahedron has no volume: the pair is left out (line 2)"));
  ck_assert_ptr_nonnull(strstr(text, "1 pairs with exact labels"));
}
END_TEST

// exact's own answers of random pairs, touching ones among them, agree; eval and overlap take the set.
START_TEST(eval_takes_an_imported_set_and_right_labels_are_not_doubted) {
  static char text[MOST_TEXT];
  static double pairs[PAIRS][24], rows[PAIRS][49], volumes[PAIRS], gradients[PAIRS][24];
  OverlapModel model;
  fill(pairs);
  for (int i = 0; i < 20; i++) memcpy(&pairs[i][12], &pairs[i][0], 3 * sizeof(double)); // a common vertex
  ck_assert_ok(overlap_models_create(&model, "exact"));
  ck_assert_ok(overlap_model_eval(&model, &(OverlapBatch){.pair_count = PAIRS,
                                                          .pairs = &pairs[0][0],
                                                          .volume = volumes,
                                                          .gradient = &gradients[0][0]}));
  overlap_model_destroy(&model);
  for (int i = 0; i < PAIRS; i++) {
    memcpy(rows[i], pairs[i], sizeof pairs[i]);
    rows[i][24] = volumes[i];
    memcpy(rows[i] + 25, gradients[i], sizeof gradients[i]);
  }
  put_npy("rows.npy", "<f8", "(300, 49)", rows, sizeof rows);
  ck_assert_int_eq(run("dataset import rows.npy -o rows.h5 --strict", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "300 pairs with exact labels; all labels of the file agree"));
  ck_assert_int_eq(run("eval clip rows.h5 --json", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "\"mae\""));
  ck_assert_int_eq(run("eval geo rows.h5", text), 0);
  ck_assert_int_eq(run("eval hybrid:.01=geo-small rows.h5 --json", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "\"bound_coverage\": 0."));
  ck_assert_ptr_nonnull(strstr(text, "\"handed_on_in_part\": 0."));
  ck_assert_int_eq(run("eval hybrid rows.h5", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "error within its bound"));
  ck_assert_ptr_nonnull(strstr(text, "handed on in part"));
  expect_volumes(scratch("rows.h5"), volumes, 0);
  rows[4][30] += 1e-3;
  put_npy("rows.npy", "<f8", "(300, 49)", rows, sizeof rows);
  ck_assert_int_eq(run("dataset import rows.npy -o rows.h5 --json", text), 0);
  ck_assert_ptr_nonnull(strstr(text, "derivatives are others than the exact ones (row 4)"));
  ck_assert_ptr_nonnull(strstr(text, "\"wrong_labels\": 1"));
  ck_assert_int_eq(run("dataset import rows.h5 -o other.h5", text), 65);
  ck_assert_ptr_nonnull(strstr(text, "is a data set already"));
}
END_TEST

// The number behind the first `key` after `section`.
static double number_behind(const char *text, const char *section, const char *key) {
  const char *at = strstr(text, section);
  ck_assert_msg(at && (at = strstr(at, key)), "no %s of %s in %s", key, section, text);
  return strtod(at + strlen(key), NULL);
}

// A block just lands on another: most elements that are near share nothing. tpn takes some of them for
// overlapping, geo none.
START_TEST(a_capture_has_near_misses_by_which_ghosts_are_found) {
  static char text[MOST_TEXT];
  ck_assert_int_eq(run("run " TETLAP_SOURCE_DIR "/tests/scenes/onset.yaml -o out -m clip -s time.end=0.065 "
                       "-s output.vtu=false --capture a.h5",
                       text),
                   0);
  ck_assert_msg(strstr(text, "them near misses, which share nothing"), "%s", text);
  ck_assert_int_eq(run("eval tpn a.h5 --json", text), 0);
  ck_assert(number_behind(text, "\"accuracy\"", "\"captured\": ") > 0.9);
  double near = number_behind(text, "\"accuracy\"", "\"scene-none\": ");
  ck_assert_msg(near > 0.5 && near < 0.999, "%g", near);
  ck_assert(number_behind(text, "\"ghost_volume\"", ": ") > 0);
  ck_assert_int_eq(run("eval geo a.h5 --json", text), 0);
  ck_assert_near(number_behind(text, "\"accuracy\"", "\"scene-none\": "), 1, 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("pairs");
  tcase_add_checked_fixture(cases, NULL, remove_scratch);
  tcase_add_test(cases, a_pair_that_a_hand_can_compute);
  tcase_add_test(cases, order_0_gives_volumes_and_flags_have_names);
  tcase_add_test(cases, every_form_of_the_same_pairs_gives_the_same_volumes);
  tcase_add_test(cases, hdf5_files_of_others_are_read_by_their_array);
  tcase_add_test(cases, a_header_that_names_the_columns_gives_their_order);
  tcase_add_test(cases, what_is_wrong_is_told_with_line_and_column);
  tcase_add_test(cases, npy_files_that_cannot_be_read_say_what_would_be_right);
  tcase_add_test(cases, npy_answers_are_records_behind_a_head_of_whole_lines_of_64_bytes);
  tcase_add_test(cases, a_signal_ends_the_wait_for_standard_input);
  tcase_add_test(cases, wrong_labels_are_counted_named_and_replaced);
  tcase_add_test(cases, a_strict_import_of_wrong_labels_writes_nothing);
  tcase_add_test(cases, flat_pairs_are_left_out_and_told);
  tcase_add_test(cases, eval_takes_an_imported_set_and_right_labels_are_not_doubted);
  tcase_add_test(cases, a_capture_has_near_misses_by_which_ghosts_are_found);
  return suite_run("pairs", cases, 60);
}
