------- OpenFAST, small numbers of spar's own ------
rotor of 80 m
2   CompElast   - 2: ElastoDyn, BeamDyn for blades
0   CompInflow   - none
2   CompAero   - AeroDyn
0   CompServo   - none
0   CompHydro   - none
0   CompSub   - none
0   MHK   - no marine turbine
1.2   AirDens   - kg/m^3
"elastodyn.dat"   EDFile   - ElastoDyn
"beamdyn.dat"   BDBldFile(1)   - blade 1
"aerodyn.dat"   AeroFile   - AeroDyn
