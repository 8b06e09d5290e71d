// SPDX-License-Identifier: Apache-2.0
// JSON values in and out; the only file that knows jansson. A value that was found inside another is borrowed
// and lives as long as the outermost one.
#ifndef NET_JSON_H
#define NET_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct NetJson NetJson;

// The object in `length` bytes, NULL where they are no JSON object or name a key twice; then `error` says
// what and where.
NetJson *net_json_parse(const char *text, size_t length, char error[160]);
NetJson *net_json_object(void); // empty, NULL without memory
void net_json_destroy(NetJson *value);

int net_json_count(const NetJson *array_or_object);
const NetJson *net_json_member(const NetJson *object, const char *key); // NULL: not there
const NetJson *net_json_element(const NetJson *array, int index);       // NULL: no array or not there
const char *net_json_text(const NetJson *value);                        // NULL: no string
bool net_json_is_object(const NetJson *value);
bool net_json_is_array(const NetJson *value);
bool net_json_integer(const NetJson *value, int64_t *integer); // false: no integer
bool net_json_bool(const NetJson *value, bool *boolean);       // false: neither true nor false

// Members in their order: `cursor` begins as NULL and is advanced; false after the last.
bool net_json_next(const NetJson *object, void **cursor, const char **key, const NetJson **value);

// False without memory, or where a text is not UTF-8.
bool net_json_set_text(NetJson *object, const char *key, const char *text);
bool net_json_set_bool(NetJson *object, const char *key, bool boolean);
bool net_json_set_integer(NetJson *object, const char *key, int64_t integer);
bool net_json_set_integers(NetJson *object, const char *key, int count, const int64_t integers[]);
bool net_json_set_object(NetJson *object, const char *key, NetJson *child); // takes the child in any case

// The compact text, to be freed with net_memory_free; NULL without memory.
char *net_json_print(const NetJson *object);

#endif
