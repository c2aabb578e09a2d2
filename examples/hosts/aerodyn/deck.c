#include "deck.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const double pi = 3.14159265358979323846;

static const char *const general[] = {
    "------- AERODYN INPUT FILE ------------------------------------------------------------------------",
    "NREL 5-MW rotor, written by examples/hosts/aerodyn of spar",
    "======  General Options  ==========================================================================",
    "False       Echo              - Echo the input",
    "\"default\"   DTAero            - Time interval for aerodynamic calculations (s)",
    "1           Wake_Mod          - Wake/induction model {0=none, 1=BEMT, 3=OLAF}",
    "0           TwrPotent         - Tower influence by potential flow",
    "0           TwrShadow         - Tower shadow",
    "False       TwrAero           - Tower aerodynamic loads",
    "False       CavitCheck        - Cavitation check",
    "False       NacelleDrag       - Nacelle drag",
    "False       CompAA            - Aeroacoustics",
    "\"unused\"    AA_InputFile      - Aeroacoustics input file",
    "======  Environmental Conditions  =================================================================",
    "\"default\"   AirDens           - Air density (kg/m^3)",
    "\"default\"   KinVisc           - Kinematic viscosity (m^2/s)",
    "\"default\"   SpdSound          - Speed of sound (m/s)",
    "\"default\"   Patm              - Atmospheric pressure (Pa)",
    "\"default\"   Pvap              - Vapour pressure (Pa)",
    "======  Blade-Element/Momentum Theory Options  ====================================================",
    "1           BEM_Mod           - BEM model {1=legacy; the library projects for no other}",
    "--- Skew correction",
    "0           Skew_Mod          - Skew model {0=none}",
    "False       SkewMomCorr       - Skew momentum correction",
    "0           SkewRedistr_Mod   - Redistribution {0=none}",
    "\"default\"   SkewRedistrFactor - Constant of the Pitt/Peters model",
    "--- BEM algorithm",
    "True        TipLoss           - Prandtl's tip loss",
    "True        HubLoss           - Prandtl's hub loss",
    "True        TanInd            - Tangential induction",
    "False       AIDrag            - Drag in the axial induction",
    "False       TIDrag            - Drag in the tangential induction",
    "\"default\"   IndToler          - Tolerance of the inductions",
    "100         MaxIter           - Most iterations",
    "--- Shear correction",
    "False       SectAvg           - Sector averaging",
    "1           SectAvgWeighting  - Weighting",
    "5           SectAvgNPoints    - Points per sector",
    "-60         SectAvgPsiBwd     - Backward azimuth",
    "60          SectAvgPsiFwd     - Forward azimuth",
    "--- Dynamic wake/inflow",
    "0           DBEMT_Mod         - Dynamic wake {0=none}",
    "20          tau1_const        - Its time constant (s)",
    "======  OLAF  =====================================================================================",
    "\"unused\"    OLAFInputFileName - Input file of OLAF",
    "======  Unsteady Airfoil Aerodynamics Options  ====================================================",
    "False       AoA34             - Angle of attack at 3/4 chord",
    "0           UA_Mod            - Unsteady model {0=quasi-steady}",
    "True        FLookup           - Lookup for f'",
    "3           IntegrationMethod - Of the unsteady model",
    "0           UAStartRad        - Where it starts",
    "1           UAEndRad          - Where it ends",
    "======  Airfoil Information  ======================================================================",
    "1           AFTabMod          - Interpolation {1=in the angle of attack}",
    "1           InCol_Alfa        - Column of the angle of attack",
    "2           InCol_Cl          - Column of lift",
    "3           InCol_Cd          - Column of drag",
    "4           InCol_Cm          - Column of the moment",
    "0           InCol_Cpmin       - Column of the least pressure, 0: none"};

