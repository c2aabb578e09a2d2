// The headers in C++: they compile, and the functions link.
#include <spar/spar.h>
#include <spar/spar_structure.h>
#include <spar/spar_coupling.h>
#include <spar/spar_analysis.h>
#include <spar/spar_all.h>
#include <spar/spar_aero.h>
#include <spar/spar_output.h>
#ifdef SPAR_TEST_MPI
#include <spar/spar_mpi.h>
#endif

int main() {
    spar_session *session = nullptr;
    int status = spar_session_create(&session);
    spar_session_destroy(&session);
    return status == SPAR_OK && session == nullptr ? 0 : 1;
}
