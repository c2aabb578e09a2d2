/* The declarations of CBLAS; linked is the fast one, if one was found. */
#ifndef SPARI_CBLAS_H
#define SPARI_CBLAS_H

#include "../base/blas.h"

#ifdef SPARI_WITHOUT_GSL
#include <cblas.h>
#else
#include <gsl/gsl_cblas.h>
#endif

#endif
