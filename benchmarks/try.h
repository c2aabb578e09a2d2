/* A call of the library, as a host makes it: what fails ends the function with its status. */
#ifndef TRY_H
#define TRY_H

#include <spar/spar.h>

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

#endif