static const char *const rest[] = {
    "======  Hub Properties  ===========================================================================",
    "0           VolHub            - Hub volume (m^3)",
    "0           HubCenBx          - Its centre of buoyancy (m)",
    "======  Nacelle Properties  =======================================================================",
    "0           VolNac            - Nacelle volume (m^3)",
    "0, 0, 0     NacCenB           - Its centre of buoyancy (m)",
    "0, 0, 0     NacArea           - Its areas (m^2)",
    "0, 0, 0     NacCd             - Its drag coefficients",
    "0, 0, 0     NacDragAC         - Where its drag acts (m)",
    "======  Tail Fin Aerodynamics  ====================================================================",
    "False       TFinAero          - Tail fin",
    "\"unused\"    TFinFile          - Its input file",
    "======  Tower Influence and Aerodynamics  =========================================================",
    "0           NumTwrNds         - Number of tower nodes",
    "TwrElev     TwrDiam     TwrCd     TwrTI     TwrCb     TwrCp     TwrCa",
    "(m)         (m)         (-)       (-)       (-)       (-)       (-)",
    "======  Outputs  ==================================================================================",
    "False       SumPrint          - Summary file",
    "0           NBlOuts           - Number of blade nodes with outputs",
    "1           BlOutNd           - Blade nodes with outputs",
    "0           NTwOuts           - Number of tower nodes with outputs",
    "1           TwOutNd           - Tower nodes with outputs",
    "            OutList           - Output channels",
    "\"RtAeroFxh, RtAeroMxh, RtAeroPwr\"",
    "END of OutList section",
    "---------------------------------------------------------------------------------------------------"};

static const char *const steady[] = {
    "90          RefHt          - Reference height (m)",
    "0           PLexp          - Power law exponent (-)",
    "================== Uniform wind file [used only for WindType = 2] ==================================",
    "\"unused\"    FileName_Uni   - Filename",
    "90          RefHt_Uni      - Reference height (m)",
    "125.88      RefLength      - Reference length (m)",
    "================== Binary TurbSim files [used only for WindType = 3] ===============================",
    "\"unused\"    FileName_BTS   - Filename",
    "================== Binary Bladed files [used only for WindType = 4] ================================",
    "\"unused\"    FileNameRoot   - Root of the filenames",
    "False       TowerFile      - Have tower file",
    "================== HAWC files [used only for WindType = 5] =========================================",
    "\"unused\"    FileName_u     - u",
    "\"unused\"    FileName_v     - v",
    "\"unused\"    FileName_w     - w",
    "64          nx             - Grids along x",
    "32          ny             - Grids along y",
    "32          nz             - Grids along z",
    "16          dx             - Distance along x (m)",
    "3           dy             - Distance along y (m)",
    "3           dz             - Distance along z (m)",
    "90          RefHt_Hawc     - Reference height (m)",
    "  -------------   Scaling parameters for turbulence   ---------------------------------------------",
    "0           ScaleMethod    - Scaling {0=none}",
    "1           SFx            - Factor along x",
    "1           SFy            - Factor along y",
    "1           SFz            - Factor along z",
    "12          SigmaFx        - Deviation along x (m/s)",
    "8           SigmaFy        - Deviation along y (m/s)",
    "2           SigmaFz        - Deviation along z (m/s)",
    "  -------------   Mean wind profile parameters (added to HAWC-format files)   ---------------------",
    "5           URef           - Mean wind (m/s)",
    "2           WindProfile    - Profile",
    "0           PLExp_Hawc     - Power law exponent",
    "0.03        Z0             - Roughness (m)",
    "0           XOffset        - Offset (m)",
    "================== LIDAR Parameters ================================================================",
    "0           SensorType          - Lidar {0=none}",
    "0           NumPulseGate        - Gates",
    "30          PulseSpacing        - Spacing (m)",
    "0           NumBeam             - Beams",
    "-200        FocalDistanceX      - Focal distance (m)",
    "0           FocalDistanceY      - Focal distance (m)",
    "0           FocalDistanceZ      - Focal distance (m)",
    "0.0 0.0 0.0 RotorApexOffsetPos  - Offset (m)",
    "17          URefLid             - Mean wind (m/s)",
    "0.25        MeasurementInterval - Interval (s)",
    "False       LidRadialVel        - Radial component",
    "1           ConsiderHubMotion   - Hub motion",
    "================== OUTPUT ==========================================================================",
    "False       SumPrint       - Summary",
    "            OutList        - Output channels",
    "END of input file",
    "---------------------------------------------------------------------------------------------------"};

static void write_lines(FILE *file, int n, const char *const *lines) {
    for (int i = 0; i < n; i++) {
        fprintf(file, "%s\n", lines[i]);
    }
}

#define LINES(file, array) write_lines(file, (int)(sizeof array / sizeof array[0]), array)

static FILE *begin(nrel5mw *data, const char *folder, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        snprintf(data->message, sizeof data->message, "%.300s cannot be written: %s", path, strerror(errno));
    }
    return file;
}

static int end(nrel5mw *data, FILE *file, const char *name) {
    const int bad = ferror(file);
    if (fclose(file) != 0 || bad) {
        snprintf(data->message, sizeof data->message, "%.300s cannot be written to its end", name);
        return SPAR_ERR_IO;
    }
    return SPAR_OK;
}

