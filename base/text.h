// SPDX-License-Identifier: Apache-2.0
// Texts: mistyped names (the distance of two words, and which known word was meant), lists of words, places
// in a text, UTF-8.
#ifndef TETLAP_BASE_TEXT_H
#define TETLAP_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

enum { TEXT_MAX_WORD = 64 };

// How many letters must be inserted, removed, replaced or swapped with their neighbour to turn a into b
// (optimal string alignment; Damerau 1964), the case of letters ignored. TEXT_MAX_WORD if one of them is
// longer than that.
int text_distance(const char *a, const char *b);

// The best guess so far while candidates are offered one by one; starts as text_guess_of(word).
typedef struct TextGuess {
  const char *word; // borrowed
  const char *best; // the nearest candidate, borrowed; if none is near, one that begins with `word`, of three
                    // letters or more; NULL: nor does any
  int distance;     // of the nearest; without one: the largest distance that counts as near, plus 1
} TextGuess;

TextGuess text_guess_of(const char *word);
void text_guess_offer(TextGuess *guess, const char *candidate);

// Whether a text has this ending and something before it.
bool text_ends_in(const char *text, const char *ending);

// Whether `word` is one of the words of `list`, separated by single spaces or
// commas. NULL: an empty list.
bool text_lists(const char *list, const char *word);

// The next word of such a list, copied to `word`; returns what follows it, NULL at the end:
// `for (const char *rest = text_next(list, word); rest; rest = text_next(rest, word))`.
const char *text_next(const char *list, char word[TEXT_MAX_WORD]);

// Cuts a list at its commas, in place, and leaves out the blanks around its words: `words` (most) points into
// `list`. `\,` is a comma within a word. Returns how many there are; 0: one of them is empty, or the list is;
// −1: there are more than `most`.
int text_split(char *list, const char **words, int most);

// Writes like snprintf after the first `*used` characters and moves `*used`; what does not fit is cut.
void text_append(char *buffer, size_t size, size_t *used, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

// Adds a word to a list as text_split takes it.
void text_append_word(char *buffer, size_t size, size_t *used, const char *word);

// The line and the column (both from 1, columns in characters of UTF-8) of a byte of a text.
void text_place(const char *text, size_t offset, int *line, int *column);

// The offset of the first byte that is not UTF-8 (RFC 3629), `size` if all are.
size_t text_utf8_valid(const char *text, size_t size);

// The length of a UTF-8 byte order mark that a text begins with, else 0. Editors write it; it has no meaning.
size_t text_mark_length(const char *text, size_t size);

#endif
