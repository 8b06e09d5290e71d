// SPDX-License-Identifier: GPL-3.0-or-later
// base/text.h: words that are nearly right, and bytes that are no text.
#include "suite.h"

#include <string.h>

#include "base/text.h"

START_TEST(distances_count_slips_of_the_finger) {
  ck_assert_int_eq(text_distance("young", "young"), 0);
  ck_assert_int_eq(text_distance("yong", "young"), 1);
  ck_assert_int_eq(text_distance("tiem", "time"), 1); // neighbours swapped
  ck_assert_int_eq(text_distance("kitten", "sitting"), 3);
  ck_assert_int_eq(text_distance("End", "end"), 0);
  ck_assert_int_eq(text_distance("", "abc"), 3);
  char longer[TEXT_MAX_WORD + 2];
  memset(longer, 'a', sizeof longer);
  longer[sizeof longer - 1] = 0;
  ck_assert_int_eq(text_distance(longer, "a"), TEXT_MAX_WORD);
}
END_TEST

START_TEST(a_guess_is_near_or_none) {
  TextGuess guess = text_guess_of("densty");
  text_guess_offer(&guess, "young"), text_guess_offer(&guess, "density");
  ck_assert_str_eq(guess.best, "density");
  guess = text_guess_of("colour");
  text_guess_offer(&guess, "young"), text_guess_offer(&guess, "density");
  ck_assert_ptr_null(guess.best);
}
END_TEST

static const char *guess_among(const char *word, const char *first, const char *second) {
  TextGuess guess = text_guess_of(word);
  text_guess_offer(&guess, first), text_guess_offer(&guess, second);
  return guess.best ? guess.best : "";
}

START_TEST(the_beginning_of_a_name_is_a_guess_if_no_name_is_near) {
  ck_assert_str_eq(guess_among("fix", "driven", "fixed"), "fixed");
  ck_assert_str_eq(guess_among("Max", "max_step", "max_frames"), "max_step");
  ck_assert_str_eq(guess_among("mix", "mixture", "min"), "min");
  ck_assert_str_eq(guess_among("fi", "driven", "fixed"), "");
  ck_assert_str_eq(guess_among("fixedly", "driven", "fix"), "");
}
END_TEST

START_TEST(utf8_is_told_from_what_is_not) {
  static const char *const good[] = {"a", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xef\xbf\xbf"};
  static const char *const bad[] = {
      "\x80",    "\xc0\xaf", "\xc3", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80",
      "\xe2\x82"};
  for (int i = 0; i < 5; i++) ck_assert_uint_eq(text_utf8_valid(good[i], strlen(good[i])), strlen(good[i]));
  for (int i = 0; i < 8; i++) ck_assert_uint_eq(text_utf8_valid(bad[i], strlen(bad[i])), 0);
}
END_TEST

static int split(const char *list, const char **words) {
  static char text[64];
  strcpy(text, list);
  return text_split(text, words, 3);
}

START_TEST(a_list_is_cut_at_commas_and_blanks_around_words_are_left_out) {
  const char *words[3];
  ck_assert_int_eq(split("clip", words), 1);
  ck_assert_str_eq(words[0], "clip");
  ck_assert_int_eq(split(" clip ,\tmy weights.safetensors, geo", words), 3);
  ck_assert_str_eq(words[0], "clip");
  ck_assert_str_eq(words[1], "my weights.safetensors");
  ck_assert_str_eq(words[2], "geo");
}
END_TEST

START_TEST(a_word_of_a_list_may_have_commas_of_its_own) {
  const char *words[3];
  char list[64];
  size_t used = 0;
  ck_assert_int_eq(split("exec:mine a\\,b\\n , clip", words), 2);
  ck_assert_str_eq(words[0], "exec:mine a,b\\n");
  ck_assert_str_eq(words[1], "clip");
  for (int w = 0; w < 2; w++) text_append_word(list, sizeof list, &used, words[w]);
  ck_assert_str_eq(list, "exec:mine a\\,b\\n,clip");
}
END_TEST

START_TEST(a_list_with_an_empty_word_or_too_many_is_none) {
  const char *words[3];
  static const char *const empty[] = {"", " ", ",", "clip,", ",clip", "clip, ,geo"};
  for (int i = 0; i < 6; i++) ck_assert_int_eq(split(empty[i], words), 0);
  ck_assert_int_eq(split("a,b,c,d", words), -1);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("text");
  tcase_add_test(cases, distances_count_slips_of_the_finger);
  tcase_add_test(cases, a_guess_is_near_or_none);
  tcase_add_test(cases, the_beginning_of_a_name_is_a_guess_if_no_name_is_near);
  tcase_add_test(cases, utf8_is_told_from_what_is_not);
  tcase_add_test(cases, a_list_is_cut_at_commas_and_blanks_around_words_are_left_out);
  tcase_add_test(cases, a_word_of_a_list_may_have_commas_of_its_own);
  tcase_add_test(cases, a_list_with_an_empty_word_or_too_many_is_none);
  return suite_run("text", cases, 60);
}
