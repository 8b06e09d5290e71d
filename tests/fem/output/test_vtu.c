// SPDX-License-Identifier: GPL-3.0-or-later
// fem/output/vtk: a frame is taken apart again by a small reader of the format's documentation, and every
// byte of every array must be back.
#include "suite.h"

#include <limits.h>
#include <omp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/output/vtk/base64.h"
#include "fem/output/vtk/pvd.h"
#include "fem/output/vtk/vtu.h"
#include "fem/output/vtk/vtu_read.h"

static char path[64];

static void name_path(void) {
  snprintf(path, sizeof path, "/tmp/tetlap_vtu_%ld.vtu", (long)getpid());
}

static void remove_path(void) {
  unlink(path);
}

// A reader.

// The DataArray element of that name, up to its closing bracket, and the value of one of its attributes.
static const char *find_array(const char *text, const char *name) {
  char key[128];
  snprintf(key, sizeof key, " Name=\"%s\"", name);
  const char *place = strstr(text, key);
  ck_assert_msg(place != NULL, "the frame has no array %s", name);
  while (*place != '<') place--;
  return place;
}

static void copy_attribute(const char *element, const char *name, char value[64]) {
  char key[64];
  snprintf(key, sizeof key, " %s=\"", name);
  const char *begin = strstr(element, key), *close = strchr(element, '>');
  ck_assert_msg(begin && begin < close, "no attribute %s", name);
  begin += strlen(key);
  size_t length = strcspn(begin, "\"");
  ck_assert_uint_lt(length, 64);
  memcpy(value, begin, length);
  value[length] = 0;
}

static int value_of(char c) {
  const char *alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", *place;
  place = c ? strchr(alphabet, c) : NULL;
  return place ? (int)(place - alphabet) : -1;
}

// Decodes one base64 text of `byte_count` bytes; returns where it ends.
static const char *decode(const char *text, unsigned char *bytes, size_t byte_count) {
  for (size_t done = 0; done < byte_count; text += 4) {
    unsigned group = 0;
    for (int k = 0; k < 4; k++) {
      int value = value_of(text[k]);
      size_t rest = byte_count - done;
      ck_assert_msg(value >= 0 || (text[k] == '=' && (size_t)k > rest), "not base64: %.8s", text);
      group = group << 6 | (unsigned)(value < 0 ? 0 : value);
    }
    for (int k = 0; k < 3 && done < byte_count; k++) bytes[done++] = (unsigned char)(group >> (16 - 8 * k));
  }
  return text;
}

// The array's bytes, decoded and inflated block by block; owned by the caller.
static unsigned char *read_array(const char *text, const char *name, size_t *byte_count) {
  const char *place = strchr(find_array(text, name), '>') + 1;
  while (*place == '\n') place++;
  uint64_t counts[3];
  decode(place, (unsigned char *)counts, sizeof counts);
  const uint64_t block_count = counts[0];
  if (block_count) ck_assert_uint_eq(counts[1], 32768);
  uint64_t *header = memory_zeroed(block_count + 3, sizeof *header);
  place = decode(place, (unsigned char *)header, (block_count + 3) * sizeof *header);
  const uint64_t *lengths = header + 3;
  size_t compressed_bytes = 0;
  for (uint64_t k = 0; k < block_count; k++) compressed_bytes += lengths[k];
  unsigned char *compressed = memory_zeroed(compressed_bytes, 1), *block = compressed;
  place = decode(place, compressed, compressed_bytes);
  ck_assert_int_eq(*place, '\n');
  unsigned char *bytes = memory_zeroed(block_count + 1, 32768);
  *byte_count = 0;
  for (uint64_t k = 0; k < block_count; block += lengths[k++]) {
    uLongf length = 32768;
    ck_assert_int_eq(uncompress(bytes + *byte_count, &length, block, lengths[k]), Z_OK);
    ck_assert_uint_eq(length, k + 1 < block_count || !counts[2] ? 32768 : counts[2]);
    *byte_count += length;
  }
  memory_free(header);
  memory_free(compressed);
  return bytes;
}

static void assert_array(const char *name, const char *type, int components, const void *expected,
                         size_t expected_bytes) {
  char *text, value[64];
  size_t size, byte_count;
  ck_assert_ok(file_read(path, &text, &size));
  const char *element = find_array(text, name);
  copy_attribute(element, "type", value);
  ck_assert_str_eq(value, type);
  copy_attribute(element, "NumberOfComponents", value);
  ck_assert_int_eq(atoi(value), components);
  unsigned char *bytes = read_array(text, name, &byte_count);
  ck_assert_uint_eq(byte_count, expected_bytes);
  ck_assert_mem_eq(bytes, expected, expected_bytes);
  memory_free(bytes);
  memory_free(text);
}

