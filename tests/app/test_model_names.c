// SPDX-License-Identifier: GPL-3.0-or-later
// Names of overlap models: short, and never the same for two.
#include "suite.h"

#include <string.h>
#include <unistd.h>

#include "app/cli/model_names.h"

enum { MOST = 4 };

static void check(int count, const char *const *sources, const char *const *expected) {
  AppModelName names[MOST];
  ck_assert_ok(app_model_names_find(count, sources, names));
  for (int i = 0; i < count; i++) ck_assert_str_eq(names[i], expected[i]);
}

static void check_refused(const char *a, const char *b, const char *words) {
  AppModelName names[2];
  const char *sources[2] = {a, b};
  ck_assert_int_eq(app_model_names_find(2, sources, names), STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), words));
}

START_TEST(a_file_is_called_by_the_shortest_end_of_its_path_that_no_other_has) {
  check(3, (const char *[]){"clip", "a/net.safetensors", "other.safetensors"},
        (const char *[]){"clip", "net", "other"});
  check(3, (const char *[]){"a/net.safetensors", "/b/net.safetensors", "/b/other.safetensors"},
        (const char *[]){"a/net", "b/net", "other"});
  check(2, (const char *[]){"/a/x/net.safetensors", "/b/x/net.safetensors"},
        (const char *[]){"a/x/net", "b/x/net"});
  check(3, (const char *[]){"/a/x/net.safetensors", "/b/x/net.safetensors", "/b/y/net.safetensors"},
        (const char *[]){"a/x/net", "b/x/net", "y/net"});
  check(2, (const char *[]){"/net.safetensors", "/b/net.safetensors"}, (const char *[]){"net", "b/net"});
}
END_TEST

START_TEST(a_file_is_never_called_like_a_model_of_the_program) {
  check(2, (const char *[]){"clip", "/a/clip.safetensors"}, (const char *[]){"clip", "a/clip"});
  AppModelName name;
  app_model_names_find_one("/a/geo.safetensors", name);
  ck_assert_str_eq(name, "a/geo");
  app_model_names_find_one("/a/mine.safetensors", name);
  ck_assert_str_eq(name, "mine");
  app_model_names_find_one("exact", name);
  ck_assert_str_eq(name, "exact");
}
END_TEST

START_TEST(a_hybrid_is_called_by_its_network) {
  check(3, (const char *[]){"hybrid", "hybrid=/a/mine.safetensors", "hybrid=geo-small"},
        (const char *[]){"hybrid", "hybrid=mine", "hybrid=geo-small"});
  check(2, (const char *[]){"/a/mine.safetensors", "hybrid=/a/mine.safetensors"},
        (const char *[]){"mine", "hybrid=mine"});
}
END_TEST

START_TEST(wrappers_stay_before_the_name) {
  check(4, (const char *[]){"/a/m.so", "both=/a/m.so", "fade:.1=both=clip", "both=exec:/x/serve --fast"},
        (const char *[]){"m", "both=m", "fade:.1=both=clip", "both=serve"});
}
END_TEST

START_TEST(a_model_is_not_named_twice) {
  check_refused("clip", "clip", "'clip' is named twice");
  check_refused("a/net.safetensors", "./b/../a//net.safetensors", "a/net.safetensors");
}
END_TEST

START_TEST(the_path_of_a_file_is_absolute) {
  char path[PATH_MAX], expected[PATH_MAX + 32], here[PATH_MAX];
  ck_assert_ptr_nonnull(getcwd(here, sizeof here));
  snprintf(expected, sizeof expected, "%s/a/net.safetensors", here);
  ck_assert(app_model_names_locate("./b/.././a/net.safetensors", path));
  ck_assert_str_eq(path, expected);
  ck_assert(app_model_names_locate("hybrid=a/net.safetensors", path));
  ck_assert_str_eq(path, expected);
  ck_assert(!app_model_names_locate("geo", path));
  ck_assert(!app_model_names_locate("hybrid=geo-small", path));
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("model names");
  tcase_add_test(test_case, a_file_is_called_by_the_shortest_end_of_its_path_that_no_other_has);
  tcase_add_test(test_case, a_file_is_never_called_like_a_model_of_the_program);
  tcase_add_test(test_case, a_hybrid_is_called_by_its_network);
  tcase_add_test(test_case, wrappers_stay_before_the_name);
  tcase_add_test(test_case, a_model_is_not_named_twice);
  tcase_add_test(test_case, the_path_of_a_file_is_absolute);
  return suite_run("model_names", test_case, 10);
}
