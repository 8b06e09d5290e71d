// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_edit.h"

#define H5_USE_110_API // what later versions have of the same name takes more arguments
#include <hdf5.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

enum { MAX_OBJECTS = 512, NAME_SIZE = 96, MAX_RANK = 5, MAX_VALUES = 4096 };

typedef enum Action {
  REMOVE,
  RETYPE, // a data set of another type and shape in its place
  WRITE,  // one element gets a special value
  LINK,   // a soft link, an external one or a group in its place
  RENAME, // moved to another's place
  TEXT,   // a fixed or variable text
  DAMAGE, // one byte of the file is changed
  ACTION_COUNT
} Action;

// Where an edit acts: the data sets by path, then the attributes of the root.
typedef struct Object {
  char name[NAME_SIZE];
  int is_attribute;
} Object;

typedef struct Objects {
  int count;
  Object list[MAX_OBJECTS];
} Objects;

static herr_t add_link(hid_t group, const char *name, const H5O_info_t *info, void *self) {
  Objects *objects = self;
  (void)group, (void)info;
  if (strcmp(name, ".") != 0 && objects->count < MAX_OBJECTS)
    snprintf(objects->list[objects->count++].name, NAME_SIZE, "%s", name);
  return 0;
}

static herr_t add_attribute(hid_t object, const char *name, const H5A_info_t *info, void *self) {
  Objects *objects = self;
  (void)object, (void)info;
  if (objects->count < MAX_OBJECTS) {
    Object *added = &objects->list[objects->count++];
    snprintf(added->name, NAME_SIZE, "%s", name);
    added->is_attribute = 1;
  }
  return 0;
}

static void list_objects(hid_t file, Objects *objects) {
  memset(objects, 0, sizeof *objects);
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, add_link, objects, H5O_INFO_BASIC);
  hsize_t place = 0;
  H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_INC, &place, add_attribute, objects);
}

static void close_id(hid_t id) {
  if (id >= 0) H5Idec_ref(id);
}

// One of the types that a reader could meet; to be closed.
static hid_t type_of(uint8_t number) {
  switch (number % 16) {
  case 0:
    return H5Tcopy(H5T_IEEE_F64LE);
  case 1:
    return H5Tcopy(H5T_IEEE_F64BE);
  case 2:
    return H5Tcopy(H5T_IEEE_F32LE);
  case 3:
    return H5Tcopy(H5T_STD_I64LE);
  case 4:
    return H5Tcopy(H5T_STD_U64BE);
  case 5:
    return H5Tcopy(H5T_STD_I32LE);
  case 6:
    return H5Tcopy(H5T_STD_U8LE);
  case 7:
    return H5Tcopy(H5T_STD_I8LE);
  case 8:
  case 9:
  case 10: {
    static const size_t sizes[] = {1, 40, H5T_VARIABLE};
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, sizes[number % 16 - 8]);
    return type;
  }
  case 11:
    return H5Tvlen_create(H5T_NATIVE_DOUBLE);
  case 12: {
    hsize_t shape = 3;
    return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &shape);
  }
  case 13: {
    hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(type, "a", 0, H5T_NATIVE_DOUBLE);
    return type;
  }
  case 14:
    return H5Tcreate(H5T_OPAQUE, 8);
  default:
    return H5Tcopy(H5T_STD_REF_OBJ);
  }
}

static hsize_t extent_of(uint8_t number) {
  static const hsize_t extents[] = {
      0,  1,  2,    3,     4,          5,          6,           8,           12,
      24, 64, 4096, 65536, 0x7fffffff, 0x80000000, 0x100000000, 0x100000001, 0x2000000000000000};
  return extents[number % (sizeof extents / sizeof *extents)];
}

