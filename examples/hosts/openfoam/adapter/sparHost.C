// The calls of spar, and what they cost.
#include "sparHost.H"
#include "OSspecific.H"
#include "Pstream.H"
#include "error.H"
#include "pointIOField.H"
#include "sparFoam.H"
#include "surfaceFields.H"
#include <spar/spar_mpi.h>
#include <ctime>
#include <map>
#include <sstream>

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

//- Where the points were before anything moved, as OpenFOAM's own displacement solvers find them
Foam::pointField pointsAtStart(const Foam::fvMesh& mesh)
{
    using namespace Foam;
    IOobject io
    (
        "points0",
        mesh.time().constant(),
        polyMesh::meshSubDir,
        mesh,
        IOobject::READ_IF_PRESENT,
        IOobject::NO_WRITE,
        false
    );
    pointIOField points(io, pointField());
    if (returnReduce(points.empty(), andOp<bool>()))
    {
        io.rename("points");
        io.readOpt() = IOobject::MUST_READ;
        points = pointIOField(io);
    }
    if (points.size() != mesh.nPoints())
    {
        FatalErrorInFunction<< "spar: the mesh has " << mesh.nPoints() << " points and constant/polyMesh " << points.size()
            << "; a mesh that changes its topology is not supported" << exit(FatalError);
    }
    return points;
}

typedef std::map<std::pair<const Foam::fvMesh*, std::string>, std::weak_ptr<Foam::sparHost>> hostMap;

hostMap& hosts()
{
    static hostMap all;
    return all;
}

}

std::shared_ptr<Foam::sparHost> Foam::sparHost::find(const fvMesh& mesh, const fileName& caseFile)
{
    return hosts()[{&mesh, caseFile}].lock();
}

std::shared_ptr<Foam::sparHost> Foam::sparHost::make
(
    const fvMesh& mesh,
    const fileName& caseFile,
    const std::vector<wetted>& patches,
    bool resumes,
    scalar begun
)
{
    std::shared_ptr<sparHost> host(new sparHost(mesh, caseFile, patches, resumes, begun));
    hosts()[{&mesh, caseFile}] = host;
    return host;
}

void Foam::sparHost::refuse(const string& text) const
{
    FatalErrorInFunction<< "spar: " << text.c_str() << exit(FatalError);
}

void Foam::sparHost::check(int status) const
{
    if (status != SPAR_OK)
    {
        refuse(string(spar_status_text(status)) + ": " + spar_session_message(session_) + flowNow());
    }
}

void Foam::sparHost::checkCase(int status) const
{
    if (status != SPAR_OK)
    {
        refuse(string(spar_status_text(status)) + ": " + spar_case_message());
    }
}

Foam::string Foam::sparHost::flowNow() const
{
    if (!motion_)
    {
        return "";
    }
    std::ostringstream text;
    text << ". The flow: forces of " << force_ << " N on the structure; velocities up to " << speed_
        << " m/s in the last accepted step; least cell of the mesh " << leastVolume_ << " m^3, "
        << 100*leastVolume_/firstVolume_ << " % of the least at the start";
    if (leastVolume_ < 0.1*firstVolume_)
    {
        text << ": the mesh's motion has squeezed cells, which breaks the flow, and the flow the structure;"
            << " another diffusivity in dynamicMeshDict spreads the motion wider";
    }
    return text.str();
}

