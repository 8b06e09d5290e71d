// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/tasks.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/files/data.h"
#include "base/text.h"

const AppVerdictScene app_verdict_scenes[APP_VERDICT_SCENES] = {
    {"press", "static", true},        {"indent", "static, stick and slip", true},
    {"drop", "falls", true},          {"collide", "collide", true},
    {"edge", "edges cross", true},    {"stick", "sticks", false},
    {"slide", "slides", false},       {"roll", "rolls", false},
    {"fold", "self-contact", false},  {"stack", "stack", false},
    {"made", "unseen bodies", false}, {"hang", "thin, bent", false},
};

// Where a scene's run with the model is cut short: by steps over those of `clip`, of which 1.5 are allowed,
// and where it does not step at all by the clock.
static const char MOST_STEPS[] = "10", WALL_S[] = "600";

static Status write_text(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
static Status write_text(char *text, const char *format, ...) {
  va_list values;
  va_start(values, format);
  int length = vsnprintf(text, PATH_MAX, format, values);
  va_end(values);
  return length < PATH_MAX ? STATUS_OK : status_fail(STATUS_INPUT, "%.200s…: the path is too long", text);
}

// A list of models; `first` may be NULL.
static Status write_list(char *list, const char *first, const char *source) {
  size_t used = 0;
  if (first) text_append_word(list, PATH_MAX, &used, first);
  text_append_word(list, PATH_MAX, &used, source);
  return used < PATH_MAX - 1 ? STATUS_OK : status_fail(STATUS_INPUT, "%.200s…: the name is too long", source);
}

typedef struct Words {
  const char **words;
  int count;
} Words;

static void add(Words *words, ...) {
  va_list list;
  va_start(list, words);
  for (const char *word; (word = va_arg(list, const char *));) words->words[words->count++] = word;
  va_end(list);
  words->words[words->count] = NULL;
}

static Status place(const AppVerdictPlan *plan, AppVerdictTask *task, const char *file) {
  TRY(write_text(task->output, "%s/%s/%s", plan->directory, plan->name, file));
  return write_text(task->log, "%s/%s/%s.log", plan->directory, plan->name, task->name);
}

static Status fill_eval(const AppVerdictPlan *plan, AppVerdictTask *task, Words *words, int index) {
  task->is_printed = true;
  add(words, "eval", plan->source, "--json", "--quiet", "--seed", task->texts[1], NULL);
  if (index == 1) {
    add(words, "--paths", plan->is_quick ? "50" : "300", NULL);
    return place(plan, task, "paths.json");
  }
  add(words, "--law", index == 2 ? "paper-test" : "scene", "--count", plan->is_quick ? "5000" : "50000",
      NULL);
  return place(plan, task, index == 2 ? "paper.json" : "pairs.json");
}

static Status fill_scene(const AppVerdictPlan *plan, AppVerdictTask *task, Words *words,
                         const AppVerdictScene *scene) {
  char relative[128], file[192];
  const char *reference = strcmp(plan->source, "clip") == 0 ? "clip-scalar" : "clip";
  task->name = scene->name;
  snprintf(relative, sizeof relative, "examples/verdict/%s.yaml", scene->name);
  TRY(data_find(relative, task->texts[2], PATH_MAX));
  TRY(write_list(task->texts[3], reference, plan->source));
  TRY(write_text(task->texts[4], "%s/%s/%s", plan->directory, plan->name, scene->name));
  snprintf(file, sizeof file, "%s/compare.json", scene->name);
  add(words, "compare", task->texts[2], "--overlap", task->texts[3], "--reference", reference, "--audit", "2",
      "--output", task->texts[4], "--most-steps", MOST_STEPS, "--wall", WALL_S, "--quiet", NULL);
  return place(plan, task, file);
}

Status app_verdict_task(const AppVerdictPlan *plan, int index, AppVerdictTask *task, bool *is_wanted) {
  static const char *const names[] = {"contract", "paths", "paper", "pairs", "unseen"};
  *task = (AppVerdictTask){.name = index < 5 ? names[index] : ""};
  *is_wanted = index < 5 || !plan->is_quick || app_verdict_scenes[index - 5].is_quick;
  if (!*is_wanted) return STATUS_OK;
  Words words = {.words = task->words};
  TRY(write_text(task->texts[0], "%d", plan->threads));
  TRY(write_text(task->texts[1], "%llu", (unsigned long long)plan->seed));
  add(&words, "tetlap", NULL);
  if (index >= 5) {
    TRY(fill_scene(plan, task, &words, &app_verdict_scenes[index - 5]));
  } else if (index == 0) {
    TRY(place(plan, task, "contract.json"));
    TRY(write_text(task->part, "%s.part", task->output));
    TRY(write_list(task->texts[3], NULL, plan->source));
    add(&words, "stress", "--pairs", "--overlap", task->texts[3], "--json", task->part, NULL);
    if (plan->is_quick) add(&words, "--quick", NULL);
    return STATUS_OK; // it has no --threads
  } else if (index == 4) {
    task->is_printed = true;
    TRY(place(plan, task, "unseen.json"));
    TRY(write_list(task->texts[3], NULL, plan->source));
    add(&words, "bench", "unseen", "--model", task->texts[3], "--json", NULL);
    if (plan->is_quick) add(&words, "--seeds", "1", "--case", "jittered,edge,made", NULL);
  } else {
    TRY(fill_eval(plan, task, &words, index));
  }
  add(&words, "--threads", task->texts[0], NULL);
  return STATUS_OK;
}
