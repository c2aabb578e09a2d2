// Turek and Hron's channel with cylinder and flag, a slab one cell thick. gmsh 4.
// -setnumber n: refinement, 1: 9212 cells, 0.6: 3390. Faces: 1 inlet, 2 outlet, 3 walls, 4 cylinder, 5 front and back, 6 flag.
If (!Exists(n)) n = 1; EndIf
span = 0.01; h = 0.01; cx = 0.2; cy = 0.2; r = 0.05; L = 2.5; H = 0.41; B = 0.1; tip = 0.6; // h: half the flag's thickness
around = Ceil(20*n) + 1; ring = Ceil(14*n) + 1; beside = Ceil(20*n) + 1; along = Ceil(40*n) + 1; end = Ceil(8*n) + 1;
wake = Ceil(69*n) + 1; wall = Ceil(10*n) + 1; front = Ceil(8*n) + 1;
s = Sqrt(2)/2; root = cx + Sqrt(r*r - h*h);

Point(1) = {cx, cy, 0};
// on the cylinder, from the flag's lower corner against the clock's sense
Point(2) = {root, cy - h, 0}; Point(3) = {root, cy + h, 0}; Point(4) = {cx + r*s, cy + r*s, 0};
Point(5) = {cx - r*s, cy + r*s, 0}; Point(6) = {cx - r*s, cy - r*s, 0}; Point(7) = {cx + r*s, cy - r*s, 0};
// the square around it, the flag's tip, the square carried on to the tip and to the outlet
Point(8) = {cx + B, cy - h, 0}; Point(9) = {cx + B, cy + h, 0};
Point(10) = {cx + B, cy + B, 0}; Point(11) = {cx - B, cy + B, 0}; Point(12) = {cx - B, cy - B, 0}; Point(13) = {cx + B, cy - B, 0};
Point(14) = {tip, cy - h, 0}; Point(15) = {tip, cy + h, 0}; Point(16) = {tip, cy + B, 0}; Point(17) = {tip, cy - B, 0};
Point(18) = {L, cy - h, 0}; Point(19) = {L, cy + h, 0}; Point(20) = {L, cy + B, 0}; Point(21) = {L, cy - B, 0};
// the channel
Point(22) = {0, 0, 0}; Point(23) = {cx - B, 0, 0}; Point(24) = {cx + B, 0, 0}; Point(25) = {tip, 0, 0}; Point(26) = {L, 0, 0};
Point(27) = {0, H, 0}; Point(28) = {cx - B, H, 0}; Point(29) = {cx + B, H, 0}; Point(30) = {tip, H, 0}; Point(31) = {L, H, 0};
Point(32) = {0, cy - B, 0}; Point(33) = {0, cy + B, 0};

Circle(1) = {3, 1, 4}; Circle(2) = {4, 1, 5}; Circle(3) = {5, 1, 6}; Circle(4) = {6, 1, 7}; Circle(5) = {7, 1, 2};
Line(6) = {9, 10}; Line(7) = {10, 11}; Line(8) = {11, 12}; Line(9) = {12, 13}; Line(10) = {13, 8};
Line(11) = {3, 9}; Line(12) = {4, 10}; Line(13) = {5, 11}; Line(14) = {6, 12}; Line(15) = {7, 13}; Line(16) = {2, 8};
Line(17) = {9, 15}; Line(18) = {8, 14}; Line(19) = {10, 16}; Line(20) = {13, 17};
Line(21) = {14, 15}; Line(22) = {15, 16}; Line(23) = {17, 14};
Line(24) = {14, 18}; Line(25) = {15, 19}; Line(26) = {16, 20}; Line(27) = {17, 21};
Line(28) = {18, 19}; Line(29) = {19, 20}; Line(30) = {21, 18};
Line(31) = {22, 23}; Line(32) = {23, 24}; Line(33) = {24, 25}; Line(34) = {25, 26};
Line(35) = {27, 28}; Line(36) = {28, 29}; Line(37) = {29, 30}; Line(38) = {30, 31};
Line(39) = {22, 32}; Line(40) = {32, 33}; Line(41) = {33, 27};
Line(42) = {23, 12}; Line(43) = {24, 13}; Line(44) = {25, 17}; Line(45) = {26, 21};
Line(46) = {11, 28}; Line(47) = {10, 29}; Line(48) = {16, 30}; Line(49) = {20, 31};
Line(50) = {32, 12}; Line(51) = {33, 11};
Transfinite Curve{1, 5} = beside;
Transfinite Curve{6, 22, 29} = beside Using Progression 1.08^(1/n);
Transfinite Curve{10, 23, 30} = beside Using Progression 1.08^(-1/n);
Transfinite Curve{2, 3, 4, 7, 8, 9, 32, 36, 40} = around;
Transfinite Curve{11:16} = ring Using Progression 1.1^(1/n);
Transfinite Curve{17, 18, 19, 20, 33, 37} = along Using Bump 0.5;
Transfinite Curve{21, 28} = end;
Transfinite Curve{24:27, 34, 38} = wake Using Progression 1.036^(1/n);
Transfinite Curve{31, 35, 50, 51} = front;
Transfinite Curve{39, 41, 42:49} = wall Using Bump 0.4;

