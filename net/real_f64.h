// SPDX-License-Identifier: Apache-2.0
// What follows is compiled for double: names end in _f64. Included before every template, hence no guard.
#undef NET_REAL
#undef NET_NAME
#undef NET_IS_DOUBLE
#define NET_REAL double
#define NET_NAME(name) name##_f64
#define NET_IS_DOUBLE 1