static int write_primary(nrel5mw *data, const char *folder) {
    FILE *file = begin(data, folder, "AeroDyn.dat");
    if (!file) {
        return SPAR_ERR_IO;
    }
    LINES(file, general);
    fprintf(file, "%-11d NumAFfiles        - Number of airfoil files\n", data->polar_n);
    for (int i = 0; i < data->polar_n; i++) {
        fprintf(file, "\"%s.dat\"%s\n", data->polar[i].name, i == 0 ? "   AFNames - Airfoil files" : "");
    }
    fprintf(file, "======  Rotor/Blade Properties  ===================================================\n");
    fprintf(file, "True        UseBlCm           - Pitching moment\n");
    for (int b = 0; b < data->blades; b++) {
        fprintf(file, "\"blade.dat\" ADBlFile(%d)       - Blade\n", b + 1);
    }
    LINES(file, rest);
    return end(data, file, "AeroDyn.dat");
}

static int write_blade(nrel5mw *data, const char *folder) {
    FILE *file = begin(data, folder, "blade.dat");
    if (!file) {
        return SPAR_ERR_IO;
    }
    fprintf(file,
            "------- AERODYN BLADE DEFINITION INPUT FILE -------\nNREL 5-MW blade, written by spar\n"
            "======  Blade Properties  ======\n%lld  NumBlNds - Number of blade nodes\n"
            "BlSpn BlCrvAC BlSwpAC BlCrvAng BlTwist BlChord BlAFID\n(m) (m) (m) (deg) (deg) (m) (-)\n",
            (long long)data->aero_n);
    for (int64_t i = 0; i < data->aero_n; i++) {
        fprintf(file, "%.9g %.9g %.9g 0 %.9g %.9g %d\n", data->span[i], data->curve[i], data->sweep[i],
                data->twist[i] * 180 / pi, data->chord[i], data->polar_of[i] + 1);
    }
    return end(data, file, "blade.dat");
}

static int write_polar(nrel5mw *data, const char *folder, const nrel5mw_polar *polar) {
    char name[64];
    snprintf(name, sizeof name, "%s.dat", polar->name);
    FILE *file = begin(data, folder, name);
    if (!file) {
        return SPAR_ERR_IO;
    }
    fprintf(
        file,
        "! Polar %s, written by spar\n1  InterpOrd ! 1=linear\n1  NonDimArea ! area/chord^2\n"
        "0  NumCoords ! shape\n\"unused\"  BL_file ! boundary layer\n1  NumTabs ! tables\n"
        "1  Re ! millions\n0  UserProp ! setting\nFalse  InclUAdata ! unsteady coefficients\n%lld  NumAlf ! lines\n",
        polar->name, (long long)polar->n);
    for (int64_t i = 0; i < polar->n; i++) {
        fprintf(file, "%.9g %.9g %.9g %.9g\n", polar->alpha[i] * 180 / pi, polar->cl[i], polar->cd[i], polar->cm[i]);
    }
    return end(data, file, name);
}

static int write_inflow(nrel5mw *data, const char *folder, double wind) {
    FILE *file = begin(data, folder, "InflowWind.dat");
    if (!file) {
        return SPAR_ERR_IO;
    }
    fprintf(
        file,
        "------- InflowWind INPUT FILE -------\nSteady wind, written by spar\n-------\n"
        "False       Echo           - Echo\n1           WindType       - 1=steady\n"
        "0           PropagationDir - Direction (deg)\n0           VFlowAng       - Upflow angle (deg)\n"
        "False       VelInterpCubic - Cubic interpolation\n1           NWindVel       - Points of output\n"
        "0           WindVxiList    - X (m)\n0           WindVyiList    - Y (m)\n90          WindVziList    - Z (m)\n"
        "================== Steady wind [used only for WindType = 1] ==================\n"
        "%-11.9g HWindSpeed     - Horizontal wind speed (m/s)\n",
        wind);
    LINES(file, steady);
    return end(data, file, "InflowWind.dat");
}

int deck_write(nrel5mw *data, const char *folder, double wind) {
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        snprintf(data->message, sizeof data->message, "%.300s cannot be made: %s", folder, strerror(errno));
        return SPAR_ERR_IO;
    }
    int status = write_primary(data, folder);
    status = status ? status : write_blade(data, folder);
    for (int i = 0; i < data->polar_n && status == SPAR_OK; i++) {
        status = write_polar(data, folder, &data->polar[i]);
    }
    return status ? status : write_inflow(data, folder, wind);
}