Foam::sparHost::sparHost
(
    const fvMesh& mesh,
    const fileName& caseFile,
    const std::vector<wetted>& patches,
    bool resumes,
    scalar begun
)
:
    mesh_(mesh),
    name_(caseFile.lessExt().name()),
    session_(nullptr),
    scene_(nullptr),
    directions_(Zero),
    planar_(false),
    begun_(resumes ? begun : sparFoam::startTime(mesh.time())),
    open_(false),
    timeIndex_(-1),
    motion_(0),
    solves_(0),
    saved_(-1),
    errors_{0, 0, 0},
    steps_(0),
    iterations_(0),
    most_(0),
    force_(0),
    firstVolume_(gMin(mesh.V().field())),
    leastVolume_(firstVolume_),
    speed_(0),
    pressure_(0),
    leftPlane_(false),
    volumes_(nullptr),
    spar_(0)
{
    const stopwatch watch(spar_);
    for (direction d = 0; d < vector::nComponents; d++)
    {
        directions_[d] = mesh.geometricD()[d] > 0;
        planar_ = planar_ || directions_[d] == 0;
    }
    // a serial run has not initialised MPI
    check(Pstream::parRun() ? spar_session_create_mpi(MPI_COMM_WORLD, &session_) : spar_session_create(&session_));
    check(spar_session_set_log(session_, tell, nullptr));
    checkCase(spar_case_read(caseFile.c_str(), "openfoam", session_, &scene_));
    const pointField points(pointsAtStart(mesh));
    for (const wetted& patch : patches)
    {
        addSurface(patch, points);
    }
    checkCase(spar_case_make_aero(scene_, Pstream::myProcNo()));
    const scalar t = sparFoam::startTime(mesh.time()) - begun_;
    const fileName file(stateFile(mesh.time().timeName(mesh.time().startTime().value())));
    checkCase(spar_case_resume(scene_, resumes ? file.c_str() : nullptr, max(t, scalar(0)), resumes ? -1 : 0));
    for (const char* key : {"flow", "dt", "steps", "speed", "density", "pressure", "half", "shake"}) // those of the script run
    {
        const char* text;
        checkCase(spar_case_get_text(scene_, key, "", &text));
    }
    checkCase(spar_case_check(scene_));
}

Foam::sparHost::~sparHost()
{
    report();
    if (volumes_)
    {
        fclose(volumes_);
    }
    spar_case_free(&scene_);
    spar_session_destroy(&session_);
}

void Foam::sparHost::addSurface(const wetted& patch, const pointField& points)
{
    const polyPatch& boundary = mesh_.boundaryMesh()[mesh_.boundaryMesh().findPatchID(patch.patch)];
    if (returnReduce(boundary.size(), sumOp<label>()) == 0)
    {
        refuse("the patch " + patch.patch + " has no faces; nothing would move " + patch.member);
    }
    surface wet{};
    wet.id = boundary.index();
    wet.density = patch.density;
    wet.reference = pointField(points, boundary.meshPoints());
    wet.position = wet.reference;
    wet.displacement.setSize(wet.reference.size(), Zero);
    wet.centreAtStart.setSize(boundary.size());
    forAll(boundary, i)
    {
        wet.centreAtStart[i] = boundary[i].centre(points);
    }
    wet.centre = wet.centreAtStart;
    spar_member* member = nullptr;
    checkCase(spar_case_member(scene_, patch.member.c_str(), &member));
    check(spar_fluid_create(member, patch.patch.c_str(), &wet.fluid));
    check(spar_fluid_set_motion_nodes(wet.fluid, wet.reference.size(), triples(wet.reference)));
    check(spar_fluid_set_force_nodes(wet.fluid, wet.centre.size(), triples(wet.centre)));
    check(spar_fluid_map(wet.fluid));
    check(spar_fluid_set_option(wet.fluid, "velocity", "own")); // OpenFOAM takes wall velocities from the moving mesh
    fluids_.push_back(wet.fluid);
    surfaces_.push_back(wet);
}

Foam::fileName Foam::sparHost::stateFile(const word& timeName) const
{
    const Time& time = mesh_.time();
    return time.rootPath()/time.globalCaseName()/"spar"/(name_ + "." + timeName);
}

Foam::vectorField Foam::sparHost::forces(const surface& wet) const
{
    const vectorField& area = mesh_.Sf().boundaryField()[wet.id];
    const scalarField& p = mesh_.lookupObject<volScalarField>("p").boundaryField()[wet.id]; // over density
    const tmp<volSymmTensorField> stress(sparFoam::stress(mesh_));
    return wet.density*cmptMultiply(area*p + (area & stress().boundaryField()[wet.id]), directions_);
}

