// SPDX-License-Identifier: GPL-3.0-or-later
// The words that name models (overlap/source.h).
#include "overlap/source.h"

#include <string.h>

#include "suite.h"

START_TEST(a_word_says_what_it_is) {
  static const struct {
    const char *word;
    OverlapSource source;
    const char *path;
  } cases[] = {{"clip", OVERLAP_SOURCE_NAME, ""},
               {"hybrid=a/b.safetensors", OVERLAP_SOURCE_WEIGHTS, "a/b.safetensors"},
               {"hybrid=geo", OVERLAP_SOURCE_NAME, ""},
               {"fade:.05=both=a/b.so", OVERLAP_SOURCE_LIBRARY, "a/b.so"},
               {"both=exec:x=y z", OVERLAP_SOURCE_COMMAND, ""},
               {"exec:env a=b.so", OVERLAP_SOURCE_COMMAND, ""},
               {"./both=b.so", OVERLAP_SOURCE_LIBRARY, "./both=b.so"},
               {"a.safetensors", OVERLAP_SOURCE_WEIGHTS, "a.safetensors"},
               {"./a.so", OVERLAP_SOURCE_LIBRARY, "./a.so"},
               {".so", OVERLAP_SOURCE_WEIGHTS, ".so"},
               {"./net.pt", OVERLAP_SOURCE_WEIGHTS, "./net.pt"},
               {"a/b.py", OVERLAP_SOURCE_PYTHON, "a/b.py"},
               {"a/b.py:f", OVERLAP_SOURCE_PYTHON, "a/b.py"},
               {"a:b/c.py", OVERLAP_SOURCE_PYTHON, "a:b/c.py"},
               {"exec:./x.py", OVERLAP_SOURCE_COMMAND, ""},
               {"channel:3:4:f", OVERLAP_SOURCE_CHANNEL, ""}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const char *path;
    char text[64];
    size_t length = overlap_source_path(cases[i].word, &path);
    ck_assert_int_eq(overlap_source_of(cases[i].word), cases[i].source);
    ck_assert_uint_eq(length, strlen(cases[i].path));
    ck_assert_int_eq(strncmp(path, cases[i].path, length), 0);
    ck_assert(overlap_source_from(cases[i].word, "/f", text, sizeof text));
    ck_assert(length > 0 ? strstr(text, "/f/") != NULL : strcmp(text, cases[i].word) == 0);
  }
  char text[64];
  ck_assert(overlap_source_from("hybrid=a.safetensors", "/f", text, sizeof text));
  ck_assert_str_eq(text, "hybrid=/f/a.safetensors");
  ck_assert(overlap_source_from("/a.py:f", "/f", text, sizeof text));
  ck_assert_str_eq(text, "/a.py:f");
  ck_assert(overlap_source_from("both=a.py:f", "e=1", text, sizeof text));
  ck_assert_str_eq(text, "both=./e=1/a.py:f");
  ck_assert(!overlap_source_from("a.py:f", "/a/folder", text, 8));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("source");
  tcase_add_test(cases, a_word_says_what_it_is);
  return suite_run("source", cases, 60);
}
