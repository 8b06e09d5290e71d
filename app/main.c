// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"

int main(int argument_count, char **arguments) {
  return app_program_main(&app_program_root, argument_count, arguments);
}