Foam::vectorField Foam::sparHost::moments(surface& wet, const vectorField& force)
{
    check(spar_fluid_pull_poses(wet.fluid, SPAR_NODES_FORCE, 1, triples(wet.centre), nullptr, nullptr, nullptr, nullptr, nullptr));
    const vectorField out(cmptMultiply(wet.centreAtStart - wet.centre, vector::one - directions_));
    return out ^ force;
}

void Foam::sparHost::begin()
{
    const stopwatch watch(spar_);
    check(spar_step_begin(session_, mesh_.time().deltaTValue()));
    open_ = true;
    timeIndex_ = mesh_.time().timeIndex();
    solves_ = 0;
}

void Foam::sparHost::solve()
{
    const stopwatch watch(spar_);
    check(spar_step_solve(session_));
    checkCase(spar_case_blow(scene_));
    for (surface& wet : surfaces_)
    {
        check(spar_fluid_pull_motion(wet.fluid, 1, triples(wet.position), nullptr));
        wet.displacement = cmptMultiply(wet.position - wet.reference, directions_);
    }
    motion_++;
    solves_++;
}

//- Forces that no flow of the accepted velocities and pressures has are those of a flow that has broken down
void Foam::sparHost::checkForce(scalar area) const
{
    const scalar largest = area*surfaces_[0].density*
        (sqr(speed_) + mesh_.bounds().mag()*speed_/mesh_.time().deltaTValue() + pressure_);
    if (!(force_ < GREAT) || (steps_ >= 2 && force_ > 1000*largest))
    {
        std::ostringstream text;
        text << "the forces are beyond what the flow's velocities and pressures of the last step can give, some " << largest
            << " N: the flow has broken down, or the coupling (take more correctors or a smaller dt)" << flowNow();
        refuse(text.str());
    }
}

void Foam::sparHost::push()
{
    std::vector<vectorField> force;
    scalar area = 0;
    leastVolume_ = gMin(mesh_.V().field());
    force_ = 0;
    for (const surface& wet : surfaces_)
    {
        force.push_back(forces(wet));
        force_ += gSum(mag(force.back())());
        area += gSum(mesh_.magSf().boundaryField()[wet.id]);
    }
    checkForce(area);
    const stopwatch watch(spar_);
    for (std::size_t i = 0; i < surfaces_.size(); i++)
    {
        const vectorField moment(planar_ ? moments(surfaces_[i], force[i]) : vectorField());
        check(spar_fluid_push_forces(surfaces_[i].fluid, triples(force[i]), triples(moment)));
    }
    int done;
    check(spar_step_check(session_, &done)); // when to stop is OpenFOAM's affair: residualControl
}

const Foam::vectorField& Foam::sparHost::displacement(const word& patch)
{
    const label id = mesh_.boundaryMesh().findPatchID(patch);
    for (surface& wet : surfaces_)
    {
        if (wet.id != id)
        {
            continue;
        }
        if (wet.received == motion_)
        {
            if (open_ && timeIndex_ == mesh_.time().timeIndex())
            {
                push();
            }
            else
            {
                finish(); // at the first corrector of a step: pressure and velocity that the last one ended with
                begin();
            }
            solve();
        }
        wet.received = motion_;
        return wet.displacement;
    }
    refuse("the patch " + patch + " has been added in the run");
    return surfaces_[0].displacement;
}

//- Whether the mesh moves in each corrector is not known beforehand: a step shows it
void Foam::sparHost::checkCorrectors() const
{
    const dictionary control(sparFoam::solution(mesh_).subOrEmptyDict("PIMPLE"));
    if
    (
        solves_ == 1 && steps_ == 0 && control.lookupOrDefault<label>("nOuterCorrectors", 1) > 1
     && !control.lookupOrDefault<Switch>("moveMeshOuterCorrectors", false)
    )
    {
        refuse("the mesh moves once a step, so that the structure is not iterated; set moveMeshOuterCorrectors yes in PIMPLE of"
            " system/fvSolution, or nOuterCorrectors 1 if the coupling is to be explicit");
    }
}

