// SPDX-License-Identifier: GPL-3.0-or-later
// Readers of an option's text, for app/cli/parse.h and for options of a form of their own. If the text is
// wrong, each ends the program (exit code 64) with a message that says what would be right; `option` is the
// long name.
#ifndef TETLAP_APP_CLI_ARGUMENT_H
#define TETLAP_APP_CLI_ARGUMENT_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

// A whole number from `least` to `most`; LLONG_MAX: without an upper end.
long long app_argument_integer(struct argp_state *state, const char *option, const char *text,
                               long long least, long long most);
double app_argument_number(struct argp_state *state, const char *option, const char *text, double smallest,
                           double largest);
// Above 0 and finite.
double app_argument_positive(struct argp_state *state, const char *option, const char *text);
// Of --seed, of random numbers: any of 64 bits.
uint64_t app_argument_seed(struct argp_state *state, const char *text);

// Of a list such as "clip, geo": cut in place at its commas, blanks around a word left out. Fills `words`
// (most), which point into `text`, and returns how many there are, at least 1. `example` is a list that would
// be right.
int app_argument_list(struct argp_state *state, const char *option, char *text, const char *example, int most,
                      const char **words);
// The same list as one text, with nothing but a comma between its words; it stays where it is.
const char *app_argument_words(struct argp_state *state, const char *option, char *text, const char *example);

// Marks each name of a list in `wanted` (count), the others not.
void app_argument_choose(struct argp_state *state, const char *option, char *text, const char *const *names,
                         int count, bool *wanted);

// Puts a text that may be given several times behind those given before: `list` (most), `*count`. `what` is
// how several of them are called, as in "--set" or "scenes".
void app_argument_add(struct argp_state *state, const char *what, const char *text, int most,
                      const char **list, int *count);

#endif