// Rank 0 … 5 in `how`, or no space at all; large ones only in chunks, so that nothing is stored.
static hid_t space_of(const uint8_t how[4], hid_t options) {
  hsize_t shape[MAX_RANK], chunk[MAX_RANK];
  int rank = how[0] % 8;
  if (rank == 6) return H5Screate(H5S_NULL);
  if (rank == 0 || rank > MAX_RANK) return H5Screate(H5S_SCALAR);
  double size = 1;
  for (int d = 0; d < rank; d++) {
    shape[d] = extent_of(how[1 + d % 3]);
    chunk[d] = shape[d] < 4 ? shape[d] + (shape[d] == 0) : 4;
    size *= (double)shape[d];
  }
  if (options >= 0 && (size > MAX_VALUES || how[0] & 8)) H5Pset_chunk(options, rank, chunk);
  if (options >= 0 && how[0] & 16) H5Pset_fletcher32(options);
  if (options < 0 && size > MAX_VALUES) return H5Screate(H5S_NULL);
  return H5Screate_simple(rank, shape, NULL);
}

static void fill_attribute(hid_t attribute, hid_t type, int byte) {
  static uint8_t values[1 << 16];
  if (H5Aget_storage_size(attribute) > sizeof values || H5Tis_variable_str(type) > 0 ||
      H5Tget_class(type) == H5T_VLEN || H5Tget_class(type) == H5T_REFERENCE)
    return;
  memset(values, byte, sizeof values);
  H5Awrite(attribute, type, values);
}

static void remove_object(hid_t file, const Object *object) {
  if (object->is_attribute)
    H5Adelete(file, object->name);
  else
    H5Ldelete(file, object->name, H5P_DEFAULT);
}