// which group the face over a curve belongs to; 0: none, it is inside
group[] = {};
For c In {0:51}
  group[] += {0};
EndFor
For c In {39:41}
  group[c] = 1;
EndFor
group[28] = 2; group[29] = 2; group[30] = 2; group[45] = 2; group[49] = 2;
For c In {31:38}
  group[c] = 3;
EndFor
For c In {1:5}
  group[c] = 4;
EndFor
group[11] = 6; group[16] = 6; group[17] = 6; group[18] = 6; group[21] = 6;

loop[] = {1, 12, -6, -11, 2, 13, -7, -12, 3, 14, -8, -13, 4, 15, -9, -14, 5, 16, -10, -15, // around the cylinder
    17, 22, -19, -6, 20, 23, -18, -10,                                                   // beside the flag
    24, 28, -25, -21, 25, 29, -26, -22, 27, 30, -24, -23,                                // behind it
    31, 42, -50, -39, 50, -8, -51, -40, 51, 46, -35, -41,                                // at the inlet
    32, 43, -9, -42, -7, 47, -36, -46, 33, 44, -20, -43, 19, 48, -37, -47, 34, 45, -27, -44, 26, 49, -38, -48}; // at the walls
f1[] = {}; f2[] = {}; f3[] = {}; f4[] = {}; f5[] = {}; f6[] = {}; fluid[] = {};
For k In {0:18}
  Curve Loop(1 + k) = {loop[4*k], loop[4*k + 1], loop[4*k + 2], loop[4*k + 3]};
  Plane Surface(1 + k) = {1 + k};
  Transfinite Surface{1 + k}; Recombine Surface{1 + k};
EndFor
For k In {0:18}
  // an extrusion answers the face across, the volume, and the faces over the loop's curves in their order
  e[] = Extrude {0, 0, span} { Surface{1 + k}; Layers{1}; Recombine; };
  fluid[] += {e[1]}; f5[] += {1 + k, e[0]};
  For i In {0:3}
    g = group[Fabs(loop[4*k + i])];
    If (g == 1) f1[] += {e[2 + i]}; EndIf
    If (g == 2) f2[] += {e[2 + i]}; EndIf
    If (g == 3) f3[] += {e[2 + i]}; EndIf
    If (g == 4) f4[] += {e[2 + i]}; EndIf
    If (g == 6) f6[] += {e[2 + i]}; EndIf
  EndFor
EndFor
Physical Surface("inlet", 1) = f1[];
Physical Surface("outlet", 2) = f2[];
Physical Surface("walls", 3) = f3[];
Physical Surface("cylinder", 4) = f4[];
Physical Surface("frontback", 5) = f5[];
Physical Surface("flag", 6) = f6[];
Physical Volume("fluid", 10) = fluid[];
