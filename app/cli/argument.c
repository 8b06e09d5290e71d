// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/argument.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

enum { MOST_WORDS = 64 };

long long app_argument_integer(struct argp_state *state, const char *option, const char *text,
                               long long least, long long most) {
  char *end;
  errno = 0;
  long long value = strtoll(text, &end, 10);
  if (end != text && !*end && !errno && value >= least && value <= most) return value;
  if (most == LLONG_MAX)
    argp_error(state, "--%s is '%s'; give a whole number from %lld up", option, text, least);
  else
    argp_error(state, "--%s is '%s'; give a whole number from %lld to %lld", option, text, least, most);
  return least;
}

double app_argument_number(struct argp_state *state, const char *option, const char *text, double smallest,
                           double largest) {
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end || !(value >= smallest && value <= largest))
    argp_error(state, "--%s is '%s'; give a number from %g to %g", option, text, smallest, largest);
  return value;
}

double app_argument_positive(struct argp_state *state, const char *option, const char *text) {
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end || !(value > 0) || isinf(value))
    argp_error(state, "--%s is '%s'; give a number above 0", option, text);
  return value;
}

uint64_t app_argument_seed(struct argp_state *state, const char *text) {
  char *end;
  errno = 0;
  uint64_t seed = strtoull(text, &end, 10);
  if (end == text || *end || errno || text[0] == '-')
    argp_error(state, "--seed is '%s'; give a whole number from 0 up", text);
  return seed;
}

int app_argument_list(struct argp_state *state, const char *option, char *text, const char *example, int most,
                      const char **words) {
  char *given = strdup(text);
  int count = text_split(text, words, most);
  if (count < 0)
    argp_error(state, "--%s names more than the %d that are possible", option, most);
  else if (count == 0)
    argp_error(state, "--%s is '%s', in which a name is empty; give names with a comma between, as in %s",
               option, given ? given : "", example);
  free(given);
  return count;
}

const char *app_argument_words(struct argp_state *state, const char *option, char *text,
                               const char *example) {
  const char *words[MOST_WORDS];
  const size_t size = strlen(text) + 1; // the list becomes no longer
  char *list = strdup(text);
  if (!list) argp_error(state, "--%s: there is no memory for the list", option);
  size_t used = 0;
  int count = app_argument_list(state, option, text, example, MOST_WORDS, words);
  for (int w = 0; w < count; w++) text_append_word(list, size, &used, words[w]);
  memcpy(text, list, size);
  free(list);
  return text;
}

static int find(const char *word, const char *const *names, int count) {
  int found = 0;
  while (found < count && strcmp(names[found], word) != 0) found++;
  return found;
}

void app_argument_choose(struct argp_state *state, const char *option, char *text, const char *const *names,
                         int count, bool *wanted) {
  char known[256] = "";
  size_t used = 0;
  for (int i = 0; i < count; i++) {
    text_append(known, sizeof known, &used, "%s%s", i ? ", " : "", names[i]);
    wanted[i] = false;
  }
  const char *words[MOST_WORDS];
  int word_count = app_argument_list(state, option, text, names[0], MOST_WORDS, words);
  for (int w = 0; w < word_count; w++) {
    int found = find(words[w], names, count);
    if (found == count)
      argp_error(state, "--%s has '%s'; give some of: %s", option, words[w], known);
    else
      wanted[found] = true;
  }
}

void app_argument_add(struct argp_state *state, const char *what, const char *text, int most,
                      const char **list, int *count) {
  if (*count == most) argp_error(state, "at most %d %s", most, what);
  list[(*count)++] = text;
}
