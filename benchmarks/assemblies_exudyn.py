#!/usr/bin/env python3
"""The chains and windows of benchmarks/assemblies in Exudyn (PyPI: exudyn), for comparison.

    assemblies_exudyn.py chain|windows MEMBERS STEPS DT [--euler] [--tolerance R] [--against FILE]

Prints CSV: members, seconds of the first step, microseconds a member and step of all later ones; processor time, one
thread. Bodies have rotation vectors with Lie-group integration, with --euler Exudyn's default, Euler parameters. R:
relative tolerance of Newton, default 1e-8 as Exudyn has it; the absolute one is R / 100. FILE is what
benchmarks/assemblies has written after as many steps of DT; then also the largest distance, in a coordinate, of the far
ends of the bars.
"""
import argparse
import sys
import time
import warnings

sys.exudynFast = True  # the module without range checks
warnings.filterwarnings("ignore")
import exudyn as exu
import numpy as np
from exudyn.utilities import RigidBodyInertia

parser = argparse.ArgumentParser()
parser.add_argument("kind", choices=["chain", "windows"])
parser.add_argument("members", type=int)
parser.add_argument("steps", type=int)
parser.add_argument("dt", type=float)
parser.add_argument("--euler", action="store_true")
parser.add_argument("--tolerance", type=float, default=1e-8)
parser.add_argument("--against")
args = parser.parse_args()

container = exu.SystemContainer()
system = container.AddSystem()
ground = system.CreateGround()
bars = []  # body, begin, vector to the far end


def add_bar(begin, along, mass, inertia, gravity):
    node = exu.NodeType.RotationEulerParameters if args.euler else exu.NodeType.RotationRotationVector
    begin, along = np.array(begin, float), np.array(along, float)
    body = system.CreateRigidBody(
        referencePosition=list(begin + 0.5 * along), gravity=gravity, nodeType=node,
        inertia=RigidBodyInertia(mass=mass, inertiaTensor=inertia * np.eye(3)))
    bars.append((body, begin, along))
    return body


def build_chain(links):
    above = ground
    for i in range(links):
        link = add_bar([0.1 * i, 0, 0], [0.1, 0, 0], 0.5, 0.5 * 0.01 / 12, [0, 0, -9.81])
        system.CreateSphericalJoint(itemNumbers=[above, link], position=[0.1 * i, 0, 0], useGlobalFrame=True)
        above = link


def add_hinge(to, bar, position, closes=False):
    """A hinge that closes a loop holds the two directions of the plane alone: Exudyn refuses redundant constraints."""
    axes = [1, 0, 1, 0, 0, 0] if closes else [1, 1, 1, 1, 0, 1]
    system.CreateGenericJoint(itemNumbers=[to, bar], position=position, constrainedAxes=axes, useGlobalFrame=True)


def build_windows(count):
    gravity, upright = [2, 0, -9.6], None
    for i in range(count // 2 + 1):
        following = add_bar([i, 0, 0], [0, 0, 1], 1, 1 / 12, gravity)
        add_hinge(ground, following, [i, 0, 0])
        if upright is not None:
            lintel = add_bar([i - 1, 0, 1], [1, 0, 0], 1, 1 / 12, gravity)
            add_hinge(upright, lintel, [i - 1, 0, 1])
            add_hinge(following, lintel, [i, 0, 1], closes=True)
        upright = following


def run(steps):
    """Processor time of so many steps from the start."""
    s = exu.SimulationSettings()
    s.timeIntegration.numberOfSteps, s.timeIntegration.endTime = steps, steps * args.dt
    s.timeIntegration.automaticStepSize = s.timeIntegration.adaptiveStep = False
    s.timeIntegration.newton.relativeTolerance = args.tolerance
    s.timeIntegration.newton.absoluteTolerance = 0.01 * args.tolerance
    s.solution.file.write = False
    s.parallel.numberOfThreads = 1
    s.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    begin = time.process_time()
    system.SolveDynamic(s, solverType=exu.DynamicSolverType.GeneralizedAlpha)
    return time.process_time() - begin


def rotate(q, v):
    t = 2 * np.cross(q[:, 1:], v)
    return v + q[:, :1] * t + np.cross(q[:, 1:], t)


if args.kind == "chain":
    build_chain(args.members)
else:
    build_windows(args.members)
system.Assemble()
first = run(1)
rest = (run(args.steps) - first) / max(1, args.steps - 1)
print("members,first step s,step us a member")
print(f"{args.members},{first:.4f},{1e6 * rest / args.members:.1f}")
if args.against:
    table = np.loadtxt(args.against, ndmin=2)
    begin, along = (np.array([bar[k] for bar in bars]) for k in (1, 2))
    theirs = begin + table[:, :3] + rotate(table[:, 3:], along)
    kind = exu.OutputVariableType.Position
    ours = np.array([system.GetObjectOutputBody(b, kind, localPosition=list(0.5 * a)) for b, _, a in bars])
    print(f"largest distance {np.abs(theirs - ours).max():.3e} m")
