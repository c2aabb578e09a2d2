// The examples' parts from C++: a case file and the reference turbine's tables, read by what is compiled as C.
#include <case.h>
#include <cstdio>
#include <nrel5mw.h>

int main(int count, char **argument) {
    spar_session *session = nullptr;
    spar_case *scene = nullptr;
    spar_member *cylinder = nullptr;
    nrel5mw turbine;
    if (count != 3 || spar_session_create(&session) != SPAR_OK) {
        return 2;
    }
    int status = spar_case_read(argument[1], "cxx", session, &scene);
    status = status == SPAR_OK ? spar_case_member(scene, "cylinder", &cylinder) : status;
    if (status != SPAR_OK) {
        std::printf("%s\n", spar_case_message());
    }
    bool good = status == SPAR_OK && cylinder != nullptr && nrel5mw_load(&turbine, argument[2]) == SPAR_OK && turbine.blades == 3;
    nrel5mw_free(&turbine);
    spar_case_free(&scene);
    spar_session_destroy(&session);
    return good ? 0 : 1;
}
