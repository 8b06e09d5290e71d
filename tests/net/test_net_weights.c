// SPDX-License-Identifier: GPL-3.0-or-later
// net/: a network survives its file; a file that is corrupt or foreign is refused by the name of what is
// wrong.
#include "net_suite.h"

#include <stdint.h>
#include <sys/resource.h>
#include <unistd.h>

static const char *temporary(void) {
  static char path[64];
  snprintf(path, sizeof path, "/tmp/tetlap_weights_%ld", (long)getpid());
  return path;
}

static NetCard make_card(void) {
  return (NetCard){
      .normalisation = "{\"kind\":\"unit\"}", .range = "{\"low\":0}", .provenance = "seed 7 – “a test”"};
}

// What a model computes for one input, in double.
static void evaluate(const NetModel_f64 *model, double y[2]) {
  NetWork_f64 work = net_suite_work(model, 1, 0, 0);
  double x[24];
  for (int k = 0; k < 24; k++) x[k] = 0.1 * k - 1;
  net_forward_eval_f64(&work, model, 1, x, y);
  net_work_destroy_f64(&work);
}

START_TEST(every_shape_survives_its_file_to_the_bit) {
  NetRandom random = net_random_seeded(31, 0);
  NetCard card = make_card(), back;
  for (int k = 0; k < 40; k++) {
    NetShape shape = net_suite_shape(&random, (NetKind)(k % 2));
    NetModel_f64 model = net_suite_model(&shape, (uint64_t)k), read;
    ck_net_ok(net_weights_write_f64(temporary(), &model, &card));
    ck_net_ok(net_weights_read_f64(temporary(), &read, &back));
    ck_assert(net_shape_equal(&read.plan->shape, &shape));
    ck_assert_int_eq(memcmp(read.parameters, model.parameters, model.plan->parameter_count * sizeof(double)),
                     0);
    ck_assert_str_eq(back.normalisation, card.normalisation);
    ck_assert_str_eq(back.range, card.range);
    ck_assert_str_eq(back.provenance, card.provenance);
    net_weights_card_destroy(&back);
    net_model_destroy_f64(&read), net_model_destroy_f64(&model);
  }
  unlink(temporary());
}
END_TEST

START_TEST(either_precision_reads_the_other) {
  NetShape shape = net_shape_tpn_b();
  NetModel_f64 model = net_suite_model(&shape, 3), wide;
  NetModel_f32 narrow, same = net_suite_narrow(&model);
  NetCard card = make_card(), back;
  ck_net_ok(net_weights_write_f64(temporary(), &model, &card));
  ck_net_ok(net_weights_read_f32(temporary(), &narrow, &back));
  net_weights_card_destroy(&back);
  ck_assert_int_eq(memcmp(narrow.parameters, same.parameters, 73370 * sizeof(float)), 0);
  ck_net_ok(net_weights_write_f32(temporary(), &narrow, &card));
  ck_net_ok(net_weights_read_f64(temporary(), &wide, &back));
  net_weights_card_destroy(&back);
  double y[2], z[2];
  evaluate(&model, y);
  evaluate(&wide, z);
  for (int k = 0; k < 2; k++) ck_assert_near(z[k], y[k], 1e-5 * (1 + fabs(y[k])));
  net_model_destroy_f64(&model), net_model_destroy_f64(&wide);
  net_model_destroy_f32(&narrow), net_model_destroy_f32(&same);
  unlink(temporary());
}
END_TEST

START_TEST(a_model_that_is_not_finite_is_not_written) {
  NetShape shape = net_shape_mlp(3, 4, 1, 1);
  NetModel_f64 model = net_suite_model(&shape, 3);
  NetCard card = make_card();
  net_model_tensor_f64(&model, "layer.1.bias")[0] = NAN;
  ck_net_fails(net_weights_write_f64(temporary(), &model, &card), NET_BAD_ARGUMENT, "layer.1.bias");
  ck_assert_int_ne(access(temporary(), F_OK), 0);
  net_model_destroy_f64(&model);
}
END_TEST

START_TEST(a_place_that_cannot_be_written_or_read_is_named) {
  NetShape shape = net_shape_mlp(3, 4, 1, 1);
  NetModel_f64 model = net_suite_model(&shape, 3), read;
  NetCard card = make_card(), back;
  ck_net_fails(net_weights_write_f64("/proc/no/place", &model, &card), NET_BAD_IO, "/proc/no/place");
  ck_net_fails(net_weights_read_f64("/tmp/tetlap-no-such-file", &read, &back), NET_BAD_IO,
               "tetlap-no-such-file");
  ck_net_fails(net_weights_read_f64("/tmp", &read, &back), NET_BAD_IO, "/tmp");
  net_model_destroy_f64(&model);
}
END_TEST

