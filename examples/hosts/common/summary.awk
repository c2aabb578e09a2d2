# What a run of any case gave: summary.txt, cycles.txt (of cycles.awk), history.csv. Exits 1 where the run ended early or the map
# between flow and structure is off.
BEGIN { FS = "," }
FILENAME ~ /summary/ { split($0, word, " "); summary[word[1]] = word[2]; next }
FILENAME ~ /cycles/ { rows++; split($0, word, " "); for (i = 1; i <= 6; i++) row[rows, i] = word[i]; next }
FNR == 1 { next }
{ lines++; last = $1 }
END {
    printf "\n%s: %d steps of %g s, to t = %g s\n", name, lines, dt, last
    if (lines != steps) { printf "  only %d of %d steps\n", lines, steps; bad = 1 }
    if (summary["steps"]) {
        printf "  %-42s %.2f in the mean, %d at most\n", "iterations a step", summary["iterations_mean"], summary["iterations_most"]
        printf "  %-42s %.2f %% of the processor time\n", "spar's share", 100 * summary["spar_share"]
        printf "  %-42s %s, %s, %s\n", "transfer's errors: force, moment, power", summary["force_error"], summary["moment_error"], summary["power_error"]
        if (summary["force_error"] > 1e-12 || summary["moment_error"] > 1e-12 || summary["power_error"] > 1e-12) bad = 1
    }
    for (r = 1; r <= rows; r++) { s = row[r, 1] ~ /^u/ ? "u" : "f"; if (row[r, 3] > most[s]) most[s] = row[r, 3] }
    f = row[1, 4]
    if (f > 0) printf "  %-42s mean +- amplitude; %.4g Hz\n", "last whole cycle", f
    else printf "  %-42s mean +- amplitude; no whole cycle\n", "last third"
    for (r = 1; r <= rows; r++) {
        s = row[r, 1] ~ /^u/ ? "u" : "f"
        if (row[r, 3] > 1e-6 * most[s] && row[r, 3] > 0) {
            printf "    %-40s %.6g +- %.6g", row[r, 1], row[r, 2], row[r, 3]
            if (f > 0 && row[r, 5] != 0) printf " (%+.2g %% since the cycle before)", row[r, 5]
            printf "\n"
        }
    }
    exit bad
}
