// SPDX-License-Identifier: Apache-2.0
// How every function of tetlap reports a failure.
//
// 0 is ok, positive is recoverable (take a smaller step), negative is fatal: IDA's own convention, so our
// callbacks hand a Status straight through. A fatal Status is minus the program's exit code. A failure
// carries one message, kept for the calling thread, that says where, what was expected and what to do. Inside
// an OpenMP region remember the failing index and fail after the region: the message belongs to one thread.
#ifndef TETLAP_BASE_STATUS_H
#define TETLAP_BASE_STATUS_H

typedef enum Status {
  STATUS_OK = 0,
  STATUS_RETRY = 1,          // recoverable: the same again with a smaller step
  STATUS_USAGE = -64,        // the command line is wrong
  STATUS_INPUT = -65,        // a file that was read is wrong
  STATUS_DEVICE = -69,       // an accelerator or a model's process is not there, or failed
  STATUS_SOLVER = -70,       // the solver gave up
  STATUS_MEMORY = -71,       // no memory
  STATUS_IO = -74,           // a file could not be read or written
  STATUS_INTERRUPTED = -130, // Ctrl-C or SIGTERM
} Status;

// Sets the thread's message and returns `code`.
Status status_fail(Status code, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Puts "prefix: " before the thread's message and returns `code`: a caller adds what it knows (file, body).
Status status_prefix(Status code, const char *format, ...) __attribute__((format(printf, 2, 3)));

// STATUS_MEMORY with a message that names what did not fit.
Status status_no_memory(const char *what);

// The message of the thread's last failure, "" if there was none.
const char *status_message(void);

// The program's exit code for a Status; an unhandled STATUS_RETRY counts as the solver's failure.
int status_exit_code(Status status);

#define TRY(call)                                                                                            \
  do {                                                                                                       \
    Status try_status_ = (call);                                                                             \
    if (try_status_ != STATUS_OK) return try_status_;                                                        \
  } while (0)

#endif
