// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static int least(int a, int b) {
  return a < b ? a : b;
}

static int lower(char letter) {
  return tolower((unsigned char)letter);
}

// Row i holds the distances between the first i letters of a and the first j of b; three rows suffice.
int text_distance(const char *a, const char *b) {
  size_t a_length = strlen(a), b_length = strlen(b);
  if (a_length > TEXT_MAX_WORD || b_length > TEXT_MAX_WORD) return TEXT_MAX_WORD;
  int rows[3][TEXT_MAX_WORD + 1];
  int *before = rows[0], *above = rows[1], *row = rows[2];
  for (size_t j = 0; j <= b_length; j++) row[j] = (int)j;
  for (size_t i = 1; i <= a_length; i++) {
    int *oldest = before;
    before = above, above = row, row = oldest;
    row[0] = (int)i;
    for (size_t j = 1; j <= b_length; j++) {
      int replaced = above[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
      row[j] = least(replaced, 1 + least(above[j], row[j - 1]));
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = least(row[j], before[j - 2] + 1);
    }
  }
  return row[b_length];
}

// A word of n letters may be mistyped in about a third of them: more would be a guess at random.
TextGuess text_guess_of(const char *word) {
  size_t length = strlen(word);
  int allowed = length > TEXT_MAX_WORD ? 0 : (int)(length + 2) / 3;
  return (TextGuess){.word = word, .distance = least(allowed, 3) + 1};
}

void text_guess_offer(TextGuess *guess, const char *candidate) {
  size_t length = strlen(guess->word);
  int distance = text_distance(guess->word, candidate);
  bool is_near = distance < guess->distance;
  bool is_begun = length >= 3 && strncasecmp(guess->word, candidate, length) == 0;
  if (is_near || (is_begun && !guess->best)) guess->best = candidate;
  if (is_near) guess->distance = distance;
}

bool text_ends_in(const char *text, const char *ending) {
  size_t length = strlen(text), size = strlen(ending);
  return length > size && strcmp(text + length - size, ending) == 0;
}

const char *text_next(const char *list, char word[TEXT_MAX_WORD]) {
  if (!list || !list[0]) return NULL;
  size_t length = strcspn(list, " ,");
  snprintf(word, TEXT_MAX_WORD, "%.*s", (int)length, list);
  return list + length + (list[length] != 0);
}

bool text_lists(const char *list, const char *word) {
  char listed[TEXT_MAX_WORD];
  for (const char *rest = text_next(list, listed); rest; rest = text_next(rest, listed))
    if (strcmp(listed, word) == 0) return true;
  return false;
}

// The word that begins at `text`, without the blanks around it and the backslashes before commas of its own;
// `*text` moves behind it and its comma, or becomes NULL.
static char *cut_word(char **text) {
  char *word = *text + strspn(*text, " \t"), *end = word, *from = word;
  for (; *from && *from != ','; from++) {
    if (from[0] == '\\' && from[1] == ',') from++;
    *end++ = *from;
  }
  *text = *from ? from + 1 : NULL;
  while (end > word && (end[-1] == ' ' || end[-1] == '\t')) end--;
  *end = 0;
  return word;
}

int text_split(char *list, const char **words, int most) {
  int count = 0;
  for (char *rest = list; rest;) {
    const char *word = cut_word(&rest);
    if (!*word) return 0;
    if (count == most) return -1;
    words[count++] = word;
  }
  return count;
}

void text_append(char *buffer, size_t size, size_t *used, const char *format, ...) {
  if (*used >= size) return;
  va_list args;
  va_start(args, format);
  int written = vsnprintf(buffer + *used, size - *used, format, args);
  va_end(args);
  if (written > 0) *used += (size_t)written;
  if (*used >= size) *used = size - 1;
}

void text_append_word(char *buffer, size_t size, size_t *used, const char *word) {
  if (*used > 0) text_append(buffer, size, used, ",");
  for (; *word; word++) text_append(buffer, size, used, "%s%c", *word == ',' ? "\\" : "", *word);
}

void text_place(const char *text, size_t offset, int *line, int *column) {
  *line = *column = 1;
  for (size_t i = 0; i < offset && text[i]; i++) {
    if (text[i] == '\n')
      ++*line, *column = 1;
    else if (((unsigned char)text[i] & 0xc0) != 0x80) // a continuation byte is no character of its own
      ++*column;
  }
}

// The length of the well-formed character at `text`, 0 if there is none: RFC 3629, table of section 4.
static size_t character_length(const unsigned char *text, size_t size) {
  unsigned char first = text[0];
  if (first < 0x80) return 1;
  size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || size < length) return 0;
  unsigned char low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80; // neither overlong
  unsigned char high = first == 0xed   ? 0x9f
                       : first == 0xf4 ? 0x8f
                                       : 0xbf; // nor surrogate, nor beyond U+10FFFF
  if (text[1] < low || text[1] > high) return 0;
  for (size_t i = 2; i < length; i++)
    if ((text[i] & 0xc0) != 0x80) return 0;
  return length;
}

size_t text_utf8_valid(const char *text, size_t size) {
  size_t offset = 0;
  while (offset < size) {
    size_t length = character_length((const unsigned char *)text + offset, size - offset);
    if (length == 0) return offset;
    offset += length;
  }
  return size;
}

size_t text_mark_length(const char *text, size_t size) {
  static const char mark[] = {'\xef', '\xbb', '\xbf'};
  return size >= sizeof mark && memcmp(text, mark, sizeof mark) == 0 ? sizeof mark : 0;
}