void Foam::sparHost::checkPlane()
{
    scalar out = 0;
    for (const surface& wet : surfaces_)
    {
        out = max(out, gMax(mag(cmptMultiply(wet.position - wet.reference, vector::one - directions_))()));
    }
    if (!leftPlane_ && out > 1e-3*cmptMax(cmptMultiply(mesh_.bounds().span(), vector::one - directions_)))
    {
        leftPlane_ = true;
        Info<< "spar, warning: the structure leaves the plane of the mesh, by " << out << " m at t = " << mesh_.time().value()
            << " s; the flow sees its motion in the plane alone; hold the beam there by `plane` in the case file" << endl;
    }
}

//- Of the step that has been accepted
void Foam::sparHost::watchFlow()
{
    speed_ = max(mag(mesh_.lookupObject<volVectorField>("U"))).value();
    pressure_ = max(mag(mesh_.lookupObject<volScalarField>("p"))).value();
    if (leastVolume_ <= 0)
    {
        refuse("the mesh has folded: a cell has no volume" + flowNow());
    }
    const string file(name_ + "_volumes.txt");
    double t;
    check(spar_session_get_time(session_, &t, nullptr, nullptr));
    if (Pstream::master() && !volumes_)
    {
        if (steps_ == 0 && t < 1.5*mesh_.time().deltaTValue())
        {
            rm(file);
        }
        checkCase(spar_case_cut_history(file.c_str(), t - 0.5*mesh_.time().deltaTValue()));
        volumes_ = fopen(file.c_str(), "a");
    }
    if (volumes_)
    {
        fprintf(volumes_, "%.17g %.6e\n", t, double(leastVolume_));
        fflush(volumes_);
    }
}

void Foam::sparHost::finish()
{
    if (!open_)
    {
        return;
    }
    push();
    checkCorrectors();
    const stopwatch watch(spar_);
    int iterations;
    check(spar_step_accept(session_));
    open_ = false;
    checkCase(spar_case_output(scene_, Pstream::myProcNo(), int(fluids_.size()), fluids_.data()));
    check(spar_session_get_time(session_, nullptr, nullptr, &iterations));
    for (spar_fluid* fluid : fluids_)
    {
        double audit[SPAR_AUDIT_COUNT];
        check(spar_fluid_get_audit(fluid, SPAR_AUDIT_COUNT, audit));
        for (int i = 0; i < 3; i++)
        {
            errors_[i] = max(errors_[i], audit[SPAR_AUDIT_FORCE_ERROR + i]);
        }
    }
    if (planar_)
    {
        checkPlane();
    }
    watchFlow();
    steps_++;
    iterations_ += iterations;
    most_ = max(most_, label(iterations));
}

void Foam::sparHost::save()
{
    if (!mesh_.time().writeTime() || saved_ == mesh_.time().timeIndex())
    {
        return;
    }
    finish();
    saved_ = mesh_.time().timeIndex();
    const fileName file(stateFile(mesh_.time().timeName()));
    if (Pstream::master())
    {
        mkDir(file.path());
    }
    check(spar_session_save(session_, file.c_str()));
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
    if (FILE* f = fopen((name_ + "_summary.txt").c_str(), "w"))
    {
        fprintf(f, "steps %d\niterations_mean %.3f\niterations_most %d\n", int(steps_), double(iterations_)/steps_, int(most_));
        fprintf(f, "force_error %.1e\nmoment_error %.1e\npower_error %.1e\n", errors_[0], errors_[1], errors_[2]);
        fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0], seconds[0]/seconds[1]);
        fclose(f);
    }
}