// A file made by hand: its header as text, then bytes of numbers.
static void write_by_hand(const char *header, const void *data, size_t size) {
  FILE *stream = fopen(temporary(), "wb");
  ck_assert_ptr_nonnull(stream);
  uint64_t length = strlen(header);
  fwrite(&length, sizeof length, 1, stream);
  fwrite(header, 1, length, stream);
  fwrite(data, 1, size, stream);
  fclose(stream);
}

#define METADATA                                                                                             \
  "\"__metadata__\":{\"format\":\"tetlap-net 1\",\"shape\":\"{\\\"kind\\\":\\\"mlp\\\",\\\"activation\\\":"  \
  "\\\"silu\\\",\\\"inputs\\\":2,\\\"hidden\\\":[],\\\"outputs\\\":1}\",\"normalisation\":\"none\","         \
  "\"range\":\"\",\"provenance\":\"by hand\"}"
#define WEIGHT "\"layer.0.weight\":{\"dtype\":\"F32\",\"shape\":[1,2],\"data_offsets\":[0,8]}"
#define BIAS "\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[8,12]}"

static void refuse(const char *header, const void *data, size_t size, const char *words) {
  NetModel_f64 model;
  NetCard card;
  write_by_hand(header, data, size);
  ck_net_fails(net_weights_read_f64(temporary(), &model, &card), NET_BAD_FILE, words);
  ck_assert_ptr_nonnull(strstr(net_status_message(), temporary()));
  unlink(temporary());
}

static const float numbers[4] = {2, 3, 4, 5};

START_TEST(a_file_made_by_hand_is_read) {
  NetModel_f64 model;
  NetCard card;
  write_by_hand("{" METADATA "," WEIGHT "," BIAS "}", numbers, 12);
  ck_net_ok(net_weights_read_f64(temporary(), &model, &card));
  NetWork_f64 work = net_suite_work(&model, 1, 0, 0);
  double x[2] = {10, 100}, y;
  net_forward_eval_f64(&work, &model, 1, x, &y);
  ck_assert_double_eq(y, 324);
  net_work_destroy_f64(&work);
  net_weights_card_destroy(&card);
  net_model_destroy_f64(&model);
  unlink(temporary());
}
END_TEST

START_TEST(a_corrupt_file_is_refused_by_what_is_wrong) {
  refuse("{" METADATA "," WEIGHT "," BIAS "}", numbers, 11, "truncated: tensor layer.0.bias ends at byte 12");
  refuse("{" METADATA "," WEIGHT "," BIAS "}", numbers, 16, "4 bytes behind layer.0.bias");
  refuse("{" METADATA "," WEIGHT, numbers, 12, "header");
  refuse("[1,2]", numbers, 12, "not a JSON object");
  refuse("{" METADATA "," WEIGHT "," WEIGHT "}", numbers, 12, "duplicate");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[4,8]}}",
         numbers, 8, "overlap");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[12,16]}}",
         numbers, 16, "4 bytes between layer.0.weight and tensor layer.0.bias");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[12,8]}}",
         numbers, 12, "begin");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[8,16]}}",
         numbers, 16, "8 bytes where its shape and dtype need 4");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[-1],\"data_offsets\":[8,12]}}",
         numbers, 12, "\"shape\"");
  refuse("{" METADATA ",\"w\":{\"dtype\":\"F64\",\"shape\":[2147483647,2147483647],\"data_offsets\":[0,8]}}",
         numbers, 8, "truncated: tensor w of 2147483647");
  float broken[3] = {1, 2, NAN};
  refuse("{" METADATA "," WEIGHT "," BIAS "}", broken, 12, "layer.0.bias: element 0 is not a finite number");
}
END_TEST

START_TEST(a_foreign_file_is_refused_by_what_is_wrong) {
  refuse("{" WEIGHT "," BIAS "}", numbers, 12, "no __metadata__");
  refuse("{\"__metadata__\":{\"format\":\"pt\"}," WEIGHT "," BIAS "}", numbers, 12, "format \"pt\"");
  refuse("{\"__metadata__\":{}," WEIGHT "," BIAS "}", numbers, 12, "metadata \"format\" is missing");
  refuse("{" METADATA "," WEIGHT "}", numbers, 8, "tensor layer.0.bias is missing");
  refuse("{" METADATA "," WEIGHT "," BIAS
         ",\"extra\":{\"dtype\":\"F32\",\"shape\":[],\"data_offsets\":[12,16]}}",
         numbers, 16, "tensor extra is not part of this shape");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[8,16]}}",
         numbers, 16, "tensor layer.0.bias has 1 dimensions, 2");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"F32\",\"shape\":[1,1,1],\"data_offsets\":[8,12]}}",
         numbers, 12, "at most two");
  refuse("{" METADATA "," WEIGHT
         ",\"layer.0.bias\":{\"dtype\":\"BF16\",\"shape\":[1],\"data_offsets\":[8,10]}}",
         numbers, 10, "dtype BF16; expected F32 or F64");
}
END_TEST