// One block as the writer would: VTK's header and the compressed bytes, each as base64 (free).
static char *pack_bytes(const void *bytes, size_t byte_count) {
  unsigned char packed[256];
  uLongf length = sizeof packed;
  ck_assert_int_eq(compress(packed, &length, bytes, byte_count), Z_OK);
  const uint64_t header[] = {1, 32768, byte_count, length};
  char *text = NULL;
  size_t size;
  FemBase64 base64 = {.stream = open_memstream(&text, &size)};
  fem_base64_write(&base64, header, sizeof header);
  fem_base64_end(&base64);
  fem_base64_write(&base64, packed, length);
  fem_base64_end(&base64);
  fclose(base64.stream);
  return text;
}

static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const int one_tet[4] = {0, 1, 2, 3};

static FemVtuFrame single_tetrahedron(void) {
  return (FemVtuFrame){
      .time = 0.1, .vertex_count = 4, .positions = corner[0], .cell_count = 1, .cells = one_tet};
}

// Random numbers in arrays of every kind, over many blocks.
typedef struct Large {
  int vertex_count, tet_count;
  double *positions, *vectors, *stress;
  int (*tets)[4], *body;
  FemVtuArray arrays[3];
  FemVtuFrame frame;
} Large;

static double *random_reals(Random *random, int count) {
  double *reals = memory_zeroed((size_t)count, sizeof *reals);
  for (int k = 0; k < count; k++) reals[k] = suite_normal(random);
  return reals;
}

static void create_large(Large *large, int vertex_count, int tet_count) {
  Random random = random_seeded(11, 0);
  *large = (Large){.vertex_count = vertex_count, .tet_count = tet_count};
  large->positions = random_reals(&random, 3 * vertex_count);
  large->vectors = random_reals(&random, 3 * vertex_count);
  large->stress = random_reals(&random, 6 * tet_count);
  large->tets = memory_zeroed((size_t)tet_count, sizeof *large->tets);
  large->body = memory_zeroed((size_t)tet_count, sizeof *large->body);
  for (int i = 0; i < tet_count; i++) {
    for (int a = 0; a < 4; a++) large->tets[i][a] = random_below(&random, vertex_count);
    large->body[i] = random_below(&random, 3);
  }
  large->arrays[0] = (FemVtuArray){.name = "velocity", .components = 3, .reals = large->vectors};
  large->arrays[1] =
      (FemVtuArray){.name = "stress", .is_cell = true, .components = 6, .reals = large->stress};
  large->arrays[2] = (FemVtuArray){.name = "body", .is_cell = true, .components = 1, .integers = large->body};
  large->frame = (FemVtuFrame){.time = 1,
                               .vertex_count = vertex_count,
                               .positions = large->positions,
                               .cell_count = tet_count,
                               .cells = large->tets[0],
                               .arrays = large->arrays,
                               .array_count = 3};
}

static void destroy_large(Large *large) {
  memory_free(large->positions), memory_free(large->vectors), memory_free(large->stress);
  memory_free(large->tets), memory_free(large->body);
}

START_TEST(a_single_tetrahedron_reads_back) {
  FemVtuFrame frame = single_tetrahedron();
  ck_assert_ok(fem_vtu_write(path, &frame));
  const int64_t end = 4;
  const uint8_t tetra = 10;
  assert_array("Points", "Float64", 3, corner, sizeof corner);
  assert_array("connectivity", "Int32", 1, one_tet, sizeof one_tet);
  assert_array("offsets", "Int64", 1, &end, sizeof end);
  assert_array("types", "UInt8", 1, &tetra, sizeof tetra);
}
END_TEST

