# What a run of the cylinder gave, and what it should. summary.txt, then history.csv. Exits 1 where it is off.
#
# The check of any run: an oscillator integrated here (of the cases whose mass is known), with the same generalised-alpha method (rho_inf 0.9), from the recorded
# force alone. The coupled motion must be its motion, to what the tolerance rtol of the loads leaves.
BEGIN { pi = atan2(0, -1); FS = ","; mass = name == "cylinder" ? 2 : name == "cylinder_light" ? 0.2 : 0 }
FNR == NR { split($0, word, " "); summary[word[1]] = word[2]; next }
FNR == 1 {
    rho = 0.9; am = (2 * rho - 1) / (rho + 1); af = rho / (rho + 1); gamma = 0.5 - am + af; beta = 0.25 * (1 - am + af) ^ 2
    k = mass * (2 * pi / 4) ^ 2; y = 0; v = 0.05; a = 0
    next
}
{
    force = $9
    if (FNR == 2) before = 0 # nothing was pushed at t = 0
    yp = y + dt * v + dt * dt * (0.5 - beta) * a
    if (mass > 0) new = (((1 - af) * force + af * before - k * ((1 - af) * yp + af * y)) / mass - am * a) / (1 - am + (1 - af) * k / mass * beta * dt * dt)
    y = yp + beta * dt * dt * new; v += dt * ((1 - gamma) * a + gamma * new); a = new; before = force
    off = mass > 0 ? $3 - y : 0; if (off < 0) off = -off; if (off > worst) worst = off
    size = $3 < 0 ? -$3 : $3; if (size > largest) largest = size
    last = $3; t = $1; lines++
}
function verdict(what, value, should, tolerance, source,   difference) {
    difference = value / should - 1
    printf "  %-42s %.8g, should be %.8g: %.1e (at most %.0e; %s)\n", what, value, should, difference, tolerance, source
    if (difference > tolerance || -difference > tolerance) bad = 1
}
END {
    if (lines < 1) exit 1
    # OpenFOAM ends its iteration by the residuals of its own fields, which leave more of a light structure's loads
    bound = solver == "openfoam" ? (mass < 1 ? 0.1 : 0.01) : 100 * rtol
    printf "  %-42s %.8f m at t = %g s\n", "y", last, t
    if (mass > 0) printf "  %-42s %.1e of the largest %.4g m (at most %.0e)\n", "off an oscillator under the same force", worst / largest, largest, bound
    if (!(worst < bound * largest)) bad = 1
    if (solver == "code_saturne" && refine == 1 && dt == 0.025 && steps == 40 && mass == 2)
        verdict("y at 1 s", last, 0.02262570, 1e-4, "a host that integrates the cylinder itself")
    if (solver == "code_saturne" && refine == 1 && dt == 0.025 && steps == 40 && mass == 0.2)
        verdict("y at 1 s", last, 0.00669542, 1e-3, "the same")
    if (solver == "code_saturne" && refine == 1 && dt == 0.025 && steps == 20 && mass == 0.2)
        verdict("y at 0.5 s", last, 0.00407147, 1e-3, "a run on one rank")
    # the tests' mesh
    if (solver == "code_saturne" && refine == 0.5 && dt == 0.025 && steps == 20 && mass == 0.2)
        verdict("y at 0.5 s", last, 0.00425098, 1e-3, "a run on one rank")
    if (solver == "openfoam" && refine == 0.5 && dt == 0.025 && steps == 20 && mass == 2)
        verdict("y at 0.5 s", last, 0.0179589, 2e-3, "a run on one rank")
    # an earlier boundary condition, with the cylinder as a mass on a beam; what residualControl leaves open
    if (solver == "openfoam" && refine == 1 && dt == 0.025 && steps == 20 && mass == 2)
        verdict("y at 0.5 s", last, 0.017913, 5e-3, "another adapter, the spring a beam")
    if (solver == "openfoam" && refine == 1 && dt == 0.025 && steps == 20 && mass == 0.2)
        verdict("y at 0.5 s", last, 0.00766, 2e-2, "the same")
    exit bad
}