START_TEST(what_is_no_safetensors_file_is_refused) {
  static const char *const texts[] = {"", "short", "a text file that is longer than eight bytes",
                                      "PK\3\4 as torch.save writes it", "\x80\2 as it once did"};
  static const char *const words[] = {"0 bytes", "5 bytes", "is not a safetensors file",
                                      "is a file of PyTorch", "tetlap.write_weights"};
  for (int k = 0; k < 5; k++) {
    NetModel_f64 model;
    NetCard card;
    FILE *stream = fopen(temporary(), "wb");
    fputs(texts[k], stream);
    fclose(stream);
    ck_net_fails(net_weights_read_f64(temporary(), &model, &card), NET_BAD_FILE, words[k]);
  }
  uint64_t length = 4096;
  FILE *stream = fopen(temporary(), "wb");
  fwrite(&length, sizeof length, 1, stream);
  fputs("{}", stream);
  fclose(stream);
  NetModel_f64 model;
  NetCard card;
  ck_net_fails(net_weights_read_f64(temporary(), &model, &card), NET_BAD_FILE,
               "header should have 4096 bytes");
  unlink(temporary());
}
END_TEST

// A file cut off anywhere, or with any byte of its header changed, is refused or read as a network of the
// same shape: never more. (A digit of the provenance may change unseen.)
START_TEST(no_cut_and_no_changed_byte_of_the_header_does_harm) {
  NetShape shape = net_shape_mlp(2, 3, 1, 1);
  NetModel_f64 model = net_suite_model(&shape, 3), read;
  NetCard card = make_card(), back;
  ck_net_ok(net_weights_write_f64(temporary(), &model, &card));
  static char bytes[4096];
  FILE *stream = fopen(temporary(), "rb");
  size_t size = fread(bytes, 1, sizeof bytes, stream);
  fclose(stream);
  ck_assert_uint_lt(size, sizeof bytes);
  uint64_t header;
  memcpy(&header, bytes, sizeof header);
  int refused = 0;
  for (size_t k = 0; k < size + 8 + header; k++) {
    static char changed[4096];
    memcpy(changed, bytes, size);
    size_t length = k < size ? k : size;
    if (k >= size) changed[k - size] = (char)(changed[k - size] ^ 0x11);
    stream = fopen(temporary(), "wb");
    fwrite(changed, 1, length, stream);
    fclose(stream);
    NetStatus status = net_weights_read_f64(temporary(), &read, &back);
    if (k < size) ck_assert_int_eq(status, NET_BAD_FILE);
    refused += status != NET_OK;
    net_weights_card_destroy(&back);
    net_model_destroy_f64(&read);
  }
  ck_assert_int_gt(refused, (int)size);
  net_model_destroy_f64(&model);
  unlink(temporary());
}
END_TEST

// Found by review for tools/fuzz weights: the shape is a line of text, and gigabytes were taken for it before
// a tensor was looked for.
START_TEST(a_shape_that_the_file_does_not_hold_takes_no_memory) {
  static const char header[] =
      "{\"__metadata__\":{\"format\":\"tetlap-net "
      "1\",\"normalisation\":\"\",\"range\":\"\",\"provenance\":\"\","
      "\"shape\":\"{\\\"kind\\\":\\\"mlp\\\",\\\"activation\\\":\\\"silu\\\",\\\"inputs\\\":8192,"
      "\\\"hidden\\\":[8192,8192,8192,8192,8192,8192,8192,8192],\\\"outputs\\\":1}\"}}";
  uint64_t length = sizeof header - 1;
  FILE *stream = fopen(temporary(), "wb");
  fwrite(&length, sizeof length, 1, stream);
  fwrite(header, 1, sizeof header - 1, stream);
  fclose(stream);
  NetModel_f64 model;
  NetCard card;
  struct rusage before, after;
  getrusage(RUSAGE_SELF, &before);
  ck_net_fails(net_weights_read_f64(temporary(), &model, &card), NET_BAD_FILE, ": tensor ");
  getrusage(RUSAGE_SELF, &after);
  ck_assert_int_lt(after.ru_maxrss - before.ru_maxrss, 64 << 10); // [kB]
  unlink(temporary());
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_weights");
  tcase_add_test(test_case, every_shape_survives_its_file_to_the_bit);
  tcase_add_test(test_case, either_precision_reads_the_other);
  tcase_add_test(test_case, a_model_that_is_not_finite_is_not_written);
  tcase_add_test(test_case, a_place_that_cannot_be_written_or_read_is_named);
  tcase_add_test(test_case, a_file_made_by_hand_is_read);
  tcase_add_test(test_case, a_corrupt_file_is_refused_by_what_is_wrong);
  tcase_add_test(test_case, a_foreign_file_is_refused_by_what_is_wrong);
  tcase_add_test(test_case, what_is_no_safetensors_file_is_refused);
  tcase_add_test(test_case, no_cut_and_no_changed_byte_of_the_header_does_harm);
  tcase_add_test(test_case, a_shape_that_the_file_does_not_hold_takes_no_memory);
  return suite_run("net_weights", test_case, 60);
}