START_TEST(base64_does_not_depend_on_how_bytes_are_cut) {
  // The test vectors of RFC 4648, section 10, in one piece and byte by byte.
  const char *const texts[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (size_t length = 0; length <= 6; length++)
    for (size_t piece = 1; piece <= 6; piece++) {
      char *text;
      size_t size;
      FemBase64 base64 = {.stream = open_memstream(&text, &size)};
      for (size_t k = 0; k < length; k += piece)
        fem_base64_write(&base64, "foobar" + k, length - k < piece ? length - k : piece);
      fem_base64_end(&base64);
      fclose(base64.stream);
      ck_assert_str_eq(text, texts[length]);
      free(text);
    }
}
END_TEST

START_TEST(the_time_stands_in_the_frame) {
  FemVtuFrame frame = single_tetrahedron();
  ck_assert_ok(fem_vtu_write(path, &frame));
  char *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  const char *value = strchr(find_array(text, "TimeValue"), '>') + 1;
  ck_assert(strtod(value, NULL) == frame.time);
  memory_free(text);
}
END_TEST

START_TEST(arrays_of_many_blocks_read_back_bit_for_bit) {
  Large large;
  create_large(&large, 5000, 7001);
  ck_assert_ok(fem_vtu_write(path, &large.frame));
  const size_t vectors = 3 * 5000 * sizeof(double);
  ck_assert_uint_gt(vectors, 3 * 32768);
  assert_array("Points", "Float64", 3, large.positions, vectors);
  assert_array("velocity", "Float64", 3, large.vectors, vectors);
  assert_array("stress", "Float64", 6, large.stress, 6 * 7001 * sizeof(double));
  assert_array("body", "Int32", 1, large.body, 7001 * sizeof(int));
  assert_array("connectivity", "Int32", 1, large.tets, 4 * 7001 * sizeof(int));
  destroy_large(&large);
}
END_TEST

static void fill_from(void *self, size_t first, size_t count, double *values) {
  memcpy(values, (const double *)self + 6 * first, 6 * count * sizeof *values);
}

// More than is compressed at a time: 2.4 MB.
START_TEST(values_given_in_turn_are_those_of_an_array) {
  enum { TETS = 71000 };
  Large large;
  create_large(&large, 50, TETS);
  ck_assert_ok(fem_vtu_write(path, &large.frame));
  size_t size, size_in_turn;
  char *whole, *in_turn;
  ck_assert_ok(file_read(path, &whole, &size));
  large.arrays[1].reals = NULL;
  large.arrays[1].fill = fill_from;
  large.arrays[1].self = large.stress;
  ck_assert_ok(fem_vtu_write(path, &large.frame));
  ck_assert_ok(file_read(path, &in_turn, &size_in_turn));
  ck_assert_uint_eq(size, size_in_turn);
  ck_assert_mem_eq(whole, in_turn, size);
  assert_array("stress", "Float64", 6, large.stress, 6 * TETS * sizeof(double));
  memory_free(whole), memory_free(in_turn);
  destroy_large(&large);
}
END_TEST

START_TEST(an_array_that_ends_with_a_block_reads_back) {
  Large large;
  create_large(&large, 4096, 4096); // scalars of 4096 doubles fill one block, integers half of one
  const FemVtuArray exact[] = {{.name = "full", .components = 1, .reals = large.positions},
                               {.name = "half", .is_cell = true, .components = 1, .integers = large.body}};
  large.frame.arrays = exact, large.frame.array_count = 2;
  ck_assert_ok(fem_vtu_write(path, &large.frame));
  assert_array("full", "Float64", 1, large.positions, 32768);
  assert_array("half", "Int32", 1, large.body, 16384);
  destroy_large(&large);
}
END_TEST

START_TEST(numbers_that_are_not_finite_survive) {
  const double odd[4] = {NAN, INFINITY, -INFINITY, -0.0};
  const FemVtuArray array = {.name = "odd", .components = 1, .reals = odd};
  FemVtuFrame frame = single_tetrahedron();
  frame.arrays = &array, frame.array_count = 1;
  ck_assert_ok(fem_vtu_write(path, &frame));
  assert_array("odd", "Float64", 1, odd, sizeof odd);
}
END_TEST

START_TEST(components_have_their_names) {
  const double nine[9] = {0};
  const FemVtuArray arrays[] = {{.name = "stress", .is_cell = true, .components = 6, .reals = nine},
                                {.name = "F", .is_cell = true, .components = 9, .reals = nine}};
  FemVtuFrame frame = single_tetrahedron();
  frame.arrays = arrays, frame.array_count = 2;
  ck_assert_ok(fem_vtu_write(path, &frame));
  char *text, value[64];
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  const char *const symmetric[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  for (int c = 0; c < 6; c++) {
    char key[32];
    snprintf(key, sizeof key, "ComponentName%d", c);
    copy_attribute(find_array(text, "stress"), key, value);
    ck_assert_str_eq(value, symmetric[c]);
  }
  copy_attribute(find_array(text, "F"), "ComponentName5", value);
  ck_assert_str_eq(value, "yz");
  memory_free(text);
}
END_TEST

// Found by review for tools/fuzz mesh: gigabytes were taken for a count in a file of a kilobyte.
START_TEST(a_frame_that_announces_more_than_it_can_hold_is_refused) {
  FemVtuFrame frame = single_tetrahedron();
  FemVtuContent content;
  char *text, changed[8192];
  size_t size, peak = memory_peak_bytes();
  ck_assert_ok(fem_vtu_write(path, &frame));
  ck_assert_ok(file_read(path, &text, &size));
  char *count = strstr(text, "NumberOfPoints=\"4\"");
  ck_assert_ptr_nonnull(count);
  ck_assert_uint_lt(size, sizeof changed - 16);
  snprintf(changed, sizeof changed, "%.*sNumberOfPoints=\"200000000\"%s", (int)(count - text), text,
           count + strlen("NumberOfPoints=\"4\""));
  FILE *stream = fopen(path, "wb");
  fputs(changed, stream);
  fclose(stream);
  ck_assert_int_eq(fem_vtu_read(path, &content), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "than a file of its size can hold"));
  ck_assert_uint_lt(memory_peak_bytes() - peak, 64 << 20);
  memory_free(text);
}
END_TEST

START_TEST(triangles_read_back_as_triangles_and_a_mixture_is_refused) {
  static const int triangles[2][3] = {{0, 2, 1}, {0, 1, 3}}, marks[2] = {7, 8};
  const FemVtuArray array = {.name = "face", .is_cell = true, .components = 1, .integers = marks};
  const FemVtuFrame frame = {.time = NAN, // at all times
                             .vertex_count = 4,
                             .positions = corner[0],
                             .cell = FEM_VTU_TRIANGLES,
                             .cell_count = 2,
                             .cells = triangles[0],
                             .arrays = &array,
                             .array_count = 1};
  const int64_t ends[] = {3, 6};
  const uint8_t types[] = {5, 5};
  ck_assert_ok(fem_vtu_write(path, &frame));
  assert_array("connectivity", "Int32", 1, triangles, sizeof triangles);
  assert_array("offsets", "Int64", 1, ends, sizeof ends);
  assert_array("types", "UInt8", 1, types, sizeof types);
  FemVtuContent content;
  ck_assert_ok(fem_vtu_read(path, &content));
  ck_assert_int_eq(content.cell, FEM_VTU_TRIANGLES);
  ck_assert_int_eq(content.cell_count, 2);
  ck_assert_mem_eq(content.cells, triangles, sizeof triangles);
  ck_assert(content.fields[0].values[1] == 8.0 && isnan(content.time));
  fem_vtu_read_destroy(&content);

  // Two tetrahedra have ends and types of their own; those types on the triangles' corners are a mixture.
  char *text, *types_at;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  types_at = strstr(text, "Name=\"types\"");
  ck_assert_ptr_nonnull(types_at);
  const uint8_t mixed[] = {5, 10};
  char *packed = pack_bytes(mixed, sizeof mixed), *end = strstr(types_at, "\n        </DataArray>");
  FILE *stream = fopen(path, "wb");
  fprintf(stream, "%.*s\n%s%s", (int)(strchr(types_at, '>') + 1 - text), text, packed, end);
  fclose(stream);
  free(packed);
  memory_free(text);
  ck_assert_int_eq(fem_vtu_read(path, &content), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "neither all tetrahedra nor all triangles"));
}
END_TEST

