#include "sparActuatorLines.H"
#include "addToRunTimeSelectionTable.H"
#include "fvMatrices.H"
#include "OSspecific.H"
#include "fvMesh.H"
#include "sparFoam.H"
#include "volFields.H"
#include <spar/spar_mpi.h>
#include <cstdlib>
#include <ctime>

namespace Foam
{
namespace fv
{

defineTypeNameAndDebug(sparActuatorLines, 0);
#if SPAR_FOAM_FOUNDATION
addToRunTimeSelectionTable(fvModel, sparActuatorLines, dictionary);
#else
addToRunTimeSelectionTable(option, sparActuatorLines, dictionary);
#endif

}
}

namespace
{

double processorSeconds()
{
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9*double(now.tv_nsec);
}

}

void Foam::fv::sparActuatorLines::check(int status) const
{
    if (status != SPAR_OK)
    {
        FatalErrorInFunction<< "spar: " << spar_status_text(status) << ": "
            << (data_.message[0] ? data_.message : spar_session_message(session_)) << exit(FatalError);
    }
}

void Foam::fv::sparActuatorLines::checkCase(int status) const
{
    if (status != SPAR_OK)
    {
        FatalErrorInFunction<< "spar: " << spar_status_text(status) << ": " << spar_case_message() << exit(FatalError);
    }
}

Foam::fv::sparActuatorLines::sparActuatorLines
(
    const word& name,
    const word& modelType,
#if SPAR_FOAM_FOUNDATION
    const fvMesh& mesh,
    const dictionary& dict
)
:
    fvModel(name, modelType, mesh, dict),
#else
    const dictionary& dict,
    const fvMesh& mesh
)
:
    option(name, modelType, dict, mesh),
#endif
    density_(sparFoam::get<scalar>(coeffs(), "density")),
    width_(0),
    speed_(0),
    angle_(0),
    timeIndex_(-1),
    session_(nullptr),
    scene_(nullptr),
    data_(),
    rotor_(),
    blade_(),
    sections_(),
    aero_(nullptr),
    spar_(0),
    history_(nullptr)
{
#if !SPAR_FOAM_FOUNDATION
    coeffs().readEntry("fields", fieldNames_);
    applied_.setSize(fieldNames_.size(), false);
#endif
    const double began = processorSeconds();
    start();
    spar_ += processorSeconds() - began;
}

void Foam::fv::sparActuatorLines::start()
{
    double rpm, kernel, wind;
    List<double> twist(256);
    const char* folder = getenv("SPAR_DATA"); // the run script's: examples/data
    fileName structure(sparFoam::get<fileName>(coeffs(), "structure"));
    // a serial run has not initialised MPI
    check(Pstream::parRun() ? spar_session_create_mpi(MPI_COMM_WORLD, &session_) : spar_session_create(&session_));
    checkCase(spar_case_read(structure.expand().c_str(), "openfoam", session_, &scene_));
    checkCase(spar_case_get_numbers(scene_, "rpm", 1, nullptr, &rpm));
    checkCase(spar_case_get_numbers(scene_, "kernel", 1, nullptr, &kernel));
    checkCase(spar_case_get_numbers(scene_, "wind", 1, nullptr, &wind)); // that of 0/U
    checkCase(spar_case_check(scene_));
    width_ = kernel;
    speed_ = rpm*constant::mathematical::pi/30;
    check(nrel5mw_load(&data_, (fileName(folder ? folder : ".")/"nrel5mw").c_str()));
    data_.tilt = data_.precone = 0;
    nrel5mw_rotor_default(&data_, &rotor_);
    const double omega[3] = {speed_*rotor_.axis[0], speed_*rotor_.axis[1], speed_*rotor_.axis[2]};
    for (int b = 0; b < blades_; b++)
    {
        check(nrel5mw_create_blade(&data_, &rotor_, session_, b, 1, nodes_, &blade_[b]));
        check(spar_member_commit(blade_[b]));
        check(spar_member_set_initial_velocity(blade_[b], rotor_.hub, nullptr, omega));
        if (Pstream::master())
        {
            check(nrel5mw_create_sections(&data_, &rotor_, b, blade_[b], &sections_[b], twist.begin()));
        }
    }
    check(nrel5mw_create_aero(&data_, &rotor_, Pstream::master() ? blades_ : 0, sections_, twist.begin(), &aero_));
    check(spar_aero_set_effects(aero_, SPAR_AERO_DRAG | SPAR_AERO_MOMENT));
    resume(structure.lessExt().name());
    const label n = blades_*label(data_.aero_n);
    x_.setSize(n, Zero);
    u_.setSize(n, Zero);
    force_.setSize(n, Zero);
    weight_.setSize(n, Zero);
}