static void retype(hid_t file, const Object *object, const uint8_t how[6]) {
  remove_object(file, object);
  hid_t type = type_of(how[0]), options = object->is_attribute ? -1 : H5Pcreate(H5P_DATASET_CREATE),
        space = space_of(how + 1, options), made = -1;
  if (object->is_attribute) {
    made = H5Acreate2(file, object->name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (made >= 0) fill_attribute(made, type, how[5]);
  } else {
    hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    made = H5Dcreate2(file, object->name, type, space, links, options, H5P_DEFAULT);
    // An element that is written allocates what is not in chunks.
    double zero = 0;
    hid_t one = H5Screate(H5S_SCALAR);
    if (made >= 0 && how[5] & 1 && H5Tget_class(type) == H5T_FLOAT &&
        H5Sget_simple_extent_npoints(space) == 1)
      H5Dwrite(made, H5T_NATIVE_DOUBLE, one, H5S_ALL, H5P_DEFAULT, &zero);
    close_id(one);
    close_id(links);
  }
  close_id(made);
  close_id(space);
  close_id(options);
  close_id(type);
}

static double special_of(const uint8_t how[3]) {
  static const double values[] = {0,      -1,      1,      2,      1e308, -1e308, 0x1p31, -0x1p31 - 1,
                                  0x1p63, -0x1p63, 1e-320, 0x1p32, 4096,  0.5,    255};
  enum { COUNT = sizeof values / sizeof *values };
  switch (how[0] % 4) {
  case 0:
    return values[how[1] % COUNT];
  case 1:
    return (double)(int16_t)(how[1] | how[2] << 8);
  case 2:
    return how[1] & 1 ? NAN : how[1] & 2 ? INFINITY : -INFINITY;
  default:
    return ldexp((double)(int8_t)how[1], (int8_t)how[2] / 2);
  }
}

static void write_element(hid_t file, const Object *object, const uint8_t how[6]) {
  double values[MAX_VALUES];
  hid_t id = object->is_attribute ? H5Aopen(file, object->name, H5P_DEFAULT)
                                  : H5Dopen2(file, object->name, H5P_DEFAULT);
  if (id < 0) return;
  hid_t space = object->is_attribute ? H5Aget_space(id) : H5Dget_space(id);
  hssize_t count = H5Sget_simple_extent_npoints(space);
  hid_t type = H5T_NATIVE_DOUBLE;
  if (count > 0 && count <= MAX_VALUES) {
    size_t k = (size_t)(how[0] | how[1] << 8) % (size_t)count;
    if (object->is_attribute && H5Aread(id, type, values) >= 0) {
      values[k] = special_of(how + 2);
      H5Awrite(id, type, values);
    } else if (!object->is_attribute && H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) {
      values[k] = special_of(how + 2);
      H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    }
  }
  close_id(space);
  close_id(id);
}

static void put_link(hid_t file, const Object *object, const Object *other, uint8_t how) {
  if (object->is_attribute) return;
  remove_object(file, object);
  hid_t group = -1;
  switch (how % 5) {
  case 0:
    H5Lcreate_soft(other->name, file, object->name, H5P_DEFAULT, H5P_DEFAULT);
    break;
  case 1: // to itself
    H5Lcreate_soft(object->name, file, object->name, H5P_DEFAULT, H5P_DEFAULT);
    break;
  case 2:
    H5Lcreate_external("no such file.h5", "/x", file, object->name, H5P_DEFAULT, H5P_DEFAULT);
    break;
  case 3:
    group = H5Gcreate2(file, object->name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    break;
  default:
    H5Lcreate_hard(file, other->name, file, object->name, H5P_DEFAULT, H5P_DEFAULT);
  }
  close_id(group);
}

static void rename_object(hid_t file, const Object *object, const Object *other) {
  if (object->is_attribute != other->is_attribute) return;
  remove_object(file, other);
  if (object->is_attribute)
    H5Arename(file, object->name, other->name);
  else
    H5Lmove(file, object->name, file, other->name, H5P_DEFAULT, H5P_DEFAULT);
}

// A text of up to four letters, repeated, without its end if `how` says so.
static void put_text(hid_t file, const Object *object, const uint8_t how[6]) {
  char text[256] = "";
  const char *pointer = text;
  size_t length = how[0] % sizeof text;
  for (size_t k = 0; k < length; k++) text[k] = (char)how[1 + k % 4];
  remove_object(file, object);
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR), id;
  H5Tset_size(type, how[5] & 1 ? H5T_VARIABLE : length + (how[5] >> 1 & 1) + (length == 0));
  const void *value = how[5] & 1 ? (const void *)&pointer : text;
  text[sizeof text - 1] = 0;
  if (object->is_attribute) {
    id = H5Acreate2(file, object->name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0) H5Awrite(id, type, value);
  } else {
    id = H5Dcreate2(file, object->name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0) H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value);
  }
  close_id(id);
  close_id(space);
  close_id(type);
}

static void apply(hid_t file, const Objects *objects, const uint8_t edit[FUZZ_HDF5_EDIT]) {
  const Object *object = &objects->list[edit[1] % objects->count],
               *other = &objects->list[edit[2] % objects->count];
  switch ((Action)(edit[0] % ACTION_COUNT)) {
  case REMOVE:
    remove_object(file, object);
    break;
  case RETYPE:
    retype(file, object, edit + 2);
    break;
  case WRITE:
    write_element(file, object, edit + 2);
    break;
  case LINK:
    put_link(file, object, other, edit[3]);
    break;
  case RENAME:
    rename_object(file, object, other);
    break;
  case TEXT:
    put_text(file, object, edit + 2);
    break;
  case DAMAGE:
  case ACTION_COUNT:
    break;
  }
}

int fuzz_hdf5_has_damage(const uint8_t *edits, size_t size) {
  for (; size >= FUZZ_HDF5_EDIT; edits += FUZZ_HDF5_EDIT, size -= FUZZ_HDF5_EDIT)
    if (edits[0] % ACTION_COUNT == DAMAGE) return 1;
  return 0;
}

