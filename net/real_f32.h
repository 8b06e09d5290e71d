// SPDX-License-Identifier: Apache-2.0
// What follows is compiled for float: names end in _f32. Included before every template, hence no guard.
#undef NET_REAL
#undef NET_NAME
#undef NET_IS_DOUBLE
#define NET_REAL float
#define NET_NAME(name) name##_f32
#define NET_IS_DOUBLE 0