Foam::fileName Foam::fv::sparActuatorLines::stateFile(const word& timeName) const
{
    const Time& time = mesh().time();
    return time.rootPath()/time.globalCaseName()/"spar"/(caseName_ + "." + timeName);
}

// The rotor goes on where the flow does. A flow that was computed before the rotor was there: `begun`, its time then.
void Foam::fv::sparActuatorLines::resume(const word& name)
{
    caseName_ = name;
    const Time& time = mesh().time();
    const scalar start = sparFoam::startTime(time), begun = coeffs().lookupOrDefault<scalar>("begun", 0);
    const bool resumes = start > begun + 0.5*time.deltaTValue();
    checkCase(spar_case_resume(scene_, resumes ? stateFile(time.timeName(time.startTime().value())).c_str() : nullptr,
        resumes ? start - begun : 0, resumes ? -1 : 0));
    angle_ = resumes ? speed_*(start - begun) : 0;
}

Foam::fv::sparActuatorLines::~sparActuatorLines()
{
    double seconds[2] = {spar_, processorSeconds()};
    for (double& value : seconds)
    {
        reduce(value, sumOp<scalar>());
    }
    if (history_)
    {
        fclose(history_);
        if (FILE* f = fopen((caseName_ + "_summary.txt").c_str(), "w"))
        {
            fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0], seconds[0]/seconds[1]);
            fclose(f);
        }
    }
    spar_aero_destroy(&aero_);
    spar_case_free(&scene_);
    spar_session_destroy(&session_);
    nrel5mw_free(&data_);
}

void Foam::fv::sparActuatorLines::places()
{
    const label n = x_.size()/blades_;
    for (int b = 0; Pstream::master() && b < blades_; b++)
    {
        check(spar_fluid_pull_motion(sections_[b], 0.5, x_[n*b].v_, nullptr));
    }
    Pstream::scatter(x_);
}

void Foam::fv::sparActuatorLines::sample(const volVectorField& U)
{
    const vectorField& centres = mesh().C();
    const scalarField& volumes = mesh().V();
    weight_ = 0;
    u_ = Zero;
    forAll(centres, cell)
    {
        forAll(x_, i)
        {
            const scalar r2 = magSqr(centres[cell] - x_[i])/sqr(width_);
            if (r2 < 16)
            {
                const scalar part = Foam::exp(-r2)*volumes[cell];
                weight_[i] += part;
                u_[i] += part*U[cell];
            }
        }
    }
    Pstream::listCombineGather(weight_, plusEqOp<scalar>());
    Pstream::listCombineScatter(weight_);
    Pstream::listCombineGather(u_, plusEqOp<vector>());
    Pstream::listCombineScatter(u_);
    u_ /= weight_;
}

void Foam::fv::sparActuatorLines::advance(const volVectorField& U, scalar dt)
{
    const label n = x_.size()/blades_;
    double began = processorSeconds();
    angle_ += speed_*dt;
    for (int b = 0; b < blades_; b++)
    {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&data_, &rotor_, b, angle_, speed_, 0, q, v, a);
        check(spar_member_drive(blade_[b], q, v, a));
    }
    check(spar_step_begin(session_, dt));
    check(spar_step_solve(session_));
    places();
    spar_ += processorSeconds() - began;
    sample(U); // once: iterations move the sections by millimetres
    began = processorSeconds();
    for (int done = 0; !done;)
    {
        check(spar_aero_solve(aero_, density_, u_[0].v_, 1));
        check(spar_step_check(session_, &done));
        if (!done)
        {
            check(spar_step_solve(session_));
        }
    }
    places();
    for (int b = 0; Pstream::master() && b < blades_; b++)
    {
        check(spar_fluid_pull_forces(sections_[b], 0.5, force_[n*b].v_));
    }
    Pstream::scatter(force_);
    spar_ += processorSeconds() - began;
    sample(U); // the kernel where the force is
}