// Bytes that HDF5 does not know of: the second half of the edit says where.
static void damage(FuzzImage *image, const uint8_t *edits, size_t size) {
  for (; size >= FUZZ_HDF5_EDIT; edits += FUZZ_HDF5_EDIT, size -= FUZZ_HDF5_EDIT) {
    if (edits[0] % ACTION_COUNT != DAMAGE) continue;
    uint32_t place;
    memcpy(&place, edits + 2, sizeof place);
    image->bytes[place % image->size] = edits[6];
    if (edits[7] == 255) image->size = 1 + place % image->size; // cut short
  }
}

FuzzImage fuzz_hdf5_edit(const uint8_t *bytes, size_t byte_count, const uint8_t *edits, size_t size) {
  enum { GROWTH = 65536 };
  FuzzImage image;
  static Objects objects;
  static const uint8_t *listed; // the file they are of: the same each time
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, GROWTH, 0);
  H5Pset_file_image(access, (void *)(uintptr_t)bytes, byte_count);
  hid_t file = H5Fopen("edited", H5F_ACC_RDWR, access);
  FUZZ_CLAIM(file >= 0, "a good file cannot be opened");
  if (listed != bytes) list_objects(file, &objects);
  listed = bytes;
  for (size_t k = 0; k + FUZZ_HDF5_EDIT <= size; k += FUZZ_HDF5_EDIT) apply(file, &objects, edits + k);
  H5Fflush(file, H5F_SCOPE_LOCAL);
  ssize_t wanted = H5Fget_file_image(file, NULL, 0);
  FUZZ_CLAIM(wanted > 0, "an edited file has no image");
  image.size = (size_t)wanted;
  image.bytes = malloc(image.size);
  FUZZ_CLAIM(image.bytes && H5Fget_file_image(file, image.bytes, image.size) == wanted, "no memory");
  close_id(file);
  close_id(access);
  H5Eclear2(H5E_DEFAULT);
  damage(&image, edits, size);
  return image;
}

size_t fuzz_hdf5_seed(int k, uint8_t *data) {
  enum { OBJECTS = 24 };
  memset(data, 0, FUZZ_HDF5_EDIT);
  if (k == 0) return 1; // less than an edit: the good file
  if (k > OBJECTS * DAMAGE) return 0;
  data[0] = (uint8_t)((k - 1) % DAMAGE);
  data[1] = (uint8_t)((k - 1) / DAMAGE);
  return FUZZ_HDF5_EDIT;
}

static uint8_t choose_action(int random) {
  return (uint8_t)(random % (getenv("TETLAP_FUZZ_DAMAGE") ? ACTION_COUNT : DAMAGE));
}

size_t fuzz_hdf5_mutate(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain) {
  enum { MOST = 6 * FUZZ_HDF5_EDIT };
  Random random = random_seeded(number, 0);
  size_t count = size / FUZZ_HDF5_EDIT, most = (room < MOST ? room : MOST) / FUZZ_HDF5_EDIT;
  int choice = random_below(&random, 8);
  if (most == 0 || size > MOST) return plain(data, size, room);
  if (count == 0 || (choice == 0 && count < most)) { // one more
    uint64_t bits = random_bits(&random);
    memcpy(data + FUZZ_HDF5_EDIT * count, &bits, FUZZ_HDF5_EDIT);
    data[FUZZ_HDF5_EDIT * count] = choose_action(data[FUZZ_HDF5_EDIT * count]);
    return FUZZ_HDF5_EDIT * (count + 1);
  }
  uint8_t *edit = data + FUZZ_HDF5_EDIT * (size_t)random_below(&random, (int)count);
  if (choice == 1 && count > 1) { // one less
    memmove(edit, edit + FUZZ_HDF5_EDIT, (size_t)(data + FUZZ_HDF5_EDIT * (count - 1) - edit));
    return FUZZ_HDF5_EDIT * (count - 1);
  }
  int place = random_below(&random, FUZZ_HDF5_EDIT);
  edit[place] = (uint8_t)random_bits(&random);
  if (place == 0) edit[0] = choose_action(edit[0]);
  return FUZZ_HDF5_EDIT * count;
}
