// SPDX-License-Identifier: Apache-2.0
// How every function of net/ says that it failed: 0 is ok, negative is a failure with one message, kept for
// the calling thread, that says what is wrong and what was expected. Nothing here prints or exits.
#ifndef NET_STATUS_H
#define NET_STATUS_H

typedef enum NetStatus {
  NET_OK = 0,
  NET_BAD_ARGUMENT = -1, // a shape or an argument that cannot be
  NET_BAD_FILE = -2,     // a file that was read is wrong
  NET_NO_MEMORY = -3,    // no memory
  NET_BAD_IO = -4,       // a file could not be read or written
} NetStatus;

// Sets the thread's message and returns `code`.
NetStatus net_status_fail(NetStatus code, const char *format, ...) __attribute__((format(printf, 2, 3)));

// NET_NO_MEMORY with a message that names what did not fit.
NetStatus net_status_no_memory(const char *what);

// The message of the thread's last failure, "" if there was none.
const char *net_status_message(void);

#define NET_TRY(call)                                                                                        \
  do {                                                                                                       \
    NetStatus net_try_status_ = (call);                                                                      \
    if (net_try_status_ != NET_OK) return net_try_status_;                                                   \
  } while (0)

#endif
