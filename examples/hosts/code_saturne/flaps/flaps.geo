// A channel of height 2 with two flaps of height 0.5 and thickness 0.1, one on each wall, a slab one cell thick. gmsh 4.
// -setnumber n: refinement, 1: 1920 cells. Faces: 1 inlet, 2 outlet, 3 walls, 5 front and back, 6 and 8 sides and tip of the
// lower flap, 7 the upper flap.
If (!Exists(n)) n = 1; EndIf
span = 0.1;
X[] = {0, 1.2, 1.3, 5}; Y[] = {0, 0.5, 1.5, 2}; // the channel, cut along the flaps
nx[] = {Ceil(16*n), Ceil(4*n), Ceil(28*n)}; ny[] = {Ceil(12*n), Ceil(16*n), Ceil(12*n)};
For j In {0:3}
  For i In {0:3}
    Point(1 + i + 4*j) = {X[i], Y[j], 0};
  EndFor
EndFor
// lines along x: 1 + i + 3 j from point (i, j); along y: 21 + i + 4 j
For j In {0:3}
  For i In {0:2}
    Line(1 + i + 3*j) = {1 + i + 4*j, 2 + i + 4*j};
  EndFor
  Transfinite Curve{1 + 3*j} = nx[0] + 1 Using Progression 0.9^(1/n);
  Transfinite Curve{2 + 3*j} = nx[1] + 1;
  Transfinite Curve{3 + 3*j} = nx[2] + 1 Using Progression 1.1^(1/n);
EndFor
For j In {0:2}
  For i In {0:3}
    Line(21 + i + 4*j) = {1 + i + 4*j, 5 + i + 4*j};
    Transfinite Curve{21 + i + 4*j} = ny[j] + 1;
  EndFor
EndFor
inlet[] = {}; outlet[] = {}; walls[] = {}; plane[] = {}; side[] = {}; tip[] = {}; upper[] = {}; fluid[] = {};
For j In {0:2}
  For i In {0:2}
    If (i != 1 || j == 1) // the flaps are no fluid
      k = 1 + i + 3*j;
      Curve Loop(k) = {1 + i + 3*j, 22 + i + 4*j, -(4 + i + 3*j), -(21 + i + 4*j)};
      Plane Surface(k) = {k};
      Transfinite Surface{k}; Recombine Surface{k};
      // an extrusion answers the face across, the volume, and the faces over the loop's curves in their order
      e[] = Extrude {0, 0, span} { Surface{k}; Layers{1}; Recombine; };
      plane[] += {k, e[0]}; fluid[] += {e[1]};
      If (i == 0) inlet[] += {e[5]}; EndIf
      If (i == 2) outlet[] += {e[3]}; EndIf
      If (j == 0) walls[] += {e[2]}; EndIf
      If (j == 2) walls[] += {e[4]}; EndIf
      If (i == 0 && j == 0) side[] += {e[3]}; EndIf
      If (i == 2 && j == 0) side[] += {e[5]}; EndIf
      If (i == 0 && j == 2) upper[] += {e[3]}; EndIf
      If (i == 2 && j == 2) upper[] += {e[5]}; EndIf
      If (i == 1) tip[] += {e[2]}; upper[] += {e[4]}; EndIf
    EndIf
  EndFor
EndFor
Physical Surface("inlet", 1) = inlet[];
Physical Surface("outlet", 2) = outlet[];
Physical Surface("walls", 3) = walls[];
Physical Surface("frontback", 5) = plane[];
Physical Surface("lower", 6) = side[];
Physical Surface("upper", 7) = upper[];
Physical Surface("tip", 8) = tip[];
Physical Volume("fluid", 10) = fluid[];
