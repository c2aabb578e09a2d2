// The calls of spar, and what they cost.
#include "sparHost.H"
#include "Pstream.H"
#include "error.H"
#include <spar/spar_mpi.h>
#include <ctime>

namespace
{

double processorSeconds()
{
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9*double(now.tv_nsec);
}

//- Adds the processor time of its scope
class stopwatch
{
    double& sum_;
    const double began_;

public:

    explicit stopwatch(double& sum) : sum_(sum), began_(processorSeconds()) {}
    ~stopwatch() { sum_ += processorSeconds() - began_; }
};

const double* triples(const Foam::vectorField& x)
{
    return x.size() ? x[0].v_ : nullptr;
}

double* triples(Foam::vectorField& x)
{
    return x.size() ? x[0].v_ : nullptr;
}

void tell(const spar_session*, int level, const char* text, void*)
{
    if (Foam::Pstream::master())
    {
        Foam::Info<< (level == SPAR_LOG_ERROR ? "spar, error: " : level == SPAR_LOG_WARNING ? "spar, warning: " : "spar: ")
            << text << Foam::endl;
    }
}

}

void Foam::sparHost::check(int status) const
{
    if (status != SPAR_OK)
    {
        FatalErrorInFunction<< "spar: " << spar_status_text(status) << ": " << spar_session_message(session_)
            << exit(FatalError);
    }
}

void Foam::sparHost::checkCase(int status) const
{
    if (status != SPAR_OK)
    {
        FatalErrorInFunction<< "spar: " << spar_status_text(status) << ": " << spar_case_message() << exit(FatalError);
    }
}

Foam::sparHost::sparHost
(
    const fileName& caseFile,
    const word& member,
    const pointField& points,
    const vectorField& faceCentres
)
:
    session_(nullptr),
    scene_(nullptr),
    surface_(nullptr),
    x0_(points),
    x_(points),
    errors_{0, 0, 0},
    steps_(0),
    iterations_(0),
    most_(0),
    spar_(0)
{
    const stopwatch watch(spar_);
    spar_member* wet = nullptr;
    // a serial run has not initialised MPI
    check(Pstream::parRun() ? spar_session_create_mpi(MPI_COMM_WORLD, &session_) : spar_session_create(&session_));
    check(spar_session_set_log(session_, tell, nullptr));
    checkCase(spar_case_read(caseFile.c_str(), "openfoam", session_, &scene_));
    checkCase(spar_case_member(scene_, member.c_str(), &wet));
    checkCase(spar_case_make_aero(scene_, Pstream::myProcNo()));
    checkCase(spar_case_check(scene_));
    check(spar_fluid_create(wet, "openfoam", &surface_));
    check(spar_fluid_set_motion_nodes(surface_, x0_.size(), triples(x0_)));
    check(spar_fluid_set_force_nodes(surface_, faceCentres.size(), triples(faceCentres)));
    check(spar_fluid_map(surface_));
    check(spar_fluid_set_option(surface_, "velocity", "own")); // OpenFOAM takes wall velocities from the moving mesh
}

Foam::sparHost::~sparHost()
{
    report();
    spar_case_free(&scene_);
    spar_session_destroy(&session_);
}

void Foam::sparHost::begin(scalar dt)
{
    const stopwatch watch(spar_);
    check(spar_step_begin(session_, dt));
}

Foam::tmp<Foam::vectorField> Foam::sparHost::solve()
{
    const stopwatch watch(spar_);
    check(spar_step_solve(session_));
    checkCase(spar_case_blow(scene_));
    check(spar_fluid_pull_motion(surface_, 1, triples(x_), nullptr));
    return x_ - x0_;
}

void Foam::sparHost::push(const vectorField& force)
{
    const stopwatch watch(spar_);
    int done;
    check(spar_fluid_push_forces(surface_, triples(force), nullptr));
    check(spar_step_check(session_, &done)); // when to stop is OpenFOAM's affair: residualControl
}

void Foam::sparHost::accept()
{
    const stopwatch watch(spar_);
    double audit[SPAR_AUDIT_COUNT];
    int iterations;
    check(spar_step_accept(session_));
    checkCase(spar_case_output(scene_, Pstream::myProcNo(), 1, &surface_));
    check(spar_session_get_time(session_, nullptr, nullptr, &iterations));
    check(spar_fluid_get_audit(surface_, SPAR_AUDIT_COUNT, audit));
    for (int i = 0; i < 3; i++)
    {
        errors_[i] = max(errors_[i], audit[SPAR_AUDIT_FORCE_ERROR + i]);
    }
    steps_++;
    iterations_ += iterations;
    most_ = max(most_, label(iterations));
}

void Foam::sparHost::report()
{
    double seconds[2] = {spar_, processorSeconds()};
    for (double& value : errors_)
    {
        reduce(value, maxOp<scalar>());
    }
    for (double& value : seconds)
    {
        reduce(value, sumOp<scalar>());
    }
    if (!Pstream::master() || !steps_)
    {
        return;
    }
    if (FILE* f = fopen("summary.txt", "w"))
    {
        fprintf(f, "steps %d\niterations_mean %.3f\niterations_most %d\n", int(steps_), double(iterations_)/steps_, int(most_));
        fprintf(f, "force_error %.1e\nmoment_error %.1e\npower_error %.1e\n", errors_[0], errors_[1], errors_[2]);
        fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0], seconds[0]/seconds[1]);
        fclose(f);
    }
}
