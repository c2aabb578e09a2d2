#include "sparDisplacementPointPatchVectorField.H"
#include "addToRunTimeSelectionTable.H"
#include "pointFields.H"
#include "pointPatchFields.H"
#include "sparFoam.H"

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const pointPatch& patch,
    const DimensionedField<vector, pointMesh>& field
)
:
    fixedValuePointPatchField<vector>(patch, field),
    density_(1),
    resumes_(false),
    begun_(0)
{}

Foam::sparDisplacementPointPatchVectorField::sparDisplacementPointPatchVectorField
(
    const pointPatch& patch,
    const DimensionedField<vector, pointMesh>& field,
    const dictionary& dict
)
:
    fixedValuePointPatchField<vector>(patch, field, dict),
    structure_(sparFoam::get<fileName>(dict, "structure")),
    member_(sparFoam::get<word>(dict, "member")),
    density_(sparFoam::get<scalar>(dict, "density")),
    resumes_(dict.found("begun")),
    begun_(resumes_ ? sparFoam::get<scalar>(dict, "begun") : 0)
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
    resumes_(other.resumes_),
    begun_(other.begun_)
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
    resumes_(other.resumes_),
    begun_(other.begun_)
{}

Foam::fileName Foam::sparDisplacementPointPatchVectorField::caseFile() const
{
    fileName file(structure_);
    return file.expand();
}

void Foam::sparDisplacementPointPatchVectorField::makeHost()
{
    typedef sparDisplacementPointPatchVectorField own;
    const fvMesh& mesh = refCast<const fvMesh>(internalField().mesh()());
    const pointVectorField& field = mesh.lookupObject<pointVectorField>(internalField().name());
    std::vector<sparHost::wetted> patches;
    forAll(field.boundaryField(), i)
    {
        if (!isA<own>(field.boundaryField()[i]))
        {
            continue;
        }
        const own& other = refCast<const own>(field.boundaryField()[i]);
        if (other.caseFile() != caseFile())
        {
            continue;
        }
        if (other.resumes_ != resumes_ || other.begun_ != begun_)
        {
            FatalErrorInFunction<< "spar: the entries `begun` of the patches " << patch().name() << " and "
                << other.patch().name() << " differ; all patches of a structure start or go on together" << exit(FatalError);
        }
        if (!resumes_ && gMax(mag(other)()) > 0)
        {
            FatalErrorInFunction<< "spar: the patch " << other.patch().name() << " starts displaced, by "
                << gMax(mag(other)()) << " m, and has no entry `begun` of a saved structure to go on from; give value uniform"
                << " (0 0 0), or the pointDisplacement that the coupled run has written" << exit(FatalError);
        }
        patches.push_back({other.patch().name(), other.member_, other.density_});
    }
    host_ = sparHost::make(mesh, caseFile(), patches, resumes_, begun_);
}

void Foam::sparDisplacementPointPatchVectorField::updateCoeffs()
{
    if (updated())
    {
        return;
    }
    const fvMesh& mesh = refCast<const fvMesh>(internalField().mesh()());
    // asked for before the first step too, when there is no flow
    if (mesh.time().timeIndex() > mesh.time().startTimeIndex() && mesh.foundObject<volVectorField>("U"))
    {
        if (!host_)
        {
            host_ = sparHost::find(mesh, caseFile());
        }
        if (!host_)
        {
            makeHost();
        }
        Field<vector>::operator=(host_->displacement(patch().name()));
    }
    fixedValuePointPatchField<vector>::updateCoeffs();
}

void Foam::sparDisplacementPointPatchVectorField::write(Ostream& os) const
{
    if (host_)
    {
        host_->save();
    }
    pointPatchField<vector>::write(os);
    sparFoam::write(os, "structure", structure_);
    sparFoam::write(os, "member", member_);
    sparFoam::write(os, "density", density_);
    if (host_ || resumes_)
    {
        const int digits = os.precision(17);
        sparFoam::write(os, "begun", host_ ? host_->begun() : begun_);
        os.precision(digits);
    }
#if SPAR_FOAM_FOUNDATION
    writeEntry(os, "value", *this);
#else
    writeEntry("value", os);
#endif
}

namespace Foam
{

makePointPatchTypeField(pointPatchVectorField, sparDisplacementPointPatchVectorField);

}
