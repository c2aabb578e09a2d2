# What a run of the flag gave, and what it should: summary.txt, then history.csv. Exits 1 where it is off.
# References (Turek and Hron 2006; FSI3 as of Featflow's level 4 with dt 0.00025 s), per metre of span, A the flag's tip:
#   FSI1   ux 0.0227 mm, uy 0.8209 mm, drag 14.295 N/m, lift 0.7638 N/m
#   FSI3   ux -2.88 +- 2.72 mm [10.93 Hz], uy 1.47 +- 34.99 mm [5.46 Hz], drag 460.5 +- 27.7 N/m, lift 2.5 +- 154 N/m
# Mean and amplitude are half the sum and half the difference of the largest and the least value in the last whole cycle of uy.
BEGIN { FS = ","; split("ux uy drag lift", what, " "); split("2 3 8 9", column, " ") }
FNR == NR { split($0, word, " "); summary[word[1]] = word[2]; next }
FNR == 1 { next }
{
    lines++; t[lines] = $1
    for (i = 1; i <= 4; i++) x[i, lines] = $column[i] * (i < 3 ? 1000 : 1)
    if (cell == "" || $13 < cell) cell = $13
    if (first == "") first = $13
}
function off(value, should) { return sprintf("%+.1f %%", 100 * (value / should - 1)) }
# up[]: lines after which uy passes its middle upwards, of the last third of the run
function cycles(   i, least, most, middle, from) {
    from = int(lines * 2 / 3); least = most = x[2, from]
    for (i = from; i <= lines; i++) { if (x[2, i] > most) most = x[2, i]; if (x[2, i] < least) least = x[2, i] }
    middle = (most + least) / 2
    for (i = from; i < lines; i++)
        if (x[2, i] < middle && x[2, i + 1] >= middle) {
            up[++ups] = i; when[ups] = t[i] + (t[i + 1] - t[i]) * (middle - x[2, i]) / (x[2, i + 1] - x[2, i])
        }
}
END {
    if (lines != steps) { printf "  only %d of %d steps in history.csv\n", lines, steps; exit 1 }
    printf "\n%s: %d steps of %g s\n", name, steps, dt
    printf "  %-42s %.2f in the mean, %d at most\n", "iterations a step", summary["iterations_mean"], summary["iterations_most"]
    printf "  %-42s %.2f %% of the processor time, the mesh's motion included\n", "spar's share", 100 * summary["spar_share"]
    printf "  %-42s %s, %s, %s\n", "transfer's errors: force, moment, power", summary["force_error"], summary["moment_error"], summary["power_error"]
    printf "  %-42s %.4e, %.4e mm at t = %g s\n", "the tip", x[1, lines], x[2, lines], t[lines]
    if (solver == "code_saturne") printf "  %-42s %.0f %% of the least at the start\n", "least cell of the run", 100 * cell / first
    if (solver == "code_saturne") printf "  %-42s %.0f degrees\n", "sharpest corner of the mesh in the run", 57.29578 * atan2(summary["least_corner"], sqrt(1 - summary["least_corner"] ^ 2))
    if (summary["force_error"] > 1e-12 || summary["moment_error"] > 1e-12 || summary["power_error"] > 1e-12 || cell <= 0) bad = 1
    if (name == "flag_fsi1" && t[lines] >= 7.9) {
        split("0.0227 0.8209 14.295 0.7638", should, " ")
        for (i = 1; i <= 4; i++)
            printf "  %-8s %10.4f   reference %8.4f   %s\n", what[i], x[i, lines], should[i], off(x[i, lines], should[i])
        for (i = 2; i <= 4; i++) if (x[i, lines] / should[i] > 1.02 || x[i, lines] / should[i] < 0.98) bad = 1
    }
    if (name == "flag" && t[lines] > 3) cycles()
    if (ups > 1) {
        split("-2.88 1.47 460.5 2.50", mean, " "); split("2.72 34.99 27.74 153.91", amplitude, " ")
        for (i = 1; i <= 4; i++) {
            least = most = x[i, up[ups]]
            for (j = up[ups - 1]; j <= up[ups]; j++) { if (x[i, j] > most) most = x[i, j]; if (x[i, j] < least) least = x[i, j] }
            printf "  %-8s %8.2f +- %7.2f   reference %7.2f +- %6.2f   amplitude %s\n", what[i], (most + least) / 2, (most - least) / 2, mean[i], amplitude[i], off((most - least) / 2, amplitude[i])
        }
        f = 1 / (when[ups] - when[ups - 1])
        printf "  %-8s %8.3f Hz          reference    5.46 Hz           %s\n", "uy", f, off(f, 5.46)
    }
    exit bad
}
