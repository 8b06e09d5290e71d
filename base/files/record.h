// SPDX-License-Identifier: GPL-3.0-or-later
// A JSON document that is built up and written, or read: the one place where jansson is used outside net/.
// Numbers that are not finite become null. After a failed allocation the handles are NULL, which every call
// accepts.
#ifndef TETLAP_BASE_FILES_RECORD_H
#define TETLAP_BASE_FILES_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/status.h"

typedef struct Record Record; // an object {…}; the root is owned by its creator, the rest by the root
typedef struct RecordList RecordList; // an array […]; owned by the root

Record *record_new(void); // NULL: no memory
void record_destroy(Record *root);

void record_number(Record *record, const char *key, double value);
void record_integer(Record *record, const char *key, long long value);
// A whole number that is computed as a double: bytes, counts that may be unknown (NaN).
void record_whole(Record *record, const char *key, double value);
// Adds to the whole number that stands there; without one it is the first.
void record_add(Record *record, const char *key, long long value);
// What stands elsewhere, a whole number as such; NULL: null.
void record_value(Record *record, const char *key, const Record *value);
void record_text(Record *record, const char *key, const char *value);
void record_bool(Record *record, const char *key, bool value);
void record_numbers(Record *record, const char *key, const double *values, int count);
void record_merge(Record *record,
                  const Record *other); // copies what `other` has into `record`; NULL: nothing
Record *record_child(Record *record, const char *key);
RecordList *record_list(Record *record, const char *key);
Record *record_append(RecordList *list);
RecordList *record_list_new(void); // a list as the root; NULL: no memory
void record_list_destroy(RecordList *root);
void record_append_number(RecordList *list, double value);
void record_append_integer(RecordList *list, long long value);
void record_append_text(RecordList *list, const char *value);

// Indented, keys in the order of insertion, a newline at the end.
Status record_print(const Record *root, FILE *stream);
// The same on one line, for files with one object a line.
Status record_print_line(const Record *root, FILE *stream);
Status record_write(const Record *root, const char *path); // whole or not at all
Status record_list_print(const RecordList *root, FILE *stream);
Status record_list_write(const RecordList *root, const char *path);

// Reads a file that holds one object or one list. STATUS_INPUT names file, line and column; STATUS_IO. After
// a failure `*root` is NULL.
Status record_read(Record **root, const char *path);
// Reads DIRECTORY/NAME if it is there; where it is not, `*root` is NULL.
Status record_read_in(Record **root, const char *directory, const char *name);
// Reads the same from a text in memory; `name` stands for it in messages.
Status record_parse(Record **root, const char *text, size_t size, const char *name);
// The text that record_print writes, owned by the caller (memory_free); NULL: no memory.
char *record_text_of(const Record *root);
// Puts `child`, which `record` owns from now on, under `key`; NULL: nothing.
void record_adopt(Record *record, const char *key, Record *child);

// What a record holds under `key`; of a list, what it holds at a place. Borrowed; NULL where there is none.
const Record *record_find(const Record *record, const char *key);
const Record *record_at(const Record *list, int index);
int record_count(const Record *list);                                // elements of a list; 0: not a list
const char *record_text_value(const Record *text);                   // NULL: it is no text
double record_number_value(const Record *number);                    // NaN: it is no number
const char *record_find_text(const Record *record, const char *key); // NULL: no text there
double record_find_number(const Record *record, const char *key);    // NaN: no number there
// The first place where two records differ, as "scene.contact.stiffness", and its values there, cut to what
// fits, "nothing" where one has none; false: they are equal. Numbers are compared as they are written.
enum { RECORD_PLACE = 256, RECORD_VALUE = 128 };
typedef struct RecordDifference {
  char place[RECORD_PLACE], a[RECORD_VALUE], b[RECORD_VALUE];
} RecordDifference;
bool record_differ(const Record *a, const Record *b, RecordDifference *difference);

#endif
