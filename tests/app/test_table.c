// SPDX-License-Identifier: GPL-3.0-or-later
// app/table: what the cells of a table say.
#include "suite.h"

#include "app/table/table.h"

typedef struct Row {
  const char *name;
  long long integer;
  double count, number;
} Row;

static const AppTableColumn columns[] = {
    {"name", APP_TABLE_TEXT, offsetof(Row, name), "name", NULL},
    {"integer", APP_TABLE_INTEGER, offsetof(Row, integer), "integer", NULL},
    {"count", APP_TABLE_COUNT, offsetof(Row, count), "count", NULL},
    {"number", APP_TABLE_NUMBER, offsetof(Row, number), "number", NULL},
};
static const Row rows[] = {{"a, \"b\"", 12345678901, 12345678901, 1234567.125}, {NULL, -1, NAN, NAN}};

static void expect(AppTableFormat format, const char *expected) {
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ptr_nonnull(stream);
  const AppTablePart part = {columns, 4, rows, sizeof *rows};
  ck_assert_ok(app_table_print(&(AppTable){&part, 1, 2}, format, stream));
  fclose(stream);
  ck_assert_str_eq(text, expected);
  free(text);
}

// Of numbers few digits are shown, of counts all; what is not measured is empty.
START_TEST(counts_are_whole_and_numbers_short_on_a_terminal) {
  expect(APP_TABLE_PLAIN, "name        integer        count     number  \n"
                          "a, \"b\"  12345678901  12345678901  1.235e+06  \n"
                          "                 -1                          \n");
}
END_TEST

START_TEST(csv_quotes_what_rfc_4180_asks_for_and_keeps_counts) {
  expect(APP_TABLE_CSV, "name,integer,count,number\n"
                        "\"a, \"\"b\"\"\",12345678901,12345678901,1234567.12\n"
                        ",-1,,\n");
}
END_TEST

START_TEST(markdown_has_a_rule_with_the_alignment) {
  expect(APP_TABLE_MARKDOWN, "| name   |     integer |       count |    number |\n"
                             "|---|--:|--:|--:|\n"
                             "| a, \"b\" | 12345678901 | 12345678901 | 1.235e+06 |\n"
                             "|        |          -1 |             |           |\n");
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("table");
  tcase_add_test(cases, counts_are_whole_and_numbers_short_on_a_terminal);
  tcase_add_test(cases, csv_quotes_what_rfc_4180_asks_for_and_keeps_counts);
  tcase_add_test(cases, markdown_has_a_rule_with_the_alignment);
  return suite_run("table", cases, 10);
}
