# What a run of the flag gave, and what it should: summary.txt, then history.csv. Exits 1 where it is off.
# References (FSI1 of Turek and Hron 2006, FSI2 and FSI3 of Featflow: Turek et al. 2010), per metre of span, A the flag's tip.
# The figures of 2006 for FSI2 are uy 1.23 +- 80.6 mm [2.0 Hz], ux -14.58 +- 12.44 mm [3.8 Hz]; by symmetry uy has half the
# frequency of ux.
#   FSI1   ux 0.0227 mm, uy 0.8209 mm, drag 14.295 N/m, lift 0.7638 N/m
#   FSI2   ux -14.85 +- 12.70 mm [3.86 Hz], uy 1.30 +- 81.6 mm [1.93 Hz], drag 215.1 +- 77.7 N/m, lift 0.6 +- 237.8 N/m
#   FSI3   ux -2.88 +- 2.72 mm [10.93 Hz], uy 1.47 +- 34.99 mm [5.46 Hz], drag 460.5 +- 27.7 N/m, lift 2.5 +- 154 N/m
BEGIN { FS = ","; split("ux uy drag lift", what, " "); split("2 3 8 9", column, " ") }
FNR == NR { split($0, word, " "); summary[word[1]] = word[2]; next }
FNR == 1 { next }
{
    lines++; t[lines] = $1
    for (i = 1; i <= 4; i++) x[i, lines] = $column[i] * (i < 3 ? 1000 : 1)
    if (cell == "" || $13 < cell) cell = $13
    if (first == "") first = $13
    z = $4 < 0 ? -$4 : $4; if (z > out) out = z
    sum += x[1, lines]
}
function off(value, should) { return sprintf("%+.1f %%", 100 * (value / should - 1)) }
# The last whole cycle (cycles.awk, whose result is cycles.txt) beside a reference: means, amplitudes, frequency
function cycle(means, amplitudes, hertz,   i, line, mean, amplitude, word, value, factor) {
    split(means, mean, " "); split(amplitudes, amplitude, " ")
    while ((getline line < "cycles.txt") > 0) { split(line, word, " "); value[word[1]] = line }
    split("ux_m uy_m fx_N_m fy_N_m", key, " ")
    if (!(key[2] in value)) return
    for (i = 1; i <= 4; i++) {
        split(value[key[i]], word, " "); factor = i < 3 ? 1000 : 1
        if (!(word[4] > 0)) return
        printf "  %-8s %8.2f +- %7.2f   reference %7.2f +- %6.2f   amplitude %s\n", what[i], factor * word[2], factor * word[3], mean[i], amplitude[i], off(factor * word[3], amplitude[i])
    }
    printf "  %-8s %8.3f Hz          reference %7.2f Hz           %s\n", "uy", word[4], hertz, off(word[4], hertz)
}
END {
    if (lines < 1) exit 1
    printf "  %-42s %.4e, %.4e mm at t = %g s\n", "the tip", x[1, lines], x[2, lines], t[lines]
    printf "  %-42s %.0f %% of the least at the start\n", "least cell of the run", 100 * cell / first
    if (solver == "code_saturne") printf "  %-42s %.0f degrees\n", "sharpest corner of the mesh in the run", 57.29578 * atan2(summary["least_corner"], sqrt(1 - summary["least_corner"] ^ 2))
    if (cell <= 0) bad = 1
    printf "  %-42s %.1e m at most\n", "the tip out of the plane", out
    if (solver == "openfoam" && out > 1e-7) bad = 1
    # under a pressure p on all sides the tip swings about -p L / E' = -1e4 0.35 / 6.67e6 m; the starting flow adds up to a tenth
    if (name == "flag_pressure") {
        printf "  %-42s %.3f mm, should be -0.525 (at most 15 %% off)\n", "mean of the tip along", sum / lines
        if (sum / lines < -0.525 * 1.15 || sum / lines > -0.525 * 0.85) bad = 1
    }
    if (name == "flag_fsi1" && t[lines] >= 7.9) {
        split("0.0227 0.8209 14.295 0.7638", should, " ")
        for (i = 1; i <= 4; i++)
            printf "  %-8s %10.4f   reference %8.4f   %s\n", what[i], x[i, lines], should[i], off(x[i, lines], should[i])
        for (i = 2; i <= 4; i++) if (x[i, lines] / should[i] > 1.02 || x[i, lines] / should[i] < 0.98) bad = 1
    }
    if (name == "flag" && t[lines] > 3) cycle("-2.88 1.47 460.5 2.50", "2.72 34.99 27.74 153.91", 5.46)
    if (name == "flag_fsi2" && t[lines] > 6) cycle("-14.85 1.30 215.1 0.6", "12.70 81.6 77.7 237.8", 1.93)
    exit bad
}