// Arrays that are named as those of the cells do not stand for them, nor the cells' for them.
START_TEST(a_name_of_the_cells_is_as_good_as_any) {
  static const int marks[4] = {9, 8, 7, 6}, mark = 5;
  const FemVtuArray arrays[] = {
      {.name = "offsets", .components = 1, .integers = marks},
      {.name = "connectivity", .is_cell = true, .components = 1, .integers = &mark}};
  FemVtuFrame frame = single_tetrahedron();
  frame.arrays = arrays, frame.array_count = 2;
  ck_assert_ok(fem_vtu_write(path, &frame));
  FemVtuContent content;
  ck_assert_ok(fem_vtu_read(path, &content));
  ck_assert_int_eq(content.field_count, 2);
  for (int v = 0; v < 4; v++) ck_assert_double_eq(content.fields[0].values[v], marks[v]);
  ck_assert_double_eq(content.fields[1].values[0], mark);
  ck_assert_mem_eq(content.cells, one_tet, sizeof one_tet);
  fem_vtu_read_destroy(&content);

  // Cells whose second array is not the ends of each are no frame of ours.
  char *text, *at;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  at = strstr(strstr(text, "<Cells>"), "offsets");
  memcpy(at, "offsetz", 7);
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fwrite(text, 1, size, writer.stream);
  ck_assert_ok(file_commit(&writer));
  memory_free(text);
  ck_assert_int_eq(fem_vtu_read(path, &content), STATUS_INPUT);
}
END_TEST

