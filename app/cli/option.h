// SPDX-License-Identifier: GPL-3.0-or-later
// A command's options and arguments as tables: a line says how one is called, what is to be given and where
// it goes in the command's struct. What reads them is app/cli/parse.h.
#ifndef TETLAP_APP_CLI_OPTION_H
#define TETLAP_APP_CLI_OPTION_H

#include <argp.h>
#include <stddef.h>

enum { APP_CLI_MOST_THREADS = 1024 }; // of --threads

// What is given with an option, and in brackets the type of the member that it goes to.
typedef enum AppOptionType {
  CLI_FLAG,     // nothing (bool, which becomes true)
  CLI_VALUE,    // nothing (int or an enumeration, which becomes `least`)
  CLI_TEXT,     // (const char *)
  CLI_INTEGER,  // a whole number from `least` to `most` (int or long long)
  CLI_NUMBER,   // a number from `least` to `most` (double)
  CLI_POSITIVE, // a number above 0 (double)
  CLI_SEED,     // of random numbers, any of 64 bits (uint64_t)
  CLI_WORDS,    // a list with commas between its names, as `example` (const char *, without blanks)
  CLI_LIST,     // the same (const char *[most], and their number)
  CLI_REPEATED, // a text each time that it is given; `example` calls several of them (const char *[most], and
                // their number)
  CLI_CHOICES,  // a list of some of `choices` (bool[most])
  CLI_OWN,      // what `read` makes of it
} AppOptionType;

typedef struct AppOption {
  const char *name;     // behind "--"; NULL: this line stands for another table
  int letter;           // behind "-"; 0: none
  const char *argument; // what is given, as help shows it; NULL: nothing
  const char *help;
  int group; // help lists the options by these, and in alphabetical order within one
  AppOptionType type;
  size_t offset, size; // of the member
  double least, most;  // INFINITY: without an upper end
  const char *example;
  size_t count_offset; // of the number of a list's texts, an int
  size_t mark_offset;  // of a bool that becomes true; 0: none
  const char *const *choices;
  void (*read)(struct argp_state *state, void *member, char *text); // ends the program if the text is wrong
  const struct AppOption *table; // whose struct is the member; ended by a zeroed line, as all tables are
} AppOption;

// A member of a struct: offset and size.
#define CLI_TO(Type, member) .offset = offsetof(Type, member), .size = sizeof(((Type *)0)->member)

// What stands on the command line beside options.
typedef struct AppArguments {
  const char *name;    // as help shows it, "DIR [DIR]"
  size_t offset;       // of a const char *, or of an array of `most` of them
  int most;            // 0: no arguments are taken
  size_t count_offset; // of their number, an int; where `most` is above 1
  const char *missing; // what to say where there is none; NULL: there need not be any
  const char *excess;  // what to say of one too many: a format of it and `most`
} AppArguments;

#endif