void Foam::fv::sparActuatorLines::spread(vectorField& source) const
{
    const vectorField& centres = mesh().C();
    forAll(centres, cell)
    {
        forAll(x_, i)
        {
            const scalar r2 = magSqr(centres[cell] - x_[i])/sqr(width_);
            if (r2 < 16)
            {
                source[cell] -= Foam::exp(-r2)/weight_[i]*force_[i]/density_;
            }
        }
    }
}

void Foam::fv::sparActuatorLines::record(const volVectorField& U, const vectorField& source, scalar t)
{
    const scalarField& volumes = mesh().V();
    const vector spreadForce = -density_*gSum(vectorField(source*volumes));
    const scalar taken = -density_*gSum(scalarField((source & U.primitiveField())*volumes));
    if (!Pstream::master())
    {
        return;
    }
    const label n = x_.size()/blades_;
    const scalarField kernel(weight_/(Foam::pow(constant::mathematical::pi, 1.5)*pow3(width_)));
    double q[7*nodes_], thrust, torque, shaft, power = 0;
    int iterations;
    vectorField v(n);
    for (int b = 0; b < blades_; b++)
    {
        check(spar_fluid_pull_motion(sections_[b], 0.5, nullptr, v[0].v_));
        forAll(v, i)
        {
            power += force_[n*b + i] & v[i];
        }
    }
    const vector line = sum(force_);
    check(spar_member_get_motion(blade_[0], q, nullptr, nullptr));
    check(spar_aero_get_rotor(aero_, &thrust, &torque, &shaft));
    check(spar_session_get_time(session_, nullptr, nullptr, &iterations));
    if (!history_)
    {
        checkCase(spar_case_cut_history("history.csv", t - 0.5*mesh().time().deltaTValue()));
        history_ = fopen("history.csv", "a");
        if (!history_)
        {
            FatalErrorInFunction<< "history.csv cannot be written here" << exit(FatalError);
        }
        if (ftell(history_) == 0)
        {
            fprintf(history_, "time_s,thrust_N,shaft_power_W,line_x_N,line_y_N,line_z_N,spread_x_N,spread_y_N,spread_z_N,"
                "line_power_W,flow_power_W,kernel_least,kernel_most,tip_x_m,iterations\n");
        }
    }
    fprintf(history_, "%.9g,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.6f,%.6f,%.6e,%d\n", t, thrust, shaft, line.x(),
        line.y(), line.z(), spreadForce.x(), spreadForce.y(), spreadForce.z(), power, taken, min(kernel), max(kernel),
        q[7*(nodes_ - 1)], iterations);
    fflush(history_);
}

void Foam::fv::sparActuatorLines::addTo(fvMatrix<vector>& eqn)
{
    const volVectorField& U = eqn.psi();
    const Time& time = mesh().time();
    volVectorField source
    (
        IOobject(name() + ":source", time.timeName(), mesh()),
        mesh(),
        dimensionedVector("0", eqn.dimensions()/dimVolume, Zero)
    );
    const bool first = timeIndex_ != time.timeIndex(); // later correctors have the same force
    if (first)
    {
        timeIndex_ = time.timeIndex();
        advance(U, time.deltaTValue());
    }
    spread(source.primitiveFieldRef());
    if (first)
    {
        record(U, source.primitiveField(), time.value());
        check(spar_step_accept(session_));
        if (time.writeTime())
        {
            const fileName file(stateFile(time.timeName()));
            if (Pstream::master())
            {
                mkDir(file.path());
            }
            check(spar_session_save(session_, file.c_str()));
        }
    }
    eqn += source;
}

#if SPAR_FOAM_FOUNDATION
void Foam::fv::sparActuatorLines::addSup(fvMatrix<vector>& eqn, const word&) const
{
    const_cast<sparActuatorLines&>(*this).addTo(eqn); // the first call of a step takes the rotor on
}
#else
void Foam::fv::sparActuatorLines::addSup(fvMatrix<vector>& eqn, const label)
{
    addTo(eqn);
}
#endif
