/* The declarations of CBLAS; linked is the fast one, if one was found. */
#ifndef SPARI_CBLAS_H
#define SPARI_CBLAS_H

#include "../base/blas.h"

#include <gsl/gsl_cblas.h>

#endif
