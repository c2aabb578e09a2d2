#include "sparDisplacementPointPatchVectorField.H"
#include "addToRunTimeSelectionTable.H"
#include "pointPatchFields.H"
#include "surfaceFields.H"
#include "turbulentTransportModel.H"
#include "volFields.H"

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const pointPatch& patch,
    const DimensionedField<vector, pointMesh>& field
)
:
    fixedValuePointPatchField<vector>(patch, field),
    density_(1),
    timeIndex_(-1)
{}

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const pointPatch& patch,
    const DimensionedField<vector, pointMesh>& field,
    const dictionary& dict
)
:
    fixedValuePointPatchField<vector>(patch, field, dict),
    structure_(dict.get<fileName>("structure")),
    member_(dict.get<word>("member")),
    density_(dict.get<scalar>("density")),
    timeIndex_(-1)
{}

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const sparDisplacementPointPatchVectorField& other,
    const pointPatch& patch,
    const DimensionedField<vector, pointMesh>& field,
    const pointPatchFieldMapper& mapper
)
:
    fixedValuePointPatchField<vector>(other, patch, field, mapper),
    structure_(other.structure_),
    member_(other.member_),
    density_(other.density_),
    timeIndex_(-1)
{}

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const sparDisplacementPointPatchVectorField& other,
    const DimensionedField<vector, pointMesh>& field
)
:
    fixedValuePointPatchField<vector>(other, field),
    structure_(other.structure_),
    member_(other.member_),
    density_(other.density_),
    timeIndex_(-1)
{}

void Foam::sparDisplacementPointPatchVectorField::start()
{
    const polyBoundaryMesh& patches = internalField().mesh()().boundaryMesh();
    const vectorField centres(patches[patches.findPatchID(patch().name())].faceCentres());
    fileName structure(structure_);
    host_.reset(new sparHost(structure.expand(), member_, patch().localPoints(), centres));
}

Foam::tmp<Foam::vectorField> Foam::sparDisplacementPointPatchVectorField::forces() const
{
    const fvMesh& mesh = refCast<const fvMesh>(internalField().mesh()());
    const label id = mesh.boundaryMesh().findPatchID(patch().name());
    const incompressible::turbulenceModel& turbulence =
        mesh.lookupObject<incompressible::turbulenceModel>(turbulenceModel::propertiesName);
    const vectorField& area = mesh.Sf().boundaryField()[id];
    const scalarField& p = mesh.lookupObject<volScalarField>("p").boundaryField()[id]; // over density
    return density_*(area*p + (area & turbulence.devReff()().boundaryField()[id]));
}

void Foam::sparDisplacementPointPatchVectorField::updateCoeffs()
{
    if (updated())
    {
        return;
    }
    const polyMesh& mesh = internalField().mesh()();
    const Time& time = mesh.time();
    // asked for before the first step too, when there is no flow
    if (time.timeIndex() > 0 && mesh.foundObject<volVectorField>("U"))
    {
        if (!host_.valid())
        {
            start();
        }
        else
        {
            host_->push(forces()); // at the first corrector of a step: pressure and velocity that the last one ended with
        }
        if (timeIndex_ != time.timeIndex())
        {
            if (timeIndex_ >= 0)
            {
                host_->accept();
            }
            host_->begin(time.deltaTValue());
            timeIndex_ = time.timeIndex();
        }
        Field<vector>::operator=(host_->solve());
    }
    fixedValuePointPatchField<vector>::updateCoeffs();
}

void Foam::sparDisplacementPointPatchVectorField::write(Ostream& os) const
{
    pointPatchField<vector>::write(os);
    os.writeEntry("structure", structure_);
    os.writeEntry("member", member_);
    os.writeEntry("density", density_);
    writeEntry("value", os);
}

namespace Foam
{

makePointPatchTypeField(pointPatchVectorField, sparDisplacementPointPatchVectorField);

}
