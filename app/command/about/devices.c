// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdio.h>

#include "app/cli/parse.h"
#include "base/files/record.h"
#include "base/status.h"
#include "device/device.h"

static const AppOption option_table[] = {
    {"json", 'j', NULL, "Print JSON", 0, CLI_FLAG, .size = sizeof(bool)},
    {0},
};

static void print_device(const DeviceOps *ops, const DeviceInfo *info) {
  printf("  %s:%d  %s (%s)\n      %s, %d units", ops->name, info->index, info->name, info->driver,
         info->is_gpu ? "GPU" : "no GPU", info->units);
  if (info->clock_mhz > 0) printf(", %d MHz", info->clock_mhz);
  if (info->memory_bytes > 0) printf(", %.1f GB", 1e-9 * info->memory_bytes);
  printf("\n");
  if (info->reason[0]) printf("      not usable: %s\n", info->reason);
}

static void print_text(const DeviceOps *ops, const DeviceInfo *infos, int count, const char *reason) {
  printf("%s: %s\n  looked for: %s\n", ops->name, ops->help, ops->looked_for);
  for (int i = 0; i < count; i++) print_device(ops, &infos[i]);
  if (count == 0) printf("  none: %s\n", reason);
}

static void record_device(const DeviceInfo *info, Record *record) {
  record_integer(record, "index", info->index);
  record_text(record, "name", info->name);
  record_text(record, "driver", info->driver);
  record_bool(record, "is_gpu", info->is_gpu);
  record_integer(record, "units", info->units);
  record_integer(record, "clock_mhz", info->clock_mhz);
  record_whole(record, "memory_bytes", info->memory_bytes);
  record_bool(record, "is_usable", info->reason[0] == 0);
  if (info->reason[0]) record_text(record, "reason", info->reason);
}

static void record_kind(const DeviceOps *ops, const DeviceInfo *infos, int count, const char *reason,
                        Record *record) {
  record_text(record, "kind", ops->name);
  record_text(record, "looked_for", ops->looked_for);
  if (count == 0) record_text(record, "reason", reason);
  RecordList *list = record_list(record, "devices");
  for (int i = 0; i < count; i++) record_device(&infos[i], record_append(list));
}

static Status list_devices(bool is_json) {
  int kind_count;
  const DeviceOps *const *kinds = device_list(&kind_count);
  RecordList *root = is_json ? record_list_new() : NULL;
  if (is_json && !root) return status_no_memory("the list");
  for (int k = 0; k < kind_count; k++) {
    DeviceInfo infos[DEVICE_MAX_FOUND];
    char reason[DEVICE_TEXT];
    int count = kinds[k]->find(infos, reason);
    if (is_json)
      record_kind(kinds[k], infos, count, reason, record_append(root));
    else
      print_text(kinds[k], infos, count, reason);
  }
  Status status = is_json ? record_list_print(root, stdout) : STATUS_OK;
  if (is_json) record_list_destroy(root);
  if (status == STATUS_OK && fflush(stdout) != 0)
    status = status_fail(STATUS_IO, "standard output cannot be written");
  return status;
}

static int run_command(int argument_count, char **arguments) {
  bool is_json = false;
  app_cli_parse(&app_command_devices, argument_count, arguments, &is_json);
  return app_cli_command_end(list_devices(is_json));
}

const AppCommand app_command_devices = {
    .name = "devices",
    .help = "list accelerators, and why one is not usable",
    .options = option_table,
    .doc = "List the devices that overlap models can be evaluated on (bench overlap --device NAME), the "
           "libraries searched, and why something is not usable.",
    .run = run_command};