START_TEST(a_name_cannot_break_the_xml) {
  const double four[4] = {1, 2, 3, 4};
  const FemVtuArray array = {.name = "a<b & \"c\">", .components = 1, .reals = four};
  FemVtuFrame frame = single_tetrahedron();
  frame.arrays = &array, frame.array_count = 1;
  ck_assert_ok(fem_vtu_write(path, &frame));
  assert_array("a&lt;b &amp; &quot;c&quot;&gt;", "Float64", 1, four, sizeof four);
}
END_TEST

START_TEST(the_bytes_do_not_depend_on_the_number_of_threads) {
  Large large;
  create_large(&large, 5000, 5000);
  char *texts[2];
  size_t sizes[2];
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(k ? 4 : 1);
    ck_assert_ok(fem_vtu_write(path, &large.frame));
    ck_assert_ok(file_read(path, &texts[k], &sizes[k]));
  }
  ck_assert_uint_eq(sizes[0], sizes[1]);
  ck_assert_mem_eq(texts[0], texts[1], sizes[0]);
  memory_free(texts[0]), memory_free(texts[1]);
  destroy_large(&large);
}
END_TEST

START_TEST(every_failed_allocation_is_an_error_that_leaves_the_old_frame) {
  const double four[4] = {1, 2, 3, 4};
  const FemVtuArray array = {.name = "a", .components = 1, .reals = four};
  FemVtuFrame frame = single_tetrahedron(), later = frame;
  ck_assert_ok(fem_vtu_write(path, &frame));
  char *old;
  size_t old_size;
  ck_assert_ok(file_read(path, &old, &old_size));
  later.arrays = &array, later.array_count = 1;
  long k = 1;
  for (Status status = STATUS_MEMORY; status; k++) {
    memory_fail_at(k);
    status = fem_vtu_write(path, &later);
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
    char *text;
    size_t size;
    ck_assert_ok(file_read(path, &text, &size));
    if (status) {
      ck_assert_uint_eq(size, old_size);
      ck_assert_mem_eq(text, old, size);
    } else
      ck_assert_uint_gt(size, old_size);
    memory_free(text);
    ck_assert_int_lt(k, 1000);
  }
  ck_assert_int_gt(k, 10); // it did fail
  memory_free(old);
}
END_TEST

START_TEST(a_place_that_cannot_be_written_is_named) {
  FemVtuFrame frame = single_tetrahedron();
  ck_assert_int_eq(fem_vtu_write("/tmp/no_such_directory/frame.vtu", &frame), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "/tmp/no_such_directory/frame.vtu"));
}
END_TEST

START_TEST(a_full_disk_is_an_error) {
  // /dev/full accepts nothing: a file there under the name that file_begin chooses.
  char temporary[96];
  snprintf(temporary, sizeof temporary, "%s.%ld.part", path, (long)getpid());
  ck_assert_int_eq(symlink("/dev/full", temporary), 0);
  FemVtuFrame frame = single_tetrahedron();
  ck_assert_int_eq(fem_vtu_write(path, &frame), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), path));
  ck_assert(!file_exists(path));
  struct stat info;
  ck_assert_int_ne(lstat(temporary, &info), 0); // nothing is left beside it
}
END_TEST

