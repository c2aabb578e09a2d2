// A box around a rotor of D = 126 at the origin, the wind along x: cells of D/10/n about the rotor, growing away from it. gmsh 4.
// Faces: 1 inlet, 2 outlet, 3 sides.
If (!Exists(n)) n = 1; EndIf
D = 126; h = D/10/n;
X[] = {-2*D, -0.5*D, 1*D, 4*D}; Y[] = {-2.2*D, -0.7*D, 0.7*D, 2.2*D};
up = Ceil(7*n); near = Ceil(1.5*D/h); down = Ceil(13*n); side = Ceil(7*n); across = Ceil(1.4*D/h);
// the plane x = -2 D first, then the three pieces of x
For j In {0:3}
  For i In {0:3}
    Point(1 + i + 4*j) = {X[0], Y[i], Y[j]};
  EndFor
EndFor
For j In {0:3}
  For i In {0:2}
    Line(1 + i + 3*j) = {1 + i + 4*j, 2 + i + 4*j};
  EndFor
  Transfinite Curve{1 + 3*j} = side + 1 Using Progression 0.83;
  Transfinite Curve{2 + 3*j} = across + 1;
  Transfinite Curve{3 + 3*j} = side + 1 Using Progression 1/0.83;
EndFor
For j In {0:2}
  For i In {0:3}
    Line(21 + i + 4*j) = {1 + i + 4*j, 5 + i + 4*j};
  EndFor
EndFor
Transfinite Curve{21:24} = side + 1 Using Progression 0.83;
Transfinite Curve{25:28} = across + 1;
Transfinite Curve{29:32} = side + 1 Using Progression 1/0.83;
inlet[] = {}; outlet[] = {}; sides[] = {}; fluid[] = {};
For j In {0:2}
  For i In {0:2}
    s = 1 + i + 3*j;
    Curve Loop(s) = {1 + i + 3*j, 22 + i + 4*j, -(4 + i + 3*j), -(21 + i + 4*j)};
    Plane Surface(s) = {s};
    Transfinite Surface{s}; Recombine Surface{s};
    inlet[] += {s};
  EndFor
EndFor
// layers of the upstream piece shrink towards the rotor, those downstream grow
a[] = {}; c[] = {}; one[] = {};
sum = 0;
For k In {1:up}
  sum += 0.83^k;
EndFor
at = 0;
For k In {1:up}
  at += 0.83^k/sum; a[] += {at}; one[] += {1};
EndFor
sumd = 0;
For k In {1:down}
  sumd += 1.09^k;
EndFor
at = 0; ones[] = {};
For k In {1:down}
  at += 1.09^k/sumd; c[] += {at}; ones[] += {1};
EndFor
For j In {0:2}
  For i In {0:2}
    e[] = Extrude {X[1] - X[0], 0, 0} { Surface{1 + i + 3*j}; Layers{one[], a[]}; Recombine; };
    f[] = Extrude {X[2] - X[1], 0, 0} { Surface{e[0]}; Layers{near}; Recombine; };
    g[] = Extrude {X[3] - X[2], 0, 0} { Surface{f[0]}; Layers{ones[], c[]}; Recombine; };
    fluid[] += {e[1], f[1], g[1]}; outlet[] += {g[0]};
    If (j == 0) sides[] += {e[2], f[2], g[2]}; EndIf
    If (i == 2) sides[] += {e[3], f[3], g[3]}; EndIf
    If (j == 2) sides[] += {e[4], f[4], g[4]}; EndIf
    If (i == 0) sides[] += {e[5], f[5], g[5]}; EndIf
  EndFor
EndFor
Physical Surface("inlet", 1) = inlet[];
Physical Surface("outlet", 2) = outlet[];
Physical Surface("sides", 3) = sides[];
Physical Volume("fluid", 10) = fluid[];
