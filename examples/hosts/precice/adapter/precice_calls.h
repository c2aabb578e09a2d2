/* The calls of preCICE 3 that the participant makes, by its C bindings (precice/preciceC.h of preCICE), declared here
   so that it compiles without preCICE. Meaning: preCICE's documentation. */
#ifndef PRECICE_CALLS_H
#define PRECICE_CALLS_H

#ifdef __cplusplus
extern "C" {
#endif

void precicec_createParticipant(const char *participant, const char *config, int rank, int ranks);
void precicec_initialize(void);
void precicec_advance(double dt);
void precicec_finalize(void);

int precicec_requiresInitialData(void);
int precicec_requiresWritingCheckpoint(void);
int precicec_requiresReadingCheckpoint(void);
int precicec_isCouplingOngoing(void);
int precicec_isTimeWindowComplete(void);
double precicec_getMaxTimeStepSize(void);

int precicec_getMeshDimensions(const char *mesh);
int precicec_getDataDimensions(const char *mesh, const char *data);
void precicec_setMeshVertices(const char *mesh, int n, const double *x, int *id);
void precicec_setMeshAccessRegion(const char *mesh, const double *box);
int precicec_getMeshVertexSize(const char *mesh);
void precicec_getMeshVertexIDsAndCoordinates(const char *mesh, int n, int *id, double *x);

void precicec_writeData(const char *mesh, const char *data, int n, const int *id, const double *values);
void precicec_readData(const char *mesh, const char *data, int n, const int *id, double relative_time, double *values);

#ifdef __cplusplus
}
#endif

#endif
