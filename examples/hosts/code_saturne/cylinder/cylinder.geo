// A cylinder of D = 1 in a stream, one cell thick: an O-grid in a square, that in a box. gmsh 4.
// -setnumber n: refinement, 1: 4056 cells. Faces: inlet, outlet, sides, cylinder, frontback.
// -setnumber halves 1: half of the cylinder is cylinder_half, the rest cylinder.
If (!Exists(n)) n = 1; EndIf
If (!Exists(halves)) halves = 0; EndIf
R = 0.5; B = 2.5; s = Sqrt(2)/2;                                // radius, half the square
X[] = {-8, -B, B, 20}; Y[] = {-8, -B, B, 8};                    // the box, cut by the square
arc = Ceil(16*n) + 1; ring = Ceil(28*n) + 1; up = Ceil(10*n) + 1; down = Ceil(44*n) + 1; side = Ceil(10*n) + 1;

Point(100) = {0, 0, 0};
For j In {0:3}
  For i In {0:3}
    Point(1 + i + 4*j) = {X[i], Y[j], 0};
  EndFor
EndFor
Point(21) = {-R*s, -R*s, 0}; Point(22) = {R*s, -R*s, 0}; Point(23) = {R*s, R*s, 0}; Point(24) = {-R*s, R*s, 0};

// lines along x: 1 + i + 3 j from point (i, j); along y: 21 + i + 4 j
For j In {0:3}
  For i In {0:2}
    Line(1 + i + 3*j) = {1 + i + 4*j, 2 + i + 4*j};
  EndFor
EndFor
For j In {0:2}
  For i In {0:3}
    Line(21 + i + 4*j) = {1 + i + 4*j, 5 + i + 4*j};
  EndFor
EndFor
For j In {0:3}
  Transfinite Curve{1 + 3*j} = up Using Progression 0.85^(1/n);
  Transfinite Curve{2 + 3*j} = arc;
  Transfinite Curve{3 + 3*j} = down Using Progression 1.03^(1/n);
  Transfinite Curve{21 + j} = side Using Progression 0.85^(1/n);
  Transfinite Curve{25 + j} = arc;
  Transfinite Curve{29 + j} = side Using Progression 0.85^(-1/n);
EndFor

// the ring: arcs 41 to 44 from the lower left, spokes 51 to 54 from the cylinder to the square
corner[] = {6, 7, 11, 10}; edge[] = {5, 27, 8, 26}; from[] = {1, 1, -1, -1};
For k In {0:3}
  Circle(41 + k) = {21 + k, 100, 21 + (k + 1)%4};
  Line(51 + k) = {21 + k, corner[k]};
EndFor
Transfinite Curve{41:44} = arc;
Transfinite Curve{51:54} = ring Using Progression 1.07^(1/n);
For k In {0:3}
  Curve Loop(1 + k) = {41 + k, 51 + (k + 1)%4, -from[k]*edge[k], -(51 + k)};
  Plane Surface(1 + k) = {1 + k};
EndFor
// the box around the square; surface 11 + i + 3 j is its part (i, j)
For j In {0:2}
  For i In {0:2}
    If (i != 1 || j != 1)
      Curve Loop(11 + i + 3*j) = {1 + i + 3*j, 22 + i + 4*j, -(4 + i + 3*j), -(21 + i + 4*j)};
      Plane Surface(11 + i + 3*j) = {11 + i + 3*j};
    EndIf
  EndFor
EndFor

// One cell of span; an extrusion answers the face across, the volume, and the faces over the loop's curves in their order.
inlet[] = {}; outlet[] = {}; sides[] = {}; wall[] = {}; plane[] = {}; fluid[] = {};
For k In {0:3}
  Transfinite Surface{1 + k}; Recombine Surface{1 + k};
  e[] = Extrude {0, 0, 1} { Surface{1 + k}; Layers{1}; Recombine; };
  plane[] += {1 + k, e[0]}; fluid[] += {e[1]}; wall[] += {e[2]};
EndFor
For j In {0:2}
  For i In {0:2}
    If (i != 1 || j != 1)
      Transfinite Surface{11 + i + 3*j}; Recombine Surface{11 + i + 3*j};
      e[] = Extrude {0, 0, 1} { Surface{11 + i + 3*j}; Layers{1}; Recombine; };
      plane[] += {11 + i + 3*j, e[0]}; fluid[] += {e[1]};
      If (i == 0) inlet[] += {e[5]}; EndIf
      If (i == 2) outlet[] += {e[3]}; EndIf
      If (j == 0) sides[] += {e[2]}; EndIf
      If (j == 2) sides[] += {e[4]}; EndIf
    EndIf
  EndFor
EndFor
Physical Surface("inlet", 1) = inlet[];
Physical Surface("outlet", 2) = outlet[];
Physical Surface("sides", 3) = sides[];
If (halves)
  Physical Surface("cylinder", 4) = {wall[0], wall[1]};
  Physical Surface("cylinder_half", 6) = {wall[2], wall[3]};
Else
  Physical Surface("cylinder", 4) = wall[];
EndIf
Physical Surface("frontback", 5) = plane[];
Physical Volume("fluid", 10) = fluid[];
