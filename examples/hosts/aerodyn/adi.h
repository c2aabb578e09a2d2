/* The entry points of OpenFAST's AeroDyn-InflowWind library (libaerodyn_inflow_c_binding) that the adapter calls, as
   they are in its versions 4.2.0 to 5.0.0. The library is the user's own; these declarations are ours. Arguments are
   Fortran's, by reference. Matrices are row-major, local to global (columns are the local axes), as the library takes
   them with transpose = 0. Status: 0 to 3 goes on, 4 is fatal. Names have room
   for ADI_TEXT characters, messages for ADI_MESSAGE (OpenFAST's ErrMsgLen + 1), both with a 0 at the end. */
#ifndef ADI_H
#define ADI_H

#ifdef __cplusplus
extern "C" {
#endif

enum { ADI_TEXT = 1025, ADI_MESSAGE = 8197, ADI_FATAL = 4, ADI_CHANNELS = 8000, ADI_CHANNEL_TEXT = 20 };

/* Once: turbines, the environment, pictures (0: none). */
void ADI_C_PreInit(const int *turbines, const int *transpose, const int *point_loads, const float *gravity,
                   const float *density, const float *viscosity, const float *sound, const float *pressure,
                   const float *vapour, const float *depth, const float *sea_level, const int *hydrokinetic,
                   const int *external_flow, const char vtk_folder[ADI_TEXT], const int *vtk, const int *vtk_kind,
                   const double *vtk_dt, const float vtk_nacelle[6], const float *vtk_hub_radius, const int *debug,
                   int *status, char message[ADI_MESSAGE]);
/* Turbine i (from 1) in the reference: places [3], matrices [9]; blade_of: of each mesh point, from 1. */
void ADI_C_SetupRotor(const int *i, const int *horizontal, const float origin[3], const float hub[3],
                      const double hub_axes[9], const float nacelle[3], const double nacelle_axes[9], const int *blades,
                      const float *root, const double *root_axes, const int *points, const float *place,
                      const double *axes, const int *blade_of, int *status, char message[ADI_MESSAGE]);
/* Reads the files (passed 0: the text is a path) and takes all memory. channel_names, channel_units: of ADI_CHANNELS
   times ADI_CHANNEL_TEXT + 1. */
void ADI_C_Init(const int *aerodyn_passed, const char *const *aerodyn, const int *aerodyn_length,
                const int *inflow_passed, const char *const *inflow, const int *inflow_length,
                const char output[ADI_TEXT], const int *order, const double *dt, const double *seconds,
                const int *keep_hub_wind, const int *write, const double *write_dt, int *channels, char *channel_names,
                char *channel_units, int *status, char message[ADI_MESSAGE]);
/* Motion at the time of the next UpdateStates' end or CalcOutput: velocities and accelerations [6], turning behind. */
void ADI_C_SetRotorMotion(const int *i, const float hub[3], const double hub_axes[9], const float hub_v[6],
                          const float hub_a[6], const float nacelle[3], const double nacelle_axes[9],
                          const float nacelle_v[6], const float nacelle_a[6], const float *root,
                          const double *root_axes, const float *root_v, const float *root_a, const int *points,
                          const float *place, const double *axes, const float *v, const float *a, int *status,
                          char message[ADI_MESSAGE]);
/* States from t to t_next; with the t of the call before: the same step once more. */
void ADI_C_UpdateStates(const double *t, const double *t_next, int *status, char message[ADI_MESSAGE]);
void ADI_C_CalcOutput(const double *t, float *channel_values, int *status, char message[ADI_MESSAGE]);
/* load[points][6]: force and moment, global. */
void ADI_C_GetRotorLoads(const int *i, const int *points, float *load, float hub_wind[3], int *status,
                         char message[ADI_MESSAGE]);
void ADI_C_End(int *status, char message[ADI_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