START_TEST(the_list_of_frames_names_each_with_its_time) {
  const double times[] = {0, 0.1, 1.0 / 3};
  const char *const files[] = {"frames/0.vtu", "frames/1.vtu", "frames/a&b.vtu"};
  FileWriter list;
  ck_assert_ok(fem_pvd_begin(&list, path));
  for (int k = 0; k < 3; k++) fem_pvd_add(&list, times[k], 0, NULL, files[k]);
  ck_assert_ok(fem_pvd_commit(&list));
  char *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  const char *place = text;
  for (int k = 0; k < 3; k++) {
    place = strstr(place, "<DataSet timestep=\"");
    ck_assert_ptr_nonnull(place);
    place += strlen("<DataSet timestep=\"");
    ck_assert(strtod(place, NULL) == times[k]);
  }
  ck_assert_ptr_null(strstr(place, "<DataSet"));
  ck_assert_ptr_nonnull(strstr(place, "file=\"frames/a&amp;b.vtu\""));
  memory_free(text);
}
END_TEST

// A list of `count` entries of these parts, each at its time.
static void write_parts(int count, const double *times, const int *parts) {
  FileWriter list;
  ck_assert_ok(fem_pvd_begin(&list, path));
  for (int k = 0; k < count; k++) {
    char file[16];
    snprintf(file, sizeof file, "%d.vtu", k);
    fem_pvd_add(&list, times[k], parts[k], parts[k] ? "a \"floor\"" : NULL, file);
  }
  ck_assert_ok(fem_pvd_commit(&list));
}

START_TEST(a_list_reads_back_with_its_parts) {
  FemPvdList list;
  write_parts(6, (double[]){0, 0, 0, 0.1, 0.1, 0.1}, (int[]){0, 1, 2, 0, 1, 2});
  ck_assert_ok(fem_pvd_read(path, &list));
  ck_assert_int_eq(list.count, 2);
  ck_assert_int_eq(list.part_count, 3);
  ck_assert(list.times[0] == 0.0 && list.times[1] == 0.1);
  ck_assert_str_eq(list.files[3 * 1 + 2], "5.vtu");
  fem_pvd_destroy(&list);
  write_parts(0, NULL, NULL);
  ck_assert_ok(fem_pvd_read(path, &list));
  ck_assert_int_eq(list.count, 0);
  fem_pvd_destroy(&list);
}
END_TEST

START_TEST(a_list_whose_times_have_other_parts_is_refused) {
  static const struct {
    int count, parts[4];
    double times[4];
  } lists[] = {
      {2, {0, INT_MAX}, {0, 0}},       // far from in order
      {3, {0, 1, 0}, {0, 0, 1}},       // the last lacks one
      {4, {0, 0, 1, 0}, {0, 1, 1, 2}}, // the second has one more
      {3, {0, 2, 1}, {0, 0, 0}},       // not in order
      {2, {0, 1}, {0, 1}},             // of another time
      {1, {1}, {0}},                   // without a first
  };
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
    FemPvdList list;
    write_parts(lists[k].count, lists[k].times, lists[k].parts);
    ck_assert_int_eq(fem_pvd_read(path, &list), STATUS_INPUT);
    ck_assert_ptr_nonnull(strstr(status_message(), path));
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("vtu");
  tcase_add_checked_fixture(cases, name_path, remove_path);
  tcase_add_test(cases, base64_does_not_depend_on_how_bytes_are_cut);
  tcase_add_test(cases, a_single_tetrahedron_reads_back);
  tcase_add_test(cases, the_time_stands_in_the_frame);
  tcase_add_test(cases, arrays_of_many_blocks_read_back_bit_for_bit);
  tcase_add_test(cases, values_given_in_turn_are_those_of_an_array);
  tcase_add_test(cases, an_array_that_ends_with_a_block_reads_back);
  tcase_add_test(cases, numbers_that_are_not_finite_survive);
  tcase_add_test(cases, components_have_their_names);
  tcase_add_test(cases, a_frame_that_announces_more_than_it_can_hold_is_refused);
  tcase_add_test(cases, triangles_read_back_as_triangles_and_a_mixture_is_refused);
  tcase_add_test(cases, a_name_of_the_cells_is_as_good_as_any);
  tcase_add_test(cases, a_name_cannot_break_the_xml);
  tcase_add_test(cases, the_bytes_do_not_depend_on_the_number_of_threads);
  tcase_add_test(cases, every_failed_allocation_is_an_error_that_leaves_the_old_frame);
  tcase_add_test(cases, a_place_that_cannot_be_written_is_named);
  tcase_add_test(cases, a_full_disk_is_an_error);
  tcase_add_test(cases, the_list_of_frames_names_each_with_its_time);
  tcase_add_test(cases, a_list_reads_back_with_its_parts);
  tcase_add_test(cases, a_list_whose_times_have_other_parts_is_refused);
  return suite_run("vtu", cases, 30);
}
