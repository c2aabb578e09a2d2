// A hub of radius 0.15 at the origin with three blades of length 0.5 and thickness 0.06, a slab one cell thick, in a wide stream.
// gmsh 4. -setnumber n: refinement. Faces: 1 inlet, 2 outlet, 3 sides, 4 hub, 5 front and back, 6 to 8 the blades at 90, 210 and 330
// degrees.
If (!Exists(n)) n = 1; EndIf
span = 0.1; R = 0.15; h = 0.03; tip = 0.65; // h: half a blade's thickness
root = Sqrt(R*R - h*h);
Point(1) = {-3, -3, 0}; Point(2) = {7, -3, 0}; Point(3) = {7, 3, 0}; Point(4) = {-3, 3, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Point(5) = {0, 0, 0};
For i In {0:2}
  c = Cos(Pi/2 + 2*Pi*i/3); s = Sin(Pi/2 + 2*Pi*i/3);
  Point(10 + 4*i) = {root*c + h*s, root*s - h*c, 0}; Point(11 + 4*i) = {tip*c + h*s, tip*s - h*c, 0};
  Point(12 + 4*i) = {tip*c - h*s, tip*s + h*c, 0}; Point(13 + 4*i) = {root*c - h*s, root*s + h*c, 0};
EndFor
// against the clock's sense: up one side of a blade, over its tip, down the other side, along the hub to the next
wall[] = {};
For i In {0:2}
  Line(10 + 4*i) = {10 + 4*i, 11 + 4*i}; Line(11 + 4*i) = {11 + 4*i, 12 + 4*i}; Line(12 + 4*i) = {12 + 4*i, 13 + 4*i};
  Circle(13 + 4*i) = {13 + 4*i, 5, 10 + 4*((i + 1)%3)};
  wall[] += {10 + 4*i, 11 + 4*i, 12 + 4*i, 13 + 4*i};
EndFor
Curve Loop(1) = {1:4};
Curve Loop(2) = wall[];
Plane Surface(1) = {1, 2};

Field[1] = Distance; Field[1].CurvesList = {wall[]}; Field[1].NumPointsPerCurve = 100;
Field[2] = Threshold; Field[2].InField = 1;
Field[2].SizeMin = 0.03/n; Field[2].SizeMax = 0.4/n; Field[2].DistMin = 0.1; Field[2].DistMax = 3;
Background Field = 2;
Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeExtendFromBoundary = 0; Mesh.Algorithm = 6;
Recombine Surface{1};
// an extrusion answers the face across, the volume, and the faces over the loops' curves, those of the hole backwards
e[] = Extrude {0, 0, span} { Surface{1}; Layers{1}; Recombine; };
Physical Surface("inlet", 1) = {e[5]};
Physical Surface("outlet", 2) = {e[3]};
Physical Surface("sides", 3) = {e[2], e[4]};
Physical Surface("hub", 4) = {e[6], e[10], e[14]};
Physical Surface("frontback", 5) = {1, e[0]};
For i In {0:2}
  Physical Surface(Sprintf("blade%g", i + 1), 6 + i) = {e[15 - 4*i], e[16 - 4*i], e[17 - 4*i]};
EndFor
Physical Volume("fluid", 10) = {e[1]};
